# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Rigs, and the results of stages. Each class here describes the C++ class of the same name."""

from __future__ import annotations

import enum

import numpy as np

from . import _cairn
from ._calls import describes, doc, of_cpp
from ._cairn import Error

NO_MATCH, HOLE_16 = _cairn.NO_MATCH, _cairn.HOLE_16
Reject = enum.IntFlag("Reject", [("none", 0), *((name, bit) for name, bit, _ in _cairn.REASONS)], module="cairn")
Reject.__doc__ = ("Why a pixel has no disparity: a bit set, as in frame.reject.\n"
                  "    frame.reject & cairn.Reject.left_right != 0   # seen by one camera only\n"
                  + "; ".join(f"{name}: {says}" for name, _, says in _cairn.REASONS) + ".")


# ---- rigs ----


class Rig:
    """The calibration of a rectified pair (C++: StereoRig). Depth in metres: Z = focal_px * baseline_m / (d + doffs_px), d in
    px."""

    focal_px: float = doc("focal length, px")
    baseline_m: float = doc("distance between the cameras, m")
    cx_px: float = doc("x of the principal point of the left camera, px")
    cy_px: float = doc("y of the principal point of the left camera, px")
    doffs_px: float = doc("cx of the right camera minus cx of the left one, px")

    def __init__(self, focal_px: float, baseline_m: float, cx_px: float, cy_px: float, doffs_px: float = 0.0) -> None:
        """Raises cairn.Error unless every number is finite and focal length and baseline are positive."""
        self._start(focal_px, baseline_m, cx_px, cy_px, doffs_px)

    @staticmethod
    def from_file(path: PathLike) -> Rig:
        """The rig of a calibration file, see load_calibration(). Raises cairn.Error if it has none."""
        rig = _cairn.load_calibration(path, False).rig
        if rig is None:
            raise Error(f"{path}: found no focal length or no baseline, expected both for a rig")
        return rig

    def point_in_camera_m(self, x: float, y: float, disparity_px: float) -> Optional[Tuple[float, float, float]]:
        """The point of pixel (x, y) with this disparity, in the left camera frame (x right, y down, z forward; m); None
        at or beyond infinity."""
        return self._point(x, y, disparity_px)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _cairn.Rig) and all(getattr(self, name) == getattr(other, name) for name in self._shown)


class Calibration:
    """The contents of a calibration file of a rectified pair. Accepted wherever a Rig is; segment() then also checks
    the image size and uses the number of disparities of the file as default."""

    rig: Optional[Rig] = doc("Rig of the file; None if it has no focal length or no baseline", lambda self: self._file().rig)
    image_size: Optional[Tuple[int, int]] = doc(
        "(width, height) of the images it was made for, or None", lambda self: self._file().image_size)
    num_disparities: Optional[int] = doc(
        "default of match.num_disparities, or None", lambda self: self._file().num_disparities)
    ground_points: List[Tuple[float, float, float, float]] = doc(
        "points on the floor: (x_left, y_left, x_right, y_right) in px", lambda self: self._ground().points)
    camera_height_m: Optional[float] = doc(
        "height of the left camera above the floor, m, or None", lambda self: self._ground().camera_height_m)
    camera_pitch_deg: float = doc(
        "pitch of the left camera, degrees; positive looks down", lambda self: self._ground().camera_pitch_deg)
    camera_roll_deg: float = doc(
        "roll of the left camera, degrees; positive lowers its right side", lambda self: self._ground().camera_roll_deg)
    of_raw_cameras: bool = doc(
        "True if the file also describes the lenses of the raw cameras: the rig is valid for images rectified with it",
        lambda self: self._file().of_raw_cameras)

    def __init__(self, rig: Optional[Rig] = None, image_size: Optional[Tuple[int, int]] = None,
                 num_disparities: Optional[int] = None, ground_points: Sequence[Tuple[float, float, float, float]] = (),
                 camera_height_m: Optional[float] = None, camera_pitch_deg: float = 0.0, camera_roll_deg: float = 0.0) -> None:
        """The contents of a file, see load_calibration(). ground_points: (x_left, y_left, x_right, y_right) in px of
        four or more points on the floor, for ground={'source': 'points'}. camera_height_m: height of the left camera
        above the floor, for 'pose'. Raises cairn.Error."""
        self._start(rig, image_size, num_disparities, ground_points, camera_height_m, camera_pitch_deg, camera_roll_deg)


@of_cpp
def load_calibration(path: PathLike) -> Calibration:
    """Reads a calibration file. Recognises the format by content: our own YAML, Middlebury, KITTI, OpenCV FileStorage,
    ROS camera_info (or the folder of a pair of them), key=value lines. Raises cairn.Error."""
    return path, False


# ---- matching ----


