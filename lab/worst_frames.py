#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Draws the frames in which the preset default misses most objects: worst_frames.py YARDSTICK DATA OUT [COUNT]

Covers the yardstick indoors and Middlebury's pairs with masks in the data collection: one row per frame, the truth next
to our result (PYTHONPATH names the built module). Middlebury's images may not be published: only their masks are drawn.
Prints one line per frame, the number of objects found and the fate of the others, and how often each fate is met.
"""
import argparse
import collections
import pathlib
import re

import cairn
import numpy as np
from PIL import Image, ImageDraw

TILE = (320, 240)
COLOURS = np.random.RandomState(5).randint(70, 256, (256, 3)).astype(np.uint8)
COLOURS[0] = 25


def tile(image, mask):
    """The mask's objects in colour over the image, or alone."""
    drawn = COLOURS[mask % 256]
    if image is not None:
        drawn = np.where((mask > 0)[..., None], drawn // 2 + image // 2, image // 2)
    return Image.fromarray(drawn.astype(np.uint8)).resize(TILE, Image.NEAREST)


def why(truth, ours, k):
    """The fate of true object k."""
    mask = truth == k
    share = lambda part: int(round(100 * part.sum() / mask.sum()))
    ids, counts = np.unique(ours[mask], return_counts=True)
    most = ids[np.argmax(np.where(ids > 0, counts, 0))]
    if most == 0 or share(mask & (ours == most)) < 20:
        return "missed"
    region = ours == most
    others = [o for o in np.unique(truth[region]) if o not in (0, k)]
    if any((region & (truth == o)).sum() > 0.3 * (truth == o).sum() for o in others):
        return "merged with a neighbour"
    if (region & ~mask).sum() > mask.sum():
        return "merged with the background"
    return f"{share(mask & region)} % found, split" if (ids > 0).sum() > 1 else f"{share(mask & region)} % found"


def judge(folder):
    left, right = (np.array(Image.open(folder / name).convert("RGB")) for name in ("left.png", "right.png"))
    truth = np.array(Image.open(folder / "objects.png")).astype(int)
    calibration = cairn.load_calibration(str(folder / "calib.txt"))
    ours = np.array(cairn.segment(left, right, calibration).objects_map).astype(int)
    lost = []
    objects = [k for k in np.unique(truth) if 0 < k < 255 and (truth == k).sum() >= 200]
    for k in objects:
        mask = truth == k
        ids = [o for o in np.unique(ours[mask]) if o > 0]
        known = truth != 255
        iou = max([(mask & (ours == o)).sum() / ((mask | (ours == o)) & known).sum() for o in ids], default=0)
        if iou < 0.5:
            lost.append(why(truth, ours, k))
    return len(objects), lost, left, np.where(truth == 255, 0, truth), ours


def draw(frames, path, count, show):
    judged = [(frame, *judge(frame)) for frame in frames]
    judged.sort(key=lambda item: (-len(item[2]), item[0].name))
    sheet = Image.new("RGB", (2 * TILE[0], count * TILE[1]))
    for row, (frame, objects, lost, left, truth, ours) in enumerate(judged[:count]):
        for column, mask in enumerate((truth, ours)):
            sheet.paste(tile(left if show else None, mask), (column * TILE[0], row * TILE[1]))
        ImageDraw.Draw(sheet).text((4, row * TILE[1] + 4), frame.name, fill="white")
        print(f"| {frame.name} | {objects - len(lost)} of {objects} | {', '.join(lost) or '–'} |", flush=True)
    sheet.save(path)
    fates = collections.Counter(re.sub(r"\d+ % found", "a part found", fate) for item in judged for fate in item[2])
    print(f"of {sum(item[1] for item in judged)} objects: " + ", ".join(f"{n} {fate}" for fate, n in fates.most_common()))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("yardstick", type=pathlib.Path, help="folder of the yardstick")
    parser.add_argument("data", type=pathlib.Path, help="the data collection")
    parser.add_argument("out", type=pathlib.Path, help="folder of the images (docs/images)")
    parser.add_argument("count", type=int, nargs="?", default=12, help="rows of each image (default: 12)")
    arguments = parser.parse_args()
    worlds = sorted(p.parent for p in (arguments.yardstick / "indoors").glob("*/objects.png"))
    clutter = sorted(p.parent for p in (arguments.data / "real").glob("middlebury*/*/objects.png"))
    for name, frames in (("yardstick", worlds), ("middlebury", clutter)):
        if not frames:
            parser.error(f"found no frames of {name} with objects.png")
        draw(frames, arguments.out / f"worst_{name}.png", min(arguments.count, len(frames)), name == "yardstick")


if __name__ == "__main__":
    main()
