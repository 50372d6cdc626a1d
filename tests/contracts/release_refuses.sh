#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# release_refuses.sh SOURCE_DIR: the files that repeat the version agree; packaging/release.sh refuses in one line what
# it must, leaves nothing behind then, and writes a complete folder otherwise. Runs it in a scratch repository, in which
# ./dev and the pages' script do nothing but succeed or fail.
set -euo pipefail
source_dir=$(cd "$1" && pwd)
command -v git >/dev/null && command -v dpkg-deb >/dev/null || { echo "skipped: no git or no dpkg-deb"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() { printf '%s\n' "$*" >&2; exit 1; }

"$source_dir/packaging/release.sh" --versions

export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null
repo=$scratch/repo
mkdir -p "$repo/packaging" "$repo/docs" "$repo/python/tools"
cp -r "$source_dir"/{CMakeLists.txt,CITATION.cff,LICENSE,ros2,.gitignore} "$repo/"
cp "$source_dir/packaging/release.sh" "$repo/packaging/"
mkdir -p "$repo/tests/consumer"
cp "$source_dir/docs/install.md" "$repo/docs/"
cp "$source_dir/tests/consumer/CMakeLists.txt" "$repo/tests/consumer/"
version=$(sed -n 's/^project(cairn VERSION \([0-9.]*\) .*/\1/p' "$repo/CMakeLists.txt")
printf '# Changelog\n\n## [%s] - 2026-01-02\n\n- A line.\n\n## [0.0.1] - 2025-01-02\n\n- Older.\n' "$version" >"$repo/CHANGELOG.md"
cat >"$repo/dev" <<'DEV'
#!/usr/bin/env bash
set -eu
echo "dev $*"
[[ ! -e $0.fails || $(cat $0.fails) != "$1" ]] || exit 1
if [[ $1 == package ]]; then
  mkdir -p build/package/debs build/deb/DEBIAN
  printf 'Package: cairn\nVersion: 1\nArchitecture: all\nMaintainer: a <a@b>\nDepends: libc6 (>= 2), libcairn0\nDescription: x\n' >build/deb/DEBIAN/control
  dpkg-deb --root-owner-group --build build/deb build/package/debs/cairn_1_all.deb
fi
DEV
cat >"$repo/docs/update.sh" <<'PAGES'
#!/usr/bin/env bash
[[ ! -e stale ]]
PAGES
printf 'def build_wheel(folder):\n    open(folder + "/cairn.whl", "w").close()\n    return "cairn.whl"\n' \
  >"$repo/python/tools/pip_backend.py"
printf '__pycache__/\n' >>"$repo/.gitignore"
chmod +x "$repo/dev" "$repo/docs/update.sh"
in_repo() { git -C "$repo" -c user.name=a -c user.email=a@localhost "$@"; }
in_repo init --quiet
commit() { in_repo add --all && in_repo commit --quiet --message "$1"; }
commit first

refuses() {  # WORDS ARGUMENTS…
  local words=$1 code=0
  shift
  "$repo/packaging/release.sh" "$@" >"$scratch/out" 2>"$scratch/err" || code=$?
  [[ $code == 2 && $(wc -l <"$scratch/err") == 1 ]] || fail "expected one line with '$words', exit code $code: $(cat "$scratch/err")"
  grep -qF -- "$words" "$scratch/err" || fail "expected '$words', found: $(cat "$scratch/err")"
  [[ ! -e $repo/dist ]] || fail "'$words' left dist/ behind"
}
again() { in_repo reset --quiet --hard HEAD~1; }  # undoes a commit

refuses "unknown argument '--chek'" --chek
echo >"$repo/new_file"
refuses "the tree has uncommitted changes, the first is new_file"
rm "$repo/new_file"
for tag in "v$version" "$version"; do
  in_repo tag "$tag"
  refuses "version $version is already tagged ($tag)"
  in_repo tag --delete "$tag" >/dev/null
done
refuses_with() {  # FILE SED_SCRIPT WORDS: with this edit committed
  sed -i "$2" "$repo/$1" && commit edit
  refuses "$3"
  again
}
refuses_with CHANGELOG.md "s/^## \[$version\].*/## [Unreleased]/" "CHANGELOG.md: no section '## [$version] - YEAR-MONTH-DAY'"
refuses_with CHANGELOG.md '/A line/d' "CHANGELOG.md: the section of $version is empty"
refuses_with ros2/package.xml 's|<version>.*</version>|<version>9.9.9</version>|' \
  "ros2/package.xml: found version '9.9.9', expected $version"
refuses_with CITATION.cff 's|^version: .*|version: 9.9.9|' "CITATION.cff: found version '9.9.9', expected $version"
refuses_with tests/consumer/CMakeLists.txt 's|find_package(cairn [0-9.]*|find_package(cairn 9.9|' \
  "tests/consumer/CMakeLists.txt: found version '9.9', expected ${version%.*}"
for command in test package; do
  echo $command >"$repo/dev.fails" && commit fails
  refuses "./dev $command failed"
  again
done
touch "$repo/stale" && commit stale
refuses "generated pages are stale" --check
again

"$repo/packaging/release.sh" --check >"$scratch/out"
grep -q '^dev test' "$scratch/out" || fail "the tests did not run"
[[ ! -e $repo/dist ]] || fail "--check wrote dist/"
mkdir -p "$repo/build/ci" && in_repo rev-parse HEAD >"$repo/build/ci/tested"
echo test >"$repo/dev.fails" && commit fails
refuses "./dev test failed"  # the stamp is of another commit
again
"$repo/packaging/release.sh" >"$scratch/out"
! grep -q '^dev test' "$scratch/out" || fail "the tests ran again for a commit that had passed"
made=$repo/dist/$version
(cd "$made" && sha256sum --quiet --check SHA256SUMS)
expected="RELEASE_NOTES.md SHA256SUMS THIRD_PARTIES.md cairn-$version.tar.gz cairn.whl cairn_1_all.deb cairn_ros-$version.tar.gz"
[[ $(cd "$made" && LC_ALL=C echo *) == "$expected" ]] || fail "found $(ls "$made"), expected $expected"
[[ $(ls -A "$repo/dist") == "$version" ]] || fail "dist/ has more than $version"
[[ $(cat "$made/RELEASE_NOTES.md") == $'## ['"$version"$'] - 2026-01-02\n\n- A line.' ]] || fail "other notes: $(cat "$made/RELEASE_NOTES.md")"
grep -q '^| libc6 | [0-9]' "$made/THIRD_PARTIES.md" || fail "libc6 is not among the third parties"
! grep -q '^| libcairn0 ' "$made/THIRD_PARTIES.md" || fail "cairn is among the third parties"
grep -qx "cairn_ros-$version/ros2/package.xml" <<<"$(tar -tzf "$made/cairn_ros-$version.tar.gz")" || fail "no ros2/package.xml"
before=$(sha256sum <"$made/cairn-$version.tar.gz")
code=0
"$repo/packaging/release.sh" 2>"$scratch/err" || code=$?
[[ $code == 2 ]] && grep -q "dist/$version exists already" "$scratch/err" || fail "an existing release is overwritten"
rm -rf "$repo/dist"
(umask 077 && "$repo/packaging/release.sh" >"$scratch/out")
[[ $(sha256sum <"$made/cairn-$version.tar.gz") == "$before" ]] || fail "the source archive has other bytes the second time"
