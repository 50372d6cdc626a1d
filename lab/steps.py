#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Compares reported steps of the ground with the truth: steps.py FOLDER... (PYTHONPATH: the built module)

FOLDER: worlds outdoors, for example of `./dev worlds frames 0 399 --seed 77 --outdoor 1`: their scene.json has the lines
where the ground rises. A step counts where at least 1 m of its edge is in view, and a ground was found. It could be known
if its height is at least four standard deviations of that of one disparity.
"""
import json
import multiprocessing
import sys

import numpy as np

from accuracy import TrueFrame
from fit import frames_in
from report import table

DISTANCES = [0, 2, 3, 4, 6]  # m
LEAST = 0.08  # m
SIGMA_PX, SIGMAS = 0.3, 4  # as in cairn/objects/ground_steps.cpp
NEAR = 0.4  # m from a true edge


class Edge:
    """The visible part of an edge, in the floor frame, and its height as seen from the camera."""

    def __init__(self, part, world_from_camera, true, floor):
        rig, (height, width) = true.calibration.rig, true.truth_px.shape
        inward = np.array(part["inward"])
        along = np.arange(-15, 15, 0.05)[:, None] * np.array([-inward[1], inward[0]])
        points = np.column_stack([part["edge"] + along, np.full(len(along), part["height_m"]), np.ones(len(along))])
        points = (np.linalg.inv(world_from_camera) @ points.T).T[:, :3]
        points = points[points[:, 2] > 0.3]
        x, y = (rig.focal_px * points[:, k] / points[:, 2] + c for k, c in ((0, rig.cx_px), (1, rig.cy_px)))
        inside = (x > 2) & (x < width - 3) & (y > 2) & (y < height - 3)
        x, y, points = x[inside].astype(int), y[inside].astype(int), points[inside]
        disparity = rig.focal_px * rig.baseline_m / points[:, 2]
        seen = np.abs(true.truth_px[y, x] + rig.doffs_px - disparity) < 0.08 * disparity
        self.places = points[seen] @ floor[:2, :3].T
        eye = world_from_camera[:2, 3] - part["edge"]
        self.height = part["height_m"] * (-1 if eye @ inward > 0 else 1)
        self.sigma = SIGMA_PX * floor[2, 3] / np.median(disparity[seen]) if seen.any() else np.inf

    @property
    def distance(self):
        return np.median(np.hypot(*self.places.T))

    def is_at(self, step):
        middle = (np.array(step.from_m) + step.to_m)[:2] / 2
        return len(self.places) > 0 and np.hypot(*(self.places - middle).T).min() < NEAR


def judged(folder):
    """(height, distance, could be known, heights reported there) of each true step; how many are reported elsewhere."""
    true = TrueFrame(folder)
    frame = true.segment(None)
    steps = frame.ground_steps()
    scene = json.loads((folder / "scene.json").read_text())
    if steps is None or "raised" not in scene:
        return [], len(steps or [])
    floor = np.reshape(frame.floor_frame.floor_from_camera, (4, 4))
    edges = [Edge(part, np.loadtxt(folder / "pose.txt"), true, floor) for part in scene["raised"]]
    rows = [(edge.height, edge.distance, SIGMAS * edge.sigma <= abs(edge.height),
             [step.height_m for step in steps if edge.is_at(step) and step.height_m * edge.height > 0])
            for edge in edges if len(edge.places) >= 20]
    return rows, sum(not any(edge.is_at(step) for edge in edges) for step in steps)


def main():
    frames = [frame for folder in sys.argv[1:] for frame in frames_in(folder)]
    with multiprocessing.Pool(2) as pool:
        seen = pool.map(judged, frames, chunksize=4)
    steps = [row for rows, _ in seen for row in rows if abs(row[0]) >= LEAST and row[1] < DISTANCES[-1]]

    def found(rows):
        return f"{sum(len(row[3]) > 0 for row in rows)} of {len(rows)}"

    print(table([f"{len(frames)} frames", *(f"{low} … {high} m" for low, high in zip(DISTANCES, DISTANCES[1:]))],
                [[name, *(found([row for row in steps if low <= row[1] < high and row[2] >= known])
                          for low, high in zip(DISTANCES, DISTANCES[1:]))]
                 for name, known in (("steps of 8 cm and more", False), ("of these, those that could be known", True))]))
    print(f"{sum(others for _, others in seen)} reported elsewhere")
    off = [100 * (height - row[0]) for row in steps for height in row[3]]
    if off:
        print(f"heights, 10th, 50th and 90th percentile of the error: {np.round(np.percentile(off, [10, 50, 90]), 1)} cm")


if __name__ == "__main__":
    main()
