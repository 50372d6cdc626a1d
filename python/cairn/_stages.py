# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Every stage of the method, by its C++ name. Each function here is the signature and the help of one.

Its options follow from the C++ function. A body checks further, and may return other values for the C++ function.
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
    """Finds how far the right image's rows are off, from textured points all over it. left, right: (H, W) or (H, W, 3) uint8 of
    one size."""


def shift_rows(right: ImageLike, offset: EpipolarOffset) -> NDArray[numpy.uint8]:
    """The right image, (H, W) uint8, moved back by `offset`, so that its rows are the left one's."""


def correct_epipolar(left: ImageLike, right: ImageLike) -> EpipolarCorrection:
    """Both: compensates a small misalignment of the cameras, as vibration makes it, before the matching."""


def match(left: ImageLike, right: ImageLike) -> Matches:
    """Matches every pixel of the left image with its candidates in the same row of the right one; the winner takes all. left,
    right: (H, W) or (H, W, 3) uint8 of one size, rectified: what is at (x, y) on the left is at (x - d, y) on the right."""


def match_windows(left: ImageLike, right: ImageLike) -> Matches:
    """match() with method='window', whatever the configuration says: a square window for every pixel, on its own."""


def match_semi_global(left: ImageLike, right: ImageLike) -> Matches:
    """match() with method='semi_global', whatever the configuration says: neighbours vote along four paths (Hirschmueller
    2008). Of the group match only min_disparity and num_disparities count."""


def refine_subpixel(matches: Matches) -> NDArray[numpy.float32]:
    """Where the curve through each winner's cost and its neighbours' is lowest: (H, W) float32, px; NaN where there is no
    match."""


# ---- disparities ----


def reject_inconsistent(matches: Matches) -> NDArray[numpy.uint16]:
    """Pixels whose match, followed back from the right image, does not return to them: (H, W) uint16, Reject.left_right or
    0."""


def reject_ambiguous(matches: Matches) -> NDArray[numpy.uint16]:
    """Pixels with more than one suitable minimum: (H, W) uint16, Reject.not_unique or 0."""


def reject_flat(matches: Matches) -> NDArray[numpy.uint16]:
    """Pixels with a constant correlation function: (H, W) uint16, Reject.flat or 0."""


def reject_textureless(left: ImageLike) -> NDArray[numpy.uint16]:
    """Pixels without enough texture (Moravec operator): (H, W) uint16, Reject.no_texture or 0. left: (H, W) or (H, W, 3)
    uint8."""


def combine(refined_px: DisparitiesLike, verdicts: Sequence[NDArray[numpy.uint16]]) -> DisparityMap:
    """Unites verdicts, arrays (H, W) uint16 of cairn.Reject bits (yours among them), with the disparities: a pixel keeps every
    bit that it got, NaN adds Reject.border. refined_px: (H, W) float32, px."""
    if any(verdict.shape != refined_px.shape for verdict in verdicts):
        raise Error("verdicts: found one of another size than refined_px, expected all of one size")


def external_disparity(disparity_px: FloatsLike) -> DisparityMap:
    """A map from outside (depth camera, learned matcher), (H, W) float32 in px: NaN and inf become holes with
    Reject.no_data."""


def noise_sigma(left: ImageLike) -> float:
    """The standard deviation of the image's noise, grey levels; stages that weigh edges ask for it."""


def find_evidence(left: ImageLike, disparity: DisparityLike, noise_sigma: float) -> NDArray[numpy.float32]:
    """The disparities that rest on the pixel's own texture, NaN elsewhere: (H, W) float32, px. noise_sigma as noise_sigma()
    gives it."""


def reject_speckles(disparity: DisparityLike) -> DisparityMap:
    """Rejects small islands of disparity."""


def estimate_confidence(matches: Matches, disparity: DisparityLike) -> NDArray[numpy.float32]:
    """How likely each disparity is within 1 px of the truth: (H, W) float32, 0 to 1; 0 where there is none. Of the group match
    only `method` counts: how `matches` was made."""


# ---- floor and walls ----


def fit_ground(disparity: Union[DisparityMap, FloatsLike], rig: RigLike = None, *, left: Optional[ImageLike] = None) -> Ground:
    """Finds the floor in a disparity map, or in floats, NaN = hole: those alone that deserve trust; with these, `left` also
    shows a floor that mirrors so well that it has hardly any disparities of its own."""
    is_map = isinstance(disparity, _cairn.DisparityMap)
    return disparity if is_map else disparities(disparity, "disparity"), rig, left


def reject_below_ground(disparity: DisparityLike, ground: Ground, rig: RigLike = None) -> DisparityMap:
    """Rejects matches under the floor, which are reflections."""


def label_floor(disparity: DisparityLike, ground: Ground, rig: RigLike = None) -> Optional[NDArray[numpy.uint8]]:
    """(H, W) uint8: 255 where the disparity is the floor's, else 0. None where there is no ground or label_floor is off."""