class EpipolarOffset:
    """The row offset of the right image. A point in row y of the left image is at column x and row y + rows +
    rows_per_px * (x - (width - 1) / 2) of the right one."""

    rows: float = doc("offset at the centre column, rows")
    rows_per_px: float = doc("tangent of the roll angle")
    points: int = doc("number of textured points matched in the right image")
    agreeing: int = doc("number of these within half a row of this offset")
    outcome: str = doc("'off', 'too few textured points', 'the points do not agree', 'aligned' or 'corrected'")

    def __init__(self, rows: float = 0.0, rows_per_px: float = 0.0) -> None:
        """rows: -1024 to 1024; rows_per_px: -1 to 1. For shift_rows()."""
        if not (-1024 <= rows <= 1024 and -1 <= rows_per_px <= 1):
            raise Error(f"epipolar offset: found rows {rows}, rows_per_px {rows_per_px}, expected at most ±1024 and ±1")
        self._start(rows, rows_per_px)


class EpipolarCorrection:
    """Result of correct_epipolar()."""

    offset: EpipolarOffset = doc("EpipolarOffset found")
    right: Optional[NDArray[numpy.uint8]] = doc("(H, W) uint8, shifted right image; None if the pair is matched as it is")


class Matches:
    """Result of the correlation for each pixel of the left image (best_right: of the right one). Arrays (H, W),
    read-only; row_offset is None without match.row_band."""

    best: NDArray[numpy.int16] = doc("int16, disparity of lowest cost in px; NO_MATCH = none")
    best_right: Optional[NDArray[numpy.int16]] = doc("int16, the same for the right image")
    row_offset: Optional[NDArray[numpy.int8]] = doc("int8, row of the match minus y")
    cost: NDArray[numpy.float32] = doc("float32, cost of best; inf without a match")
    runner_up: Optional[NDArray[numpy.float32]] = doc("float32, lowest cost with |d - best| > 1; inf = none")
    mean_cost: Optional[NDArray[numpy.float32]] = doc("float32, mean cost over all candidates of the pixel")
    cost_before: Optional[NDArray[numpy.float32]] = doc("float32, cost at best - 1; inf = no such candidate")
    cost_after: Optional[NDArray[numpy.float32]] = doc("float32, cost at best + 1; inf = no such candidate")


class DisparityMap:
    """The disparity of each pixel of the left image, and the reason for every hole. Arrays (H, W), read-only. In a
    hole, reject is not 0 and disparity_px is NaN."""

    disparity_px: NDArray[numpy.float32] = doc("float32, px; NaN = hole")
    reject: NDArray[numpy.uint16] = doc("uint16, the bits of cairn.Reject; 0 = none")


class StereoResult:
    """Disparity after all checks, including ground and speckle, with the reason for every hole."""

    disparity_map: DisparityMap = doc("disparity and reject as a DisparityMap, the input of stages")
    disparity: NDArray[numpy.float32] = doc(
        "(H, W) float32, px, read-only; NaN = hole", lambda self: self.disparity_map.disparity_px)
    reject: NDArray[numpy.uint16] = doc("(H, W) uint16, bits of cairn.Reject", lambda self: self.disparity_map.reject)
    ground: Ground = doc("floor plane, or why there is none")
    floor: Optional[NDArray[numpy.uint8]] = doc("(H, W) uint8, 255 = floor; None if no floor was labelled")
    epipolar: EpipolarOffset = doc("row offset of the right image, an EpipolarOffset")
    confidence: Optional[NDArray[numpy.float32]] = doc("(H, W) float32, 0 to 1, see estimate_confidence(); or None")


# ---- floor and walls ----


class GroundPlane:
    """A plane as disparity in the left image: d = a * x + b * y + c, all in px."""

    a: float = doc("px of disparity per px to the right")
    b: float = doc("px of disparity per px downwards; above 0 for a floor")
    c: float = doc("px of disparity at x = 0, y = 0")

    def disparity_px(self, x: float, y: float) -> float:
        """The plane's disparity at (x, y), px; below 0 beyond the horizon."""
        return self._disparity(x, y)

    def __iter__(self) -> Iterator[float]:
        return iter((self.a, self.b, self.c))


class Ground:
    """The floor plane, or why there is none."""

    plane: Optional[GroundPlane] = doc("a GroundPlane, or None")
    support: float = doc("0 to 1: share of the valid pixels below the horizon on the plane")
    residual_px: float = doc("root mean square distance of these pixels from the plane, px")
    refusal: str = doc("reason for a missing plane, in words; 'none' if there is one")

    def __bool__(self) -> bool:
        return self.plane is not None


