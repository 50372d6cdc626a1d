# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
import os
import pathlib

import numpy as np
import pytest

import cairn

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SAMPLES = sorted(folder for folder in (SOURCE / "data" / "samples").iterdir() if (folder / "left.png").exists())


@pytest.fixture(scope="session")
def source():
    return SOURCE


@pytest.fixture(scope="session")
def command():
    """The command from the same build."""
    path = os.environ.get("CAIRN_COMMAND")
    if not path:
        pytest.skip("CAIRN_COMMAND does not say where the command is")
    return path


class Sample:
    """A pair with its calibration; the frame is computed once."""

    def __init__(self, folder):
        self.folder = folder
        self.left, self.right = cairn.load_pair(folder / "left.png", folder / "right.png")
        self.calibration = cairn.load_calibration(folder / "calib.txt")
        self.frame = cairn.segment(self.left, self.right, self.calibration)

    def gray(self):
        """Both images in grey."""
        return tuple(gray_of(image) for image in (self.left, self.right))


def gray_of(rgb):
    r, g, b = (rgb[..., channel].astype(int) for channel in range(3))
    return ((77 * r + 150 * g + 29 * b + 128) >> 8).astype(np.uint8)


@pytest.fixture(scope="session")
def sample():
    return Sample(SOURCE / "data" / "samples" / "four_in_a_row")


@pytest.fixture(scope="session")
def kerb():
    """A frame of a pavement 12 cm high, 2 m ahead of a camera 1 m above the road that looks 30 degrees down."""
    focal, baseline, height, away = 280.0, 0.2, 0.12, 2.0
    v, u = np.mgrid[:240, :320]
    x, y = (u - 160) / focal, (v - 120) / focal
    ahead, down = np.cos(np.pi / 6) - y * np.sin(np.pi / 6), y * np.cos(np.pi / 6) + np.sin(np.pi / 6)
    with np.errstate(divide="ignore"):
        road, top, face = 1 / down, (1 - height) / down, away / ahead
    depth = np.where(road * ahead <= away, road, np.maximum(top, face))
    disparity = np.where((down > 0) & (depth < 6), focal * baseline / depth, np.nan).astype(np.float32)
    left = np.random.default_rng(1).integers(90, 110, (240, 320), dtype=np.uint8)
    rig = cairn.Rig(focal_px=focal, cx_px=160, cy_px=120, baseline_m=baseline)
    calibration = cairn.Calibration(rig, camera_height_m=1, camera_pitch_deg=30)
    return cairn.segment(left, rig=calibration, disparity_map=disparity, preset="paper", ground={"source": "pose"})


def same(a, b):
    """Equal bit for bit, holes included."""
    return (a is None and b is None) or (
        a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
    )


def same_frame(a, b):
    names = ["disparity", "reject", "confidence", "floor", "objects_map"]
    return all(same(getattr(a, name), getattr(b, name)) for name in names) and repr(a) == repr(b)
