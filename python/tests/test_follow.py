# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Sequences: the module gives the results and refusals of the command."""

import json
import pickle
import subprocess

import numpy as np
import pytest

import cairn
from conftest import SOURCE

SEQUENCE = SOURCE / "data" / "sequences" / "rolling_ball"
if not isinstance(cairn.Follower, type):
    pytest.skip("this cairn was built without sequences", allow_module_level=True)


@pytest.fixture(scope="module")
def steps():
    return list(cairn.follow(SEQUENCE))


@pytest.fixture(scope="module")
def pairs():
    return [cairn.load_pair(f / "left.png", f / "right.png") for f in sorted(SEQUENCE.iterdir()) if f.is_dir()]


@pytest.fixture(scope="module")
def rig():
    return cairn.load_calibration(SEQUENCE / "000" / "calib.txt")


def plain(value):
    return [json.loads(line) for line in value.splitlines()]


def test_a_sequence_gives_the_output_of_the_command(command, steps):
    done = subprocess.run([command, "follow", SEQUENCE, "--json-lines"], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert plain("".join(step.to_json() for step in steps)) == plain(done.stdout)
    assert len(steps) == 6


def test_the_scores_of_a_sequence_equal_those_of_the_command(command, steps, tmp_path):
    (tmp_path / "tracks.jsonl").write_text("".join(step.to_json() for step in steps))
    scores = tmp_path / "scores.json"
    subprocess.run([command, "evaluate", tmp_path, SEQUENCE, "--sequence", "--json", scores], check=True, capture_output=True)
    assert cairn.score_sequence(tmp_path, SEQUENCE) == json.loads(scores.read_text())["summary"]
    with pytest.raises(cairn.Error, match="no such file or folder"):
        cairn.score_sequence(tmp_path / "none", SEQUENCE)


def test_findings_about_the_rig_are_those_of_the_command(tmp_path):
    following = cairn.follow(SEQUENCE)
    next(following)
    assert not [finding for finding in following.findings if finding.severity != "note"]
    for name in ("000", "001"):
        (tmp_path / name).mkdir()
        for side, other in (("left", "right"), ("right", "left")):
            (tmp_path / name / f"{side}.png").write_bytes((SEQUENCE / name / f"{other}.png").read_bytes())
        (tmp_path / name / "calib.txt").write_bytes((SEQUENCE / name / "calib.txt").read_bytes())
    swapped = cairn.follow(tmp_path)
    assert swapped.findings == []
    list(swapped)
    assert ("cameras swapped", "broken") in [(finding.kind, finding.severity) for finding in swapped.findings]


def test_options_files_and_frames_equal_those_of_the_command(command, tmp_path):
    config = tmp_path / "config.yaml"
    config.write_text("tracking:\n  min_hits: 2\nodometry:\n  max_features: 150\n")
    done = subprocess.run(
        [command, "follow", SEQUENCE, "--json-lines", "--frames", "0:4", "--binning", "2", "--config", config,
         "--set", "repair.method=off"],
        capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    mine = cairn.follow(SEQUENCE, frames="0:4", binning=2, config=config, repair={"method": "off"})
    assert plain("".join(step.to_json() for step in mine)) == plain(done.stdout)


def test_pair_by_pair_equals_the_whole_sequence(steps, pairs, rig):
    follower = cairn.Follower(rig)
    for i, (left, right) in enumerate(pairs):
        step = follower.next(left, right, seconds=0.3 * i)
        np.testing.assert_array_equal(step.ids, steps[i].ids)
        np.testing.assert_array_equal(step.map_from_camera, steps[i].map_from_camera)
        assert step.frame.to_json().split('"objects"')[1] == steps[i].frame.to_json().split('"objects"')[1]
        assert (step.stamp_ns, step.index) == (steps[i].stamp_ns, i)
        assert json.loads(step.frame.to_json())["stamp_ns"] == step.stamp_ns


def test_a_step_contains_the_camera_and_its_objects(steps):
    last = steps[-1]
    assert last.ids.dtype == np.int64 and last.ids.shape == last.frame.shape and not last.ids.flags.writeable
    assert last.map_from_camera.shape == (4, 4) and last.map_from_camera.dtype == np.float64
    assert last.pose_covariance.shape == (6, 6) and (np.linalg.eigvalsh(last.pose_covariance) >= -1e-12).all()
    assert last.motion.refusal == "none" and not last.is_lost and last.motion.inliers > 15
    moved = last.map_from_camera[:3, 3] - steps[0].map_from_camera[:3, 3]
    assert 0.1 < np.linalg.norm(moved) < 0.15  # 0.12 m by its truth
    (ball,) = [track for track in last.tracks if track.is_moving]
    assert 0.2 < np.linalg.norm(ball.velocity_m_s) < 0.5  # 0.33 m/s by its truth
    assert ball.state == "confirmed" and ball.covariance_m2.shape == (3, 3) and len(ball.extent_m) == 3
    assert {track.id for track in last.tracks if track.object} == set(np.unique(last.ids)) - {0}
    mask = last.ids == ball.id
    assert set(np.unique(last.frame.objects_map[mask])) == {ball.object, *ball.parts}
    assert last.overlay().shape[2] == 3


def test_steps_can_be_pickled(steps):
    back = pickle.loads(pickle.dumps(steps[-1]))
    assert repr(back) == repr(steps[-1]) and back.to_json() == steps[-1].to_json()
    np.testing.assert_array_equal(back.ids, steps[-1].ids)
    np.testing.assert_array_equal(back.overlay(), steps[-1].overlay())
    assert [repr(track) for track in back.tracks] == [repr(track) for track in steps[-1].tracks]


def test_without_a_rig_there_are_only_ids(pairs):
    follower = cairn.Follower(match={"num_disparities": 32})
    for i, (left, right) in enumerate(pairs[:3]):
        step = follower.next(left, right, i)
    assert step.ids.any() and step.motion.refusal == "no_rig"
    assert all(track.position_m is None and track.covariance_m2 is None for track in step.tracks)


def test_a_known_pose_is_used_unchanged(pairs, rig):
    follower = cairn.Follower(rig)
    pose = np.array([[0, 0, 1, 5], [-1, 0, 0, 0], [0, -1, 0, 1], [0, 0, 0, 1]], dtype=float)
    step = follower.next(*pairs[0], 0, pose=pose)
    np.testing.assert_allclose(step.map_from_camera, pose)
    for wrong, words in [(np.eye(3), "shape \\(3, 3\\), expected 4 x 4"), (2 * np.eye(4), "no rigid motion"),
                         (np.full((4, 4), np.nan), "not finite"), ("here", "found 'here'")]:
        with pytest.raises(cairn.Error, match=words):
            follower.next(*pairs[1], 1, pose=wrong)


def test_a_prior_replaces_odometry_on_blank_images(pairs, rig):
    follower = cairn.Follower(rig)
    follower.next(*pairs[0], 0)
    ahead = np.eye(4)
    ahead[2, 3] = -0.05  # a point 1 m ahead is 0.95 m ahead now
    prior = cairn.MotionPrior(ahead, 1e-4 * np.eye(6))
    assert prior.kind == "wheels" and pickle.loads(pickle.dumps(prior)).now_from_before[2, 3] == -0.05
    black = np.zeros_like(pairs[0][0])
    step = follower.next(black, black, 300_000_000, prior=prior)
    assert step.motion.refusal != "none"
    np.testing.assert_allclose(step.motion.now_from_before, ahead)
    with pytest.raises(cairn.Error, match="kind: found 'sonar', expected 'wheels' or 'gyroscope'"):
        cairn.MotionPrior(ahead, np.eye(6), "sonar")


def test_stamps_must_increase_and_sizes_stay_the_same(pairs, rig):
    follower = cairn.Follower(rig)
    left, right = pairs[0]
    follower.next(left, right, stamp_ns=10)
    with pytest.raises(cairn.Error, match="its stamp 10 ns is not later than the one before, 10 ns"):
        follower.next(left, right, stamp_ns=10)
    unsized = cairn.Follower(match={"num_disparities": 32})
    unsized.next(left, right, 0)
    with pytest.raises(cairn.Error, match="frame 1: is 319x240, the first one is 320x240"):
        unsized.next(left[:, 1:], right[:, 1:], 1)
    with pytest.raises(cairn.Error, match="stamp_ns: found neither it nor seconds"):
        follower.next(left, right)
    with pytest.raises(cairn.Error, match="stamp_ns: found seconds as well"):
        follower.next(left, right, 20, seconds=1)
    ids = {track.id for track in follower.next(left, right, np.int64(1_700_000_000_000_000_000)).tracks}
    with pytest.raises(cairn.Error, match="is not later than the one before"):
        follower.next(left, right, 1_699_999_999_500_000_000)
    again = follower.next(left, right, 1_600_000_000_000_000_000)  # set back: a new run
    assert again.index == 2 and ids.isdisjoint(track.id for track in again.tracks)


def test_refusals_have_the_wording_of_the_command(command, tmp_path):
    for assignment, options in [("tracking.min_hist=2", {"tracking": {"min_hist": 2}}),
                                ("tracking.min_hits=0", {"tracking": {"min_hits": 0}}),
                                ("match.window_size=4", {"match": {"window_size": 4}})]:
        done = subprocess.run([command, "follow", SEQUENCE, "--set", assignment], capture_output=True, text=True)
        with pytest.raises(cairn.Error) as refusal:
            cairn.follow(SEQUENCE, **options)
        assert done.returncode == 2 and done.stderr.strip().endswith(str(refusal.value))
    with pytest.raises(cairn.Error, match="nowhere"):
        cairn.follow(tmp_path / "nowhere")
    with pytest.raises(cairn.Error, match="found 3, expected a dict"):
        cairn.follow(SEQUENCE, tracking=3)


def test_a_map_keeps_landmarks_from_run_to_run(tmp_path):
    map_file = tmp_path / "room.db"
    options = {"map_file": map_file, "landmarks": {"min_frames": 4}}
    with cairn.follow(SEQUENCE, **options) as following:
        found = {landmark for step in following for landmark in step.landmarks.values()}
    assert following.size == 6 and found and map_file.exists()
    before = map_file.read_bytes()
    assert len(list(cairn.follow(SEQUENCE, read_only=True, **options))) == 6
    assert map_file.read_bytes() == before


def test_a_better_option_is_reported_or_set(pairs, rig):
    left, right = pairs[0]
    control = {"budget": 1}
    for method in ("watch", "tune"):
        follower = cairn.Follower(rig, objects={"min_area": 60}, control={"method": method, **control})
        steps = [follower.next(left, right, seconds=0.1 * i) for i in range(40)]
        step = next(step for step in steps if step.control)
        found = step.control
        assert (found["option"], found["before"], found["value"]) == ("objects.min_area", "60", "0.1")
        assert found["lead"] > 1 and found["is_set"] == (method == "tune")
        assert follower["objects.min_area"] == ("0.1" if method == "tune" else "60")
        assert pickle.loads(pickle.dumps(step)).control == found
    assert steps[0].control is None


def test_the_options_of_sequences_are_listed():
    names = {option.name for option in cairn.follow_options()}
    assert {"odometry.max_features", "tracking.min_hits", "repair.method", "landmarks.min_frames"} <= names
    assert not names & {option.name for option in cairn.options()}
    assert cairn.Follower(tracking={"min_hits": 2})["tracking.min_hits"] == "2"


def test_given_disparities_are_followed_as_from_a_folder_of_maps(pairs, rig, tmp_path):
    maps = tmp_path / "maps"
    maps.mkdir()
    folders = [f for f in sorted(SEQUENCE.iterdir()) if f.is_dir()]
    for folder, (left, right) in zip(folders, pairs):
        np.save(maps / f"{folder.name}.npy", cairn.segment(left, right, rig).disparity)
    whole = list(cairn.follow(SEQUENCE, disparity=maps))
    follower = cairn.Follower(rig)
    for step, folder, (left, _) in zip(whole, folders, pairs):
        given = follower.next(left, disparity_map=np.load(maps / f"{folder.name}.npy"), stamp_ns=step.stamp_ns)
        assert np.array_equal(given.ids, step.ids)
        assert np.array_equal(given.map_from_camera, step.map_from_camera)
        assert given.reliability["stereo"] is None
        assert given.frame.confidence is None
    assert any(step.tracks for step in whole)
    blind = follower.next(pairs[0][0], disparity_map=np.full(given.ids.shape, np.nan, np.float32), seconds=50.0)
    assert not blind.frame.objects
    with pytest.raises(cairn.Error, match="found disparity 5000.000000 px at x 0, y 0"):
        follower.next(pairs[0][0], disparity_map=np.full(given.ids.shape, 5000, np.float32), seconds=60.0)
    with pytest.raises(cairn.Error, match="right, disparity_map: found both or neither"):
        follower.next(pairs[0][0], seconds=100.0)
    with pytest.raises(cairn.Error, match="disparity_map: is 4x4, expected 320x240"):
        follower.next(pairs[0][0], disparity_map=np.ones((4, 4), np.float32), seconds=100.0)
    with pytest.raises(cairn.Error, match="--depth-image: found --disparity as well"):
        cairn.follow(SEQUENCE, disparity=maps, depth_image=maps)