class FloorFrame:
    """The floor frame, in metres: origin on the floor below the left camera, x forward, y left, z up."""

    camera_height_m: float = doc("height of the left camera above the floor, m")
    pitch_rad: float = doc("pitch of the camera, rad; positive looks down")
    roll_rad: float = doc("roll of the camera, rad; positive lowers its right side")
    floor_from_camera: NDArray[numpy.float32] = doc(
        "4 x 4 transform of homogeneous points from the camera frame to the floor frame",
        lambda self: np.array(self._matrix, np.float32).reshape(4, 4))


@of_cpp
def floor_frame(ground: GroundPlane, rig: RigLike) -> Optional[FloorFrame]:
    """The FloorFrame of a ground plane; None if the plane cannot be a floor below the camera."""
    if rig.rig is None:
        raise Error("rig: found none, expected one: a frame of the floor is in metres")
    return ground, rig.rig


class Background:
    """The planes that bound the scene from behind: floor and walls."""

    planes: List[GroundPlane] = doc("list of GroundPlane")
    has_floor: bool = doc("True if the first plane is the floor")

    def disparity_px(self, x: float, y: float) -> float:
        """The disparity of the nearest plane at (x, y), px; at least 0."""
        return self._disparity(x, y)


# ---- regions ----


class Region:
    """A set of connected pixels. Mean and variance are over its valid pixels: of grey levels, or of disparities in px."""

    pixel_count: int = doc("area, px")
    valid_count: int = doc("number of pixels with a value")
    box: Tuple[int, int, int, int] = doc("(x, y, width, height), px")
    mean: float = doc("mean of its valid pixels: grey levels, 0 to 255, or px of disparity; 0 without any")
    variance: float = doc("population variance of its valid pixels, at least 0: grey levels squared, or px squared")
    is_floor: bool = doc("True for the one floor region of a disparity segmentation")
    is_background: bool = doc("True for the region of everything but the objects, in the groups of a frame")


class Segmentation:
    """A partition of the image into regions."""

    labels: NDArray[numpy.int32] = doc("(H, W) int32, read-only: region of each pixel, an index into `regions`")
    regions: List[Region] = doc(
        "list of Region, in raster order of their first pixel; of object_regions(): the background, then the objects")

    def __len__(self) -> int:
        return len(self.regions)


class Basins:
    """Result of watershed()."""

    labels: NDArray[numpy.int32] = doc("(H, W) int32, read-only: basin of each pixel, 0 to count - 1")
    count: int = doc("number of basins, 1 or more")


class RegionGraph:
    """Regions and their adjacency (4-neighbourhood)."""

    def neighbours(self, region: int) -> List[int]:
        """The regions adjacent to this one, ascending."""
        if not 0 <= region < len(self):
            raise IndexError("no such region")
        return self._neighbours(region)


class Superpixels:
    """Connected pieces of the image without a clear edge of brightness, colour or depth inside."""

    labels: NDArray[numpy.int32] = doc("(H, W) int32, read-only: superpixel of each pixel, 0 to count - 1")
    count: int = doc("number of superpixels, 1 or more")


class MergeTree:
    """The hierarchy of merged superpixels, from single superpixels to the whole image; its length is the number of
    nodes. Every node follows its parts."""

    superpixels: int = doc("number of superpixels; node i < superpixels is superpixel i")
    parents: NDArray[numpy.int32] = doc("int32, parent of each node; -1 = none")

    def __len__(self) -> int:
        return len(self.parents)


class ChosenObjects:
    """The regions of a MergeTree chosen as objects."""

    object_of: List[int] = doc("object of each superpixel, 1 to len(scores) - 1; 0 = none")
    scores: List[float] = doc("probability of each object, 0 to 1; scores[0] = 0")
    likeliest: List[float] = doc("for each superpixel, the highest object probability of a region that contains it, 0 to 1")

    def __len__(self) -> int:
        return len(self.scores) - 1


class RefinedDisparity:
    """The most likely disparity of each pixel. Arrays (H, W), read-only."""

    disparity_px: NDArray[numpy.float32] = doc("float32, px; NaN = neither a disparity nor a plane is known")
    confidence: NDArray[numpy.float32] = doc("float32, 0 to 1: probability that it is within 1 px of the truth")


# ---- objects ----


class Fusion:
    """The intensity regions of each fused region, the candidates for objects."""

    labels: NDArray[numpy.int32] = doc("(H, W) int32, read-only: fused region of each pixel, an index into `parts`")
    parts: List[List[int]] = doc("intensity regions of each fused region, ascending")
    disparity_region: List[int] = doc("disparity region of each fused region")
    is_floor: List[bool] = doc("for each fused region, True if its disparity region is the floor")

    def __len__(self) -> int:
        return len(self.parts)


