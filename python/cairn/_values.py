# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Rigs, and what the stages return. Each class here describes the class of C++ with its name."""

from __future__ import annotations

import enum

import numpy as np

from . import _cairn
from ._calls import describes, of_cpp
from ._cairn import Error

NO_MATCH, HOLE_16 = _cairn.NO_MATCH, _cairn.HOLE_16
Reject = enum.IntFlag("Reject", [("none", 0), *((name, bit) for name, bit, _ in _cairn.REASONS)], module="cairn")
Reject.__doc__ = ("Why a pixel has no disparity: a set of bits, as in frame.reject.\n"
                  "    frame.reject & cairn.Reject.left_right != 0   # seen by one camera only\n"
                  + "; ".join(f"{name}: {says}" for name, _, says in _cairn.REASONS) + ".")


# ---- rigs ----


class Rig:
    """The calibration of a rectified pair (C++: StereoRig). Depth in metres: Z = focal_px * baseline_m / (d + doffs_px), d in
    px."""

    focal_px: float = "focal length, px"
    baseline_m: float = "distance of the cameras, m"
    cx_px: float = "principal point of the left camera, px"
    cy_px: float = "principal point of the left camera, px"
    doffs_px: float = "cx of the right camera less cx of the left one, px"

    def __init__(self, focal_px: float, baseline_m: float, cx_px: float = 0.0, cy_px: float = 0.0, doffs_px: float = 0.0) -> None:
        """Raises cairn.Error unless every number is finite and focal length and baseline are positive."""
        return focal_px, baseline_m, cx_px, cy_px, doffs_px

    @staticmethod
    def from_file(path: PathLike) -> Rig:
        """The rig of a calibration file, see load_calibration(). Raises cairn.Error where it has none."""
        rig = _cairn.load_calibration(path, False).rig
        if rig is None:
            raise Error(f"{path}: found no focal length or no baseline, expected both for a rig")
        return rig

    def point_in_camera_m(self, x: float, y: float, disparity_px: float) -> Optional[Tuple[float, float, float]]:
        """The point (x right, y down, z forward; m) that pixel (x, y) with this disparity shows in the left camera's frame;
        None at or beyond infinity."""
        return self._point(x, y, disparity_px)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _cairn.Rig) and all(getattr(self, name) == getattr(other, name) for name in self._shown)


class Calibration:
    """What a calibration file says of a rectified pair. Takes the place of a Rig everywhere; segment() then also checks the
    images' size and takes the file's number of disparities as default."""

    rig: Optional[Rig] = "None where the file has no focal length or no baseline", lambda self: self._file().rig
    image_size: Optional[Tuple[int, int]] = (
        "(width, height) of the images that it was made for, or None", lambda self: self._file().image_size)
    num_disparities: Optional[int] = "the default of match.num_disparities, or None", lambda self: self._file().num_disparities
    ground_points: List[Tuple[float, float, float, float]] = (
        "points of the floor: (x_left, y_left, x_right, y_right) in px", lambda self: self._ground().points)
    camera_height_m: Optional[float] = (
        "of the left camera above the floor, m, or None", lambda self: self._ground().camera_height_m)
    camera_pitch_deg: float = "degrees; positive looks down", lambda self: self._ground().camera_pitch_deg
    camera_roll_deg: float = (
        "degrees; positive lowers the camera's right side", lambda self: self._ground().camera_roll_deg)
    of_raw_cameras: bool = (
        "whether the file describes the lenses of the raw cameras as well: the rig fits images that were rectified with it",
        lambda self: self._file().of_raw_cameras)

    def __init__(self, rig: Optional[Rig] = None, image_size: Optional[Tuple[int, int]] = None,
                 num_disparities: Optional[int] = None, ground_points: Sequence[Tuple[float, float, float, float]] = (),
                 camera_height_m: Optional[float] = None, camera_pitch_deg: float = 0.0, camera_roll_deg: float = 0.0) -> None:
        """What a file would say, see load_calibration(). ground_points: (x_left, y_left, x_right, y_right) in px of four and
        more points of the floor, for ground={'source': 'points'}. camera_height_m: of the left camera above the floor, for
        'pose'. Raises cairn.Error."""
        return rig, image_size, num_disparities, ground_points, camera_height_m, camera_pitch_deg, camera_roll_deg


