# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
# Written by python/tools/make_stubs.py; do not edit.
"""Objects from a rectified stereo pair, in metres, with a reason for every pixel that was refused."""

import enum
import os
from typing import Any, Callable, Dict, Iterable, Iterator, List, Literal, Optional, Sequence, Tuple, TypedDict, Union, overload

import numpy
from numpy.typing import NDArray

ImageLike = NDArray[numpy.uint8]  # (H, W) or (H, W, 3)
FloatsLike = NDArray[numpy.floating[Any]]  # (H, W), px
DisparityLike = Union["DisparityMap", FloatsLike]
MaskLike = Union[NDArray[numpy.uint8], NDArray[numpy.bool_], None]  # (H, W)
LabelsLike = NDArray[numpy.integer[Any]]  # (H, W)
NumbersLike = NDArray[Any]  # (H, W)
RigLike = Union["Rig", "Calibration", None]
PairsLike = Iterable[Tuple[ImageLike, ImageLike]]  # (left, right)
FramesLike = Iterable[Union["TuningFrame", Tuple[ImageLike, ImageLike]]]
PathLike = Union[str, "os.PathLike[str]"]
Points = Sequence[Tuple[float, float, float, float]]  # x_left, y_left, x_right, y_right; px

__version__: str

class EpipolarCorrectionOptions(TypedDict, total=False):
    max_rows: float  # rows, −1 = off, 0.5 … 8: largest misalignment of the right image's rows that is looked for and taken back (vibration)

class MatchOptions(TypedDict, total=False):
    method: Literal["window", "semi_global"]  # window|semi_global: window: correlation alone; semi_global: neighbours agree along paths
    cost: Literal["sad", "ssd", "zsad", "zssd", "nssd", "zncc"]  # sad|ssd|zsad|zssd|nssd|zncc, read while match.method=window: correlation operator
    window_size: int  # px, 3 … 31, odd, read while match.method=window: side of the square correlation window, odd
    min_disparity: int  # px, -1024 … 1023: first disparity tried; may be negative
    num_disparities: int  # px, 1 … 1024: how many disparities are tried; a calibration's ndisp replaces the default
    row_band: int  # rows, 0 … 8, read while match.method=window: also search k rows above and below (vibration)
    prefilter: Literal["none", "xsobel"]  # none|xsobel, read while match.method=window: filter both images before matching
    prefilter_cap: int  # grey levels, 1 … 63, read while match.prefilter=xsobel: clip the x-Sobel response to ±cap

class SemiGlobalOptions(TypedDict, total=False):
    penalty_small: float  # greatest cost, 0 … 2.3, read while match.method=semi_global: for a change of disparity by one pixel
    penalty_large: float  # greatest cost, 0 … 2.3, read while match.method=semi_global: for a larger change of disparity
    penalty_edge: float  # 1/grey level, 0 … 10, read while match.method=semi_global: how fast the large penalty falls where the intensity changes

class SubpixelOptions(TypedDict, total=False):
    enabled: bool  # true|false: refine each winner by a curve through its cost and its neighbours'
    method: Literal["parabola", "equiangular"]  # parabola|equiangular, read while subpixel.enabled=true: the curve: round for squares, pointed for absolute differences and semi_global

class LeftRightOptions(TypedDict, total=False):
    max_diff: float  # px, −1 = off, 0 … 64: largest left-right disagreement still accepted
    method: Literal["true", "vote"]  # true|vote, read while left_right.max_diff!=-1: true: the right image's own winner over all candidates; vote: the right pixel takes the best left winner (OpenCV)

class UniquenessOptions(TypedDict, total=False):
    ratio: float  # %, −1 = off, 0 … 100: by how much the best cost must beat the runner-up (OpenCV's uniquenessRatio)

class FlatnessOptions(TypedDict, total=False):
    threshold: float  # share, −1 = off, 0 … 1: least depth of the best cost below the mean cost

class TextureOptions(TypedDict, total=False):
    window_size: int  # px, 3 … 31, odd, read while texture.threshold!=-1: side of the Moravec operator's window, odd
    threshold: float  # grey levels², −1 = off, 0 … 65025: least mean squared difference to the most similar shift

class GroundOptions(TypedDict, total=False):
    source: Literal["off", "automatic", "points", "pose"]  # off|automatic|points|pose: where the floor comes from: fitted to each frame, the calibration's points or pose, nowhere
    margin: float  # px, 0 … 64, read while ground.source!=off: how far a disparity may lie from the floor's and still be floor
    label_floor: bool  # true|false, read while ground.source!=off: label matches on the floor; the floor is no object

class SpeckleOptions(TypedDict, total=False):
    size: int  # px, −1 = off, 0 … 1000000: islands of up to this many pixels are rejected (OpenCV's speckleWindowSize)
    range: float  # px, 0 … 64, read while speckle.size!=-1: largest step of disparity between neighbours of one island

class EvidenceOptions(TypedDict, total=False):
    gradient_min: float  # grey levels, 0 … 255, read while fusion.method=hierarchy: how far a pixel's horizontal gradient must exceed the image's noise to count as evidence

class BackgroundOptions(TypedDict, total=False):
    max_walls: int  # 0 … 8, read while fusion.method=hierarchy: how many walls are looked for besides the floor

class IntensityOptions(TypedDict, total=False):
    smoothing_sigma: float  # px, 0 … 5, read while fusion.method=overlap: Gaussian smoothing before the gradient
    gradient_threshold: float  # grey levels, 0 … 255, read while fusion.method=overlap: 0 = off; a lower gradient counts as 0: no basins of noise
    mean_difference_max: float  # grey levels, 0 … 255, read while fusion.method=overlap: Eq. 1: largest difference of two means that fuse
    deviation_max: float  # σ, 0 … 100, read while fusion.method=overlap: Eq. 2: how many deviations a fusion may move the mean
    sigma_min: float  # grey levels, 0.01 … 255, read while fusion.method=overlap: least deviation used in Eq. 2
    min_region_area: float  # % of the image, 0 … 100, read while fusion.method=overlap: smaller regions fuse with the most similar neighbour

class DisparityOptions(TypedDict, total=False):
    smoothing_sigma: float  # px, 0 … 5, read while fusion.method=overlap: Gaussian smoothing before the gradient
    gradient_threshold: float  # px, 0 … 64, read while fusion.method=overlap: 0 = off; a lower gradient counts as 0: no basins of noise
    mean_difference_max: float  # px, 0 … 64, read while fusion.method=overlap: Eq. 1: largest difference of two means that fuse
    deviation_max: float  # σ, 0 … 100, read while fusion.method=overlap: Eq. 2: how many deviations a fusion may move the mean
    sigma_min: float  # px, 0.01 … 64, read while fusion.method=overlap: least deviation used in Eq. 2
    min_region_area: float  # % of the image, 0 … 100, read while fusion.method=overlap: smaller regions fuse with the most similar neighbour

class FusionOptions(TypedDict, total=False):
    method: Literal["overlap", "hierarchy"]  # overlap|hierarchy: overlap: the paper's two segmentations; hierarchy: the likeliest objects in a tree of regions

class SuperpixelsOptions(TypedDict, total=False):
    count: int  # 1 … 100000, read while fusion.method=hierarchy: how many pieces the image is cut into at most; more follow small things, and take longer

class ObjectsOptions(TypedDict, total=False):
    min_area: float  # % of the image, 0 … 100: smaller regions are no objects
    max_area: float  # % of the image, 0 … 100, read while fusion.method=overlap: larger regions are background
    min_confidence: float  # 0 … 1: regions less likely than this to be an object are none

class SpaceOptions(TypedDict, total=False):
    max_height: float  # m, 0.01 … 100: higher things above the floor are in nobody's way
    range: float  # m, 0.1 … 1000: how far the scan and the grid of obstacles reach
    cell_size: float  # m, 0.005 … 10: side of a cell of the grid of obstacles

class OdometryOptions(TypedDict, total=False):
    method: Literal["off", "frame", "keyframe"]  # off|frame|keyframe: motion against the last keyframe, against the frame before, or none
    max_features: int  # 30 … 2000, read while odometry.method!=off: corners of a keyframe
    quality_level: float  # 1e-04 … 0.5, read while odometry.method!=off: a corner's strength, as a share of the strongest one's
    min_distance: float  # px, 2 … 50, read while odometry.method!=off: between corners
    min_confidence: float  # 0 … 1, read while odometry.method!=off: corners whose disparity is less sure are left out
    win_size: int  # px, 5 … 41, odd, read while odometry.method!=off: window by which a corner is followed
    max_level: int  # 0 … 5, read while odometry.method!=off: pyramid levels above the picture by which a corner is followed
    fb_max_error: float  # px, −1 = off, 0.1 … 5, read while odometry.method!=off: a corner that is followed back may miss itself by this
    reprojection_error: float  # px, 0.3 … 10, read while odometry.method!=off: a corner that a motion misses by more speaks against it
    iterations: int  # 20 … 5000, read while odometry.method!=off: motions tried at most
    confidence: float  # 0.9 … 0.9999, read while odometry.method!=off: that the right motion is among those tried
    min_inliers: int  # 6 … 200, read while odometry.method!=off: fewer corners tell no motion
    keyframe_inliers: float  # 0.2 … 0.95, read while odometry.method=keyframe: a smaller share of a keyframe's corners asks for a new one
    max_depth_baselines: float  # baselines, −1 = off, 5 … 1000, read while odometry.method!=off: farther corners tell rotation only
    sigma_disparity: float  # px, 0.05 … 3, read while odometry.method!=off: standard deviation of a disparity
    sigma_pixel: float  # px, 0.05 … 3, read while odometry.method!=off: standard deviation of a followed corner's place

class TrackingOptions(TypedDict, total=False):
    gate: float  # χ², 1 … 100: an object that is farther from where a track is expected is not that track's
    min_hits: int  # frames, 1 … 30: of five in a row in which a thing must be seen before its track counts
    max_age: int  # frames, 1 … 300: in which a track may be missed, though in view, before it ends
    max_hidden: float  # s, 0 … 3600: that a track may be hidden or out of view before it ends
    high_confidence: float  # 0 … 1: objects at least this sure are matched first and found tracks
    low_confidence: float  # 0 … 1: objects less sure than this are not looked at
    static_noise: float  # m/√s, 0 … 1: how far a thing that stands may seem to wander
    acceleration_noise: float  # m/s², 0.01 … 20: how quickly a moving thing may change its speed
    min_speed: float  # m/s, 0 … 5: slower things stand still
    appearance_weight: float  # 0 … 10: how much colours count beside place and size

class RepairOptions(TypedDict, total=False):
    method: Literal["off", "objects"]  # off|objects, read while fusion.method=hierarchy: whether tracks help to choose objects
    weight: float  # 0 … 1, read while repair.method!=off: of what a track says of a region, against what this frame's picture says

