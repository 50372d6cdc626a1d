#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Prints the type stubs of the module (python/cairn/__init__.pyi), from the module itself.

    PYTHONPATH=build/dev/python python/tools/make_stubs.py > python/cairn/__init__.pyi

`./dev docs` does so, and a test tells when the file is not as printed.
"""

import inspect
import re
import sys
import textwrap

import cairn
from cairn import _cairn

HEAD = '''\
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
# Written by python/tools/make_stubs.py; do not edit.
"""Objects from a rectified stereo pair, in metres, with a reason for every pixel that was refused."""

import enum
import os
from typing import Any, Callable, Dict, Iterable, Iterator, List, Literal, Optional, Sequence, Tuple, TypedDict, Union, overload

import numpy
from numpy.typing import NDArray

ImageLike = NDArray[numpy.uint8]  # (H, W) or (H, W, 3)
FloatsLike = NDArray[numpy.floating[Any]]  # (H, W), px
DisparityLike = Union["DisparityMap", FloatsLike]
MaskLike = Union[NDArray[numpy.uint8], NDArray[numpy.bool_], None]  # (H, W)
LabelsLike = NDArray[numpy.integer[Any]]  # (H, W)
NumbersLike = NDArray[Any]  # (H, W)
RigLike = Union["Rig", "Calibration", None]
PairsLike = Iterable[Tuple[ImageLike, ImageLike]]  # (left, right)
FramesLike = Iterable[Union["TuningFrame", Tuple[ImageLike, ImageLike]]]
PathLike = Union[str, "os.PathLike[str]"]
Points = Sequence[Tuple[float, float, float, float]]  # x_left, y_left, x_right, y_right; px

__version__: str
'''

# What pybind11 calls a type, and what typing does.
TYPES = [
    (r"\bcairn\.", ""),
    (r"\bos\.PathLike\b", "PathLike"),
    (r"\bdict\b", "Dict[str, Any]"),
    (r"\btuple\b(?!\[)", "Tuple[Any, ...]"),
    (r"\blist\b(?!\[)", "List[Any]"),
]
# Arguments that may be of several types are objects to pybind11.
ARGUMENTS = {
    "config": "Union[Config, PathLike, None]",
    "exec": "Optional[Exec]",
    "file": "Optional[PathLike]",
    "progress": "Optional[Callable[[Dict[str, Any]], object]]",
    "stamp_ns": "Optional[int]",
    "pose": "Optional[FloatsLike]",
    "now_from_before": "FloatsLike",
    "covariance": "FloatsLike",
}
RETURNS = {"__iter__": {"Objects": "Iterator[Object]", "GroundPlane": "Iterator[float]", "Following": "Following"},
           "__enter__": {"Following": "Following"}}
# pybind11 knows only that it is a dict.
PROPERTIES = {
    "as_dict": "Dict[str, Dict[str, Any]]",
    "timings": "Dict[str, float]",
    "bad_of_matched": "Dict[float, float]",
    "bad_of_known": "Dict[float, float]",
    "histogram": "Dict[int, int]",
    "motion": "Dict[int, float]",
    "agreement": "Dict[int, float]",
    "changes": "Dict[str, Tuple[Any, Any]]",
    "frame": "Frame",
}


def typed(text):
    for pattern, by in TYPES:
        text = re.sub(pattern, by, text)
    return text


def option_type(option):
    if option.type == "choice":
        return "Literal[" + ", ".join(f'"{choice}"' for choice in option.range.split("|")) + "]"
    return option.type


def group_class(group):
    return "".join(word.capitalize() for word in group.split("_")) + "Options"


def all_options():
    return cairn.options() + cairn.follow_options()


def option_arguments(name):
    """The keywords that **kwargs of a function stands for."""
    grouped, groups = _cairn._options_of.get(name, (False, []))
    if grouped:
        return [f"{group}: {group_class(group)} = ..." for group in groups]
    return [f"{o.name.split('.')[1]}: {option_type(o)} = ..." for g in groups for o in all_options() if o.group == g]


def split_arguments(text):
    """At the commas that stand in no brackets."""
    parts, depth, start = [], 0, 0
    for i, char in enumerate(text):
        depth += (char in "[(") - (char in ")]")
        if char == "," and depth == 0:
            parts.append(text[start:i].strip())
            start = i + 1
    return parts + [text[start:].strip()] if text.strip() else parts


def argument(text, function):
    name, _, rest = text.partition(":")
    if not rest:
        return text
    kind, equals, default = rest.partition(" = ")
    kind = typed(kind.strip())
    if name == "self":
        return "self"
    if kind == "object":
        kind = ARGUMENTS.get(name, "object")
        if name == "config" and not _cairn._options_of.get(function, (False,))[0]:
            kind = "Optional[Config]"
    elif name == "ground_points":
        kind = "Points"
    elif default == "None" and kind not in ("RigLike", "MaskLike") and not kind.startswith("Optional"):
        kind = f"Optional[{kind}]"
    return f"{name}: {kind}" + (f" = {default}" if equals else "")


def signature(line, function, owner=None):
    """`def` line for one of pybind11's: name(arguments) -> type."""
    name, arguments, result = re.fullmatch(r"(\w+)\((.*)\) -> (.*)", line).groups()
    shown = []
    for text in split_arguments(arguments):
        if text == "**kwargs":
            options = option_arguments(owner if name == "__init__" else function)
            if options and "*" not in shown:
                shown.append("*")
            shown += options
        elif text == "/" or (text == "*args" and name != "__exit__"):
            continue
        elif text == "*args":
            shown.append("*args: object")
        else:
            shown.append(argument(text, owner if name == "__init__" else function))
    if shown and shown[-1] == "*":
        shown.pop()
    result = RETURNS.get(name, {}).get(owner) or PROPERTIES.get(name) or typed(result)
    if name == "__eq__":
        shown[1] = "other: object"
    head = f"def {name}(" + ", ".join(shown) + f") -> {result}:"
    if len(head) > 110:
        head = f"def {name}(\n    " + ",\n    ".join(shown) + f",\n) -> {result}:"
    return head