def likely_ground(ground: Ground, disparity: DisparityLike, rig: RigLike = None, *,
                  evidence_px: Optional[DisparitiesLike] = None, left: Optional[ImageLike] = None) -> Ground:
    """The ground itself, or if it was refused for lack of support, one fitted to all disparities: a plain floor has no
    textured disparities. evidence_px, as find_evidence() gives it, and left refuse planes that textured disparities show
    to be upright, and allow a floor that mirrors."""


def floor_under_reflections(disparity: DisparityLike, ground: Ground) -> NDArray[numpy.float32]:
    """(H, W) float32, px: the disparities of what is seen: those of the ground where a match was rejected as below it, NaN in
    other holes."""


def fit_background(evidence_px: DisparitiesLike, ground: Ground, rig: RigLike = None) -> Background:
    """Finds walls: upright planes with much evidence on them and hardly any behind. evidence_px as find_evidence() gives it."""


# ---- regions ----


def gradient(image: NumbersLike, smoothing_sigma: float = 0.0) -> NDArray[numpy.uint16]:
    """Gradient magnitude: of an image, (H, W) uint8, in grey levels, capped at 255; or of quantised() disparities, int16, in
    1/16 px, 65535 in holes. (H, W) uint16, from one side of a pixel to the other."""


def edge_strength(left: ImageLike, smoothing_sigma: float = 0.7) -> NDArray[numpy.uint16]:
    """Edges that superpixels follow: central differences in 1/4 grey level, of colour the strongest channel's. (H, W)
    uint16."""


def quantised(disparity: DisparityLike) -> NDArray[numpy.int16]:
    """Disparities in 1/16 px: (H, W) int16, HOLE_16 in holes."""


def watershed(gradient: NDArray[numpy.uint16]) -> Basins:
    """Watershed by steepest descent, 4-connected, no ridge lines. gradient: (H, W) uint16."""


def build_graph(labels: LabelsLike, values: NumbersLike, floor: MaskLike = None) -> RegionGraph:
    """Counts and links regions. labels: (H, W) integers from 0 on; values: what the statistics are of, (H, W) uint8 grey
    levels, or int16 as quantised() gives them, then with floor: (H, W) uint8, not 0 = floor, or None."""
    if floor is not None and not isinstance(values, np.ndarray):
        raise Error("floor: found a mask with grey levels, expected None: grey levels have no floor")
    return labels, count_of(labels), values, floor


def grow_statistical(graph: RegionGraph, *, mean_difference_max: float, deviation_max: float, sigma_min: float,
                     min_region_area: int = 0) -> NDArray[numpy.int32]:
    """Statistical region growing (paper, Eq. 1 to 3): for each region that in which it ended, int32. The criteria are in units
    of the graph's values; min_region_area in px."""
    if not (mean_difference_max >= 0 and deviation_max >= 0 and 0 < sigma_min < np.inf and min_region_area >= 0):
        raise Error(f"growing: found mean_difference_max {mean_difference_max}, deviation_max {deviation_max}, sigma_min "
                    f"{sigma_min}, min_region_area {min_region_area}, expected none below 0 and a sigma_min above")


def grow_near_to_far(graph: RegionGraph, *, mean_difference_max: float, deviation_max: float, sigma_min: float,
                     min_region_area: int = 0) -> NDArray[numpy.int32]:
    """The paper's region growing for disparity, from the nearest region to the farthest; else as grow_statistical()."""
    CHECKS["grow_statistical"](graph, mean_difference_max=mean_difference_max, deviation_max=deviation_max,
                               sigma_min=sigma_min, min_region_area=min_region_area)


def apply_merges(labels: LabelsLike, graph: RegionGraph, merged_into: Sequence[int], value_scale: float = 1.0) -> Segmentation:
    """Writes what growing made. value_scale: what one unit of the graph's values is (1/16 px for disparities)."""
    if count_of(labels) != len(graph) or len(merged_into) != len(graph):
        raise Error(f"labels: found {count_of(labels)} regions, merged_into: {len(merged_into)}, expected the {len(graph)} of "
                    "the graph")
    into = np.asarray(merged_into)
    lost = np.flatnonzero((into < 0) | (into >= len(graph)) | (into[np.clip(into, 0, len(graph) - 1)] != into))
    if len(lost):
        raise Error(f"merged_into: found {into[lost[0]]} for region {lost[0]}, expected a region that ended in itself")


def segment_intensity(left: ImageLike) -> Segmentation:
    """Regions of like intensity: gradient, watershed, build_graph, grow_statistical. left: (H, W) or (H, W, 3) uint8."""


def segment_disparity(disparity: DisparityLike, floor: MaskLike = None) -> Segmentation:
    """Regions of like disparity, nearest first: gradient, watershed, build_graph, grow_near_to_far. floor: (H, W) uint8 as
    label_floor() gives it, one region of its own; or None."""


# ---- grouping ----


def cut_superpixels(left: ImageLike, disparity: DisparityLike, noise_sigma: float) -> Superpixels:
    """Cuts the image into connected pieces that no clear edge runs through, by brightness, colour (where there is colour) and
    steps of disparity. noise_sigma as noise_sigma() gives it."""


