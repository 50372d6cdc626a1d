# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""The whole method and its result; files and images."""

from __future__ import annotations

import json
import warnings

import numpy as np

from . import _cairn
from ._calls import NO_EXEC, checked, describes, doc, numbers, of_cpp, whole
from ._calls import image as picture
from ._cairn import Error
from ._options import config_of


def made_by(method):
    """A getter for a result of one method; None in frames of the other."""
    return lambda self: (lambda part: None if part.labels is None else part)(getattr(self._data, method))


@describes()
class Frame:
    """The results of one pair. Arrays (H, W) are read-only views of the frame's memory, without a copy. Rows may be
    padded; array.copy() returns a writable array. The frame keeps the left image for overlay(): the array itself, not a
    copy. In a notebook it is displayed as overlay()."""

    disparity: NDArray[numpy.float32] = doc("float32, px; NaN = hole, see `reject`", lambda self: self.disparity_map.disparity_px)
    reject: NDArray[numpy.uint16] = doc(
        "uint16, why there is no disparity: bits of cairn.Reject; 0 = valid", lambda self: self.disparity_map.reject)
    confidence: Optional[NDArray[numpy.float32]] = doc(
        "float32, 0 to 1: probability that the disparity is within 1 px of the truth; 0 in holes. "
        "None without matching")
    floor: Optional[NDArray[numpy.uint8]] = doc("uint8, 255 = floor, else 0; None if no floor was labelled")
    objects_map: NDArray[numpy.int32] = doc(
        "int32, object id of each pixel; 0 = none. `frame.objects_map == object.id` is a mask",
        lambda self: self.objects.labels)
    objects: Objects = doc("Objects, nearest first")
    space: NDArray[numpy.uint8] = doc("uint8, class of each pixel: 255 = obstacle, object or not; 128 = floor; 64 = sky; 0 = unknown")
    left_out: List[LeftOut] = doc("list of LeftOut: obstacles that are not objects, nearest first, and why")
    floor_frame: Optional[FloorFrame] = doc(
        "floor frame, in metres, a FloorFrame; None without a rig or a ground",
        lambda self: _cairn.floor_of(self._data, self._how))
    disparity_map: DisparityMap = doc("disparity and reject as a DisparityMap, the input of stages")
    ground: Ground = doc("floor plane, or why there is none")
    by_intensity: Optional[Segmentation] = doc(
        "Segmentation of the image by intensity; None with pipeline.method=region_tree", made_by("by_intensity"))
    by_disparity: Optional[Segmentation] = doc(
        "Segmentation by disparity; None with pipeline.method=region_tree", made_by("by_disparity"))
    fusion: Optional[Fusion] = doc("Fusion of both; None with pipeline.method=region_tree", made_by("fusion"))
    superpixels: Optional[Segmentation] = doc(
        "superpixels as a Segmentation; None with pipeline.method=paper", made_by("superpixels"))
    groups: Optional[Segmentation] = doc(
        "Segmentation: region 0 is the background, the others are the chosen objects; None with pipeline.method=paper",
        made_by("groups"))
    refined: Optional[RefinedDisparity] = doc(
        "the most likely disparity of each pixel, with its confidence: gross errors corrected and holes filled, a "
        "RefinedDisparity; None with pipeline.method=paper and with given disparities",
        lambda self: None if self._data.refined.disparity_px is None else self._data.refined)
    epipolar: EpipolarOffset = doc("row offset of the right image, an EpipolarOffset")
    rig: Optional[Rig] = doc("Rig used, or None", lambda self: self._how.rig)
    config: Config = doc("Config used", lambda self: self._how.config)
    timings: Dict[str, float] = doc("time of each stage, ms", lambda self: self._how.timings)
    shape: Tuple[int, int] = doc("(H, W)", lambda self: self.disparity.shape)

    @classmethod
    def _of(cls, left, data, how):
        frame = cls.__new__(cls)
        frame._left, frame._data, frame._how = left, data, how
        return frame

    def _metric(self):
        if self.rig is None:
            raise Error("rig: found none, expected one: a frame without a rig has no metres")
        return self.rig

    def scan(self) -> Optional[ObstacleScan]:
        """The nearest obstacle in each direction: an ObstacleScan. None without a rig or a ground."""
        return self.floor_frame and _cairn.scan(self._data, self.floor_frame, self._how)

    def grid(self) -> Optional[ObstacleGrid]:
        """The obstacles and steps on the floor: an ObstacleGrid. None without a rig or a ground."""
        return self.floor_frame and _cairn.grid(self._data, self.floor_frame, self._how)

    def ground_steps(self) -> Optional[List[GroundStep]]:
        """Kerbs and other steps of the ground from 7.5 cm on: a list of GroundStep, nearest first. None without a rig or
        a ground."""
        return self.floor_frame and _cairn.ground_steps(self._data, self.floor_frame, self._how)

    def depth_m(self) -> NDArray[numpy.float32]:
        """Depth of each pixel along the viewing direction: (H, W) float32, m; NaN = hole."""
        return self.points()[..., 2].copy()

    def points(self, object: Union[Object, int, None] = None) -> NDArray[numpy.float32]:
        """Points in the camera frame, m, x right, y down, z forward: (H, W, 3) float32, NaN = hole. With an Object or
        its id, only its points: (N, 3), without holes."""
        if object is None:
            return _cairn.points_of_pixels(self._data, self._metric())
        return _cairn.points_of_object(self._data, self._metric(), whole(getattr(object, "id", object)) or 0)

    def overlay(self) -> NDArray[numpy.uint8]:
        """The left image with the objects drawn in, each with its id and distance, and the steps of the ground with their
        heights: (h, w, 3) uint8, RGB. Small images are enlarged."""
        return _cairn.draw_frame(self._left, self._data, self._how)

    def disparity_view(self) -> NDArray[numpy.uint8]:
        """Colour-coded disparity, holes coloured by reason, with a legend: (h, w, 3) uint8, RGB."""
        return _cairn.draw_frame_disparity(self._data, self._how)

    def to_json(self) -> str:
        """The text of objects.json: objects with masks, ground, configuration, timings (docs/formats.md)."""
        return _cairn.to_json(self._data, self._how)

    def save(self, folder: PathLike) -> None:
        """Writes the files of `cairn segment -o FOLDER` (docs/formats.md) atomically."""
        _cairn.save(folder, self._left, self._data, self._how)

    def _repr_png_(self) -> bytes:
        return _cairn.png_bytes(self.overlay())

    def __repr__(self):
        ground = "ground found" if self.ground else "no ground"
        return f"<cairn.Frame {self.shape[1]}x{self.shape[0]}, {ground}, {self.objects!r}>"


