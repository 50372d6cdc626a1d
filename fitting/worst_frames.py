#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Draws the frames in which the least is found: worst_frames.py DATA OUT [COUNT]

Of rendered/train and of the Middlebury pairs with masks: a row each, truth beside what the preset default finds
(with PYTHONPATH at the built module). The pictures of Middlebury are not ours to show: of those only the masks
are drawn. Prints a line for each frame: objects found, and what became of the others.
"""
import pathlib
import sys

import numpy as np
from PIL import Image, ImageDraw

import cairn

TILE = (320, 240)
COLOURS = np.random.RandomState(5).randint(70, 256, (256, 3)).astype(np.uint8)
COLOURS[0] = 25


def tile(picture, mask):
    """The mask's objects in colour over the picture, or alone."""
    drawn = COLOURS[mask % 256]
    if picture is not None:
        drawn = np.where((mask > 0)[..., None], drawn // 2 + picture // 2, picture // 2)
    return Image.fromarray(drawn.astype(np.uint8)).resize(TILE, Image.NEAREST)


def why(truth, ours, k):
    """What became of object k of the truth."""
    mask = truth == k
    share = lambda part: int(round(100 * part.sum() / mask.sum()))
    ids, counts = np.unique(ours[mask], return_counts=True)
    most = ids[np.argmax(np.where(ids > 0, counts, 0))]
    if most == 0 or share(mask & (ours == most)) < 20:
        return "missed"
    region = ours == most
    others = [int(o) for o in np.unique(truth[region]) if o not in (0, k) and (region & (truth == o)).sum() > 0.3 * (truth == o).sum()]
    if others:
        return "one with its neighbour"
    if (region & ~mask).sum() > mask.sum():
        return "flooded into the background"
    return f"{share(mask & region)} % of it, in parts" if (ids > 0).sum() > 1 else f"{share(mask & region)} % of it"


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


def main():
    data, out = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 12
    rooms = sorted(p.parent for p in (data / "rendered/train/320x240").glob("*/objects.png"))
    clutter = sorted(p.parent for p in (data / "real").glob("middlebury*/*/objects.png"))
    draw(rooms, out / "worst_train.png", count, True)
    draw(clutter, out / "worst_middlebury.png", min(count, len(clutter)), False)


if __name__ == "__main__":
    main()
