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
    jobs = [(pathlib.Path("a"), "colour", "yardstick indoors"), (pathlib.Path("b"), "grey", "rc_tabletop")]
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
                                     pair_features=[], plane_features=[], floor_features=[])
        _, values = fit.Fitting.records(fake, "regions", 2)
        assert values.tolist() == [kept]


def test_the_fit_needs_worlds_alone(tmp_path):
    world = tmp_path / "worlds" / "world_00000"
    room = tmp_path / "data/rendered/dev/320x240/dev_s01"
    for folder in (world, room):
        folder.mkdir(parents=True)
        for file in ("left.png", "objects.png"):
            (folder / file).touch()
    assert fit.fit_sets(tmp_path / "worlds", None) == {"worlds": [world]}
    assert fit.fit_sets(tmp_path / "worlds", tmp_path / "data")["dev 320x240"] == [room]
    assert fit.fit_sets(tmp_path / "worlds", None, tmp_path / "worlds")["wide streets"] == [world]
    assert fit.checked_sets(None, None) == {}


@pytest.fixture
def hints(monkeypatch):
    monkeypatch.syspath_prepend(str(SOURCE / "lab"))
    return load("fit_hints")


def store(hints, folder, ids):
    """Two frames, in colour and in grey, with the objects `ids`: (id, columns) of a band in the middle."""
    cells = np.zeros((4, hints.OWN, hints.HEIGHT, hints.WIDTH), np.int16)
    cells[:, 4] = hints.UNIT
    cells[::2, 11] = hints.UNIT
    truth = np.zeros((4, hints.HEIGHT, hints.WIDTH), np.uint8)
    for number, columns in ids:
        truth[:, 40:80, columns] = number
    np.save(folder / "cells.npy", cells)
    np.save(folder / "truth.npy", truth)


def sampling(hints, folder, objects):
    """A sampler of such frames, a batch of zeros, the ids of the first frame for all of it, and random numbers."""
    torch = pytest.importorskip("torch")
    store(hints, folder, objects)
    sampler = hints.Sampler(hints.Frames([folder], 10, torch.device("cpu")), 4)
    data = torch.zeros(hints.BATCH, hints.OWN, hints.HEIGHT, hints.WIDTH)
    ids = torch.from_numpy(np.load(folder / "truth.npy")[:1].astype(np.int64)).repeat(hints.BATCH, 1, 1)
    random = torch.Generator().manual_seed(1)

    def uniform(low, high, shape=(hints.BATCH, 1, 1)):
        return low + (high - low) * torch.rand(*shape, generator=random)

    return sampler, data, ids, uniform


