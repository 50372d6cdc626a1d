# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Evaluation, diagnosis and tuning: the commands `evaluate`, `doctor` and `tune`."""

from __future__ import annotations

import math

from . import _cairn
from ._calls import NO_EXEC, STAGE_NAMED, ArgumentError, Report, checked, describes, doc, image, of_cpp, real, shown
from ._cairn import DEFAULTS, Error
from ._options import config_of, flat_config

# ---- evaluation ----


@describes(_cairn.DisparityErrors)
class DisparityErrors:
    """Disparity errors over the pixels with known truth. += adds the errors of another frame."""

    known: int = doc("number of pixels with truth")
    matched: int = doc("number of these with an estimated disparity")
    density: float = doc("0 to 1: matched / known")
    bad_of_matched: Dict[float, float] = doc("share of the matched pixels with a larger error, by threshold in px")
    bad_of_known: Dict[float, float] = doc("the same share of the known pixels; a hole counts as bad")
    mean_absolute_px: float = doc("mean of |ours - truth| over the matched pixels, px; NaN if no pixel is matched")
    root_mean_square_px: float = doc("root mean square of the same, px; NaN if no pixel is matched")
    sigma_px: float = doc("root mean square over errors of at most 1 px: sigma of a correct match")


@describes(_cairn.TrueObjectScore)
class TrueObjectScore:
    """The score of one true object."""

    id: int = doc("id in the truth, from 1")
    pixel_count: int = doc("area, px")
    found: int = doc("id of the found object of greatest IoU; 0 = none")
    iou: float = doc("0 to 1: intersection over union with `found`; 0 without overlap")
    boundary_f: float = doc("0 to 1: harmonic mean of the shares of each outline within the tolerance of the other")
    over_segmented: bool = doc("True if two or more found objects, each mostly on it, cover more than half of it")
    under_segmented: bool = doc("True if more than half of it is in a found object with more than half of another, too")
    error: float = doc("the paper's E, Eq. 5: 1 / IoU - 1; inf without overlap")


@describes(_cairn.FoundObjectScore)
class FoundObjectScore:
    """The score of one found object."""

    id: int = doc("id of the found object, from 1")
    pixel_count: int = doc("area outside don't-care pixels, px")
    best: int = doc("id of the true object of greatest IoU; 0 = none")
    iou: float = doc("0 to 1: intersection over union with `best`; 0 without overlap")
    phantom: bool = doc("True if large enough and hardly on any true object")


@describes(_cairn.ObjectErrors)
class ObjectErrors:
    """The scores of the objects of one frame."""

    truth: List[TrueObjectScore] = doc("list of TrueObjectScore")
    ours: List[FoundObjectScore] = doc("list of FoundObjectScore")


@describes(_cairn.ObjectSummary)
class ObjectSummary:
    """The scores of many frames: counts, and means over all their objects."""

    frames: int = doc("number of frames")
    true_objects: int = doc("number of scored true objects")
    our_objects: int = doc("number of found objects, except those mostly on don't-care pixels")
    phantoms: int = doc("number of found objects that hardly overlap a true one")
    mean_error: float = doc("mean of the paper's E, each capped at 2; 0 is best")
    median_error: float = doc("median of the same, 0 to 2")
    mean_iou: float = doc("mean IoU over all scored objects, 0 to 1")
    mean_boundary_f: float = doc("mean boundary_f over all scored objects, 0 to 1")
    recall_50: float = doc("share of the true objects found with IoU >= 0.5")
    precision_50: float = doc("share of the found objects with IoU >= 0.5")


@of_cpp
def disparity_errors(ours_px: FloatsLike, truth_px: FloatsLike, excluded: MaskLike = None, skip_left: int = 0) -> DisparityErrors:
    """Compares two disparity maps, (H, W) float32 in px; NaN = hole, no truth. excluded: (H, W) uint8, non-zero pixels
    are skipped. skip_left: columns x < skip_left are skipped."""
    if skip_left < 0:
        raise Error(f"skip_left: found {skip_left}, expected 0 or more")


