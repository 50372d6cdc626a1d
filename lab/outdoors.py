#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Compares sky, ground, obstacles and objects with the truth outdoors: outdoors.py DATA YARDSTICK [--report | --fit WORLDS]
(PYTHONPATH: the built module)

Prints tables for the outdoor fit set and the yardstick: shares of pixels, with the share of indoor images that is
wrongly sky, and objects found by their distance. --report adds validation, which is rarely scored.
--fit prints the coefficients of sky_probability() in cairn/objects/sky.cpp, fitted to the superpixels of the rendered
fit sets and of 500 worlds, in colour.
"""
import multiprocessing
import pathlib
import sys

import numpy as np

import cairn
from accuracy import TrueFrame, share
from fit import LARGER, frames_in
from report import number, percent, table
from studies import disparity_of, logistic

TRUSTED, NEAR_PX = 0.7, 2.0  # kTrusted and kNear_px there
NEAR_BY = 12.0  # m
DISTANCES = [0, 2, 4, 7, 12, np.inf]  # m
FIT_WORLDS, RIDGE = 500, 1e-4
SIZES = ["320x240", *LARGER]


class Seen(TrueFrame):
    """A frame and its truth. A pixel is sky if it is infinitely far."""

    def __init__(self, folder):
        super().__init__(folder)
        self.rig = self.calibration.rig
        self.frame = self.segment(None)
        with np.errstate(invalid="ignore"):
            self.depth = self.rig.focal_px * self.rig.baseline_m / (self.truth_px + self.rig.doffs_px)
        self.is_ground = cairn.load_labels(folder / "ground.png") == 255
        self.is_sky = np.isnan(self.truth_px) & (self.objects == 0) & ~self.is_ground


def superpixels_of(folder):
    """Features as SkyFeatures has them, the share that is sky, and the share of the image, of each superpixel."""
    seen = Seen(folder)
    before = disparity_of(folder, folder, "default")[-1]  # without the reason sky
    if before.ground.plane is None:
        return np.zeros((0, 7))
    labels = seen.frame.superpixels.labels
    count = labels.max() + 1
    pixels = np.bincount(labels.ravel(), minlength=count)

    def mean(values):
        return np.bincount(labels.ravel(), weights=values.ravel(), minlength=count) / pixels

    rows, columns = np.mgrid[: labels.shape[0], : labels.shape[1]]
    plane, infinity = before.ground.plane, -seen.rig.doffs_px
    above = plane.a * columns + plane.b * rows + plane.c <= infinity
    near = (np.nan_to_num(before.disparity, nan=-np.inf) > infinity + NEAR_PX) & (before.confidence >= TRUSTED)
    top = np.isin(np.arange(count), labels[0])
    return np.column_stack([mean(seen.grey / 255), np.full(count, seen.grey.mean() / 255), mean(above), mean(near), top,
                            mean(seen.is_sky), pixels / labels.size])


def fit(frames, pool):
    rows = np.concatenate(pool.map(superpixels_of, frames, chunksize=4))
    found = logistic(np.column_stack([np.ones(len(rows)), rows[:, :5]]), rows[:, 5], rows[:, 6], RIDGE)
    print(f"{len(frames)} frames, {len(rows)} superpixels")
    names = ["bias", "brightness", "image_brightness", "above_horizon", "near", "touches_the_top"]
    print("  ".join(f"{name} {value:.2f}" for name, value in zip(names, found)))


def counts_of(folder):
    """Counts of pixels, and (distance, IoU) of each true object."""
    seen = Seen(folder)
    space, sky, near_by = seen.frame.space, seen.frame.space == 64, seen.depth < NEAR_BY
    ground, floor, objects = seen.is_ground & near_by, (space == 128) & near_by, (seen.objects > 0) & near_by
    pixels = np.array([space.size, sky.sum(), (sky & seen.is_sky).sum(), seen.is_sky.sum(), (seen.is_sky & (space == 255)).sum(),
                       ground.sum(), (ground & (space == 128)).sum(), (ground & (space == 255)).sum(), floor.sum(),
                       objects.sum(), (objects & (space == 255)).sum()])
    scores = cairn.object_errors(seen.frame.objects_map, seen.objects).truth
    return pixels, [(np.nanmedian(seen.depth[seen.objects == score.id]), score.iou) for score in scores]


def pixels_row(name, counts):
    (pixels, sky, right, true, as_obstacle, ground, as_floor, ground_obstacle, floor, near_by, as_near) = np.sum(counts, axis=0)
    shares = [share(right, sky), share(right, true), share(as_obstacle, true), share(as_floor, floor), share(as_floor, ground),
              share(ground_obstacle, ground), share(as_near, near_by)]
    return [name, *map(percent, shares), number(100 * share(sky - right, pixels), ".2f")]


def found_cell(iou):
    found = (iou >= 0.5).sum()
    return f"{found}/{len(iou)} = {number(share(found, len(iou)), '.2f')}, {number(share((iou >= 0.75).sum(), len(iou)), '.2f')}"


def distance_row(name, objects):
    distance, iou = np.array(objects).T
    return [name, *(found_cell(iou[(distance >= low) & (distance < high)]) for low, high in zip(DISTANCES, DISTANCES[1:]))]


def main():
    data, yardstick = (pathlib.Path(folder) for folder in sys.argv[1:3])
    rendered = data / "rendered"
    outdoors, reported = ([frame for size in SIZES for frame in frames_in(rendered / name / size)]
                          for name in ("train_outdoor", "validate_outdoor"))
    rooms = frames_in(rendered / "train/320x240") + frames_in(rendered / "dev/320x240")
    with multiprocessing.Pool(2) as pool:
        if "--fit" in sys.argv:
            return fit(outdoors + rooms + frames_in(sys.argv[4])[:FIT_WORLDS], pool)
        outside = {"train_outdoor": outdoors, "yardstick outdoors": frames_in(yardstick / "outdoors")}
        if "--report" in sys.argv:
            outside["validate_outdoor"] = reported
        inside = {"rooms of the fit": rooms, "yardstick indoors": frames_in(yardstick / "indoors")}
        measured = {name: list(zip(*pool.map(counts_of, frames, chunksize=4))) for name, frames in (outside | inside).items()}
    print(table(["% of the pixels", "sky: precision", "recall", "called obstacle", "ground nearer than 12 m: precision", "recall",
                 "called obstacle", "objects nearer than 12 m: obstacle", "of all pixels, wrongly sky"],
                [pixels_row(name, counts) for name, (counts, _) in measured.items()]))
    print(table(["found at IoU 0.5, at 0.75", *(f"{low} … {high} m" for low, high in zip(DISTANCES, DISTANCES[1:]))],
                [distance_row(name, sum(measured[name][1], [])) for name in outside]))


if __name__ == "__main__":
    main()
