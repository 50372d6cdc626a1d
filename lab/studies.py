#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Three studies on pairs with measured or exact truth, suggested by the claims of the paper (with PYTHONPATH at the module)

  studies.py operators DATA     robustness of each correlation operator to noise, gain and offset (Middlebury)
  studies.py reflections DATA   effect and cost of the ground check on floors of increasing gloss
  studies.py confidence DATA    fits the model of confidence of both presets; agreement of stated and measured confidence
DATA is the folder with real/ and rendered/.
"""
import pathlib
import sys

import numpy as np

import cairn

SIGNS = ("bias", "margin", "cost", "jumps", "holes")  # of a ConfidenceModel
BINS, FEW_PIXELS, WINDOW = 10, 200, 13  # smaller bins are too noisy to report; kConfidenceWindow


def row(*cells):
    print("| " + " | ".join(map(str, cells)) + " |", flush=True)


def header(names, words):
    row(*names)
    print("|" + "---|" * words + "---:|" * (len(names) - words))


def disparity_of(folder, truth, preset, **options):
    """A pair's disparities by a preset, as (left, right, rig and options, StereoResult)."""
    left, right = cairn.load_pair(folder / "left.png", folder / "right.png")
    calibration = cairn.load_calibration(truth / "calib.txt")
    config = cairn.Config(preset, match={"num_disparities": calibration.num_disparities or 64}, **options)
    return left, right, config, cairn.estimate_disparity(left, right, calibration.rig, config=config)


# ---- operators ----


def grey(image):
    if image.ndim == 2:
        return image
    r, g, b = (image[..., channel].astype(int) for channel in range(3))
    return ((77 * r + 150 * g + 29 * b + 128) >> 8).astype(np.uint8)


def disturbed(image, gain, offset, sigma, seed):
    lit = np.clip(np.floor(gain * image + offset + 0.5), 0, 255)
    return np.clip(np.rint(lit + sigma * np.random.default_rng(seed).normal(size=image.shape)), 0, 255).astype(np.uint8)


def operators(data):
    print("bad-1 of matched / bad-2 of matched / density, %; preset paper, ground off, pixels that both cameras see\n")
    costs = next(option.range for option in cairn.options() if option.name == "match.cost").split("|")
    header(["pair", "right image", *costs], 2)
    conditions = {"as it is": (1, 0, 0), "gain 1.25, offset 12": (1.25, 12, 0), "both: noise 4": (1, 0, 4), "both: noise 8": (1, 0, 8)}
    for name in ("middlebury2003/cones", "middlebury2003/teddy", "middlebury2001/tsukuba"):
        folder = data / "real" / name
        left, right = map(grey, cairn.load_pair(folder / "left.png", folder / "right.png"))
        truth = cairn.load_disparity(folder / "disp_left.png")
        occlusion = folder / "occlusion.png"
        hidden = cairn.load_labels(occlusion) == 255 if occlusion.exists() else None
        match = {"num_disparities": cairn.load_calibration(folder / "calib.txt").num_disparities or 64}
        for condition, (gain, offset, sigma) in conditions.items():
            pair = disturbed(left, 1, 0, sigma, 1), disturbed(right, gain, offset, sigma, 2)
            cells = []
            for cost in costs:  # the scenes have no floor
                found = cairn.estimate_disparity(*pair, preset="paper", match={**match, "cost": cost}, ground={"source": "off"})
                errors = cairn.disparity_errors(found.disparity, truth, hidden)
                bad = errors.bad_of_matched
                cells.append(f"{100 * bad[1.0]:.1f} / {100 * bad[2.0]:.1f} / {100 * errors.density:.0f}")
            row(pathlib.Path(name).name, condition, *cells)


# ---- reflections ----


