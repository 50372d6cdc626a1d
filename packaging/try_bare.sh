#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# try_bare.sh [ROOT]: runs `./dev demo` and `./dev test` of the last commit in a clean Debian 12 that has only git, as a
# new user would. Creates the root with debootstrap in ROOT (default: a temporary folder; an existing root is used as
# it is). Prints how many packages and how much disk each takes. Needs root, debootstrap and a Debian mirror
# (CAIRN_MIRROR). CAIRN_TRY=demo leaves out the tests.
set -euo pipefail
root=${1:-}
mirror=${CAIRN_MIRROR:-http://deb.debian.org/debian}
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf '\n-- %s\n' "$*"; }
fail() { printf 'try_bare: %s\n' "$*" >&2; exit 1; }

[[ $(id -u) == 0 ]] || fail "needs root, for debootstrap and chroot"
command -v debootstrap >/dev/null || fail "needs debootstrap: apt-get install debootstrap"

leave() {
  local code=$? part
  for part in proc dev/shm; do
    if mountpoint -q "$root/$part"; then umount "$root/$part"; fi
  done
  if [[ -n ${scratch:-} ]]; then rm -rf "$scratch"; fi
  exit "$code"
}
trap leave EXIT
if [[ -z $root ]]; then
  scratch=$(mktemp -d)
  root=$scratch/root
fi
inside() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
  ${CAIRN_JOBS:+CAIRN_JOBS=$CAIRN_JOBS} "$@"; }
size() { echo "$(inside dpkg-query -W -f '.\n' | wc -l) packages, $(du -smx "$root" | cut -f1) MB"; }

if [[ ! -x $root/usr/bin/apt-get ]]; then
  say "a clean Debian 12 in $root"
  debootstrap --variant=minbase --include=git,ca-certificates bookworm "$root" "$mirror" >/dev/null || fail "debootstrap failed"
fi
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
mountpoint -q "$root/dev/shm" || mount -t tmpfs tmpfs "$root/dev/shm"
# The host's access to a mirror: names, proxy.
cp /etc/resolv.conf "$root/etc/resolv.conf" 2>/dev/null || true
if [[ -n ${http_proxy:-} ]]; then echo "Acquire::http::Proxy \"$http_proxy\";" >"$root/etc/apt/apt.conf.d/90proxy"; fi
rm -rf "$root/root/cairn"
git clone --quiet --no-hardlinks "$source_dir" "$root/root/cairn"
echo "before: $(size)"

for command in demo ${CAIRN_TRY:-test}; do
  [[ $command != demo || ${done_demo:-no} == no ]] || continue
  done_demo=yes
  say "./dev $command"
  began=$SECONDS
  inside bash -c "cd /root/cairn && ./dev $command" || fail "./dev $command failed"
  echo "./dev $command: $((SECONDS - began)) s; now $(size)"
done
