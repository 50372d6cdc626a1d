# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""lab/: tables and plots of docs/accuracy.md and BENCHMARK.md, and the list of ablations."""

import math
import pathlib
import sys

import numpy as np
import pytest
from conftest import SOURCE

import cairn

pytest.importorskip("matplotlib")
sys.path.insert(0, str(SOURCE / "lab"))
import accuracy  # noqa: E402
import page  # noqa: E402
import report  # noqa: E402


def test_a_table_puts_words_left_and_numbers_right():
    assert report.table(["", "found, %"], [["default", "73.7"]]) == "|  | found, % |\n|---|---:|\n| default | 73.7 |\n"
    assert report.table(["a", "b"], [["x|y", "1"]], words=2) == "| a | b |\n|---|---|\n| x\\|y | 1 |\n"


def test_nan_is_a_dash():
    assert (report.percent(0.6214), report.percent(math.nan)) == ("62.1", "–")


@pytest.mark.parametrize("most, end", [(3.2, 5), (5, 5), (51, 100), (0.17, 0.2), (0, 1), (math.nan, 1)])
def test_axes_end_at_round_numbers(most, end):
    assert report.axis_end(most) == pytest.approx(end)


def test_a_plot_is_the_same_file_each_time(tmp_path):
    panels = [("found, %", 100, {"default": ("#ff0000", [10, math.nan, 30])})]
    for name in ("a.png", "b.png"):
        report.plot(tmp_path / name, [0, 1, 2], panels, "noise", {0: "none", 2: "much"})
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    picture = np.rint(255 * report.plt.imread(tmp_path / "a.png")[..., :3])
    assert (picture == (255, 0, 0)).all(axis=-1).any(), "no line in its colour"


def test_each_ablation_is_a_configuration_that_differs_from_default():
    for settings in accuracy.all_ablations():
        config, grey = accuracy.configured(settings)
        assert grey or config.as_dict() != cairn.Config().as_dict(), settings


def test_ablations_cover_every_option_on_which_the_presets_differ():
    named = " ".join(accuracy.all_ablations())
    for ours, paper in zip(cairn.options(), cairn.options("paper")):
        if ours.default != paper.default and ours.active:
            assert f"{ours.name}=" in named


def test_as_printed_is_paper_without_floor_label_and_gradient_thresholds():
    config, grey = accuracy.configured(accuracy.AS_PRINTED)
    paper = cairn.Config("paper")
    changed = {f"{group}.{name}": value for group, of in config.as_dict().items() for name, value in of.items() if paper[f"{group}.{name}"] != value}
    assert changed == {"ground.label_floor": False, "intensity.gradient_threshold": 0, "disparity.gradient_threshold": 0}
    assert not grey


@pytest.mark.parametrize("settings", ["speckle.sise=-1", "speckle.size"])
def test_a_misspelt_option_is_refused(settings):
    with pytest.raises(ValueError):
        accuracy.configured(settings)


def test_a_line_through_exact_points_is_found():
    assert page.straight_line([1, 2, 4], [5, 7, 11]) == pytest.approx((2, 3, 0), abs=1e-9)


def test_a_sample_has_its_scores():
    frame = accuracy.TrueFrame(pathlib.Path(SOURCE) / "data" / "samples" / "four_in_a_row")
    score = accuracy.score(frame, cairn.Config(), False)
    summary = accuracy.Summary([score])
    by_library = cairn.summarise([score.objects])
    assert (summary.recall_50, summary.precision_50, summary.median_error) == pytest.approx(
        (by_library.recall_50, by_library.precision_50, by_library.median_error))
    assert summary.density == pytest.approx(score.disparity.density)
    assert summary.bad_2 == pytest.approx(score.disparity.bad_of_matched[2.0])
