#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Counts folders, lines, options, long functions and names, of the working tree or of commits side by side."""

import argparse
import ast
import os
import re
import subprocess
import sys

CODE = (".cpp", ".hpp", ".py", ".js", ".css", ".cmake", ".sh", ".html", ".in")
MAX_LINES = 60
MAX_PARAMETERS = 7
CONTROL = re.compile(r"\b(if|for|while|switch|catch|do|else|return|namespace|struct|class|union|enum|try)\b")
STRINGS = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|^[ \t]*#(?:\\\n|[^\n])*', re.S | re.M)


def git(*arguments):
    return subprocess.run(["git", *arguments], check=True, capture_output=True).stdout


def files_of(commit):
    """Path → bytes, of a commit or of the working tree."""
    if commit is None:
        names = git("ls-files", "--cached", "--others", "--exclude-standard", "-z").decode().split("\0")
        files = {}
        for name in names:
            if os.path.isfile(name) and not os.path.islink(name):
                with open(name, "rb") as file:
                    files[name] = file.read()
        return files
    files = {}
    for entry in git("ls-tree", "-rz", commit).decode().split("\0"):
        if entry and not entry.startswith("120000"):  # a symbolic link
            kind, _, name = entry.partition("\t")
            files[name] = kind.split()[2]
    output = subprocess.run(["git", "cat-file", "--batch"], input="\n".join(files.values()).encode(), check=True,
                            capture_output=True).stdout
    at = 0
    for name in files:
        end = output.index(b"\n", at)
        size = int(output[at:end].split()[2])
        files[name] = output[end + 1:end + 1 + size]
        at = end + size + 2
    return files


def kind_of(name, content):
    """What a file's lines count as; None: nothing."""
    base = os.path.basename(name)
    fitted = re.search(r"(^|/)(fitted|object_hints_weights)[^/]*\.inc$", name)
    if name.endswith(".svg") or fitted:
        return "fitted text and SVG"
    is_script = content.startswith(b"#!") and b"\0" not in content[:200]
    if not (name.endswith(CODE) or base == "CMakeLists.txt" or is_script):
        return None
    return "tests" if re.match(r"tests/|python/tests/", name) else "code"


def blank(match):
    return re.sub(r"[^\n]", " ", match.group(0))


def split_parameters(text):
    """The number of parameters in the text between a function's parentheses."""
    depth, count = 0, 1
    for c in re.sub(r"->|[<>]=|<<|>>(?=\s*\()", "  ", text):
        depth += (c in "(<[{") - (c in ")>]}")
        count += c == "," and depth == 0
    return count if text.strip() not in ("", "void") else 0


def functions_in_braces(text):
    """(line, lines, parameters, name) of each outermost function of C++ or JavaScript."""
    text = STRINGS.sub(blank, text)
    inside = []  # of each open brace: (start of the function or None)
    begin = 0
    for m in re.finditer(r"[{};]", text):
        at = m.start()
        if m.group() == "{":
            head = text[begin:at]
            named = re.search(r"(~?[\w:]+|operator\S+)\s*\(", head)
            outer = not any(start is not None for start in inside)
            is_macro = named and re.fullmatch(r"[A-Z_]+", named.group(1))
            is_function = outer and named and not is_macro and not CONTROL.search(head[:named.end()]) and "=" not in head[:named.start()]
            start = None
            if is_function:
                first = begin + len(head) - len(head.lstrip())
                close, depth = named.end(), 1
                while close < len(head) and depth:
                    depth += (head[close] == "(") - (head[close] == ")")
                    close += 1
                start = (first, named.group(1), split_parameters(head[named.end():close - 1]))
            inside.append(start)
        elif m.group() == "}" and inside:
            start = inside.pop()
            if start:
                line = text.count("\n", 0, start[0]) + 1
                yield line, text.count("\n", start[0], at) + 1, start[2], start[1]
        begin = m.end()