@of_cpp
def load_calibration(path: PathLike) -> Calibration:
    """Reads a calibration, its form recognised by content: our own YAML, Middlebury, KITTI, OpenCV FileStorage, ROS camera_info
    (or the folder of a pair of them), key=value lines. Raises cairn.Error."""
    return path, False


# ---- matching ----


class EpipolarOffset:
    """How far the right image's rows are off: what the left one shows in row y is in column x of the right one at row y + rows
    + rows_per_px * (x - (width - 1) / 2)."""

    rows: float = "rows, in the middle column"
    rows_per_px: float = "tangent of the roll"
    points: int = "textured points found again in the right image"
    agreeing: int = "those of them within half a row of this offset"
    outcome: str = "'off', 'too few textured points', 'the points do not agree', 'aligned' or 'corrected'"

    def __init__(self, rows: float = 0.0, rows_per_px: float = 0.0) -> None:
        """rows: -1024 to 1024; rows_per_px: -1 to 1. For shift_rows()."""
        if not (-1024 <= rows <= 1024 and -1 <= rows_per_px <= 1):
            raise Error(f"epipolar offset: found rows {rows}, rows_per_px {rows_per_px}, expected at most ±1024 and ±1")
        return rows, rows_per_px


class EpipolarCorrection:
    """Result of correct_epipolar()."""

    offset: EpipolarOffset = "an EpipolarOffset: what was found"
    right: Optional[NDArray[numpy.uint8]] = "(H, W) uint8, the right image moved; None where the pair is to be matched as it is"


class Matches:
    """Outcome of the correlation for each pixel of the left image (best_right: of the right one). Arrays (H, W), read-only;
    row_offset is None without match.row_band."""

    best: NDArray[numpy.int16] = "int16, disparity of least cost in px; NO_MATCH = none"
    best_right: Optional[NDArray[numpy.int16]] = "int16, the same seen from the right image"
    row_offset: Optional[NDArray[numpy.int8]] = "int8, row of the match minus y"
    cost: NDArray[numpy.float32] = "float32, of best; inf where there is no match"
    runner_up: Optional[NDArray[numpy.float32]] = "float32, least cost with |d - best| > 1; inf = none"
    mean_cost: Optional[NDArray[numpy.float32]] = "float32, over all candidates of the pixel"
    cost_before: Optional[NDArray[numpy.float32]] = "float32, at best - 1; inf = no such candidate"
    cost_after: Optional[NDArray[numpy.float32]] = "float32, at best + 1; inf = no such candidate"


class DisparityMap:
    """Disparity for each pixel of the left image, and for each one without the reason. Arrays (H, W), read-only. A hole is
    where reject is not 0, and there disparity_px is NaN."""

    disparity_px: NDArray[numpy.float32] = "float32, px; NaN = hole"
    reject: NDArray[numpy.uint16] = "uint16, the bits of cairn.Reject; 0 = none"


class SceneDisparity:
    """Disparity with everything that speaks against it, ground and speckle included."""

    disparity_map: DisparityMap = "disparity and reject as the DisparityMap that stages take"
    disparity: NDArray[numpy.float32] = (
        "(H, W) float32, px, read-only; NaN = hole", lambda self: self.disparity_map.disparity_px)
    reject: NDArray[numpy.uint16] = "(H, W) uint16, bits of cairn.Reject", lambda self: self.disparity_map.reject
    ground: Ground = "the floor as a plane, or why there is none"
    floor: Optional[NDArray[numpy.uint8]] = "(H, W) uint8, 255 = floor; None where there is none"
    epipolar: EpipolarOffset = "an EpipolarOffset: how far the right image's rows were off, rows"
    confidence: Optional[NDArray[numpy.float32]] = "(H, W) float32, 0 to 1; or None"


# ---- floor and walls ----


class GroundPlane:
    """A plane as the left image's disparity: d = a * x + b * y + c, all in px."""

    a: float = "px of disparity for each px to the right"
    b: float = "px of disparity for each px downwards; a floor's is above 0"
    c: float = "px of disparity at x = 0, y = 0"

    def disparity_px(self, x: float, y: float) -> float:
        """The plane's disparity at (x, y), px; below 0 beyond the horizon."""
        return self._disparity(x, y)

    def __iter__(self) -> Iterator[float]:
        return iter((self.a, self.b, self.c))


