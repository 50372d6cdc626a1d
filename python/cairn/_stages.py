# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""The stages of the method, by their C++ names. Each function here declares the signature and the help of one stage;
the checks of matches come from C++.

The options come from the C++ function. A body adds checks, and may return other values for the C++ function.
"""

from __future__ import annotations

import inspect

import numpy as np

from . import _cairn
from ._calls import DEFAULT, STAGE_NAMED, checked, disparities
from ._cairn import Error
from ._options import flat_config


# ---- matching ----


def find_epipolar_offset(left: ImageLike, right: ImageLike) -> EpipolarOffset:
    """Estimates the row offset of the right image from textured points of the whole image. left, right: (H, W) or
    (H, W, 3) uint8 of one size."""


def shift_rows(right: ImageLike, offset: EpipolarOffset) -> NDArray[numpy.uint8]:
    """The right image, (H, W) uint8, shifted by `offset` so that its rows match those of the left image."""


def correct_epipolar(left: ImageLike, right: ImageLike) -> EpipolarCorrection:
    """Estimates and corrects a small misalignment of the cameras, as caused by vibration, before matching."""


def match(left: ImageLike, right: ImageLike) -> Matches:
    """Matches each pixel of the left image with its candidates in the same row of the right one; the lowest cost wins.
    left, right: (H, W) or (H, W, 3) uint8 of one size, rectified: a point at (x, y) in the left image is at (x - d, y)
    in the right one."""


def match_windows(left: ImageLike, right: ImageLike) -> Matches:
    """match() with method='window', whatever the configuration says: a square window around
    each pixel, independently."""


def match_semi_global(left: ImageLike, right: ImageLike) -> Matches:
    """match() with method='semi_global', whatever the configuration says: smoothness along four paths
    (Hirschmueller 2008). Of the group match only min_disparity and num_disparities are used."""


def refine_subpixel(matches: Matches) -> NDArray[numpy.float32]:
    """Subpixel disparities, the minimum of a curve through the costs of each winner and its neighbours: (H, W) float32,
    px; NaN without a match."""


# ---- disparities ----


def combine(refined_px: DisparitiesLike, verdicts: Sequence[NDArray[numpy.uint16]]) -> DisparityMap:
    """Combines disparities with the verdicts of checks, arrays (H, W) uint16 of cairn.Reject bits (also your own). A
    pixel keeps every bit it received; NaN adds Reject.border. refined_px: (H, W) float32, px."""
    if any(verdict.shape != refined_px.shape for verdict in verdicts):
        raise Error("verdicts: found one of another size than refined_px, expected all of one size")


def external_disparity(disparity_px: FloatsLike) -> DisparityMap:
    """A DisparityMap from an external map (depth camera, learned matcher), (H, W) float32 in px. NaN and inf become
    holes with Reject.no_data."""


def noise_sigma(left: ImageLike) -> float:
    """The standard deviation of the image noise, grey levels; an input of stages that weigh edges."""


def select_textured(left: ImageLike, disparity: DisparityLike, noise_sigma: float) -> NDArray[numpy.float32]:
    """The textured disparities, those supported by texture at the pixel itself: (H, W) float32, px; NaN elsewhere.
    noise_sigma: from noise_sigma()."""


def reject_speckles(disparity: DisparityLike) -> DisparityMap:
    """Rejects small islands of disparity."""


def estimate_confidence(matches: Matches, disparity: DisparityLike) -> NDArray[numpy.float32]:
    """The probability that each disparity is within 1 px of the truth: (H, W) float32, 0 to 1; 0 in holes. Of the group
    match only `method` is used, the method that produced `matches`."""


# ---- floor and walls ----


def fit_ground(disparity: Union[DisparityMap, FloatsLike], rig: RigLike = None, *, left: Optional[ImageLike] = None) -> Ground:
    """Finds the floor in a disparity map, or in an array of trusted disparities only, NaN = hole. With an array, `left`
    also allows a floor so reflective that it has hardly any disparities of its own."""
    is_map = isinstance(disparity, _cairn.DisparityMap)
    return disparity if is_map else disparities(disparity, "disparity"), rig, left


def reject_below_ground(disparity: DisparityLike, ground: Ground, rig: RigLike = None) -> DisparityMap:
    """Rejects matches below the floor, which are reflections."""


def label_floor(disparity: DisparityLike, ground: Ground, rig: RigLike = None) -> Optional[NDArray[numpy.uint8]]:
    """Floor mask, (H, W) uint8: 255 = disparity of the floor, else 0. None without a ground or with label_floor off."""


def likely_ground(ground: Ground, disparity: DisparityLike, rig: RigLike = None, *,
                  textured_px: Optional[DisparitiesLike] = None, left: Optional[ImageLike] = None) -> Ground:
    """The ground itself or, if it was refused for lack of support, one fitted to all disparities: a floor without
    texture has no textured disparities. textured_px (from select_textured()) and left refuse planes that textured
    disparities show to be upright, and allow a reflective floor."""


def floor_under_reflections(disparity: DisparityLike, ground: Ground) -> NDArray[numpy.float32]:
    """The disparities of the visible surfaces, (H, W) float32, px: those of the ground where a match was rejected as
    below it, NaN in other holes."""


def fit_background(textured_px: DisparitiesLike, ground: Ground, rig: RigLike = None) -> Background:
    """Fits walls: upright planes with many textured disparities on them and hardly any behind. textured_px: from
    select_textured()."""


# ---- regions ----


def gradient(image: NumbersLike, smoothing_sigma: float = 0.0) -> NDArray[numpy.uint16]:
    """Gradient magnitude from one side of a pixel to the other, (H, W) uint16: of an image, (H, W) uint8, in grey
    levels, capped at 255; or of quantised() disparities, int16, in 1/16 px, 65535 in holes."""


def edge_strength(left: ImageLike, smoothing_sigma: float = 0.7) -> NDArray[numpy.uint16]:
    """Edge strength for superpixels, (H, W) uint16: central differences in 1/4 grey level; for colour, the maximum over
    the channels."""


def quantised(disparity: DisparityLike) -> NDArray[numpy.int16]:
    """Disparities in 1/16 px: (H, W) int16, HOLE_16 in holes."""


def watershed(gradient: NDArray[numpy.uint16]) -> Basins:
    """Watershed by steepest descent, 4-connected, without ridge lines. gradient: (H, W) uint16."""


def build_graph(labels: LabelsLike, values: NumbersLike, floor: MaskLike = None) -> RegionGraph:
    """Builds the adjacency graph of the regions, with their statistics. labels: (H, W) integers from 0 on. values:
    input of the statistics, (H, W) uint8 grey levels or int16 from quantised(). floor: only with the latter, (H, W)
    uint8, non-zero = floor, or None."""
    if floor is not None and not isinstance(values, np.ndarray):
        raise Error("floor: found a mask with grey levels, expected None: grey levels have no floor")
    return labels, count_of(labels), values, floor


def grow_statistical(graph: RegionGraph, *, mean_difference_max: float, deviation_max: float, sigma_min: float,
                     min_region_area: int = 0) -> NDArray[numpy.int32]:
    """Statistical region growing (paper, Eq. 1 to 3). Returns for each region the surviving one that contains
    it, int32. The criteria are in units of the graph's values, min_region_area in px."""
    if not (mean_difference_max >= 0 and deviation_max >= 0 and 0 < sigma_min < np.inf and min_region_area >= 0):
        raise Error(f"growing: found mean_difference_max {mean_difference_max}, deviation_max {deviation_max}, sigma_min "
                    f"{sigma_min}, min_region_area {min_region_area}, expected none below 0 and a sigma_min above")