class LandmarksOptions(TypedDict, total=False):
    min_frames: int  # frames, 2 … 1000: in which a track must be seen before it becomes a landmark
    max_sigma: float  # m, 0.005 … 10: standard deviation of a landmark's position, at most
    min_baseline: float  # m, 0 … 10: camera travel while a landmark is seen, or min_angle
    min_angle: float  # degrees, 0 … 180: between viewpoints of a landmark, or min_baseline
    gate: float  # χ², 1 … 100: largest squared distance at which a landmark is recognised
    min_score: float  # 0 … 1: likeness of colours at which a landmark is recognised
    min_pairs: int  # 1 … 20: recognised landmarks that correct the pose
    relocation_pairs: int  # 2 … 20: recognised landmarks that tell a pose not known before
    moved: float  # m, 0.02 … 100: shortest displacement reported as moved
    max_known: int  # 1 … 1000000: landmarks in a map, at most

class ControlOptions(TypedDict, total=False):
    method: Literal["off", "watch"]  # off|watch: whether steadier values of options are looked for and reported
    window: int  # frames, 3 … 1000, read while control.method!=off: on which two settings are compared at least
    hold: int  # frames, 1 … 10000, read while control.method!=off: between two reports at least
    budget: float  # 0 … 1, read while control.method!=off: share of frames that are segmented a second time
    lead: float  # %, 0 … 100, read while control.method!=off: by which a setting must be steadier to be better

class ArgumentError:
    """An Error that is a TypeError as well: an argument of a wrong type, one that there is not, or none where one is wanted."""
    ...

class Background:
    """The planes that bound the scene from behind: floor and walls."""
    @property
    def planes(self) -> List[GroundPlane]:
        """a list of GroundPlane"""
    @property
    def has_floor(self) -> bool:
        """whether the first of them is the floor"""
    def disparity_px(self, x: float, y: float) -> float:
        """Of the nearest of them, at least 0; px."""

class Basins:
    """What watershed() makes."""
    @property
    def labels(self) -> NDArray[numpy.int32]:
        """(H, W) int32, read-only: 0 to count - 1"""
    @property
    def count(self) -> int:
        """how many basins there are, 1 or more"""

class BrightnessDifference:
    """What the right camera makes of the left one's brightness: right = gain * left + offset."""
    @property
    def points(self) -> int:
        """windows compared; with fewer than 50 no difference is measured"""
    @property
    def is_measured(self) -> bool:
        """otherwise gain, offset and median are those of equal cameras"""
    @property
    def gain(self) -> float:
        """factor on the left one's grey levels; 1 where both agree, or too little varies"""
    @property
    def offset(self) -> float:
        """grey levels"""
    @property
    def median(self) -> float:
        """of |right - left|, grey levels"""

class Calibration:
    """What a calibration file says of a rectified pair. Stands wherever a Rig does; segment() then also checks the pictures' size and takes the file's number of disparities as default."""
    def __init__(
        self,
        rig: Optional[Rig] = None,
        image_size: Optional[Tuple[int, int]] = None,
        num_disparities: Optional[int] = None,
        ground_points: Points = [],
        camera_height_m: Optional[float] = None,
        camera_pitch_deg: float = 0.0,
        camera_roll_deg: float = 0.0,
    ) -> None:
        """What a file would say, see load_calibration(). ground_points: (x_left, y_left, x_right, y_right) in
        px of four and more points of the floor, for ground={'source': 'points'}. camera_height_m: of the
        left camera above the floor, for 'pose'. Raises cairn.Error.
        """
    @property
    def rig(self) -> Optional[Rig]:
        """None where the file has no focal length or no baseline"""
    @property
    def image_size(self) -> Optional[Tuple[int, int]]:
        """(width, height) of the pictures that it was made for, or None"""
    @property
    def num_disparities(self) -> Optional[int]:
        """the default of match.num_disparities, or None"""
    @property
    def ground_points(self) -> List[Tuple[float, float, float, float]]:
        """points of the floor: (x_left, y_left, x_right, y_right) in px"""
    @property
    def camera_height_m(self) -> Optional[float]:
        """of the left camera above the floor, m, or None"""
    @property
    def camera_pitch_deg(self) -> float:
        """degrees; positive looks down"""
    @property
    def camera_roll_deg(self) -> float:
        """degrees; positive lowers the camera's right side"""
    @property
    def of_raw_cameras(self) -> bool:
        """whether the file describes the lenses of the raw cameras as well: the rig fits pictures that were
        rectified with it
        """

class ChosenObjects:
    """The regions of a MergeTree that are objects."""
    @property
    def object_of(self) -> List[int]:
        """for each superpixel its object, 1 to len(scores) - 1; 0 = none"""
    @property
    def scores(self) -> List[float]:
        """for each object how likely it is one, 0 to 1; scores[0] = 0"""
    @property
    def likeliest(self) -> List[float]:
        """for each superpixel how likely the likeliest region that holds it is an object, 0 to 1"""
    def __len__(self) -> int: ...

class Config:
    """What is computed: every option's value. Made from a preset, then a file (as `cairn config` prints it), then keywords; later ones win:
        cairn.Config('paper', match={'window_size': 11})
    Raises cairn.Error for an unknown name, a value out of range, and an option that would have no effect."""
    def __init__(
        self,
        preset: str = 'default',
        file: Optional[PathLike] = None,
        *,
        epipolar_correction: EpipolarCorrectionOptions = ...,
        match: MatchOptions = ...,
        semi_global: SemiGlobalOptions = ...,
        subpixel: SubpixelOptions = ...,
        left_right: LeftRightOptions = ...,
        uniqueness: UniquenessOptions = ...,
        flatness: FlatnessOptions = ...,
        texture: TextureOptions = ...,
        ground: GroundOptions = ...,
        speckle: SpeckleOptions = ...,
        evidence: EvidenceOptions = ...,
        background: BackgroundOptions = ...,
        intensity: IntensityOptions = ...,
        disparity: DisparityOptions = ...,
        fusion: FusionOptions = ...,
        superpixels: SuperpixelsOptions = ...,
        objects: ObjectsOptions = ...,
        space: SpaceOptions = ...,
    ) -> None:
        """preset: one of preset_names(). file: a configuration file's name, or None. Then a dict for each
        group of options().
        """
    @property
    def preset(self) -> str:
        """what it started from"""
    def __getitem__(self, name: str) -> object:
        """The value of an option by its full name, 'match.window_size'."""
    def as_dict(self) -> Dict[str, Dict[str, Any]]:
        """The values of all options that it reads: a dict of the groups' dicts. Config(**config.as_dict()) is
        its equal.
        """
    def yaml(self) -> str:
        """The text of a configuration file: the options that it reads, one comment for each."""
    def __eq__(self, other: object) -> bool: ...

class DisparityErrors:
    """Counts over the pixels whose true disparity is known. Several frames' add up with +=."""
    @property
    def known(self) -> int:
        """pixels with truth"""
    @property
    def matched(self) -> int:
        """of these, pixels with a disparity of ours"""
    @property
    def density(self) -> float:
        """0 to 1: matched / known"""
    @property
    def bad_of_matched(self) -> Dict[float, float]:
        """by threshold in px: share of the matched that is off by more"""
    @property
    def bad_of_known(self) -> Dict[float, float]:
        """the same of the known; a hole counts as bad"""
    @property
    def mean_absolute_px(self) -> float:
        """mean of |ours - truth| over the matched, px; NaN where nothing is"""
    @property
    def root_mean_square_px(self) -> float:
        """root of the mean square of the same, px; NaN where nothing is matched"""
    @property
    def sigma_px(self) -> float:
        """the same over those that are off by 1 px at most: sigma of a right match"""
    def __iadd__(self, arg0: DisparityErrors) -> DisparityErrors: ...

class DisparityMap:
    """Disparity for each pixel of the left picture, and for each one without the reason. Arrays (H, W), read-only. A hole is where reject is not 0, and there disparity_px is NaN."""
    @property
    def disparity_px(self) -> NDArray[numpy.float32]:
        """float32, px; NaN = hole"""
    @property
    def reject(self) -> NDArray[numpy.uint16]:
        """uint16, the bits of cairn.Reject; 0 = none"""

class EpipolarCorrection:
    """What correct_epipolar() makes."""
    @property
    def offset(self) -> EpipolarOffset:
        """an EpipolarOffset: what was found"""
    @property
    def right(self) -> Optional[NDArray[numpy.uint8]]:
        """(H, W) uint8, the right picture moved; None where the pair is to be matched as it is"""

class EpipolarOffset:
    """How far the right picture's rows are off: what the left one shows in row y stands in column x of the right one at row y + rows + rows_per_px * (x - (width - 1) / 2)."""
    def __init__(self, rows: float = 0.0, rows_per_px: float = 0.0) -> None:
        """rows: -1024 to 1024; rows_per_px: -1 to 1. For shift_rows()."""
    @property
    def rows(self) -> float:
        """rows, in the middle column"""
    @property
    def rows_per_px(self) -> float:
        """tangent of the roll"""
    @property
    def points(self) -> int:
        """textured points found again in the right picture"""
    @property
    def agreeing(self) -> int:
        """those of them within half a row of this offset"""
    @property
    def outcome(self) -> str:
        """'off', 'too few textured points', 'the points do not agree', 'aligned' or 'corrected'"""

class Error(ValueError):
    """Bad input: what was found, what was expected, which argument, option or file. The command says the same."""

class Exec:
    """How the work is done: threads, instruction set, a pool of image buffers. Never changes a result."""
    def __init__(self, threads: int = 0, target: str = 'best') -> None:
        """threads: 0 = one for each processor. target: 'best' or one of supported_targets()."""
    @property
    def threads(self) -> int:
        """how many work, the caller's among them; 1 or more"""
    @property
    def target(self) -> str:
        """the instruction set that the kernels run on"""
    @property
    def heap_allocations(self) -> int:
        """how many image buffers its pool has asked the heap for"""

class Exposure:
    """How one camera used its 256 grey levels."""
    @property
    def black(self) -> float:
        """0 to 1: share of the pixels at level 0 or 1"""
    @property
    def white(self) -> float:
        """0 to 1: share of the pixels at level 254 or 255"""
    @property
    def contrast(self) -> float:
        """grey levels between the darkest and the brightest hundredth of the pixels"""

class Finding:
    """One thing that is wrong with a rig."""
    @property
    def kind(self) -> str:
        """what it is, 'cameras swapped'; `cairn doctor` calls it the same"""
    @property
    def severity(self) -> str:
        """'note', 'warning': results suffer, or 'broken': no result can be trusted"""
    @property
    def value(self) -> float:
        """the number that was measured"""
    @property
    def number(self) -> str:
        """what that number is, in words"""
    @property
    def unit(self) -> str:
        """its unit; may be empty"""
    @property
    def says(self) -> str:
        """one sentence with the numbers"""
    @property
    def remedy(self) -> str:
        """what to do about it"""

