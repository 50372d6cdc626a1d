#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# try_deb.sh FOLDER [ROOT]: tries the packages in FOLDER on a clean Debian 12. Creates the root with debootstrap in
# ROOT (default: a temporary folder; an existing root is used as it is). Installs cairn there with apt only and runs
# the command on every sample; then compiles with the headers, by CMake and by pkg-config; then imports the Python
# module, if its package exists. Needs root, debootstrap and a Debian mirror (CAIRN_MIRROR).
set -euo pipefail
packages=$(cd "$1" && pwd)
root=${2:-}
mirror=${CAIRN_MIRROR:-http://deb.debian.org/debian}
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf '\n-- %s\n' "$*"; }
fail() { printf 'try_deb: %s\n' "$*" >&2; exit 1; }

[[ $(id -u) == 0 ]] || fail "needs root, for debootstrap and chroot"
command -v debootstrap >/dev/null || fail "needs debootstrap: apt-get install debootstrap"
compgen -G "$packages/cairn_*.deb" >/dev/null || fail "no cairn_*.deb in $packages; ./dev package makes them"

leave() {
  local code=$?
  if mountpoint -q "$root/proc"; then umount "$root/proc"; fi
  if [[ -n ${scratch:-} ]]; then rm -rf "$scratch"; fi
  exit "$code"
}
trap leave EXIT
if [[ -z $root ]]; then
  scratch=$(mktemp -d)
  root=$scratch/root
fi

inside() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
  DEBIAN_FRONTEND=noninteractive "$@"; }
packages_named() { (cd "$root" && compgen -G "cairn/$1_*.deb" | sed 's|^|/|'); }
install_inside() { inside apt-get install --yes --no-install-recommends "$@" >"$root/tmp/apt.log" 2>&1 ||
  { tail -20 "$root/tmp/apt.log" >&2; fail "apt-get install $* failed"; }; }
count_packages() { inside dpkg-query -W -f '.\n' | wc -l; }

if [[ ! -x $root/usr/bin/apt-get ]]; then
  say "a clean Debian 12 in $root"
  debootstrap --variant=minbase bookworm "$root" "$mirror" >"$packages/debootstrap.log" 2>&1 ||
    { tail -5 "$packages/debootstrap.log" >&2; fail "debootstrap failed"; }
fi
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
# The host's access to a mirror: names, proxy, certificates.
cp /etc/resolv.conf "$root/etc/resolv.conf" 2>/dev/null || true
if [[ -n ${http_proxy:-} ]]; then echo "Acquire::http::Proxy \"$http_proxy\";" >"$root/etc/apt/apt.conf.d/90proxy"; fi
rm -rf "$root/cairn" && mkdir "$root/cairn"
cp "$packages"/*.deb "$root/cairn/"
inside apt-get update >/dev/null
before=$(count_packages)

say "the command"
mapfile -t tools < <(packages_named 'libcairn[0-9]*'; packages_named 'libcairn-sequences*'; packages_named cairn)
install_inside "${tools[@]}"
echo "$(inside cairn --version); $(($(count_packages) - before)) packages installed, including its own"
for sample in "$source_dir"/data/samples/*/; do
  name=$(basename "$sample")
  inside cairn segment "/usr/share/doc/cairn/examples/$name" -o "/tmp/demo/$name"
  for file in objects.json objects.png overlay.png disparity.png; do
    [[ -s $root/tmp/demo/$name/$file ]] || fail "cairn segment left no $file for $name"
  done
done
if compgen -G "$packages/libcairn-sequences*.deb" >/dev/null; then
  inside cairn follow /usr/share/doc/cairn/sequences/rolling_ball -o /tmp/followed
  [[ $(wc -l <"$root/tmp/followed/tracks.jsonl") == 6 ]] || fail "cairn follow left no six frames"
  inside cairn live /usr/share/doc/cairn/sequences/rolling_ball --pace 0 --every-frame --record /tmp/run.mcap
  inside cairn follow /tmp/run.mcap -o /tmp/recorded
  [[ $(wc -l <"$root/tmp/recorded/tracks.jsonl") == 6 ]] || fail "the recording of cairn live has no six frames"
