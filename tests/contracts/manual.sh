#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# manual.sh CAIRN MANUAL_DIR: checks that the manual pages, if help2man made them, are valid roff and have every
# command and option of --help; and that bash completes commands, options, values, files and option names.
set -euo pipefail
cairn=$1 manual=$2
bad=0
complain() { echo "$*"; bad=1; }

# ---- manual pages ----

mapfile -t commands < <("$cairn" --help | awk '/^Subcommands:/ { on = 1; next } on && NF { print $1 } on && !NF { exit }')
((${#commands[@]} > 0)) || complain "cairn --help tells no commands"

page_as_text() { groff -k -man -Tascii -P-cbou -rLL=400n "$1" 2>/dev/null; }

with_pages=no
if command -v help2man >/dev/null; then with_pages=yes; fi
for name in "" "${commands[@]}"; do
  [[ $with_pages == yes ]] || break
  page=$manual/man1/cairn${name:+-$name}.1
  [[ -e $page ]] || { complain "$page is missing"; continue; }
  command -v groff >/dev/null || continue
  warnings=$(groff -k -ww -man -Tutf8 "$page" 2>&1 >/dev/null)
  [[ -z $warnings ]] || complain "$page: $warnings"
  text=$(page_as_text "$page")
  [[ -z $name || $text == *EXAMPLES*"cairn $name"* ]] || complain "$page has no example"
  while read -r option; do
    [[ $text == *"$option"* ]] || complain "$page does not tell of $option"
  done < <("$cairn" ${name:+"$name"} --help | grep -oE '^ +(-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+')
done
while read -r option; do
  [[ $with_pages == no ]] || grep -qFx -- "$option" "$manual/man7/cairn-options.7" ||
    complain "cairn-options(7) does not tell of $option"
done < <("$cairn" config --markdown | sed -nE 's/^\| `([^`]+)`.*/\1/p')

# ---- completion ----

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/some folder"
touch "$scratch/left.png"

expect() {  # WHAT EXPECTED FOUND
  [[ $2 == "$3" ]] || complain "$1: expected '$2', found '$3'"
}

bash_offers() {  # WORD...: completions of the last word
  (
    cd "$scratch"
    # shellcheck disable=SC1091
    source "$manual/bash-completion/completions/cairn"
    COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
    _cairn
    printf '%s\n' "${COMPREPLY[@]}" | sort | paste -sd' '
  )
}
expect "bash: a command" segment "$(bash_offers cairn seg)"
expect "bash: an option" "--calib --config" "$(bash_offers cairn segment --c)"
expect "bash: after a flag" "--threads" "$(bash_offers cairn segment --json --thr)"
expect "bash: a preset" paper "$(bash_offers cairn segment --preset pa)"
expect "bash: a preset behind =" paper "$(bash_offers cairn segment --preset = pa)"
expect "bash: a file" "left.png" "$(bash_offers cairn segment le)"
expect "bash: a folder" "some folder" "$(bash_offers cairn segment left.png -o '')"
expect "bash: an option's name" "match.method=" "$(bash_offers cairn segment --set match.me)"
expect "bash: an option's value" "semi_global window" "$(bash_offers cairn segment --set match.method =)"
expect "bash: a started value" "window" "$(bash_offers cairn segment --set match.method = w)"
expect "bash: a command's help" "config" "$(bash_offers cairn help conf)"
expect "bash: what may be tuned" "superpixels.* superpixels.count" "$(bash_offers cairn tune --options superp | tr ' ' '\n' | sort | sed -n 1,2p | paste -sd' ')"
expect "bash: a number" "" "$(bash_offers cairn segment --threads '')"
expect "bash: commands" "$(printf '%s\n' "${commands[@]}" | sort | paste -sd' ')" \
  "$(bash_offers cairn '' | tr ' ' '\n' | grep -v '^-' | paste -sd' ')"
[[ $(bash -c "source '$manual/bash-completion/completions/cairn'; complete -p cairn") == *_cairn* ]] ||
  complain "bash: nothing is registered for cairn"

[[ $bad == 0 ]]