@of_cpp
def object_errors(ours: LabelsLike, truth: LabelsLike, min_area: int = DEFAULTS["min_area"],
                  boundary_tolerance: float = DEFAULTS["boundary_tolerance"]) -> ObjectErrors:
    """Compares an object map with the truth of the same size: (H, W) integers, 0 = none; truth -1 = don't care.
    min_area: px, smaller true objects are not scored. boundary_tolerance: % of the image diagonal."""
    if min_area < 0 or not 0 <= boundary_tolerance <= 100:
        raise Error(f"object_errors: found min_area {min_area}, boundary_tolerance {boundary_tolerance}, expected at least 0, "
                    "and 0 … 100")
    if ours.min() < 0 or truth.min() < -1:
        raise Error("object_errors: found a negative id, expected ids from 0 on (truth: -1 = don't care)")


@of_cpp
def summarise(frames: Sequence[ObjectErrors], partial: bool = False) -> ObjectSummary:
    """Summarises the object_errors() of many frames. partial: their truth may lack objects, so there is no precision
    and no phantom."""


# ---- diagnosis ----


@describes(_cairn.PairMeasures, Report)
class PairMeasures:
    """Result of measure_pair(): the numbers of `cairn doctor --json` (docs/formats.md) as items and attributes, e.g.
    measures.offset_rows; None if not measured."""

    size: Tuple[int, int] = doc("(width, height), px")
    identical: bool = doc("True if both images are equal, pixel for pixel")
    disparities_px: NDArray[numpy.float32] = doc(
        "float32, px, ascending: disparities of consistent points with similar neighbours; a copy")

    def disparity_px(self, share: float) -> float:
        """The disparity, px, below which `share` (0 to 1) of the points lie; NaN without points."""
        if not 0 <= share <= 1:
            raise Error(f"share: found {share:g}, expected 0 … 1")
        return self._disparity(share)


@describes(_cairn.Synchrony, Report)
class Synchrony:
    """Result of measure_synchrony(), the synchronisation of both cameras of a sequence: the numbers of
    `cairn doctor --json` (docs/formats.md) as items and attributes; lag is the delay of the right camera in frames."""

    tells: bool = doc("True if the numbers distinguish the lags; False with too little or too even motion")


@describes(None, Report)
class Finding:
    """One fault of a rig, as in `cairn doctor --json` (docs/formats.md): severity, value, number, unit, says and remedy
    as items and attributes."""

    kind: str = doc("name of the fault as in `cairn doctor`, e.g. 'cameras swapped'", lambda self: self["finding"])


def report_of(cls, text, **more):
    made = cls.__new__(cls)
    made._json = text
    vars(made).update(more)
    return made


@of_cpp
def measure_pair(left: ImageLike, right: ImageLike, *, exec: Optional[Exec] = None, bgr: bool = False) -> PairMeasures:
    """Measures the input of diagnose(): rows, disparities, brightness, exposure and sharpness of a pair. left, right:
    (H, W) or (H, W, 3) uint8 of one size; they need not be rectified."""


@of_cpp
def measure_synchrony(pairs: Iterable[Tuple[ImageLike, ImageLike]], *, bgr: bool = False,
                      exec: Optional[Exec] = None) -> Synchrony:
    """Measures whether both cameras took their images at the same time. pairs: consecutive (left, right), all of one
    size. Holds all pairs in memory. With fewer than 8 pairs only repeated images are measured."""
    if not hasattr(pairs, "__iter__"):
        raise ArgumentError(f"pairs: found {shown(pairs)}, expected a sequence of (left, right)")
    pictures = []
    for number, pair in enumerate(pairs):
        if not (hasattr(pair, "__len__") and len(pair) == 2):
            raise ArgumentError(f"pairs: found {shown(pair)} as number {number}, expected (left, right)")
        names = f"left of pair {number}", f"right of pair {number}"
        pictures.append([image(value, name, exec, bgr) for value, name in zip(pair, names)])
        for name, (height, width) in zip(names, (picture.shape for picture in pictures[-1])):
            h, w = pictures[0][0].shape
            if (height, width) != (h, w):
                raise Error(f"{name}: is {width}x{height}, expected {w}x{h} as left of pair 0 is")
    return pictures, exec


