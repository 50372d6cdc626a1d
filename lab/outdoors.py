#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Compares sky, ground, obstacles and objects with the truth outdoors: outdoors.py DATA YARDSTICK [--fit WORLDS]
(PYTHONPATH: the built module)

Prints tables for the outdoor fit set, the yardstick and validation: shares of pixels, with the share of indoor images that is
wrongly sky, and objects found by their distance.
--fit prints the coefficients of sky_probability() in cairn/objects/sky.cpp, fitted to the superpixels of the rendered
fit sets and of 500 worlds, in colour.
"""
import multiprocessing
import pathlib
import sys

import numpy as np

import cairn

TRUSTED, NEAR_PX = 0.7, 2.0  # kTrusted and kNear_px there
NEAR_BY = 12.0  # m
LEAST_PX = 200
DISTANCES = [0, 2, 4, 7, 12, np.inf]  # m
FIT_WORLDS = 500
SIZES = ["320x240", "621x188", "640x360", "640x480"]


def frames_in(folder):
    return sorted(path.parent for path in pathlib.Path(folder).glob("*/left.png"))


class Seen:
    """A frame and its truth. A pixel is sky if it is infinitely far."""

    def __init__(self, folder):
        left, right = cairn.load_pair(folder / "left.png", folder / "right.png")
        calibration = cairn.load_calibration(folder / "calib.txt")
        self.rig = calibration.rig
        self.left = left
        self.right, self.calibration = right, calibration
        self.frame = cairn.segment(left, right, calibration)
        self.disparity = np.nan_to_num(cairn.load_disparity(folder / "disp_left.png"))
        self.is_ground = cairn.load_labels(folder / "ground.png") == 255
        self.ids = ids = cairn.load_labels(folder / "objects.png")
        self.is_object = (ids > 0) & (ids < 255)
        self.depth = self.rig.focal_px * self.rig.baseline_m / np.maximum(self.disparity + self.rig.doffs_px, 1e-6)
        self.is_sky = (self.disparity <= 0) & (ids == 0) & ~self.is_ground


def superpixels_of(folder):
    """Features as SkyFeatures has them, the share that is sky, and the share of the image, of each superpixel."""
    seen = Seen(folder)
    before = cairn.disparity(seen.left, seen.right, seen.calibration)  # without the reason sky
    if before.ground.plane is None:
        return np.zeros((0, 7))
    labels = seen.frame.superpixels.labels
    count = labels.max() + 1
    pixels = np.bincount(labels.ravel(), minlength=count)

    def share(values):
        return np.bincount(labels.ravel(), weights=values.ravel(), minlength=count) / pixels

    grey = seen.left if seen.left.ndim == 2 else seen.left @ np.array([77, 150, 29]) / 256
    rows, columns = np.mgrid[: labels.shape[0], : labels.shape[1]]
    plane, infinity = before.ground.plane, -seen.rig.doffs_px
    above = plane.a * columns + plane.b * rows + plane.c <= infinity
    near = (np.nan_to_num(before.disparity, nan=-np.inf) > infinity + NEAR_PX) & (before.confidence >= TRUSTED)
    top = np.isin(np.arange(count), labels[0])
    return np.column_stack([share(grey / 255), np.full(count, grey.mean() / 255), share(above), share(near), top,
                            share(seen.is_sky), pixels / labels.size])


def fit(frames, pool):
    from scipy.optimize import minimize  # only here

    rows = np.concatenate(pool.map(superpixels_of, frames, chunksize=4))
    inputs = np.column_stack([np.ones(len(rows)), rows[:, :5]])
    sky, weight = rows[:, 5], rows[:, 6]

    def loss(weights):
        log_odds = inputs @ weights
        value = (weight * (np.logaddexp(0, log_odds) - sky * log_odds)).sum() + 1e-4 * (weights[1:] ** 2).sum()
        gradient = inputs.T @ (weight * (1 / (1 + np.exp(-log_odds)) - sky))
        return value, gradient + 2e-4 * np.append(0, weights[1:])

    found = minimize(loss, np.zeros(6), jac=True, method="L-BFGS-B", options={"maxiter": 2000})
    print(f"{len(frames)} frames, {len(rows)} superpixels, loss {found.fun:.2f}")
    names = ["bias", "brightness", "image_brightness", "above_horizon", "near", "touches_the_top"]
    print("  ".join(f"{name} {value:.2f}" for name, value in zip(names, found.x)))


def counts_of(folder):
    seen = Seen(folder)
    space, sky = seen.frame.space, seen.frame.space == 64
    near_by = (seen.disparity > 0) & (seen.depth < NEAR_BY)
    ground, floor = seen.is_ground & near_by, (space == 128) & near_by
    pixels = np.array([1, sky.mean(), sky.sum(), (sky & seen.is_sky).sum(), seen.is_sky.sum(), (seen.is_sky & (space == 255)).sum(),
                     ground.sum(), (ground & (space == 128)).sum(), (ground & (space == 255)).sum(), floor.sum(),
                     (seen.is_object & near_by).sum(), (seen.is_object & near_by & (space == 255)).sum()], float)
    return pixels, found_at(seen)


def found_at(seen):
    """(distance, its IoU with the best of our objects) of each true object of at least 200 px."""
    ours, objects = seen.frame.objects_map, []
    for k in np.unique(seen.ids[seen.is_object]):
        true = seen.ids == k
        if true.sum() < LEAST_PX:
            continue
        best = max((np.sum(true & (ours == i)) / np.sum(true | (ours == i)) for i in np.unique(ours[true]) if i), default=0)
        objects.append((np.median(seen.depth[true]), best))
    return objects


def main():
    data, yardstick = (pathlib.Path(folder) for folder in sys.argv[1:3])
    rendered = data / "rendered"
    outdoors = [frame for size in SIZES for frame in frames_in(rendered / "train_outdoor" / size)]
    rooms = frames_in(rendered / "train/320x240") + frames_in(rendered / "dev/320x240")
    with multiprocessing.Pool(2) as pool:
        if "--fit" in sys.argv:
            return fit(outdoors + rooms + frames_in(sys.argv[4])[:FIT_WORLDS], pool)
        print("| % of the pixels | sky: precision | recall | called obstacle | ground nearer than 12 m: precision | recall | called obstacle | objects nearer than 12 m: obstacle | all frames: wrongly sky |")
        print("|---|---:|---:|---:|---:|---:|---:|---:|---:|")
        reported = [frame for size in SIZES for frame in frames_in(rendered / "validate_outdoor" / size)]
        sets = {"train_outdoor": outdoors, "yardstick outdoors": frames_in(yardstick / "outdoors"), "validate_outdoor": reported,
                "rooms of the fit": rooms, "yardstick indoors": frames_in(yardstick / "indoors")}
        by_distance = {}
        for name, frames in sets.items():
            pixels, objects = zip(*pool.map(counts_of, frames, chunksize=4))
            by_distance[name] = np.array(sum(objects, []))
            (count, share, sky, right, true, as_obstacle, ground, as_floor, ground_obstacle, floor, near_by,
             as_near) = np.sum(pixels, axis=0)

            def percent(part, whole):
                return f"{100 * part / whole:.1f}" if whole else "–"

            wrong = share * (1 - right / sky) if sky else 0
            print(f"| {name} | " + " | ".join([percent(right, sky), percent(right, true), percent(as_obstacle, true),
                  percent(as_floor, floor), percent(as_floor, ground), percent(ground_obstacle, ground),
                  percent(as_near, near_by), f"{100 * wrong / count:.2f}"]) + " |", flush=True)
    print("\n| found at IoU 0.5, at 0.75 | " + " | ".join(f"{a} … {b} m" for a, b in zip(DISTANCES, DISTANCES[1:])) + " |")
    print("|---|" + "---|" * (len(DISTANCES) - 1))
    for name in list(sets)[:3]:
        distance, best = by_distance[name].T
        cells = []
        for low, high in zip(DISTANCES, DISTANCES[1:]):
            there = best[(distance >= low) & (distance < high)]
            cells.append(f"{(there >= 0.5).sum()}/{len(there)} = {(there >= 0.5).mean():.2f}, {(there >= 0.75).mean():.2f}" if len(there) else "–")
        print(f"| {name} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
