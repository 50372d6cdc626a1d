#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# install_and_use.sh SOURCE_DIR BUILD_DIR COMPILER: installs the library from BUILD_DIR into a new folder, and a project that
# knows only find_package(cairn) builds against it and runs.
set -euo pipefail
source_dir=$1 build_dir=$2 compiler=$3
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cmake --install "$build_dir" --prefix "$scratch/prefix" >/dev/null
cmake -S "$source_dir/tests/contracts/consumer" -B "$scratch/build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_PREFIX_PATH="$scratch/prefix" ${CAIRN_CONSUMER_FLAGS:+"-DCMAKE_CXX_FLAGS=$CAIRN_CONSUMER_FLAGS"} >/dev/null
cmake --build "$scratch/build"
"$scratch/build/consumer"