def grow_near_to_far(graph: RegionGraph, *, mean_difference_max: float, deviation_max: float, sigma_min: float,
                     min_region_area: int = 0) -> NDArray[numpy.int32]:
    """The paper's region growing for disparity, from the nearest region to the farthest; otherwise like
    grow_statistical()."""
    STAGES["grow_statistical"](graph, mean_difference_max=mean_difference_max, deviation_max=deviation_max,
                               sigma_min=sigma_min, min_region_area=min_region_area)


def apply_merges(labels: LabelsLike, graph: RegionGraph, merged_into: Sequence[int], value_scale: float = 1.0) -> Segmentation:
    """The regions after growing, as a Segmentation. value_scale: size of one unit of the graph's values (1/16 px for
    disparities)."""
    if count_of(labels) != len(graph) or len(merged_into) != len(graph):
        raise Error(f"labels: found {count_of(labels)} regions, merged_into: {len(merged_into)}, expected the {len(graph)} of "
                    "the graph")
    into = np.asarray(merged_into)
    lost = np.flatnonzero((into < 0) | (into >= len(graph)) | (into[np.clip(into, 0, len(graph) - 1)] != into))
    if len(lost):
        raise Error(f"merged_into: found {into[lost[0]]} for region {lost[0]}, expected a region that ended in itself")


def segment_intensity(left: ImageLike) -> Segmentation:
    """Regions of similar intensity: gradient, watershed, build_graph, grow_statistical. left: (H, W) or (H, W, 3)
    uint8."""


def segment_disparity(disparity: DisparityLike, floor: MaskLike = None) -> Segmentation:
    """Regions of similar disparity, grown nearest first: gradient, watershed, build_graph, grow_near_to_far. floor:
    (H, W) uint8 from label_floor(), one separate region; or None."""


# ---- grouping ----


