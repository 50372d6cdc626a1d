# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Evaluation, diagnosis and tuning, as the commands `evaluate`, `doctor` and `tune` do them."""

from __future__ import annotations

import math

from . import _cairn
from ._calls import NO_EXEC, STAGE_NAMED, ArgumentError, Report, checked, describes, image, of_cpp, real, shown
from ._cairn import DEFAULTS, Error
from ._options import config_of, flat_config

# ---- evaluation ----


@describes(_cairn.DisparityErrors)
class DisparityErrors:
    """Counts over the pixels whose true disparity is known. Several frames' add up with +=."""

    known: int = "pixels with truth"
    matched: int = "of these, pixels with a disparity of ours"
    density: float = "0 to 1: matched / known"
    bad_of_matched: Dict[float, float] = "by threshold in px: share of the matched pixels with a larger error"
    bad_of_known: Dict[float, float] = "the same of the known; a hole counts as bad"
    mean_absolute_px: float = "mean of |ours - truth| over the matched, px; NaN where no pixel is matched"
    root_mean_square_px: float = "root of the mean square of the same, px; NaN where no pixel is matched"
    sigma_px: float = "the same over errors of at most 1 px: sigma of a correct match"


@describes(_cairn.TrueObjectScore)
class TrueObjectScore:
    """How well one true object was found."""

    id: int = "its number in the truth, from 1 on"
    pixel_count: int = "its area, px"
    found: int = "our object of greatest IoU; 0 = none"
    iou: float = "0 to 1: intersection over union with `found`; 0 where they do not overlap"
    boundary_f: float = "0 to 1: how much of both outlines lies within the tolerance of the other"
    over_segmented: bool = "two or more of ours lie mostly on it and cover more than half of it"
    under_segmented: bool = "more than half of it lies in one of ours that holds more than half of another, too"
    error: float = "the paper's E, Eq. 5: 1 / IoU - 1; inf where they do not overlap"


@describes(_cairn.FoundObjectScore)
class FoundObjectScore:
    """How well one object of ours lies on a true one."""

    id: int = "its number among ours, from 1 on"
    pixel_count: int = "its area outside don't-care, px"
    best: int = "the true object of greatest IoU; 0 = none"
    iou: float = "0 to 1: intersection over union with `best`; 0 where they do not overlap"
    phantom: bool = "large enough, and hardly on any true object"


@describes(_cairn.ObjectErrors)
class ObjectErrors:
    """One frame against its truth."""

    truth: List[TrueObjectScore] = "a list of TrueObjectScore"
    ours: List[FoundObjectScore] = "a list of FoundObjectScore"


@describes(_cairn.ObjectSummary)
class ObjectSummary:
    """Many frames as one: counts, and means over all their objects."""

    frames: int = "number of frames"
    true_objects: int = "that were scored"
    our_objects: int = "all of ours but those mostly on don't-care"
    phantoms: int = "reported objects that hardly overlap a true one"
    mean_error: float = "of the paper's E, each capped at 2; 0 is best"
    median_error: float = "of the same, 0 to 2"
    mean_iou: float = "over all scored objects, 0 to 1"
    mean_boundary_f: float = "over all scored objects, 0 to 1"
    recall_50: float = "share of the true objects found with IoU >= 0.5"
    precision_50: float = "share of ours with IoU >= 0.5"


@of_cpp
def disparity_errors(ours_px: FloatsLike, truth_px: FloatsLike, excluded: MaskLike = None, skip_left: int = 0) -> DisparityErrors:
    """Compares two disparity maps, (H, W) float32 in px, NaN = a hole, no truth. excluded: (H, W) uint8, pixels that are not 0
    are left out; columns x < skip_left are left out, too."""
    if skip_left < 0:
        raise Error(f"skip_left: found {skip_left}, expected 0 or more")