ABOUT = """left, right: a rectified pair of one size, (H, W) or (H, W, 3) uint8, RGB (bgr=True: OpenCV's order). A point
at (x, y) in the left image is at (x - d, y) in the right one. Grey and RGB arrays with contiguous rows are read in
place, without a copy; do not write to them during the call. bgr=True and other layouts are copied. Matching uses grey
levels, which are computed from colours. rig: a Rig, a Calibration, or None; metric results need a rig. The preset
applies first, then config (a Config or a file name), then the options; later ones win. Releases the GIL. Raises
cairn.Error for invalid input."""


def segment(left: ImageLike, right: Optional[ImageLike] = None, rig: RigLike = None, *,
            disparity_map: Optional[DisparityLike] = None, preset: str = "default",
            config: Union[Config, PathLike, None] = None, exec: Optional[Exec] = None, bgr: bool = False, **options) -> Frame:
    wanted = config_of(config, preset, options)
    if disparity_map is None:
        if right is None:
            picture(None, "right", exec, bgr)  # refuses it
        return Frame._of(left, *_cairn.segment_pair(left, right, rig, wanted, exec))
    if right is not None:
        fault = _cairn.fault_of_given(left, right, disparity_map, rig, exec)
        told = fault and json.loads(fault)
        if told and told["severity"] == "broken":
            raise Error(f"disparity_map: {told['finding']}: {told['says']}. {told['remedy']}")
        if told:
            warnings.warn(f"disparity_map: {told['finding']}: {told['says']}", stacklevel=3)
    return Frame._of(left, *_cairn.segment_given(left, disparity_map, rig, wanted, exec))


segment.__doc__ = f"""Segments a stereo pair into objects: the whole method. Returns a Frame.
{ABOUT} disparity_map: an external map instead of matching, (H, W) float32 in px, NaN = hole, or a DisparityMap. With
right it is compared with both images, and refused if it is no disparity of them, as depth is not."""
segment = checked(segment)


def estimate_disparity(left: ImageLike, right: ImageLike, rig: RigLike = None, *, preset: str = "default",
                       config: Union[Config, PathLike, None] = None, exec: Optional[Exec] = None, bgr: bool = False,
                       **options) -> StereoResult:
    return _cairn.estimate_disparity(left, right, rig, config_of(config, preset, options), exec)


estimate_disparity.__doc__ = f"""Estimates disparities, the first half of the method: matching and all checks, including
ground and speckle. Returns a StereoResult.\n{ABOUT}"""
estimate_disparity = checked(estimate_disparity)


