#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# pip_install.sh SOURCE_DIR PYTHON: runs `pip install .` in a new environment, without an index, and uses the module
# there.
set -euo pipefail
source_dir=$1 python=$2
unset PYTHONPATH
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

if ! "$python" -m venv --system-site-packages "$scratch/venv" >"$scratch/log" 2>&1; then
  cat "$scratch/log"
  echo "skipped: $python cannot create environments (Debian: python3-venv)"
  exit 77
fi
"$scratch/venv/bin/pip" install --no-index "$source_dir"
cd "$scratch"
"$scratch/venv/bin/python" - "$source_dir/data/samples/four_in_a_row" <<'PYTHON'
import importlib.metadata
import pathlib
import sys

import cairn

folder = pathlib.Path(sys.argv[1])
assert pathlib.Path(cairn.__file__).is_relative_to(sys.prefix), cairn.__file__
assert importlib.metadata.version("cairn") == cairn.__version__
assert (pathlib.Path(cairn.__file__).parent / "py.typed").exists()
frame = cairn.segment(*cairn.load_pair(folder / "left.png", folder / "right.png"), cairn.load_calibration(folder / "calib.txt"))
assert len(frame.objects) == 4 and frame.ground, frame
print(frame)
PYTHON
"$scratch/venv/bin/pip" uninstall --yes cairn
[[ -z $(find "$scratch/venv" -path '*site-packages/cairn*') ]]  # uninstalling leaves no file
