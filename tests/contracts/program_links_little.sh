#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# program_links_little.sh PROGRAM: checks that the command loads no library that only some commands need: those are in
# its module. Above all not LAPACK, which OpenCV's core links: where it is OpenBLAS, a program under a memory limit hangs.
set -euo pipefail
loaded=$(ldd "$1")
if grep -iE 'opencv|lapack|blas|sqlite|libssl|libcrypto|libgst|ddsc|vulkan|zstd' <<<"$loaded"; then
  echo "$1 loads these; expected only its own libraries, yaml-cpp, PNG, JPEG, zlib, Highway and oneTBB"
  exit 1
fi
grep -q libstdc <<<"$loaded"
