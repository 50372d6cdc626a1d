# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""soak.py DATA [--frames N] [--threads N] [--cairn PROGRAM] [--shrink N] [--only RUN]: a short endurance test. Runs
back and forth through a rendered tour in small images, N frames for each RUN:

  segmenter  cairn.Segmenter, alternating sizes and presets
  follower   cairn.Follower with a map in memory
  live       the command cairn live, with objects as lines of JSON (needs --cairn)

At ten points it prints the time per frame since the last point, the process's resident memory, and the number of
images that the segmenters' pools have allocated so far. Exit code 1 if memory grew by more than 8 MB, or if
images were allocated after the first tenth: something leaks, or is not reused."""
import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from array import array
from pathlib import Path

import numpy as np

import cairn

MOST_GROWTH_MB = 8
POINTS = 10
DISPARITIES = 32


def resident_mb(process="self"):
    with open(f"/proc/{process}/statm") as statm:
        return int(statm.read().split()[1]) * resource.getpagesize() / 2**20


def to_and_fro(frames):
    """0 1 … last … 1: repeating it has no jump."""
    return frames + frames[-2:0:-1]


class Log:
    """Prints a line at each of the points, and a summary."""

    def __init__(self, name, frames):
        self.name, self.frames = name, frames
        self.all, self.since, self.points = array("f"), array("f"), []  # a list of floats would grow eight times as fast
        print(f"\n{name}: {frames} frames\n{'frames':>8} {'p50':>7} {'p99':>7} {'max':>7} ms   resident MB   "
              "images allocated", flush=True)

    def frame(self, milliseconds, memory_mb, images=lambda: None):
        self.all.append(milliseconds)
        self.since.append(milliseconds)
        if len(self.all) * POINTS // self.frames == len(self.points):
            return
        self.points.append((memory_mb(), images()))
        self.line(self.since, *self.points[-1])
        self.since = array("f")

    def line(self, milliseconds, memory, images):
        p50, p99 = np.percentile(milliseconds, [50, 99])
        print(f"{len(self.all):8} {p50:7.1f} {p99:7.1f} {max(milliseconds):7.1f}      {memory:11.1f}   "
              f"{'' if images is None else images:>16}", flush=True)

    def is_fine(self):
        (first_mb, first_images), (last_mb, last_images) = self.points[0], self.points[-1]
        p50, p99 = np.percentile(self.all, [50, 99])
        print(f"{self.name}: {len(self.all)} frames, p50 {p50:.1f} ms, p99 {p99:.1f} ms, max {max(self.all):.1f} ms; "
              f"since the first tenth memory grew by {last_mb - first_mb:+.1f} MB"
              + ("" if last_images is None else f", and {last_images - first_images} images were allocated"), flush=True)
        return last_mb - first_mb <= MOST_GROWTH_MB and last_images == first_images


def in_process(name, pairs, frames, step, images=lambda: None):
    log = Log(name, frames)
    for k in range(frames):
        began = time.perf_counter()
        step(k, pairs[k % len(pairs)])
        log.frame(1000 * (time.perf_counter() - began), resident_mb, images)
    return log.is_fine()


def soak_segmenter(pairs, rig, options):
    height, width = pairs[0][0].shape[:2]
    sizes = [np.s_[:, :], np.s_[height // 6:, width // 10:], np.s_[:height * 4 // 5, :width * 4 // 5]]
    segmenters = [cairn.Segmenter(rig, preset=preset, exec=cairn.Exec(options.threads),
                                  match={"num_disparities": DISPARITIES}) for preset in ("default", "paper")]

    def step(k, pair):
        left, right = (np.ascontiguousarray(image[sizes[k % 3]]) for image in pair)
        segmenters[k % 2].segment(left, right)

    return in_process("segmenter", pairs, options.frames, step,
                      lambda: sum(segmenter.exec.heap_allocations for segmenter in segmenters))


def soak_follower(pairs, rig, options):
    follower = cairn.Follower(rig, exec=cairn.Exec(options.threads), match={"num_disparities": DISPARITIES})
    return in_process("follower", pairs, options.frames, lambda k, pair: follower.next(*pair, seconds=0.2 * k))


def soak_live(pairs, rig, options):
    with tempfile.TemporaryDirectory() as work:
        for k, pair in enumerate(pairs):
            folder = Path(work, f"{k:04}")
            folder.mkdir()
            for side, image in zip(("left", "right"), pair):
                cairn.save_png(folder / f"{side}.png", image)
        height, width = pairs[0][0].shape[:2]
        Path(work, "0000/calib.txt").write_text(
            f"fx={rig.focal_px}\nfy={rig.focal_px}\ncx={rig.cx_px}\ncy={rig.cy_px}\nbaseline={rig.baseline_m}\n"
            f"width={width}\nheight={height}\nndisp={DISPARITIES}\n")
        command = [options.cairn, "live", work, "--loop", "--pace", "0", "--every-frame", "--rate", "5", "--json-lines",
                   "--threads", str(options.threads)]
        log = Log("live", options.frames)
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as live:
            seen, before = 0, time.perf_counter()
            for line in live.stdout:
                if "frame" not in json.loads(line):
                    continue
                now = time.perf_counter()
                log.frame(1000 * (now - before), lambda: resident_mb(live.pid))
                seen, before = seen + 1, now
                if seen == options.frames:
                    break
            live.send_signal(signal.SIGTERM)
            live.stdout.close()
            said = live.stderr.read().decode()
        print(said.strip())
        if seen < options.frames:
            print(f"live: ended after {seen} frames")
            return False
        return log.is_fine()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=Path)
    parser.add_argument("--frames", type=int, default=100_000)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--cairn", help="the command; without it, live is skipped")
    parser.add_argument("--shrink", type=int, default=2, help="use every n-th pixel of the tour's 320x240 (default: 2)")
    parser.add_argument("--only", choices=["segmenter", "follower", "live"])
    options = parser.parse_args()
    if options.frames < 100 * POINTS:
        sys.exit(f"soak.py: --frames {options.frames}: expected at least {100 * POINTS}")
    folders = sorted(p.parent for p in (options.data / "rendered/tour_train").glob("*/left.png"))
    if not folders:
        sys.exit(f"soak.py: {options.data}: no rendered/tour_train in it")
    pairs = to_and_fro([tuple(np.ascontiguousarray(image[::options.shrink, ::options.shrink]) for image in
                              cairn.load_pair(f / "left.png", f / "right.png")) for f in folders])
    whole = cairn.load_calibration(folders[0] / "calib.txt").rig
    rig = cairn.Rig(whole.focal_px / options.shrink, whole.baseline_m, whole.cx_px / options.shrink,
                    whole.cy_px / options.shrink)

    parts = {"segmenter": soak_segmenter, "follower": soak_follower}
    if options.cairn:
        parts["live"] = soak_live
    if options.only:
        if options.only not in parts:
            sys.exit("soak.py: --only live: needs --cairn PROGRAM")
        parts = {options.only: parts[options.only]}
    print(f"{os.cpu_count()} processors, {options.threads} threads, images of {pairs[0][0].shape[1]}x{pairs[0][0].shape[0]}")
    fine = [soak(pairs, rig, options) for soak in parts.values()]
    sys.exit(0 if all(fine) else 1)


main()