class FloorBox:
    """A box about what is seen of an object, upright on the floor and turned as it is. In the floor's frame: x forward, y left, z up, from the floor below the left camera."""
    @property
    def centre_in_floor_m(self) -> Tuple[float, float, float]:
        """(x, y, z), m"""
    @property
    def size_m(self) -> Tuple[float, float, float]:
        """(along its longer side, along its shorter one, up), m"""
    @property
    def yaw_rad(self) -> float:
        """-pi/2 to pi/2: of the longer side, counter-clockwise from x as seen from above"""
    @property
    def centre_covariance_m2(self) -> List[List[float[3]][3]]:
        """3 rows of 3, m^2: how well the centre is known"""

class FloorFrame:
    """Where the floor is, in metres: its frame has its origin on the floor below the left camera, x forward, y left, z up."""
    @property
    def camera_height_m(self) -> float:
        """of the left camera above the floor, m"""
    @property
    def pitch_rad(self) -> float:
        """of the camera: positive looks down"""
    @property
    def roll_rad(self) -> float:
        """of the camera: positive lowers its right side"""
    @property
    def floor_from_camera(self) -> List[List[float[4]][4]]:
        """4 rows of 4: takes homogeneous points from the camera's frame to the floor's"""

class Follower:
    """Follows the camera and the objects through a sequence, pair by pair. preset, config (a Config or a file's name) and options are those of segment(), with the groups of follow_options() besides: tracking={'min_hits': 2}. Without a rig there are ids, but no metres and no motion."""
    def __init__(
        self,
        rig: RigLike = None,
        *,
        preset: str = 'default',
        config: Union[Config, PathLike, None] = None,
        exec: Optional[Exec] = None,
        epipolar_correction: EpipolarCorrectionOptions = ...,
        match: MatchOptions = ...,
        semi_global: SemiGlobalOptions = ...,
        subpixel: SubpixelOptions = ...,
        left_right: LeftRightOptions = ...,
        uniqueness: UniquenessOptions = ...,
        flatness: FlatnessOptions = ...,
        texture: TextureOptions = ...,
        ground: GroundOptions = ...,
        speckle: SpeckleOptions = ...,
        evidence: EvidenceOptions = ...,
        background: BackgroundOptions = ...,
        intensity: IntensityOptions = ...,
        disparity: DisparityOptions = ...,
        fusion: FusionOptions = ...,
        superpixels: SuperpixelsOptions = ...,
        objects: ObjectsOptions = ...,
        space: SpaceOptions = ...,
        odometry: OdometryOptions = ...,
        tracking: TrackingOptions = ...,
        repair: RepairOptions = ...,
        landmarks: LandmarksOptions = ...,
        control: ControlOptions = ...,
    ) -> None:
        """rig: a Rig, a Calibration or None. Raises cairn.Error for what cannot be used."""
    def next(
        self,
        left: ImageLike,
        right: ImageLike,
        stamp_ns: Optional[int] = None,
        *,
        seconds: Optional[float] = None,
        prior: Optional[MotionPrior] = None,
        pose: Optional[FloatsLike] = None,
        bgr: bool = False,
    ) -> Step:
        """The next frame: a Step. stamp_ns or seconds: when it was taken, later than the one before. prior: a
        MotionPrior since the frame before. pose: 4 x 4 map_from_camera of a robot that knows where it is;
        then no motion is estimated. Raises cairn.Error for another size than the first pair's and stamps
        that do not rise.
        """
    @property
    def rig(self) -> Optional[Rig]:
        """the Rig that it measures with, or None"""
    def __getitem__(self, name: str) -> str:
        """The value of an option by its full name, as text."""

class Following:
    """What follow() returns: an iterator of Steps over a source."""
    def __iter__(self) -> Following: ...
    def __next__(self) -> Step: ...
    def __enter__(self) -> Following: ...
    def __exit__(self, *args: object) -> None: ...
    def close(self) -> None:
        """Ends the run, in the map, too; reading to the end does so by itself."""
    @property
    def rig(self) -> Optional[Rig]:
        """the source's Rig, or None"""
    @property
    def size(self) -> Optional[int]:
        """frames at most; None where it is not known"""
    @property
    def remarks(self) -> List[Tuple[str, int]]:
        """what was noticed of the source's frames up to now: (words, frames)"""
    @property
    def ended_early(self) -> str:
        """why the source ended before its end; '' where it did not"""

class FoundObjectScore:
    """What became of one object of ours."""
    @property
    def id(self) -> int:
        """its number among ours, from 1 on"""
    @property
    def pixel_count(self) -> int:
        """its area outside don't-care, px"""
    @property
    def best(self) -> int:
        """the true object of greatest IoU; 0 = none"""
    @property
    def iou(self) -> float:
        """0 to 1: intersection over union with `best`; 0 where nothing overlaps"""
    @property
    def phantom(self) -> bool:
        """large enough, and hardly on any true object"""

class Frame:
    """All that is known of one pair. Arrays (H, W) are read-only and the frame's own memory, without a copy; rows may be padded, so ask array.copy() for one that may be written to. Keeps the left picture that it was made of, for overlay(): the array itself, not a copy of it. In a notebook it shows itself as overlay()."""
    @property
    def disparity(self) -> NDArray[numpy.float32]:
        """float32, px; NaN = hole, see `reject`"""
    @property
    def reject(self) -> NDArray[numpy.uint16]:
        """uint16, why there is no disparity: bits of cairn.Reject; 0 = there is one"""
    @property
    def confidence(self) -> Optional[NDArray[numpy.float32]]:
        """float32, 0 to 1: how likely the disparity is within 1 px of the truth; 0 in holes. None where
        nothing was matched
        """
    @property
    def floor(self) -> Optional[NDArray[numpy.uint8]]:
        """uint8, 255 = floor, else 0; None where no floor was labelled"""
    @property
    def objects_map(self) -> NDArray[numpy.int32]:
        """int32, the object that each pixel belongs to; 0 = none. `frame.objects_map == object.id` is a mask"""
    @property
    def objects(self) -> Objects:
        """the Objects, nearest first"""
    @property
    def space(self) -> NDArray[numpy.uint8]:
        """uint8, what each pixel shows: 255 = obstacle, object or not; 128 = floor; 0 = unknown"""
    @property
    def left_out(self) -> List[LeftOut]:
        """a list of LeftOut: obstacles that are no objects, nearest first, and why"""
    @property
    def floor_frame(self) -> Optional[FloorFrame]:
        """the FloorFrame: where the floor is, in metres; None without a rig or a ground"""
    def scan(self) -> Optional[ObstacleScan]:
        """The nearest obstacle in each direction: an ObstacleScan. None without a rig or a ground."""
    def grid(self) -> Optional[ObstacleGrid]:
        """What stands where on the floor: an ObstacleGrid. None without a rig or a ground."""
    def depth_m(self) -> numpy.ndarray[numpy.float32]:
        """(H, W) float32, m: how far each pixel is along the view; NaN = hole."""
    def points(self, object: object = None) -> numpy.ndarray[numpy.float32]:
        """Points in the camera's frame, m, x right, y down, z forward: (H, W, 3) float32, NaN = hole; of an
        Object or of its id alone (N, 3), without holes.
        """
    @property
    def disparity_map(self) -> DisparityMap:
        """disparity and reject as the DisparityMap that stages take"""
    @property
    def ground(self) -> Ground:
        """the floor as a plane, or why there is none"""
    @property
    def by_intensity(self) -> Optional[Segmentation]:
        """Segmentation of the picture by intensity; None with fusion.method=hierarchy"""
    @property
    def by_disparity(self) -> Optional[Segmentation]:
        """Segmentation by disparity; None with fusion.method=hierarchy"""
    @property
    def fusion(self) -> Optional[Fusion]:
        """both fused; None with fusion.method=hierarchy"""
    @property
    def superpixels(self) -> Optional[Segmentation]:
        """the picture's superpixels as a Segmentation; None with fusion.method=overlap"""
    @property
    def groups(self) -> Optional[Segmentation]:
        """Segmentation: region 0 is the background, the others were chosen to be objects; None with
        fusion.method=overlap
        """
    @property
    def epipolar(self) -> EpipolarOffset:
        """how far the right picture's rows were off"""
    @property
    def rig(self) -> Optional[Rig]:
        """the Rig that it was made with, or None"""
    @property
    def config(self) -> Config:
        """the Config that it was made with"""
    @property
    def timings(self) -> Dict[str, float]:
        """milliseconds by stage"""
    @property
    def shape(self) -> Tuple[int, int]:
        """(H, W)"""
    def overlay(self) -> NDArray[numpy.uint8]:
        """The left picture with the objects drawn in, each with its id and distance: (h, w, 3) uint8, RGB;
        small frames are enlarged.
        """
    def disparity_view(self) -> NDArray[numpy.uint8]:
        """Disparity as colour, holes in colours that tell the reason, with a legend: (h, w, 3) uint8, RGB."""
    def to_json(self) -> str:
        """The text of objects.json: objects with masks, ground, configuration, timings (docs/formats.md)."""
    def save(self, folder: PathLike) -> None:
        """Writes the files that `cairn segment -o FOLDER` does (docs/formats.md); whole or not at all."""
    def _repr_png_(self) -> bytes: ...

class Fusion:
    """Which intensity regions make up each fused region: the candidates for objects."""
    @property
    def labels(self) -> NDArray[numpy.int32]:
        """(H, W) int32, read-only: indexes `parts`"""
    @property
    def parts(self) -> List[List[int]]:
        """for each fused region its intensity regions, ascending"""
    @property
    def disparity_region(self) -> List[int]:
        """for each fused region the disparity region that it follows"""
    @property
    def is_floor(self) -> List[bool]:
        """for each fused region: does it follow the floor?"""
    def __len__(self) -> int: ...

class Ground:
    """The floor, or why there is none."""
    @property
    def plane(self) -> Optional[GroundPlane]:
        """a GroundPlane, or None"""
    @property
    def support(self) -> float:
        """0 to 1: share of the valid pixels under the horizon that lie on it"""
    @property
    def residual_px(self) -> float:
        """root mean square distance of these from it, px"""
    @property
    def refusal(self) -> str:
        """why there is no plane, in words; 'none' where there is one"""
    def __bool__(self) -> bool: ...

class GroundPlane:
    """A plane as the left picture's disparity: d = a * x + b * y + c, all in px."""
    @property
    def a(self) -> float:
        """px of disparity for each px to the right"""
    @property
    def b(self) -> float:
        """px of disparity for each px downwards; a floor's is above 0"""
    @property
    def c(self) -> float:
        """px of disparity at x = 0, y = 0"""
    def disparity_px(self, x: float, y: float) -> float:
        """The plane's disparity at (x, y), px; below 0 beyond the horizon."""
    def __iter__(self) -> Iterator[float]: ...

HOLE_16: int

class LeftOut:
    """An obstacle that is no object, and why."""
    @property
    def reason(self) -> str:
        """'background', 'too small' or 'low confidence'"""
    @property
    def box_px(self) -> Tuple[int, int, int, int]:
        """(x, y, width, height), px"""
    @property
    def pixel_count(self) -> int:
        """area, px"""
    @property
    def disparity_px(self) -> float:
        """mean of its pixels, px"""
    @property
    def position_in_camera_m(self) -> Optional[Tuple[float, float, float]]:
        """(x right, y down, z forward), m: of its middle; None without a rig"""
    @property
    def confidence(self) -> float:
        """0 to 1: the best of a region that holds some of it; 0 where none was judged"""

