#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""make_stubs.py FILE: writes the module's type stubs, by inspecting the module. The build calls it.

Docstrings of functions begin with their signature, and classes have the types of their attributes: see cairn/_calls.py.
"""

import inspect
import pathlib
import re
import sys
import textwrap

try:
    import numpy  # noqa: F401
except ImportError:
    print(f"No type stubs of the Python module: {sys.executable} has no numpy")
    sys.exit(0)
import cairn
from cairn import _calls

HEAD = '''\
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
# Written by the build (python/tools/make_stubs.py); do not edit.
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
HintsLike = Union[NDArray[numpy.int16], None]  # (rows, columns, 5)
DisparitiesLike = FloatsLike  # each within ±2047, NaN = hole
MatrixLike = NDArray[numpy.floating[Any]]  # square
LabelsLike = NDArray[numpy.integer[Any]]  # (H, W)
NumbersLike = NDArray[Any]  # (H, W)
RigLike = Union["Rig", "Calibration", None]
PathLike = Union[str, "os.PathLike[str]"]

__version__: str
'''


# Declarations of C++ that no signature contains.
SPECIAL = {
    "__len__": "def __len__(self) -> int: ...",
    "__iadd__": "def __iadd__(self, other: {owner}) -> {owner}: ...",
}
OVERLOADS = {
    "Objects.__getitem__": ["(self, index: int) -> Object", "(self, index: slice) -> List[Object]"],
    "diagnose": ["(measures: PairMeasures, rig: RigLike = ..., *, limits: Optional[Dict[str, float]] = ..., "
                 "config: Optional[Config] = ..., exec: Optional[Exec] = ..., **options: Any) -> List[Finding]",
                 "(measures: Synchrony) -> Optional[Finding]"],
}


def option_type(option):
    if option.type == "choice":
        return "Literal[" + ", ".join(f'"{choice}"' for choice in option.range.split("|")) + "]"
    return option.type


def group_class(group):
    return "".join(word.capitalize() for word in group.split("_")) + "Options"


def option_arguments(function):
    """The keywords that **options of a function stands for."""
    if function.by_group:
        return [f"{group}: {group_class(group)} = ..." for group in function.groups]
    return [f"{o.name.split('.')[1]}: {option_type(o)} = ..." for o in _calls.OPTIONS if o.group in function.groups]


def function_stub(title, function, decorator=""):
    name = title.split(".")[-1]
    if not hasattr(function, "groups"):
        signature = inspect.signature(function)
        return f"def {name}({_calls.described(signature.parameters.values(), False)} -> {signature.return_annotation}: ..."
    line, _, words = function.__doc__.partition("\n\n")
    if title in OVERLOADS:
        return "\n".join(f"@overload\ndef {name}{line}: ..." for line in OVERLOADS[title])
    if re.search(r"\*\*\w+", line):
        options = option_arguments(function)
        has_star = "*, " in line or not options
        line = re.sub(r"\*\*\w+", ("" if has_star else "*, ") + ", ".join(options), line).replace(", )", ")")
    return f"{decorator}def {line}:{doc_of(words)}"


def doc_of(text):
    """The docstring without the list of options, which is shown with the groups."""
    text = re.split(r"\n\nOptions, |\n\nconfig: a cairn.Config", text.strip())[0].strip()
    lines = [wrapped for line in re.split(r"\n(?= )", text) for wrapped in textwrap.wrap(line, 100)]
    if len(lines) < 2:
        return f'\n    """{lines[0]}"""' if lines else " ..."
    return '\n    """' + "\n    ".join(lines) + '\n    """'


def class_stub(name, cls):
    members = []
    for key, value in vars(cls).items():
        if isinstance(value, property) and key in cls._shown:
            members.append(f"@property\ndef {key}(self) -> {cls._shown[key]}:" + doc_of(value.__doc__))
        elif isinstance(value, staticmethod):
            members.append(function_stub(f"{name}.{key}", value.__func__, "@staticmethod\n"))
        elif inspect.isfunction(value) and (hasattr(value, "groups") or key.startswith("__") and value.__annotations__):
            members.append(function_stub(f"{name}.{key}", value))
        elif key in SPECIAL:
            members.append(SPECIAL[key].format(owner=name))
    return f"class {name}:" + doc_of(cls.__doc__) + "\n" + textwrap.indent("\n".join(members), "    ")


def options_stub(group):
    lines = [f"class {group_class(group)}(TypedDict, total=False):"]
    for o in _calls.OPTIONS:
        if o.group == group:
            unit = f"{o.unit}, " if o.unit else ""
            needs = f", read while {o.needs}" if o.needs else ""
            lines.append(f"    {o.name.split('.')[1]}: {option_type(o)}  # {unit}{o.range}{needs}: {o.help}")
    return "\n".join(lines)


def stub(name, value):
    if inspect.isclass(value) and issubclass(value, Exception):
        bases = ", ".join(base.__name__ for base in value.__bases__)
        return f'class {name}({bases}):{doc_of(value.__doc__)}'
    if name == "Reject":
        bits = "\n".join(f"    {bit}: Reject" for bit in value.__members__)
        return f"class Reject(enum.IntFlag):{doc_of(value.__doc__)}\n{bits}"
    if inspect.isclass(value):
        return class_stub(name, value)
    if callable(value):
        return function_stub(name, value)
    return f"{name}: {type(value).__name__}"


def stubs():
    groups = dict.fromkeys(option.group for option in _calls.OPTIONS)
    names = sorted(cairn.__all__, key=lambda name: (name != "Error", name))
    blocks = [options_stub(group) for group in groups] + [stub(name, getattr(cairn, name)) for name in names]
    return HEAD + "\n" + "\n\n".join(blocks) + "\n"


if __name__ == "__main__":
    file = pathlib.Path(sys.argv[1])
    file.unlink(missing_ok=True)  # may be a link
    file.write_text(stubs())
