#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# build.sh BUILD_DIR: builds a site in build/docs/site from the pages, the C++ reference and, if BUILD_DIR has the
# module, the Python reference; checks every link.
set -euo pipefail
build_dir=$(cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
for program in mkdocs doxygen; do
  command -v "$program" >/dev/null || { echo "skipped: there is no $program"; exit 77; }
done
python=/usr/bin/python3  # Debian's: the module and mkdocs are installed for it

module=()
compgen -G "$build_dir/python/cairn/*.so" >/dev/null && module=("$build_dir")
config=build/docs/mkdocs.yml
"$python" docs/site/assemble.py . build/docs/pages "${module[@]}"
# Without the module, its page is removed from the table of contents.
sed ${module[0]:+-e 's|^\( *\)- C++: .*|&\n\1- Python: api/python.md|'} -e '' docs/site/mkdocs.yml >"$config"
mkdir -p build/docs/pages/api
cp docs/site/wide.css build/docs/pages/
doxygen docs/site/Doxyfile
mkdocs build --strict --config-file "$config" >build/docs/mkdocs.log 2>&1 || {
  grep -v INFO build/docs/mkdocs.log >&2
  exit 1
}
"$python" docs/site/check_links.py build/docs/site
