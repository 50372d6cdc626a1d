# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""pickle and copy.deepcopy of the module's values."""

import concurrent.futures
import copy
import multiprocessing
import pickle

import numpy as np
import pytest

import cairn
from conftest import same, same_frame

WAYS = [copy.deepcopy, *(lambda v, p=p: pickle.loads(pickle.dumps(v, p)) for p in range(2, pickle.HIGHEST_PROTOCOL + 1))]


def shown_by(value):
    return [name for name, member in vars(type(value)).items() if isinstance(member, property)]


def parts(value):
    """All attributes of a value, arrays as bytes, recursively down to plain numbers."""
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    if isinstance(value, dict):
        return {key: parts(entry) for key, entry in value.items()}
    if type(value).__module__ == "cairn" and not isinstance(value, cairn.Reject):
        entries = list(value) if hasattr(type(value), "__iter__") else []
        return type(value), repr(value), {name: parts(getattr(value, name)) for name in shown_by(value)}, parts(entries)
    if isinstance(value, (list, tuple)):
        return [parts(entry) for entry in value]
    return repr(value)


@pytest.mark.parametrize("way", WAYS)
def test_a_frame_survives_pickling_with_all_its_parts(sample, way):
    back = way(sample.frame)
    assert same_frame(back, sample.frame)
    assert parts(back) == parts(sample.frame)
    assert same(back.overlay(), sample.frame.overlay()) and back.to_json() == sample.frame.to_json()
    assert back.config == sample.frame.config and back.rig == sample.frame.rig
    assert not np.shares_memory(back.disparity, sample.frame.disparity)
    assert not back.disparity.flags.writeable


def test_objects_survive_pickling_without_their_frame(sample):
    objects = pickle.loads(pickle.dumps(sample.frame.objects))
    assert parts(objects) == parts(sample.frame.objects) and same(objects.labels, sample.frame.objects_map)
    nearest = pickle.loads(pickle.dumps(sample.frame.objects[0]))
    assert parts(nearest) == parts(sample.frame.objects[0]) and nearest.position_in_camera_m is not None


def test_a_frame_without_colour_rig_and_matching_survives_pickling(sample):
    gray, truth = sample.gray()[0], cairn.load_disparity(sample.folder / "disp_left.png")
    frame = cairn.segment(gray, disparity_map=truth, preset="paper")
    assert frame.confidence is None and frame.rig is None and frame.objects[0].position_in_camera_m is None
    back = copy.deepcopy(frame)
    assert parts(back) == parts(frame) and same(back.overlay(), frame.overlay()) and back.to_json() == frame.to_json()
    swapped = cairn.segment(sample.left[:, :, ::-1], disparity_map=truth, bgr=True)
    assert same(copy.deepcopy(swapped).overlay(), swapped.overlay())


FLOOR = [(10, 200, 4, 200), (300, 210, 293, 210), (20, 230, 12, 230), (280, 190, 275, 190)]


def one_of_each(sample, kerb):
    left, right = sample.left, sample.right
    # The next values keep state from frame to frame; their results can be pickled.
    step = cairn.Follower(sample.calibration).next(left, right, 0) if isinstance(cairn.Follower, type) else None
    matches = cairn.match(left, right, num_disparities=32)
    superpixels = cairn.cut_superpixels(left, sample.frame.disparity_map, 1, count=20)
    walls = cairn.fit_background(sample.frame.disparity, sample.frame.ground)
    cues = (left, sample.frame.disparity_map, sample.frame.disparity, sample.frame.ground, walls)
    tree = cairn.grow_merge_tree(superpixels, *cues, noise_sigma=1)
    paper = cairn.segment(left, right, sample.calibration, preset="paper")
    basins = cairn.watershed(cairn.gradient(left))
    errors = cairn.object_errors(sample.frame.objects_map, cairn.load_labels(sample.folder / "objects.png"))
    measures = cairn.measure_pair(right, left)
    return [
        matches,
        cairn.correct_epipolar(left, np.roll(right, 2, axis=0), max_rows=4),
        cairn.estimate_disparity(left, right, sample.calibration),
        sample.frame.disparity_map,
        sample.frame.ground,
        walls,
        basins,
        cairn.build_graph(basins.labels, sample.gray()[0]),
        superpixels,
        tree,
        cairn.choose_objects(tree),
        paper,
        paper.fusion,
        sample.frame.groups,
        sample.frame.groups.regions[0],
        sample.frame.epipolar,
        cairn.disparity_errors(sample.frame.disparity, sample.frame.disparity),
        errors,
        errors.truth[0],
        errors.ours[0],
        cairn.summarise([errors]),
        measures,
        cairn.diagnose(measures)[0],
        cairn.measure_synchrony([(left, right)] * 8),
        sample.calibration,
        sample.calibration.rig,
        cairn.Config("paper", match={"window_size": 11}, ground={"source": "points"}),
        cairn.Calibration(sample.calibration.rig, ground_points=FLOOR, camera_height_m=0.5, camera_pitch_deg=10),
        cairn.options()[0],
        sample.frame.floor_frame,
        sample.frame.scan(),
        sample.frame.grid(),
        kerb.ground_steps()[0],
        sample.frame.left_out[0],
        sample.frame.refined,
        sample.frame.objects[0].box_on_floor,
        cairn.Exec(2, "scalar"),
        cairn.Segmenter(sample.calibration, preset="paper"),
        cairn.Reject.flat | cairn.Reject.border,
        cairn.TuningFrame(left, right, sample.calibration, truth_px=sample.frame.disparity, name="four"),
        cairn.tune([(left, right)], evaluations=1, match={"num_disparities": 32}),
        *([step, *step.tracks, step.motion, cairn.MotionPrior(np.eye(4), np.eye(6))] if step else []),
    ]


