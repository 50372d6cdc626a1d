#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# install_and_use.sh HOW SOURCE_DIR BUILD_DIR COMPILER: installs the library from BUILD_DIR into a new folder, moves
# that folder, and uses it as other projects do (HOW):
#   cmake         tests/consumer finds it by find_package(cairn), builds and runs
#   pkg-config    the same programs, built with the flags of pkg-config
#   headers       each installed header compiles alone, without access to the source tree
#   fetch         tests/consumer builds the library from its sources by FetchContent (nothing is downloaded or installed)
# Exit code 77 without pkg-config.
set -euo pipefail
how=$1 source_dir=$2 build_dir=$3 compiler=$4
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
read -ra flags <<<"${CAIRN_CONSUMER_FLAGS:-}"

# Moved after installation: no file may contain the original path.
install_and_move() {
  cmake --install "$build_dir" --prefix "$scratch/first" >/dev/null
  mv "$scratch/first" "$scratch/prefix"
  ! grep -rlI -e "$scratch/first" -e "$source_dir" "$scratch/prefix" || { echo "these name a path of the build"; exit 1; }
  PKG_CONFIG_PATH=$(dirname "$(find "$scratch/prefix" -name cairn.pc)")
  LD_LIBRARY_PATH=$(dirname "$PKG_CONFIG_PATH")${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}  # for shared libraries
  export PKG_CONFIG_PATH LD_LIBRARY_PATH
}

build_consumer() {  # CMAKE-ARGS
  cmake -S "$source_dir/tests/consumer" -B "$scratch/build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
    -DCMAKE_CXX_FLAGS="${flags[*]}" "$@" >/dev/null
  cmake --build "$scratch/build"
}

run_programs() {
  local program ran=0
  for program in core files matrices; do
    [[ -x $scratch/build/$program ]] || continue
    "$scratch/build/$program" "$source_dir/data/samples/four_in_a_row" "$scratch/result"
    ran=$((ran + 1))
  done
  if [[ -x $scratch/build/sequences ]]; then
    "$scratch/build/sequences" "$source_dir/data/sequences/rolling_ball" "$scratch/map.db"
    ran=$((ran + 1))
  fi
  echo "$ran programs"
  [[ -x $scratch/build/core ]]
}

compile() {  # PACKAGES SOURCE OUTPUT
  local words
  words=$(pkg-config --cflags --libs "$1")
  # shellcheck disable=SC2086  # words
  "$compiler" -std=c++20 "${flags[@]}" "$2" -o "$3" $words
}

# Without a dependency of cairn::io: the core is still found, and requesting io reports the missing package.
lose_io() {
  mkdir "$scratch/lost"
  printf '%s\n' 'cmake_minimum_required(VERSION 3.25)' 'project(lost CXX)' 'find_package(cairn REQUIRED)' \
    'find_package(cairn REQUIRED COMPONENTS io)' >"$scratch/lost/CMakeLists.txt"
  local said
  said=$(cmake -S "$scratch/lost" -B "$scratch/lost/build" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" \
    -DCMAKE_PREFIX_PATH="$scratch/prefix" -DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON 2>&1) &&
    { echo "found component io without yaml-cpp"; exit 1; }
  grep -q 'CMakeLists.txt:4' <<<"$said" && grep -q 'component io is missing: yaml-cpp' <<<"$said" || { echo "$said"; exit 1; }
}

# The installed command finds its module: only the module can report an invalid video this way.
find_video_module() {
  [[ -e $(find "$scratch/prefix" -name cairn-video.so) ]] || return 0
  echo "no video" >"$scratch/broken.mp4"
  local said
  said=$("$scratch/prefix/bin/cairn" follow "$scratch/broken.mp4" --layout side_by_side 2>&1) && { echo "$said"; exit 1; }
  ! grep -q 'cairn-video.so\|videoio' <<<"$said" && grep -q 'broken.mp4' <<<"$said" || { echo "$said"; exit 1; }
}

# The same for the camera module.
find_gstreamer_module() {
  [[ -e $(find "$scratch/prefix" -name cairn-gstreamer.so) ]] || return 0
  local said
  said=$("$scratch/prefix/bin/cairn" follow "gst:no_such_element" 2>&1) && { echo "$said"; exit 1; }
  grep -q 'no element "no_such_element"' <<<"$said" || { echo "$said"; exit 1; }
}

case $how in
  cmake)
    install_and_move
    build_consumer -DCMAKE_PREFIX_PATH="$scratch/prefix"
    run_programs
    find_video_module
    find_gstreamer_module
    if [[ -x $scratch/build/files && -e $(find "$scratch/prefix" -name libcairn.a) ]]; then lose_io; fi
    ;;
  pkg-config)
    command -v pkg-config >/dev/null || exit 77
    install_and_move
    mkdir "$scratch/build"
    compile cairn "$source_dir/tests/consumer/core.cpp" "$scratch/build/core"
    if [[ -e $PKG_CONFIG_PATH/cairn-io.pc ]]; then
      compile cairn-io "$source_dir/tests/consumer/files.cpp" "$scratch/build/files"
    fi
    if [[ -e $PKG_CONFIG_PATH/cairn-sequences.pc ]]; then
      compile cairn-sequences "$source_dir/tests/consumer/sequences.cpp" "$scratch/build/sequences"
    fi
    run_programs
    ;;
  headers)
    install_and_move
    cd "$scratch/prefix/include"
    mapfile -t headers < <(find cairn -name '*.hpp' | sort)
    [[ -d /usr/include/opencv4 ]] || mapfile -t headers < <(printf '%s\n' "${headers[@]}" | grep -v opencv)
    # shellcheck disable=SC2016  # for the inner shell
    printf '%s\n' "${headers[@]}" | xargs -P "$(nproc)" -I{} \
      sh -c 'echo "#include <$2>" | "$1" -std=c++20 -Wall -Wextra -Wconversion -Wshadow -Werror -fsyntax-only -I. \
        -isystem /usr/include/opencv4 -x c++ - || { echo "$2"; exit 255; }' \
      compile "$compiler" {}
    echo "${#headers[@]} headers"
    [[ ${#headers[@]} -gt 30 ]]
    ;;
  fetch)
    if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
    build_consumer -DCAIRN_FROM_SOURCE=ON -DFETCHCONTENT_SOURCE_DIR_CAIRN="$source_dir" -DCMAKE_BUILD_TYPE=Release
    run_programs
    ;;
esac
