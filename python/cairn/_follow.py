# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Sequences: the camera's way and the objects over time."""

from __future__ import annotations

import numpy as np

from . import _cairn
from ._calls import ALL_GROUPS, GROUPS, ArgumentError, checked, describes, image, of_cpp, shown
from ._cairn import Error
from ._frame import Frame
from ._options import base_of, settings_of


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
    """An object over time. Metres are those of the map's frame: z up, its origin on the floor below the first frame's camera, x
    forward."""

    id: int = "from 1; never used twice in a run"
    state: str = "'tentative', 'confirmed', 'occluded', 'out_of_view', 'lost' or 'dead'"
    is_moving: bool = "by itself, not by the camera's motion"
    object: int = "id of its Object in this frame; 0 = not seen"
    parts: List[int] = "ids of further objects of this frame that are pieces of it"
    is_joined: bool = "this frame shows it as one object with another track"
    position_m: Optional[Tuple[float, float, float]] = "(x, y, z), m; None without a rig"
    covariance_m2: Optional[NDArray[numpy.float64]] = "3 x 3 of position_m, m²; None without a rig"
    velocity_m_s: Optional[Tuple[float, float, float]] = "(x, y, z), m/s; 0 if static; None without a rig"
    extent_m: Optional[Tuple[float, float, float]] = (
        "(x, y, z) in the camera's frame, m: the box around its points; None without a rig")
    confidence: float = "0 to 1, smoothed"
    hits: int = "frames in which it was seen"
    misses: int = "frames since then in which it should have been seen"
    first_ns: int = "stamp of its first frame, ns"
    last_ns: int = "stamp when it was last seen, ns"


@describes(_cairn.Motion)
class Motion:
    """The camera's motion that one frame shows, or why it shows none."""

    now_from_before: NDArray[numpy.float64] = "4 x 4: points of the frame before go to this one; where refused, its stand-in"
    covariance: NDArray[numpy.float64] = "6 x 6 of the pose against the keyframe, translation (m) before rotation (rad)"
    refusal: str = "'none' where it was estimated, else why not: 'few_points', 'no_rig', …"
    is_new_keyframe: bool = "whether the next motions are against this frame"
    is_new_segment: bool = "whether only a guess ties what is seen from here on to what was seen before"
    followed: int = "corners that were followed"
    inliers: int = "corners that agree"
    inlier_share: float = "0 to 1: of the corners that were followed"
    chi2_per_dof: float = "1 where errors are as large as assumed"


@describes(_cairn.MotionPrior)
class MotionPrior:
    """What another sensor says of the camera's motion since the frame before."""

    now_from_before: NDArray[numpy.float64] = "4 x 4 float64"
    covariance: NDArray[numpy.float64] = "6 x 6 float64"
    kind: str = "'wheels' or 'gyroscope'", lambda self: "gyroscope" if self._is_gyroscope else "wheels"

    def __init__(self, now_from_before: MatrixLike, covariance: MatrixLike, kind: str = "wheels") -> None:
        """now_from_before: 4 x 4, takes points of the camera's frame then to its frame now. covariance: 6 x 6, translation (m)
        before rotation (rad). kind: 'wheels', or 'gyroscope', of which only the rotation counts."""
        if kind not in ("wheels", "gyroscope"):
            raise Error(f"kind: found '{kind}', expected 'wheels' or 'gyroscope'")
        return pose_from(now_from_before, "now_from_before"), matrix(covariance, "covariance", 6), kind == "gyroscope"


@describes()
class Step:
    """All that is known after one frame of a sequence."""

    index: int = "the frame's number, from 0"
    stamp_ns: int = "when it was taken, ns"
    seconds: float = "when it was taken, s", lambda self: self.stamp_ns * 1e-9
    is_lost: bool = "whether the camera's place is not known"
    map_from_camera: NDArray[numpy.float64] = "4 x 4 float64: where the left camera is; takes points of its frame to the map's"
    pose_covariance: NDArray[numpy.float64] = "6 x 6 of map_from_camera, translation (m) before rotation (rad)"
    motion: Motion = "the camera's Motion"
    tracks: List[Track] = "a list of Track by id, those out of view included"
    ids: NDArray[numpy.int64] = "(H, W) int64, read-only: the track that each pixel belongs to; 0 = none"
    odometry_suspect: bool = "whether most tracks began to move at once: rather the camera's motion is wrong"
    reliability: Dict[str, Any] = (
        "how far the frame is to be trusted: value (0 ... 1 or None), the witnesses it is the mean of, and the weakest one's name")
    control: Optional[Dict[str, Any]] = (
        "the option that the search for better ones found at this frame, or None: option, value, before, lead (share) and is_set "
        "(control={'method': 'watch'} or 'tune')")
    landmarks: Dict[int, int] = "of follow(): landmark by track, both by id", lambda self: self._landmarks
    events: List[Tuple[str, int]] = (
        "of follow(): (kind, landmark), kind 'new', 'moved', 'gone', 'back' or 'relocated'", lambda self: self._events)
    frame: Frame = "the Frame", lambda self: Frame._of(self._left, self._data.frame, self._how)

    @classmethod
    def _of(cls, left, data, how, json, landmarks, events):
        step = cls.__new__(cls)
        step._left, step._data, step._how, step._json, step._landmarks, step._events = left, data, how, json, landmarks, events
        return step

    def to_json(self) -> str:
        """The frame's line of tracks.jsonl, as `cairn follow --json-lines` prints it (docs/formats.md)."""
        return self._json

    def overlay(self) -> NDArray[numpy.uint8]:
        """The left image with its tracks drawn in, each with its id: (h, w, 3) uint8, RGB."""
        return _cairn.draw_tracks(self._left, self._data)

    def _repr_png_(self) -> bytes:
        return _cairn.png_bytes(self.overlay())


