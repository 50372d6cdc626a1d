# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Explains a failed import in a Python version that the module was not built for."""

import importlib.machinery
import pathlib
import re
import sys


def explained(error):
    """The original error, or a clearer one that names the running and the expected Python."""
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
