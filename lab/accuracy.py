#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Measures everything that needs ground truth, in one run; writes DOCS/accuracy.md and DOCS/images/accuracy/.

    accuracy.py DATA DOCS COMMIT [THREADS]          (with PYTHONPATH at the built module)
    accuracy.py DATA --only FOLDER [THREADS]        prints the table of one frame set, such as rendered/dev/320x240

DATA is the folder with real/ and rendered/; COMMIT is the commit that the page names. All files are written at the end,
after the last measurement. Exit code 2: no data.
"""
import collections
import concurrent.futures
import datetime
import functools
import json
import math
import os
import pathlib
import sys
import threading
import time

import numpy as np

import cairn
import report
from fit import LARGER
from report import number, percent, table

COLOURS = {"paper": "#888888", "default": "#d1495b"}

# To add a row, add a line of space-separated options, as for --set; "input=grey" drops the colour; "preset=paper",
# which must be first, selects that preset. Options on which the presets differ get a row automatically: see
# all_ablations().
ABLATIONS = {
    "match.method=window": "paper: matching of windows",
    "semi_global.penalty_edge=0": "a step costs the same at intensity edges",
    "subpixel.method=parabola": "paper: the parabola through three costs",
    "subpixel.method=none": "whole pixels",
    "left_right.max_diff=1": "paper: 1 px",
    "left_right.max_diff=-1": "no left-right check",
    "left_right.method=vote": "OpenCV's left-right check",
    "uniqueness.ratio=10": "paper: the check is on",
    "flatness.threshold=0.1": "paper: the check is on",
    "texture.threshold=2": "paper: the check is on",
    "ground.source=off": "no ground: reflections stay, the floor is an ordinary surface",
    "speckle.size=-1": "paper: speckles stay",
    "background.max_walls=0": "the floor is the only background",
    "input=grey": "images without colour",
    "superpixels.count=75": "half as many superpixels",
    "superpixels.count=300": "twice as many superpixels",
    "pipeline.method=paper": "paper: the two segmentations and their overlap",
    "objects.min_confidence=0": "paper: every remaining region is an object",
    "objects.min_area=0.5": "paper",
}
# The paper's text has neither a floor label nor gradient thresholds.
AS_PRINTED = "preset=paper ground.label_floor=false intensity.gradient_threshold=0 disparity.gradient_threshold=0"

# Series of one degradation, mild to severe: label of the plot's x axis, whether x is numeric, {folder: (x, label)}.
STRESSES = {
    "reflectivity": ("mirror share of the floor", True, {"floor_0.0": (0, "0"), "floor_0.3": (0.3, "0.3"), "floor_0.6": (0.6, "0.6")}),
    "gain_offset": ("right image: gain, offset", False, {
        "gain_0.80_offset_-8": (0, "0.8,−8"), "gain_1.00_offset_+0": (1, "1,0"), "gain_1.00_offset_+20": (2, "1,20"),
        "gain_1.10_offset_+5": (3, "1.1,5"), "gain_1.25_offset_+12": (4, "1.25,12")}),
    "noise": ("noise, σ in grey levels", True, {"noise_0": (0, "0"), "noise_4": (4, "4"), "noise_8": (8, "8")}),
    "vertical_shift": ("right image lower by, px", True, {"vshift_0": (0, "0"), "vshift_0.5": (0.5, "0.5"), "vshift_1": (1, "1"), "vshift_2": (2, "2")}),
    "texture": ("texture", False, {"repetitive": (0, "repetitive"), "floor_0.3": (1, "as it is"), "lowtexture": (2, "low")}),
    "dim_light": ("light (each step about a third)", True, {"dim_1.00": (0, "1"), "dim_0.35": (1, "0.35"), "dim_0.12": (2, "0.12"), "dim_0.05": (2.83, "0.05")}),
}
STRESSED = [f"rendered/stress/base{i}" for i in range(3)]
SEQUENCES = ["dev_seqA", "dev_seqB"]
MIDDLEBURY = [f"real/middlebury{year}" for year in (2001, 2003, 2005, 2006, 2014)]
FRAME_SETS = {"Rendered, 320x240": "rendered/dev/320x240", "Rendered, 640x480": "rendered/dev/640x480",
              "rc_tabletop, real, 640x480": "real/rc_tabletop"}
YARDSTICK = pathlib.Path("build/fit/yardstick").resolve()  # made by ./dev worlds yardstick
SPLITS = {  # folders, and what they are used for
    "train 320x240": (["rendered/train/320x240"], "fit"), "train_outdoor": (["rendered/train_outdoor/320x240"], "fit"),
    "train_outdoor, larger": ([f"rendered/train_outdoor/{size}" for size in LARGER], "fit"),
    "dev 320x240": (["rendered/dev/320x240"], "fit"), "dev 640x480": (["rendered/dev/640x480"], "fit"),
    **{f"yardstick {place}": ([YARDSTICK / place], "choices") for place in ("indoors", "outdoors", "large")},
    "rc_tabletop": (["real/rc_tabletop"], "choices"), "Middlebury": (MIDDLEBURY, "choices"),
    **{f"validate{kind} 320x240": ([f"rendered/validate{kind}/320x240"], "reports") for kind in ("", "_varied", "_models", "_outdoor")},
    "validate_outdoor, larger": ([f"rendered/validate_outdoor/{size}" for size in LARGER], "reports"),
    "validate 640x480": (["rendered/validate/640x480"], "reports"),
    "validate rc_tabletop": (["real/validate/rc_tabletop"], "reports"), "validate Middlebury": (["real/validate/middlebury"], "reports"),
    "real streets": (["real/outdoor_fit"], "choices"), "validate real streets": (["real/validate_outdoor"], "reports"),
}


def folders_read():
    stress = [f"{scene}/{name}" for scene in STRESSED for name in ["gt", *(v for s in STRESSES.values() for v in s[2])]]
    return [*FRAME_SETS.values(), *(f for folders, _ in SPLITS.values() for f in folders), *(f"rendered/dev/sequences/{s}" for s in SEQUENCES), *stress]


# ---- frames and scores ----


class TrueFrame:
    """A pair with its ground truth, in the pair's folder or in ../gt."""

    def __init__(self, folder):
        truth = folder if any((folder / name).exists() for name in ("objects.png", "disp_left.png")) else folder.parent / "gt"
        calib = next(f for f in (folder / "calib.txt", truth / "calib.txt") if f.exists())
        self.name, self.truth_folder = folder.name, truth
        self.left, self.right = cairn.load_pair(folder / "left.png", folder / "right.png")
        self.calibration = cairn.load_calibration(calib)
        self.num_disparities = self.calibration.num_disparities or 64
        read = lambda name, load: load(truth / name) if (truth / name).exists() else None
        self.truth_px = read("disp_left.png", cairn.load_disparity)
        self.hidden = read("occlusion.png", lambda file: (cairn.load_labels(file) == 255).astype(np.uint8))
        self.objects = read("objects.png", lambda file: cairn.load_labels(file).astype(np.int32))
        if self.objects is not None:
            self.objects[self.objects == 255] = -1  # don't care
        self.partial = (truth / "partial").exists()

    @functools.cached_property
    def grey(self):  # the library's formula: (77 R + 150 G + 29 B + 128) >> 8
        return self.left if self.left.ndim == 2 else ((self.left @ np.array([77, 150, 29], np.uint32) + 128) >> 8).astype(np.uint8)

    def segment(self, config, grey=False, **more):
        return cairn.segment(self.grey if grey else self.left, self.right, self.calibration, config=config,
                             match={"num_disparities": self.num_disparities}, **more)


