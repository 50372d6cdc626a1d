#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""frame_spread.py DATA [--size WxH] [--frames N] [--rounds N] [--timeline FILE]: how much the time of a frame depends on what it shows.
Times `default`, `paper` and OpenCV's StereoSGBM 3-way, in turn and with one thread, on up to N different frames of one
size and 64 disparities; of each frame the least time of the rounds counts, so that other load on the machine does not.
Prints median, 99th percentile and their ratio. --timeline: instead, draws when the first frames are begun and done with
one thread, with two, and with two and prefetch()."""
import argparse
import pathlib
import time

import cv2
import numpy as np

import cairn

DISPARITIES = 64


def pairs(data, size, most):
    """Evenly spread over all folders below DATA that have pairs of this size."""
    found = []
    for left in sorted(pathlib.Path(data).rglob("left.png")):
        image = cv2.imread(str(left))
        if image is not None and image.shape[1::-1] == size and left.with_name("right.png").exists():
            found.append(left)
    return [found[i * len(found) // min(most, len(found))] for i in range(min(most, len(found)))]


def least(work, rounds):
    times = []
    for _ in range(rounds):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return 1000 * min(times)


def spans(images, threads, begins_early):
    """For each frame, when it is begun and done, in ms."""
    segmenter = cairn.Segmenter(exec=cairn.Exec(threads), match={"num_disparities": DISPARITIES})
    for pair in images[:2]:
        segmenter.segment(*pair)
    zero, begun, all_spans = time.perf_counter(), {}, []
    now = lambda: 1000 * (time.perf_counter() - zero)
    for k, pair in enumerate(images):
        begun.setdefault(k, now())
        if begins_early and k + 1 < len(images):
            begun[k + 1] = now()
            segmenter.prefetch(*images[k + 1])
        segmenter.segment(*pair)
        all_spans.append((begun[k], now()))
    return all_spans


def draw_timeline(images, path):
    import report  # matplotlib

    cases = {"one thread": (1, False), "two threads": (2, False), "two threads, frames overlap": (2, True)}
    figure, axes = report.plt.subplots(len(cases), 1, figsize=(7, 2.6), sharex=True)
    for axis, (title, case) in zip(axes, cases.items()):
        for k, (begin, end) in enumerate(spans(images, *case)):
            axis.barh(k % 2, end - begin, left=begin, height=0.8, color=("#4477aa", "#cc6677")[k % 2], edgecolor="white")
            axis.text((begin + end) / 2, k % 2, str(k + 1), ha="center", va="center", color="white", fontsize=6)
        axis.set(yticks=[], ylim=(-0.6, 1.6))
        axis.set_title(title, loc="left", pad=2)
    axes[-1].set_xlabel("ms")
    figure.tight_layout()
    figure.savefig(path, dpi=150, metadata={"Software": None})


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data")
    parser.add_argument("--size", default="320x240")
    parser.add_argument("--frames", type=int, default=500)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--timeline", help="PNG file")
    arguments = parser.parse_args()
    files = pairs(arguments.data, tuple(map(int, arguments.size.split("x"))), arguments.frames)
    if not files:
        parser.error(f"{arguments.data}: found no pair of {arguments.size} below it")
    if arguments.timeline:
        colour = lambda file: np.ascontiguousarray(cv2.imread(str(file))[..., ::-1])
        return draw_timeline([(colour(f), colour(f.with_name("right.png"))) for f in files], arguments.timeline)
    cv2.setNumThreads(1)
    sgbm = cv2.StereoSGBM_create(0, DISPARITIES, 5, 200, 800, mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY)
    ours = {preset: cairn.Segmenter(preset=preset, exec=cairn.Exec(1), match={"num_disparities": DISPARITIES})
            for preset in ("default", "paper")}
    times = {name: [] for name in (*ours, "StereoSGBM 3-way")}
    for file in files:
        left, right = (cv2.imread(str(f), cv2.IMREAD_COLOR) for f in (file, file.with_name("right.png")))
        grey = [cv2.cvtColor(image, cv2.COLOR_BGR2GRAY) for image in (left, right)]
        rgb = [np.ascontiguousarray(image[..., ::-1]) for image in (left, right)]
        for name, segmenter in ours.items():
            times[name].append(least(lambda: segmenter.segment(*rgb), arguments.rounds))
        times["StereoSGBM 3-way"].append(least(lambda: sgbm.compute(*grey), arguments.rounds))
    print(f"{len(files)} different frames of {arguments.size}, {DISPARITIES} disparities, one thread")
    for name, values in times.items():
        median, p99 = np.quantile(values, [0.5, 0.99])
        print(f"{name:18} median {median:6.2f} ms  p99 {p99:6.2f} ms  p99/median {p99 / median:.2f}")


if __name__ == "__main__":
    main()
