# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""lab/: trees as files, reports, the fate of a missed object. Nothing is fitted here."""

import importlib.util
import pathlib
import re
import struct
import subprocess
import sys
import types

import numpy as np
import pytest
from conftest import SOURCE


sys.path.insert(0, str(SOURCE / "lab"))


def load(name):
    spec = importlib.util.spec_from_file_location(name, SOURCE / "lab" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


fit = load("fit")

TREE = {
    "nodeid": 0, "split": "f3", "split_condition": 1.5, "yes": 1, "no": 2,
    "children": [
        {"nodeid": 2, "leaf": 0.25},
        {"nodeid": 1, "split": "f0", "split_condition": -2, "yes": 4, "no": 3,
         "children": [{"nodeid": 3, "leaf": 3}, {"nodeid": 4, "leaf": -1}]},
    ],
}


def trees():
    nodes = fit.Nodes(0.5)
    nodes.add(TREE)
    nodes.add({"nodeid": 0, "leaf": 7})
    return nodes


def test_the_branches_of_a_node_are_adjacent_yes_first():
    nodes = trees()
    assert nodes.roots == [0, 5]
    assert nodes.nodes == [(3, 1, 1.5), (0, 3, -2), (-1, 0, 0.25), (-1, 0, -1), (-1, 0, 3), (-1, 0, 7)]


def test_trees_are_written_for_the_tool_and_for_the_library(tmp_path):
    nodes = trees()
    nodes.write(tmp_path / "trees")
    assert (tmp_path / "trees").read_text() == "0.5 2 6\n0 5\n3 1 1.5\n0 3 -2\n-1 0 0.25\n-1 0 -1\n-1 0 3\n-1 0 7\n"
    fit.fitted_files.write_trees(tmp_path / "trees.bin", nodes.base, nodes.roots, nodes.nodes)
    assert (tmp_path / "trees.bin").read_bytes() == (
        b"cairn 1 tree" + struct.pack("<If", 1, 0.5) + struct.pack("<I2h", 2, 0, 5) + struct.pack("<I", 6)
        + b"".join(struct.pack("<hhf", *node) for node in nodes.nodes))


def test_arrays_of_fitted_files_begin_at_whole_words(tmp_path):
    fit.fitted_files.write_network(tmp_path / "net.bin", [(1, 1, 3, 2, 0)], [-1, 2, 3], [7], [0.25])
    assert (tmp_path / "net.bin").read_bytes() == (
        b"cairn 1 net " + struct.pack("<I5i", 5, 1, 1, 3, 2, 0) + struct.pack("<I3bx", 3, -1, 2, 3)
        + struct.pack("<Ii", 1, 7) + struct.pack("<If", 1, 0.25))


def test_a_scene_is_in_one_fold_at_all_sizes():
    folds = [fit.fold_of(pathlib.Path(f"dev/320x240/s{i}"), 5) for i in range(50)]
    assert folds == [fit.fold_of(pathlib.Path(f"dev/640x480/s{i}"), 5) for i in range(50)]
    assert set(folds) == set(range(5))


def test_frames_are_folders_with_true_objects(tmp_path):
    for name, files in {"b": ["left.png", "objects.png"], "a": ["left.png", "objects.png"], "c": ["left.png"]}.items():
        (tmp_path / name).mkdir()
        for file in files:
            (tmp_path / name / file).touch()
    assert fit.frames_in(tmp_path) == [tmp_path / "a", tmp_path / "b"]


def test_numbers_are_formatted():
    assert fit.runs_of([1, 2, 3, 4, 6, 8, 9]) == "1 to 4, 6, 8 to 9"
    assert fit.share_with_interval(0, 0) == "–"
    assert fit.share_with_interval(8, 10) == "0.80 (0.49 … 0.94)"
    assert fit.shares_of({"f1": 3.0, "f0": 1.0}, ["a", "b", "c"]) == [(0.75, "b"), (0.25, "a"), (0.0, "c")]


def test_every_kind_of_cues_has_features():
    names = "\n".join(re.findall(r'"([^"]+)"', (SOURCE / "cairn/regions/region_features.cpp").read_text()))
    for cue, words in fit.CUES.items():
        for word in words:
            assert word in names, f"{cue}: {word}"


# For each job: its number, the true objects, partial, ours, right, phantoms, IoUs, scores:right, milliseconds.
ROWS = ["0 2 0 3 2 1 =0.9,0.6 =0.95:1,0.85:0,0.4:1 7".split(" "), "1 1 1 5 0 9 =0.2 =0.9:0 3".split(" ")]


def test_a_report_counts_partial_frames_in_recall_only():
    jobs = [(pathlib.Path("a"), "colour", "rooms"), (pathlib.Path("b"), "colour", "rooms")]
    row = fit.report(ROWS, jobs).splitlines()[2]
    found = fit.share_with_interval
    assert row == (f"| rooms | colour | 3 | {found(2, 3)} | {found(1, 3)} | {found(2, 3)} | 67 | 1.00 | "
                   f"{found(1, 2)} | 5.0 |")


def test_the_ablation_fits_without_each_kind_of_cues(tmp_path, capsys):
    fitted = []
    fake = types.SimpleNamespace(
        jobs=[None] * 6, folds=2, fit_regions=lambda: None, of_all=lambda i: ("same_thing_all", "whole_object_all"),
        fit_pairs=lambda: fitted.append(fake.without), run=lambda trees, *options, jobs: ROWS)
    jobs = [(pathlib.Path("a"), "colour", "validate 320x240"), (pathlib.Path("b"), "grey", "validate rc_tabletop")]
    fit.ablation(fake, jobs, tmp_path / "ablation.md")
    assert fitted == [(), *fit.CUES.values()]
    page = (tmp_path / "ablation.md").read_text()
    assert "| edges | 2/2 = 1.00 | 0/1 = 0.00 | 2/2 = 1.00 | 0/0 = – | 0/0 = – | 0/1 = 0.00 | 0/0 = – | 0/0 = – | 2/3 = 0.67 |" in page
    assert "fitted to 3 frames" in page and "in 2 folds" in page


def test_a_hint_counts_as_a_cue_of_the_hints_only(tmp_path):
    np.arange(1, 6, dtype=np.float32).tofile(tmp_path / "regions0")
    (tmp_path / "regions1").write_bytes(b"")
    names = ["hints: area over the voted size", "area, share of the image"]
    for without, kept in ((("area",), [4, 0]), (("hints:",), [0, 5]), ((), [4, 5])):
        fake = types.SimpleNamespace(work=tmp_path, without=without, region_features=names, bias_features=[],
                                     pair_features=[])
        _, values = fit.Fitting.records(fake, "regions", 2)
        assert values.tolist() == [kept]


def test_clutter_is_a_separate_set(tmp_path):
    for name in ("train_s300", "clutter_s2000", "train_s301"):
        (tmp_path / "rooms" / name).mkdir(parents=True)
        for file in ("left.png", "objects.png"):
            (tmp_path / "rooms" / name / file).touch()
    sets = fit.fit_sets(tmp_path, tmp_path / "rooms")
    assert [frame.name for frame in sets["more rooms"]] == ["train_s300", "train_s301"]
    assert [frame.name for frame in sets["clutter"]] == ["clutter_s2000"]
    assert "clutter" not in fit.fit_sets(tmp_path, None)


def test_a_close_view_has_the_input_of_a_narrow_lens(monkeypatch):
    monkeypatch.syspath_prepend(str(SOURCE / "lab"))
    hints = load("fit_hints")
    data = np.zeros((hints.CHANNELS, hints.HEIGHT, hints.WIDTH), np.float32)
    inside = np.ones(data.shape[1:], bool)
    inside[:, :40] = False
    data[0, inside], data[3, inside], data[4, inside], data[5, inside] = 2, 0.25, 1, 0.5
    hints.see_closer(data, 2.0, inside)
    assert np.allclose(data[0][inside], 0)  # as bright as the crop's mean
    assert np.allclose(data[3][inside], 1)  # the nearest thing that is seen
    assert np.allclose(data[5][inside], 1)  # twice the disparity
    assert data[10, 0, 80] == -1 and (data[:, ~inside] == 0).all()


def test_the_fate_of_a_lost_object():
    pytest.importorskip("PIL")
    worst = load("worst_frames")
    truth = np.zeros((20, 40), int)
    truth[5:15, 5:15] = 1
    truth[5:15, 15:25] = 2
    ours = np.zeros_like(truth)
    assert worst.why(truth, ours, 1) == "missed"
    ours[5:15, 5:25] = 3
    assert worst.why(truth, ours, 1) == "merged with a neighbour"
    assert worst.why(np.where(truth == 1, 1, 0), ours, 1) == "100 % found"
    ours[:] = 0
    ours[5:9, 5:15] = 1
    assert worst.why(truth, ours, 1) == "40 % found"
    ours[10:13, 5:15] = 2
    assert worst.why(truth, ours, 1) == "40 % found, split"
    ours[:, :15] = 5
    assert worst.why(truth, ours, 1) == "merged with the background"
    ours[:] = 0
    ours[5:15, 5:6] = 1
    assert worst.why(truth, ours, 1) == "missed"


@pytest.mark.parametrize("arguments, message", [
    (["--worse"], "fit: unknown argument '--worse'"),
    (["--worst", "12"], "fit: unknown argument '12'"),
    (["nowhere"], "fit: there is no folder 'nowhere'"),
    (["--distances", "--ablation"], "fit: unknown argument '--ablation' after --distances"),
    (["--distances", "nowhere"], "fit: there is no folder 'nowhere'"),
    (["--distances"], "fit: no data collection in '/nowhere'"),
    (["--ablation"], "fit: no data collection in '/nowhere'"),
    (["--worst"], "fit: no data collection in '/nowhere'"),
])
def test_dev_refuses_unknown_arguments(arguments, message):
    environment = {"CAIRN_DATA": "/nowhere", "CAIRN_INSTALL": "no", "PATH": "/usr/bin:/bin"}
    done = subprocess.run([SOURCE / "dev", "fit", *arguments], capture_output=True, text=True, env=environment)
    assert message in done.stderr and done.stderr.count("\n") == 1 and done.returncode == 1


def test_frames_of_a_sequence_are_one_scene(tmp_path):
    frames = [tmp_path / "dev_seqA" / f"{i:03}" for i in range(40)]
    assert len({fit.fold_of(frame, 5) for frame in frames}) == 1
    assert fit.fold_of(tmp_path / "320x240" / "dev_s01", 5) == fit.fold_of(tmp_path / "640x480" / "dev_s01", 5)


def test_corrections_are_reduced_and_limited_as_in_the_library():
    assert fit.beyond_doubt(np.array([0.05, -0.05, 0.28, -0.28, 9])) == pytest.approx([0, 0, 0.2, -0.2, 1])
    code = (SOURCE / "cairn/objects/refine_objects.cpp").read_text()
    for name, number in (("kDoubt", fit.DOUBT), ("kMaxBias", fit.MOST_CORRECTION)):
        assert float(re.search(rf"{name} = ([0-9.]+);", code)[1]) == number


def test_errors_in_metres_grow_with_the_square_of_the_distance(tmp_path):
    (tmp_path / "calib.txt").write_text("fx=200\nbaseline=0.1\n")
    jobs = [(tmp_path, "colour", "rooms")]
    near = fit.bias_rows(jobs, np.array([[0, 0.1, 10**2 / 20]]), np.array([0.0]))  # 2 m
    assert near == "| rooms | colour | 1 | 0.100 | 0.000 | 1 | 2.0 / 2.0 | 0.0 / 0.0 |\n"
    far = fit.bias_rows(jobs, np.array([[0, 0.1, 5**2 / 20]]), np.array([0.05]))  # 4 m
    assert far == "| rooms | colour | 1 | 0.100 | 0.050 | 1 | 8.2 / 8.2 | 4.0 / 4.0 |\n"