def reflections(data):
    print("preset paper; wrong = more than 1 px off, below = under the true floor by more than ground.margin\n")
    header(["scene", "floor reflectivity", "wrong matches below the floor", "removed", "right matches", "lost", "ground"], 1)
    for scene in ("base0", "base1", "base2"):
        folder = data / "rendered" / "stress" / scene
        truth = cairn.load_disparity(folder / "gt" / "disp_left.png")
        lines = [line.split() for line in (folder / "gt" / "ground.txt").read_text().splitlines() if line and line[0] != "#"]
        a, b, c = map(float, lines[-1])
        rows, columns = np.mgrid[: truth.shape[0], : truth.shape[1]]
        floor = a * columns + b * rows + c
        for gloss in ("0.0", "0.3", "0.6"):
            frame = folder / f"floor_{gloss}"
            _, _, config, checked = disparity_of(frame, folder / "gt", "paper")
            unchecked = disparity_of(frame, folder / "gt", "paper", ground={"source": "off"})[-1].disparity
            removed = (checked.reject & cairn.Reject.below_ground) != 0
            right = np.abs(unchecked - truth) <= 1
            is_wrong = np.abs(unchecked - truth) > 1
            below = is_wrong & (floor > 0) & (unchecked < floor - config["ground.margin"])
            counts = [(of.sum(), (of & removed).sum()) for of in (below, right)]
            (wrong, wrong_removed), (all_right, lost) = counts
            row(scene, gloss, wrong, f"{wrong_removed} ({100 * wrong_removed / max(1, wrong):.0f} %)", all_right,
                f"{lost} ({100 * lost / max(1, all_right):.2f} %)", "found" if checked.ground else "refused")


# ---- confidence ----


def data_sets(data):
    """Name, folders of frames, how their names begin, and of a sequence, which of them."""
    rendered, real = data / "rendered", data / "real"
    stress = [rendered / "stress" / f"base{i}" for i in range(3)]
    yield "rendered 320x240 (fitted)", [rendered / "dev/320x240"], "", 1
    yield "rendered 640x480 (fitted)", [rendered / "dev/640x480"], "", 1
    yield "rendered sequences", [rendered / f"dev/sequences/dev_seq{i}" for i in "AB"], "", 8
    for name, prefix in (("gloss", "floor_"), ("gain and offset", "gain_"), ("noise", "noise_"), ("vertical shift", "vshift_"),
                         ("dim light", "dim_"), ("low texture", "lowtexture"), ("repetitive texture", "repetitive")):
        yield f"stress: {name}", stress, prefix, 1
    for year in (2001, 2003, 2005, 2006, 2014):
        yield f"Middlebury {year}", [real / f"middlebury{year}"], "", 1


def frames_of(folders, prefix, step):
    """Each frame with the folder of its truth."""
    for folder in folders:
        for frame in sorted(path.parent for path in folder.glob("*/left.png"))[::step]:
            if frame.name.startswith(prefix):
                yield frame, frame if (frame / "disp_left.png").exists() else folder / "gt"


