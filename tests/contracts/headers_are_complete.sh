#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# headers_are_complete.sh CMAKE BUILD_DIR: checks that every cairn header included by an installed one is installed,
# too.
set -euo pipefail
prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT
"$1" --install "$2" --prefix "$prefix" >/dev/null
cd "$prefix/include"
[[ -f cairn/cairn.hpp ]] || { echo "no cairn/cairn.hpp was installed"; exit 1; }
missing=0
while IFS=: read -r header included; do
  [[ -f $included ]] || { echo "$header includes $included, which is not installed"; missing=1; }
done < <(grep -rohE '^#include <cairn/[^>]+>' --include='*.hpp' -H . | sed -E 's/#include <([^>]+)>/\1/')
exit "$missing"
