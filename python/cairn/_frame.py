# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""The whole method, its result, files and images."""

from __future__ import annotations

import numpy as np

from . import _cairn
from ._calls import NO_EXEC, checked, describes, numbers, of_cpp, whole
from ._calls import image as picture
from ._cairn import Error
from ._options import config_of


def made_by(method):
    """What a frame of the other method has not is None."""
    return lambda self: (lambda part: None if part.labels is None else part)(getattr(self._data, method))


@describes()
class Frame:
    """All that is known of one pair. Arrays (H, W) are read-only and the frame's own memory, without a copy; rows may be
    padded, so ask array.copy() for one that may be written to. Keeps the left image that it was made of, for overlay(): the
    array itself, not a copy of it. In a notebook it shows itself as overlay()."""

    disparity: NDArray[numpy.float32] = "float32, px; NaN = hole, see `reject`", lambda self: self.disparity_map.disparity_px
    reject: NDArray[numpy.uint16] = (
        "uint16, why there is no disparity: bits of cairn.Reject; 0 = there is one", lambda self: self.disparity_map.reject)
    confidence: Optional[NDArray[numpy.float32]] = (
        "float32, 0 to 1: how likely the disparity is within 1 px of the truth; 0 in holes. None where nothing was matched")
    floor: Optional[NDArray[numpy.uint8]] = "uint8, 255 = floor, else 0; None where no floor was labelled"
    objects_map: NDArray[numpy.int32] = (
        "int32, the object that each pixel belongs to; 0 = none. `frame.objects_map == object.id` is a mask",
        lambda self: self.objects.labels)
    objects: Objects = "the Objects, nearest first"
    space: NDArray[numpy.uint8] = "uint8, what each pixel shows: 255 = obstacle, object or not; 128 = floor; 0 = unknown"
    left_out: List[LeftOut] = "a list of LeftOut: obstacles that are no objects, nearest first, and why"
    floor_frame: Optional[FloorFrame] = (
        "the FloorFrame: where the floor is, in metres; None without a rig or a ground",
        lambda self: _cairn.floor_of(self._data, self._how))
    disparity_map: DisparityMap = "disparity and reject as the DisparityMap that stages take"
    ground: Ground = "the floor as a plane, or why there is none"
    by_intensity: Optional[Segmentation] = (
        "Segmentation of the image by intensity; None with fusion.method=hierarchy", made_by("by_intensity"))
    by_disparity: Optional[Segmentation] = (
        "Segmentation by disparity; None with fusion.method=hierarchy", made_by("by_disparity"))
    fusion: Optional[Fusion] = "both fused; None with fusion.method=hierarchy", made_by("fusion")
    superpixels: Optional[Segmentation] = (
        "the image's superpixels as a Segmentation; None with fusion.method=overlap", made_by("superpixels"))
    groups: Optional[Segmentation] = (
        "Segmentation: region 0 is the background, the others were chosen to be objects; None with fusion.method=overlap",
        made_by("groups"))
    epipolar: EpipolarOffset = "how far the right image's rows were off"
    rig: Optional[Rig] = "the Rig that it was made with, or None", lambda self: self._how.rig
    config: Config = "the Config that it was made with", lambda self: self._how.config
    timings: Dict[str, float] = "milliseconds by stage", lambda self: self._how.timings
    shape: Tuple[int, int] = "(H, W)", lambda self: self.disparity.shape

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
        """The obstacles on the floor: an ObstacleGrid. None without a rig or a ground."""
        return self.floor_frame and _cairn.grid(self._data, self.floor_frame, self._how)

    def depth_m(self) -> NDArray[numpy.float32]:
        """(H, W) float32, m: how far each pixel is along the view; NaN = hole."""
        return self.points()[..., 2].copy()

    def points(self, object: Union[Object, int, None] = None) -> NDArray[numpy.float32]:
        """Points in the camera's frame, m, x right, y down, z forward: (H, W, 3) float32, NaN = hole; of an Object or of its id
        alone (N, 3), without holes."""
        if object is None:
            return _cairn.points_of_pixels(self._data, self._metric())
        return _cairn.points_of_object(self._data, self._metric(), whole(getattr(object, "id", object)) or 0)

    def overlay(self) -> NDArray[numpy.uint8]:
        """The left image with the objects drawn in, each with its id and distance: (h, w, 3) uint8, RGB; small frames are
        enlarged."""
        return _cairn.draw_objects(self._left, self.objects, self.floor)

    def disparity_view(self) -> NDArray[numpy.uint8]:
        """Disparity as colour, holes in colours that tell the reason, with a legend: (h, w, 3) uint8, RGB."""
        return _cairn.draw_frame_disparity(self._data, self._how)

    def to_json(self) -> str:
        """The text of objects.json: objects with masks, ground, configuration, timings (docs/formats.md)."""
        return _cairn.to_json(self._data, self._how)

    def save(self, folder: PathLike) -> None:
        """Writes the files that `cairn segment -o FOLDER` does (docs/formats.md); whole or not at all."""
        _cairn.save(folder, self._left, self._data, self._how)

    def _repr_png_(self) -> bytes:
        return _cairn.png_bytes(self.overlay())

    def __repr__(self):
        ground = "ground found" if self.ground else "no ground"
        return f"<cairn.Frame {self.shape[1]}x{self.shape[0]}, {ground}, {self.objects!r}>"


