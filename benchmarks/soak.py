# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""soak.py DATA [--frames N] [--threads N]: hours of running in short. Goes to and fro through a rendered tour, N frames in
all, once with cairn.Segmenter in sizes and presets that take turns and once with cairn.Follower and a map in memory, and
prints how long a frame takes and how much the process has grown since its 200th frame. Exit code 1 where that is more
than 8 MB: something is kept."""
import argparse
import resource
import sys
import time
from pathlib import Path

import numpy as np

import cairn

MOST_GROWTH_MB = 8
SETTLED = 200  # frames after which nothing should grow


def resident_mb():
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * resource.getpagesize() / 2**20


def to_and_fro(frames, count):
    """0 1 … last … 1 0 1 …, so that the camera never jumps."""
    cycle = list(range(len(frames))) + list(range(len(frames) - 2, 0, -1))
    for k in range(count):
        yield k, frames[cycle[k % len(cycle)]]


def run(name, frames, count, step):
    milliseconds, settled = [], None
    for k, frame in to_and_fro(frames, count):
        began = time.perf_counter()
        step(k, frame)
        milliseconds.append(1000 * (time.perf_counter() - began))
        if k == SETTLED:
            settled = resident_mb()
    grown = resident_mb() - settled
    p50, p99 = np.percentile(milliseconds, [50, 99])
    print(f"{name:10} {count} frames   p50 {p50:6.1f} ms   p99 {p99:6.1f} ms   max {max(milliseconds):6.1f} ms   "
          f"resident {settled:6.1f} MB, grown by {grown:+.1f} MB", flush=True)
    return grown <= MOST_GROWTH_MB


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("--frames", type=int, default=100_000)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    if options.frames <= SETTLED:
        sys.exit(f"soak.py: --frames {options.frames}: expected more than {SETTLED}")
    folders = sorted(p.parent for p in (options.data / "rendered/tour_train").glob("*/left.png"))
    if not folders:
        sys.exit(f"soak.py: {options.data}: has no rendered/tour_train")
    pairs = [cairn.load_pair(f / "left.png", f / "right.png") for f in folders]
    calibration = cairn.load_calibration(folders[0] / "calib.txt")

    segmenters = [cairn.Segmenter(calibration.rig, preset=preset, exec=cairn.Exec(options.threads))
                  for preset in ("default", "paper")]

    def segment(k, pair):
        left, right = pair
        if k % 3 == 1:  # another size
            left, right = (np.ascontiguousarray(image[40:, 30:]) for image in pair)
        segmenters[k % 2].segment(left, right)

    fine = run("segment", pairs, options.frames, segment)
    follower = cairn.Follower(calibration, exec=cairn.Exec(options.threads))
    fine &= run("follow", pairs, options.frames, lambda k, pair: follower.next(*pair, seconds=0.2 * k))
    sys.exit(0 if fine else 1)


main()
