# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Messages for a Python that the module was not built for."""

import pathlib
import shutil
import subprocess
import sys

import pytest

import cairn

PACKAGE = pathlib.Path(cairn.__file__).parent


def last_line_of_importing(folder, *arguments):
    done = subprocess.run(
        [sys.executable, *arguments, "-c", "import cairn"], capture_output=True, text=True, cwd=folder,
        env={"PYTHONPATH": str(folder)},
    )
    assert done.returncode == 1
    return done.stderr.strip().splitlines()[-1]


@pytest.fixture
def copy(tmp_path):
    shutil.copytree(PACKAGE, tmp_path / "cairn", ignore=shutil.ignore_patterns("*.so"))
    return tmp_path


def test_another_python_gets_the_expected_version(copy):
    other = copy / "cairn" / "_cairn.cpython-399-x86_64-linux-gnu.so"
    other.write_bytes(b"")
    running = f"Python {sys.version_info[0]}.{sys.version_info[1]} ({sys.executable})"
    assert last_line_of_importing(copy) == f"ImportError: cairn: found {running}, expected Python 3.99, which {other} was built for"
    other.unlink()
    assert last_line_of_importing(copy).startswith(f"ImportError: cairn: found no built module _cairn in {copy / 'cairn'}, expected")


def test_a_python_without_numpy_gets_a_message():
    # -S: without the folders that contain numpy
    line = last_line_of_importing(PACKAGE.parent, "-S")
    assert line == f"ImportError: cairn needs numpy, and {sys.executable} cannot import it: No module named 'numpy'"


def test_other_errors_are_unchanged(copy):
    """A missing library or a truncated file: the system's own message says more."""
    suffix = next(PACKAGE.glob("_cairn.*.so")).name
    (copy / "cairn" / suffix).write_bytes(b"")
    assert "file too short" in last_line_of_importing(copy)
