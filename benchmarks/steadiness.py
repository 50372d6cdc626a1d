#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Measures how well the steadiness of a sequence's objects ranks wrong settings by their true error.

usage: steadiness.py CAIRN SEQUENCE...   (folders of frames with objects.png)

Each sequence is played back and forth until it has 200 frames. Prints means of the last 100 frames: E and steadiness of
each setting, their rank correlation, and how many of the pairs of settings that differ by more than 0.05 in E are
ordered correctly by steadiness.
"""
import itertools
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

FRAMES = 200
APART = 0.05
WRONG = {
    "match.num_disparities=8": [],
    "superpixels.count=40": [],
    "ground.source=off": [],
    "objects.min_area=3": [],
    "ground.margin=30": [],
    "speckle.size=20000": [],
    "evidence.gradient_min=60": [],
    "background.max_walls=0": [],
    "left_right.max_diff=0": [],
    "match.method=window": [],
    "semi_global.penalty_small=2.3": ["semi_global.penalty_large=2.3"],
    "objects.min_confidence=0.95": [],
}


def looped(sequence, folder):
    frames = sorted(path.parent.resolve() for path in sequence.glob("*/left.png"))
    order = frames[:]
    while len(order) < FRAMES:
        frames.reverse()
        order += frames[1:]
    folder.mkdir(parents=True)
    for number, frame in enumerate(order[:FRAMES]):
        os.symlink(frame, folder / f"{number:03d}")


def run(cairn, sequence, settings, out):
    command = [cairn, "follow", sequence, "--rate", "10", "--threads", "1", "-o", out]
    for setting in settings:
        command += ["--set", setting]
    subprocess.run([str(word) for word in command], capture_output=True, check=True)
    lines = (out / "tracks.jsonl").read_text().splitlines(keepends=True)[FRAMES // 2:]
    (out / "tracks.jsonl").write_text("".join(lines))
    score = out / "score.json"
    subprocess.run([cairn, "evaluate", out, sequence, "--sequence", "--json", score], capture_output=True, check=True)
    error = json.loads(score.read_text())["summary"]["objects"]["mean_error"]
    steady = statistics.mean(json.loads(line)["reliability"]["steadiness"] for line in lines)
    return error, steady


def ranks(values):
    return [sum(v < x for v in values) + (sum(v == x for v in values) - 1) / 2 for x in values]


def main():
    cairn, *sequences = sys.argv[1:]
    cairn = pathlib.Path(cairn).resolve()
    work = pathlib.Path(tempfile.mkdtemp())
    names = [pathlib.Path(sequence).name for sequence in sequences]
    for sequence, name in zip(sequences, names):
        looped(pathlib.Path(sequence), work / name)
    settings = {"none": [], **{first: [first, *more] for first, more in WRONG.items()}}
    jobs = [(name, wrong) for wrong in settings for name in names]

    def measure(job):
        name, wrong = job
        return run(cairn, work / name, settings[wrong], work / f"{name}_{list(settings).index(wrong)}")

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = dict(zip(jobs, pool.map(measure, jobs)))

    print(f"| wrong setting | {' | '.join(f'{n}: E, steadiness' for n in names)} |")
    print("|---" * (len(names) + 1) + "|")
    for wrong in settings:
        cells = ["%.1f %%, %.2f" % (100 * found[n, wrong][0], found[n, wrong][1]) for n in names]
        print(f"| {wrong} | {' | '.join(cells)} |")
    for name in names:
        both = [found[name, wrong] for wrong in settings]
        pairs = [(a, b) for a, b in itertools.combinations(both, 2) if abs(a[0] - b[0]) > APART]
        right = sum((a[0] < b[0]) == (a[1] > b[1]) for a, b in pairs)
        correlation = statistics.correlation(ranks([e for e, _ in both]), ranks([s for _, s in both]))
        print(f"{name}: rank correlation {correlation:.2f}, {right} of {len(pairs)} pairs ordered correctly")


if __name__ == "__main__":
    main()