@describes()
class Segmenter:
    """segment() for video. Keeps threads and image buffers between frames, so that from the second frame on no image is
    allocated (if earlier frames and their arrays have been released). Returns the same frames as segment(). Several
    threads may share one Segmenter."""

    config: Config = doc("Config used", lambda self: self._config)
    rig: Optional[Rig] = doc("Rig used for measurements, or None", lambda self: self._calibration.rig)
    exec: Exec = doc("Exec used, with its own threads and pool of images", lambda self: self._exec)

    def __init__(self, rig: RigLike = None, *, preset: str = "default", config: Union[Config, PathLike, None] = None,
                 exec: Optional[Exec] = None, **options) -> None:
        """The arguments are those of segment()."""
        self.__setstate__((config_of(config, preset, options), rig, exec))

    def __getstate__(self):
        return self._config, self._calibration, self._exec

    def __setstate__(self, state):
        self._config, self._calibration, of_images = state
        self._data = _cairn.SegmenterData(self._config, self._calibration, of_images)
        self._exec = self._data.exec

    def segment(self, left: ImageLike, right: ImageLike, *, bgr: bool = False) -> Frame:
        """Segments one pair. Returns a Frame."""
        return Frame._of(left, *self._data.segment(left, right))

    def prefetch(self, left: ImageLike, right: ImageLike, *, bgr: bool = False) -> None:
        """Begins the frame of the pair after the next one, in the background: call it before segment() of the next pair.
        Two threads (Exec(threads=2)) then do almost twice the frames of one. The images are copied; segment() finds by
        their pixels what was begun, and returns the same frame without this call. With one thread, only the matches of a
        device are begun."""
        self._data.prefetch(left, right)


@describes()
class Rectifier:
    """Rectifies pairs of raw cameras, like `cairn rectify`. Several threads may share one Rectifier."""

    calibration: Calibration = doc(
        "Calibration of the rectified pairs, with their number of disparities: the rig of segment()",
        lambda self: self._data.calibration)
    rig: Rig = doc("Rig of the rectified pairs", lambda self: self.calibration.rig)

    def __init__(self, calibration: PathLike, image_size: Optional[Tuple[int, int]] = None, *,
                 nearest_m: float = 0.0) -> None:
        """calibration: a file of raw cameras, from `cairn calibrate`, OpenCV, ROS, EuRoC or Kalibr (docs/formats.md).
        image_size: (width, height), if the file has none. nearest_m: nearest distance of interest, for the number of
        disparities; 0 = five baselines. Needs OpenCV's calib3d; raises cairn.Error without it."""
        self._data = _cairn.RectifierData(calibration, image_size, nearest_m)

    def rectify(self, left: ImageLike, right: ImageLike, *, bgr: bool = False) -> Tuple[NDArray[numpy.uint8], NDArray[numpy.uint8]]:
        """Rectifies one pair of the calibrated size: two arrays like those given, (H, W) or (H, W, 3) uint8; bgr=True:
        in OpenCV's order, also of the results. Areas beyond the border of the raw images are black."""
        both = self._data.rectify(left, right)
        return tuple(np.ascontiguousarray(one[..., ::-1]) if bgr and one.ndim == 3 else one for one in both)


# ---- files and images ----


@of_cpp
def load_picture(path: PathLike) -> NDArray[numpy.uint8]:
    """Reads a PNG, JPEG, PGM or PPM file: (H, W) uint8 for grey, (H, W, 3) uint8 RGB for colour. Images of more
    than 8 bits lose their low bits."""


@of_cpp
def load_pair(left: PathLike, right: PathLike) -> Tuple[NDArray[numpy.uint8], NDArray[numpy.uint8]]:
    """Reads both images of a pair. Images of more than 8 bits are reduced by a common factor, which preserves a
    difference in exposure."""


@of_cpp
def load_disparity(path: PathLike) -> NDArray[numpy.float32]:
    """Reads a disparity map from .png (16 bits, px * 256, 0 = hole), .pfm, .npy, or an 8-bit file of Middlebury: (H, W)
    float32, px, NaN = hole."""


@of_cpp
def save_disparity(path: PathLike, disparity_px: FloatsLike) -> None:
    """Writes a disparity map as .png or .pfm, atomically."""


@of_cpp
def load_labels(path: PathLike) -> NDArray[numpy.uint16]:
    """Reads the values of a one-channel file without scaling: (H, W) uint16."""


@of_cpp
def save_png(path: PathLike, image: Union[ImageLike, NDArray[numpy.uint16]]) -> None:
    """Writes (H, W) uint8 or uint16, or (H, W, 3) uint8 RGB, as PNG, atomically."""
    is_16 = getattr(image, "dtype", None) == np.uint16
    return path, numbers(image, "image", "uint16") if is_16 else picture(image, "image", NO_EXEC, False)


@of_cpp
def draw_disparity(disparity: DisparityLike, rig: RigLike = None) -> NDArray[numpy.uint8]:
    """Colour-coded disparity, holes coloured by reason, with a legend (also in metres, given a rig): (h, w, 3) uint8,
    RGB."""


@of_cpp
def draw_objects(left: ImageLike, objects: Objects, floor: MaskLike = None) -> NDArray[numpy.uint8]:
    """The left image with the objects drawn in: (h, w, 3) uint8, RGB."""
