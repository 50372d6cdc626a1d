#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# install_and_import.sh BUILD_DIR PYTHON: installs the component `python` into new folders, as for Debian's /usr and
# for another prefix, and imports it from there only.
set -euo pipefail
build_dir=$1 python=$2
unset PYTHONPATH
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

imports() {  # FOLDER
  cd "$1"
  "$python" -c 'import cairn, os; assert os.path.dirname(os.path.dirname(cairn.__file__)) == os.getcwd(), cairn.__file__
assert os.path.exists("cairn/py.typed") and os.path.exists("cairn/__init__.pyi"); print(cairn.__version__)'
}

DESTDIR=$scratch/system cmake --install "$build_dir" --prefix /usr --component python >/dev/null
cmake --install "$build_dir" --prefix "$scratch/own" --component python >/dev/null
if "$python" -c 'import sysconfig, sys; sys.exit("deb_system" not in sysconfig.get_scheme_names())'; then
  imports "$scratch/system/usr/lib/python3/dist-packages"
else
  imports "$scratch"/system/usr/lib/python3.*/site-packages
fi
imports "$scratch"/own/lib/python3.*/*-packages
[[ ! -e $scratch/own/bin ]]  # no file of another component
