#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# links_exist.sh SOURCE_DIR: checks that every relative link of every page leads to an existing file, and every
# #fragment to a heading.
set -euo pipefail
cd "$1"

# Anchors in GitHub's form: lower case, no punctuation, hyphens for spaces.
anchors() {
  awk '/^```/ { code = !code } !code && /^#+ / { sub(/^#+ +/, ""); print tolower($0) }' "$1" |
    sed -E 's/[^[:alnum:] _-]//g; s/ /-/g'
}

bad=0 links=0
while read -r page; do
  while read -r target; do
    [[ $target =~ ^(https?:|mailto:) ]] && continue
    links=$((links + 1))
    file=${target%%#*}
    path=${file:+$(dirname "$page")/$file}
    path=${path:-$page}
    if [[ ! -e $path ]]; then
      echo "$page: $target: no such file"
      bad=1
    elif [[ $target == *#* && $path == *.md ]] && ! anchors "$path" | grep -xF -- "${target#*#}" >/dev/null; then
      echo "$page: $target: no such heading"
      bad=1
    fi
  done < <(awk '/^```/ { code = !code } !code' "$page" | sed -E 's/`[^`]*`//g' |
    grep -oE '(\]\([^) ]+\)|src="[^"]+")' | sed -E 's/^(\]\(|src=")//; s/[)"]$//')
done < <(find . -name '*.md' -not -path './build/*' -not -path './.git/*' | sort)
echo "$links links"
[[ $links -gt 0 && $bad == 0 ]]
