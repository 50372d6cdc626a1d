#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Degrades a sequence in one way after another and prints the value of each reliability check of `cairn follow`.

usage: reliability.py CAIRN SEQUENCE...   (folders of frames with disp_left.png and pose.txt)
"""
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np
from PIL import Image, ImageFilter

WITNESSES = ("value", "stereo", "photometric", "temporal", "floor", "odometry", "scan")
LASER_BELOW_M = 0.75  # the camera


def calibration(frame):
    lines = (line.split("=") for line in (frame / "calib.txt").read_text().split() if "=" in line)
    return {key: float(value) for key, value in lines}


def pose_of(frame):
    rows = [line.split() for line in (frame / "pose.txt").read_text().splitlines() if not line.startswith("#")]
    return np.array(rows, float)


def true_scan(frame):
    """Ranges that a laser below the camera would measure, from the true disparities; 0 = no return."""
    c = calibration(frame)
    d = np.array(Image.open(frame / "disp_left.png")).astype(float) / 256
    v, u = np.mgrid[: d.shape[0], : d.shape[1]]
    z = np.where(d > 0, c["fx"] * c["baseline"] / np.maximum(d, 1e-6), np.nan)
    points = np.stack([(u - c["cx"]) / c["fx"] * z, (v - c["cy"]) / c["fy"] * z, z], -1)
    world = points @ pose_of(frame)[:3, :3].T
    ahead = pose_of(frame)[:3, :3] @ [0, 0, 1]
    heading = math.atan2(ahead[1], ahead[0])
    forward = world[..., 0] * math.cos(heading) + world[..., 1] * math.sin(heading)
    left = -world[..., 0] * math.sin(heading) + world[..., 1] * math.cos(heading)
    on_plane = np.abs(world[..., 2] + LASER_BELOW_M) < 0.006
    angles = np.arange(-40, 40.01, 0.25)
    ranges = []
    for angle in angles:
        near = on_plane & (np.abs(np.degrees(np.arctan2(left, forward)) - angle) < 0.15)
        ranges.append(np.hypot(forward, left)[near].min() if near.any() else 0)
    return math.radians(angles[0]), math.radians(0.25), ranges


def quaternion(r):
    w = math.sqrt(max(0, 1 + np.trace(r))) / 2
    if w > 1e-3:
        return [(r[2, 1] - r[1, 2]) / (4 * w), (r[0, 2] - r[2, 0]) / (4 * w), (r[1, 0] - r[0, 1]) / (4 * w), w]
    values, vectors = np.linalg.eigh((r + r.T) / 2)
    return [*vectors[:, np.argmax(values)], 0.0]


def as_it_is(left, right, k, frames):
    return left[k], right[k]


def black(left, right, k, frames):
    return left[k], right[k].point(lambda _: 0)


def blurred(left, right, k, frames):
    return left[k], right[k].filter(ImageFilter.GaussianBlur(3))


def late(left, right, k, frames):
    return left[k], right[max(0, k - 2)]


def rows_off(left, right, k, frames):
    return left[k], right[k].transform(right[k].size, Image.AFFINE, (1, 0, 0, 0, 1, 9))


def frozen(left, right, k, frames):
    return left[k // 3 * 3], right[k // 3 * 3]


def hidden_floor(left, right, k, frames):
    """From the tenth frame on, a card covers the lower part of both lenses."""
    if k < 10:
        return left[k], right[k]
    noise = np.random.default_rng(7).integers(40, 200, (left[k].height, left[k].width + 64)).astype(np.uint8)
    card = Image.fromarray(noise).filter(ImageFilter.GaussianBlur(1))
    images = []
    for image, shift in ((left[k], 0), (right[k], 24)):
        drawn = image.copy()
        half = image.height * 2 // 5
        part = card.crop((shift, half, shift + image.width, image.height))
        drawn.paste(part.convert(image.mode), (0, half))
        images.append(drawn)
    return images


BREAKAGES = [
    ("unchanged", as_it_is, {}),
    ("right image black", black, {}),
    ("right image blurred, σ 3 px", blurred, {}),
    ("right image two frames late", late, {}),
    ("right rows 9 px off", rows_off, {}),
    ("two of three frames repeated", frozen, {}),
    ("lower part of both images covered", hidden_floor, {}),
    ("focal length 1.3 times too long", as_it_is, {"fx": 1.3, "fy": 1.3}),
    ("baseline 1.3 times too long", as_it_is, {"baseline": 1.3}),
]


def follow(cairn, sequence, change, factors, work):
    frames = sorted(path.parent for path in sequence.glob("*/left.png"))[:40]
    left = [Image.open(frame / "left.png").copy() for frame in frames]
    right = [Image.open(frame / "right.png").copy() for frame in frames]
    scans = ["# laser_in_level_camera_m: 0 %g 0" % LASER_BELOW_M]
    poses = []
    first = np.linalg.inv(pose_of(frames[0]))
    for k, frame in enumerate(frames):
        folder = work / "in" / frame.name
        folder.mkdir(parents=True)
        for name, image in zip(("left.png", "right.png"), change(left, right, k, frames)):
            image.save(folder / name)
        text = (frame / "calib.txt").read_text().splitlines()
        (folder / "calib.txt").write_text(
            "\n".join("%s=%.9g" % (key, float(value) * factors[key]) if key in factors else f"{key}={value}"
                      for key, value in (line.split("=") for line in text)) + "\n")
        begin, step, ranges = true_scan(frame)
        if k == 0:
            scans.append("t_s,angle_min,angle_increment," + ",".join(f"r{i}" for i in range(len(ranges))))
        scans.append("%.3f,%.6f,%.6f," % (k / 10, begin, step) + ",".join("%.3f" % r for r in ranges))
        pose = first @ pose_of(frame)
        poses.append(" ".join("%.6f" % x for x in [k / 10, *pose[:3, 3], *quaternion(pose[:3, :3])]))
    (work / "scan.csv").write_text("\n".join(scans) + "\n")
    (work / "odometry.tum").write_text("\n".join(poses) + "\n")
    command = [cairn, "follow", work / "in", "--rate", "10", "--scan", work / "scan.csv", "--odometry",
               work / "odometry.tum", "-o", work / "out"]
    ran = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if ran.returncode != 0:
        sys.exit(ran.stderr)
    return json.loads((work / "out" / "summary.json").read_text())["reliability"]


def main():
    cairn, *sequences = sys.argv[1:]
    for sequence in map(pathlib.Path, sequences):
        print(f"\n{sequence.name}\n\n| | {' | '.join(WITNESSES)} | unreliable frames |\n|---{'|---' * 8}|")
        for name, change, factors in BREAKAGES:
            work = pathlib.Path(tempfile.mkdtemp())
            found = follow(cairn, sequence, change, factors, work)
            shutil.rmtree(work)
            cells = ["%.2f" % found[w] if w in found else "–" for w in WITNESSES]
            print(f"| {name} | {' | '.join(cells)} | {found['unreliable_frames']} |", flush=True)


if __name__ == "__main__":
    main()