def load_frames(folder):
    return [TrueFrame(f) for f in sorted(folder.iterdir()) if (f / "left.png").exists()]


MIN_REFINED = 0.3  # kMinRefined of cairn/regions/refine_disparity.hpp
Score = collections.namedtuple("Score", "objects partial disparity ms")
THREAD = threading.local()


def on_one_core(work):
    """Result of `work` on one thread of the library, and its processor time in ms."""
    if not hasattr(THREAD, "exec"):
        THREAD.exec = cairn.Exec(threads=1)
    start = time.thread_time()
    made = work(THREAD.exec)
    return made, 1000 * (time.thread_time() - start)


def score(frame, config, grey):
    found, ms = on_one_core(lambda one: frame.segment(config, grey, exec=one))
    objects = None if frame.objects is None else cairn.object_errors(found.objects_map, frame.objects)
    disparity = None if frame.truth_px is None else cairn.disparity_errors(found.disparity, frame.truth_px, frame.hidden)
    return Score(objects, frame.partial, disparity, ms)


def on_all(frames, work, threads):
    with concurrent.futures.ThreadPoolExecutor(threads) as pool:
        return list(pool.map(work, frames))


def score_all(frames, config, grey, threads):
    return on_all(frames, lambda frame: score(frame, config, grey), threads)