class Ground:
    """The floor, or why there is none."""

    plane: Optional[GroundPlane] = "a GroundPlane, or None"
    support: float = "0 to 1: share of the valid pixels under the horizon that lie on it"
    residual_px: float = "root mean square distance of these from it, px"
    refusal: str = "why there is no plane, in words; 'none' where there is one"

    def __bool__(self) -> bool:
        return self.plane is not None


class FloorFrame:
    """Where the floor is, in metres: its frame has its origin on the floor below the left camera, x forward, y left, z up."""

    camera_height_m: float = "of the left camera above the floor, m"
    pitch_rad: float = "of the camera: positive looks down"
    roll_rad: float = "of the camera: positive lowers its right side"
    floor_from_camera: NDArray[numpy.float32] = (
        "4 x 4: takes homogeneous points from the camera's frame to the floor's",
        lambda self: np.array(self._matrix, np.float32).reshape(4, 4))


@of_cpp
def floor_frame(ground: GroundPlane, rig: RigLike) -> Optional[FloorFrame]:
    """Where the floor is: a FloorFrame, or None for a plane that no floor below a camera can show."""
    if rig.rig is None:
        raise Error("rig: found none, expected one: a frame of the floor is in metres")
    return ground, rig.rig


class Background:
    """The planes that bound the scene from behind: floor and walls."""

    planes: List[GroundPlane] = "a list of GroundPlane"
    has_floor: bool = "whether the first of them is the floor"

    def disparity_px(self, x: float, y: float) -> float:
        """Of the nearest of them, at least 0; px."""
        return self._disparity(x, y)


# ---- regions ----


class Region:
    """A set of connected pixels. Mean and variance are over its valid pixels: of grey levels, or of disparities in px."""

    pixel_count: int = "its area, px"
    valid_count: int = "pixels that carry a value"
    box: Tuple[int, int, int, int] = "(x, y, width, height), px"
    mean: float = "of its valid pixels: grey levels, 0 to 255, or px of disparity; 0 without any"
    variance: float = "of its valid pixels (population), at least 0: grey levels squared, or px squared"
    is_floor: bool = "the one floor region of a disparity segmentation"
    is_background: bool = "the region that holds all that is no object, in the groups of a frame"


class Segmentation:
    """Regions: every pixel belongs to one."""

    labels: NDArray[numpy.int32] = "(H, W) int32, read-only: indexes `regions`"
    regions: List[Region] = "a list of Region, in raster order of their first pixel"

    def __len__(self) -> int:
        return len(self.regions)


class Basins:
    """Result of watershed()."""

    labels: NDArray[numpy.int32] = "(H, W) int32, read-only: 0 to count - 1"
    count: int = "number of basins, 1 or more"


class RegionGraph:
    """Regions and which of them touch (4-neighbourhood)."""

    def neighbours(self, region: int) -> List[int]:
        """The regions that touch this one, ascending."""
        if not 0 <= region < len(self):
            raise IndexError("no such region")
        return self._neighbours(region)


class Superpixels:
    """The image cut into connected pieces that no clear edge of brightness, colour or depth runs through."""

    labels: NDArray[numpy.int32] = "(H, W) int32, read-only: 0 to count - 1"
    count: int = "number of superpixels, 1 or more"


class MergeTree:
    """All regions that superpixels fuse to, from the superpixels to the whole image; its length is the number of its nodes.
    Every node comes after its parts."""

    superpixels: int = "number of superpixels: node i below it is superpixel i"
    parents: NDArray[numpy.int32] = "int32, for each node the node that it is a part of; -1 = none"

    def __len__(self) -> int:
        return len(self.parents)


class ChosenObjects:
    """The regions of a MergeTree that are objects."""

    object_of: List[int] = "for each superpixel its object, 1 to len(scores) - 1; 0 = none"
    scores: List[float] = "for each object how likely it is one, 0 to 1; scores[0] = 0"
    likeliest: List[float] = "for each superpixel how likely the likeliest region that holds it is an object, 0 to 1"

    def __len__(self) -> int:
        return len(self.scores) - 1


# ---- objects ----


class Fusion:
    """Which intensity regions make up each fused region: the candidates for objects."""

    labels: NDArray[numpy.int32] = "(H, W) int32, read-only: indexes `parts`"
    parts: List[List[int]] = "for each fused region its intensity regions, ascending"
    disparity_region: List[int] = "for each fused region the disparity region that it follows"
    is_floor: List[bool] = "for each fused region: does it follow the floor?"

    def __len__(self) -> int:
        return len(self.parts)