def segmentation_of(superpixels: Superpixels, left: ImageLike) -> Segmentation:
    """The superpixels as a Segmentation, with their grey statistics."""


def hint_objects(superpixels: Superpixels, left: ImageLike, disparity: DisparityLike, evidence_px: DisparitiesLike,
                 ground: Ground, background: Background, noise_sigma: float) -> NDArray[numpy.int16]:
    """Estimates of a small network, used by grow_merge_tree(): (rows, columns, 5) int16 for cells of about 2x2 pixels of a
    320x240 image. Log-odds in 1/16 that the cell shows an object, and that an object's outline passes; the way to the object's
    centroid, x and y in 1/8 cell; log2 of its number of cells in 1/16."""


def grow_merge_tree(superpixels: Superpixels, left: ImageLike, disparity: DisparityLike, evidence_px: DisparitiesLike,
                    ground: Ground, background: Background, noise_sigma: float) -> MergeTree:
    """Merges the two neighbouring regions that most likely belong to one object, by all cues and fitted trees, until one is
    left. Calls hint_objects(). evidence_px as find_evidence() gives it, ground as likely_ground(), noise_sigma as
    noise_sigma()."""


def choose_objects(tree: MergeTree) -> ChosenObjects:
    """Chooses the regions of the tree that are likeliest whole objects; no two share a superpixel. Of the options only min_area
    and min_confidence count."""


def groups_of(superpixels: Superpixels, chosen: ChosenObjects, disparity: DisparityLike) -> Segmentation:
    """The chosen objects as a Segmentation: region 0 is all else (is_background), the others are the objects. Means in px."""
    if len(chosen.object_of) != superpixels.count:
        raise Error(f"chosen: is of {len(chosen.object_of)} superpixels, expected the {superpixels.count} of superpixels")


# ---- objects ----


def fuse(by_intensity: Segmentation, by_disparity: Segmentation) -> Fusion:
    """Each intensity region goes to the disparity region with the greatest overlap (paper, Eq. 4)."""


def measure(candidates: LabelsLike, is_background: Sequence[bool], disparity: DisparityLike, left: ImageLike,
            noise_sigma: float) -> Objects:
    """Turns candidates into objects: what is background, too large, too small, unseen or unlikely is none. candidates: (H, W)
    integers, the regions of a Fusion; is_background: for each of them, whether it is known to be no object; noise_sigma as
    noise_sigma() gives it."""
    check_labels("candidates", candidates, "is_background", is_background)


def measure_chosen(chosen: LabelsLike, scores: Sequence[float], disparity: DisparityLike, left: ImageLike,
                   noise_sigma: float) -> Objects:
    """Measures regions that were chosen to be objects: measure() of C++ with scores. chosen: (H, W) integers, the labels of
    groups_of(); scores: for each region its confidence, 0 to 1, as choose_objects() gives them; 0 = no object."""
    check_labels("chosen", chosen, "scores", scores)
    if not all(0 <= score <= 1 for score in scores):
        raise Error("scores: found one outside 0 … 1, expected a confidence for each region")


def refine_objects(objects: Objects, disparity: DisparityLike, left: ImageLike, right: ImageLike) -> Objects:
    """Refines the disparity of each object by both images, and numbers the objects anew if their order changes. Returns
    Objects."""


def locate(objects: Objects, disparity: DisparityLike, ground: Ground, rig: RigLike = None) -> Objects:
    """Where objects are: the uncertainty of their disparity and, with a rig, position, interval of depth, extent, and with a
    ground their box on the floor. Returns Objects."""


def label_space(objects: Objects, disparity: DisparityLike, confidence: DisparitiesLike, ground: Ground,
                background: Background, superpixels: Superpixels, seen_px: DisparitiesLike,
                rig: RigLike = None) -> NDArray[numpy.uint8]:
    """What each pixel shows: (H, W) uint8, 255 = obstacle, 128 = floor, 0 = unknown. seen_px as floor_under_reflections() gives
    it."""


STAGES = {name: function for name, function in list(globals().items()) if name in _cairn.stage_groups}
CHECKS = STAGES


def count_of(labels):
    """The number of regions in the labels. Raises Error unless each of 0 … count - 1 has a pixel."""
    if labels.min() < 0 or labels.max() >= labels.size:
        y, x = np.argwhere((labels < 0) | (labels >= labels.size))[0]
        raise Error(f"labels: found {labels[y, x]} at x {x}, y {y}, expected regions numbered from 0 on")
    areas = np.bincount(labels.ravel())
    if not areas.all():
        raise Error(f"labels: found no pixel of region {areas.argmin()}, expected every one of 0 … {len(areas) - 1}")
    return len(areas)


def check_labels(name, labels, counted, entries):
    if labels.min() < 0 or labels.max() >= len(entries):
        raise Error(f"{name}: found a region without an entry in {counted}, expected 0 … {len(entries)} - 1")


# ---- calls ----

# What a stage needs whatever the configuration says.
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
