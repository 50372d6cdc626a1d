#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""assemble.py SOURCE_DIR PAGES_DIR [BUILD_DIR]: copies the repository's pages to where the site generator reads them.

Pages and images keep their paths. A link to a source file becomes a page with its text, a link to a folder without a
README a list of its files. With BUILD_DIR, where the Python module is built, writes the module's reference, too.
"""
import importlib
import inspect
import os
import re
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

PICTURES = {".png", ".jpg"}
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
            content, fence = (self.source / path).read_bytes(), "````"
            shown = (f"{len(content)} bytes, not text." if b"\0" in content else
                     f"{fence}{LANGUAGES.get(path.suffix, 'text')}\n{content.decode()}{fence}")
            self.write(page, f"# {path}\n\n{shown}\n")
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
            elif path.suffix in PICTURES and path.parts[0] in ("docs", "data"):
                (self.pages / path.parent).mkdir(parents=True, exist_ok=True)
                shutil.copy(self.source / path, self.pages / path)


def markdown_of(name, text):
    """A docstring as Markdown: signature and indented lines as code, the rest as prose."""
    parts = []
    for paragraph in re.split(r"\n\s*\n", text):
        if not parts and paragraph.startswith(f"{name}("):
            lines = textwrap.wrap(paragraph, 76, subsequent_indent="    ", break_long_words=False)
            parts.append("```python\n" + "\n".join(lines) + "\n```")
        elif re.search(r"^  ", paragraph, re.M):
            parts.append(f"```text\n{paragraph}\n```")
        else:
            parts.append(re.sub(r"([*_<>])", r"\\\1", paragraph))
    return "\n\n".join(parts) + "\n"


def python_reference(build):
    sys.path.insert(0, str(build / "python"))
    cairn = importlib.import_module("cairn")
    parts = ["# Python\n", inspect.getdoc(cairn) or ""]
    first = ["segment", "Segmenter", "options"]  # then alphabetically
    public = [n for n in getattr(cairn, "__all__", dir(cairn)) if not n.startswith("_")]
    public.sort(key=lambda n: (first.index(n) if n in first else len(first), n))
    things = {n: getattr(cairn, n) for n in public if not inspect.ismodule(getattr(cairn, n))}

    parts.append("\n## Functions\n")
    for name, thing in things.items():
        if callable(thing) and not inspect.isclass(thing):
            parts.append(f"\n### {name}\n\n{markdown_of(name, inspect.getdoc(thing) or '')}")
    parts.append("\n## Types\n")
    for name, thing in things.items():
        if not inspect.isclass(thing):
            continue
        parts.append(f"\n### {name}\n\n{markdown_of(name, inspect.getdoc(thing) or '')}")
        members = {m: inspect.getdoc(v) for m, v in vars(thing).items() if not m.startswith("_")}
        for member, text in members.items():
            if text and text != inspect.getdoc(int):
                parts.append(f"\n#### {name}.{member}\n\n{markdown_of(member, text)}")
    parts.append("\n## Numbers\n\n| name | value |\n|---|---|")
    for name, thing in things.items():
        if not callable(thing):
            parts.append(f"| {name} | {thing!r} |".replace("_", "\\_"))
    return "\n".join(parts) + "\n"


def main(source, pages, build=None):
    shutil.rmtree(pages, ignore_errors=True)
    assembly = Assembly(source, pages)
    assembly.all()
    if build is not None:
        assembly.write(Path("api/python.md"), python_reference(build))


if __name__ == "__main__":
    main(*(Path(argument).resolve() for argument in sys.argv[1:]))