def share(part, whole):
    return part / whole if whole else math.nan


class Summary:
    """Scores of many frames, aggregated. Frames with partial truth cannot count an object of ours as wrong."""

    def __init__(self, scores):
        iou = [t.iou for s in scores if s.objects for t in s.objects.truth]
        errors = [min(t.error, 2) for s in scores if s.objects for t in s.objects.truth]
        complete = [s.objects for s in scores if s.objects and not s.partial]
        ours = cairn.summarise(complete)
        self.true_objects, self.our_objects = len(iou), ours.our_objects
        self.found_50, self.found_75 = (sum(i >= least for i in iou) for least in (0.5, 0.75))
        self.right_50 = round(ours.precision_50 * ours.our_objects) if ours.our_objects else 0
        self.recall_50, self.recall_75 = share(self.found_50, len(iou)), share(self.found_75, len(iou))
        self.precision_50 = share(self.right_50, self.our_objects)
        self.median_error = float(np.median(errors)) if errors else math.nan
        self.mean_error = float(np.mean(errors)) if errors else math.nan
        self.boundary_f = float(np.mean([t.boundary_f for s in scores if s.objects for t in s.objects.truth])) if iou else math.nan
        self.phantoms_per_frame = share(ours.phantoms, len(complete))
        self.density, self.bad_2 = math.nan, math.nan
        known = [s.disparity for s in scores if s.disparity is not None]
        if known:
            self.density = share(sum(d.matched for d in known), sum(d.known for d in known))
            self.bad_2 = share(sum(round(d.bad_of_matched[2.0] * d.matched) for d in known if d.matched), sum(d.matched for d in known))


# ---- presets and ablations ----


def configured(settings):
    """The configuration of "a.b=1 c.d=word input=grey", and whether the input is grey."""
    preset, grey, groups = "default", False, collections.defaultdict(dict)
    for setting in settings.split():
        name, value = setting.split("=")
        if name == "preset":
            preset = value
        elif name == "input":
            grey = True
        else:
            group, option = name.split(".")
            kind = next((o.type for o in cairn.options() if o.name == name), "")
            groups[group][option] = value if kind in ("choice", "") else json.loads(value)
    return cairn.Config(preset, **groups), grey


def all_ablations():
    """ABLATIONS, then one for every other option on which the presets differ."""
    named = {setting.split("=")[0] for settings in ABLATIONS for setting in settings.split()}
    text = lambda value: str(value).lower() if isinstance(value, bool) else f"{value:g}" if isinstance(value, float) else str(value)
    rest = {f"{ours.name}={text(paper.default)}": "paper" for ours, paper in zip(cairn.options(), cairn.options("paper"))
            if ours.default != paper.default and ours.active and ours.name not in named}
    return {**ABLATIONS, **rest}


def accuracy_cells(scores):
    s = Summary(scores)
    return [percent(s.recall_50), percent(s.recall_75), percent(s.precision_50), percent(s.median_error), percent(s.boundary_f),
            number(s.phantoms_per_frame, ".2f"), percent(s.density), percent(s.bad_2)]


def frame_set_section(title, frames, threads):
    runs = {"**as printed**": AS_PRINTED, "**paper**": "preset=paper", "**default**": "", **{f"`{s}`": s for s in all_ablations()}}
    as_default = score_all(frames, cairn.Config(), False, threads)
    rows, without_effect = [], []
    for name, settings in runs.items():
        scores = score_all(frames, *configured(settings), threads)
        cells = accuracy_cells(scores)
        if name[0] == "`" and cells == accuracy_cells(as_default):
            without_effect.append(name)
        else:
            rows.append([name, *cells, number(float(np.median([s.ms for s in scores])), ".0f")])
    objects = Summary(as_default).true_objects
    header = ["", "found 0.5, %", "found 0.75, %", "precision, %", "median E, %", "boundary F, %", "phantoms", "density, %", "bad-2, %", "ms"]
    text = f"### {title}\n\n{len(frames)} frames, {objects} scored objects: one object is {percent(1 / objects)} % of found.\n\n"
    text += table(header, rows) + "\n"
    return text + (f"The same figures as `default`: {', '.join(without_effect)}.\n\n" if without_effect else "")


