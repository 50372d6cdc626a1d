# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Runs the code shown in the guide."""

import re
import subprocess
import sys

import cairn
import guide


def test_the_example_prints_what_the_first_one_in_cpp_prints(source, sample):
    example = source / "examples" / "04_in_python.py"
    done = subprocess.run([sys.executable, example, sample.folder], capture_output=True, text=True, check=True)
    printed_in_readme = re.findall(r"^object \d .* away$", (source / "README.md").read_text(), re.M)
    assert done.stdout.splitlines()[:-1] == printed_in_readme != []


def test_the_guide_runs(sample, source, capsys):
    rig = guide.rigs(sample.folder)
    assert isinstance(rig, cairn.Calibration)
    frame, pixels, trusted, hidden = guide.frame_of(sample.left, sample.right, rig)
    assert pixels.sum() == frame.objects[0].pixel_count and hidden.any() and (trusted > 0).any()
    frame, coarse = guide.options_of(sample.left, sample.right, rig)
    assert frame.config["match.window_size"] == 11 and coarse[0].default == 9
    found = guide.video([(sample.left, sample.right)] * 2, rig)
    assert found[0] == found[1] and found[0][0][0] == 1
    assert guide.overlapping([(sample.left, sample.right)] * 4, rig) == [len(sample.frame.objects)] * 4
    if isinstance(cairn.Follower, type):
        found = guide.followed(source / "data" / "sequences" / "rolling_ball")
        assert any(is_moving for _, _, _, is_moving, _ in found) and len({track for _, track, *_ in found}) == 3
        assert guide.fed([(sample.left, sample.right)] * 2, rig).index == 1
    assert guide.stages(sample.left, sample.right, rig).objects
    assert guide.doctor(sample.right, sample.left, rig, [(sample.left, sample.right)] * 2) == 0
    assert capsys.readouterr().out.startswith("broken, cameras swapped: ")
    tuning, better = guide.tuned(source / "data" / "samples", sample.left, sample.right, rig)
    assert capsys.readouterr().out == f"{tuning}\n" and better.config["superpixels.count"] == tuning.config["superpixels.count"]
