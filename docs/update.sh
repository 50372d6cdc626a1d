#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# update.sh [--check|--pictures] BUILD_DIR: regenerates the generated parts of the pages; with --check, only reports
# which are stale.
#   docs/options.md                         `cairn config --markdown`
#   <!-- code: FILE#NAME -->                the lines of FILE between `// [NAME]` and `// [/NAME]` (or `# [NAME]`)
#   <!-- output: COMMAND ARGUMENTS -->      stdout of the program COMMAND in BUILD_DIR, without times; SCRATCH in
#                                           ARGUMENTS is replaced by a temporary folder
# A marker is followed by a fenced block, which is replaced. docs/images is regenerated with --pictures only, since
# every new image stays in the repository's history.
set -euo pipefail
check=no pictures=no
case $1 in
  --check) check=yes; shift ;;
  --pictures) pictures=yes; shift ;;
esac
build_dir=$(cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

options_page() {
  cat <<'TEXT'
# Options

<!-- Written by ./dev docs from `cairn config --markdown`; do not edit. -->

Look up here every option of every stage, with its value in the presets `default` and `paper` (empty: the same as in `default`).
Set one with `--set stage.name=value`, several in a file with `--config FILE` ([format](formats.md)). `cairn config --preset P` prints the options in force.
An option with a condition in the last column is refused while the condition does not hold.
TEXT
  # One heading per stage, and the paper's value next to the default.
  awk -F'|' '
    !/^\| `/ { next }
    NR == FNR { paper[$2] = $3; next }
    {
      split($2, name, /[`.]/)
      if (name[2] != section) {
        section = name[2]
        printf "\n## %s\n\n| option | default | paper | unit | values | meaning | read while |\n|---|---|---|---|---|---|---|\n", section
      }
      rest = substr($0, length($2) + length($3) + 3)
      printf "|%s|%s|%s%s\n", $2, $3, paper[$2] == $3 ? " " : paper[$2], rest
    }' <("$build_dir/cairn" config --preset paper --markdown) <("$build_dir/cairn" config --markdown)
  cat <<'TEXT'

# Options of a sequence

`cairn follow` reads these in addition to those above; `cairn config --sequence` prints them.
TEXT
  awk -F'|' '
    !/^\| `/ { next }
    {
      split($2, name, /[`.]/)
      if (name[2] != section) {
        section = name[2]
        printf "\n## %s\n\n| option | default | unit | values | meaning | read while |\n|---|---|---|---|---|---|\n", section
      }
      print
    }' <("$build_dir/cairn" config --sequence --markdown)
}

code_of() {  # FILE#NAME
  awk -v name="${1#*#}" '
    $0 ~ "(//|#) \\[/" name "\\]" { shown = 0 }
    shown { print substr($0, match($0, /[^ ]/) > indent ? indent + 1 : 1); found = 1 }
    $0 ~ "(//|#) \\[" name "\\]" { shown = 1; indent = match($0, /[^ ]/) - 1 }
    END { exit !found }' "${1%%#*}"
}

output_of() {  # COMMAND ARGUMENTS
  local words
  read -ra words <<<"${1//SCRATCH/$scratch}"
  "$build_dir/${words[0]}" "${words[@]:1}" | sed -E 's/, [0-9.]+ ms$//'
}

# The page with the block after each marker regenerated.
page_anew() {
  local line
  while IFS= read -r line; do
    printf '%s\n' "$line"
    [[ $line =~ ^'<!-- '(code|output):' '(.*)' -->'$ ]] || continue
    local kind=${BASH_REMATCH[1]} source=${BASH_REMATCH[2]}
    IFS= read -r line
    [[ $line == '```'* ]] || { echo "$1: no block after the marker of $source" >&2; return 1; }
    printf '%s\n' "$line"
    while IFS= read -r line && [[ $line != '```' ]]; do :; done
    "${kind}_of" "$source" || { echo "$1: cannot make $source" >&2; return 1; }
    printf '```\n'
  done <"$1"
}

stale=0
put() {  # FILE < expected contents
  local contents
  contents=$(cat)
  if [[ -e $1 && $contents == "$(cat "$1")" ]]; then
    return
  elif [[ $check == yes ]]; then
    echo "$1 is stale; ./dev docs regenerates it:"
    diff -u "$1" - <<<"$contents" || true
    stale=1
  else
    printf '%s\n' "$contents" >"$1"
    echo "wrote $1"
  fi
}

contents=$(options_page)
put docs/options.md <<<"$contents"
while read -r page; do
  contents=$(page_anew "$page")
  put "$page" <<<"$contents"
done < <(find . -name '*.md' -not -path './build/*' | xargs grep -lE '^<!-- (code|output): ' | sort)

picture() {  # FILE NAME
  cp "$1" "docs/images/$2.png"
  # 256 colours suffice for a page and take a third of the bytes.
  if command -v pngquant >/dev/null; then pngquant --force --ext .png 256 "docs/images/$2.png"; fi
  echo "wrote docs/images/$2.png"
}

# A screenshot of a page in a browser.
screenshot() {  # PAGE FILE
  chromium --headless --no-sandbox --disable-gpu --hide-scrollbars --window-size=1280,1180 --virtual-time-budget=4000 \
    --screenshot="$2" "file://$1" >/dev/null 2>&1
}

if [[ $pictures == yes ]]; then
  mkdir -p docs/images
  "$build_dir/cairn" segment data/samples --html -o "$scratch/results" >/dev/null
  "$build_dir/cairn" evaluate "$scratch/results" data/samples --html "$scratch" >/dev/null
  for kind in overlay disparity_view; do picture "$scratch/results/four_in_a_row/$kind.png" $kind; done
  "$build_dir/cairn" disparity data/samples/overlap --view "$scratch/matched.png" >/dev/null
  "$build_dir/cairn" disparity data/samples/overlap --refined --view "$scratch/refined.png" >/dev/null
  for kind in matched refined; do picture "$scratch/$kind.png" "disparity_$kind"; done
  "$build_dir/cairn" segment data/outdoors -o "$scratch/outdoors" >/dev/null
  for place in street yard lawn; do picture "$scratch/outdoors/$place/overlay.png" "outdoors_$place"; done
  if command -v chromium >/dev/null; then
    screenshot "$scratch/results/segment.html#2" "$scratch/segment.png"
    screenshot "$scratch/evaluation.html#2" "$scratch/evaluation.png"
    picture "$scratch/segment.png" segment_page
    picture "$scratch/evaluation.png" evaluation_page
  else
    echo "no chromium: screenshots are not updated" >&2
  fi
fi
[[ $stale == 0 ]]