@of_cpp
def object_errors(ours: LabelsLike, truth: LabelsLike, min_area: int = DEFAULTS["min_area"],
                  boundary_tolerance: float = DEFAULTS["boundary_tolerance"]) -> ObjectErrors:
    """Compares a map of objects with the truth of the same size: (H, W) integers, 0 = none; truth -1 = don't care. min_area:
    px, smaller true objects are not scored; boundary_tolerance: % of the image's diagonal."""
    if min_area < 0 or not 0 <= boundary_tolerance <= 100:
        raise Error(f"object_errors: found min_area {min_area}, boundary_tolerance {boundary_tolerance}, expected at least 0, "
                    "and 0 … 100")
    if ours.min() < 0 or truth.min() < -1:
        raise Error("object_errors: found a negative id, expected ids from 0 on (truth: -1 = don't care)")


@of_cpp
def summarise(frames: Sequence[ObjectErrors]) -> ObjectSummary:
    """A summary of many frames' object_errors()."""


# ---- diagnosis ----


@describes(_cairn.PairMeasures, Report)
class PairMeasures:
    """Result of measure_pair(): the numbers of `cairn doctor --json` (docs/formats.md) as items and attributes, e.g.
    measures.offset_rows; None where one was not measured."""

    size: Tuple[int, int] = "(width, height), px"
    identical: bool = "the right image is the left one, pixel for pixel"
    disparities_px: NDArray[numpy.float32] = (
        "float32, px, ascending: of the points that agree and are not alone with theirs; a copy")

    def disparity_px(self, share: float) -> float:
        """The disparity, px, that `share` (0 to 1) of the points stay below; NaN without points."""
        if not 0 <= share <= 1:
            raise Error(f"share: found {share:g}, expected 0 … 1")
        return self._disparity(share)


@describes(_cairn.Synchrony, Report)
class Synchrony:
    """Whether the two cameras of a sequence took their images at the same moments: the numbers of `cairn doctor --json`
    (docs/formats.md) as items and attributes: lag is how many frames the right camera is late."""

    tells: bool = "whether the numbers tell one lag from another: False where too little moves"


@describes(None, Report)
class Finding:
    """One thing that is wrong with a rig, as `cairn doctor --json` has it (docs/formats.md): severity, value, number, unit,
    says and remedy as items and attributes."""

    kind: str = "what it is, 'cameras swapped'; `cairn doctor` calls it the same", lambda self: self["finding"]


def report_of(cls, text, **more):
    made = cls.__new__(cls)
    made._json = text
    vars(made).update(more)
    return made


@of_cpp
def measure_pair(left: ImageLike, right: ImageLike, *, exec: Optional[Exec] = None, bgr: bool = False) -> PairMeasures:
    """Measures what diagnose() judges: rows, disparities, brightness, exposure and sharpness of a pair. left, right: (H, W) or
    (H, W, 3) uint8 of one size; they need not be rectified."""


@of_cpp
def measure_synchrony(pairs: Iterable[Tuple[ImageLike, ImageLike]], *, bgr: bool = False,
                      exec: Optional[Exec] = None) -> Synchrony:
    """Measures whether both cameras of consecutive pairs, (left, right) each and all of one size, took their images at the same
    moments. All of them are held at once; of fewer than 8 only repeats are measured."""
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


