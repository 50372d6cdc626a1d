# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""The type stubs say what the module is."""

import ast
import os
import pathlib
import re
import subprocess
import sys

import pytest

import cairn


STUBS = pathlib.Path(cairn.__file__).with_suffix(".pyi")  # written by the build


def test_stubs_name_everything_that_is_public():
    tree = ast.parse(STUBS.read_text())
    named = {node.name: node for node in tree.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    named.update({node.target.id: node for node in tree.body if isinstance(node, ast.AnnAssign)})
    assert set(cairn.__all__) <= set(named)
    for name in cairn.__all__:
        if isinstance(getattr(cairn, name), type) and name != "Reject":
            members = {n.name for n in named[name].body if isinstance(n, ast.FunctionDef)}
            assert {m for m in vars(getattr(cairn, name)) if not m.startswith("_")} <= members, name
    assert set(cairn.Reject.__members__) == {n.target.id for n in named["Reject"].body if isinstance(n, ast.AnnAssign)}


def words_of(documented):
    """A docstring without the signature that pybind11 writes into it."""
    return re.sub(r"^\w+\(.*\) -> .*$", "", documented.__doc__ or "", flags=re.M).strip()


def test_everything_public_has_a_docstring():
    bare = []
    for name in cairn.__all__:
        value = getattr(cairn, name)
        if not callable(value):
            continue
        if len(words_of(value)) < 10:
            bare.append(name)
        if not isinstance(value, type) or name == "Reject":
            continue
        for key, member in vars(value).items():
            if key == "__init__" or not key.startswith("_"):
                if len(words_of(getattr(member, "__func__", member))) < 6:
                    bare.append(f"{name}.{key}")
    assert not bare, "no words on: " + ", ".join(bare)


def test_a_type_checker_takes_right_uses_and_refuses_wrong_ones(tmp_path):
    mypy = [sys.executable, "-m", "mypy"]
    if subprocess.run([*mypy, "--version"], capture_output=True).returncode != 0:
        pytest.skip("mypy is not installed")
    program = tmp_path / "program.py"
    program.write_text(
        "import cairn\n"
        "left, right = cairn.load_pair('left.png', 'right.png')\n"
        "rig = cairn.load_calibration('calib.txt')\n"
        "frame = cairn.segment(left, right, rig, match={'num_disparities': 64, 'cost': 'sad'})\n"
        "far = [o.id for o in frame.objects if o.distance_m is not None and o.distance_m > 3]\n"
        "total = frame.disparity.sum() + cairn.match(left, right, window_size=9).best.max()\n"
        "cairn.segment(left, right, rig, match={'num_disparities': '64'})\n"
        "cairn.segment(left, right, rig, match={'cost': 'sda'})\n"
        "cairn.match(left, right, windowsize=9)\n"
        "frame.objets\n"
    )
    package = pathlib.Path(cairn.__file__).parents[1]
    done = subprocess.run(
        [*mypy, "--strict", "--cache-dir", tmp_path / "cache", program], capture_output=True, text=True,
        env={**os.environ, "MYPYPATH": str(package)}, cwd=tmp_path,
    )
    wrong = sorted({int(line) for line in re.findall(r"program.py:(\d+): error", done.stdout)})
    assert wrong == [7, 8, 9, 10], done.stdout + done.stderr