def share_in_window(marks):
    """Of the pixels around each one that the image has."""
    def sums(values):
        padded = np.pad(values.astype(float), WINDOW // 2 + 1)[:-1, :-1].cumsum(0).cumsum(1)
        return padded[WINDOW:, WINDOW:] - padded[:-WINDOW, WINDOW:] - padded[WINDOW:, :-WINDOW] + padded[:-WINDOW, :-WINDOW]

    return sums(marks) / sums(np.ones_like(marks))


def signs_of(left, right, config, px):
    """(H, W) each: what estimate_confidence() reads, as tests/reference/confidence.cpp defines it."""
    corrected = cairn.correct_epipolar(left, right, config=config).right
    matches = cairn.match(left, right if corrected is None else corrected, config=config)
    mean = np.maximum(matches.mean_cost, 1e-6)
    jumps = np.zeros(px.shape, bool)
    jumps[:, :-1] |= np.abs(px[:, 1:] - px[:, :-1]) > 1
    jumps[:-1] |= np.abs(px[1:] - px[:-1]) > 1
    with np.errstate(invalid="ignore"):
        margin, cost = np.minimum((matches.runner_up - matches.cost) / mean, 1), np.minimum(matches.cost / mean, 1)
    return np.ones(px.shape), margin, cost, np.sqrt(share_in_window(jumps)), np.sqrt(share_in_window(np.isnan(px)))


def logistic(x, share_right, weight, ridge=0):
    """The maximum-likelihood parameters of a logistic regression, by Newton's method. The first column of x is 1;
    ridge: penalty for the squares of the other parameters."""
    numbers = np.zeros(x.shape[1])
    penalty = np.diag([0, *[2 * ridge] * (len(numbers) - 1)])
    for _ in range(12):
        p = 1 / (1 + np.exp(-x @ numbers))
        hessian = (x * (weight * p * (1 - p))[:, None]).T @ x + penalty
        numbers += np.linalg.solve(hessian, x.T @ (weight * (share_right - p)) - penalty @ numbers)
    return numbers


def fitted(sets, preset):
    """The parameters of one pixel of eleven. Data sets have equal weight."""
    signs, right, weights = [], [], []
    random = np.random.default_rng(1)
    for _, *of in sets:
        samples = [], []
        for frame, truth in frames_of(*of):
            pair_left, pair_right, config, scene = disparity_of(frame, truth, preset)
            off = np.abs(scene.disparity - cairn.load_disparity(truth / "disp_left.png"))
            taken = ~np.isnan(off) & (random.integers(0, 11, off.shape) == 0)
            samples[0].append(np.stack([sign[taken] for sign in signs_of(pair_left, pair_right, config, scene.disparity)], 1))
            samples[1].append(off[taken] <= 1)
        count = sum(map(len, samples[1]))
        signs, right, weights = signs + samples[0], right + samples[1], weights + [np.full(count, 1 / count)]
    x, is_right, weight = map(np.concatenate, (signs, right, weights))
    return logistic(x, is_right, weight)


def print_reliability(name, preset, *of):
    count, stated, right = (np.zeros(BINS) for _ in range(3))
    confident = np.zeros(2)
    for frame, truth in frames_of(*of):
        scene = disparity_of(frame, truth, preset)[-1]
        off = np.abs(scene.disparity - cairn.load_disparity(truth / "disp_left.png"))
        known = ~np.isnan(off)
        confidence, is_right = scene.confidence[known], off[known] <= 1
        bins = np.minimum((confidence * np.float32(BINS)).astype(int), BINS - 1)
        for sums, values in ((count, None), (stated, confidence), (right, is_right)):
            sums += np.bincount(bins, values, BINS)
        confident += (confidence >= 0.8).sum(), is_right[confidence >= 0.8].sum()
    every = count.sum()
    row(name, *(f"{100 * share:.1f}" for share in (stated.sum() / every, right.sum() / every, np.abs(stated - right).sum() / every)),
        f"{100 * confident[0] / every:.0f}: {100 * confident[1] / confident[0]:.1f}",
        *(f"{100 * r / n:.0f}" if n >= FEW_PIXELS else "" for r, n in zip(right, count)))


def confidence(data):
    print("All in %, over the pixels with a disparity and a truth, occluded ones too; right = within 1 px.\n"
          "stated: mean confidence; ECE: expected calibration error; >= 0.8: share of pixels with such a confidence, and how "
          "many of them are right;\n"
          f".0 to .9: right ones among those stated 0 to 0.1 ... 0.9 to 1 (empty: fewer than {FEW_PIXELS} pixels)\n")
    sets = list(data_sets(data))
    for preset in ("default", "paper"):
        numbers = ", ".join(f"{name} {value:.2f}" for name, value in zip(SIGNS, fitted(sets[:2], preset)))
        print(f"Preset {preset}\n\nfitted now (confidence_model() has those in use): {numbers}\n")
        header(["data", "stated", "right", "ECE", ">= 0.8: right", *(f".{i}" for i in range(BINS))], 1)
        for name, *of in sets:
            print_reliability(name, preset, *of)
        print()


if __name__ == "__main__":
    studies = {study.__name__: study for study in (operators, reflections, confidence)}
    if len(sys.argv) != 3 or sys.argv[1] not in studies:
        sys.exit("usage: studies.py operators|reflections|confidence DATA")
    studies[sys.argv[1]](pathlib.Path(sys.argv[2]))
