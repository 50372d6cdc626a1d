# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Tables and plots of docs/accuracy.md and BENCHMARK.md."""
import math
import os
import pathlib

import matplotlib

matplotlib.use("agg")
matplotlib.rcParams.update({"font.family": "sans-serif", "font.size": 8})
import matplotlib.pyplot as plt  # noqa: E402


def number(value, form=".1f"):
    """The number as text, or a dash for NaN."""
    return "–" if math.isnan(value) else format(value, form)


def percent(share):
    return number(100 * share)


def table(header, rows, words=1):
    """A Markdown table: the first columns, words, are left-aligned, the others, numbers, right-aligned."""
    line = lambda cells: "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"
    rule = "|" + "---|" * words + "---:|" * (len(header) - words) + "\n"
    return line(header) + rule + "".join(line(row) for row in rows)


def axis_end(most):
    """The smallest of 1, 2, 5, 10, 20, 50 … that is not below `most`: a round end for an axis."""
    if not most > 0:
        return 1
    power = 10 ** math.floor(math.log10(most))
    return next(step * power for step in (1, 2, 5, 10) if most <= step * power * (1 + 1e-9))


def plot(path, x, panels, x_title, ticks=None, lines=True, dots=True):
    """Panels side by side with a common x axis. panels: (title, end of the y axis or None, {name: (colour, values)});
    NaN interrupts a line. ticks: {x: label}. lines=False: x are categories, without lines between them."""
    figure, axes = plt.subplots(1, len(panels), figsize=(2.6 * len(panels), 2.4), squeeze=False)
    for axis, (title, end, series) in zip(axes[0], panels):
        for name, (colour, values) in series.items():
            axis.plot(x, values, color=colour, label=name, linestyle="-" if lines else "none", marker="o" if dots else None, markersize=3)
        known = [v for _, values in series.values() for v in values if not math.isnan(v)]
        axis.set(title=title, xlabel=x_title, ylim=(0, end or axis_end(max(known, default=0))))
        axis.grid(axis="y", color="#dddddd")
        if ticks:
            axis.set_xticks(list(ticks), list(ticks.values()))
        if not lines:
            axis.margins(x=0.5 / len(x))
    axes[0][0].legend(frameon=False)
    figure.tight_layout()
    figure.savefig(path, dpi=150, metadata={"Software": None})  # the same bytes in each run
    plt.close(figure)


def write(path, text):
    """Writes the whole file or leaves it unchanged."""
    unfinished = pathlib.Path(f"{path}.unfinished")
    unfinished.write_text(text, encoding="utf-8")
    os.replace(unfinished, path)


def processor():
    lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
    return next((line.split(": ", 1)[1] for line in lines if line.startswith("model name")), "unknown processor")
