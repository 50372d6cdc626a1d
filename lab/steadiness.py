#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Measures how well the steadiness of a sequence's objects ranks wrong settings by their true error.

usage: steadiness.py [--control] CAIRN SEQUENCE...   (folders of frames with objects.png)

Each sequence is played back and forth until it has 200 frames. Prints means of the last 100 frames: E and steadiness of
each setting, their rank correlation, and how many of the pairs of settings that differ by more than 0.05 in E are
ordered correctly by steadiness.

--control: instead measures how much of the error of each wrong setting control.method=tune repairs, (E wrong - E tuned)
/ (E wrong - E of the preset) over the same frames, and what it costs the preset.
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
LOSS = 0.02
WRONG = {
    "match.num_disparities=8": [],
    "superpixels.count=40": [],
    "ground.source=off": [],
    "objects.min_area=3": [],
    "ground.margin=30": [],
    "speckle.size=20000": [],
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
    events = [json.loads(line) for line in (out / "events.jsonl").read_text().splitlines()]
    changes = [f"{e['option']}={e['to']} at {e['frame']}" for e in events if e["kind"] == "option_set"]
    return error, steady, changes


def ranks(values):
    return [sum(v < x for v in values) + (sum(v == x for v in values) - 1) / 2 for x in values]


def report_control(settings, names, found):
    print("| wrong setting | sequence | E of the preset | wrong | tuned | repaired | changes |")
    print("|---|---|---|---|---|---|---|")
    repaired, harm = [], []
    for wrong in settings:
        for name in names:
            preset, given = found[name, "none", "off"][0], found[name, wrong, "off"][0]
            tuned, _, changes = found[name, wrong, "tune"]
            share = "-"
            if wrong == "none" or given - preset <= LOSS:
                harm.append(tuned - given)
            else:
                repaired.append((given - tuned) / (given - preset))
                share = "%.2f" % repaired[-1]
            print(f"| {wrong} | {name} | {100 * preset:.1f} % | {100 * given:.1f} % | {100 * tuned:.1f} % | {share} | "
                  f"{', '.join(changes) or 'none'} |")
    if repaired:
        print(f"median repaired share of {len(repaired)} cases that cost more than {100 * LOSS:.0f} points: "
              f"{statistics.median(repaired):.2f}, {sum(r >= 0.6 for r in repaired)} of them 0.6 or more")
    if harm:
        print(f"the other {len(harm)}: E changes by {100 * min(harm):+.1f} to {100 * max(harm):+.1f} points")


def main():
    control = sys.argv[1] == "--control"
    cairn, *sequences = sys.argv[1 + control:]
    cairn = pathlib.Path(cairn).resolve()
    work = pathlib.Path(tempfile.mkdtemp())
    names = [pathlib.Path(sequence).name for sequence in sequences]
    for sequence, name in zip(sequences, names):
        looped(pathlib.Path(sequence), work / name)
    settings = {"none": [], **{first: [first, *more] for first, more in WRONG.items()}}
    jobs = [(name, wrong, method) for wrong in settings for name in names
            for method in (("off", "tune") if control else ("off",))]

    def measure(job):
        name, wrong, method = job
        return run(cairn, work / name, [*settings[wrong], f"control.method={method}"],
                   work / f"{name}_{list(settings).index(wrong)}_{method}")

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = dict(zip(jobs, pool.map(measure, jobs)))

    if control:
        report_control(settings, names, found)
        return
    found = {(name, wrong): values[:2] for (name, wrong, _), values in found.items()}
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