def limits_of(limits):
    known = {name: entry for name, *entry in _cairn.diagnosis_limits()}
    for name, value in limits.items():
        if name not in known:
            close = _cairn.nearest(str(name), list(known))
            hint = f", did you mean '{close}'?" if close else "; help(cairn.diagnose) lists them"
            raise Error(f"limits: there is no '{str(name)[:80]}'{hint}")
        *_, lowest, highest, is_whole = known[name]
        number = real(value)
        if number is None or not lowest <= number <= highest or (is_whole and number != math.floor(number)):
            kind = "whole number" if is_whole else "number"
            raise Error(f"limits: {name}: found {value!r}, expected a {kind}, {lowest:g} … {highest:g}")
    return {name: float(value) for name, value in limits.items()}


def diagnose(measures: Union[PairMeasures, Synchrony], rig: RigLike = None, *, limits: Optional[Dict[str, float]] = None) -> Any:
    return measures, rig, limits


diagnose.__doc__ = """Finds the faults of a pair. Returns a list of Finding, causes before consequences; [] for a good
pair. As in segment(), a Calibration sets the default number of disparities and must match the image size; without rig
no calibration is judged. Of the options only min_disparity and num_disparities are used, the search range. For a
Synchrony, returns a Finding, or None if the cameras are synchronous.

limits: a dict of the limits to change:
""" + "\n".join(f"    {name} = {value:g}{unit and ' ' + unit} ({lowest:g} … {highest:g}): {words}"
                for name, value, unit, words, lowest, highest, _ in _cairn.diagnosis_limits())


def diagnosed(values, options, given):
    measures, calibration, limits = given
    if isinstance(measures, _cairn.Synchrony):
        fault = _cairn.fault_of(measures)
        return fault and report_of(Finding, fault)
    if not isinstance(measures, _cairn.PairMeasures):
        raise ArgumentError(f"measures: found {shown(measures)}, expected a cairn.PairMeasures or a cairn.Synchrony")
    config = flat_config(values["config"], ["match"], options)
    return [report_of(Finding, fault) for fault in _cairn.faults_of(measures, calibration, config, limits_of(limits or {}))]


diagnose = checked(diagnose, more=STAGE_NAMED[:2], groups=["match"], is_stage=True, run=diagnosed)


# ---- tuning ----


@describes()
class TuningFrame:
    """A pair to tune on, with its known ground truth. Borrows its arrays, as segment() does."""

    name: str = doc("name in error messages; frames with the same name show the same scene", lambda self: self._name)
    objects: Optional[NDArray[numpy.int32]] = doc(
        "(H, W) int32, true object ids; None if unknown", lambda self: self._objects)
    truth_px: Optional[NDArray[numpy.float32]] = doc(
        "(H, W) float32, true disparities, px; None if unknown", lambda self: self._truth_px)
    hidden: Optional[NDArray[numpy.uint8]] = doc(
        "(H, W) uint8, non-zero = not seen by the right camera; None if unknown", lambda self: self._hidden)
    partial: bool = doc("True if the truth may lack objects", lambda self: self._partial)

    def __init__(self, left: ImageLike, right: ImageLike, rig: RigLike = None, *, objects: Optional[LabelsLike] = None,
                 truth_px: Optional[FloatsLike] = None, hidden: MaskLike = None, partial: bool = False, name: str = "",
                 bgr: bool = False) -> None:
        """left, right, rig, bgr: as for segment(). objects: (H, W) integers, true object ids, 0 = none, -1 = don't
        care. truth_px: (H, W) float32, true disparities in px, NaN = unknown. hidden: (H, W) uint8, non-zero = not seen
        by the right camera. Each of these may be None. partial: not every object is labelled. name: frames with the
        same name show the same scene."""
        if left.shape != right.shape:
            _cairn.measure_pair(left, right, NO_EXEC)  # refuses them
        if objects is not None and objects.min() < -1:
            y, x = divmod(int(objects.argmin()), objects.shape[1])
            raise Error(f"objects: found {objects[y, x]} at x {x}, y {y}, expected ids from 0 on, or -1 = don't care")
        self._left, self._right, self._calibration, self._objects = left, right, rig, objects
        self._truth_px, self._hidden, self._partial, self._name = truth_px, hidden, partial, name


