#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# commands_answer_help.sh CAIRN: checks that every command answers --help on stdout with its name and exit code 0, and
# wrong usage with exit code 2 and one line on stderr.
set -euo pipefail
cairn=$1
bad=0
complain() { echo "$*"; bad=1; }

for name in "" segment follow live batch disparity evaluate bench tune doctor calibrate rectify record map odometry config info help; do
  if ! answer=$("$cairn" ${name:+"$name"} --help 2>/dev/null); then
    complain "cairn $name --help: exit code is not 0"
  fi
  [[ $answer == *"${name:-segment}"* ]] || complain "cairn $name --help does not name ${name:-segment}"
done

expect_usage_error() {
  local code=0 message
  message=$("$cairn" "$@" 2>&1 >/dev/null) || code=$?
  [[ $code == 2 ]] || complain "cairn $*: exit code $code, expected 2"
  [[ $(wc -l <<<"$message") == 1 && -n $message ]] || complain "cairn $*: expected one line on stderr, found: $message"
}
expect_usage_error no_such_command
expect_usage_error segment
expect_usage_error segment no/such/left.png no/such/right.png
expect_usage_error config --preset no_such_preset
expect_usage_error info --no-such-option

[[ $bad == 0 ]]
