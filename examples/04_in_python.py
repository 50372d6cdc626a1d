#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""The first example in Python: a rectified pair in, objects out.

PYTHONPATH=build/release/python examples/04_in_python.py data/samples/four_in_a_row
"""

import pathlib
import sys

if len(sys.argv) != 2:
    sys.exit(f"usage: {sys.argv[0]} FOLDER (with left.png, right.png and calib.txt)")
folder = pathlib.Path(sys.argv[1])

# [readme]
import cairn

left, right = cairn.load_pair(folder / "left.png", folder / "right.png")  # or any numpy arrays, (H, W[, 3]) uint8
frame = cairn.segment(left, right, cairn.load_calibration(folder / "calib.txt"))

for o in frame.objects:
    x, y, z = o.position_in_camera_m
    print(f"object {o.id}  {o.pixel_count:5} px  {x:5.2f} m right  {y:5.2f} m down  {z:5.2f} m away")

occluded = (frame.reject & cairn.Reject.left_right) != 0  # why a pixel has no disparity
print(f"{occluded.mean():.1%} of the pixels are seen by one camera only")
# [/readme]