# ---- fit and validation side by side ----


def share_text(part, whole):
    """The share in per cent with its 95 % Wilson interval."""
    if whole == 0:
        return "–"
    z, p = 1.96, part / whole
    scale = 1 + z * z / whole
    middle = (p + z * z / (2 * whole)) / scale
    reach = z / scale * math.sqrt(p * (1 - p) / whole + z * z / (4 * whole * whole))
    return f"{percent(p)} ({percent(max(0, middle - reach))} … {percent(min(1, middle + reach))})"


def splits(data, threads):
    rows = []
    for title, (folders, use) in SPLITS.items():
        frames = [frame for folder in folders for frame in load_frames(data / folder) if frame.objects is not None]
        for name, settings in {"default": "", "default, grey": "input=grey", "paper": "preset=paper input=grey"}.items():
            s = Summary(score_all(frames, *configured(settings), threads))
            rows.append([title, use, name, str(s.true_objects), share_text(s.found_50, s.true_objects),
                         share_text(s.found_75, s.true_objects), share_text(s.right_50, s.our_objects), percent(s.median_error),
                         number(s.phantoms_per_frame, ".2f")])
    header = ["frames", "used for", "preset", "objects", "found 0.5, %", "found 0.75, %", "precision, %", "median E, %", "phantoms"]
    return f"""## Fit and validation

Network and trees were fitted to the sets marked *fit* and to [worlds](worlds.md), so results there are optimistic; [fitted models](fitting.md) has worlds scored by trees fitted without them, and [failures](failures.md) shows what is missed. Options, cues and networks are chosen by the sets marked *choices*, above all the [yardstick](worlds.md#the-yardstick). The others are only reported. In brackets: Wilson's 95 % interval. Middlebury's objects are only partly labelled, so precision is undefined there.
Validation was scored eleven times since the fit to worlds, the last time with the [present network](worlds.md#surroundings), in the second table. Before, in colour (found .5, found .75, precision; –: not scored, or not kept):

| network and trees | validate 320x240 | varied | models | outdoor | real tables |
|---|---|---|---|---|---|
| trees fitted to worlds and `dev` alone | .88 .76 .81 | .55 .38 .76 | .69 .50 .79 | .66 .46 .92 | – |
| trees of the next fit | .86 .74 .83 | .59 .30 .81 | .71 .49 .82 | .66 .52 .89 | – |
| the same with 150 superpixels, for the [comparison](comparison.md#objects-the-usual-chain) | – | – | – | – | – |
| a wider network and its trees | .86 .76 .84 | .62 .43 .80 | .73 .57 .83 | .70 .56 .88 | .87 .67 .81 |
| fitted to [lids](worlds.md#lids) | .84 .74 .88 | .59 .43 .79 | .72 .50 .86 | .64 .56 .94 | .87 .60 .93 |
| [wider again](worlds.md#wider) | .86 .70 .88 | .62 .45 .76 | .73 .55 .82 | .64 .52 .91 | .87 .73 .87 |
| [mean of two](worlds.md#streets) | .86 .74 .86 | .66 .43 .80 | .74 .54 .86 | .70 .54 .88 | .87 .67 .93 |
| [orthogonal steps](worlds.md#orthogonal-steps) | .86 .80 .86 | .61 .38 .77 | .73 .56 .84 | .70 .56 .90 | .87 .67 .93 |
| [houses](worlds.md#houses-and-larger-images) | .90 .82 .87 | .70 .46 .85 | .76 .57 .87 | .68 .58 .90 | .93 .73 .82 |
| fitted on to [wide streets](failures.md#attempts-without-success), not taken | .88 .82 .88 | .63 .36 .80 | .77 .54 .89 | .66 .56 .97 | .93 .73 .82 |

Real streets, and streets of other sizes than 320x240, were scored only in the last three of these runs.

{table(header, rows, words=3)}
"""


