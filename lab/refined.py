#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Compares refined disparities with matched ones and with the truth: refined.py DATA YARDSTICK [--fit WORLDS] (PYTHONPATH: the
built module)

Prints, for objects and for the rest of the image: the share of the pixels with a disparity, of these the share that is off by
more than 3 px, and the calibration of the stated confidence. Middlebury is in docs/accuracy.md.
--fit prints the weights of kept pixels, kKept… in cairn/regions/refine_disparity.cpp, fitted to 300 worlds. The confidence that
they are fitted to contains the present weights, so repeat it until nothing changes.
"""
import multiprocessing
import pathlib
import sys

import numpy as np

import cairn
from accuracy import TrueFrame, share
from fit import frames_in
from report import number, percent, table
from studies import logistic

THRESHOLDS = (0.0, 0.3, 0.5)  # of the refined confidence
GROSS = 3.0  # px
RIGHT = 1.0  # px
BINS = 10  # of the confidence
LEAST = 0.005  # kLeast of cairn/regions/refine_disparity.cpp
FIT_WORLDS, EVERY = 300, 23  # one pixel of so many
KEPT = np.array([-0.32, 0.87, 0.27])  # as there


def seen(folder, grey=False):
    """The frame and its truth; the pixels with a true disparity."""
    true = TrueFrame(folder)
    frame = true.segment(None, grey)
    return true, frame, ~np.isnan(true.truth_px)


def counts_of(job):
    """(objects or rest, pixels, then for the matches and for each threshold: with a disparity, of these gross), and of the
    confidence's bins: pixels, right ones, sum of the confidence."""
    folder, grey = job
    true, frame, known = seen(folder, grey)
    off = np.abs(frame.refined.disparity_px - true.truth_px)
    confidence = frame.refined.confidence
    rows = []
    for of in (true.objects > 0, true.objects == 0):
        pixels = known & of
        matched = pixels & ~np.isnan(frame.disparity)
        row = [pixels.sum(), matched.sum(), (np.abs(frame.disparity - true.truth_px)[matched] > GROSS).sum()]
        for least in THRESHOLDS:
            likely = pixels & ~np.isnan(off) & (confidence >= least)
            row += [likely.sum(), (off[likely] > GROSS).sum()]
        rows.append(row)
    sure = known & (confidence > 0)
    bins = np.minimum((confidence[sure] * BINS).astype(int), BINS - 1)
    weights = (None, (off[sure] <= RIGHT).astype(float), confidence[sure])
    return np.array(rows), np.array([np.bincount(bins, weights=w, minlength=BINS) for w in weights])


def log_odds(p):
    p = np.clip(p, LEAST, 1 - LEAST)
    return np.log(p / (1 - p))


def kept_pixels(folder):
    """Kept pixels: 1, the log-odds of the refined and of the matched confidence, whether they are right."""
    true, frame, known = seen(folder)
    with np.errstate(invalid="ignore"):
        kept = known & (frame.refined.disparity_px == frame.disparity) & (frame.refined.confidence > 0)
    at = np.flatnonzero(kept)[::EVERY]
    of = lambda image: image.ravel()[at]
    right = np.abs(of(frame.disparity) - of(true.truth_px)) <= RIGHT
    return np.column_stack([np.ones(len(at)), log_odds(of(frame.refined.confidence)), log_odds(of(frame.confidence)), right])


def fit(worlds, pool):
    rows = np.concatenate(pool.map(kept_pixels, frames_in(worlds)[:FIT_WORLDS], chunksize=4))
    bias, refined, match = logistic(rows[:, :3], rows[:, 3], np.ones(len(rows)))
    bias, choice, match = bias + refined * KEPT[0], refined * KEPT[1], refined * KEPT[2] + match
    print(f"{len(rows)} pixels: kKeptBias {bias:.2f}, kKeptChoice {choice:.2f}, kKeptMatch {match:.2f}")


def main():
    data, yardstick = (pathlib.Path(folder) for folder in sys.argv[1:3])
    rendered = data / "rendered"
    sets = {"train": rendered / "train/320x240", "train_outdoor": rendered / "train_outdoor/320x240",
            "dev 640x480": rendered / "dev/640x480", "yardstick indoors": yardstick / "indoors",
            "yardstick outdoors": yardstick / "outdoors"}
    rows, calibration = [], []
    with multiprocessing.Pool(2) as pool:
        if "--fit" in sys.argv:
            return fit(pathlib.Path(sys.argv[4]), pool)
        for name, folder in sets.items():
            for grey in (False, True):
                frames = [(frame, grey) for frame in frames_in(folder)]
                pixels, bins = (sum(part) for part in zip(*pool.map(counts_of, frames, chunksize=4)))
                where = f"{name}, {'grey' if grey else 'colour'}"
                for what, (all_, *of) in zip(("objects", "the rest"), pixels):
                    rows.append([where, what, *(f"{percent(share(n, all_))}, {percent(share(bad, n))}"
                                                for n, bad in zip(of[::2], of[1::2]))])
                counts, right, stated = bins
                calibration.append([where, *(f"{number(share(s, n), '.2f')} → {number(share(r, n), '.2f')}"
                                             for n, r, s in zip(counts, right, stated))])
    print(table(["% of the pixels with a disparity, % of these off by more than 3 px", "", "matched",
                 *(f"refined, confidence ≥ {least}" if least else "refined, all" for least in THRESHOLDS)], rows, 2))
    print(table(["mean confidence → share within 1 px", *(f"{k / BINS:.1f} …" for k in range(BINS))], calibration))


if __name__ == "__main__":
    main()
