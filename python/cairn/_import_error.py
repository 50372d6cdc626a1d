# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Explains why the module cannot be imported by a Python other than the one that it was built for."""

import importlib.machinery
import pathlib
import re
import sys


def explained(error):
    """The error itself, or a clearer one that names the running and the expected Python."""
    built = sorted(pathlib.Path(__file__).parent.glob("_cairn.*.so"))
    if any(file.name == "_cairn" + suffix for file in built for suffix in importlib.machinery.EXTENSION_SUFFIXES):
        return error
    running = f"Python {sys.version_info[0]}.{sys.version_info[1]} ({sys.executable})"
    wanted = [f"{tag[1]}.{tag[2]}" for tag in (re.search(r"-(\d)(\d+)", file.name) for file in built) if tag]
    if wanted:
        return ImportError(
            f"cairn: found {running}, expected Python {' or '.join(wanted)}, which {built[0]} was built for"
        )
    return ImportError(f"cairn: found no built module _cairn in {pathlib.Path(__file__).parent}, expected one for {running}")