diagnose.__doc__ = """What is wrong with a pair, a list of Finding, a cause before what follows from it; [] for a good one. As in
segment(), a Calibration brings its number of disparities as default and must be of the images' size; without rig no calibration
is judged. Of the options only min_disparity and num_disparities count: the range that would be searched. Of a Synchrony: a
Finding, or None where the cameras run together.

limits, a dict of what is to differ:
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
    """A pair to tune on, with what is known to be true of it. Borrows its arrays, as segment() does."""

    name: str = "as errors call it; frames of one name show the same scene", lambda self: self._name
    objects: Optional[NDArray[numpy.int32]] = "(H, W) int32, the true ids; None where not known", lambda self: self._objects
    truth_px: Optional[NDArray[numpy.float32]] = "(H, W) float32, px; None where not known", lambda self: self._truth_px
    hidden: Optional[NDArray[numpy.uint8]] = "(H, W) uint8; None where not known", lambda self: self._hidden
    partial: bool = "whether objects may be missing in the truth", lambda self: self._partial

    def __init__(self, left: ImageLike, right: ImageLike, rig: RigLike = None, *, objects: Optional[LabelsLike] = None,
                 truth_px: Optional[FloatsLike] = None, hidden: MaskLike = None, partial: bool = False, name: str = "",
                 bgr: bool = False) -> None:
        """left, right, rig, bgr: as for segment(). objects: (H, W) integers, the true objects' ids, 0 = none, -1 = don't care;
        truth_px: (H, W) float32, true disparities in px, NaN = not known; hidden: (H, W) uint8, not 0 = not seen by the right
        camera; each may be None. partial: not every object is labelled. name: frames of one name show the same scene."""
        if left.shape != right.shape:
            _cairn.measure_pair(left, right, NO_EXEC)  # refuses them
        if objects is not None and objects.min() < -1:
            y, x = divmod(int(objects.argmin()), objects.shape[1])
            raise Error(f"objects: found {objects[y, x]} at x {x}, y {y}, expected ids from 0 on, or -1 = don't care")
        self._left, self._right, self._calibration, self._objects = left, right, rig, objects
        self._truth_px, self._hidden, self._partial, self._name = truth_px, hidden, partial, name


@checked
def load_tuning_frames(folder: PathLike, truth: bool = False) -> List[TuningFrame]:
    """Every frame of a folder, as `cairn tune` reads them: a folder with left.png and right.png is one, else each of its
    sub-folders with those; a calib.txt belongs to it. truth: with objects.png, disp_left.png and occlusion.png, of which one of
    the first two must be there."""
    return [TuningFrame(**frame) for frame in _cairn.tuning_frames(folder, truth)]


@describes(None, Report)
class Tuning:
    """What tune() found: `config`, and what `cairn tune --json` writes (docs/formats.md) as items and attributes: goal, found,
    tuned_on, held_out, gain, kept_because, …."""

    config: Config = "the Config to use: the tuned one, or the start where that is kept", lambda self: self._config


@of_cpp
def tunables(patterns: Sequence[str] = ("*",)) -> List[str]:
    """The names of the options that tune() can search: those that the patterns ('match.window_size', 'match.*', '*') name, in
    the order of options()."""


@checked
def tune(frames: Iterable[Union[TuningFrame, Tuple[ImageLike, ImageLike]]], *, options: Sequence[str] = (),
         budget_s: float = DEFAULTS["budget_s"], evaluations: int = DEFAULTS["evaluations"],
         holdout: float = DEFAULTS["holdout"], seed: int = DEFAULTS["seed"],
         progress: Optional[Callable[[Dict[str, Any]], object]] = None, preset: str = "default",
         config: Union[Config, PathLike, None] = None, exec: Optional[Exec] = None, **groups) -> Tuning:
    """Searches the options that do best on frames of yours, as `cairn tune` does (docs/tune.md). Returns a Tuning.
    frames: a TuningFrame or (left, right) each; all are held at once. options: patterns as tunables() takes them, none = a
    sensible choice. budget_s: seconds, more than 0; the start is measured all the same. evaluations: end after this number as
    well, for a result that does not depend on the machine's speed; 0 = no limit. holdout: 0 to 0.9, the share of the frames
    that only judge the result. seed: which frames these are, and in which order options are tried. progress: called before each
    evaluation with a dict: goal, evaluations, seconds, share (0 to 1), before and best (mean losses; None until the start is
    measured). Ctrl-C (KeyboardInterrupt) ends the search and keeps the best so far. The search starts from preset, config and
    the options, as in segment(). Other Python threads run meanwhile. Raises cairn.Error for what cannot be used."""
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
    text, best = _cairn.tune(held, base, exec, options, budget_s, evaluations, holdout, seed, progress)
    return report_of(Tuning, text, _config=best)
