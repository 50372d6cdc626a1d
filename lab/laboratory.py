#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Prints the tables of the paper's experiment made again, for docs/paper.md: laboratory.py CAIRN FOLDER

FOLDER: the four sequences of `./dev worlds laboratory`. The frame that stands for a sequence is the one whose mean error
over its objects is the median of the sequence (the lower one of two), for each preset by itself: the rule was fixed
before any frame was looked at. A missed object counts 200 %, the evaluation's limit.
"""
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

LARGEST = 2.0
OBJECTS = {1: "blue", 2: "yellow", 3: "red"}
IMAGES = "abcd"


def errors(cairn, sequence, preset, work):
    """For each frame the errors E by the id of the object."""
    result, scores = work / preset / sequence.name, work / f"{preset}_{sequence.name}.json"
    run = lambda *command: subprocess.run([cairn, *map(str, command)], check=True, stdout=subprocess.DEVNULL)
    run("segment", sequence, "--preset", preset, "-o", result)
    run("evaluate", result, sequence, "--json", scores)
    return [{o["id"]: min(1 / max(o["iou"], 1e-9) - 1, LARGEST) for o in frame["objects"]["true"]}
            for frame in json.loads(scores.read_text())["frames"]]


def cell(error):
    return "–" if error is None else "miss" if error >= LARGEST else f"{100 * error:.1f}"


def main():
    cairn, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    sequences = sorted(p for p in folder.iterdir() if p.is_dir())
    with tempfile.TemporaryDirectory() as work:
        for preset in ("paper", "default"):
            print(f"| E, %, `{preset}` | " + " | ".join(f"{name} object" for name in OBJECTS.values()) +
                  " | mean of 200 frames | median |\n|---|" + "---:|" * (len(OBJECTS) + 2))
            everything = []
            for image, sequence in zip(IMAGES, sequences):
                frames = errors(cairn, sequence, preset, pathlib.Path(work))
                means = [np.mean(list(frame.values())) for frame in frames]
                middle = int(np.argsort(means, kind="stable")[(len(means) - 1) // 2])
                all_of = [e for frame in frames for e in frame.values()]
                everything += all_of
                print(f"| image {image} (frame {middle}) | " + " | ".join(cell(frames[middle].get(i)) for i in OBJECTS) +
                      f" | {100 * np.mean(all_of):.1f} | {100 * np.median(all_of):.1f} |")
            found = sum(e <= 1 for e in everything)
            print(f"\nAll {len(everything)} objects: mean {100 * np.mean(everything):.1f} %, median "
                  f"{100 * np.median(everything):.1f} %, {100 * found / len(everything):.1f} % with IoU ≥ 0.5.\n")


if __name__ == "__main__":
    main()
