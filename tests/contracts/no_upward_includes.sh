#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# no_upward_includes.sh SOURCE_DIR: checks that every folder includes only lower ones (ARCHITECTURE.md).
set -euo pipefail
cd "$1"

# From the lowest to the highest; `cairn` means files directly in that folder.
ranks='cairn/core cairn/fitted cairn/image cairn/stereo cairn/scene cairn/regions cairn/objects cairn/pipeline cairn/evaluation
  cairn/diagnosis cairn/tuning cairn cairn/io cairn/device cairn/sequence cairn/ros cairn/fleet cairn/output cairn/input cairn/live cairn/timing
  cairn/batch cli python examples lab tests'

find cairn cli python examples lab tests \( -name '*.?pp' -o -name '*.in' \) 2>/dev/null | sort |
  xargs awk -v ranks="$ranks" '
    BEGIN {
      count = split(ranks, listed)
      for (i = 1; i <= count; ++i) rank[listed[i]] = i
    }
    function folder_of(path, parts, depth) {
      depth = split(path, parts, "/")
      return parts[1] == "cairn" && depth > 2 ? "cairn/" parts[2] : parts[1]
    }
    # Also the files from which kernels are compiled; each_target-inl.hpp includes them by a macro.
    match($0, /^ *#(include|define CAIRN_[A-Z_]+) [<"][^>"]+[>"]/) {
      split($0, quoted, /[<>"]/)
      from = folder_of(FILENAME)
      to = folder_of(quoted[2])
      if (to !~ "^cairn(/|$)" && !(to in rank)) next  # not ours, or in the same folder
      if (!(from in rank) || !(to in rank)) {
        printf "%s:%d: a folder without a rank: %s includes %s\n", FILENAME, FNR, from, to
        wrong = 1
      } else if (rank[to] > rank[from]) {
        printf "%s:%d: %s includes %s, which is above it\n", FILENAME, FNR, from, quoted[2]
        wrong = 1
      }
      ++seen
    }
    END {
      if (seen < 100) print "hardly any include: is this the source folder?"
      exit wrong || seen < 100
    }'