def cut_superpixels(left: ImageLike, disparity: DisparityLike, noise_sigma: float,
                    hints: HintsLike = None) -> Superpixels:
    """Segments the image into superpixels: connected pieces without a clear edge of brightness, colour (if
    there is colour) or disparity inside. noise_sigma: from noise_sigma(). hints: from hint_objects(); the
    superpixels then follow the outlines that it expects. superpixels.count is their number in 320x240 pixels; larger
    images have up to 2.25 times as many."""


def superpixel_regions(superpixels: Superpixels, left: ImageLike) -> Segmentation:
    """The superpixels as a Segmentation, with their grey level statistics."""


def hint_objects(left: ImageLike, disparity: DisparityLike, textured_px: DisparitiesLike, ground: Ground,
                 background: Background, noise_sigma: float) -> NDArray[numpy.int16]:
    """Estimates of a small neural network, used by cut_superpixels() and grow_merge_tree(): (rows, columns, 5) int16 for
    about 160x120 to 240x180 cells, of 2x2 pixels in an image of 320x240. The channels are: log-odds in 1/16 that the
    cell shows an object, and that the outline of an object passes; offset to the centroid of the object, x and y in 1/8
    cell; log2 of its number of cells in 1/16."""


def grow_merge_tree(superpixels: Superpixels, left: ImageLike, disparity: DisparityLike, textured_px: DisparitiesLike,
                    ground: Ground, background: Background, noise_sigma: float) -> MergeTree:
    """Repeatedly merges the two neighbouring regions most likely to belong to one object, judged from all cues by
    fitted trees, until one is left. Calls hint_objects(). textured_px: from select_textured(). ground: from
    likely_ground(). noise_sigma: from noise_sigma()."""


def choose_objects(tree: MergeTree) -> ChosenObjects:
    """Chooses the regions of the tree that are most likely whole objects; no two share a superpixel. Of the options
    only min_area and min_confidence are used."""


def object_regions(superpixels: Superpixels, chosen: ChosenObjects, disparity: DisparityLike) -> Segmentation:
    """The chosen objects as a Segmentation: region 0 is the rest (is_background), the others are the objects. Means in
    px."""
    check_superpixels(superpixels, chosen=len(chosen.object_of))


def refine_disparity(superpixels: Superpixels, tree: MergeTree, chosen: ChosenObjects, left: ImageLike,
                     disparity: DisparityLike, textured_px: DisparitiesLike, ground: Ground, background: Background,
                     confidence: DisparitiesLike, hints: HintsLike, noise_sigma: float) -> RefinedDisparity:
    """The most likely disparity of each pixel: groups of pixels of a superpixel keep their disparities or take a plane,
    chosen by fitted trees. disparity, textured_px, ground, background, hints: as for the tree. confidence: from
    estimate_confidence(). noise_sigma: from noise_sigma()."""
    check_superpixels(superpixels, tree=tree.superpixels, chosen=len(chosen.object_of))


def without_sky(refined: RefinedDisparity, reject: NDArray[numpy.uint16]) -> RefinedDisparity:
    """The same with NaN where `reject` says sky."""


def likely_disparities(refined: RefinedDisparity, reject: NDArray[numpy.uint16], min_confidence: float) -> DisparityMap:
    """The refined disparities with at least this confidence, 0 to 1. Others are holes, with the reasons of `reject` and
    Reject.unlikely."""


# ---- objects ----


def fuse(by_intensity: Segmentation, by_disparity: Segmentation) -> Fusion:
    """Assigns each intensity region to the disparity region of greatest overlap (paper, Eq. 4)."""


def measure(candidates: LabelsLike, is_background: Sequence[bool], disparity: DisparityLike, left: ImageLike,
            noise_sigma: float) -> Objects:
    """Turns candidate regions into objects. Excludes background and regions that are too large, too small, without
    valid pixels, or of low confidence. candidates: (H, W) integers, the regions of a Fusion. is_background: for each
    region, True if it is known not to be an object. noise_sigma: from noise_sigma()."""
    check_labels("candidates", candidates, "is_background", is_background)


def measure_chosen(chosen: LabelsLike, scores: Sequence[float], disparity: DisparityLike, left: ImageLike,
                   noise_sigma: float) -> Objects:
    """Measures regions chosen as objects: measure() of C++ with scores. chosen: (H, W) integers, the labels of
    object_regions(). scores: confidence of each region, 0 to 1, from choose_objects(); 0 = no object."""
    check_labels("chosen", chosen, "scores", scores)
    if not all(0 <= score <= 1 for score in scores):
        raise Error("scores: found one outside 0 … 1, expected a confidence for each region")


def refine_objects(objects: Objects, disparity: DisparityLike, left: ImageLike, right: ImageLike) -> Objects:
    """Refines the disparity of each object by both images and by fitted trees, and renumbers the objects if their order
    changes. Returns Objects."""


