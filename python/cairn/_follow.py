# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Sequences: camera trajectory and object tracks."""

from __future__ import annotations

import json

import numpy as np

from . import _cairn
from ._calls import ALL_GROUPS, GROUPS, ArgumentError, checked, describes, doc, image, of_cpp, shown
from ._cairn import Error
from ._frame import Frame
from ._options import base_of, settings_of
from ._scores import Finding, report_of


def matrix(value, name, side):
    """A square matrix of finite numbers."""
    expected = f"expected {side} x {side} numbers"
    try:
        numbers = np.ascontiguousarray(value, np.float64)
    except (TypeError, ValueError):
        raise ArgumentError(f"{name}: found {shown(value)}, {expected}") from None
    if numbers.shape != (side, side):
        raise Error(f"{name}: found an array of shape {numbers.shape}, {expected}")
    if not np.isfinite(numbers).all():
        raise Error(f"{name}: found a number that is not finite, {expected}")
    return numbers


def pose_from(value, name):
    pose = matrix(value, name, 4)
    rotation = pose[:3, :3]
    is_rotation = np.abs(rotation @ rotation.T - np.eye(3)).max() < 1e-3 and np.linalg.det(rotation) > 0
    if not is_rotation or pose[3].tolist() != [0, 0, 0, 1]:
        raise Error(f"{name}: found no rigid motion, expected a rotation and a translation above a row of 0, 0, 0, 1")
    return pose


def stamp_from(stamp_ns, seconds):
    if (stamp_ns is None) == (seconds is None):
        found = "neither it nor seconds" if seconds is None else "seconds as well"
        raise ArgumentError(f"stamp_ns: found {found}, expected one of the two")
    if seconds is None:
        if not hasattr(stamp_ns, "__index__"):
            raise ArgumentError(f"stamp_ns: found {shown(stamp_ns)}, expected a whole number")
        return int(stamp_ns)
    if not abs(seconds) < 9.2e9:
        raise Error(f"seconds: found {seconds!r}, expected ±9.2e9 at most")
    return round(seconds * 1e9)


def settings(config, preset, options):
    own = {group: values for group, values in options.items() if group not in GROUPS and group in ALL_GROUPS}
    of_frame = settings_of({group: values for group, values in options.items() if group not in own})
    base, file = base_of(config, preset)
    if base is not None:
        base = base._with(of_frame, [])
    return _cairn.FollowSettings(base, preset, file, of_frame, settings_of(own, own))


@describes(_cairn.Track)
class Track:
    """An object tracked over time. Metric values are in the map frame unless stated otherwise: x forward, y left, z up,
    origin on the floor below the camera of the first frame."""

    id: int = doc("track id, from 1; never reused in a run")
    state: str = doc("'tentative', 'confirmed', 'occluded', 'out_of_view', 'lost' or 'dead'")
    is_moving: bool = doc("True if the object itself moves, not only the camera")
    object: int = doc("id of its Object in this frame; 0 = not seen")
    parts: List[int] = doc("ids of further objects in this frame that are parts of it")
    is_joined: bool = doc("True if it forms one object with another track in this frame")
    position_m: Optional[Tuple[float, float, float]] = doc("(x, y, z), m; None without a rig or until one is measured")
    covariance_m2: Optional[NDArray[numpy.float64]] = doc("3 x 3 covariance of position_m, m²; None without a rig")
    velocity_m_s: Optional[Tuple[float, float, float]] = doc("(x, y, z), m/s; 0 if static; None without a rig")
    extent_m: Optional[Tuple[float, float, float]] = doc(
        "(x, y, z) size of the box around its points in the camera frame, m; None without a rig")
    confidence: float = doc("0 to 1, smoothed")
    hits: int = doc("number of frames in which it was seen")
    misses: int = doc("number of frames since it was last seen in which it should have been visible")
    first_ns: int = doc("stamp of its first frame, ns")
    last_ns: int = doc("stamp of the frame in which it was last seen, ns")


