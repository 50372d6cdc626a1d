#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# stage_counts.sh X86_BUILD ARM64_BUILD: how many instructions each stage of one frame executes with AVX2 and with NEON, as a
# table of Markdown. Both programs run in QEMU's user mode (qemu-user, g++-aarch64-linux-gnu); for AVX2, callgrind counts the
# same. The builds are those of the presets ci and arm64.
set -euo pipefail
x86_build=${1:?} arm64_build=${2:?}
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

gcc -O2 -shared -fPIC -o "$scratch/plugin.so" lab/stage_counts_plugin.c

counts() {  # COMPILER BUILD QEMU [TARGET]: lines `stage instructions`
  "$1" -std=c++20 -O2 -I. lab/stage_counts.cpp cairn/timing/drawn_pair.cpp "$2/libcairn/libcairn.a" -lhwy -ltbb -ldl -pthread \
    -o "$scratch/$3"
  "$3" -cpu max -plugin "$scratch/plugin.so" "$scratch/$3" ${4:+"$4"} 2>"$scratch/counts" >"$scratch/stages"
  awk 'NR > 1 { print $1 - last } { last = $1 }' "$scratch/counts" | paste -d' ' "$scratch/stages" -
}

counts g++ "$x86_build" qemu-x86_64 avx2 >"$scratch/avx2"
QEMU_LD_PREFIX=/usr/aarch64-linux-gnu counts aarch64-linux-gnu-g++ "$arm64_build" qemu-aarch64 >"$scratch/neon"
cut -d' ' -f1 "$scratch/avx2" | diff -q - <(cut -d' ' -f1 "$scratch/neon") >&2 || { echo "stage_counts: the stages differ" >&2; exit 1; }
paste -d' ' "$scratch/avx2" "$scratch/neon" | awk '
  BEGIN { print "| million instructions | AVX2 | NEON | ratio |\n|---|---:|---:|---:|" }
  { x += $2; arm += $4; if ($2 >= 1e6 || $4 >= 1e6) printf "| `%s` | %.1f | %.1f | %.2f |\n", $1, $2 / 1e6, $4 / 1e6, $4 / $2 }
  END { printf "| **frame** | **%.1f** | **%.1f** | **%.2f** |\n", x / 1e6, arm / 1e6, arm / x }'