# ---- the best, the median and the worst frame ----


def tinted(frame):
    """The left image with each true object tinted and its distance."""
    grey = frame.grey[..., None].repeat(3, 2).astype(float)
    for k, value in enumerate(v for v in np.unique(frame.objects) if v > 0):
        grey[frame.objects == value] = 0.5 * grey[frame.objects == value] + 127 * np.array(report.plt.cm.tab10(k % 10)[:3])
    return grey.astype(np.uint8)


def best_median_worst(frames, threads):
    scores = score_all(frames, cairn.Config(), False, threads)
    order = sorted(range(len(frames)), key=lambda i: Summary([scores[i]]).mean_error)
    text = ("## The best, the median and the worst frame\n\nRanked by the mean E of a frame's objects, over `rendered/dev/320x240` with `default`. "
            "The truth is on the left, the result on the right, with distances in metres; colours have no meaning.\n\n")
    made = {}
    for name, i in zip(("best", "median", "worst"), (order[0], order[(len(order) - 1) // 2], order[-1])):
        frame, rig = frames[i], frames[i].calibration.rig
        figure, axes = report.plt.subplots(1, 2, figsize=(8, 3.1))
        axes[0].imshow(tinted(frame))
        for value in (v for v in np.unique(frame.objects) if v > 0):
            rows, columns = np.nonzero(frame.objects == value)
            z = rig.focal_px * rig.baseline_m / (np.nanmedian(frame.truth_px[rows, columns]) + rig.doffs_px)
            axes[0].text(columns.mean(), rows.mean(), f"{z:.2f} m", color="white", ha="center")
        axes[1].imshow(frame.segment(cairn.Config()).overlay())
        for axis in axes:
            axis.axis("off")
        figure.tight_layout()
        made[f"{name}.png"] = figure
        text += (f"The {name}, {frame.name}: mean E {percent(Summary([scores[i]]).mean_error)} %.\n\n"
                 f"![truth and result of the {name} frame](images/accuracy/{name}.png)\n\n")
    return text, made


# ---- stress ----


def curves(columns):
    """Panels of a plot from {preset: [Summary]}."""
    panel = lambda title, end, value: (title, end, {p: (COLOURS[p], [value(s) for s in of]) for p, of in columns.items()})
    return panel


def stress(data, threads, plots):
    images, objects = "", 0
    for name, (title, is_strength, variants) in STRESSES.items():
        frames = [[TrueFrame(data / scene / variant) for scene in STRESSED] for variant in variants]
        of = {p: [Summary(score_all(f, cairn.Config(p), False, threads)) for f in frames] for p in COLOURS}
        objects = of["default"][0].true_objects
        panel = curves(of)
        panels = [panel("objects found (IoU ≥ 0.5), %", 100, lambda s: 100 * s.recall_50), panel("median E, % (200 = missed)", 200, lambda s: 100 * s.median_error),
                  panel("density, %", 100, lambda s: 100 * s.density), panel("bad-2 of the matched, %", None, lambda s: 100 * s.bad_2)]
        ticks = dict(variants.values())
        plots[f"stress_{name}.png"] = dict(x=list(ticks), panels=panels, x_title=title, ticks=ticks, lines=is_strength)
        images += f"![found, E, density and bad-2 against: {title}](images/accuracy/stress_{name}.png)\n\n"
    return ("## Under stress\n\nThree rendered scenes, 320x240, in which one condition at a time gets worse "
            f"(`rendered/stress`): {objects} scored objects: one object is {percent(1 / objects)} % of found. Disparity errors are over the pixels visible to both cameras.\n\n{images}")


# ---- Middlebury ----


def opencv_matchers():
    """{name: (settings, prepare(number of disparities))}; OpenCV wants multiples of 16."""
    import cv2

    cv2.setNumThreads(1)

    def block(n):
        matcher = cv2.StereoBM_create(n, 9)
        matcher.setDisp12MaxDiff(1)
        return matcher

    semi_global = lambda mode: lambda n: cv2.StereoSGBM_create(0, n, 5, 200, 800, 1, 63, 10, 100, 2, mode)
    return cv2.__version__, {
        "StereoBM": ("window 9, x-Sobel with cap 31, uniqueness 15, texture 10, left-right 1, no speckle filter", block),
        "StereoSGBM": ("block 5, P1 200, P2 800, prefilter cap 63, uniqueness 10, left-right 1, speckles 100 px within 2",
                       semi_global(cv2.STEREO_SGBM_MODE_SGBM)),
        "StereoSGBM HH": ("the same with 8 paths", semi_global(cv2.STEREO_SGBM_MODE_HH))}


def by_cairn(config, frame):
    made, ms = on_one_core(lambda one: cairn.estimate_disparity(frame.left, frame.right, frame.calibration, config=config, exec=one,
                                                                match={"num_disparities": frame.num_disparities}))
    return made.disparity, ms


def by_refinement(frame):
    """As `cairn disparity --refined`."""
    def work(one):
        made = frame.segment(None, grey=True, exec=one)
        return cairn.likely_disparities(made.refined, made.reject, MIN_REFINED).disparity_px

    return on_one_core(work)


def searched_by_opencv(num_disparities):
    """Rounded up: OpenCV searches multiples of 16."""
    return (num_disparities + 15) // 16 * 16


def by_opencv(prepare, frame):
    matcher = prepare(searched_by_opencv(frame.num_disparities))
    right = frame.right if frame.right.ndim == 2 else ((frame.right @ np.array([77, 150, 29], np.uint32) + 128) >> 8).astype(np.uint8)
    made, ms = on_one_core(lambda _: matcher.compute(frame.grey, right))
    return np.where(made < 0, np.nan, made / np.float32(16)).astype(np.float32), ms


def errors_of(match, frame):
    found_px, ms = match(frame)
    return [cairn.disparity_errors(found_px, frame.truth_px, frame.hidden, skip) for skip in (0, searched_by_opencv(frame.num_disparities))], ms


def middlebury(data, threads):
    frames = [frame for folder in MIDDLEBURY for frame in load_frames(data / folder)]
    version, theirs = opencv_matchers()
    matchers = {f"cairn, `{p}`": functools.partial(by_cairn, cairn.Config(p)) for p in COLOURS}
    matchers["cairn, `default`, refined"] = by_refinement
    matchers.update({f"OpenCV {name}": functools.partial(by_opencv, prepare) for name, (_, prepare) in theirs.items()})
    errors = {name: on_all(frames, functools.partial(errors_of, match), threads) for name, match in matchers.items()}

    def row(name, columns):  # means over the pairs, equally weighted
        of = [pair[columns] for pair, _ in errors[name]]
        figures = [[e.density for e in of]] + [[getattr(e, kind)[t] for e in of] for kind in ("bad_of_matched", "bad_of_known") for t in (1.0, 2.0)]
        return [name, *(percent(float(np.nanmean(f))) for f in figures), number(float(np.mean([ms for _, ms in errors[name]])), ".0f")]

    header = ["", "density, %", "bad-1, %", "bad-2, %", "bad-1 with holes, %", "bad-2 with holes, %", "ms"]
    pair = lambda e: f"{percent(e.bad_of_matched[2.0])} / {percent(e.density)}"
    pairs = [[frame.name, *(pair(errors[name][i][0][1]) for name in matchers)] for i, frame in enumerate(frames)]
    return f"""## Disparity on Middlebury

Means over {len(frames)} pairs of the Middlebury collections of 2001 to 2014, over the pixels visible to both cameras (Motorcycle: all pixels with truth); OpenCV {version} in the same run, grey images for all. bad-t: share of the matched pixels that are off by more than t px; with holes: share of all pixels, with holes counted as bad. *Refined*: the whole of [`cairn disparity --refined`](stages/refinement.md), objects included; the others are matchers alone.

Only columns x ≥ the number of disparities, since OpenCV's matchers leave the others empty:

{table(header, [row(name, 1) for name in matchers])}
All columns:

{table(header, [row(name, 0) for name in matchers if not name.startswith("OpenCV")])}
OpenCV's settings: {"; ".join(f"{name}: {settings}" for name, (settings, _) in theirs.items())}.

<details><summary>Pair by pair, columns x ≥ the number of disparities</summary>

{table(["bad-2, % / density, %", *matchers], pairs)}
</details>

"""


# ---- sequences ----


def percentile(values, part):
    """The smallest value that at least this share of the values does not exceed; NaN are ignored."""
    known = sorted(v for v in values if not math.isnan(v))
    return known[min(max(math.ceil(part * len(known)), 1), len(known)) - 1] if known else math.nan


def mean(values):
    return float(np.nanmean(values)) if any(not math.isnan(v) for v in values) else math.nan


def sequence_row(name, frames):
    """Means over the frames, and the 95th percentile."""
    cell = lambda values, form, more_is_better: f"{number(mean(values), form)} ({number(percentile(values, 0.05 if more_is_better else 0.95), form)})"
    of = lambda value: [100 * value(s) for s in frames]
    return [name, cell(of(lambda s: s.recall_50), ".0f", True), cell(of(lambda s: s.recall_75), ".0f", True), cell(of(lambda s: s.precision_50), ".0f", True),
            cell(of(lambda s: s.median_error), ".1f", False), cell([s.phantoms_per_frame for s in frames], ".2f", False),
            cell(of(lambda s: s.density), ".0f", True), cell(of(lambda s: s.bad_2), ".1f", False)]


def track_row(name, scores):
    """One true object over a sequence; scores: one per frame, None where it is out of view or too small to be
    scored."""
    iou = [s.iou if s else math.nan for s in scores]
    seen, found = sum(s is not None for s in scores), sum(i >= 0.5 for i in iou)
    merged = sum(s is not None and s.iou < 0.5 and s.under_segmented for s in scores)
    steps = [(before, now) for before, now in zip(iou, iou[1:])]
    falls = [before - now if before - now > 0 else 0 for before, now in steps]
    at = int(np.argmax(falls)) if falls else 0
    return [name, str(seen), str(found), str(seen - found), str(merged), str(sum(b >= 0.5 > n for b, n in steps)), number(percentile(iou, 0.5), ".2f"),
            number(mean([abs(n - b) for b, n in steps]), ".3f"), f"{falls[at]:.2f} at {at + 1}" if falls and falls[at] > 0 else "–"]


def sequences(data, threads, plots):
    rows, objects, images = [], [], ""
    for name in SEQUENCES:
        frames = load_frames(data / "rendered/dev/sequences" / name)
        summaries = {}
        for preset in COLOURS:
            scores = score_all(frames, cairn.Config(preset), False, threads)
            summaries[preset] = [Summary([s]) for s in scores]
            rows.append(sequence_row(f"{name}, `{preset}`", summaries[preset]))
        names = {o["id"]: o["name"] for o in json.loads((frames[0].truth_folder / "scene.json").read_text())["objects"]}
        by_id = [{t.id: t for t in s.objects.truth} for s in scores]  # of the last preset, `default`
        for k in sorted(set().union(*by_id)):
            objects.append(track_row(f"{name}, {names.get(k, k)}", [of.get(k) for of in by_id]))
        panel = curves(summaries)
        panels = [panel("objects found (IoU ≥ 0.5), %", 100, lambda s: 100 * s.recall_50), panel("precision, %", 100, lambda s: 100 * s.precision_50),
                  panel("median E, % (200 = missed)", 200, lambda s: 100 * s.median_error), panel("phantoms", None, lambda s: s.phantoms_per_frame)]
        plots[f"{name}.png"] = dict(x=list(range(len(frames))), panels=panels, x_title="frame", dots=False)
        images += f"![found, precision, E and phantoms of each frame of {name}](images/accuracy/{name}.png)\n\n"
    header = ["", "found 0.5, %", "found 0.75, %", "precision, %", "median E, %", "phantoms", "density, %", "bad-2, %"]
    of_objects = ["`default`, object", "frames", "found", "not found", "of these merged", "lost", "median IoU", "mean change of IoU", "greatest fall of IoU"]
    return f"""## Frame by frame

Two rendered sequences of 40 frames at 320x240 (`rendered/dev/sequences`): in A, the robot drives and turns among static objects; in B, a ball rolls past. Each frame is segmented independently, so this also shows how stable the result is. The table has means over the frames, and in brackets the 5th percentile, or the 95th of E, phantoms and bad-2, where less is better.

{table(header, rows)}
{images}Found: frames with IoU ≥ 0.5. Merged: frames in which more than half of the object is in one of ours that also contains more than half of another. Lost: the number of times the object was found in one frame and not in the next. The greatest fall is between consecutive frames, with the number of the later one.

{table(of_objects, objects)}
"""


# ---- the page ----


def head(commit):
    return f"""# Accuracy

<!-- Written by ./dev accuracy; do not edit. -->

Measured on {datetime.datetime.now(datetime.timezone.utc):%Y-%m-%d} at commit {commit}, on {report.processor()} (kernels: {cairn.supported_targets()[-1]}).
This page reports how well cairn finds objects and disparities, against ground truth and compared with OpenCV's matchers. `./dev accuracy` measures everything again and writes this page and its plots; it needs the data collection in `../shared/data`, or in `CAIRN_DATA`.

**Most results are not held out.** After the first table, results are measured on frames that the options and the trees of `default` were fitted to, so they are optimistic. The rendered frames are our own.

"""


COLUMNS = """## Presets and ablations

| column | content |
|---|---|
| found 0.5, found 0.75 | share of the true objects of at least 200 px with IoU ≥ 0.5 and ≥ 0.75 |
| precision | share of our objects with IoU ≥ 0.5 with a true object |
| median E | of the paper's E (Eq. 5, 1/IoU − 1) over all true objects; each counts for 200 % at most |
| boundary F | mean over all true objects |
| phantoms | per frame: reported objects of at least 200 px with little overlap with true ones |
| density, bad-2 | over the pixels visible to both cameras: share of the pixels with a disparity, and of these the share with an error above 2 px; rc_tabletop has no true disparity |
| ms | one core's time for the whole method, median frame |

[Evaluation](evaluation.md) defines the terms. **paper** and **default** are the presets, **as printed** is `paper` without the floor label and the gradient thresholds. Each other row is an ablation: `default` with one feature disabled or as in `paper`. A difference of one object is noise; each section gives the share of one object.

"""


def measure_all(data, docs, commit, threads):
    tell = lambda what: print(f"accuracy: {what}", file=sys.stderr, flush=True)
    plots = {}
    tell("fit and validation")
    text = head(commit) + splits(data, threads) + COLUMNS
    text += table(["`default` with", "meaning"], [[f"`{s}`", meaning] for s, meaning in all_ablations().items()], words=2) + "\n"
    for title, folder in FRAME_SETS.items():
        tell(folder)
        text += frame_set_section(title, load_frames(data / folder), threads)
    # The images of the real frames may not be published.
    shown, figures = best_median_worst(load_frames(data / FRAME_SETS["Rendered, 320x240"]), threads)
    tell("stress")
    text += shown + stress(data, threads, plots)
    tell("middlebury")
    text += middlebury(data, threads)
    tell("sequences")
    text += sequences(data, threads, plots)
    images = docs / "images" / "accuracy"
    images.mkdir(parents=True, exist_ok=True)
    for name, what in plots.items():
        report.plot(images / name, **what)
    for name, figure in figures.items():
        figure.savefig(images / name, dpi=100, metadata={"Software": None})
    report.write(docs / "accuracy.md", text)


def main():
    arguments = sys.argv[1:]
    only = len(arguments) > 2 and arguments[1] == "--only"
    if len(arguments) not in (3, 4):
        sys.exit(__doc__)
    data, threads = pathlib.Path(arguments[0]), int(arguments[3]) if len(arguments) == 4 else os.cpu_count()
    missing = next((f for f in ([arguments[2]] if only else folders_read()) if not (data / f).is_dir()), None)
    if missing:
        print(f"accuracy: {data / missing}: no such folder; set CAIRN_DATA to the data collection", file=sys.stderr)
        sys.exit(2)
    if only:
        print(frame_set_section(arguments[2], load_frames(data / arguments[2]), threads), end="")
        return
    start = time.monotonic()
    measure_all(data, pathlib.Path(arguments[1]), arguments[2], threads)
    print(f"wrote {arguments[1]}/accuracy.md and its images in {time.monotonic() - start:.0f} s on {threads} threads")


if __name__ == "__main__":
    main()