@describes(_cairn.Motion)
class Motion:
    """The camera motion estimated from one frame, or the reason why it was refused."""

    now_from_before: NDArray[numpy.float64] = doc(
        "4 x 4 transform of points from the previous camera frame to this one; a substitute if refused")
    covariance: NDArray[numpy.float64] = doc(
        "6 x 6 covariance of the pose relative to the keyframe, translation (m) before rotation (rad)")
    refusal: str = doc("'none' if the motion was estimated, else the reason: 'few_points', 'no_rig', …")
    is_new_keyframe: bool = doc("True if this frame is the keyframe of the next motions")
    is_new_segment: bool = doc("True if only a guess relates the poses from here on to the earlier ones")
    followed: int = doc("number of tracked corners")
    inliers: int = doc("number of corners consistent with the motion")
    inlier_share: float = doc("0 to 1: share of inliers among the tracked corners")
    chi2_per_dof: float = doc("chi-squared per degree of freedom; 1 if errors are as large as assumed")


@describes(_cairn.MotionPrior)
class MotionPrior:
    """The camera motion since the previous frame, measured by another sensor."""

    now_from_before: NDArray[numpy.float64] = doc(
        "4 x 4 float64: transform of points from the previous camera frame to this one")
    covariance: NDArray[numpy.float64] = doc("6 x 6 float64, translation (m) before rotation (rad)")
    kind: str = doc("'wheels' or 'gyroscope'", lambda self: "gyroscope" if self._is_gyroscope else "wheels")

    def __init__(self, now_from_before: MatrixLike, covariance: MatrixLike, kind: str = "wheels") -> None:
        """now_from_before: 4 x 4 transform of points from the previous camera frame to this one. covariance: 6 x 6,
        translation (m) before rotation (rad). kind: 'wheels', or 'gyroscope', of which only the rotation is used."""
        if kind not in ("wheels", "gyroscope"):
            raise Error(f"kind: found '{kind}', expected 'wheels' or 'gyroscope'")
        motion = pose_from(now_from_before, "now_from_before")
        self._start(motion, matrix(covariance, "covariance", 6), kind == "gyroscope")


@describes()
class Step:
    """The results of one frame of a sequence."""

    index: int = doc("frame number, from 0")
    stamp_ns: int = doc("time of capture, ns")
    seconds: float = doc("time of capture, s", lambda self: self.stamp_ns * 1e-9)
    is_lost: bool = doc("True if the camera pose is unknown")
    map_from_camera: NDArray[numpy.float64] = doc(
        "4 x 4 float64: pose of the left camera, the transform of points from its frame to the map frame")
    pose_covariance: NDArray[numpy.float64] = doc(
        "6 x 6 covariance of map_from_camera, translation (m) before rotation (rad)")
    motion: Motion = doc("camera motion, a Motion")
    tracks: List[Track] = doc("list of Track by id, including those out of view")
    ids: NDArray[numpy.int64] = doc("(H, W) int64, read-only: track id of each pixel; 0 = none")
    odometry_suspect: bool = doc("True if most tracks began to move at once; the camera motion is probably wrong")
    reliability: Dict[str, Any] = doc(
        "reliability of the frame: value (0 ... 1 or None), the witnesses whose geometric mean it is, and the name of "
        "the weakest one; steadiness, for comparing settings; is_unreliable, after ten weak frames")
    control: Optional[Dict[str, Any]] = doc(
        "better option found at this frame, or None: option, value, before, lead (share) and is_set "
        "(control={'method': 'watch'} or 'tune')")
    landmarks: Dict[int, int] = doc("landmark id by track id; only from follow()", lambda self: self._landmarks)
    events: List[Tuple[str, int]] = doc(
        "changes of landmarks: (kind, landmark id), kind 'new', 'moved', 'gone', 'back' or 'relocated'; "
        "only from follow()", lambda self: self._events)
    frame: Frame = doc("results of the pair, a Frame", lambda self: Frame._of(self._left, self._data.frame, self._how))

    @classmethod
    def _of(cls, left, data, how, line, landmarks, events):
        step = cls.__new__(cls)
        step._left, step._data, step._how, step._line, step._landmarks, step._events = left, data, how, line, landmarks, events
        return step

    def to_json(self) -> str:
        """The line of tracks.jsonl for this frame, as printed by `cairn follow --json-lines` (docs/formats.md)."""
        return _cairn.step_json(self._data, *self._line)

    def overlay(self) -> NDArray[numpy.uint8]:
        """The left image with the tracks and their ids drawn in: (h, w, 3) uint8, RGB."""
        return _cairn.draw_tracks(self._left, self._data)

    def _repr_png_(self) -> bytes:
        return _cairn.png_bytes(self.overlay())