def locate(objects: Objects, disparity: DisparityLike, ground: Ground, rig: RigLike = None) -> Objects:
    """Locates objects: adds the uncertainty of their disparity; with a rig also position, depth interval and extent;
    with a rig and a ground also the box on the floor. Returns Objects."""


def reject_sky(disparity: DisparityLike, left: ImageLike, confidence: DisparitiesLike, ground: Ground,
               superpixels: Superpixels, objects: Objects, rig: RigLike = None) -> DisparityMap:
    """Rejects the disparities of the sky, outside of objects. segment() then sets their confidence to 0."""


def floor_probability(objects: Objects, disparity: DisparityLike, confidence: DisparitiesLike, ground: Ground,
                      background: Background, surface_disparity_px: DisparitiesLike, superpixels: Superpixels,
                      refined: RefinedDisparity, hints: HintsLike, rig: RigLike = None) -> NDArray[numpy.float32]:
    """The probability that a pixel shows the floor, by fitted trees: (H, W) float32, 0 to 1; NaN in objects, in the sky, above
    the horizon, where a wall hides the floor, and in groups of one or two pixels. surface_disparity_px: from
    floor_under_reflections(). hints: from hint_objects(). refined: from without_sky()."""


def label_obstacles(objects: Objects, disparity: DisparityLike, confidence: DisparitiesLike, ground: Ground,
                    background: Background, surface_disparity_px: DisparitiesLike, rig: RigLike = None,
                    refined: Optional[RefinedDisparity] = None,
                    floor_probability: Optional[DisparitiesLike] = None) -> NDArray[numpy.uint8]:
    """The class of each pixel: (H, W) uint8, 255 = obstacle, 128 = floor, 64 = sky, 0 = unknown. surface_disparity_px: from
    floor_under_reflections(). floor_probability: without it, and where it is NaN, the disparities decide."""


# ---- checks: listed in C++, for_each_check() ----


def check(name, reason, is_of_image):
    def of_matches(matches: Matches) -> NDArray[numpy.uint16]:
        pass

    def of_image(left: ImageLike) -> NDArray[numpy.uint16]:
        pass

    function = of_image if is_of_image else of_matches
    function.__name__ = function.__qualname__ = name
    function.__doc__ = f"A check, which marks pixels with Reject.{reason}: {SAYS[reason]}. Returns (H, W) uint16, the bit or 0."
    return function


SAYS = {reason: says for reason, _, says in _cairn.REASONS}
globals().update({name: check(name, *of) for name, *of in _cairn.CHECKS})
STAGES = {name: function for name, function in list(globals().items()) if name in _cairn.stage_groups}


def count_of(labels):
    """The number of regions in the labels. Raises Error unless each of 0 … count - 1 has a pixel."""
    if labels.min() < 0 or labels.max() >= labels.size:
        y, x = np.argwhere((labels < 0) | (labels >= labels.size))[0]
        raise Error(f"labels: found {labels[y, x]} at x {x}, y {y}, expected regions numbered from 0 on")
    areas = np.bincount(labels.ravel())
    if not areas.all():
        raise Error(f"labels: found no pixel of region {areas.argmin()}, expected every one of 0 … {len(areas) - 1}")
    return len(areas)


def check_superpixels(superpixels, **counts):
    for name, count in counts.items():
        if count != superpixels.count:
            raise Error(f"{name}: is of {count} superpixels, expected the {superpixels.count} of superpixels")


def check_labels(name, labels, counted, entries):
    if labels.min() < 0 or labels.max() >= len(entries):
        raise Error(f"{name}: found a region without an entry in {counted}, expected 0 … {len(entries)} - 1")


# ---- calls ----

# Option values that a stage requires, whatever the configuration says.
SETTLED = {"match_semi_global": [("match.method", "semi_global")]}


def stage(name, function):
    of_cpp, groups = getattr(_cairn, name), _cairn.stage_groups[name]

    def run(values, options, prepared):
        config, exec = values.pop("config"), values.pop("exec")
        values.pop("bgr", None)
        if name in SETTLED:
            config = (config or DEFAULT)._with(SETTLED[name], groups)
        config = flat_config(config, groups, options)
        values = list(values.values() if prepared is None else prepared)
        for i, value in enumerate(values):
            if isinstance(value, _cairn.Calibration):
                config, values[i] = config._suited(value), value.rig
        return of_cpp(config, exec, *values)

    kinds = " ".join(p.annotation for p in inspect.signature(function).parameters.values())
    has_images = "ImageLike" in kinds or "NumbersLike" in kinds
    return checked(function, more=STAGE_NAMED[:3 if has_images else 2], groups=groups, is_stage=True, run=run)


globals().update({name: stage(name, function) for name, function in STAGES.items()})