def functions_in_python(text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            arguments = node.args
            names = [a.arg for a in arguments.posonlyargs + arguments.args]  # those by keyword only name themselves
            count = len(names) - (names[:1] == ["self"])
            yield node.lineno, node.end_lineno - node.lineno + 1, count, node.name


def measure(commit):
    files = files_of(commit)
    lines = {"code": 0, "tests": 0, "fitted text and SVG": 0}
    functions, types, old_constants = [], set(), 0
    for name, content in files.items():
        kind = kind_of(name, content)
        if kind is None:
            continue
        text = content.decode(errors="replace")
        lines[kind] += text.count("\n")
        if kind == "code" and name.endswith((".cpp", ".hpp", ".js")):
            functions += [(f, name) for f in functions_in_braces(text)]
        elif kind == "code" and name.endswith(".py"):
            functions += [(f, name) for f in functions_in_python(text)]
        if kind == "code" and name.endswith((".cpp", ".hpp")):
            plain = STRINGS.sub(blank, text)
            types |= set(re.findall(r"\b(?:struct|class|enum class|enum)\s+([A-Z]\w+)\s*(?:final\s*)?[:{]", plain))
            old_constants += len(set(re.findall(r"\bk(?:Most|Least|Fewest|Greatest|Farthest)[A-Z]\w*", plain)))
    options = re.findall(r"^\| `[\w]+\.[\w.]+` \|", files.get("docs/options.md", b"").decode(), re.M)
    fitted = [len(c) for n, c in files.items() if re.search(r"fitted/[^/]*\.bin$", n)]
    participles = sorted(t for t in types if re.search(r"[a-z](ed|en|wn)$", t) or t in ("Given", "LeftOut"))
    long = sorted(((f[1], f[3], n, f[0]) for f, n in functions if f[1] > MAX_LINES), reverse=True)
    wide = sorted(((f[2], f[3], n, f[0]) for f, n in functions if f[2] > MAX_PARAMETERS), reverse=True)
    table = {
        "folders at the top": len({n.split("/")[0] for n in files if "/" in n and not n.startswith(".")}),
        "lines of code": lines["code"],
        "lines of tests": lines["tests"],
        "lines of fitted text and SVG": lines["fitted text and SVG"],
        "fitted binary files, kB": round(sum(fitted) / 1000),
        "options": len(set(options)),
        "functions": len(functions),
        f"functions over {MAX_LINES} lines": len(long),
        f"functions over {MAX_PARAMETERS} parameters": len(wide),
        "names of types": len(types),
        "names of types that end like participles": len(participles),
        "constants kMost, kLeast, kFewest, …": old_constants,
    }
    return table, long, wide, sorted(types), participles


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("commits", nargs="*", metavar="COMMIT", help="columns before that of the working tree")
    parser.add_argument("--types", action="store_true", help="list the names of all types")
    arguments = parser.parse_args()
    try:
        columns = [measure(commit) for commit in [*arguments.commits, None]]
    except subprocess.CalledProcessError as error:
        sys.exit("dev lines: " + error.stderr.decode().strip().splitlines()[0])
    print("| | " + " | ".join([*arguments.commits, "working tree"]) + " |")
    print("|---|" + "---:|" * len(columns))
    for row in columns[0][0]:
        print(f"| {row} | " + " | ".join(f"{column[0][row]:,}" for column in columns) + " |")
    _, long, wide, types, participles = columns[-1]
    for title, found in ((f"over {MAX_LINES} lines", long), (f"over {MAX_PARAMETERS} parameters", wide)):
        if found:
            print(f"\nFunctions {title}:")
            for count, name, file, line in found:
                print(f"  {count:3d}  {name}  {file}:{line}")
    if participles:
        print("\nTypes that end like participles: " + ", ".join(participles))
    if arguments.types:
        print("\nTypes: " + ", ".join(types))


if __name__ == "__main__":
    main()