@describes(groups=ALL_GROUPS)
class Follower:
    """Tracks the camera and the objects through a sequence, pair by pair."""

    rig: Optional[Rig] = doc("Rig used for measurements, or None", lambda self: self._calibration.rig)

    def __init__(self, rig: RigLike = None, *, preset: str = "default", config: Union[Config, PathLike, None] = None,
                 exec: Optional[Exec] = None, **options) -> None:
        """rig: a Rig, a Calibration or None; without one there are ids, but no metres and no motion.
        Raises cairn.Error for invalid input.
        preset, config (a Config or a file name) and options are those of segment(), plus the groups of
        follow_options(): tracking={'min_hits': 2}."""
        self._calibration, self._exec = rig, exec
        self._pairs = _cairn.Pairs(settings(config, preset, options), rig, exec)

    def next(self, left: ImageLike, right: Optional[ImageLike] = None, stamp_ns: Optional[Any] = None, *,
             seconds: Optional[float] = None, disparity_map: Optional[DisparitiesLike] = None,
             prior: Optional[MotionPrior] = None, pose: Optional[MatrixLike] = None, bgr: bool = False) -> Step:
        """Processes the next frame and returns its Step. stamp_ns or seconds: time of capture, later than that of the
        previous frame. disparity_map: an external map instead of right, (H, W) float32 in px, NaN = hole, also
        everywhere; of depths in m it is rig.focal_px * rig.baseline_m / depth - rig.doffs_px. prior: a MotionPrior since
        the previous frame. pose: 4 x 4 map_from_camera, if the robot knows it; no motion is estimated then. Raises
        cairn.Error if the size differs from that of the first pair, or the stamp is not later. One that is more than
        1 s earlier begins a new run: the clock was set back."""
        stamp = stamp_from(stamp_ns, seconds)
        known = None if pose is None else pose_from(pose, "pose")
        if (right is None) == (disparity_map is None):
            raise Error("right, disparity_map: found both or neither, expected one of the two")
        if disparity_map is None:
            data, how = self._pairs.next(left, right, stamp, prior, known)
        else:
            data, how = self._pairs.next_given(left, disparity_map, stamp, prior, known)
        return Step._of(left, data, how, (str(data.index), "", []), {}, [])

    def prefetch(self, left: ImageLike, right: ImageLike, *, bgr: bool = False) -> None:
        """Begins the segmentation of the pair after the next one, in the background, like Segmenter.prefetch(): call it
        before next() of the next pair. follow() does so."""
        self._pairs.prefetch(left, right)

    def __getitem__(self, name: str) -> str:
        """The value of an option by its full name, as text."""
        found = {option.name: option._text for option in self._pairs.options()}
        if name not in found:
            raise Error(f"unknown option '{name}', did you mean '{_cairn.nearest(name, list(found))}'?")
        return found[name]


