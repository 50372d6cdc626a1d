#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# release_is_hardened.sh SOURCE_DIR COMPILER: checks that a release build compiles every source and links every
# program and shared library with the options of cmake/hardening.cmake, and a build with sanitizers does not. Only
# configures; hardened.sh checks the binaries, and `./dev package` the packages.
set -euo pipefail
source_dir=$1 compiler=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() { echo "$*"; exit 1; }

configure() {  # FOLDER CMAKE-ARGS
  cmake -S "$source_dir" -B "$scratch/$1" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release \
    -DBUILD_SHARED_LIBS=ON -DCAIRN_TESTS=OFF -DCAIRN_PYTHON=AUTO "${@:2}" >"$scratch/log" 2>&1 ||
    { tail -20 "$scratch/log"; exit 1; }
}
commands() { grep '"command":' "$scratch/$1/compile_commands.json"; }
# Link flags of each program, shared library and module, one line each.
links() {
  awk '/^build .*: CXX_(EXECUTABLE|SHARED_LIBRARY|MODULE_LIBRARY)_LINKER/ { name = $2 } /^ *LINK_FLAGS/ && name { print name, $0; name = "" }
       /^$/ { if (name) { print name; name = "" } }' "$scratch/$1/build.ninja"
}

configure release
total=$(commands release | wc -l)
[[ $total -gt 50 ]] || fail "only $total sources"
for flag in '-fstack-protector-strong' '-D_FORTIFY_SOURCE=2' '-fPI[CE]'; do
  ! commands release | grep -vE -e " $flag( |$)" || fail "these are compiled without $flag"
done
linked=$(links release | wc -l)
[[ $linked -gt 0 ]] || fail "nothing is linked"
! links release | grep -v -e '-z,relro,-z,now' || fail "these are linked without RELRO and BIND_NOW"
! grep -A12 'CXX_EXECUTABLE_LINKER' "$scratch/release/build.ninja" | grep LINK_FLAGS | grep -v -e '-pie' || fail "these are no PIE"

configure sanitized -DCAIRN_SANITIZE=address
! commands sanitized | grep -e '-D_FORTIFY_SOURCE' || fail "these are checked twice: by the sanitizer and the C library"
echo "$total sources, $linked programs and shared libraries"