class FloorBox:
    """An upright box on the floor around the visible part of an object, aligned with it. In the floor frame: x forward,
    y left, z up from the floor below the left camera."""

    centre_in_floor_m: Tuple[float, float, float] = doc("(x, y, z) of the centre, m")
    size_m: Tuple[float, float, float] = doc("(longer side, shorter side, height), m")
    yaw_rad: float = doc("-pi/2 to pi/2: yaw of the longer side, counter-clockwise from x as seen from above")
    centre_covariance_m2: NDArray[numpy.float32] = doc(
        "3 x 3 covariance of the centre, m^2",
        lambda self: np.array(self._covariance, np.float32)[[0, 1, 2, 1, 3, 4, 2, 4, 5]].reshape(3, 3))


class Object:
    """An object in front of the background."""

    id: int = doc("id, from 1 = the nearest; the value of its pixels in the object map")
    distance_m: Optional[float] = doc(
        "z of its position, m; None without a rig", lambda self: self.position_in_camera_m and self.position_in_camera_m[2])
    position_in_camera_m: Optional[Tuple[float, float, float]] = doc(
        "(x right, y down, z forward), m: centroid of its mask, at the depth of disparity_px; None without a rig")
    extent_in_camera_m: Optional[Tuple[float, float, float]] = doc(
        "(x, y, z), m: size of the box around the points of its main part, without outliers; None without a rig")
    depth_interval_m: Optional[Tuple[float, float]] = doc(
        "(nearest, farthest), m: 95 % interval of its depth; None without a rig")
    disparity_px: float = doc("median disparity of its valid pixels, px; with the preset default refined by both images and by fitted trees")
    disparity_sigma_px: float = doc("standard deviation of disparity_px, px")
    pixel_count: int = doc("area of its mask, px")
    box_px: Tuple[int, int, int, int] = doc("(x, y, width, height), px")
    valid_share: float = doc("0 to 1: share of the mask with a disparity")
    mean_colour: Tuple[int, int, int] = doc("(red, green, blue), 0 to 255; grey if the input had no colour")
    edge_share: float = doc("0 to 1: share of the outline on image edges")
    cut_share: float = doc("0 to 1: share of the outline at the image border")
    confidence: float = doc("0 to 1: probability that it matches a true object (IoU >= 0.5)")
    box_on_floor: Optional[FloorBox] = doc("upright box on the floor, a FloorBox; None without a rig or a ground")


class LeftOut:
    """An obstacle that is not an object, and why."""

    reason: str = doc("'background', 'too small' or 'low confidence'")
    box_px: Tuple[int, int, int, int] = doc("(x, y, width, height), px")
    pixel_count: int = doc("area, px")
    disparity_px: float = doc("mean disparity of its pixels, px")
    position_in_camera_m: Optional[Tuple[float, float, float]] = doc(
        "(x right, y down, z forward), m: its centre; None without a rig")
    confidence: float = doc("0 to 1: highest confidence of the regions that overlap it; 0 if none was judged")


class GroundStep:
    """A kerb, or another straight edge between two levels of the ground."""

    from_m: Tuple[float, float, float] = doc("(x, y, z), m, in the floor frame: its right end on the nearer level")
    to_m: Tuple[float, float, float] = doc("(x, y, z), m, in the floor frame: its left end")
    height_m: float = doc("height of the farther level above the nearer one, m; negative: a step down")


class ObstacleScan:
    """The nearest obstacle in each direction, as from a laser scanner, seen from the floor below the left camera."""

    angle_min_rad: float = doc("angle of the first range; counter-clockwise from straight ahead")
    angle_increment_rad: float = doc("angle between ranges")
    range_max_m: float = doc("largest range, m")
    ranges_m: NDArray[numpy.float32] = doc("(N,) float32, m; NaN: no obstacle seen, but not necessarily free")

    def __len__(self) -> int:
        return len(self.ranges_m)


class ObstacleGrid:
    """Occupancy of the floor: rows along y, from right to left, of cells along x, from the camera forward."""

    cell_size_m: float = doc("side of a cell, m")
    origin_in_floor_m: Tuple[float, float] = doc(
        "(x, y), m: corner of the first cell, in the floor frame", lambda self: self._origin)
    cells: NDArray[numpy.int8] = doc("(height, width) int8: -1 = unknown, 0 = free, 100 = occupied")


class Objects:
    """The objects of a frame: a sequence of Object, nearest first, and the object map."""

    labels: NDArray[numpy.int32] = doc("(H, W) int32, read-only: object id of each pixel; 0 = none")

    def __len__(self) -> int:
        return len(self._list)

    def __getitem__(self, index: Union[int, slice]) -> Any:
        """One object, or a list of objects for a slice."""
        return self._list[index]

    def __iter__(self) -> Iterator[Object]:
        return iter(self._list)

    def __repr__(self):
        return f"Objects({len(self)}" + "".join(f"\n  {one!r}" for one in self) + ")"


globals().update({name: describes(getattr(_cairn, name))(value) for name, value in list(globals().items())
                  if isinstance(value, type) and value.__module__ == __name__})
