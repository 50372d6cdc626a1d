#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Writes a job list for the generator of rendered rooms: cluttered scenes that objects fill, seen by a narrow lens.

cluttered_rooms.py GENERATOR JOBS.json FIRST LAST
GENERATOR is the folder with rooms.py; scene i of FIRST … LAST - 1 is derived from its room i. The list is rendered
like any list of rooms.py, and `./dev fit` uses the frames together with the other rooms.
"""
import argparse
import json
import math
import pathlib
import sys

import numpy as np


LYING = ("cylinder", "bottle", "barrel", "bucket", "bin", "suitcase", "cone", "crate")


def cluttered(rooms, i):
    room = rooms.scene2(f"clutter_s{i:02d}", 40000 + 29 * i, rooms.TRAIN, i, hard=(0, 0.5, 1)[i % 3])
    random = np.random.default_rng([i, 5])
    half_view = math.radians(random.uniform(13, 26))
    fx = 160 / math.tan(half_view)
    distance = random.uniform(0.7, 2.2)  # to the middle of the objects
    across = 2 * distance * math.tan(half_view)  # width of the field of view there, m
    pitch = math.radians(random.uniform(8, 32))
    height = distance * math.sin(pitch) + random.uniform(0.12, 0.3) * across
    near, far = distance * random.uniform(0.7, 0.8), distance * random.uniform(1.25, 1.6)
    # The nearest object has 25 to 60 px of disparity.
    baseline = random.uniform(25, 60) * near / fx
    count = int(random.integers(5, 12))
    standing = [kind for kind in rooms.TRAIN["kinds"] if kind not in rooms.THIN and kind != "balloons"]
    objects = []
    for j in range(count):
        kind = str(random.choice(standing if j < 2 or random.random() < 0.8 else rooms.TRAIN["kinds"]))
        mode, ref = "free", None
        if j:
            mode = str(random.choice(["free", "touch", "behind", "edge"], p=[0.35, 0.4, 0.2, 0.05]))
            if j < 4 and objects[0]["kind"] in rooms.FLATTOP and random.random() < 0.35:
                mode = "on"
            ref = 0 if mode == "on" else int(random.integers(0, j)) if mode in ("touch", "behind") else None
        if random.random() < 0.6:
            style = str(random.choice(rooms.TRAIN["textures"]))
        else:
            style = "plain" if random.random() < 0.7 else "poor"
        size = across * random.uniform(0.4, 0.85) * math.sqrt(6 / count)
        size *= (1.6 if kind in rooms.SMALL else 1.0) * (0.6 if mode == "on" else 1.0)
        thing = dict(kind=kind, color=str(random.choice(rooms.COLORS)), style=style, scale=round(float(size), 4),
                     mode=mode)
        if ref is not None:
            thing["ref"] = ref
        finish = [None, None, "glossy", "matte"][int(random.integers(4))]
        if finish:
            thing["finish"] = finish
        if mode == "free" and kind in LYING and random.random() < 0.3:
            thing["lying"] = True
        objects.append(thing)
    depth = float(random.uniform(4, 5))  # of the room
    place = depth - far - random.uniform(0.15, 0.9) * across  # of the camera: a wall is close behind the objects
    aside = random.uniform(-0.2, 0.2)
    for other in ("table", "back_window", "marks"):
        room.pop(other, None)
    room.update(view="clutter", arrangement="clutter", objects=objects, fx=fx, baseline=round(float(baseline), 4),
                zmin=near * 0.7, range=[near, far], room=[2.2, depth],
                attach=["poster"] * int(random.integers(0, 4)) + ["outlet"],
                path=[[aside, float(place), float(height), float(random.uniform(-0.15, 0.15)), float(pitch)]])
    for lamp in room["lights"]:
        lamp.update(x=float(random.uniform(-0.8, 0.8)), y=float(place + random.uniform(-1.0, 0.8) * far))
    return room


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("generator", type=pathlib.Path, help="the folder with rooms.py")
    parser.add_argument("jobs", type=pathlib.Path, help="output file")
    parser.add_argument("first", type=int)
    parser.add_argument("last", type=int, help="end of the range, exclusive")
    arguments = parser.parse_args()
    sys.path.insert(0, str(arguments.generator))
    import rooms

    scenes = [cluttered(rooms, i) for i in range(arguments.first, arguments.last)]
    arguments.jobs.write_text(json.dumps(
        [dict(id=f"train/{scene['name']}", scene=scene, W=320, H=240, spp=16) for scene in scenes]))


if __name__ == "__main__":
    main()
