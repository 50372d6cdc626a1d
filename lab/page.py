#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Writes ROOT/BENCHMARK.md and its plots: page.py CAIRN ROOT COMMIT [ENGINES]

Times of the stages at three sizes, on one and on all threads, and their growth with pixels and with disparities,
measured by `cairn bench` on a synthetic pair. ENGINES: a file with the output of the program engines.
"""
import datetime
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

from report import number, percent, plot, table, write

EXTENTS = [((320, 240), 64), ((640, 480), 64), ((1280, 720), 128)]
PRESETS = ["default", "paper"]
PARTS = {"frame": "#1f77b4", "disparity": "#d62728", "match": "#2ca02c"}


def measured(cairn, size, disparities, preset, threads, seconds):
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "bench.json"
        subprocess.run([cairn, "bench", "--size", "x".join(map(str, size)), "--preset", preset, "--set", f"match.num_disparities={disparities}",
                        "--threads", str(threads), "--seconds", str(seconds), "--no-opencv", "--json", file], check=True, stdout=subprocess.DEVNULL)
        return json.loads(file.read_text())


def stage_table(cairn, preset):
    columns = {f"{size[0]}x{size[1]}x{n}, {t} thread{'s' * (t > 1)}": measured(cairn, size, n, preset, t, 3)
               for size, n in EXTENTS for t in sorted({1, os.cpu_count()})}
    of = list(columns.values())
    ms = lambda value: format(value, ".2f")
    rows = [[f"`{stage['name']}`", *(ms(b["stages"][i]["wall_ms"]["median"]) for b in of)] for i, stage in enumerate(of[0]["stages"])]
    for title, cell in {
            "**frame**, median": lambda b: f"**{ms(b['frame']['wall_ms']['median'])}**",
            "of which disparity": lambda b: ms(b["disparity"]["wall_ms"]["median"]),
            "frame, p99": lambda b: ms(b["frame"]["wall_ms"]["p99"]),
            "frame, processor time": lambda b: ms(b["frame"]["cpu_ms"]["median"]),
            "frames per second": lambda b: f"{b['frames_per_second']:.1f}",
            "peak image memory, MB": lambda b: f"{1e-6 * b['memory']['pool_bytes']:.1f}",
            "image buffers allocated after the first frame": lambda b: str(b["memory"]["later_allocations"]),
            "frames measured": lambda b: str(b["frames"])}.items():
        rows.append([title, *map(cell, of)])
    return f"### Preset `{preset}`\n\n{table(['ms', *columns], rows)}\n", of[0]["machine"]


def point(bench):
    """Processor time of one thread, ms."""
    match = next(stage for stage in bench["stages"] if stage["name"] == "match")
    return {"frame": bench["frame"]["cpu_ms"]["median"], "disparity": bench["disparity"]["cpu_ms"]["median"], "match": match["cpu_ms"]["median"]}


def straight_line(x, y):
    """Slope, intercept and the largest deviation of a least-squares fit of the relative residuals."""
    x, y = np.array(x), np.array(y)
    (slope, at_zero), *_ = np.linalg.lstsq(np.stack([x, np.ones_like(x)], 1) / y[:, None], np.ones_like(y), rcond=None)
    return slope, at_zero, np.max(np.abs(at_zero + slope * x - y) / y)


def growth(cairn, title, file, axis, extents, x_of):
    """`axis`: title of x, name of its unit, and its size, format of x in the table."""
    x_title, unit, unit_x, form = axis
    x = [float(x_of(*extent)) for extent in extents]
    points = {p: [point(measured(cairn, *extent, p, 1, 1.5)) for extent in extents] for p in PRESETS}
    lines = {(p, part): straight_line(x, [of[part] for of in points[p]]) for p in PRESETS for part in PARTS}
    plot(file, x, [(f"preset {p}, ms of one core", None, {part: (colour, [of[part] for of in points[p]]) for part, colour in PARTS.items()})
                      for p in PRESETS], x_title)
    fits = [[p, part, number(slope * unit_x, ".2f"), number(at_zero, ".2f"), percent(off)] for (p, part), (slope, at_zero, off) in lines.items()]
    rows = [[format(value, form), *(f"{points[p][i][part]:.2f}" for p in PRESETS for part in PARTS)] for i, value in enumerate(x)]
    return f"""### {title}

![{title}](docs/images/benchmark/{file.name})

{table(["preset", "of", f"ms per {unit}", "constant ms", "largest deviation, %"], fits, words=2)}
{table([x_title.split(",")[0], *(f"{p}: {part}" for p in PRESETS for part in PARTS)], rows)}
"""


ARM64 = """## 64-bit ARM

Instructions of the second frame of the generated pair, 320x240 with 64 disparities, one thread, preset `default`, as QEMU counts them (`./dev bench arm64`). They say how much work a stage is with vectors of 16 bytes; how fast a board does it, they do not. Stages of fewer than a million are left out.

"""


def main():
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    cairn, root, commit = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
    start, plots = time.monotonic(), root / "docs" / "images" / "benchmark"
    plots.mkdir(parents=True, exist_ok=True)
    tables, machine = zip(*(stage_table(cairn, preset) for preset in PRESETS))
    sizes = [((w, h), 64) for w, h in ((320, 240), (480, 360), (640, 480), (800, 600), (960, 720), (1280, 960))]
    pixels = growth(cairn, "Time against pixels", plots / "pixels.png", ("megapixels, 64 disparities", "megapixel", 1, ".2f"), sizes,
                    lambda size, n: 1e-6 * size[0] * size[1])
    ranges = [((640, 480), n) for n in range(32, 257, 32)]
    disparities = growth(cairn, "Time against disparities", plots / "disparities.png", ("disparities, 640x480", "64 disparities", 64, ".0f"), ranges,
                         lambda size, n: n)
    engines = "Not measured in this run: it needs OpenCV's calib3d and the data collection.\n"
    if len(sys.argv) == 5:
        engines = ("The output of `./dev bench engines`: ours and theirs interleaved in one process, on real images, one thread each unless "
                   "stated otherwise; the ratio is theirs to ours, of the minimum times.\n\n" + pathlib.Path(sys.argv[4]).read_text())
    arm64 = root / "lab" / "arm64_counts.md"
    write(root / "BENCHMARK.md", f"""# Benchmark

<!-- Written by ./dev bench; do not edit. -->

Measured on {datetime.datetime.now(datetime.timezone.utc):%Y-%m-%d} at commit {commit}, on {machine[0]["processor"]} with {os.cpu_count()} processors (kernels: {machine[0]["target"]}), compiled with {machine[0]["compiler"]}.
This page reports the time of each stage, its growth with the image size, and a comparison with OpenCV. `./dev bench` measures everything again and writes this page and its plots. It needs an otherwise idle machine.

## Stages

Wall-clock times on the pair that `cairn bench` generates: the median over the frames after a first warm-up frame, for each size with its number of disparities. The generated room has fewer and larger regions than many photographs, on which the grouping stages take longer; the time of matching depends only on the size. With several threads, some stages run at the same time as others and show only the time waited for them (`cut_superpixels`, `estimate_confidence`, `segment_intensity`).

{"".join(tables)}## Growth

Median processor time on one thread, and the straight line (constant ms + ms per unit) that minimises the relative residuals. The generated scene uses three quarters of each disparity range. Matching processes whole vectors of disparities, so its time grows in steps.

{pixels}{disparities}## Comparison with OpenCV

{engines}
{ARM64}{arm64.read_text()}""")
    print(f"wrote BENCHMARK.md and its plots in {time.monotonic() - start:.0f} s")


if __name__ == "__main__":
    main()