@pytest.mark.parametrize("more_rows", (30, -24))  # a larger image, a flat one
def test_a_window_is_gathered(hints, tmp_path, monkeypatch, more_rows):
    torch = pytest.importorskip("torch")
    width, height = hints.WIDTH + 40, hints.HEIGHT + more_rows
    down, across = np.mgrid[:height, :width]
    own = np.zeros((hints.OWN, height, width), np.int16)
    own[0], own[1] = across + 1, down + 1
    recorded = np.floor(hints.with_surroundings(torch.from_numpy(own[None] / hints.UNIT).float())[0].numpy() * hints.UNIT + 0.5)

    def run_tool(tool, work, jobs, files, *options, parts):
        cells = recorded.transpose(1, 2, 0).astype(np.int16)
        ids = np.where(across < 90, 7, -1).astype(np.int16)
        for part in range(parts):
            mine = range(len(jobs[part::parts]))
            rows = [np.concatenate([np.array([i, width, height, 0], np.int16), cells.ravel(), ids.ravel()]) for i in mine]
            np.array(rows, np.int16).tofile(work / f"inputs{part}")
            (work / f"jobs{part}").touch()

    monkeypatch.setattr(hints, "run_tool", run_tool)
    monkeypatch.setattr(hints.os, "cpu_count", lambda: 8)  # more than there are jobs
    hints.gather("tool", tmp_path, ["a", "b", "c"])
    cells, truth = np.load(tmp_path / "cells.npy"), np.load(tmp_path / "truth.npy")
    top = max(0, -more_rows // 2)
    assert (cells[:, :, :top] == 0).all() and (truth[:, :top] == hints.DONT_CARE).all()
    rows = min(height, hints.HEIGHT)
    cells, truth = cells[:, :, top:top + rows], truth[:, top:top + rows]
    first = cells[:, 0, 0, 0], cells[:, 1, 0, 0]
    assert len(cells) == 6 and len(set(zip(*map(tuple, first)))) > 3
    assert (cells[:, 0] == first[0][:, None, None] + across[:rows, :hints.WIDTH]).all()
    assert (cells[:, 1] == first[1][:, None, None] + down[:rows, :hints.WIDTH]).all()
    assert (truth == np.where(cells[:, 0] < 91, 7, hints.DONT_CARE)).all()
    recorded[13] += 2  # a library that computes something else
    with pytest.raises(SystemExit, match="not those of the library"):
        hints.gather("tool", tmp_path, ["d"])


def test_every_frame_comes_once_in_a_round(hints):
    sampler = types.SimpleNamespace(frames=range(60), seed=1)
    half = hints.BATCH // 2
    drawn = np.concatenate([hints.Sampler.numbers(sampler, step) for step in range(60 // half)])
    assert sorted(drawn) == list(range(120))
    first = hints.Sampler.numbers(sampler, 0)
    assert (first[:half] % 2 == 0).all() and (first[half:] % 2 == 1).all()  # in colour, in grey
    assert (hints.Sampler.numbers(sampler, 1000) == hints.Sampler.numbers(sampler, 1000)).all()


@pytest.mark.parametrize("width", (1 / 3, 1 / 2))  # the same, and wider
def test_a_fit_goes_on_from_the_networks_integers(hints, tmp_path, width):
    torch = pytest.importorskip("torch")
    store(hints, tmp_path, [(1, slice(30, 60))])
    frames = hints.Frames([tmp_path], 10, torch.device("cpu"))
    torch.manual_seed(3)
    net = hints.network(1 / 3).eval()
    for step in net.steps:
        torch.nn.init.normal_(step[1].running_mean, 0, 0.3)
        torch.nn.init.uniform_(step[1].weight, 0.5, 2)
        torch.nn.init.normal_(step[1].bias, 0.2, 0.3)
    hints.write_fitted(hints.rounded(net, frames), tmp_path / "hints.bin")
    again = hints.network(width)
    hints.of_library(again, tmp_path / "hints.bin", frames)
    again.eval()
    data = hints.with_surroundings(torch.stack([frames.take(number)[0] for number in (0, 1)]).float() / hints.UNIT)
    with torch.no_grad():
        expected, found = net(data), again(data)
    assert (found - expected).abs().max() < 0.05 * expected.abs().max()  # but for the rounding


def test_a_step_turns_filters_along_an_orthogonal_matrix(hints):
    torch = pytest.importorskip("torch")
    torch.manual_seed(1)
    for kind in (torch.bfloat16, torch.float32):
        for shape in ((8, 40), (40, 8)):
            values = torch.linalg.svdvals(hints.orthogonal(torch.randn(shape), kind))
            assert values.min() > 0.5 and values.max() < 1.4
    weight = torch.nn.Parameter(3 * torch.randn(16, 4, 3, 3))
    weight.grad = torch.randn_like(weight)
    before, gradient = weight.detach().clone(), weight.grad.clone()
    hints.orthogonal_steps([weight], 0.01, torch.float32).step()
    step = weight.detach() - before * 4 / before.norm()  # 16 filters, of length 1 in the mean
    assert 0.03 < step.norm() < 0.05  # of a length of 4
    assert (step * gradient).sum() < 0


def test_targets_of_the_network(hints, tmp_path):
    sampler, _, ids, _ = sampling(hints, tmp_path, [(3, slice(60, 80)), (9, slice(80, 90))])
    ids[:, 0, 0] = hints.DONT_CARE
    targets = sampler.targets(ids)[0].numpy()
    assert targets[0].sum() == 40 * 30 and targets[6].sum() == hints.HEIGHT * hints.WIDTH - 1
    assert targets[1, 60, 79] == targets[1, 60, 80] == 1 and targets[1, 60, 70] == 0  # outlines, on both sides
    assert targets[1, 0, 0] == targets[1, 0, 1] == 0  # none around what is unknown
    assert targets[2:6, 50, 65] == pytest.approx([69.5, 59.5, np.log2(800), np.sqrt(800)])


def test_a_pasted_object_hides_what_is_behind_it(hints, tmp_path, monkeypatch):
    torch = pytest.importorskip("torch")
    monkeypatch.setattr(hints, "PASTES", 1)
    sampler, data, ids, uniform = sampling(hints, tmp_path, [(1, slice(60, 90))])
    data[:, 3], data[:, 4] = 0.5, 1
    data[:, 0] = torch.arange(hints.BATCH)[:, None, None]  # brightness says whose cells they are
    before = data.clone()
    sampler.paste(data, ids, 253, uniform)
    pasted = ids == 253
    assert pasted.any() and (data[:, 3][pasted] > 0.5).all()
    assert (data[:, 0] != before[:, 0])[pasted].all()
    unchanged = ~pasted[:, None].expand_as(data)
    assert (data[unchanged] == before[unchanged]).all()


def test_a_mark_lies_flat_on_the_floor(hints, tmp_path, monkeypatch):
    monkeypatch.setattr(hints, "MARKS", 1)
    sampler, data, ids, uniform = sampling(hints, tmp_path, [(1, slice(60, 90))])
    data[:, 7, 60:] = 0.5  # the floor
    before = data.clone()
    free = (ids == 0) & (data[:, 7] > 0)
    sampler.mark(data, ids, uniform)
    changed = (data != before).any(1)
    assert changed.flatten(1).any(1).sum() > hints.BATCH / 3 and (free | ~changed).all()
    matched = data[:, 4] > 0
    assert matched.any() and (data[:, 3][matched] == 0.5).all() and (data[:, 5][matched].abs() < 0.2).all()
    assert (data[:, 7] == before[:, 7]).all()


def test_of_the_start_a_share_is_kept(hints, tmp_path, monkeypatch):
    torch = pytest.importorskip("torch")
    monkeypatch.setattr(hints, "BATCH", 4)
    monkeypatch.setattr(hints, "COUNTED", 2)
    store(hints, tmp_path, [(1, slice(20, 70))])
    frames = hints.Frames([tmp_path], 10, torch.device("cpu"))
    start, net = hints.network(1 / 3), hints.network(1 / 3)
    expected = 0.25 * start.end.weight + 0.75 * net.end.weight
    mean = hints.towards_start(net, start.state_dict(), 0.25, frames)
    assert torch.allclose(mean.end.weight, expected) and not mean.training
    assert (mean.steps[0][1].running_mean != 0).any()  # measured again


def test_a_close_view_has_the_input_of_a_narrow_lens(hints, tmp_path):
    torch = pytest.importorskip("torch")
    sampler, data, _, _ = sampling(hints, tmp_path, [])
    inside = torch.ones(hints.BATCH, hints.HEIGHT, hints.WIDTH, dtype=torch.bool)
    inside[:, :, :40] = False
    for channel, value in ((0, 2.0), (3, 0.25), (4, 1.0), (5, 0.5)):
        data[:, channel][inside] = value
    narrower = torch.zeros(hints.BATCH, 1, 1, dtype=torch.bool)
    narrower[0] = True
    before = data.clone()
    sampler.see_closer(data, torch.full((hints.BATCH, 1, 1), 2.0), inside, narrower)
    assert torch.allclose(data[0, 0][inside[0]], torch.tensor(0.0))  # as bright as the crop's mean
    assert torch.allclose(data[0, 3][inside[0]], torch.tensor(1.0))  # the nearest thing that is seen
    assert torch.allclose(data[0, 5][inside[0]], torch.tensor(1.0))  # twice the disparity
    assert data[0, 10, 0, 80] == -1 and (data[0, :, ~inside[0]] == 0).all()
    assert (data[1:] == before[1:]).all()


def test_a_fit_that_was_stopped_goes_on_to_the_same_weights(hints, tmp_path, monkeypatch):
    torch = pytest.importorskip("torch")
    monkeypatch.setattr(hints, "BATCH", 4)
    store(hints, tmp_path, [(1, slice(20, 70))])
    frames = hints.Frames([tmp_path], 10, torch.device("cpu"))
    whole = hints.fitted(frames, 4, 0.5, tmp_path / "whole")
    monkeypatch.setattr(hints, "CHECKPOINT_SECONDS", -1)  # after every step

    class Stopped(Exception):
        pass

    batch = hints.Sampler.batch

    def until_stopped(sampler, step):
        if step == 2:
            raise Stopped
        return batch(sampler, step)

    monkeypatch.setattr(hints.Sampler, "batch", until_stopped)
    with pytest.raises(Stopped):
        hints.fitted(frames, 4, 0.5, tmp_path / "parts")
    monkeypatch.setattr(hints.Sampler, "batch", batch)
    resumed = hints.fitted(frames, 4, 0.5, tmp_path / "parts")
    for one, other in zip(whole.state_dict().values(), resumed.state_dict().values()):
        assert torch.equal(one, other)


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
    (["nowhere"], "fit: unknown argument 'nowhere'"),
    (["--distances", "--ablation"], "fit: unknown argument '--ablation'"),
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
