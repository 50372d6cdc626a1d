# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""cairn.Rectifier gives the files of `cairn rectify`."""

import subprocess

import numpy as np
import pytest

import cairn

RAW = """%YAML:1.0
---
{size}M1: !!opencv-matrix
   {{ rows: 3, cols: 3, dt: d, data: [ 310., 0., 158., 0., 311., 121., 0., 0., 1. ] }}
D1: !!opencv-matrix
   {{ rows: 1, cols: 5, dt: d, data: [ -0.1, 0.02, 0.001, -0.002, 0. ] }}
M2: !!opencv-matrix
   {{ rows: 3, cols: 3, dt: d, data: [ 308., 0., 161., 0., 309., 118., 0., 0., 1. ] }}
D2: !!opencv-matrix
   {{ rows: 1, cols: 5, dt: d, data: [ -0.08, 0.01, 0., 0.001, 0. ] }}
R: !!opencv-matrix
   {{ rows: 3, cols: 3, dt: d, data: [ 0.9998, 0., 0.02, 0., 1., 0., -0.02, 0., 0.9998 ] }}
T: !!opencv-matrix
   {{ rows: 3, cols: 1, dt: d, data: [ -0.12, 0.001, 0.002 ] }}
"""


@pytest.fixture
def raw(tmp_path):
    file = tmp_path / "raw.yaml"
    file.write_text(RAW.format(size="image_width: 320\nimage_height: 240\n"))
    try:
        cairn.Rectifier(file)
    except cairn.Error as error:
        if "not built in" in str(error):
            pytest.skip("built without OpenCV's calib3d")
        raise
    return file


def pictures():
    random = np.random.default_rng(1)
    return [random.integers(0, 256, (240, 320, 3), dtype=np.uint8) for _ in range(2)]


def test_equals_the_files_of_the_command(command, raw, tmp_path):
    left, right = pictures()
    cairn.save_png(tmp_path / "l.png", left)
    cairn.save_png(tmp_path / "r.png", right)
    subprocess.run([command, "rectify", "--calib", raw, tmp_path / "l.png", tmp_path / "r.png", "--nearest", "0.8", "-o",
                    tmp_path / "pair"], check=True, capture_output=True)
    rectifier = cairn.Rectifier(raw, nearest_m=0.8)
    found = rectifier.rectify(left, right)
    for name, image in zip(("left.png", "right.png"), found):
        np.testing.assert_array_equal(cairn.load_picture(tmp_path / "pair" / name), image)
    written = cairn.load_calibration(tmp_path / "pair" / "calib.txt")
    assert rectifier.calibration.num_disparities == written.num_disparities
    assert rectifier.rig.focal_px == pytest.approx(written.rig.focal_px)
    assert rectifier.rig.baseline_m == pytest.approx(written.rig.baseline_m)
    # What it returns can be segmented.
    assert cairn.segment(*found, rectifier.calibration).rig.focal_px == rectifier.rig.focal_px


def test_grey_and_bgr_come_back_as_they_were_given(raw):
    left, right = pictures()
    rectifier = cairn.Rectifier(str(raw))
    expected = rectifier.rectify(left, right)[0]
    found = rectifier.rectify(left[..., ::-1], right[..., ::-1], bgr=True)[0]
    np.testing.assert_array_equal(found, expected[..., ::-1])
    grey = rectifier.rectify(left[..., 0], right[..., 0])[0]
    np.testing.assert_array_equal(grey, expected[..., 0])


def test_refuses_other_sizes_and_other_files(raw, tmp_path):
    left, right = pictures()
    with pytest.raises(cairn.Error, match="raw.yaml: the calibration is for 320x240, the images are 318x240"):
        cairn.Rectifier(raw).rectify(left[:, 2:], right[:, 2:])
    with pytest.raises(cairn.Error, match="none.yaml"):
        cairn.Rectifier(tmp_path / "none.yaml")
    unsized = tmp_path / "unsized.yaml"
    unsized.write_text(RAW.format(size=""))
    with pytest.raises(cairn.Error, match="unsized.yaml"):
        cairn.Rectifier(unsized)
    assert cairn.Rectifier(unsized, (320, 240)).rig.focal_px == cairn.Rectifier(raw).rig.focal_px