class FloorBox:
    """A box about what is seen of an object, upright on the floor and turned as it is. In the floor's frame: x forward, y left,
    z up, from the floor below the left camera."""

    centre_in_floor_m: Tuple[float, float, float] = "(x, y, z), m"
    size_m: Tuple[float, float, float] = "(along its longer side, along its shorter one, up), m"
    yaw_rad: float = "-pi/2 to pi/2: of the longer side, counter-clockwise from x as seen from above"
    centre_covariance_m2: NDArray[numpy.float32] = (
        "3 x 3, m^2: how well the centre is known",
        lambda self: np.array(self._covariance, np.float32)[[0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(3, 3))


class Object:
    """An object in front of the background."""

    id: int = "from 1, the nearest, on; its pixels in the map of objects"
    distance_m: Optional[float] = (
        "z of its position, m; None without a rig", lambda self: self.position_in_camera_m and self.position_in_camera_m[2])
    position_in_camera_m: Optional[Tuple[float, float, float]] = (
        "(x right, y down, z forward), m: in the middle of its main part, at the depth of disparity_px; None without a rig")
    extent_in_camera_m: Optional[Tuple[float, float, float]] = (
        "(x, y, z), m: the box around the points of its main part, without wild ones; None without a rig")
    depth_interval_m: Optional[Tuple[float, float]] = (
        "(nearest, farthest), m: where its depth lies with 95 %; None without a rig")
    disparity_px: float = "median of its valid pixels, px"
    disparity_sigma_px: float = "standard deviation of disparity_px, px"
    pixel_count: int = "area of its mask, px"
    box_px: Tuple[int, int, int, int] = "(x, y, width, height), px"
    valid_share: float = "0 to 1: pixels of the mask that have a disparity"
    mean_colour: Tuple[int, int, int] = "(red, green, blue), 0 to 255; grey where the input had no colour"
    edge_share: float = "0 to 1: of its outline, where the image shows an edge"
    cut_share: float = "0 to 1: of its outline, what lies at the image's border"
    confidence: float = "0 to 1: how likely it covers a true object by more than half"
    box_on_floor: Optional[FloorBox] = "its box, upright on the floor: a FloorBox; None without a rig or a ground"


class LeftOut:
    """An obstacle that is no object, and why."""

    reason: str = "'background', 'too small' or 'low confidence'"
    box_px: Tuple[int, int, int, int] = "(x, y, width, height), px"
    pixel_count: int = "area, px"
    disparity_px: float = "mean of its pixels, px"
    position_in_camera_m: Optional[Tuple[float, float, float]] = (
        "(x right, y down, z forward), m: of its middle; None without a rig")
    confidence: float = "0 to 1: the best of a region that holds some of it; 0 where none was judged"


class ObstacleScan:
    """The nearest obstacle in each direction, as a laser scanner has it, seen from the floor below the left camera."""

    angle_min_rad: float = "of the first; counter-clockwise from straight ahead"
    angle_increment_rad: float = "from one to the next"
    range_max_m: float = "how far it reaches, m"
    ranges_m: NDArray[numpy.float32] = "(N,) float32, m; NaN: no obstacle seen there, though there may be one"

    def __len__(self) -> int:
        return len(self.ranges_m)


class ObstacleGrid:
    """Obstacles on the floor: rows along y, from the right to the left, of cells along x, from the camera forward."""

    cell_size_m: float = "side of a cell, m"
    origin_in_floor_m: Tuple[float, float] = "(x, y), m: corner of the first cell", lambda self: self._origin
    cells: NDArray[numpy.int8] = "(height, width) int8: -1 = unknown, 0 = free, 100 = occupied"


class Objects:
    """The objects of a frame, nearest first: a sequence of Object, and their map."""

    labels: NDArray[numpy.int32] = "(H, W) int32, read-only: ids, 0 = no object"

    def __len__(self) -> int:
        return len(self._list)

    def __getitem__(self, index: Union[int, slice]) -> Any:
        """One object, or with a slice a list of some."""
        return self._list[index]

    def __iter__(self) -> Iterator[Object]:
        return iter(self._list)

    def __repr__(self):
        return f"Objects({len(self)}" + "".join(f"\n  {one!r}" for one in self) + ")"


globals().update({name: describes(getattr(_cairn, name))(value) for name, value in list(globals().items())
                  if isinstance(value, type) and value.__module__ == __name__})
