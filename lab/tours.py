#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Follows tours of worlds with a map and scores them together: tours.py CAIRN TOURS OUT [--no-wheels] [ARGS OF cairn follow]

TOURS: folders that `./dev worlds tours` wrote. Prints one line per tour and the sums: carried objects reported as moved, wrong
changes, landmarks seen again and recognised, and the tracks' positions. Wheels (odometry.csv) are used unless --no-wheels.
"""
import json
import math
import multiprocessing
import pathlib
import statistics
import subprocess
import sys

from report import number, percent, table


def scores_of(job):
    cairn, tour, out, wheels, more = job
    run = out / tour.name
    run.mkdir(parents=True, exist_ok=True)
    (run / "map.db").unlink(missing_ok=True)
    odometry = ["--odometry", tour / "odometry.csv"] if wheels else []
    follow = [cairn, "follow", tour, "-o", run, "--map", run / "map.db", "--threads", "1", *odometry, *more]
    subprocess.run(follow, check=True, stdout=subprocess.DEVNULL)
    scores = run / "scores.json"
    subprocess.run([cairn, "evaluate", run, tour, "--sequence", "--json", scores], check=True, stdout=subprocess.DEVNULL)
    return tour.name, json.loads(scores.read_text())["summary"]


def total(scores, part, key):
    return sum(s[part][key] for s in scores)


def main():
    cairn, tours, out, *more = sys.argv[1:]
    wheels = "--no-wheels" not in more
    more = [m for m in more if m != "--no-wheels"]
    folders = sorted(p for p in pathlib.Path(tours).iterdir() if (p / "events.json").exists())
    with multiprocessing.Pool() as pool:
        named = pool.map(scores_of, [(cairn, t, pathlib.Path(out), wheels, more) for t in folders], chunksize=1)
    rows = []
    for name, s in named:
        changes, again = s["changes"], s["landmarks"]
        rows.append([name, f"{changes['found']} of {changes['expected']}", str(changes["wrong"]),
                     f"{again['re_identified']} of {again['in_view_again']}", str(again["wrong"]),
                     number(100 * s["tracks"]["IDF1"], ".0f"), number(s["trajectory"]["end_error_m"] if s["trajectory"] else math.nan, ".2f")])
    print(table(["tour", "moved", "wrong changes", "recognised", "mistaken", "IDF1", "end, m"], rows))
    scores = [s for _, s in named]
    expected, again = total(scores, "changes", "expected"), total(scores, "landmarks", "in_view_again")
    errors = [s["changes"]["median_error_m"] for s in scores if s["changes"]["median_error_m"] is not None]
    known = sum(s["positions"]["with_covariance"] for s in scores)
    inside = sum((s["positions"]["inside_95"] or 0) * s["positions"]["with_covariance"] for s in scores)
    print(f"""
carried objects reported as moved: {total(scores, 'changes', 'found')} of {expected}, median error {number(statistics.median(errors or [math.nan]), '.2f')} m
wrong changes: {total(scores, 'changes', 'wrong')}, per landmark seen again {percent(total(scores, 'changes', 'wrong') / max(again, 1))} %
recognised: {total(scores, 'landmarks', 're_identified')} of {again}; mistaken: {total(scores, 'landmarks', 'wrong')}
positions within the stated 95 % ellipsoid: {percent(inside / max(known, 1))} %; median of the tours' 95 % of errors {number(statistics.median([s['positions']['in_map']['p95_m'] for s in scores if s['positions']['in_map']['p95_m']] or [math.nan]), '.2f')} m
IDF1 in the mean {number(100 * statistics.mean(s['tracks']['IDF1'] for s in scores))}, HOTA {number(100 * statistics.mean(s['tracks']['HOTA'] for s in scores))}""")


if __name__ == "__main__":
    main()
