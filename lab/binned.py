#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Compares whole images with binned ones: binned.py CAIRN FRAMES... (PYTHONPATH: the built module)

CAIRN is the command, each of FRAMES a folder of frames with truth. Binned masks are enlarged to the truth's size. Prints the
objects found, the precision, the error of distances of the objects that both find, and the time of a frame on one thread.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import cairn
from accuracy import TrueFrame
from fit import frames_in
from report import number, percent, table

FACTORS = (1, 2)


def segmented(command, folder, factor):
    """The scores of each frame, {(frame, object): relative error of the distance}, and the ms of each frame."""
    errors, distances, ms = [], {}, []
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([command, "segment", folder, "--binning", str(factor), "--threads", "1", "-o", out], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for frame in frames_in(folder):
            true = TrueFrame(frame)
            result = pathlib.Path(out) / frame.name
            found = json.loads((result / "objects.json").read_text())
            ours = np.zeros_like(true.objects)
            small = cairn.load_labels(result / "objects.png").astype(ours.dtype)
            large = small.repeat(factor, 0).repeat(factor, 1)
            ours[:large.shape[0], :large.shape[1]] = large
            errors.append(cairn.object_errors(ours, true.objects))
            ms.append(sum(found["timings_ms"].values()))
            distance_of = {thing["id"]: thing["position_m"] and thing["position_m"][2] for thing in found["objects"]}
            rig = true.calibration.rig
            for thing in errors[-1].truth:
                known = true.truth_px[(true.objects == thing.id) & ~np.isnan(true.truth_px)]
                if rig is None or thing.iou < 0.5 or len(known) == 0 or not distance_of[thing.found]:
                    continue
                truth_m = rig.focal_px * rig.baseline_m / (np.median(known) + rig.doffs_px)
                distances[frame, thing.id] = abs(distance_of[thing.found] / truth_m - 1)
    return errors, distances, ms


def main():
    command, folders = sys.argv[1], [pathlib.Path(folder) for folder in sys.argv[2:]]
    of = {factor: [segmented(command, folder, factor) for folder in folders] for factor in FACTORS}
    both = set.intersection(*({key for part in parts for key in part[1]} for parts in of.values()))
    rows = []
    for factor, parts in of.items():
        errors = [frame for part in parts for frame in part[0]]
        summary = cairn.summarise(errors)
        things = [thing.iou for frame in errors for thing in frame.truth]
        off = [error for part in parts for key, error in part[1].items() if key in both]
        rows.append([str(factor), str(len(things)), number(summary.recall_50, ".2f"), number(np.mean(np.array(things) >= 0.75), ".2f"),
                     number(summary.precision_50, ".2f"), str(summary.phantoms),
                     f"{percent(np.median(off))}, {percent(np.percentile(off, 90))}",
                     number(np.median([t for part in parts for t in part[2]]), ".1f")])
    print(table(["`--binning`", "objects", "found", "IoU ≥ 0.75", "precision", "phantoms",
                 f"distances off by, % (median and 90 % of {len(both)})", "ms a frame"], rows))


if __name__ == "__main__":
    main()
