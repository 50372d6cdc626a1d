#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Counts right and wrong floors: floors.py DATA [--fit] (PYTHONPATH: the built module)

Frames with a true floor are the rendered ones and the table tops; those without one are the rows above the floor of
the rendered frames, and the Middlebury pairs named below. --fit fits floor_odds() in cairn/scene/floor_search.cpp to
the planes that are found; to see them all, build with kOddsAtOnce = 1000 first. Rolled copies of the right planes
stand for cameras on a slope, which the frames have not.
"""
import pathlib
import sys

import numpy as np

import cairn

FIT = ["train/320x240", "dev/320x240", "stress/base0", "stress/base1", "stress/base2", "train_outdoor/320x240",
       "train_outdoor/621x188", "train_outdoor/640x360", "train_outdoor/640x480"]
VALIDATE = ["validate/320x240", "validate_varied/320x240", "validate_models/320x240", "validate_outdoor/320x240",
            "validate_outdoor/621x188", "validate_outdoor/640x360", "validate_outdoor/640x480"]
NO_FLOOR = ["middlebury2001/barn2", "middlebury2001/bull", "middlebury2001/map", "middlebury2001/poster",
            "middlebury2001/sawtooth", "middlebury2001/venus", "middlebury2005/Books", "middlebury2005/Dolls",
            "middlebury2006/Baby1", "middlebury2006/Cloth1", "middlebury2006/Lampshade1", "middlebury2006/Lampshade2",
            "middlebury2006/Midd2", "middlebury2006/Rocks1", "middlebury2006/Wood1"]
# The table in front hides most of the true ground; what is found is the room's floor, which is right.
TABLES = {"train_s68", "train_s91", "train_s107"}
WRONG_PX = 1.5  # median difference of true and found disparities of the floor
MIN_ROWS = 90


def calibration_of(folder):
    for path in (folder / "calib.txt", folder.parent / "gt" / "calib.txt"):
        if path.exists():
            return cairn.load_calibration(path)
    return None


def plane_of(left, right, calibration):
    """(ground, roll in degrees, height in baselines) as found; None without a floor."""
    rig = calibration.rig if calibration else None
    # Not the calibration itself: cut images have another size.
    known = calibration.num_disparities if calibration else None
    ground = cairn.segment(left, right, rig, match={"num_disparities": known} if known else {}).ground
    if ground.plane is None:
        return None
    height, width = left.shape[:2]
    focal, cx, cy, doffs = (rig.focal_px, rig.cx_px, rig.cy_px, rig.doffs_px) if rig else (width, (width - 1) / 2, (height - 1) / 2, 0)
    a, b, c = ground.plane.a, ground.plane.b, ground.plane.c
    down = np.array([focal * a, focal * b, a * cx + b * cy + c + doffs])
    return ground, np.degrees(np.arctan2(down[0], down[1])), focal / np.linalg.norm(down)


def error_px(folder, plane, shape):
    path = folder / "ground.txt"
    path = path if path.exists() else folder.parent / "gt" / "ground.txt"
    values = np.array(" ".join(line for line in path.read_text().splitlines() if line[0] != "#").split(), float)
    y, x = np.mgrid[: shape[0] : 8, : shape[1] : 8]
    true = x - (values[0] * x + values[1] * y + values[2])
    return np.median(np.abs(plane.a * x + plane.b * y + plane.c - true)[true > 0])


def rows_above(folder, shape):
    """Number of rows from the top in which less than 1 % of the pixels show the floor."""
    floor = cairn.load_labels(folder / "ground.png") > 0
    share = np.cumsum(floor.sum(1)) / (np.arange(1, shape[0] + 1) * shape[1])
    return int(np.argmax(share > 0.01)) if share[-1] > 0.01 else shape[0]


def fitted(planes):
    """Logistic regression, classes of equal weight; columns as in floor_odds()."""
    generator = np.random.RandomState(1)
    rows = [(support, abs(roll), height, right, 0.5 if right else 1) for right, support, roll, height in planes]
    rows += [(support, abs(generator.normal(0, 5)), height, True, 0.25) for right, support, _, height in planes if right for _ in range(2)]
    support, roll, height, right, weight = (np.array(column, float) for column in zip(*rows))
    a = np.stack([np.ones_like(support), support, roll / 10, np.log(np.maximum(height / 40, 1)), np.log(np.maximum(1.5 / height, 1))], 1)
    weight[right == 0] *= weight[right == 1].sum() / weight[right == 0].sum()
    found = np.zeros(5)
    ridge = 0.5 * np.diag([0, 1, 1, 1, 1])
    for _ in range(50):
        odds = 1 / (1 + np.exp(-a @ found))
        found += np.linalg.solve((a.T * (weight * odds * (1 - odds))) @ a + ridge, a.T @ (weight * (right - odds)) - ridge @ found)
    return found


def main():
    data = pathlib.Path(sys.argv[1])
    planes = []
    print(f"{'frames':28} {'right':>6} {'wrong':>6} {'none':>6}")
    for name in FIT + ["real/rc_tabletop", "above the floor", "no floor"] + VALIDATE + ["real/validate/rc_tabletop"]:
        counts = [0, 0, 0]
        folders = [data / "real" / pair for pair in NO_FLOOR]
        if name.startswith("real/"):
            folders = sorted((data / name).iterdir())
        elif name == "above the floor":
            folders = [folder for set_name in FIT if "stress" not in set_name for folder in sorted((data / "rendered" / set_name).iterdir())]
        elif name != "no floor":
            folders = sorted((data / "rendered" / name).iterdir())
        for folder in folders:
            if not (folder / "left.png").exists():
                continue
            left, right = cairn.load_pair(folder / "left.png", folder / "right.png")
            calibration = calibration_of(folder)
            if name == "above the floor":
                rows = rows_above(folder, left.shape)
                if rows < MIN_ROWS or folder.name in TABLES:
                    continue
                left, right = left[:rows], right[:rows]
            found = plane_of(left, right, calibration)
            if found is None:
                counts[2] += 1
                continue
            ground, roll, height = found
            has_floor = name not in ("above the floor", "no floor")
            is_right = has_floor and (name.startswith("real/") or folder.name in TABLES or error_px(folder, ground.plane, left.shape) <= WRONG_PX)
            counts[0 if is_right else 1] += 1
            if name not in VALIDATE and "validate" not in name:
                planes.append((is_right, ground.support, roll, height))
        print(f"{name:28} {counts[0]:6} {counts[1]:6} {counts[2]:6}", flush=True)
    if "--fit" in sys.argv:
        print("odds:", *(f"{word} {value:+.2f}" for word, value in zip(
            ("at once", "support", "per 10 degrees of roll", "above", "below"), fitted(planes))))


main()
