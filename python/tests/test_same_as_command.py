# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""The module gives the results of the command, and its refusals in the same wording."""

import json
import subprocess

import numpy as np
import pytest

import cairn
from conftest import SAMPLES

PRESETS = ["default", "paper"]


def run(command, *arguments):
    return subprocess.run([command, *map(str, arguments)], capture_output=True, text=True, timeout=120)


def without_timings(text):
    result = json.loads(text)
    assert result.pop("timings_ms", None) or result.pop("timings", None)
    return result


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("folder", SAMPLES, ids=lambda folder: folder.name)
def test_every_sample_gives_the_numbers_of_the_command(command, folder, preset, tmp_path):
    done = run(command, "segment", folder, "--preset", preset, "-o", tmp_path / "command")
    assert done.returncode == 0, done.stderr
    left, right = cairn.load_pair(folder / "left.png", folder / "right.png")
    frame = cairn.segment(left, right, cairn.load_calibration(folder / "calib.txt"), preset=preset)
    frame.save(tmp_path / "python")

    names = {path.name for path in (tmp_path / "command").iterdir()}
    assert names == {path.name for path in (tmp_path / "python").iterdir()}
    assert {"disparity.png", "objects.json", "overlay.png"} <= names
    for name in names - {"objects.json"}:
        assert (tmp_path / "command" / name).read_bytes() == (tmp_path / "python" / name).read_bytes(), name
    said = without_timings((tmp_path / "command" / "objects.json").read_text())
    assert without_timings(frame.to_json()) == said
    assert len(frame.objects) == len(said["objects"]) > 0


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("folder", SAMPLES, ids=lambda folder: folder.name)
def test_disparities_equal_the_commands_bit_for_bit(command, folder, preset, tmp_path):
    file = tmp_path / "disparity.pfm"
    done = run(command, "disparity", folder / "left.png", folder / "right.png", "--preset", preset, "-o", file)
    assert done.returncode == 0, done.stderr
    left, right = cairn.load_pair(folder / "left.png", folder / "right.png")
    scene = cairn.estimate_disparity(left, right, cairn.load_calibration(folder / "calib.txt"), preset=preset)
    np.testing.assert_array_equal(scene.disparity, cairn.load_disparity(file))


def test_an_external_disparity_map_gives_the_result_of_the_command(command, sample, tmp_path):
    truth = sample.folder / "disp_left.png"
    done = run(command, "segment", sample.folder, "--disparity", truth, "--json")
    assert done.returncode == 0, done.stderr
    frame = cairn.segment(sample.left, rig=sample.calibration, disparity_map=cairn.load_disparity(truth))
    assert without_timings(frame.to_json()) == without_timings(done.stdout)
    assert frame.confidence is None


@pytest.mark.parametrize("folder", SAMPLES, ids=lambda folder: folder.name)
def test_scores_equal_those_of_the_command(command, folder, tmp_path):
    left, right = cairn.load_pair(folder / "left.png", folder / "right.png")
    frame = cairn.segment(left, right, cairn.load_calibration(folder / "calib.txt"))
    frame.save(tmp_path / "result")
    done = run(command, "evaluate", tmp_path / "result", folder, "--json", tmp_path / "scores.json")
    assert done.returncode == 0, done.stderr
    said = json.loads((tmp_path / "scores.json").read_text())["summary"]

    scores = cairn.object_errors(frame.objects_map, cairn.load_labels(folder / "objects.png"))
    summary = cairn.summarise([scores])
    assert summary.true_objects == said["objects"]["scored"] == len(scores.truth) > 0
    for name in ("recall_50", "precision_50", "mean_error", "median_error", "mean_iou", "mean_boundary_f"):
        assert getattr(summary, name) == said["objects"][name]
    assert [s.id for s in scores.ours] == [o.id for o in frame.objects]
    partial = cairn.summarise([scores], partial=True)
    assert (partial.phantoms, partial.our_objects) == (0, 0) and partial.recall_50 == summary.recall_50

    occluded = cairn.load_labels(folder / "occlusion.png").astype(np.uint8)
    stored, truth = (cairn.load_disparity(file) for file in (tmp_path / "result/disparity.png", folder / "disp_left.png"))
    errors = cairn.disparity_errors(stored, truth, occluded)
    said = said["disparity"]["both_cameras"]
    assert (errors.known, errors.matched) == (said["known_px"], said["matched_px"])
    assert errors.mean_absolute_px == said["mean_absolute_px"]
    assert list(errors.bad_of_matched.values()) == list(said["bad_of_matched"].values())
    with pytest.raises(cairn.Error, match="truth_px: is 320x240, expected 319x240 as ours_px is"):
        cairn.disparity_errors(frame.disparity[:, 1:], frame.disparity)


REFUSED = [
    ("match.windwo_size=9", {"match": {"windwo_size": 9}}),
    ("macth.window_size=9", {"macth": {"window_size": 9}}),
    ("match.window_size=4", {"match": {"window_size": 4}}),
    ("match.window_size=nine", {"match": {"window_size": "nine"}}),
    ("match.num_disparities=2.5", {"match": {"num_disparities": 2.5}}),
    ("match.num_disparities=1024", {"match": {"num_disparities": 1024}}),
    ("match.cost=sda", {"match": {"cost": "sda"}}),
    ("ground.margin=nan", {"ground": {"margin": float("nan")}}),
    ("ground.label_floor=maybe", {"ground": {"label_floor": "maybe"}}),
    ("match.cost=sad", {"match": {"cost": "sad"}}),
]


@pytest.mark.parametrize("assignment, options", REFUSED, ids=lambda value: value if isinstance(value, str) else "")
def test_a_bad_option_is_refused_with_the_wording_of_the_command(command, sample, assignment, options):
    done = run(command, "segment", sample.folder, "--set", assignment)
    assert done.returncode == 2
    with pytest.raises(cairn.Error) as refusal:
        cairn.segment(sample.left, sample.right, sample.calibration, **options)
    assert done.stderr.strip().endswith(str(refusal.value))
    assert isinstance(refusal.value, ValueError)


def test_a_bad_file_is_refused_with_the_wording_of_the_command(command, sample, tmp_path):
    missing = tmp_path / "none.png"
    done = run(command, "segment", missing, sample.folder / "right.png")
    with pytest.raises(cairn.Error) as refusal:
        cairn.load_pair(missing, sample.folder / "right.png")
    assert done.returncode == 2 and done.stderr.strip().endswith(str(refusal.value))

    config = tmp_path / "config.yaml"
    config.write_text("match:\n  window_size: 8\n")
    done = run(command, "segment", sample.folder, "--config", config)
    with pytest.raises(cairn.Error) as refusal:
        cairn.segment(sample.left, sample.right, config=config)
    assert done.returncode == 2 and done.stderr.strip().endswith(str(refusal.value))

    calibration = tmp_path / "calib.txt"
    calibration.write_text((sample.folder / "calib.txt").read_text().replace("width=320", "width=640"))
    done = run(command, "segment", sample.folder, "--calib", calibration)
    with pytest.raises(cairn.Error) as refusal:
        cairn.segment(sample.left, sample.right, cairn.load_calibration(calibration))
    assert done.returncode == 2 and done.stderr.strip().endswith(str(refusal.value))