fi
inside cairn batch plan /usr/share/doc/cairn/examples -o /tmp/archive
inside cairn batch work /tmp/archive
inside cairn batch merge /tmp/archive -o /tmp/archive.jsonl
[[ $(wc -l <"$root/tmp/archive.jsonl") == "$(ls -d "$source_dir"/data/samples/*/ | wc -l)" ]] || fail "cairn batch left other rows"
[[ -x $root/usr/share/doc/cairn/examples/batch/parallel.sh ]] || fail "no examples of batch runs"
inside cairn evaluate /tmp/demo/four_in_a_row /usr/share/doc/cairn/examples/four_in_a_row
[[ -s $root/usr/share/man/man1/cairn-segment.1.gz ]] || fail "no manual page"
inside bash -c 'source /usr/share/bash-completion/completions/cairn && complete -p cairn' >/dev/null ||
  fail "bash completion cannot be sourced"

# expect_refusal WORDS ARGUMENTS...: cairn must end with exit code 2 and one line with WORDS, which shows that the
# module was loaded.
expect_refusal() {
  local words=$1 code=0 said
  shift
  said=$(inside cairn "$@" 2>&1 >/dev/null) || code=$?
  [[ $code == 2 && $said == *"$words"* && $(wc -l <<<"$said") == 1 ]] || fail "cairn $*: exit code $code, $said"
}
# try_module PACKAGE WORDS ARGUMENTS...: without PACKAGE cairn must name it; with it the module must answer.
try_module() {
  local package=$1
  compgen -G "$packages/${package}_*.deb" >/dev/null || return 0
  expect_refusal "$package" "${@:3}"
  install_inside "$(packages_named "$package")"
  expect_refusal "${@:2}"
  echo "$package"
}
say "modules"
echo "no video" >"$root/tmp/broken.mp4"
try_module cairn-video "cannot be opened as a video" follow /tmp/broken.mp4 --layout side_by_side
try_module cairn-gstreamer 'no element "no_such_element"' follow gst:no_such_element
# Without the packages that it recommends there is no driver.
try_module cairn-vulkan "finds no driver" segment /usr/share/doc/cairn/examples/four_in_a_row --device nonsense
try_module cairn-ros2 "received nothing on /nothing" follow ros2:/nothing --open-timeout 1

say "headers and libraries for C++"
install_inside "$(packages_named libcairn-dev)" g++ cmake make pkg-config libopencv-core-dev
cp -r "$source_dir/tests/consumer" "$root/cairn/consumer"
inside cmake -S /cairn/consumer -B /cairn/build >/dev/null
inside cmake --build /cairn/build -- --no-print-directory >/dev/null
inside /cairn/build/core
inside /cairn/build/matrices
[[ ! -x $root/cairn/build/sequences ]] ||
  inside /cairn/build/sequences /usr/share/doc/cairn/sequences/rolling_ball /tmp/demo/by_library.db
inside /cairn/build/files /usr/share/doc/cairn/examples/overlap /tmp/demo/by_library
# shellcheck disable=SC2016  # for the shell inside
inside bash -c 'g++ -std=c++20 /cairn/consumer/core.cpp -o /cairn/core $(pkg-config --cflags --libs cairn) && /cairn/core'

if compgen -G "$packages/python3-cairn_*.deb" >/dev/null; then
  say "Python"
  install_inside "$(packages_named python3-cairn)"
  inside python3 - /usr/share/doc/cairn/examples/four_in_a_row /tmp/demo/four_in_a_row <<'PYTHON'
import json, pathlib, pickle, sys
import cairn
folder, result = map(pathlib.Path, sys.argv[1:])
frame = cairn.segment(*cairn.load_pair(folder / "left.png", folder / "right.png"), cairn.load_calibration(folder / "calib.txt"))
by_command = json.loads((result / "objects.json").read_text())["objects"]
assert [o.pixel_count for o in frame.objects] == [o["area"] for o in by_command], frame
assert repr(pickle.loads(pickle.dumps(frame))) == repr(frame)
print("import cairn:", len(frame.objects), "objects, those of the command")
PYTHON
fi

say "removal"
mapfile -t ours < <(inside dpkg-query -W -f '${db:Status-Status} ${Package}\n' | sed -n 's/^installed \(.*cairn.*\)/\1/p')
inside apt-get purge --yes "${ours[@]}" >/dev/null 2>&1
left=$(inside find /usr -name 'cairn*' -o -name 'libcairn*')
[[ -z $left ]] || fail "left behind: $left"
echo "installed, used and removed on Debian $(cat "$root/etc/debian_version")"
