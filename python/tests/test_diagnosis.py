# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Diagnosis of a rig, as by `cairn doctor`."""

import json
import subprocess

import numpy as np
import pytest

import cairn


@pytest.fixture(scope="module")
def measures(sample):
    return cairn.measure_pair(sample.left, sample.right)


def sequence(frames, late=0):
    """Noise that drifts irregularly; the right camera is `late` frames late."""
    texture = np.random.default_rng(1).integers(0, 256, (48, 160), np.uint8)
    shifts = np.cumsum(np.random.default_rng(2).integers(0, 4, frames + 4)) + 4
    lefts = [np.ascontiguousarray(texture[:, s % 60 : s % 60 + 96]) for s in shifts]
    rights = [np.ascontiguousarray(texture[:, s % 60 + 3 : s % 60 + 99]) for s in shifts]
    return [(lefts[i + 2], rights[i + 2 - late]) for i in range(frames)]


def test_a_good_pair_has_no_findings(sample, measures):
    assert cairn.diagnose(measures, sample.calibration) == []
    assert measures.size == (320, 240) and measures.found_points > 24 and measures["agreeing_percent"] > 40
    assert abs(measures.offset_rows) < 0.5 and sum(measures.rows_histogram) == measures.found_points
    disparities = measures.disparities_px
    assert disparities.dtype == np.float32 and (np.diff(disparities) >= 0).all()
    assert measures.disparity_px(0) == disparities[0] and measures.disparity_px(1) == disparities[-1]
    assert 0.8 < measures.gain < 1.2 and measures.left_contrast > 40 and 1 <= measures.right_edge_px < 4.5
    assert "offset_rows=" in repr(measures) and not measures.identical
    with pytest.raises(AttributeError, match="PairMeasures has no 'offset_row'"):
        measures.offset_row


def test_measures_equal_those_of_the_command(sample, measures, command, tmp_path):
    report = tmp_path / "report.json"
    subprocess.run([command, "doctor", sample.folder, "--json", report], capture_output=True)
    assert measures.as_dict() == json.loads(report.read_text())["pairs"][0]["measured"]


def test_swapped_cameras_are_reported(sample):
    (found,) = cairn.diagnose(cairn.measure_pair(sample.right, sample.left), sample.calibration)
    assert (found.kind, found.severity, found.unit) == ("cameras swapped", "broken", "%")
    assert found.value > 60 and "negative disparity" in found.says and "Exchange" in found.remedy
    assert found.says in repr(found) and found.number == "points with a negative disparity"


def test_findings_equal_those_of_the_command(sample, command, tmp_path):
    cairn.save_png(tmp_path / "left.png", sample.right)
    cairn.save_png(tmp_path / "right.png", sample.left)
    report = tmp_path / "report.json"
    subprocess.run([command, "doctor", tmp_path / "left.png", tmp_path / "right.png", "--json", report], capture_output=True)
    told = json.loads(report.read_text())["findings"]
    found = cairn.diagnose(cairn.measure_pair(sample.right, sample.left))
    assert len(found) == len(told) > 0
    assert [{**f.as_dict(), "pairs": t["pairs"]} for f, t in zip(found, told)] == told


def test_the_range_defaults_to_that_of_the_calibration(sample, measures):
    def kinds(*arguments, **keywords):
        return [f.kind for f in cairn.diagnose(measures, *arguments, **keywords)]

    assert kinds(sample.calibration, num_disparities=2) == ["disparity range too small"]
    assert kinds(sample.calibration, config=cairn.Config(match={"num_disparities": 2})) == ["disparity range too small"]
    assert kinds(sample.calibration, config=cairn.Config("paper", match={"window_size": 7})) == []
    assert kinds(num_disparities=320) == ["disparity range too large"]


def test_limits_can_be_set(sample, measures):
    strict = cairn.diagnose(measures, sample.calibration, limits={"warn_edge": np.float32(1), "least_points": 9})
    assert [f.kind for f in strict] == ["blurred"] and strict[0].severity == "warning"
    assert "warn_rows = 0.75 rows (0 … 100): " in cairn.diagnose.__doc__


def test_synchronous_cameras_have_no_findings():
    together = cairn.measure_synchrony(sequence(14))
    assert together.frames == 14 and together.lag == 0 and cairn.diagnose(together) is None
    assert len(together.motion) == len(together.agreement) == 5  # for lags from -2 to 2
    assert together.tells and together.change is None
    assert cairn.diagnose(cairn.measure_synchrony([])) is None


