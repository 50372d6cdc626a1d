#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# instruction_counts.sh --check|--update BUILD_DIR: how many instructions the method executes on a fixed pair, by preset and
# function, counted by valgrind's callgrind; unlike times they are the same on a machine that is busy. --check compares
# with lab/instruction_counts.txt and fails where one is off by more than 3 %; faster is off, too: a guard that is
# never renewed guards nothing. --update writes the file anew, to be reviewed in git diff.
# One thread and AVX2 kernels, because valgrind knows no AVX-512. Counts of another compiler or of other flags are others:
# then, and where there is no valgrind, --check ends with exit code 77, which ctest takes for skipped.
set -euo pipefail
mode=${1:?} build_dir=$(realpath "${2:?}")
cd "$(dirname "${BASH_SOURCE[0]}")/.."
readonly kept=lab/instruction_counts.txt
readonly most_percent=3   # that a count may be off
readonly least_percent=1  # of the whole that a function must have for a row of its own

unable() {
  echo "instruction_counts: $*"
  [[ $mode == --check ]] && exit 77
  exit 1
}

cached() {  # VARIABLE of the build's CMake cache
  sed -n "s/^$1:[A-Z]*=//p" "$build_dir/CMakeCache.txt"
}

# What the counts hold for.
build_key() {
  local type flags
  type=$(cached CMAKE_BUILD_TYPE)
  flags="$(cached CMAKE_CXX_FLAGS) $(cached "CMAKE_CXX_FLAGS_${type^^}")"
  [[ $(cached CAIRN_QUICK) == ON ]] && flags+=" -g1"
  [[ $(cached CAIRN_NATIVE) == ON ]] && flags+=" -march=native"
  [[ -n $(cached CAIRN_SANITIZE) ]] && flags+=" -fsanitize=$(cached CAIRN_SANITIZE)"
  # Without the name that the compiler was called by: c++ and g++ are one.
  echo "$("$(cached CMAKE_CXX_COMPILER)" --version | sed '1!d; s/^[^ ]* //'), $(uname -m), $(xargs <<<"$flags")," \
    "SIMD $(cached CAIRN_SIMD), TBB $(cached CAIRN_TBB)"
}

# counts PRESET: lines `PRESET FUNCTION INSTRUCTIONS` for every function of the stages' own folders, those that it calls
# included; segment is the whole. With --json, since the table of refusals judges texture once more.
counts() {
  local preset=$1
  valgrind --tool=callgrind --callgrind-out-file="$scratch/$preset" \
    "$build_dir/cairn" segment data/samples/four_in_a_row --threads 1 --target avx2 --preset "$preset" --json \
    >"$scratch/out" 2>&1 || { cat "$scratch/out" >&2; return 1; }
  # A function of more than one source file has a line for each, and an overload one of its own: the largest counts.
  callgrind_annotate --inclusive=yes --threshold=100 "$scratch/$preset" |
    sed -nE 's!^ *([0-9,]+) .*cairn/(image|stereo|scene|regions|objects|pipeline)/[a-z_]+\.[ch]pp:cairn::([a-z_0-9]+)\(.*!\3 \1!p' |
    tr -d , | sort -k1,1 -k2,2nr | awk -v preset="$preset" '$1 != last { print preset, $1, $2; last = $1 }'
}

command -v valgrind >/dev/null && command -v callgrind_annotate >/dev/null || unable "valgrind is not installed"
key=$(build_key)
if [[ $mode == --check ]]; then
  then_key=$(sed -n 's/^# built with: //p' "$kept")
  [[ $key == "$then_key" ]] || unable "the counts were taken with $then_key; this build has $key"
fi
"$build_dir/cairn" info --target avx2 >/dev/null 2>&1 || unable "AVX2 is not there in this build or on this processor"
# Highway reads the processor's time stamps when it is loaded; valgrind refuses that instruction on processors that do
# not report it.
[[ $(valgrind --tool=none "$build_dir/cairn" --version 2>&1) != *"unhandled instruction"* ]] ||
  unable "valgrind cannot start cairn on this processor: it does not know an instruction of the Highway library"

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
for preset in default paper; do counts "$preset"; done >"$scratch/now"
[[ -s $scratch/now ]] || { echo "instruction_counts: found no function of the stages, expected a build with -g1" >&2; exit 1; }

if [[ $mode == --update ]]; then
  {
    echo "# Instructions that one frame of data/samples/four_in_a_row takes: one thread, AVX2 kernels without VNNI; what a function calls is"
    echo "# counted with it. Written by ./dev test --update; checked to $most_percent % by the test contracts/instruction_counts."
    echo "# built with: $key"
    awk -v least="$least_percent" '
      NR == FNR { if ($2 == "segment") whole[$1] = $3; next }
      $3 * 100 >= whole[$1] * least { print }' "$scratch/now" "$scratch/now" | sort -k1,1 -k3,3nr
  } >"$scratch/anew"
  cp "$scratch/anew" "$kept"
  echo "wrote $kept"
  exit
fi

grep -v '^#' "$kept" | awk -v most="$most_percent" -v least="$least_percent" '
  NR == FNR { now[$1 " " $2] = $3; if ($2 == "segment") whole[$1] = $3; next }
  {
    name = $1 " " $2
    kept[name] = 1
    off = name in now ? 100 * (now[name] - $3) / $3 : 100
    if (off > most || off < -most) {
      bad = 1
      printf "%-36s %12d then, %12s now", name, $3, name in now ? now[name] : "none"
      if (name in now) printf ", %+.1f %%", off
      print ""
    }
  }
  END {
    for (name in now) {
      split(name, of, " ")
      # A count near the limit may be on either side of it.
      if (name in kept || now[name] * 100 < whole[of[1]] * (least + 0.5)) continue
      bad = 1
      printf "%-36s %12s then, %12d now\n", name, "none", now[name]
    }
    if (bad) print "more than " most " % off: find out why, or take the new counts over with ./dev test --update"
    exit bad
  }' "$scratch/now" -