class Matches:
    """The outcome of correlation for each pixel of the left picture (best_right: of the right one). Arrays (H, W), read-only; row_offset is None without match.row_band."""
    @property
    def best(self) -> NDArray[numpy.int16]:
        """int16, disparity of least cost in px; NO_MATCH = none"""
    @property
    def best_right(self) -> Optional[NDArray[numpy.int16]]:
        """int16, the same seen from the right picture"""
    @property
    def row_offset(self) -> Optional[NDArray[numpy.int8]]:
        """int8, row of the match minus y"""
    @property
    def cost(self) -> NDArray[numpy.float32]:
        """float32, of best; inf where there is no match"""
    @property
    def runner_up(self) -> Optional[NDArray[numpy.float32]]:
        """float32, least cost with |d - best| > 1; inf = none"""
    @property
    def mean_cost(self) -> Optional[NDArray[numpy.float32]]:
        """float32, over all candidates of the pixel"""
    @property
    def cost_before(self) -> Optional[NDArray[numpy.float32]]:
        """float32, at best - 1; inf = no such candidate"""
    @property
    def cost_after(self) -> Optional[NDArray[numpy.float32]]:
        """float32, at best + 1; inf = no such candidate"""

class MergeTree:
    """All regions that superpixels fuse to, from the superpixels to the whole image; its length is the number of its nodes. Every node comes after its parts."""
    @property
    def superpixels(self) -> int:
        """number of superpixels: node i below it is superpixel i"""
    @property
    def parents(self) -> NDArray[numpy.int32]:
        """int32, for each node the node that it is a part of; -1 = none"""
    def __len__(self) -> int: ...

class Motion:
    """The camera's motion that one frame shows, or why it shows none."""
    @property
    def now_from_before(self) -> NDArray[numpy.float64]:
        """4 x 4: points of the frame before go to this one; where refused, its stand-in"""
    @property
    def covariance(self) -> NDArray[numpy.float64]:
        """6 x 6 of the pose against the keyframe, translation (m) before rotation (rad)"""
    @property
    def refusal(self) -> str:
        """'none' where it was estimated, else why not: 'few_points', 'no_rig', …"""
    @property
    def is_new_keyframe(self) -> bool:
        """whether the next motions are against this frame"""
    @property
    def is_new_segment(self) -> bool:
        """whether only a guess ties what is seen from here on to what was seen before"""
    @property
    def followed(self) -> int:
        """corners that were followed"""
    @property
    def inliers(self) -> int:
        """corners that agree"""
    @property
    def inlier_share(self) -> float:
        """0 to 1: of the corners that were followed"""
    @property
    def chi2_per_dof(self) -> float:
        """1 where errors are as large as assumed"""

class MotionPrior:
    """What another sensor says of the camera's motion since the frame before."""
    def __init__(self, now_from_before: FloatsLike, covariance: FloatsLike, kind: str = 'wheels') -> None:
        """now_from_before: 4 x 4, takes points of the camera's frame then to its frame now. covariance: 6 x 6,
        translation (m) before rotation (rad). kind: 'wheels', or 'gyroscope', of which only the rotation
        counts.
        """
    @property
    def now_from_before(self) -> NDArray[numpy.float64]:
        """4 x 4 float64"""
    @property
    def covariance(self) -> NDArray[numpy.float64]:
        """6 x 6 float64"""
    @property
    def kind(self) -> str:
        """'wheels' or 'gyroscope'"""

NO_MATCH: int

class Object:
    """Something that stands or hangs in front of the background."""
    @property
    def id(self) -> int:
        """from 1, the nearest, on; its pixels in the map of objects"""
    @property
    def box_px(self) -> Tuple[int, int, int, int]:
        """(x, y, width, height), px"""
    @property
    def pixel_count(self) -> int:
        """area of its mask, px"""
    @property
    def disparity_px(self) -> float:
        """median of its valid pixels, px"""
    @property
    def valid_share(self) -> float:
        """0 to 1: pixels of the mask that have a disparity"""
    @property
    def mean_colour(self) -> Tuple[int, int, int]:
        """(red, green, blue), 0 to 255; grey where the input had no colour"""
    @property
    def position_in_camera_m(self) -> Optional[Tuple[float, float, float]]:
        """(x right, y down, z forward), m: in the middle of its main part, at the depth of disparity_px; None
        without a rig
        """
    @property
    def disparity_sigma_px(self) -> float:
        """standard deviation of disparity_px, px"""
    @property
    def depth_interval_m(self) -> Optional[Tuple[float, float]]:
        """(nearest, farthest), m: where its depth lies with 95 %; None without a rig"""
    @property
    def extent_in_camera_m(self) -> Optional[Tuple[float, float, float]]:
        """(x, y, z), m: the box around the points of its main part, without wild ones; None without a rig"""
    @property
    def box_on_floor(self) -> Optional[FloorBox]:
        """its box, upright on the floor: a FloorBox; None without a rig or a ground"""
    @property
    def distance_m(self) -> Optional[float]:
        """z of its position, m; None without a rig"""
    @property
    def edge_share(self) -> float:
        """0 to 1: of its outline, where the picture shows an edge"""
    @property
    def cut_share(self) -> float:
        """0 to 1: of its outline, what lies at the picture's border"""
    @property
    def confidence(self) -> float:
        """0 to 1: how likely it covers a true object by more than half"""

class ObjectErrors:
    """One frame against its truth."""
    @property
    def truth(self) -> List[TrueObjectScore]:
        """a list of TrueObjectScore"""
    @property
    def ours(self) -> List[FoundObjectScore]:
        """a list of FoundObjectScore"""

class ObjectSummary:
    """Many frames as one: counts, and means over all their objects."""
    @property
    def frames(self) -> int:
        """how many were summarised"""
    @property
    def true_objects(self) -> int:
        """that were scored"""
    @property
    def our_objects(self) -> int:
        """all of ours but those mostly on don't-care"""
    @property
    def phantoms(self) -> int:
        """objects of ours that hardly lie on a true one"""
    @property
    def mean_error(self) -> float:
        """of the paper's E, each capped at 2; 0 is best"""
    @property
    def median_error(self) -> float:
        """of the same, 0 to 2"""
    @property
    def mean_iou(self) -> float:
        """over all scored objects, 0 to 1"""
    @property
    def mean_boundary_f(self) -> float:
        """over all scored objects, 0 to 1"""
    @property
    def recall_50(self) -> float:
        """share of the true objects found with IoU >= 0.5"""
    @property
    def precision_50(self) -> float:
        """share of ours with IoU >= 0.5"""

class Objects:
    """The objects of a frame, nearest first: a sequence of Object, and their map."""
    @property
    def labels(self) -> NDArray[numpy.int32]:
        """(H, W) int32, read-only: ids, 0 = no object"""
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, index: int) -> Object: ...
    @overload
    def __getitem__(self, range: slice) -> List[Object]: ...
    def __iter__(self) -> Iterator[Object]: ...

class ObstacleGrid:
    """What stands where on the floor: rows along y, from the right to the left, of cells along x, from the camera forward."""
    @property
    def cell_size_m(self) -> float:
        """side of a cell, m"""
    @property
    def origin_in_floor_m(self) -> Tuple[float, float]:
        """(x, y), m: corner of the first cell"""
    @property
    def cells(self) -> numpy.ndarray[numpy.int8]:
        """(height, width) int8: -1 = unknown, 0 = free, 100 = occupied"""

class ObstacleScan:
    """The nearest obstacle in each direction, as a laser scanner has it, seen from the floor below the left camera."""
    @property
    def angle_min_rad(self) -> float:
        """of the first; counter-clockwise from straight ahead"""
    @property
    def angle_increment_rad(self) -> float:
        """from one to the next"""
    @property
    def range_max_m(self) -> float:
        """how far it reaches, m"""
    @property
    def ranges_m(self) -> numpy.ndarray[numpy.float32]:
        """(N,) float32, m; NaN: no obstacle is seen there, which does not say that there is none"""
    def __len__(self) -> int: ...

class Option:
    """One option of the method, as the command and the reference page name it."""
    @property
    def name(self) -> str:
        """its group and name, 'match.window_size'"""
    @property
    def group(self) -> str:
        """the stage that it belongs to, 'match'"""
    @property
    def type(self) -> str:
        """'int', 'float', 'bool' or 'choice'"""
    @property
    def default(self) -> object:
        """value in the preset asked for"""
    @property
    def unit(self) -> str:
        """may be empty"""
    @property
    def range(self) -> str:
        """'3 … 31, odd', '−1 = off, 0 … 64', 'sad|ssd|…'"""
    @property
    def help(self) -> str:
        """what it does"""
    @property
    def needs(self) -> str:
        """'match.method=window', 'ground.source!=off': it is read only while that is so; '' = always"""
    @property
    def active(self) -> bool:
        """whether the preset asked for reads it"""

class PairMeasures:
    """All that measure_pair() measures of one pair."""
    @property
    def size(self) -> Tuple[int, int]:
        """(width, height), px"""
    @property
    def identical(self) -> bool:
        """the right picture is the left one, pixel for pixel"""
    @property
    def textured_points(self) -> int:
        """of the left picture, that were looked for in the right one"""
    @property
    def rows(self) -> RowAlignment:
        """a RowAlignment"""
    @property
    def disparities_px(self) -> NDArray[numpy.float32]:
        """float32, px, ascending: of the points that agree and are not alone with theirs; a copy"""
    def disparity_px(self, share: float) -> float:
        """The disparity, px, that `share` (0 to 1) of the points stay below; NaN without points."""
    @property
    def brightness(self) -> BrightnessDifference:
        """a BrightnessDifference"""
    @property
    def left_exposure(self) -> Exposure:
        """an Exposure"""
    @property
    def right_exposure(self) -> Exposure:
        """an Exposure"""
    @property
    def left_sharpness(self) -> Sharpness:
        """a Sharpness"""
    @property
    def right_sharpness(self) -> Sharpness:
        """a Sharpness"""

class Region:
    """A set of connected pixels. Mean and variance are over its valid pixels: of grey levels, or of disparities in px."""
    @property
    def pixel_count(self) -> int:
        """its area, px"""
    @property
    def valid_count(self) -> int:
        """pixels that carry a value"""
    @property
    def box(self) -> Tuple[int, int, int, int]:
        """(x, y, width, height), px"""
    @property
    def mean(self) -> float:
        """of its valid pixels: grey levels, 0 to 255, or px of disparity; 0 without any"""
    @property
    def variance(self) -> float:
        """of its valid pixels (population), at least 0: grey levels squared, or px squared"""
    @property
    def is_floor(self) -> bool:
        """the one floor region of a disparity segmentation"""
    @property
    def is_background(self) -> bool:
        """the region that holds all that is no object, in the groups of a frame"""