ABOUT = """left, right: a rectified pair of one size, (H, W) or (H, W, 3) uint8, RGB (bgr=True: OpenCV's order): what is at (x, y)
on the left is at (x - d, y) on the right. Arrays whose rows are dense are used where they lie, without a copy, grey ones and
RGB; do not write to them meanwhile. Matching works on grey, which is computed from colours; bgr=True and other layouts cost a
copy. rig: a Rig, a Calibration, or None: no metres then. preset, then config (a Config or a file's name), then the options;
later ones win. Other Python threads run meanwhile. Raises cairn.Error for what cannot be used."""


def segment(left: ImageLike, right: Optional[ImageLike] = None, rig: RigLike = None, *,
            disparity_map: Optional[DisparityLike] = None, preset: str = "default",
            config: Union[Config, PathLike, None] = None, exec: Optional[Exec] = None, bgr: bool = False, **options) -> Frame:
    wanted = config_of(config, preset, options)
    if disparity_map is None:
        if right is None:
            picture(None, "right", exec, bgr)  # refuses it
        return Frame._of(left, *_cairn.segment_pair(left, right, rig, wanted, exec))
    if right is not None:
        raise Error("right: found an image together with disparity_map, expected one of the two")
    return Frame._of(left, *_cairn.segment_given(left, disparity_map, rig, wanted, exec))


segment.__doc__ = f"""Objects from a stereo pair: the whole method. Returns a Frame.
{ABOUT} disparity_map instead of right: a map from elsewhere, (H, W) float32 in px, NaN = hole, or a DisparityMap."""
segment = checked(segment)


def estimate_disparity(left: ImageLike, right: ImageLike, rig: RigLike = None, *, preset: str = "default",
                       config: Union[Config, PathLike, None] = None, exec: Optional[Exec] = None, bgr: bool = False,
                       **options) -> SceneDisparity:
    return _cairn.estimate_disparity(left, right, rig, config_of(config, preset, options), exec)


estimate_disparity.__doc__ = f"""The method's first half: matching and every check, ground and speckle included. Returns a
SceneDisparity.\n{ABOUT}"""
estimate_disparity = checked(estimate_disparity)


@describes()
class Segmenter:
    """segment() for video: keeps threads and image buffers from frame to frame, so that from the second frame on no image is
    allocated (as long as earlier frames, and arrays of them, have died). Every frame is what segment() would give. Several
    threads may use one."""

    config: Config = "the Config that it works with", lambda self: self._config
    rig: Optional[Rig] = "the Rig that it measures with, or None", lambda self: self._calibration.rig
    exec: Exec = "the Exec that it works with: its own threads and pool of images", lambda self: self._exec

    def __init__(self, rig: RigLike = None, *, preset: str = "default", config: Union[Config, PathLike, None] = None,
                 exec: Optional[Exec] = None, **options) -> None:
        """The arguments are those of segment()."""
        self._config, self._calibration = config_of(config, preset, options), rig
        self._exec = _cairn.own_exec(exec, self._config, rig)

    def segment(self, left: ImageLike, right: ImageLike, *, bgr: bool = False) -> Frame:
        """One frame."""
        return Frame._of(left, *_cairn.segment_pair(left, right, self._calibration, self._config, self._exec))


# ---- files and images ----


@of_cpp
def load_picture(path: PathLike) -> NDArray[numpy.uint8]:
    """A PNG, JPEG, PGM or PPM file: (H, W) uint8 where it is grey, (H, W, 3) RGB where it is in colour. Of deeper images the
    low bits are dropped."""


@of_cpp
def load_pair(left: PathLike, right: PathLike) -> Tuple[NDArray[numpy.uint8], NDArray[numpy.uint8]]:
    """Both images; deeper ones are reduced by the same factor, so that a difference of exposure stays what it was."""


@of_cpp
def load_disparity(path: PathLike) -> NDArray[numpy.float32]:
    """A disparity map from .png (16 bits, px * 256, 0 = hole), .pfm or .npy, or of Middlebury in its own 8 bits: (H, W)
    float32, px, NaN = hole."""


@of_cpp
def save_disparity(path: PathLike, disparity_px: FloatsLike) -> None:
    """Writes a map as .png or .pfm, whole or not at all."""


@of_cpp
def load_labels(path: PathLike) -> NDArray[numpy.uint16]:
    """The numbers of a one-channel file as they stand: (H, W) uint16."""


@of_cpp
def save_png(path: PathLike, image: Union[ImageLike, NDArray[numpy.uint16]]) -> None:
    """Writes (H, W) uint8 or uint16, or (H, W, 3) uint8 RGB, as PNG, whole or not at all."""
    is_16 = getattr(image, "dtype", None) == np.uint16
    return path, numbers(image, "image", "uint16") if is_16 else picture(image, "image", NO_EXEC, False)


@of_cpp
def draw_disparity(disparity: DisparityLike, rig: RigLike = None) -> NDArray[numpy.uint8]:
    """Disparity as colour, holes in colours that tell the reason, with a legend (with a rig in metres, too): (h, w, 3) uint8,
    RGB."""


@of_cpp
def draw_objects(left: ImageLike, objects: Objects, floor: MaskLike = None) -> NDArray[numpy.uint8]:
    """The left image with the objects drawn in: (h, w, 3) uint8, RGB."""
