# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Video, and concurrent threads."""

import concurrent.futures
import gc
import os
import threading
import time

import numpy as np
import pytest

import cairn
from conftest import same_frame


def test_a_segmenter_equals_segment(sample):
    segmenter = cairn.Segmenter(sample.calibration, exec=cairn.Exec(2))
    assert same_frame(segmenter.segment(sample.left, sample.right), sample.frame)
    assert segmenter.rig == sample.calibration.rig and segmenter.config == cairn.Config()
    assert repr(segmenter).startswith("Segmenter(config=Config('default'), rig=Rig(focal_px=")
    by_paper = cairn.Segmenter(preset="paper", match={"num_disparities": 32}).segment(sample.left, sample.right)
    assert same_frame(by_paper, cairn.segment(sample.left, sample.right, preset="paper", match={"num_disparities": 32}))
    with pytest.raises(cairn.Error, match="match.window_size"):
        cairn.Segmenter(match={"window_size": 8})


def test_frames_begun_early_are_the_same(sample):
    dark = (sample.left // 2, sample.right // 2)
    pairs = [(sample.left, sample.right), dark] * 2
    expected = [cairn.segment(*pair, sample.calibration) for pair in pairs[:2]] * 2
    segmenter = cairn.Segmenter(sample.calibration, exec=cairn.Exec(2))
    follower = cairn.Follower(sample.calibration, exec=cairn.Exec(2))
    for k, pair in enumerate(pairs):
        if k + 1 < len(pairs):
            segmenter.prefetch(*pairs[k + 1])
            follower.prefetch(*pairs[k + 1])
        frame = segmenter.segment(*pair)
        assert same_frame(frame, expected[k])
        assert list(frame.timings) == list(expected[k].timings)
        assert follower.next(*pair, seconds=k).frame.disparity.tobytes() == expected[k].disparity.tobytes()
    with pytest.raises(cairn.Error, match="right"):
        segmenter.prefetch(sample.left, sample.right[:-1])


@pytest.mark.parametrize("preset", cairn.preset_names())
def test_from_the_second_frame_on_no_image_is_allocated(sample, preset):
    segmenter = cairn.Segmenter(sample.calibration, preset=preset, exec=cairn.Exec(1))
    for _ in range(2):
        frame = segmenter.segment(sample.left, sample.right)
        assert frame.disparity.shape == (240, 320)
        del frame
        gc.collect()
    after_two = segmenter.exec.heap_allocations
    assert after_two > 0
    for _ in range(4):
        segmenter.segment(sample.left, sample.right)
    assert segmenter.exec.heap_allocations == after_two


def test_earlier_frames_keep_their_images(sample):
    segmenter = cairn.Segmenter(sample.calibration)
    first = segmenter.segment(sample.left, sample.right)
    second = segmenter.segment(np.flipud(sample.left), np.flipud(sample.right))
    del segmenter
    assert same_frame(first, sample.frame) and not same_frame(second, sample.frame)


def test_two_threads_get_the_results_of_one(sample):
    segmenter = cairn.Segmenter(sample.calibration, exec=cairn.Exec(2))

    def work(number):
        if number % 2:
            return segmenter.segment(sample.left, sample.right)
        return cairn.segment(sample.left, sample.right, sample.calibration, exec=cairn.Exec(1))

    with concurrent.futures.ThreadPoolExecutor(2) as threads:
        frames = list(threads.map(work, range(8)))
    assert all(same_frame(frame, sample.frame) for frame in frames)


def test_other_threads_run_while_one_segments(sample):
    large = [np.tile(image, (4, 4, 1)) for image in (sample.left, sample.right)]
    state = {"inside": False, "ticks": 0, "frame": None}

    def work():
        state["inside"] = True
        state["frame"] = cairn.segment(*large, exec=cairn.Exec(1))
        state["inside"] = False

    worker = threading.Thread(target=work)
    worker.start()
    while worker.is_alive():
        state["ticks"] += state["inside"]
        time.sleep(0.001)
    worker.join()
    assert state["frame"].shape == (960, 1280)
    assert state["ticks"] >= 5  # with the lock held it would be at most one


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_a_forked_process_can_segment(sample):
    """As in multiprocessing, after threads have been started."""
    child = os.fork()
    if child == 0:
        try:
            ok = same_frame(cairn.segment(sample.left, sample.right, sample.calibration), sample.frame)
        finally:
            os._exit(0 if ok else 1)
    for _ in range(600):
        done, status = os.waitpid(child, os.WNOHANG)
        if done:
            assert os.waitstatus_to_exitcode(status) == 0
            return
        time.sleep(0.05)
    os.kill(child, 9)
    os.waitpid(child, 0)
    pytest.fail("the child hangs")
