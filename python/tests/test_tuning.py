# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Options tuned on frames, as by the command."""

import json
import os
import pickle
import signal
import subprocess
import threading

import numpy as np
import pytest

import cairn
from conftest import SOURCE, same

SPOILT = {"objects": {"min_area": 10}}


@pytest.fixture(scope="module")
def frames():
    return cairn.load_tuning_frames(SOURCE / "data" / "samples", truth=True)


def quick(frames, **more):
    """Twelve evaluations of two options, one of them set to a bad value."""
    arguments = {"options": ["objects.min_confidence", "objects.min_area"], "evaluations": 12, "budget_s": 600, **SPOILT, **more}
    return cairn.tune(frames, **arguments)


def test_the_result_equals_that_of_the_command(frames, command, tmp_path):
    tuning = quick(frames, holdout=0.25, seed=3)
    subprocess.run(
        [command, "tune", SOURCE / "data" / "samples", "--truth", "--options", "objects.min_confidence,objects.min_area", "--evaluations", "12",
         "--budget", "10m", "--holdout", "0.25", "--seed", "3", "--set", "objects.min_area=10", "-o", tmp_path / "tuned.yaml",
         "--json", tmp_path / "found.json"], check=True, capture_output=True,
    )
    found = json.loads((tmp_path / "found.json").read_text())
    assert tuning.config == cairn.Config(file=tmp_path / "tuned.yaml")
    mine = tuning.as_dict()
    assert mine["held_out"]["frames"] == len(mine["held_out_frames"]) == 1
    assert {**mine, "seconds": 0} == {**{key: value for key, value in found.items() if key != "config"}, "seconds": 0}


def test_a_bad_option_is_repaired(frames):
    tuning = quick(frames)
    loss = tuning.tuned_on["loss"]
    assert loss["after"] < loss["before"] and tuning.kept_because is None and tuning["held_out"] is None
    assert tuning.config["objects.min_area"] < 9
    assert tuning.found["objects.min_area"] == {"before": "10", "after": f"{tuning.config['objects.min_area']:g}"}
    assert tuning.options == 2 and "goal='objects'" in repr(tuning)
    back = pickle.loads(pickle.dumps(tuning))
    assert back.config == tuning.config and repr(back) == repr(tuning) and back.as_dict() == tuning.as_dict()


def test_frames_from_files_equal_frames_from_arrays(frames, sample):
    by_hand = cairn.TuningFrame(
        sample.left, sample.right, sample.calibration, name=sample.folder.name,
        objects=cairn.load_labels(sample.folder / "objects.png"), truth_px=cairn.load_disparity(sample.folder / "disp_left.png"),
    )
    read = next(frame for frame in frames if frame.name == sample.folder.name)
    assert same(by_hand.objects, read.objects) and same(by_hand.truth_px, read.truth_px)
    one, other = (quick([frame], evaluations=3) for frame in (by_hand, pickle.loads(pickle.dumps(read))))
    assert one.tuned_on["loss"] == other.tuned_on["loss"] and one.config == other.config


def test_without_truth_disparities_are_judged_by_consistency(sample):
    pair = (sample.left, sample.right)
    tuning = cairn.tune([pair, pair], evaluations=3, budget_s=600, match={"num_disparities": 32})
    assert tuning.goal == "consistency" and 0 < tuning.tuned_on["loss"]["before"] < 1
    assert not any(name.startswith("objects.") for name in tuning.found)
    assert tuning.config["match.num_disparities"] == 32


def test_progress_is_called_before_each_evaluation(frames):
    told = []
    tuning = quick(frames, evaluations=4, progress=lambda now: told.append(now))
    assert [now["evaluations"] for now in told][:4] == [0, 1, 2, 3]
    assert told[0]["best"] is None and told[-1]["before"] == tuning.tuned_on["loss"]["before"]
    assert all(0 <= now["share"] <= 1 and now["goal"] == "objects" for now in told)

    def fails(now):
        raise ZeroDivisionError("in the middle")

    with pytest.raises(ZeroDivisionError, match="in the middle"):
        quick(frames, progress=fails)


