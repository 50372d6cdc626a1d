#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Compares two builds of the command on one pair: the time ratio of each stage, second to first.

    against.py FIRST SECOND [--rounds N] [FOLDER] [OPTIONS]

FIRST and SECOND are programs called cairn. FOLDER holds left.png, right.png and optionally calib.txt; default: a sample.
OPTIONS go to both. A round runs a few frames of each program; the order alternates between rounds, and ratios are taken
within a round, so that a change of the machine's load affects both alike. Times are the processor times of `cairn bench`
on one thread unless OPTIONS say otherwise. If one of the programs is too old to have `bench`, they are the wall times
that `cairn segment` reports.
"""
import collections
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

FRAMES = 5  # of each program in a round
SAMPLE = pathlib.Path(__file__).resolve().parent.parent / "data" / "samples" / "four_in_a_row"


def refuse(why):
    print(f"against: {why}", file=sys.stderr)
    sys.exit(2)


def run(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], stdout=subprocess.PIPE, text=True)
    return done.stdout if done.returncode == 0 else refuse(f"{program}: failed")


def knows_bench(program):
    try:
        return subprocess.run([program, "bench", "--help"], capture_output=True).returncode == 0
    except OSError:
        refuse(f"{program}: cannot be run")


def times_of_bench(program, folder, options, scratch):
    """Milliseconds of each stage in pipeline order, the whole frame last."""
    run(program, "bench", folder, "--no-opencv", "--frames", FRAMES, "--json", scratch / "bench.json", *options)
    found = json.loads((scratch / "bench.json").read_text())
    return {**{stage["name"]: stage["cpu_ms"]["median"] for stage in found["stages"]}, "frame": found["frame"]["cpu_ms"]["median"]}


def times_of_segment(program, folder, options, scratch):
    """Times over a folder with several copies of the pair; the first frame fills the pool and is not counted."""
    frames = scratch / "frames"
    frames.mkdir(exist_ok=True)
    for i in range(FRAMES + 1):
        if not (frames / str(i)).exists():
            (frames / str(i)).symlink_to(folder.resolve(), target_is_directory=True)
    text, decoder, stages = run(program, "segment", frames, "--json", *options), json.JSONDecoder(), collections.defaultdict(list)
    for i in range(FRAMES + 1):
        frame, end = decoder.raw_decode(text.lstrip())
        text = text.lstrip()[end:]
        for stage, ms in {**frame["timings_ms"], "frame": sum(frame["timings_ms"].values())}.items():
            if i > 0:
                stages[stage].append(ms)
    return {stage: np.median(ms) for stage, ms in stages.items()}


def main():
    words = sys.argv[1:]
    if len(words) < 2:
        sys.exit(__doc__)
    programs, words, rounds, folder = words[:2], words[2:], 15, SAMPLE
    if words[:1] == ["--rounds"]:
        if not (len(words) > 1 and words[1].isdigit() and int(words[1]) > 0):
            refuse("--rounds: expected a positive number")
        rounds, words = int(words[1]), words[2:]
    if words and not words[0].startswith("-"):
        folder, words = pathlib.Path(words[0]), words[1:]
    options = words if "--threads" in words else [*words, "--threads", "1"]
    by_bench = all(map(knows_bench, programs))
    times_of = times_of_bench if by_bench else times_of_segment
    found = [[], []]
    with tempfile.TemporaryDirectory() as scratch:
        for i in range(rounds):
            for which in (i % 2, 1 - i % 2):
                found[which].append(times_of(programs[which], folder, options, pathlib.Path(scratch)))
    print(f"{'processor time' if by_bench else 'wall time':22} {'first ms':>12} {'second ms':>12} {'ratio':>8}   middle half of the rounds")
    stages = dict.fromkeys([*found[0][0], *found[1][0]])
    for stage in [*(s for s in stages if s != "frame"), "frame"]:
        first, second = (np.array([times.get(stage, np.nan) for times in of]) for of in found)
        with np.errstate(divide="ignore", invalid="ignore"):  # a stage's time may be below the clock's resolution
            low, middle, high = np.quantile(second / first, [0.25, 0.5, 0.75], method="inverted_cdf")
        print(f"{stage:22} {np.median(first):12.3f} {np.median(second):12.3f} {middle:8.3f}   {low:.3f} ... {high:.3f}")
    print(f"The median of {rounds} rounds of {FRAMES} frames each; ratio: second to first, below 1: the second is faster.")


if __name__ == "__main__":
    main()