@describes()
class Following:
    """Result of follow(): an iterator of Steps over a source."""

    rig: Optional[Rig] = doc("Rig of the source, or None", lambda self: self._sequence.rig())
    size: Optional[int] = doc("largest number of frames, for videos an estimate; None if unknown", lambda self: self._sequence.size())
    remarks: List[Tuple[str, int]] = doc(
        "remarks on frames of the source so far: (text, number of frames)", lambda self: self._sequence.remarks())
    findings: List[Finding] = doc(
        "what is wrong with the rig, judged like in `cairn follow` (docs/doctor.md): list of Finding as of the last Step",
        lambda self: [report_of(Finding, fault) for fault in self._sequence.findings()])
    ended_early: str = doc("why the source ended early; '' if it did not", lambda self: self._sequence.ended_early())

    def __iter__(self) -> Following:
        return self

    def __next__(self) -> Step:
        followed = self._sequence.next()
        if followed is None:
            raise StopIteration
        left, data, how = followed.parts()
        return Step._of(image(left, "left", self._exec, False), data, how, followed.line(), followed.landmarks, followed.events)

    def __enter__(self) -> Following:
        return self

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        self.close()

    def close(self) -> None:
        """Ends the run, also in the map. Reading to the end does this automatically."""
        self._sequence.close()


def follow(source: PathLike, *, calib: Optional[PathLike] = None, layout: str = "", rate_hz: float = 0.0, frames: str = "",
           rectify: bool = False, binning: int = 1, topics: str = "", disparity: PathLike = "", depth_image: PathLike = "",
           depth_units: Optional[float] = None, odometry_file: Optional[PathLike] = None, imu_file: Optional[PathLike] = None,
           poses_file: Optional[PathLike] = None, map_file: Optional[PathLike] = None, read_only: bool = False,
           preset: str = "default", config: Union[Config, PathLike, None] = None, exec: Optional[Exec] = None,
           **options) -> Following:
    """Tracks camera and objects through a whole sequence. Returns a Following, an iterator of Steps.
    source: a folder of frames, a folder of KITTI or EuRoC, 'LEFT,RIGHT', or a video with layout (docs/sequences.md). calib:
    replaces the calibration of the source. frames: 'A:B:STEP'. rectify: True for raw images. binning: N x N
    pixels in one. topics, disparity, depth_image, depth_units: depth from elsewhere (docs/bring_your_own_depth.md). odometry_file, imu_file,
    poses_file: motion measured by other sensors. map_file: landmarks to recognise and to extend; read_only: leaves it
    unchanged. The arguments are the options of `cairn follow` and give the same steps.
    preset, config (a Config or a file name) and options are those of segment(), plus the groups of
    follow_options(): tracking={'min_hits': 2}."""
    if sum(file is not None for file in (odometry_file, imu_file, poses_file)) > 1:
        raise Error("odometry_file, imu_file, poses_file: found more than one, expected one of the three")
    if read_only and map_file is None:
        raise Error("read_only: found True without map_file, expected both")
    following = Following()
    following._exec = exec
    following._sequence = _cairn.follow(settings(config, preset, options), exec, source,
                                        (calib or "", layout, rate_hz, frames, rectify, topics, disparity, depth_image,
                                         depth_units, binning),
                                        (odometry_file, imu_file, poses_file, None, map_file, read_only, None))
    return following


follow = checked(follow, groups=ALL_GROUPS)


@of_cpp
def follow_options() -> List[Option]:
    """The options of sequences with their defaults, in the order of the stages. options() lists those of a frame."""


@checked
def score_sequence(result: PathLike, truth: PathLike, min_area: int = 200, tentative: bool = False) -> Dict[str, Any]:
    """Compares a followed sequence with its truth: the summary of `cairn evaluate --sequence --json` (docs/evaluation.md).
    result: what `cairn follow -o` wrote, or a MOTS text. truth: a folder of frames or a MOTS text. min_area: px, smaller
    true objects are ignored. tentative: unconfirmed tracks count as well."""
    return json.loads(_cairn.score_sequence(result, truth, min_area, tentative))
