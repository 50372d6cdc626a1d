#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""shown_code_runs.py SOURCE_DIR BUILD_DIR COMPILER: runs the code shown on the pages.

A fenced block of a page is
  sh      run by bash, block after block, in one folder per page
  python  run by this interpreter, all blocks of a page together, in the folder of the built module
  cpp     declarations of the library, which must match the headers word for word
unless the line before it is one of:
  <!-- code: ... -->, <!-- output: ... -->   generated; docs/update.sh --check compares it
  <!-- not run: WHY -->                      skipped
The examples in the commands' help are run, too.
The folder holds left.png, right.png and calib.txt of a sample, frames/ with all samples, and truth/, a copy of it. A page
that mentions boards/ gets OpenCV's checkerboards there, and the first of them as left.png and right.png; without
Debian's opencv-doc its blocks are skipped.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

GENERATED = re.compile(r"<!-- (code|output): .* -->")
NOT_RUN = re.compile(r"<!-- not run: \S.* -->")


class Block:
    def __init__(self, page, line, language, before):
        self.page, self.line, self.language, self.before = page, line, language, before
        self.text = ""

    @property
    def place(self):
        return f"{self.page}:{self.line}"

    @property
    def is_checked_here(self):
        return not (GENERATED.fullmatch(self.before) or NOT_RUN.fullmatch(self.before))


def blocks_of(page):
    block, before = None, ""
    for number, line in enumerate(page.read_text().splitlines(), 1):
        fence = re.fullmatch(r"\s*```(\w*)", line)
        if fence and block is None:
            block = Block(page, number, fence[1], before.strip())
        elif fence:
            yield block
            block = None
        elif block is not None:
            block.text += line + "\n"
        before = line


def pages(source):
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard", "*.md"], cwd=source,
                            capture_output=True, text=True)
    found = listed.stdout.split() if listed.returncode == 0 else [
        p for p in map(str, source.rglob("*.md")) if "/build/" not in p]
    return sorted(source / p for p in found if (source / p).exists())


BOARDS = Path("/usr/share/doc/opencv-doc/examples/data")


def raw_scene(folder):
    (folder / "boards").mkdir()
    for file in [*BOARDS.glob("left[0-9]*.jpg"), *BOARDS.glob("right[0-9]*.jpg")]:
        shutil.copy(file, folder / "boards")
    for side in ("left", "right"):  # the format is detected from the content, not the name
        shutil.copy(BOARDS / f"{side}01.jpg", folder / f"{side}.png")


def scene(source, folder):
    for name in ("left.png", "right.png", "calib.txt"):
        shutil.copy(source / "data/samples/four_in_a_row" / name, folder)
    for name in ("frames", "truth"):
        shutil.copytree(source / "data" / "samples", folder / name)
    (folder / "data").symlink_to(source / "data")
    shutil.copytree(source / "data/sequences/rolling_ball", folder / "sequence")


def failure(block, run):
    return f"{block.place}: exit {run.returncode}\n{block.text}\n{run.stdout}{run.stderr}" if run.returncode else None


def run_shell(block, folder, environment):
    return failure(block, subprocess.run(["bash", "-euo", "pipefail", "-c", block.text], cwd=folder, env=environment,
                                         stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=120))


def run_python(blocks, folder, environment):
    whole = blocks[0]
    whole.text = "\n".join(block.text for block in blocks)
    return failure(whole, subprocess.run([sys.executable, "-c", whole.text], cwd=folder, env=environment,
                                         capture_output=True, text=True, timeout=120))


def check_declarations(blocks, compiler, source):
    """The compiler reports a repeated declaration as redundant; one that differs is not reported. Several blocks are
    compiled at once, and one by one if that is not right."""
    text = "".join(block.text for block in blocks)
    code = "#include <cairn/cairn.hpp>\n" + "".join(
        f"#include <{name}>\n" for name in re.findall(r"//.*?(cairn/\w+(?:/\w+)*\.hpp)", text))
    code += "".join(f"namespace cairn {{\n{block.text}}}\n" for block in blocks)
    run = subprocess.run([compiler, "-std=c++20", "-fsyntax-only", "-Wredundant-decls", f"-I{source}", "-xc++", "-"],
                         input=code, capture_output=True, text=True, env={**os.environ, "LC_ALL": "C"})
    known = len(re.findall(r"redundant redeclaration of", run.stderr))
    shown = [len(re.sub(r"//.*", "", block.text).split(";")) - 1 for block in blocks]
    if run.returncode == 0 and all(shown) and known == sum(shown):
        return []
    if len(blocks) > 1:
        return [failure for block in blocks for failure in check_declarations([block], compiler, source)]
    return [f"{block.place}: {shown[0]} declarations shown, {known} of them in the headers\n{block.text}\n{run.stderr}"
            for block in blocks]


def run_examples(build, source, environment):
    """Runs the lines below "Examples:" of every command's help, in order, in one folder."""
    text = subprocess.run([build / "cairn", "--help"], capture_output=True, text=True).stdout
    names = re.findall(r"^  (\w+) ", text[text.index("Subcommands:"):], re.M)
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        scene(source, folder)
        for name in names:
            help_text = subprocess.run([build / "cairn", "help", name], capture_output=True, text=True).stdout
            lines = re.findall(r"^  (cairn .*)$", help_text[help_text.index("Examples:"):], re.M)
            for number, line in enumerate(lines, 1):
                # Run on pages instead: boards/ may be missing, bench is slow, and a map needs a sequence
                # (map_test.cpp).
                if name in ("calibrate", "rectify", "bench", "map"):
                    continue
                block = Block(f"cairn help {name}", number, "sh", "")
                block.text = line + "\n"
                yield run_shell(block, folder, environment)


def main(source, build, compiler):
    environment = {**os.environ, "PATH": f"{build}:{os.environ['PATH']}", "PYTHONPATH": f"{build}/python"}
    has_module = any((build / "python/cairn").glob("*.so"))
    failures, counts = [], {"sh": 0, "python": 0, "cpp": 0}
    declarations = []
    for page in pages(source):
        checked = [b for b in blocks_of(page) if b.is_checked_here and b.language in counts]
        python = [b for b in checked if b.language == "python"] if has_module else []
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch)
            if any("boards/" in b.text for b in checked):
                if not (BOARDS / "left01.jpg").exists():
                    print(f"{page}: not run: no {BOARDS}")
                    continue
                raw_scene(folder)
            elif any(b.language != "cpp" for b in checked):
                scene(source, folder)
            results = [run_shell(b, folder, environment) for b in checked if b.language == "sh"]
            results += [run_python(python, folder, environment)] if python else []
        failures += [r for r in results if r]
        declarations += [b for b in checked if b.language == "cpp"]
        for block in checked:
            counts[block.language] += block.language != "python" or has_module
    failures += check_declarations(declarations, compiler, source)
    failures += [r for r in run_examples(build, source, environment) if r]
    print("\n".join(failures))
    print(", ".join(f"{n} blocks of {language}" for language, n in counts.items()),
          "" if has_module else "(the Python module is not built)")
    return 1 if failures or not counts["sh"] or not counts["cpp"] else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), sys.argv[3]))