class RegionGraph:
    """Regions and which of them touch (4-neighbourhood)."""
    def __len__(self) -> int: ...
    def neighbours(self, region: int) -> List[int]:
        """The regions that touch this one, ascending."""

class Reject(enum.IntFlag):
    """Why a pixel has no disparity: a set of bits, as in frame.reject.
    frame.reject & cairn.Reject.left_right != 0   # seen by one camera only
border: no candidate lay inside the right image; left_right: followed back from the right image, the match does not return; not_unique: another disparity fits nearly as well; flat: every disparity fits equally badly or well; no_texture: too little texture to match at all; below_ground: under the floor: a reflection; speckle: a small island of disparity; no_data: the external disparity map had no value here."""
    none: Reject
    border: Reject
    left_right: Reject
    not_unique: Reject
    flat: Reject
    no_texture: Reject
    below_ground: Reject
    speckle: Reject
    no_data: Reject

class Rig:
    """The calibration of a rectified pair (C++: StereoRig). Depth in metres: Z = focal_px * baseline_m / (d + doffs_px), d in px."""
    def __init__(
        self,
        focal_px: float,
        baseline_m: float,
        cx_px: float = 0.0,
        cy_px: float = 0.0,
        doffs_px: float = 0.0,
    ) -> None:
        """Raises cairn.Error unless every number is finite and focal length and baseline are positive."""
    @staticmethod
    def from_file(path: PathLike) -> Rig:
        """The rig of a calibration file, see load_calibration(). Raises cairn.Error where it has none."""
    @property
    def focal_px(self) -> float:
        """focal length, px"""
    @property
    def baseline_m(self) -> float:
        """distance of the cameras, m"""
    @property
    def cx_px(self) -> float:
        """principal point of the left camera, px"""
    @property
    def cy_px(self) -> float:
        """principal point of the left camera, px"""
    @property
    def doffs_px(self) -> float:
        """cx of the right camera less cx of the left one, px"""
    def point_in_camera_m(self, x: float, y: float, disparity_px: float) -> Optional[Tuple[float, float, float]]:
        """The point (x right, y down, z forward; m) that pixel (x, y) with this disparity shows in the left
        camera's frame; None at or beyond infinity.
        """
    def __eq__(self, other: object) -> bool: ...

class RowAlignment:
    """How well the rows of both pictures are the same: what the left one shows in row y should stand in the right one's row y; it stands at y + offset_rows + rows_per_px * (x - (width - 1) / 2)."""
    @property
    def points(self) -> int:
        """found in both pictures"""
    @property
    def agreeing(self) -> int:
        """those of them within a row of what a smooth distortion explains"""
    @property
    def agreeing_share(self) -> float:
        """0 to 1: agreeing / points"""
    @property
    def offset_rows(self) -> float:
        """rows, in the middle column"""
    @property
    def rows_per_px(self) -> float:
        """tangent of the roll"""
    @property
    def left_over_rows(self) -> float:
        """rows that 9 in 10 points at most are off once shift and roll are taken back"""
    @property
    def histogram(self) -> Dict[int, int]:
        """by rows that the right point is lower, -8 to 8: points; the outermost count all beyond"""

class SceneDisparity:
    """Disparity with everything that speaks against it, ground and speckle included."""
    @property
    def disparity_map(self) -> DisparityMap:
        """disparity and reject as the DisparityMap that stages take"""
    @property
    def disparity(self) -> NDArray[numpy.float32]:
        """(H, W) float32, px, read-only; NaN = hole"""
    @property
    def reject(self) -> NDArray[numpy.uint16]:
        """(H, W) uint16, bits of cairn.Reject"""
    @property
    def ground(self) -> Ground:
        """the floor as a plane, or why there is none"""
    @property
    def floor(self) -> Optional[NDArray[numpy.uint8]]:
        """(H, W) uint8, 255 = floor; None where there is none"""
    @property
    def epipolar(self) -> EpipolarOffset:
        """an EpipolarOffset: how far the right picture's rows were off, rows"""
    @property
    def confidence(self) -> Optional[NDArray[numpy.float32]]:
        """(H, W) float32, 0 to 1; or None"""

class Segmentation:
    """Regions: every pixel belongs to one."""
    @property
    def labels(self) -> NDArray[numpy.int32]:
        """(H, W) int32, read-only: indexes `regions`"""
    @property
    def regions(self) -> List[Region]:
        """a list of Region, in raster order of their first pixel"""
    def __len__(self) -> int: ...

class Segmenter:
    """segment() for video: keeps threads and image buffers from frame to frame, so that from the second frame on no image is allocated (as long as earlier frames, and arrays of them, have died). Every frame is what segment() would give. Several threads may use one."""
    def __init__(
        self,
        rig: RigLike = None,
        *,
        preset: str = 'default',
        config: Union[Config, PathLike, None] = None,
        exec: Optional[Exec] = None,
        epipolar_correction: EpipolarCorrectionOptions = ...,
        match: MatchOptions = ...,
        semi_global: SemiGlobalOptions = ...,
        subpixel: SubpixelOptions = ...,
        left_right: LeftRightOptions = ...,
        uniqueness: UniquenessOptions = ...,
        flatness: FlatnessOptions = ...,
        texture: TextureOptions = ...,
        ground: GroundOptions = ...,
        speckle: SpeckleOptions = ...,
        evidence: EvidenceOptions = ...,
        background: BackgroundOptions = ...,
        intensity: IntensityOptions = ...,
        disparity: DisparityOptions = ...,
        fusion: FusionOptions = ...,
        superpixels: SuperpixelsOptions = ...,
        objects: ObjectsOptions = ...,
        space: SpaceOptions = ...,
    ) -> None:
        """The arguments are those of segment()."""
    def segment(self, left: ImageLike, right: ImageLike, *, bgr: bool = False) -> Frame:
        """One frame."""
    @property
    def config(self) -> Config:
        """the Config that it works with"""
    @property
    def rig(self) -> Optional[Rig]:
        """the Rig that it measures with, or None"""
    @property
    def exec(self) -> Exec:
        """the Exec that it works with: its own threads and pool of images"""

class Sharpness:
    """How many pixels an edge takes from dark to bright."""
    @property
    def edges(self) -> int:
        """that were measured"""
    @property
    def edge_px(self) -> float:
        """px, a quarter of them are narrower; 1 = a step; 0 = too few edges"""

class Step:
    """All that is known after one frame of a sequence."""
    @property
    def index(self) -> int:
        """the frame's number, from 0"""
    @property
    def stamp_ns(self) -> int:
        """when it was taken, ns"""
    @property
    def seconds(self) -> float:
        """when it was taken, s"""
    @property
    def frame(self) -> Frame:
        """the Frame"""
    @property
    def ids(self) -> NDArray[numpy.int64]:
        """(H, W) int64, read-only: the track that each pixel belongs to; 0 = none"""
    @property
    def tracks(self) -> List[Track]:
        """a list of Track by id, those out of view included"""
    @property
    def motion(self) -> Motion:
        """the camera's Motion"""
    @property
    def map_from_camera(self) -> NDArray[numpy.float64]:
        """4 x 4 float64: where the left camera is; takes points of its frame to the map's"""
    @property
    def pose_covariance(self) -> NDArray[numpy.float64]:
        """6 x 6 of map_from_camera, translation (m) before rotation (rad)"""
    @property
    def is_lost(self) -> bool:
        """whether the camera's place is not known"""
    @property
    def reliability(self) -> Dict[str, Any]:
        """how far the frame is to be trusted: value (0 ... 1 or None), the witnesses it is the mean of, and
        the weakest one's name
        """
    @property
    def odometry_suspect(self) -> bool:
        """whether most tracks began to move at once: rather the camera's motion is wrong"""
    @property
    def landmarks(self) -> Dict[int, int]:
        """of follow(): landmark by track, both by id"""
    @property
    def events(self) -> List[Tuple[str, int]]:
        """of follow(): (kind, landmark), kind 'new', 'moved', 'gone', 'back' or 'relocated'"""
    def to_json(self) -> str:
        """The frame's line of tracks.jsonl, as `cairn follow --json-lines` prints it (docs/formats.md)."""
    def overlay(self) -> NDArray[numpy.uint8]:
        """The left picture with its tracks drawn in, each with its id: (h, w, 3) uint8, RGB."""
    def _repr_png_(self) -> bytes: ...

class Superpixels:
    """The image cut into connected pieces that no clear edge of brightness, colour or depth runs through."""
    @property
    def labels(self) -> NDArray[numpy.int32]:
        """(H, W) int32, read-only: 0 to count - 1"""
    @property
    def count(self) -> int:
        """number of superpixels, 1 or more"""

class Synchrony:
    """Whether the two cameras of a sequence took their pictures at the same moments."""
    @property
    def frames(self) -> int:
        """pairs that were looked at"""
    @property
    def lag(self) -> int:
        """frames that the right camera is late, as the numbers say; 0 without evidence"""
    @property
    def motion(self) -> Dict[int, float]:
        """by frames that the right camera is late, -2 to 2: correlation of the changes in both pictures, -1 to
        1; 0 where nothing changes
        """
    @property
    def agreement(self) -> Dict[int, float]:
        """by the same: share of the textured points that agree in their rows, 0 to 1; 0 where not tried"""
    @property
    def left_repeats(self) -> int:
        """frames in which only the left picture is the one before once more"""
    @property
    def right_repeats(self) -> int:
        """the same of the right one"""
    @property
    def change(self) -> Optional[Tuple[int, int, int]]:
        """None, or (frame, lag before, lag after): from that frame on, give or take one, the right camera is
        late by another number of frames
        """
    @property
    def tells(self) -> bool:
        """whether the numbers tell one lag from another: False where too little moves"""

class Track:
    """An object over time. Metres are those of the map's frame: z up, its origin on the floor below the first frame's camera, x forward."""
    @property
    def id(self) -> int:
        """from 1; never used twice in a run"""
    @property
    def state(self) -> str:
        """'tentative', 'confirmed', 'occluded', 'out_of_view', 'lost' or 'dead'"""
    @property
    def is_moving(self) -> bool:
        """by itself, not by the camera's motion"""
    @property
    def object(self) -> int:
        """id of its Object in this frame; 0 = not seen"""
    @property
    def parts(self) -> List[int]:
        """ids of further objects of this frame that are pieces of it"""
    @property
    def is_joined(self) -> bool:
        """this frame shows it as one object with another track"""
    @property
    def position_m(self) -> Optional[Tuple[float, float, float]]:
        """(x, y, z), m; None without a rig"""
    @property
    def covariance_m2(self) -> Optional[NDArray[numpy.float64]]:
        """3 x 3 of position_m, m²; None without a rig"""
    @property
    def velocity_m_s(self) -> Optional[Tuple[float, float, float]]:
        """(x, y, z), m/s; 0 where it stands; None without a rig"""
    @property
    def extent_m(self) -> Optional[Tuple[float, float, float]]:
        """(x, y, z) in the camera's frame, m: the box around its points; None without a rig"""
    @property
    def confidence(self) -> float:
        """0 to 1, smoothed"""
    @property
    def hits(self) -> int:
        """frames in which it was seen"""
    @property
    def misses(self) -> int:
        """frames since then in which it should have been seen"""
    @property
    def first_ns(self) -> int:
        """stamp of its first frame, ns"""
    @property
    def last_ns(self) -> int:
        """stamp when it was last seen, ns"""