def doc_of(text):
    """Without the list of options: it stands with the groups."""
    text = re.split(r"\n\nOptions, |\n\nconfig: a cairn.Config", text.strip())[0].strip()
    if not text:
        return " ..."
    lines = [wrapped for line in text.split("\n") for wrapped in textwrap.wrap(line, 100) or [""]]
    if len(lines) == 1:
        return f'\n    """{lines[0]}"""'
    return '\n    """' + "\n    ".join(lines) + '\n    """'


def function_stub(name, function, owner=None, decorator=""):
    doc = function.__doc__
    if doc.split("\n")[1:2] == ["Overloaded function."]:
        lines = re.findall(r"^\d+\. (.*)$", doc, re.M)
        return "\n".join("@overload\n" + signature(line, name, owner) + " ..." for line in lines)
    line, _, text = doc.partition("\n")
    return decorator + signature(line, name, owner) + doc_of(text)


def property_stub(name, value):
    line, _, text = (value.fget.__doc__ or "").strip().partition("\n")
    kind = typed(re.search(r"-> (.*)$", line).group(1))
    if kind in ("Dict[str, Any]", "object"):
        kind = PROPERTIES.get(name, kind)
    return f"@property\ndef {name}(self) -> {kind}:" + doc_of(value.__doc__ or text)


def class_stub(name, cls):
    members = []
    for key, value in vars(cls).items():
        if isinstance(value, property):
            members.append(property_stub(key, value))
        elif isinstance(value, staticmethod):
            members.append(function_stub(key, value.__func__, name, "@staticmethod\n"))
        elif key in ("__hash__", "__getstate__", "__setstate__") or not (callable(value) and getattr(value, "__doc__", None)):
            continue
        elif re.match(rf"{key}\(", value.__doc__) and key != "__repr__":
            members.append(function_stub(key, value, name))
    body = "\n".join(members) or "..."
    doc = f'"""{cls.__doc__.strip()}"""\n' if cls.__doc__ else ""
    return f"class {name}:\n" + textwrap.indent(doc + body, "    ")


def options_stub(group):
    lines = [f"class {group_class(group)}(TypedDict, total=False):"]
    for o in all_options():
        if o.group == group:
            unit = f"{o.unit}, " if o.unit else ""
            needs = f", read while {o.needs}" if o.needs else ""
            lines.append(f"    {o.name.split('.')[1]}: {option_type(o)}  # {unit}{o.range}{needs}: {o.help}")
    return "\n".join(lines)


def stubs():
    blocks = []
    for group in dict.fromkeys(o.group for o in all_options()):
        blocks.append(options_stub(group))
    for name in sorted(cairn.__all__):
        value = getattr(cairn, name)
        if name == "Error":
            blocks.append(f'class Error(ValueError):\n    """{value.__doc__}"""')
        elif name == "Reject":
            bits = "\n".join(f"    {bit}: Reject" for bit in value.__members__)
            blocks.append(f'class Reject(enum.IntFlag):\n    """{value.__doc__}"""\n{bits}')
        elif inspect.isclass(value):
            blocks.append(class_stub(name, value))
        elif callable(value):
            blocks.append(function_stub(name, value))
        else:
            blocks.append(f"{name}: {type(value).__name__}")
    return HEAD + "\n" + "\n\n".join(blocks) + "\n"


if __name__ == "__main__":
    sys.stdout.write(stubs())