@checked
def load_tuning_frames(folder: PathLike, truth: bool = False) -> List[TuningFrame]:
    """Reads the frames of a folder as `cairn tune` does: a folder with left.png and right.png is one frame, else each
    of its sub-folders with both. Their calib.txt is read as well. truth: also reads objects.png, disp_left.png and
    occlusion.png; one of the first two is required."""
    return [TuningFrame(**frame) for frame in _cairn.tuning_frames(folder, truth)]


@describes(None, Report)
class Tuning:
    """Result of tune(): `config`, and the contents of `cairn tune --json` (docs/formats.md) as items and attributes:
    goal, found, tuned_on, held_out, gain, kept_because, …."""

    config: Config = doc("Config to use: the tuned one, or the start if that is kept", lambda self: self._config)


@of_cpp
def tunables(patterns: Sequence[str] = ("*",)) -> List[str]:
    """The names of the options that tune() can search and that match the patterns ('match.window_size', 'match.*',
    '*'), in the order of options()."""


@checked
def tune(frames: Iterable[Union[TuningFrame, Tuple[ImageLike, ImageLike]]], *, options: Sequence[str] = (),
         budget_s: float = DEFAULTS["budget_s"], evaluations: int = DEFAULTS["evaluations"],
         holdout: float = DEFAULTS["holdout"], seed: int = DEFAULTS["seed"],
         progress: Optional[Callable[[Dict[str, Any]], object]] = None, preset: str = "default",
         config: Union[Config, PathLike, None] = None, exec: Optional[Exec] = None, **groups) -> Tuning:
    """Searches for the options that do best on your frames, as `cairn tune` does (docs/tune.md). Returns a Tuning.
    frames: a TuningFrame or (left, right) each; all are held in memory. options: patterns as for tunables(); none = a
    sensible choice. budget_s: seconds, more than 0; the start is measured in any case. evaluations: also ends after
    this number, for a result that does not depend on the speed of the machine; 0 = no limit. holdout: 0 to 0.9, share
    of the frames used for validation only. seed: selects these frames and the order in which options are tried.
    progress: called before each evaluation with a dict: goal, evaluations, seconds, share (0 to 1), before and best
    (mean losses; None until the start is measured). Ctrl-C (KeyboardInterrupt) ends the search and keeps the best so
    far. The search starts from preset, config and the options, as in segment(). Releases the GIL. Raises cairn.Error
    for invalid input."""
    expected = "expected cairn.TuningFrame or (left, right)"
    if not hasattr(frames, "__iter__"):
        raise ArgumentError(f"frames: found {shown(frames)}, {expected} of each frame")
    held = []
    for number, frame in enumerate(frames):
        if not isinstance(frame, TuningFrame):
            if isinstance(frame, str) or not hasattr(frame, "__len__") or len(frame) != 2:
                raise ArgumentError(f"frames: found {shown(frame)} as number {number}, {expected}")
            frame = TuningFrame(*frame)
        held.append((frame.name or str(number), frame))
    if progress is not None and not callable(progress):
        raise ArgumentError(f"progress: found {shown(progress)}, expected a function or None")
    if seed < 0:
        raise Error(f"seed: found {seed}, expected 0 or more")
    base = config_of(config, preset, groups)
    text, best = _cairn.tune(held, base, exec, (options, budget_s, evaluations, holdout, seed), progress)
    return report_of(Tuning, text, _config=best)
