#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Fits the trees that score regions, those that choose planes of disparity, those that recognise the floor, and those that
correct the disparity of an object (cairn/fitted/*.bin).

fit.py TOOL WORLDS [--streets STREETS] [--data DATA] [--yardstick FOLDER] [--folds N] [--work FOLDER] [--hints FILE] [--out FOLDER] [--page FILE]
It needs the network that fit_hints.py writes to the work folder, and worlds that this network has not seen: trees
fitted to hints of a network that has would trust them too much. fit.py TOOL WORLDS --ablation FILE: refits without
each kind of cue in turn, and reports the gain of each. fit.py TOOL WORLDS --distances [--out FOLDER]: fits only the trees
that correct disparities, to the objects that the library finds. --planes, --floor: fits only the trees that
choose planes or that recognise the floor, likewise. --stages fits nothing.

Gradient boosting fits four scores and a correction: whether two neighbouring regions belong to the same object, on the pairs that occur
while the merge tree grows; whether a region is a whole object, on the regions of such trees; whether a group of pixels lies on a
plane, and whether it shows the floor; and how far the disparity of a found object is from the true one. The floor is fitted
to what the library finds, with refined disparities, so build the tool again before it. Which pairs and regions occur
depends on the first score, so it is fitted twice. Regions always come from trees grown by a fit that has not seen their scene
(cross-validation in `--folds` folds); so does every figure printed for the fit set. The yardstick and the real frames are
only reported. Everything is seeded: the same frames give the same trees.
"""
import argparse
import functools
import json
import math
import pathlib
import subprocess
import sys
import time
import zlib

import fitted_files
import numpy as np

ROOM_WEIGHT = 2.0  # of a frame of the data collection; there are few
PAIRS_KEPT = 0.2  # share of all pairs, of which there are millions
PAIR_TREES, PAIR_DEPTH = 80, 5
REGION_TREES, REGION_DEPTH = 400, 4
BIAS_TREES, BIAS_DEPTH = 60, 4
PLANE_TREES, PLANE_DEPTH = 100, 5
FLOOR_TREES, FLOOR_DEPTH = 150, 6
PLANES_KEPT = 0.3  # share of all planes that were judged
DOUBT = 0.08  # px, kDoubt of cairn/objects/refine_objects.cpp
MOST_CORRECTION = 1  # px, kMaxBias there
LARGEST_ERROR = 1.2  # px; larger ones are mistakes of the matching, which no feature predicts
MIN_SCORE = "0.35"  # objects.min_confidence of the preset default
SEED = 7
MIDDLEBURY = ["2001/tsukuba", "2003/cones", "2003/teddy", "2005/Art", "2005/Laundry", "2005/Reindeer", "2006/Baby1",
              "2006/Lampshade1"]
LARGER = ["621x188", "640x360", "640x480"]  # streets of other sizes than 320x240

CUES = {  # by substrings of their features' names
    "colours and brightness": ("colour", "brightness"), "edges": ("edge",), "steps of disparity": ("step",),
    "planes of disparity": ("plane", "slope", "spread of disparity", "spread, relative"),
    "the ground": ("ground", "floor"), "the background": ("background",), "evidence": ("evidence",),
    "hints": ("hints:",),
    "shape and place": ("box", "outline over", "outline of", "longer than before", "area", "extent", "middle",
                        "width", "height, share", "its foot", "image's", "borders of"),
    "the tree": ("same-object", "its parent", "same object likely")}


def frames_in(folder):
    return sorted(p.parent for p in pathlib.Path(folder).glob("*/left.png") if (p.parent / "objects.png").exists())


def fit_sets(worlds, data, streets=None):
    """Worlds that the network has not seen, and our own rendered rooms and streets. The network was fitted to those of
    train, too, but its loss there is no less than on dev, so its hints are not better than elsewhere."""
    sets = {"worlds": frames_in(worlds)}
    if streets:
        sets["wide streets"] = frames_in(streets)
    if data:
        sets |= {name: frames_in(data / "rendered" / name / "320x240") for name in ("train", "train_outdoor")}
        sets |= {f"train_outdoor {size}": frames_in(data / "rendered/train_outdoor" / size)
                 for size in LARGER}
        sets |= {f"dev {size}": frames_in(data / "rendered/dev" / size) for size in ("320x240", "640x480")}
    return sets


def checked_sets(yardstick, data):
    """Choices are made by these; no number is fitted to them."""
    sets = {f"yardstick {place}": frames_in(yardstick / place) for place in ("indoors", "outdoors", "large")} if yardstick else {}
    if data:
        sets |= {"rc_tabletop": frames_in(data / "real/rc_tabletop"),
                 "middlebury": [data / ("real/middlebury" + name) for name in MIDDLEBURY],
                 "outdoor_fit": frames_in(data / "real/outdoor_fit")}
    return sets


def sequences(data):
    """Every fourth frame: what follows each other is nearly the same."""
    if not data:
        return {}
    names = ("dev/sequences/dev_seqA", "dev/sequences/dev_seqB", "tour_train")
    return {"sequences": [frame for name in names for frame in frames_in(data / "rendered" / name)[::4]]}


def fold_of(frame, folds):
    scene = frame.parent.name if frame.name.isdigit() else frame.name  # a scene has the same name at all sizes
    return zlib.crc32(scene.encode()) % folds


def jobs_of(sets):
    return [(frame, colour, name) for name, frames in sets.items() for frame in frames for colour in ("colour", "grey")]


def run_tool(tool, work, jobs, files, *options, parts=2):
    """The tool's output for each job. files(i): the files of job i. Runs `parts` processes; @ is replaced by the
    process's number."""
    processes = []
    for part in range(parts):
        lines = [f"{frame} {colour} {files(i)}\n" for i, (frame, colour, _) in enumerate(jobs) if i % parts == part]
        (work / f"jobs{part}").write_text("".join(lines))
        command = [tool, work / f"jobs{part}", *(str(o).replace("@", str(part)) for o in options)]
        processes.append(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
    rows = [None] * len(jobs)
    for part, process in enumerate(processes):
        out, _ = process.communicate()
        if process.returncode:
            sys.exit(process.returncode)
        for line in out.splitlines():
            row = line.split(" ")
            rows[parts * int(row[0]) + part] = row
    return rows


class Nodes:
    """Trees in the library's layout: a node's two branches are adjacent."""

    def __init__(self, base):
        self.base, self.roots, self.nodes = base, [], []

    def add(self, tree):
        def fill(at, node):
            if "leaf" in node:
                self.nodes[at] = (-1, 0, node["leaf"])
                return
            branch = {child["nodeid"]: child for child in node["children"]}
            below = len(self.nodes)
            self.nodes += [None, None]
            self.nodes[at] = (int(node["split"][1:]), below, node["split_condition"])
            fill(below, branch[node["yes"]])
            fill(below + 1, branch[node["no"]])

        self.roots.append(len(self.nodes))
        self.nodes.append(None)
        fill(self.roots[-1], tree)

    def write(self, path):
        with open(path, "w") as out:
            out.write(f"{self.base:.9g} {len(self.roots)} {len(self.nodes)}\n" + " ".join(map(str, self.roots)) + "\n")
            out.writelines(f"{feature} {below} {value:.9g}\n" for feature, below, value in self.nodes)


def by_edges():
    """Initial score: the edge between two regions, and their step in disparity."""
    trees = Nodes(0.0)
    for feature, steps in ((2, [0.5 * k for k in range(1, 80)]), (11, [0.25 * k for k in range(1, 40)])):
        for step in steps:
            at = len(trees.nodes)
            trees.roots.append(at)
            trees.nodes += [(feature, at + 1, step), (-1, 0, 0.1), (-1, 0, -0.1)]
    return trees


SCORE = {"objective": "binary:logistic", "base_score": 0.5, "lambda": 2.0}
BIAS = {"objective": "reg:pseudohubererror", "huber_slope": 0.2, "base_score": 0.0, "lambda": 3.0}


def fitted(labels, weights, features, shape, goal=SCORE):
    """`shape`: number of trees, their depth, least weight of a leaf, learning rate."""
    trees, depth, least_weight, eta = shape
    import xgboost  # only this function needs it

    data = xgboost.DMatrix(features, label=labels, weight=weights)
    model = xgboost.train(
        {**goal, "max_depth": depth, "eta": eta, "subsample": 0.7, "colsample_bytree": 0.6,
         "min_child_weight": least_weight, "tree_method": "hist", "seed": SEED, "nthread": 2}, data, trees)
    nodes = Nodes(0.0)
    nodes.predict = lambda values: model.predict(xgboost.DMatrix(values))
    nodes.gains = model.get_score(importance_type="total_gain")
    for tree in model.get_dump(dump_format="json"):
        nodes.add(json.loads(tree))
    return nodes


class Fitting:
    def __init__(self, tool, work, hints, folds, sets):
        self.tool, self.work, self.hints, self.folds = tool, work, hints, folds
        names = subprocess.run([tool, "--names"], capture_output=True, text=True, check=True).stdout
        self.pair_features, self.region_features, self.bias_features, self.plane_features, self.floor_features = (
            part.splitlines() for part in names.split("\n\n"))
        self.gains = {}
        self.without = ()
        self.met_by_edges = False
        self.of_library = False  # find objects by the library's network and trees
        self.jobs = jobs_of(sets)
        self.fold = np.array([fold_of(frame, folds) for frame, _, _ in self.jobs])
        self.weight = np.array([1 if name in ("worlds", "wide streets") else ROOM_WEIGHT for _, _, name in self.jobs])

    def run(self, trees, *options, jobs=None):
        """trees(i): the two files of job i."""
        def files(i):
            return " ".join(map(str, ("-" if self.of_library else self.hints, *trees(i))))

        return run_tool(self.tool, self.work, self.jobs if jobs is None else jobs, files, *options)

    def records(self, name, features, share=1.0):
        heads, values = [], []
        for part in range(2):
            all_ = np.fromfile(self.work / f"{name}{part}", dtype=np.float32).reshape(-1, 3 + features)
            if share < 1:
                all_ = all_[np.random.RandomState(SEED + part).rand(len(all_)) < share]
            head = all_[:, :3].copy()
            head[:, 0] = 2 * head[:, 0] + part
            heads.append(head)
            values.append(all_[:, 3:])
        values = np.concatenate(values)
        names = {"regions": self.region_features, "bias": self.bias_features, "planes": self.plane_features,
                 "floor": self.floor_features}.get(name, self.pair_features)
        for i, feature in enumerate(names):
            # Features from hints count as cues of the hints only.
            if any(word in feature for word in self.without) and ("hints:" in self.without or "hints:" not in feature):
                values[:, i] = 0  # constant, so no tree splits on it
        return np.concatenate(heads), values

    def model(self, kind, fold):
        return self.work / f"{kind}_{fold}"

    def fit_pairs(self):
        if not self.met_by_edges:  # does not depend on the fit
            by_edges().write(self.work / "by_edges")
            self.run(lambda i: (self.work / "by_edges", "-"), "--pairs", self.work / "pairs_by_edges@")
            self.met_by_edges = True
        seen = []
        for round_, name in enumerate(("pairs_by_edges", "pairs")):
            if round_ == 1:
                self.run(self.of_fold_pairs, "--pairs", self.work / "pairs@")
            seen.append(self.records(name, len(self.pair_features), PAIRS_KEPT))
            head = np.concatenate([h for h, _ in seen])
            features = np.concatenate([f for _, f in seen])
            job = head[:, 0].astype(int)
            weights = head[:, 2] * self.weight[job]
            for fold in [*range(self.folds), *(["all"] if round_ == 1 else [])]:
                take = self.fold[job] != fold if fold != "all" else job >= 0
                model = fitted(head[take, 1], weights[take], features[take], (PAIR_TREES, PAIR_DEPTH, 20, 0.12))
                model.write(self.model("same_thing", fold))
                self.gains["same_thing"] = shares_of(model.gains, self.pair_features)
                say(f"pairs, round {round_ + 1}, without fold {fold}: {take.sum()} of them")

    def of_fold_pairs(self, i):
        return self.model("same_thing", self.fold[i]), "-"

    def of_fold(self, i):
        return self.model("same_thing", self.fold[i]), self.model("whole_object", self.fold[i])

    def of_all(self, _):
        return self.model("same_thing", "all"), self.model("whole_object", "all")

    def fit_regions(self):
        self.run(self.of_fold_pairs, "--regions", self.work / "regions@")
        head, features = self.records("regions", len(self.region_features))
        job = head[:, 0].astype(int)
        # Label 0.5 from half of the object, 1 from three quarters.
        labels = 0.5 * (head[:, 1] >= 0.5) + 0.5 * (head[:, 1] >= 0.75)
        for fold in [*range(self.folds), "all"]:
            take = self.fold[job] != fold if fold != "all" else job >= 0
            model = fitted(labels[take], self.weight[job][take], features[take],
                           (REGION_TREES, REGION_DEPTH, 15, 0.07))
            model.write(self.model("whole_object", fold))
            self.gains["whole_object"] = shares_of(model.gains, self.region_features)
            say(f"regions, without fold {fold}: {take.sum()} of them")

    def fit_planes(self, trees):
        """trees(i): the files of job i. The label is the share of the pixels that are right on the plane."""
        self.run(trees, "--planes", self.work / "planes@")
        head, features = self.records("planes", len(self.plane_features), PLANES_KEPT)
        weights = self.weight[head[:, 0].astype(int)] * np.sqrt(head[:, 2])
        model = fitted(head[:, 1], weights / weights.mean(), features, (PLANE_TREES, PLANE_DEPTH, 20, 0.12))
        model.write(self.model("right_plane", "all"))
        self.gains["right_plane"] = shares_of(model.gains, self.plane_features)
        say(f"planes: {len(head)} of them")

    def fit_floor(self, trees):
        """trees(i): the files of job i. The label is the share of a group's pixels that show the floor."""
        self.run(trees, "--floor", self.work / "floor@")
        head, features = self.records("floor", len(self.floor_features))
        weights = self.weight[head[:, 0].astype(int)] * head[:, 2]
        model = fitted(head[:, 1], weights / weights.mean(), features, (FLOOR_TREES, FLOOR_DEPTH, 5, 0.1))
        model.write(self.model("shows_floor", "all"))
        self.gains["shows_floor"] = shares_of(model.gains, self.floor_features)
        say(f"floor: {len(head)} groups")

    def fit_bias(self, trees, sequences, checked_jobs):
        """Fits the trees that correct the disparities of found objects. Returns a table of the errors before and after:
        of the fit set and the sequences in folds, of the others by the trees fitted to all. trees(i, jobs):
        the files of job i."""
        def objects(jobs):
            self.run(lambda i: trees(i, jobs), "--bias", self.work / "bias@", jobs=jobs)
            return self.records("bias", len(self.bias_features))

        head, features = objects(None)
        if sequences:
            more, more_features = objects(sequences)
            more[:, 0] += len(self.jobs)
            head, features = np.concatenate([head, more]), np.concatenate([features, more_features])
        jobs = self.jobs + sequences
        job, bias = head[:, 0].astype(int), head[:, 1]
        object_fold = np.array([fold_of(frame, self.folds) for frame, _, _ in jobs])[job]
        left = bias.copy()
        for fold in [*range(self.folds), "all"]:
            take = object_fold != fold if fold != "all" else job >= 0
            model = fitted(np.clip(bias[take], -LARGEST_ERROR, LARGEST_ERROR), np.ones(take.sum()), features[take],
                           (BIAS_TREES, BIAS_DEPTH, 10, 0.1), BIAS)
            say(f"disparities, without fold {fold}: {take.sum()} objects")
            if fold != "all":
                left[~take] -= beyond_doubt(model.predict(features[~take]))
        model.write(self.model("disparity_bias", "all"))
        self.gains["disparity_bias"] = shares_of(model.gains, self.bias_features)
        checked, features = objects(checked_jobs)
        return BIAS_HEAD + bias_rows(jobs, head, left) + bias_rows(
            checked_jobs, checked, checked[:, 1] - beyond_doubt(model.predict(features)))


def beyond_doubt(bias):
    """As refine_objects() uses it."""
    return np.sign(bias) * np.clip(np.abs(bias) - DOUBT, 0, MOST_CORRECTION)


BIAS_HEAD = """| frames | input | objects | error, px | corrected | objects at 2–4 m | error, cm: median / 90 % | corrected |
|---|---|---:|---:|---:|---:|---:|---:|
"""


def bias_rows(jobs, head, left):
    job, bias, px_per_m = head[:, 0].astype(int), head[:, 1], head[:, 2]
    focal_baseline = np.array([focal_times_baseline(jobs[i][0]) for i in job])
    depth = np.sqrt(focal_baseline / px_per_m)

    def in_metres(off):
        """From disparities that are too small by `off`. Limited, since a depth needs a positive disparity."""
        least = 0.3
        return np.abs(focal_baseline / np.maximum(px_per_m * depth - off, least) - depth)

    rows = ""
    for name, colour in dict.fromkeys((name, colour) for _, colour, name in jobs):
        mine = np.array([jobs[i][1:] == (colour, name) for i in job], bool)
        near = mine & (depth >= 2) & (depth <= 4)
        if near.sum() == 0:
            continue
        pixels = [f"{np.mean(np.minimum(np.abs(off[mine]), LARGEST_ERROR)):.3f}" for off in (bias, left)]
        metres = [f"{100 * np.median(e):.1f} / {100 * np.quantile(e, 0.9):.1f}"
                  for e in (in_metres(bias)[near], in_metres(left)[near])]
        rows += f"| {name} | {colour} | {mine.sum()} | {pixels[0]} | {pixels[1]} | {near.sum()} | {metres[0]} | {metres[1]} |\n"
    return rows


@functools.cache
def focal_times_baseline(frame):
    values = dict(line.split("=") for line in (frame / "calib.txt").read_text().splitlines() if "=" in line)
    return float(values["fx"]) * float(values["baseline"])


def shares_of(gains, names):
    """Share of each feature in the gain of all splits, largest first."""
    total = sum(gains.values()) or 1.0  # 0: nothing was worth a split
    shares = [(gains.get(f"f{i}", 0.0) / total, name) for i, name in enumerate(names)]
    return sorted(shares, key=lambda item: (-item[0], item[1]))


def gains_table(fitting, kind, header):
    rows = [f"| {name} | {100 * share:.1f} |" for share, name in fitting.gains[kind] if share >= 0.005]
    return f"| {header} | share of the gain, % |\n|---|---:|\n" + "\n".join(rows)


def frames_used(sets):
    return "Fitted to: " + ", ".join(f"{name} {len(frames)}" for name, frames in sets.items()) + \
        "; each frame once in colour and once in grey. *worlds*, and *wide streets* as a car sees them: [worlds](worlds.md) that the network has not seen.\n"


def page_of_distances(fitting, sets, distances):
    masks = ("the library's trees, which have seen most of these scenes" if fitting.of_library
             else "trees fitted without their scene")
    return f"""# Fitted distances

<!-- Written by ./dev fit; do not edit. -->

This page reports how well the fitted trees of [`refine_objects()`](stages/objects.md#its-disparity-refined) correct the disparity of an object.
{frames_used(sets)}Also fitted to every fourth frame of the rendered sequences.
An error is the difference between the object's disparity, with the shift by the images, and the median true disparity of the true object that it overlaps by an IoU of 0.5 or more. The objects are found by {masks}.
Frames of the fit set and of sequences are corrected by trees fitted without their scene, in {fitting.folds} folds. The others are corrected by the library's trees.
Errors in px: means, each error counted as {LARGEST_ERROR} px at most. A correction is reduced by {DOUBT} px.

{distances}
## Features of an object

{len(fitting.bias_features)} features, {BIAS_TREES} trees of depth {BIAS_DEPTH}.

{gains_table(fitting, "disparity_bias", "feature")}
"""


def page(fitting, sets, reports, score):
    return f"""# Fitted models

<!-- Written by ./dev fit; do not edit. -->

This page reports how well the preset `default` finds objects with its fitted trees ([grouping](stages/grouping.md)) and the network of its [hints](stages/object_hints.md). `./dev fit` fits both and writes them and this page: the same frames give the same numbers on the same processor.
{frames_used(sets)}Frames of the fit set are scored by trees fitted without their scene, in {fitting.folds} folds. The others are scored by the library's trees: the [yardstick](worlds.md#the-yardstick), by which choices are made, and real frames, to which nothing is fitted. [Accuracy](accuracy.md) reports validation.
In brackets: Wilson's 95 % interval. ms: one core's time for the median frame, from the merge tree to the choice of objects, on a shared machine.
`objects.min_confidence` = {score}.

{reports}

## Features of a pair of regions

{len(fitting.pair_features)} features, {PAIR_TREES} trees of depth {PAIR_DEPTH}. The tables omit features that gain less than 0.5 %.

{gains_table(fitting, "same_thing", "feature")}

## Features of a region

{len(fitting.region_features)} features, {REGION_TREES} trees of depth {REGION_DEPTH}.

{gains_table(fitting, "whole_object", "feature")}
"""


def share_of(hits, of):
    return f"{hits}/{of} = " + (f"{hits / of:.2f}" if of else "–")


def share_with_interval(hits, of):
    """The share with its 95 % Wilson interval."""
    if of == 0:
        return "–"
    p, z = hits / of, 1.96
    middle = (p + z * z / (2 * of)) / (1 + z * z / of)
    reach = z / (1 + z * z / of) * math.sqrt(p * (1 - p) / of + z * z / (4 * of * of))
    return f"{p:.2f} ({max(0, middle - reach):.2f} … {min(1, middle + reach):.2f})"


def report(rows, jobs):
    lines = ["| frames | input | objects | found .5 | found .75 | precision | median E, % | phantoms per frame | precision at confidence ≥ .8 | ms |",
             "|---|---|---:|---|---|---|---:|---:|---|---:|"]
    for name in dict.fromkeys(name for _, _, name in jobs):
        for colour in ("colour", "grey"):
            mine = [row for row, job in zip(rows, jobs) if job[1:] == (colour, name)]
            if not mine:
                continue
            iou = np.array([float(v) for row in mine for v in row[6][1:].split(",") if v])
            complete = [row for row in mine if row[2] == "0"]
            ours, right, phantoms = (sum(int(row[k]) for row in complete) for k in (3, 4, 5))
            scores = [v.split(":") for row in complete for v in row[7][1:].split(",") if v]
            sure = [int(v[1]) for v in scores if float(v[0]) >= 0.8]
            error = np.minimum(1 / np.maximum(iou, 1e-9) - 1, 2)
            lines.append(f"| {name} | {colour} | {len(iou)} | {share_with_interval((iou >= .5).sum(), len(iou))} | "
                         f"{share_with_interval((iou >= .75).sum(), len(iou))} | {share_with_interval(right, ours)} | "
                         f"{100 * np.median(error):.0f} | {phantoms / max(1, len(complete)):.2f} | "
                         f"{share_with_interval(sum(sure), len(sure))} | {np.median([float(row[8]) for row in mine]):.1f} |")
    return "\n".join(lines)


def stages(rows, jobs):
    """At which stage objects are lost, by their area: no set of superpixels has an IoU of 0.5, no region in the tree, or the best region
    is not chosen."""
    lines = ["| frames | input | area, px | objects | superpixels | regions in the tree | found | not found with such a region: median of its scores |",
             "|---|---|---|---:|---|---|---|---|"]
    for name, colour in dict.fromkeys((name, colour) for _, colour, name in jobs):
        # Of each object: IoU as found, area, IoU of superpixels and of a region, score of the region.
        objects = np.array([[float(iou), *map(float, known.split(":"))] for row, job in zip(rows, jobs) if job[1:] == (colour, name)
                            for iou, known in zip(row[6][1:].split(","), row[9][1:].split(",")) if iou])
        bounds = (0, 400, 768, 1536, 4000, math.inf) if colour == "colour" else ()
        for least, beyond in [*zip(bounds, bounds[1:]), (0, math.inf)]:
            iou, area, of_superpixels, of_region, score = objects[(least <= objects[:, 1]) & (objects[:, 1] < beyond)].T
            if len(iou) == 0:
                continue
            shares = " | ".join(f"{np.mean(values >= 0.5):.2f} ({np.mean(values >= 0.75):.2f})" for values in (of_superpixels, of_region, iou))
            lost = score[(iou < 0.5) & (of_region >= 0.5)]
            size = "all" if (least, beyond) == (0, math.inf) else f"{least} … {beyond}"
            lines.append(f"| {name} | {colour} | {size} | {len(iou)} | {shares} | {len(lost)}: {np.median(lost) if len(lost) else 0:.2f} |")
    return "\n".join(lines)


def ablation(fitting, checked, path):
    """Refits without one kind of cue at a time and counts the objects found on the yardstick and the real frames."""
    names = {"all frames": lambda name: True, "yardstick": lambda name: "yardstick" in name,
             "tabletops": lambda name: "rc" in name, "Middlebury": lambda name: "middlebury" in name}
    lines = ["| without | " + " | ".join(f"{name}, {colour}" for name in names for colour in ("colour", "grey")) +
             " | precision |", "|---|" + "---|" * (2 * len(names) + 1)]
    for cue, words in {"–": (), **CUES}.items():
        fitting.without = words
        fitting.fit_pairs()
        fitting.fit_regions()
        rows = fitting.run(fitting.of_all, "--min-score", MIN_SCORE, jobs=checked)
        cells = []
        for chosen in names.values():
            for colour in ("colour", "grey"):
                iou = np.array([float(v) for row, job in zip(rows, checked) if chosen(job[2]) and job[1] == colour
                                for v in row[6][1:].split(",") if v])
                cells.append(share_of((iou >= .5).sum(), len(iou)))
        complete = [row for row in rows if row[2] == "0"]
        right, ours = sum(int(row[4]) for row in complete), sum(int(row[3]) for row in complete)
        lines.append(f"| {cue} | " + " | ".join(cells) + f" | {share_of(right, ours)} |")
        say(lines[-1])
    path.write_text(f"""# Contribution of each cue

<!-- Written by ./dev fit --ablation; do not edit. -->

This page shows how much each kind of cue contributes: objects found (IoU ≥ 0.5) on the [yardstick](worlds.md#the-yardstick) and on real frames, in colour and in grey, after fitting both sets of trees again without the features of one kind.
The trees were fitted to {len(fitting.jobs) // 2} frames, in {fitting.folds} folds; the [hints](stages/object_hints.md) come from the network of the library. A difference of fewer than about 15 of the yardstick's objects, or of three of the real frames', is within chance.

""" + "\n".join(lines) + "\n\n" + "\n".join(
        f"- **{cue}**: features whose names contain " + ", ".join(f"“{word}”" for word in words) + "."
        for cue, words in CUES.items()) + "\n")


begin = time.time()


def say(text):
    print(f"{time.time() - begin:6.0f} s  {text}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tool", type=pathlib.Path)
    parser.add_argument("worlds", type=pathlib.Path, help="frames that the network has not seen")
    parser.add_argument("--streets", type=pathlib.Path, help="more of them: streets as a car sees them")
    parser.add_argument("--data", type=pathlib.Path, help="the data collection: rendered rooms are added to the fit")
    parser.add_argument("--yardstick", type=pathlib.Path, help="frames that are only reported")
    parser.add_argument("--folds", type=int, default=2)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("build/fit"))
    parser.add_argument("--hints", type=pathlib.Path, help="the fitted network, if not that of the work folder; -: the library's")
    parser.add_argument("--out", type=pathlib.Path, help="where the sources are written (cairn)")
    parser.add_argument("--page", type=pathlib.Path, help="where the report is written (docs/fitting.md)")
    parser.add_argument("--distances", action="store_true", help="fit only the trees that correct disparities")
    parser.add_argument("--planes", action="store_true", help="fit only the trees that choose planes of disparity")
    parser.add_argument("--floor", action="store_true", help="fit only the trees that recognise the floor")
    parser.add_argument("--stages", action="store_true", help="only print at which stage the library loses the objects of the yardstick")
    parser.add_argument("--distances-page", type=pathlib.Path,
                        help="where their report is written (docs/fitted_distances.md)")
    parser.add_argument("--ablation", type=pathlib.Path, help="where the ablation report is written")
    parser.add_argument("--min-scores", default=MIN_SCORE, help="thresholds for the report; the page shows the first")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    sets = fit_sets(arguments.worlds, arguments.data, arguments.streets)
    fitting = Fitting(arguments.tool, arguments.work, arguments.hints or arguments.work / "hints", arguments.folds, sets)
    say(f"{len(fitting.jobs)} frames, colour and grey")
    checked = jobs_of(checked_sets(arguments.yardstick, arguments.data))
    if arguments.stages:
        fitting.of_library = True
        return print(stages(fitting.run(lambda i: ("-", "-"), jobs=checked), checked))
    tracked = jobs_of(sequences(arguments.data))
    if arguments.ablation:
        return ablation(fitting, checked, arguments.ablation)

    def write_fitted(kind):
        if not arguments.out:
            return
        lines = fitting.model(kind, "all").read_text().split("\n")
        nodes = [(int(f), int(b), float(v)) for f, b, v in (line.split() for line in lines[2:] if line)]
        fitted_files.write_trees(arguments.out / f"{kind}.bin", float(lines[0].split()[0]), [int(v) for v in lines[1].split()], nodes)

    fitting.of_library = arguments.distances or arguments.planes or arguments.floor
    for wanted, fit, kind in ((arguments.planes, fitting.fit_planes, "right_plane"),
                              (arguments.floor, fitting.fit_floor, "shows_floor")):
        if wanted:
            fit(lambda i: ("-", "-"))
            print(gains_table(fitting, kind, "feature"))
            write_fitted(kind)
    if arguments.planes or arguments.floor:
        return None
    if arguments.distances:
        distances = fitting.fit_bias(lambda i, jobs: ("-", "-"), tracked, checked)
    else:
        fitting.fit_pairs()
        fitting.fit_regions()
        distances = fitting.fit_bias(
            lambda i, jobs: fitting.of_fold(i) if jobs is None else fitting.of_all(i), tracked, checked)
        for score in arguments.min_scores.split(","):
            rows = fitting.run(fitting.of_fold, "--min-score", score)
            others = fitting.run(fitting.of_all, "--min-score", score, jobs=checked)
            print(f"\nobjects.min_confidence={score}; fit set in {arguments.folds} folds by scene\n")
            reports = report(rows, fitting.jobs) + "\n\n" + report(others, checked)
            print(reports, flush=True)
            if arguments.page and score == arguments.min_scores.split(",")[0]:
                arguments.page.write_text(page(fitting, sets, reports, score))
        write_fitted("same_thing")
        write_fitted("whole_object")
        fitting.fit_planes(fitting.of_fold)
        write_fitted("right_plane")
    print(distances)
    write_fitted("disparity_bias")
    if arguments.distances_page:
        arguments.distances_page.write_text(page_of_distances(fitting, sets, distances))
    say("done")


if __name__ == "__main__":
    main()
