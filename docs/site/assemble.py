#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""assemble.py SOURCE_DIR PAGES_DIR [BUILD_DIR]: the pages of the repository as the site takes them.

Pages and pictures keep their places. A link to a source file leads to a page with its text, one to a folder without
a README to a list of its files. With BUILD_DIR, where the Python module is built, its reference is written, too.
"""
import importlib
import inspect
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

PICTURES = {".png", ".svg", ".jpg"}
LANGUAGES = {".hpp": "cpp", ".cpp": "cpp", ".py": "python", ".sh": "bash", ".json": "json", ".yml": "yaml",
             ".cmake": "cmake"}
LINK = re.compile(r'(\]\(|src=")([^)#"\s:]+)(#[^)"\s]*)?([)"])')


def git_files(source):
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=source, check=True,
                            capture_output=True, text=True)
    return [Path(name) for name in listed.stdout.splitlines() if (source / name).is_file()]


class Assembly:
    def __init__(self, source, pages):
        self.source, self.pages = source, pages
        self.files = git_files(source)
        self.made = set()

    def write(self, path, text):
        target = self.pages / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text)

    def page(self, path):
        in_code, lines = False, []
        for line in (self.source / path).read_text().splitlines():
            in_code ^= line.lstrip().startswith("```")
            lines.append(line if in_code else LINK.sub(lambda link: self.link(path, link), line))
        self.write(path, "\n".join(lines) + "\n")

    def link(self, page, link):
        start, target, heading, end = link[1], link[2], link[3] or "", link[4]
        path = Path(os.path.normpath(page.parent / target))
        if path.suffix == ".md" or path.suffix in PICTURES or not (self.source / path).exists():
            return link[0]
        made = self.folder(path) if (self.source / path).is_dir() else self.text(path)
        return f"{start}{os.path.relpath(made, page.parent)}{heading}{end}"

    def text(self, path):
        page = Path("source") / f"{path}.md"
        if page not in self.made:
            self.made.add(page)
            code = (self.source / path).read_text()
            fence = "````"
            self.write(page, f"# {path}\n\n{fence}{LANGUAGES.get(path.suffix, 'text')}\n{code}{fence}\n")
        return page

    def folder(self, path):
        if (self.source / path / "README.md").exists():
            return path / "README.md"
        page = Path("source") / path / "index.md"
        if page not in self.made:
            self.made.add(page)
            rows = []
            for file in self.files:
                if file.parent != path or file.suffix in PICTURES or file.name.startswith("."):
                    continue
                target = file if file.suffix == ".md" else self.text(file)
                rows.append(f"- [{file.name}]({os.path.relpath(target, page.parent)})\n")
            self.write(page, f"# {path}\n\n{''.join(rows)}")
        return page

    def all(self):
        for path in self.files:
            if path.suffix == ".md" and path.parent != Path("docs/site"):
                self.page(path)
            elif path.suffix in PICTURES and path.parts[0] in ("docs", "samples"):
                (self.pages / path.parent).mkdir(parents=True, exist_ok=True)
                shutil.copy(self.source / path, self.pages / path)


def python_reference(build):
    sys.path.insert(0, str(build / "python"))
    cairn = importlib.import_module("cairn")
    parts = ["# Python\n", inspect.getdoc(cairn) or ""]

    def entry(level, name, thing):
        parts.append(f"\n{'#' * level} {name}\n")
        text = inspect.getdoc(thing) if not isinstance(thing, (int, float, str, bool)) else repr(thing)
        parts.append(f"```text\n{text or name}\n```\n")

    public = [n for n in getattr(cairn, "__all__", dir(cairn)) if not n.startswith("_")]
    things = {n: getattr(cairn, n) for n in public if not inspect.ismodule(getattr(cairn, n))}
    for title, wanted in (("Functions", lambda t: not inspect.isclass(t)), ("Types", inspect.isclass)):
        parts.append(f"\n## {title}\n")
        for name, thing in things.items():
            if not wanted(thing):
                continue
            entry(3, name, thing)
            if inspect.isclass(thing):
                for member, value in vars(thing).items():
                    if not member.startswith("_") and inspect.getdoc(value):
                        entry(4, f"{name}.{member}", value)
    return "\n".join(parts) + "\n"


def main(source, pages, build=None):
    shutil.rmtree(pages, ignore_errors=True)
    assembly = Assembly(source, pages)
    assembly.all()
    if build is not None:
        assembly.write(Path("api/python.md"), python_reference(build))


if __name__ == "__main__":
    main(*(Path(argument).resolve() for argument in sys.argv[1:]))