class TrueObjectScore:
    """How well one true object was found."""
    @property
    def id(self) -> int:
        """its number in the truth, from 1 on"""
    @property
    def pixel_count(self) -> int:
        """its area, px"""
    @property
    def found(self) -> int:
        """our object of greatest IoU; 0 = none"""
    @property
    def iou(self) -> float:
        """0 to 1: intersection over union with `found`; 0 where nothing overlaps"""
    @property
    def boundary_f(self) -> float:
        """0 to 1: how much of both outlines lies within the tolerance of the other"""
    @property
    def over_segmented(self) -> bool:
        """two or more of ours lie mostly on it and cover more than half of it"""
    @property
    def under_segmented(self) -> bool:
        """more than half of it lies in one of ours that holds more than half of another, too"""
    @property
    def error(self) -> float:
        """the paper's E, Eq. 5: 1 / IoU - 1; inf where nothing overlaps"""

class Tuning:
    """What tune() found."""
    @property
    def config(self) -> Config:
        """the Config to use: the tuned one, or the start where that is kept"""
    @property
    def goal(self) -> str:
        """what was made small: 'objects' (the paper's E), 'disparities' (off by more than 1 px; a hole counts
        half) or 'consistency' (contradictions, where no truth is known)
        """
    @property
    def before(self) -> float:
        """mean loss of the start on the frames tuned on, from 0; 0 is best"""
    @property
    def after(self) -> float:
        """the same of the best that was found"""
    @property
    def held_out_before(self) -> Optional[float]:
        """mean loss of the start on the frames held out; None where none are"""
    @property
    def held_out_after(self) -> Optional[float]:
        """the same of the best that was found"""
    @property
    def held_out(self) -> List[int]:
        """indices of the frames held out"""
    @property
    def changes(self) -> Dict[str, Tuple[Any, Any]]:
        """what the best changes: by option, (value before, value after); also where the start is kept"""
    @property
    def kept_because(self) -> Optional[str]:
        """why `config` is the start; None where it is the best that was found"""
    @property
    def options(self) -> List[str]:
        """the names of the options that were searched"""
    @property
    def not_judged(self) -> List[str]:
        """names that were asked for but change nothing that can be judged"""
    @property
    def evaluations(self) -> int:
        """settings that were measured, the start among them"""
    @property
    def seconds(self) -> float:
        """that it took"""
    @property
    def end(self) -> str:
        """'converged' (nothing near the best is better), 'evaluations', 'time' or 'interrupted'"""

class TuningFrame:
    """A pair to tune on, with what is known to be true of it. Borrows its arrays, as segment() does."""
    def __init__(
        self,
        left: ImageLike,
        right: ImageLike,
        rig: RigLike = None,
        *,
        objects: Optional[LabelsLike] = None,
        truth_px: Optional[FloatsLike] = None,
        hidden: MaskLike = None,
        partial: bool = False,
        name: str = '',
        bgr: bool = False,
    ) -> None:
        """left, right, rig, bgr: as for segment(). objects: (H, W) integers, the true objects' ids, 0 = none,
        -1 = don't care; truth_px: (H, W) float32, true disparities in px, NaN = not known; hidden: (H, W)
        uint8, not 0 = not seen by the right camera; each may be None. partial: not every object is
        labelled. name: frames of one name show the same scene.
        """
    @property
    def name(self) -> str:
        """as errors call it; frames of one name show the same scene"""
    @property
    def objects(self) -> object:
        """(H, W) int32, the true ids, a copy; None where not known"""
    @property
    def truth_px(self) -> object:
        """(H, W) float32, px, a copy; None where not known"""
    @property
    def hidden(self) -> object:
        """(H, W) uint8, a copy; None where not known"""
    @property
    def partial(self) -> bool:
        """whether objects may be missing in the truth"""