def test_ctrl_c_keeps_the_best_so_far(frames):
    def interrupt(now):
        if now["evaluations"] == 5:
            os.kill(os.getpid(), signal.SIGINT)

    tuning = quick(frames, options=["*"], evaluations=0, progress=interrupt)
    assert tuning.end == "interrupted" and 5 <= tuning.evaluations <= 6
    assert tuning.tuned_on["loss"]["after"] <= tuning.tuned_on["loss"]["before"]

    def raises(now):
        if now["evaluations"] == 2:
            raise KeyboardInterrupt

    assert quick(frames, progress=raises).end == "interrupted"

    def at_once(now):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):  # no result yet
        quick(frames, progress=at_once)


def test_ctrl_c_interrupts_a_running_measurement(frames):
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))

    def when_the_start_is_known(now):
        if now["evaluations"] == 1:
            timer.start()

    tuning = cairn.tune(frames * 3, options=["*"], budget_s=600, progress=when_the_start_is_known)
    assert tuning.end == "interrupted" and tuning.seconds < 100


def test_other_threads_run_meanwhile(frames):
    ticks, done = [0], threading.Event()

    def tick():
        while not done.wait(0.001):
            ticks[0] += 1

    ticker = threading.Thread(target=tick)
    ticker.start()
    quick(frames, evaluations=2, exec=cairn.Exec(1))
    done.set()
    ticker.join()
    assert ticks[0] >= 5


def test_tunable_names_are_listed():
    names = [option.name for option in cairn.options()]
    assert cairn.tunables() == names
    assert cairn.tunables(["objects.*"]) == [name for name in names if name.startswith("objects.")]


def test_invalid_requests_are_refused(frames, sample):
    left, right = sample.left, sample.right
    calls = {
        "frames: found none, expected one or more": lambda: cairn.tune([]),
        "frames: found 3, expected cairn.TuningFrame": lambda: cairn.tune(3),
        "frames: found 'a' as number 1, expected": lambda: cairn.tune([(left, right), "a"]),
        "left: found": lambda: cairn.tune([(None, right)]),
        "budget_s: found": lambda: cairn.tune(frames, budget_s=0),
        "holdout: found 1.5": lambda: cairn.tune(frames, holdout=1.5),
        "holdout: found one frame": lambda: cairn.tune(frames[:1], holdout=0.5),
        "evaluations: found -1": lambda: cairn.tune(frames, evaluations=-1),
        "evaluations: found 2.5, expected a whole number": lambda: cairn.tune(frames, evaluations=2.5),
        "options: found 'superpixels.count', expected a list, each entry a str": lambda: cairn.tune(frames, options="superpixels.count"),
        "match.window_size": lambda: cairn.tune(frames, options=["match.windw_size"]),
        "match.cost has no effect with match.method=semi_global": lambda: cairn.tune(frames, options=["match.cost"]),
        "has no effect on disparities": lambda: cairn.tune([(left, right)], options=["superpixels.count"]),
        "progress: found 3, expected a function or None": lambda: cairn.tune(frames, progress=3),
        "objects: is 319x240, expected 320x240 as left is": lambda: cairn.TuningFrame(left, right, objects=np.zeros((240, 319), int)),
        "objects: found -2 at x 0, y 0": lambda: cairn.TuningFrame(left, right, objects=np.full((240, 320), -2)),
        "nowhere: no such folder": lambda: cairn.load_tuning_frames("nowhere"),
        "nothing that can be scored": lambda: cairn.tune([cairn.TuningFrame(left, right, objects=np.zeros((240, 320), int))]),
        "frame 0: option match.num_disparities": lambda: cairn.tune([(left, right)], match={"num_disparities": 999}),
    }
    for words, call in calls.items():
        with pytest.raises(cairn.Error, match=words):
            call()
