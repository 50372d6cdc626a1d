#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# man_pages.sh CAIRN DIR: makes manual pages by help2man from the output of --help and `cairn config`: of the command
# and its subcommands in DIR/man1, and of the stages' options, cairn-options(7), in DIR/man7.
set -euo pipefail
cairn=$1 dir=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir -p "$dir/man1" "$dir/man7"
version=$("$cairn" --version)

page() {  # NAME SECTION TITLE < text
  # help2man names a page after the program that it runs.
  { echo "cat <<'TEXT'" && cat && echo TEXT; } >"$scratch/$1"
  chmod +x "$scratch/$1"
  help2man --no-info --locale C.UTF-8 --section "$2" --name "$3" --manual cairn --source "$version" \
    --version-string "${version#cairn }" --include "$scratch/see_also" --output "$dir/man$2/$1.$2" "$scratch/$1"
}

help_of() {  # [COMMAND]: marks the sections for help2man, and the examples as shell lines
  "$cairn" "$@" --help | sed 's/^Positionals:/*Arguments*/; s/^Subcommands:/*Commands*/; s/^  cairn /  $ cairn /'
}

commands=$("$cairn" --help | awk '/^Subcommands:/ { on = 1; next } on && !NF { exit } on { print $1 }')
# shellcheck disable=SC2086  # words
{ echo '[SEE ALSO]' && printf '.BR cairn\\-%s (1),\n' $commands && echo '.BR cairn\-options (7)'; } >"$scratch/see_also"

help_of | page cairn 1 "$("$cairn" --help | sed -n '1s/^cairn: //p')"
for name in $commands; do
  help_of "$name" | page "cairn-$name" 1 "$("$cairn" "$name" --help | sed -n 1p)"
done
# | `name` | `default` | unit | values | meaning | `read while` |
"$cairn" config --markdown | awk -F ' [|] ' '
  BEGIN { print "Set one with --set NAME=VALUE, several in a file with --config FILE, which cairn config prints.\n\n*Options*" }
  /^\| `/ {
    gsub(/`|^\| /, ""); sub(/ \|.*/, "", $5); gsub(/\\\|/, "|")
    print "  " $1 (length($1) > 30 ? "\n                                " : "  ") $5 \
      " (" ($3 == "" ? "" : $3 "; ") ($2 == "" ? "" : "default: " $2 "; ") "values: " $4 ")" }' |
  page cairn-options 7 "options of the stages"
