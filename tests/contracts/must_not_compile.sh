#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# must_not_compile.sh COMPILER SOURCE_DIR: see must_not_compile.cpp.
set -euo pipefail
compiler=$1
source_dir=$2
file=$source_dir/tests/contracts/must_not_compile.cpp

compile() { "$compiler" -std=c++20 -fsyntax-only -I"$source_dir" "$@" "$file" 2>&1; }

if ! message=$(compile); then
  printf 'the right use does not compile:\n%s\n' "$message"
  exit 1
fi

bad=0 cases=0
while IFS=$'\t' read -r name expected; do
  cases=$((cases + 1))
  if message=$(compile -D"$name"); then
    echo "$name compiles, but must not"
    bad=1
  elif ! grep -qE "$expected" <<<"$message"; then
    printf '%s fails, but not with "%s":\n%s\n' "$name" "$expected" "$message"
    bad=1
  fi
done < <(sed -nE 'N; s/.*defined\((CASE_[a-z_]+)\)\n *\/\/ expect: (.*)/\1\t\2/p; D' "$file")
echo "$cases cases"
# A case without an expectation would never be tried.
[[ $cases == $(grep -c 'defined(CASE_' "$file") && $cases -gt 0 && $bad == 0 ]]
