#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# hardened.sh PATH...: checks that every program and shared library of PATHs (files, or folders to search) was built
# with the options of cmake/hardening.cmake: position-independent, with read-only tables at run time, a non-executable
# stack, canaries, and only relative library paths. At least one of them must call the C library's checked functions;
# most C++ code has no such call. Exit code 77 without readelf.
set -euo pipefail
command -v readelf >/dev/null || { echo "skipped: readelf is not installed (binutils)"; exit 77; }

bad=0 seen=0 checked=0
complain() { echo "$file: $*"; bad=1; }

while IFS= read -r -d '' file; do
  [[ $(head -c 4 "$file" | tr -d '\0') == $'\x7fELF' ]] || continue
  head=$(readelf --wide --file-header --program-headers "$file")
  dynamic=$(readelf --wide --dynamic "$file")
  symbols=$(readelf --wide --dyn-syms "$file")
  grep -qE '^ *Type: +DYN' <<<"$head" || { complain "has fixed addresses (no PIE)"; continue; }
  seen=$((seen + 1))
  if grep -q 'INTERP' <<<"$head"; then grep -qE 'FLAGS_1.*PIE' <<<"$dynamic" || complain "is no PIE"; fi
  grep -q 'GNU_RELRO' <<<"$head" || complain "has no RELRO"
  grep -qE 'BIND_NOW|FLAGS_1.*NOW' <<<"$dynamic" || complain "binds lazily (no BIND_NOW), so RELRO covers a part only"
  grep -E 'GNU_STACK' <<<"$head" | grep -E ' RW +0x' >/dev/null || complain "has a stack that can be run"
  ! grep -qE 'LOAD.* RWE ' <<<"$head" || complain "has memory that can be written and run"
  ! grep -q 'TEXTREL' <<<"$dynamic" || complain "has relocations in its code"
  ! grep -E 'R(UN)?PATH' <<<"$dynamic" | grep -vE '\[(\$ORIGIN[^]:]*:?)+\]' >/dev/null || complain "names a folder of libraries: $(grep -E 'R(UN)?PATH' <<<"$dynamic")"
  grep -q '__stack_chk_fail' <<<"$symbols" || complain "has no stack protector"
  if grep -qE ' UND +__[a-z]+_chk(@|$)' <<<"$symbols"; then checked=$((checked + 1)); fi
done < <(find "$@" -type f \( -perm -u+x -o -name '*.so*' \) -print0)

[[ $seen -gt 0 ]] || { echo "no program and no shared library in: $*"; exit 1; }
[[ $checked -gt 0 ]] || { echo "none calls a checked function of the C library (no _FORTIFY_SOURCE): $*"; exit 1; }
echo "$seen programs and libraries, $checked of which call checked functions of the C library"
[[ $bad == 0 ]]