def apply_merges(
    labels: LabelsLike,
    graph: RegionGraph,
    merged_into: List[int],
    value_scale: float = 1.0,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> Segmentation:
    """Writes what growing made. value_scale: what one unit of the graph's values is (1/16 px for
    disparities).
    """

def build_graph(
    labels: LabelsLike,
    values: NumbersLike,
    floor: MaskLike = None,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> RegionGraph:
    """Counts and links regions. labels: (H, W) integers from 0 on; values: what the statistics are of, (H,
    W) uint8 grey levels, or int16 as quantised() gives them, then with floor: (H, W) uint8, not 0 =
    floor, or None.
    """

def choose_objects(
    tree: MergeTree,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    min_area: float = ...,
    max_area: float = ...,
    min_confidence: float = ...,
) -> ChosenObjects:
    """Chooses the regions of the tree that are likeliest whole objects; no two share a superpixel. Of the
    options only min_area and min_confidence count.
    """

def combine(
    refined_px: FloatsLike,
    verdicts: sequence,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> DisparityMap:
    """Unites verdicts, arrays (H, W) uint16 of cairn.Reject bits (yours among them), with the disparities:
    a pixel keeps every bit that it got, NaN adds Reject.border. refined_px: (H, W) float32, px.
    """

def compiled_targets() -> List[str]:
    """The instruction sets in this build, slowest first."""

def correct_epipolar(
    left: ImageLike,
    right: ImageLike,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    max_rows: float = ...,
    method: Literal["window", "semi_global"] = ...,
    cost: Literal["sad", "ssd", "zsad", "zssd", "nssd", "zncc"] = ...,
    window_size: int = ...,
    min_disparity: int = ...,
    num_disparities: int = ...,
    row_band: int = ...,
    prefilter: Literal["none", "xsobel"] = ...,
    prefilter_cap: int = ...,
) -> EpipolarCorrection:
    """Both: compensates a small misalignment of the cameras, as vibration makes it, before the matching."""

def cut_superpixels(
    left: ImageLike,
    disparity: DisparityLike,
    noise_sigma: float,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    count: int = ...,
) -> Superpixels:
    """Cuts the image into connected pieces that no clear edge runs through, by brightness, colour (where
    there is colour) and steps of disparity. noise_sigma as noise_sigma() gives it.
    """

@overload
def diagnose(
    measures: PairMeasures,
    rig: RigLike = None,
    *,
    limits: Optional[Dict[str, Any]] = None,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    method: Literal["window", "semi_global"] = ...,
    cost: Literal["sad", "ssd", "zsad", "zssd", "nssd", "zncc"] = ...,
    window_size: int = ...,
    min_disparity: int = ...,
    num_disparities: int = ...,
    row_band: int = ...,
    prefilter: Literal["none", "xsobel"] = ...,
    prefilter_cap: int = ...,
) -> List[Finding]: ...
@overload
def diagnose(synchrony: Synchrony) -> Optional[Finding]: ...

def disparity_errors(
    ours_px: FloatsLike,
    truth_px: FloatsLike,
    excluded: MaskLike = None,
    skip_left: int = 0,
) -> DisparityErrors:
    """Compares two disparity maps, (H, W) float32 in px, NaN = a hole, no truth. excluded: (H, W) uint8,
    pixels that are not 0 are left out; columns x < skip_left are left out, too.
    """

def draw_disparity(disparity: DisparityLike, rig: RigLike = None) -> NDArray[numpy.uint8]:
    """Disparity as colour, holes in colours that tell the reason, with a legend (with a rig in metres,
    too): (h, w, 3) uint8, RGB.
    """

def draw_objects(
    left: ImageLike,
    objects: Objects,
    floor: MaskLike = None,
    *,
    bgr: bool = False,
) -> NDArray[numpy.uint8]:
    """The left picture with the objects drawn in: (h, w, 3) uint8, RGB."""

def edge_strength(
    left: ImageLike,
    smoothing_sigma: float = 0.699999988079071,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> NDArray[numpy.uint16]:
    """Edges that superpixels follow: central differences in 1/4 grey level, of colour the strongest
    channel's. (H, W) uint16.
    """

def estimate_confidence(
    matches: Matches,
    disparity: DisparityLike,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    method: Literal["window", "semi_global"] = ...,
    cost: Literal["sad", "ssd", "zsad", "zssd", "nssd", "zncc"] = ...,
    window_size: int = ...,
    min_disparity: int = ...,
    num_disparities: int = ...,
    row_band: int = ...,
    prefilter: Literal["none", "xsobel"] = ...,
    prefilter_cap: int = ...,
) -> NDArray[numpy.float32]:
    """How likely each disparity is within 1 px of the truth: (H, W) float32, 0 to 1; 0 where there is
    none. Of the group match only `method` counts: how `matches` was made.
    """

def estimate_disparity(
    left: ImageLike,
    right: ImageLike,
    rig: RigLike = None,
    *,
    preset: str = 'default',
    config: Union[Config, PathLike, None] = None,
    exec: Optional[Exec] = None,
    bgr: bool = False,
    epipolar_correction: EpipolarCorrectionOptions = ...,
    match: MatchOptions = ...,
    semi_global: SemiGlobalOptions = ...,
    subpixel: SubpixelOptions = ...,
    left_right: LeftRightOptions = ...,
    uniqueness: UniquenessOptions = ...,
    flatness: FlatnessOptions = ...,
    texture: TextureOptions = ...,
    ground: GroundOptions = ...,
    speckle: SpeckleOptions = ...,
    evidence: EvidenceOptions = ...,
    background: BackgroundOptions = ...,
    intensity: IntensityOptions = ...,
    disparity: DisparityOptions = ...,
    fusion: FusionOptions = ...,
    superpixels: SuperpixelsOptions = ...,
    objects: ObjectsOptions = ...,
    space: SpaceOptions = ...,
) -> SceneDisparity:
    """The method's first half: matching and every check, ground and speckle included. Returns a
    SceneDisparity.
    left, right: a rectified pair of one size, (H, W) or (H, W, 3) uint8, RGB (bgr=True: OpenCV's
    order): what stands at (x, y) on the left stands at (x - d, y) on the right. Arrays whose rows are
    dense are used where they lie, without a copy, grey ones and RGB; do not write to them meanwhile.
    Matching works on grey, which is computed from colours; bgr=True and other layouts cost a copy. rig:
    a Rig, a Calibration, or None: no metres then. preset, then config (a Config or a file's name), then
    the options; later ones win. Other Python threads run meanwhile. Raises cairn.Error for what cannot
    be used.
    """

def external_disparity(
    disparity_px: FloatsLike,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> DisparityMap:
    """A map from outside (depth camera, learned matcher), (H, W) float32 in px: NaN and inf become holes
    with Reject.no_data.
    """

def find_epipolar_offset(
    left: ImageLike,
    right: ImageLike,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    max_rows: float = ...,
    method: Literal["window", "semi_global"] = ...,
    cost: Literal["sad", "ssd", "zsad", "zssd", "nssd", "zncc"] = ...,
    window_size: int = ...,
    min_disparity: int = ...,
    num_disparities: int = ...,
    row_band: int = ...,
    prefilter: Literal["none", "xsobel"] = ...,
    prefilter_cap: int = ...,
) -> EpipolarOffset:
    """Finds how far the right picture's rows are off, from textured points all over it. left, right: (H,
    W) or (H, W, 3) uint8 of one size.
    """

def find_evidence(
    left: ImageLike,
    disparity: DisparityLike,
    noise_sigma: float,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    gradient_min: float = ...,
) -> NDArray[numpy.float32]:
    """The disparities that rest on the pixel's own texture, NaN elsewhere: (H, W) float32, px. noise_sigma
    as noise_sigma() gives it.
    """

def fit_background(
    evidence_px: FloatsLike,
    ground: Ground,
    rig: RigLike = None,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    max_walls: int = ...,
) -> Background:
    """Finds walls: upright planes with much evidence on them and hardly any behind. evidence_px as
    find_evidence() gives it.
    """

def fit_ground(
    disparity: DisparityLike,
    rig: RigLike = None,
    *,
    left: Optional[ImageLike] = None,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    source: Literal["off", "automatic", "points", "pose"] = ...,
    margin: float = ...,
    label_floor: bool = ...,
) -> Ground:
    """Finds the floor in a disparity map (or in floats, NaN = hole: in those alone that deserve trust;
    with these, `left` also shows a floor that mirrors so well that it has hardly any disparities of its
    own).
    """

def floor_frame(ground: GroundPlane, rig: RigLike) -> Optional[FloorFrame]:
    """Where the floor is: a FloorFrame, or None for a plane that no floor below a camera can show."""

def floor_under_reflections(
    disparity: DisparityLike,
    ground: Ground,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> NDArray[numpy.float32]:
    """(H, W) float32, px: the disparities of what is seen: those of the ground where a match was rejected
    as below it, NaN in other holes.
    """

def follow(
    source: PathLike,
    *,
    calib: Optional[PathLike] = None,
    layout: str = '',
    rate_hz: float = 0.0,
    frames: str = '',
    rectify: bool = False,
    odometry_file: Optional[PathLike] = None,
    imu_file: Optional[PathLike] = None,
    poses_file: Optional[PathLike] = None,
    map_file: Optional[PathLike] = None,
    read_only: bool = False,
    preset: str = 'default',
    config: Union[Config, PathLike, None] = None,
    exec: Optional[Exec] = None,
    epipolar_correction: EpipolarCorrectionOptions = ...,
    match: MatchOptions = ...,
    semi_global: SemiGlobalOptions = ...,
    subpixel: SubpixelOptions = ...,
    left_right: LeftRightOptions = ...,
    uniqueness: UniquenessOptions = ...,
    flatness: FlatnessOptions = ...,
    texture: TextureOptions = ...,
    ground: GroundOptions = ...,
    speckle: SpeckleOptions = ...,
    evidence: EvidenceOptions = ...,
    background: BackgroundOptions = ...,
    intensity: IntensityOptions = ...,
    disparity: DisparityOptions = ...,
    fusion: FusionOptions = ...,
    superpixels: SuperpixelsOptions = ...,
    objects: ObjectsOptions = ...,
    space: SpaceOptions = ...,
    odometry: OdometryOptions = ...,
    tracking: TrackingOptions = ...,
    repair: RepairOptions = ...,
    landmarks: LandmarksOptions = ...,
    control: ControlOptions = ...,
) -> Following:
    """Follows a whole sequence: an iterator of Steps.
    source: a folder of frames, of KITTI's or EuRoC's, 'LEFT,RIGHT', or a video with layout
    (docs/sequences.md). calib: instead of the source's own. frames: 'A:B:STEP'. rectify: the pictures
    are raw. odometry_file, imu_file, poses_file: what other sensors say of the motion. map_file:
    landmarks to recognise and to add to; read_only: it stays as it is. These are the options of `cairn
    follow`, and the steps are its own. preset, config (a Config or a file's name) and options are those
    of segment(), with the groups of follow_options() besides: tracking={'min_hits': 2}.
    """

def follow_options() -> List[Option]:
    """Every option of sequences with its default, in the order of the stages; those of a frame are in
    options().
    """

def fuse(
    by_intensity: Segmentation,
    by_disparity: Segmentation,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> Fusion:
    """Each intensity region goes to the disparity region with the greatest overlap (paper, Eq. 4)."""

def gradient(
    image: NumbersLike,
    smoothing_sigma: float = 0.0,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> NDArray[numpy.uint16]:
    """Gradient magnitude: of a picture, (H, W) uint8, in grey levels, capped at 255; or of quantised()
    disparities, int16, in 1/16 px, 65535 in holes. (H, W) uint16, from one side of a pixel to the
    other.
    """

def groups_of(
    superpixels: Superpixels,
    chosen: ChosenObjects,
    disparity: DisparityLike,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> Segmentation:
    """The chosen objects as a Segmentation: region 0 is all else (is_background), the others are the
    objects. Means in px.
    """

def grow_merge_tree(
    superpixels: Superpixels,
    left: ImageLike,
    disparity: DisparityLike,
    evidence_px: FloatsLike,
    ground: Ground,
    background: Background,
    noise_sigma: float,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> MergeTree:
    """Fuses the two neighbouring regions that are likeliest one thing, by every cue and by fitted trees,
    until none are left. evidence_px as find_evidence() gives it, ground as likely_ground(), noise_sigma
    as noise_sigma().
    """

def grow_near_to_far(
    graph: RegionGraph,
    *,
    mean_difference_max: float,
    deviation_max: float,
    sigma_min: float,
    min_region_area: int = 0,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> NDArray[numpy.int32]:
    """The paper's region growing for disparity, from the nearest region to the farthest; else as
    grow_statistical().
    """

def grow_statistical(
    graph: RegionGraph,
    *,
    mean_difference_max: float,
    deviation_max: float,
    sigma_min: float,
    min_region_area: int = 0,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> NDArray[numpy.int32]:
    """Statistical region growing (paper, Eq. 1 to 3): for each region that in which it ended, int32. The
    criteria are in units of the graph's values; min_region_area in px.
    """

def label_floor(
    disparity: DisparityLike,
    ground: Ground,
    rig: RigLike = None,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    source: Literal["off", "automatic", "points", "pose"] = ...,
    margin: float = ...,
    label_floor: bool = ...,
) -> Optional[NDArray[numpy.uint8]]:
    """(H, W) uint8: 255 where the disparity is the floor's, else 0. None where there is no ground or
    label_floor is off.
    """

def label_space(
    objects: Objects,
    disparity: DisparityLike,
    confidence: FloatsLike,
    ground: Ground,
    background: Background,
    superpixels: Superpixels,
    seen_px: FloatsLike,
    rig: RigLike = None,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    source: Literal["off", "automatic", "points", "pose"] = ...,
    margin: float = ...,
    label_floor: bool = ...,
) -> NDArray[numpy.uint8]:
    """What each pixel shows: (H, W) uint8, 255 = obstacle, 128 = floor, 0 = unknown. seen_px as
    floor_under_reflections() gives it.
    """

def likely_ground(
    ground: Ground,
    disparity: DisparityLike,
    rig: RigLike = None,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    source: Literal["off", "automatic", "points", "pose"] = ...,
    margin: float = ...,
    label_floor: bool = ...,
) -> Ground:
    """The ground itself, or where it was refused for want of evidence, one fitted to all disparities: a
    plain floor has no texture that would vouch for it.
    """

def load_calibration(path: PathLike) -> Calibration:
    """Reads a calibration, its form recognised by content: our own YAML, Middlebury, KITTI, OpenCV
    FileStorage, ROS camera_info (or the folder of a pair of them), key=value lines. Raises cairn.Error.
    """

def load_disparity(path: PathLike) -> NDArray[numpy.float32]:
    """A disparity map from .png (16 bits, px * 256, 0 = hole), .pfm or .npy, or of Middlebury in its own 8
    bits: (H, W) float32, px, NaN = hole.
    """

def load_labels(path: PathLike) -> NDArray[numpy.uint16]:
    """The numbers of a one-channel file as they stand: (H, W) uint16."""

def load_pair(left: PathLike, right: PathLike) -> Tuple[NDArray[numpy.uint8], NDArray[numpy.uint8]]:
    """Both pictures; deeper ones are reduced by the same factor, so that a difference of exposure stays
    what it was.
    """

def load_picture(path: PathLike) -> NDArray[numpy.uint8]:
    """A PNG, JPEG, PGM, PPM or TIFF file: (H, W) uint8 where it is grey, (H, W, 3) RGB where it is in
    colour. Of deeper pictures the low bits are dropped.
    """

def load_tuning_frames(folder: PathLike, truth: bool = False) -> List[TuningFrame]:
    """Every frame of a folder, as `cairn tune` reads them: a folder with left.png and right.png is one,
    else each of its sub-folders with those; a calib.txt belongs to it. truth: with objects.png,
    disp_left.png and occlusion.png, of which one of the first two must be there.
    """

def locate(
    objects: Objects,
    disparity: DisparityLike,
    ground: Ground,
    rig: RigLike = None,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> Objects:
    """Where objects are: the uncertainty of their disparity and, with a rig, position, interval of depth,
    extent, and with a ground their box on the floor. Returns Objects.
    """

def match(
    left: ImageLike,
    right: ImageLike,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    method: Literal["window", "semi_global"] = ...,
    cost: Literal["sad", "ssd", "zsad", "zssd", "nssd", "zncc"] = ...,
    window_size: int = ...,
    min_disparity: int = ...,
    num_disparities: int = ...,
    row_band: int = ...,
    prefilter: Literal["none", "xsobel"] = ...,
    prefilter_cap: int = ...,
    penalty_small: float = ...,
    penalty_large: float = ...,
    penalty_edge: float = ...,
) -> Matches:
    """Matches every pixel of the left picture with its candidates in the same row of the right one; the
    winner takes all. left, right: (H, W) or (H, W, 3) uint8 of one size, rectified: what stands at (x,
    y) on the left stands at (x - d, y) on the right.
    """

def match_semi_global(
    left: ImageLike,
    right: ImageLike,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    method: Literal["window", "semi_global"] = ...,
    cost: Literal["sad", "ssd", "zsad", "zssd", "nssd", "zncc"] = ...,
    window_size: int = ...,
    min_disparity: int = ...,
    num_disparities: int = ...,
    row_band: int = ...,
    prefilter: Literal["none", "xsobel"] = ...,
    prefilter_cap: int = ...,
    penalty_small: float = ...,
    penalty_large: float = ...,
    penalty_edge: float = ...,
) -> Matches:
    """match() with method='semi_global', whatever the configuration says: neighbours vote along four paths
    (Hirschmueller 2008). Of the group match only min_disparity and num_disparities count.
    """

def match_windows(
    left: ImageLike,
    right: ImageLike,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    method: Literal["window", "semi_global"] = ...,
    cost: Literal["sad", "ssd", "zsad", "zssd", "nssd", "zncc"] = ...,
    window_size: int = ...,
    min_disparity: int = ...,
    num_disparities: int = ...,
    row_band: int = ...,
    prefilter: Literal["none", "xsobel"] = ...,
    prefilter_cap: int = ...,
) -> Matches:
    """match() with method='window', whatever the configuration says: a square window for every pixel, on
    its own.
    """

def measure(
    candidates: LabelsLike,
    is_background: List[bool],
    disparity: DisparityLike,
    left: ImageLike,
    noise_sigma: float,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    min_area: float = ...,
    max_area: float = ...,
    min_confidence: float = ...,
) -> Objects:
    """Turns candidates into objects: what is background, too large, too small, unseen or unlikely is none.
    candidates: (H, W) integers, the regions of a Fusion; is_background: for each of them, whether it is
    known to be no object; noise_sigma as noise_sigma() gives it.
    """

def measure_chosen(
    chosen: LabelsLike,
    scores: List[float],
    disparity: DisparityLike,
    left: ImageLike,
    noise_sigma: float,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> Objects:
    """Measures regions that were chosen to be objects: measure() of C++ with scores. chosen: (H, W)
    integers, the labels of groups_of(); scores: for each region its confidence, 0 to 1, as
    choose_objects() gives them; 0 = no object.
    """

def measure_pair(
    left: ImageLike,
    right: ImageLike,
    *,
    bgr: bool = False,
    exec: Optional[Exec] = None,
) -> PairMeasures:
    """Measures what diagnose() judges: rows, disparities, brightness, exposure and sharpness of a pair.
    left, right: (H, W) or (H, W, 3) uint8 of one size; they need not be rectified.
    """

def measure_synchrony(pairs: PairsLike, *, bgr: bool = False, exec: Optional[Exec] = None) -> Synchrony:
    """Measures whether both cameras of consecutive pairs, (left, right) each and all of one size, took
    their pictures at the same moments. All of them are held at once; of fewer than 8 nothing is
    measured but repeats.
    """

def noise_sigma(
    left: ImageLike,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> float:
    """The standard deviation of the picture's noise, grey levels; stages that weigh edges ask for it."""

def object_errors(
    ours: LabelsLike,
    truth: LabelsLike,
    min_area: int = 200,
    boundary_tolerance: float = 0.75,
) -> ObjectErrors:
    """Compares a map of objects with the truth of the same size: (H, W) integers, 0 = none; truth -1 =
    don't care. min_area: px, smaller true objects are not scored; boundary_tolerance: % of the image's
    diagonal.
    """

def options(preset: str = 'default') -> List[Option]:
    """Every option with its value in a preset, in the order of the stages."""

def preset_names() -> List[str]:
    """The presets by name: 'default', 'paper'."""

def quantised(
    disparity: DisparityLike,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> NDArray[numpy.int16]:
    """Disparities in 1/16 px: (H, W) int16, HOLE_16 in holes."""

def refine_subpixel(
    matches: Matches,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    enabled: bool = ...,
    method: Literal["parabola", "equiangular"] = ...,
) -> NDArray[numpy.float32]:
    """Where the curve through each winner's cost and its neighbours' is lowest: (H, W) float32, px; NaN
    where there is no match.
    """

def reject_ambiguous(
    matches: Matches,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    ratio: float = ...,
) -> NDArray[numpy.uint16]:
    """Pixels with more than one suitable minimum: (H, W) uint16, Reject.not_unique or 0."""

def reject_below_ground(
    disparity: DisparityLike,
    ground: Ground,
    rig: RigLike = None,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    source: Literal["off", "automatic", "points", "pose"] = ...,
    margin: float = ...,
    label_floor: bool = ...,
) -> DisparityMap:
    """Rejects matches under the floor, which are reflections."""

def reject_flat(
    matches: Matches,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    threshold: float = ...,
) -> NDArray[numpy.uint16]:
    """Pixels with a constant correlation function: (H, W) uint16, Reject.flat or 0."""

def reject_inconsistent(
    matches: Matches,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    max_diff: float = ...,
    method: Literal["true", "vote"] = ...,
) -> NDArray[numpy.uint16]:
    """Pixels whose match, followed back from the right picture, does not return to them: (H, W) uint16,
    Reject.left_right or 0.
    """

def reject_speckles(
    disparity: DisparityLike,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    size: int = ...,
    range: float = ...,
) -> DisparityMap:
    """Rejects small islands of disparity."""

def reject_textureless(
    left: ImageLike,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    window_size: int = ...,
    threshold: float = ...,
) -> NDArray[numpy.uint16]:
    """Pixels without enough texture (Moravec operator): (H, W) uint16, Reject.no_texture or 0. left: (H,
    W) or (H, W, 3) uint8.
    """

def save_disparity(path: PathLike, disparity_px: FloatsLike) -> None:
    """Writes a map as .png or .pfm, whole or not at all."""

def save_png(path: PathLike, image: NumbersLike) -> None:
    """Writes (H, W) uint8 or uint16, or (H, W, 3) uint8 RGB, as PNG, whole or not at all."""

def segment(
    left: ImageLike,
    right: Optional[ImageLike] = None,
    rig: RigLike = None,
    *,
    preset: str = 'default',
    config: Union[Config, PathLike, None] = None,
    exec: Optional[Exec] = None,
    bgr: bool = False,
    disparity_map: Optional[DisparityLike] = None,
    epipolar_correction: EpipolarCorrectionOptions = ...,
    match: MatchOptions = ...,
    semi_global: SemiGlobalOptions = ...,
    subpixel: SubpixelOptions = ...,
    left_right: LeftRightOptions = ...,
    uniqueness: UniquenessOptions = ...,
    flatness: FlatnessOptions = ...,
    texture: TextureOptions = ...,
    ground: GroundOptions = ...,
    speckle: SpeckleOptions = ...,
    evidence: EvidenceOptions = ...,
    background: BackgroundOptions = ...,
    intensity: IntensityOptions = ...,
    disparity: DisparityOptions = ...,
    fusion: FusionOptions = ...,
    superpixels: SuperpixelsOptions = ...,
    objects: ObjectsOptions = ...,
    space: SpaceOptions = ...,
) -> Frame:
    """Objects from a stereo pair: the whole method. Returns a Frame.
    left, right: a rectified pair of one size, (H, W) or (H, W, 3) uint8, RGB (bgr=True: OpenCV's
    order): what stands at (x, y) on the left stands at (x - d, y) on the right. Arrays whose rows are
    dense are used where they lie, without a copy, grey ones and RGB; do not write to them meanwhile.
    Matching works on grey, which is computed from colours; bgr=True and other layouts cost a copy. rig:
    a Rig, a Calibration, or None: no metres then. preset, then config (a Config or a file's name), then
    the options; later ones win. Other Python threads run meanwhile. Raises cairn.Error for what cannot
    be used. disparity_map instead of right: a map from elsewhere, (H, W) float32 in px, NaN = hole, or
    a DisparityMap.
    """

def segment_disparity(
    disparity: DisparityLike,
    floor: MaskLike = None,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    smoothing_sigma: float = ...,
    gradient_threshold: float = ...,
    mean_difference_max: float = ...,
    deviation_max: float = ...,
    sigma_min: float = ...,
    min_region_area: float = ...,
) -> Segmentation:
    """Regions of like disparity, nearest first: gradient, watershed, build_graph, grow_near_to_far. floor:
    (H, W) uint8 as label_floor() gives it, one region of its own; or None.
    """

def segment_intensity(
    left: ImageLike,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
    smoothing_sigma: float = ...,
    gradient_threshold: float = ...,
    mean_difference_max: float = ...,
    deviation_max: float = ...,
    sigma_min: float = ...,
    min_region_area: float = ...,
) -> Segmentation:
    """Regions of like intensity: gradient, watershed, build_graph, grow_statistical. left: (H, W) or (H,
    W, 3) uint8.
    """

def segmentation_of(
    superpixels: Superpixels,
    left: ImageLike,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> Segmentation:
    """The superpixels as a Segmentation, with their grey statistics."""

def shift_rows(
    right: ImageLike,
    offset: EpipolarOffset,
    *,
    bgr: bool = False,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> NDArray[numpy.uint8]:
    """The right picture, (H, W) uint8, moved back by `offset`, so that its rows are the left one's."""

def summarise(frames: List[ObjectErrors]) -> ObjectSummary:
    """A summary of many frames' object_errors()."""

def supported_targets() -> List[str]:
    """Those of them that this processor has, slowest first."""

def tunables(patterns: List[str] = ['*']) -> List[str]:
    """The names of the options that tune() can search: those that the patterns ('match.window_size',
    'match.*', '*') name, in the order of options().
    """

def tune(
    frames: FramesLike,
    *,
    options: List[str] = [],
    budget_s: float = 60.0,
    evaluations: int = 0,
    holdout: float = 0.0,
    seed: int = 1,
    progress: Optional[Callable[[Dict[str, Any]], object]] = None,
    preset: str = 'default',
    config: Union[Config, PathLike, None] = None,
    exec: Optional[Exec] = None,
    epipolar_correction: EpipolarCorrectionOptions = ...,
    match: MatchOptions = ...,
    semi_global: SemiGlobalOptions = ...,
    subpixel: SubpixelOptions = ...,
    left_right: LeftRightOptions = ...,
    uniqueness: UniquenessOptions = ...,
    flatness: FlatnessOptions = ...,
    texture: TextureOptions = ...,
    ground: GroundOptions = ...,
    speckle: SpeckleOptions = ...,
    evidence: EvidenceOptions = ...,
    background: BackgroundOptions = ...,
    intensity: IntensityOptions = ...,
    disparity: DisparityOptions = ...,
    fusion: FusionOptions = ...,
    superpixels: SuperpixelsOptions = ...,
    objects: ObjectsOptions = ...,
    space: SpaceOptions = ...,
) -> Tuning:
    """Searches the options that do best on frames of yours, as `cairn tune` does (docs/tune.md). Returns a
    Tuning.
    frames: a TuningFrame or (left, right) each; all are held at once. options: patterns as tunables()
    takes them, none = a sensible choice. budget_s: seconds, more than 0; the start is measured all the
    same. evaluations: end after so many as well, for a result that does not depend on the machine's
    speed; 0 = no limit. holdout: 0 to 0.9, the share of the frames that only judge the result. seed:
    which frames these are, and in which order options are tried. progress: called before each
    evaluation with a dict: goal, evaluations, seconds, share (0 to 1), before and best (mean losses;
    None until the start is measured). Ctrl-C (KeyboardInterrupt) ends the search and keeps the best so
    far. The search starts from preset, config and the options, as in segment(). Other Python threads
    run meanwhile. Raises cairn.Error for what cannot be used.
    """

def watershed(
    gradient: NumbersLike,
    *,
    config: Optional[Config] = None,
    exec: Optional[Exec] = None,
) -> Basins:
    """Watershed by steepest descent, 4-connected, no ridge lines. gradient: (H, W) uint16."""