def test_a_camera_that_becomes_late_is_reported():
    together, late = sequence(34), sequence(34, 1)
    measured = cairn.measure_synchrony(together[:17] + late[17:])
    frame = measured.change["from"]
    assert abs(frame - 17) <= 1 and (measured.change["before"], measured.change["after"]) == (0, 1)
    assert f"from frame {frame} on" in cairn.diagnose(measured).says


def test_a_static_sequence_has_no_findings():
    measured = cairn.measure_synchrony(sequence(1) * 9)
    assert not measured.tells and cairn.diagnose(measured).severity == "note"


def test_identical_images_are_reported(sample):
    measured = cairn.measure_pair(sample.left, sample.left)
    assert measured.identical and [f.kind for f in cairn.diagnose(measured)] == ["identical images"]
    assert cairn.measure_pair(sample.left[:20, :20], sample.left[:20, :20]).gain is None  # not measured


@pytest.mark.parametrize("late", [-1, 2])
def test_a_late_camera_is_reported(late):
    measured = cairn.measure_synchrony(iter(sequence(16, late)), exec=cairn.Exec(2))
    found = cairn.diagnose(measured)
    assert measured.lag == late == found.value and found.kind == "not synchronised" and found.severity == "broken"
    assert f"lag={late}" in repr(measured)


def test_repeated_images_are_counted():
    pairs = sequence(5)
    pairs[3] = (pairs[3][0], pairs[2][1])
    moving = cairn.measure_synchrony(pairs)
    assert moving.left_repeats == 0 and moving.right_repeats >= 1 and cairn.diagnose(moving).severity == "warning"


def test_the_smallest_images_are_measured():
    dot = np.zeros((1, 1), np.uint8)
    measured = cairn.measure_pair(dot, dot)
    assert np.isnan(measured.disparity_px(0.5)) and len(measured.disparities_px) == 0 and "size=(1, 1)" in repr(measured)
    assert cairn.diagnose(measured)[0].kind == "too little texture"


def test_invalid_input_is_refused_by_name(sample, measures):
    left, right = sample.gray()
    half = left[:, :160]
    calls = {
        "stereo pair: left image is 320x240, right image is 160x240": lambda: cairn.measure_pair(left, half),
        "right: found": lambda: cairn.measure_pair(left, right.astype(float)),
        "left of pair 1: is 160x240, expected 320x240 as left of pair 0 is": lambda: cairn.measure_synchrony([(left, right), (half, half)]),
        "right of pair 0: is 160x240": lambda: cairn.measure_synchrony([(left, half)]),
        "right of pair 0: found": lambda: cairn.measure_synchrony([(left, None)]),
        r"pairs: found a value of type tuple as number 1, expected \(left, right\)": lambda: cairn.measure_synchrony([(left, right), (left,)]),
        "pairs: found 3, expected a sequence of": lambda: cairn.measure_synchrony(3),
        "exec: found 2, expected a cairn.Exec": lambda: cairn.measure_pair(left, right, exec=2),
        "rig: found 'calib.txt', expected": lambda: cairn.diagnose(measures, "calib.txt"),
        "config: found 3, expected a cairn.Config": lambda: cairn.diagnose(measures, config=3),
        "unknown option 'match.num_disparitys'": lambda: cairn.diagnose(measures, num_disparitys=3),
        "share: found 1.5, expected 0 … 1": lambda: measures.disparity_px(1.5),
        "limits: there is no 'warn_row', did you mean 'warn_rows'": lambda: cairn.diagnose(measures, limits={"warn_row": 1}),
        "limits: warn_rows: found -1, expected a number, 0 … 100": lambda: cairn.diagnose(measures, limits={"warn_rows": -1}),
        "limits: warn_rows: found 'x', expected a number": lambda: cairn.diagnose(measures, limits={"warn_rows": "x"}),
        "limits: least_points: found 8.5, expected a whole number, 8 … 500": lambda: cairn.diagnose(measures, limits={"least_points": 8.5}),
        "the calibration is for 320x240": lambda: cairn.diagnose(cairn.measure_pair(half, half), sample.calibration),
    }
    for words, call in calls.items():
        with pytest.raises(cairn.Error, match=words):
            call()
            pytest.fail(f"not refused: {words}")
    with pytest.raises(TypeError):
        cairn.diagnose([measures])