ABOUT = ("preset, config (a Config or a file's name) and options are those of segment(), with the groups of follow_options()\n"
         "besides: tracking={'min_hits': 2}.")


def start_follower(self, rig: RigLike = None, *, preset: str = "default", config: Union[Config, PathLike, None] = None,
                   exec: Optional[Exec] = None, **options) -> None:
    self._calibration, self._exec = rig, exec
    self._pairs = _cairn.Pairs(settings(config, preset, options), rig, exec)


start_follower.__name__ = "__init__"
start_follower.__doc__ = f"""rig: a Rig, a Calibration or None: then there are ids, but no metres and no motion. Raises cairn.Error for
what cannot be used. {ABOUT}"""


@describes()
class Follower:
    """Follows the camera and the objects through a sequence, pair by pair."""

    rig: Optional[Rig] = "the Rig that it measures with, or None", lambda self: self._calibration.rig

    __init__ = checked(start_follower, "Follower", groups=ALL_GROUPS)

    def next(self, left: ImageLike, right: ImageLike, stamp_ns: Optional[Any] = None, *, seconds: Optional[float] = None,
             prior: Optional[MotionPrior] = None, pose: Optional[MatrixLike] = None, bgr: bool = False) -> Step:
        """The next frame: a Step. stamp_ns or seconds: when it was taken, later than the one before. prior: a MotionPrior since
        the frame before. pose: 4 x 4 map_from_camera of a robot that knows where it is; then no motion is estimated. Raises
        cairn.Error for another size than the first pair's and stamps that do not rise."""
        stamp = stamp_from(stamp_ns, seconds)
        known = None if pose is None else pose_from(pose, "pose")
        data, json, how = self._pairs.next(left, right, stamp, prior, known)
        return Step._of(left, data, how, json, {}, [])

    def __getitem__(self, name: str) -> str:
        """The value of an option by its full name, as text."""
        found = {option.name: option._text for option in self._pairs.options()}
        if name not in found:
            raise Error(f"unknown option '{name}', did you mean '{_cairn.nearest(name, list(found))}'?")
        return found[name]


@describes()
class Following:
    """What follow() returns: an iterator of Steps over a source."""

    rig: Optional[Rig] = "the source's Rig, or None", lambda self: self._sequence.rig()
    size: Optional[int] = "frames at most; None where it is not known", lambda self: self._sequence.size()
    remarks: List[Tuple[str, int]] = (
        "what was noticed of the source's frames up to now: (words, frames)", lambda self: self._sequence.remarks())
    ended_early: str = "why the source ended before its end; '' where it did not", lambda self: self._sequence.ended_early()

    def __iter__(self) -> Following:
        return self

    def __next__(self) -> Step:
        followed = self._sequence.next()
        if followed is None:
            raise StopIteration
        left, data, how = followed.parts()
        return Step._of(image(left, "left", self._exec, False), data, how, followed.json, followed.landmarks, followed.events)

    def __enter__(self) -> Following:
        return self

    def __exit__(self, kind: Any, error: Any, trace: Any) -> None:
        self.close()

    def close(self) -> None:
        """Ends the run, in the map, too; reading to the end does so by itself."""
        self._sequence.close()


def follow(source: PathLike, *, calib: Optional[PathLike] = None, layout: str = "", rate_hz: float = 0.0, frames: str = "",
           rectify: bool = False, odometry_file: Optional[PathLike] = None, imu_file: Optional[PathLike] = None,
           poses_file: Optional[PathLike] = None, map_file: Optional[PathLike] = None, read_only: bool = False,
           preset: str = "default", config: Union[Config, PathLike, None] = None, exec: Optional[Exec] = None,
           **options) -> Following:
    if sum(file is not None for file in (odometry_file, imu_file, poses_file)) > 1:
        raise Error("odometry_file, imu_file, poses_file: found more than one, expected one of the three")
    if read_only and map_file is None:
        raise Error("read_only: found True without map_file, expected both")
    following = Following()
    following._exec = exec
    following._sequence = _cairn.follow(settings(config, preset, options), exec, source, calib, layout, rate_hz, frames, rectify,
                                        odometry_file, imu_file, poses_file, map_file, read_only)
    return following


follow.__doc__ = f"""Follows a whole sequence: an iterator of Steps.
source: a folder of frames, of KITTI's or EuRoC's, 'LEFT,RIGHT', or a video with layout (docs/sequences.md). calib: instead of the
source's own. frames: 'A:B:STEP'. rectify: the images are raw. odometry_file, imu_file, poses_file: what other sensors say of the
motion. map_file: landmarks to recognise and to add to; read_only: it stays as it is. These are the options of `cairn follow`, and
the steps are its own. {ABOUT}"""
follow = checked(follow, groups=ALL_GROUPS)


@of_cpp
def follow_options() -> List[Option]:
    """Every option of sequences with its default, in the order of the stages; those of a frame are in options()."""
