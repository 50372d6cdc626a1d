#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# release.sh [--check|--versions]: prepares the release of the last commit in dist/VERSION: source archive, Debian
# packages, Python wheel, ROS package, release notes, third parties, checksums. VERSION is that of project() in
# CMakeLists.txt. With --check, only checks whether it could; with --versions, only whether the files that repeat the
# version agree. Called by ./dev release; uses no network, except that ./dev may install packages.
# Whatever speaks against a release is one line on stderr and exit code 2; dist/VERSION appears complete or not at all.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export LC_ALL=C.UTF-8

refuse() { printf 'release: %s\n' "$*" >&2; exit 2; }
say() { printf '\n== %s\n' "$*"; }

mode=${1:-}
[[ $# -le 1 && ( -z $mode || $mode == --check || $mode == --versions ) ]] ||
  refuse "unknown argument '${*: -1}', expected --check or none"

# ---- what speaks against it, the quick checks first -----------------------------------------------------------

version=$(sed -n 's/^project(cairn VERSION \([0-9.]*\) .*/\1/p' CMakeLists.txt)
[[ $version =~ ^[0-9]+\.[0-9]+\.[0-9]+$ ]] ||
  refuse "CMakeLists.txt: found version '$version' in project(), expected three numbers"
repeated() {  # FILE FOUND EXPECTED
  [[ $2 == "$3" ]] || refuse "$1: found version '$2', expected $3 as in CMakeLists.txt"
}
repeated ros2/package.xml "$(sed -n 's|.*<version>\(.*\)</version>.*|\1|p' ros2/package.xml)" "$version"
repeated CITATION.cff "$(sed -n 's/^version: *//p' CITATION.cff)" "$version"
for page in docs/install.md tests/consumer/CMakeLists.txt; do
  repeated "$page" "$(sed -n '0,/.*find_package(cairn \([0-9.]*\) .*/s//\1/p' "$page")" "${version%.*}"
done
repeated docs/install.md "$(sed -n '0,/.*`libcairn\([0-9][0-9.]*\)`.*/s//\1/p' docs/install.md)" "${version%.*}"
[[ $mode != --versions ]] || exit 0

commit=$(git rev-parse --verify --quiet HEAD) || refuse "$PWD: no commit, expected a git repository"
changed() { git status --porcelain | sed -n '1s/^...//p'; }
[[ -z $(changed) ]] || refuse "the tree has uncommitted changes, the first is $(changed); commit or stash them"
for tag in "v$version" "$version"; do
  ! git rev-parse --verify --quiet "refs/tags/$tag" >/dev/null ||
    refuse "version $version is already tagged ($tag); raise it in CMakeLists.txt"
done
notes=$(awk -v title="## [$version]" '
  /^## / { inside = index($0, title) == 1 && $0 ~ / - [0-9]+-[0-9][0-9]-[0-9][0-9]$/ }
  inside' CHANGELOG.md)
[[ -n $notes ]] || refuse "CHANGELOG.md: no section '## [$version] - YEAR-MONTH-DAY'"
grep -q '^- ' <<<"$notes" || refuse "CHANGELOG.md: the section of $version is empty"
[[ ! -e dist/$version ]] || refuse "dist/$version exists already; remove it to prepare the release again"

# ./dev test leaves the commit it passed with.
if [[ $(cat build/ci/tested 2>/dev/null) == "$commit" ]]; then
  say "./dev test has passed with this commit"
  ./dev build ci || refuse "./dev build ci failed"
else
  say "./dev test"
  ./dev test || refuse "./dev test failed"
fi
say "the generated pages"
docs/update.sh --check build/ci || refuse "generated pages are stale; ./dev docs regenerates them"
[[ -z $(changed) && $(git rev-parse HEAD) == "$commit" ]] || refuse "the tree has changed during the tests"
if [[ $mode == --check ]]; then
  say "nothing speaks against the release of $version"
  exit 0
fi

# ---- the files -------------------------------------------------------------------------------------------------

SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
export SOURCE_DATE_EPOCH
mkdir -p dist
new=$(mktemp -d dist/.new-XXXXXX)
trap 'rm -rf "$new"; rmdir dist 2>/dev/null || true' EXIT
chmod 755 "$new"

# The same bytes for the same commit.
archive() {  # NAME PATH…: of the last commit
  local name=$1 work
  shift
  work=$(mktemp -d)
  mkdir "$work/$name"
  git archive HEAD "$@" | tar -x -C "$work/$name"
  tar --sort=name --format=ustar --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner --mode=go=rX,u+rw \
    -C "$work" -c "$name" | gzip -9n >"$new/$name.tar.gz"
  rm -rf "$work"
}

# The licences' names in a package's copyright file.
licences_of() {  # PACKAGE
  local file=/usr/share/doc/$1/copyright names
  [[ -r $file ]] || { echo "no $file"; return; }
  names=$(sed -n 's/^License: *\([^ ].*\)$/\1/p' "$file" | tr -d '|\t' | sort -u | paste -sd ';' | sed 's/;/; /g')
  echo "${names:-see $file}"
}

third_party_row() {  # PACKAGE HOW
  local known
  known=$(dpkg-query -W -f '${Version}' "$1" 2>/dev/null) || known="not installed"
  echo "| $1 | ${known:-not installed} | $2 | $(licences_of "$1") |"
}

third_parties() {
  cat <<TEXT
# Third parties of cairn $version

Nothing of these is in the source archive. The packages and the wheel use the shared libraries of the system; headers and templates of some are compiled in. Versions and licences are those of the packages with which this release was built, as Debian's copyright files name them; a file may name licences that only its tests or its build files have.

| package | version | how it is used | licences named in its copyright file |
|---|---|---|---|
TEXT
  local deb package boost
  # libboost-dev only depends on the package with the headers.
  boost=$(dpkg-query -W -f '${Depends}' libboost-dev 2>/dev/null | sed 's/[ (,].*//') || true
  for deb in "$new"/*.deb; do dpkg-deb -f "$deb" Depends; done |
    tr ',|' '\n\n' | sed 's/(.*//; s/ //g; /^$/d; /cairn/d' | sort -u |
    while read -r package; do third_party_row "$package" "at run time"; done
  for package in ${boost:-libboost-dev} libcli11-dev libdlib-dev libeigen3-dev libhwy-dev libsqlitecpp-dev libvulkan-dev nlohmann-json3-dev pybind11-dev; do
    third_party_row "$package" "compiled in"
  done
}

say "archives"
archive "cairn-$version" .
archive "cairn_ros-$version" ros2 LICENSE
say "Debian packages"
./dev package || refuse "./dev package failed"
cp build/package/debs/*.deb "$new/"
say "Python wheel"
/usr/bin/python3 - "$new" <<'PYTHON' || refuse "the wheel could not be built"
import sys
sys.path.insert(0, "python/tools")
import pip_backend
print(pip_backend.build_wheel(sys.argv[1]))
PYTHON
say "notes, third parties, checksums"
printf '%s\n' "$notes" >"$new/RELEASE_NOTES.md"
third_parties >"$new/THIRD_PARTIES.md"
(cd "$new" && sha256sum -- * >../.sums && mv ../.sums SHA256SUMS)
[[ -z $(changed) && $(git rev-parse HEAD) == "$commit" ]] || refuse "the tree has changed while the release was built"
mv -T "$new" "dist/$version"
say "dist/$version"
ls "dist/$version"
