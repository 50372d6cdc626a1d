#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# no_shared_temporaries.sh SOURCE_DIR: checks that installed code writes only where requested. A temporary file is
# next to its final name (cairn/io/atomic_file.hpp), never in a folder that others may write to.
set -euo pipefail
cd "$1"
readonly installed=(cairn cli python/bindings python/cairn)
readonly calls='temp_directory_path|tmpnam|tempnam|tmpfile|mktemp|mkstemp|mkostemp|mkdtemp|shm_open|tempfile'
readonly folders='"/(var/)?tmp|/dev/shm|TMPDIR'
[[ $(ls -d "${installed[@]}" | wc -l) == "${#installed[@]}" ]]
if grep -rnE --include='*.[ch]pp' --include='*.py' "\b($calls)\b|$folders" "${installed[@]}"; then
  echo "these create files in a shared folder; expected none, or next to the final name through write_file()"
  exit 1
fi