def test_every_class_can_be_pickled(sample, kerb):
    values = one_of_each(sample, kerb)
    for value in values:
        back = pickle.loads(pickle.dumps(value))
        if not isinstance(value, (cairn.Exec, cairn.Segmenter)):  # whose buffers cannot be pickled
            assert parts(back) == parts(value), type(value)
        assert repr(back) == repr(value)
    reached = {type(value) for value in values} | {cairn.Frame, cairn.Object, cairn.Objects, cairn.GroundPlane}
    reached |= {type(getattr(value, name)) for value in values for name in shown_by(value)}
    public = {getattr(cairn, name) for name in cairn.__all__ if isinstance(getattr(cairn, name), type)}
    # What is made from a file or goes on from frame to frame.
    others = {cairn.Follower, getattr(cairn, "Following", None), cairn.Rectifier}
    assert {c for c in public if not issubclass(c, Exception)} - others <= reached


def test_stages_and_segmenters_accept_unpickled_values(sample):
    matches = pickle.loads(pickle.dumps(cairn.match(sample.left, sample.right, num_disparities=32)))
    direct = cairn.match(sample.left, sample.right, num_disparities=32)
    assert same(cairn.refine_subpixel(matches), cairn.refine_subpixel(direct))
    assert same(cairn.reject_inconsistent(matches), cairn.reject_inconsistent(direct))
    basins = cairn.watershed(cairn.gradient(sample.left))
    graph = cairn.build_graph(basins.labels, sample.gray()[0])
    criteria = {"mean_difference_max": 10, "deviation_max": 3, "sigma_min": 1}
    assert same(cairn.grow_statistical(copy.deepcopy(graph), **criteria), cairn.grow_statistical(graph, **criteria))
    superpixels = cairn.cut_superpixels(sample.left, sample.frame.disparity_map, 1, count=20)
    walls = cairn.fit_background(sample.frame.disparity, sample.frame.ground)
    cues = (sample.left, sample.frame.disparity_map, sample.frame.disparity, sample.frame.ground, walls, 1)
    tree = cairn.grow_merge_tree(superpixels, *cues)
    assert parts(cairn.grow_merge_tree(copy.deepcopy(superpixels), *cues)) == parts(tree)
    assert parts(cairn.choose_objects(copy.deepcopy(tree))) == parts(cairn.choose_objects(tree))
    segmenter = pickle.loads(pickle.dumps(cairn.Segmenter(sample.calibration)))
    assert same_frame(segmenter.segment(sample.left, sample.right), sample.frame)


def frame_of(folder):
    left, right = cairn.load_pair(folder / "left.png", folder / "right.png")
    return cairn.segment(left, right, cairn.load_calibration(folder / "calib.txt"))


def test_another_process_returns_its_frames(sample):
    with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as workers:
        assert same_frame(workers.submit(frame_of, sample.folder).result(), sample.frame)


def test_pickles_of_another_version_are_refused(sample):
    version, state = sample.frame.objects.__getstate__()
    assert version == cairn.__version__
    objects = cairn.Objects.__new__(cairn.Objects)
    with pytest.raises(cairn.Error, match="found a value of version 0.0.1, expected what this version"):
        objects.__setstate__(("0.0.1", state))
