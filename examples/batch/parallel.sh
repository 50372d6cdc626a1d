#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# parallel.sh RUN [SHARDS [OPTIONS...]]: a batch run with GNU parallel, one shard per processor at a time. OPTIONS go
# to parallel: --sshlogin host1,host2 for machines that share the folders.
set -euo pipefail
run=$1 shards=${2:-$(nproc)}
shift $(($# < 2 ? $# : 2))
seq "$shards" | parallel --joblog "$run/joblog" --halt now,fail=1 "$@" \
  "${CAIRN:-cairn}" batch work "$run" --shard "{}/$shards" --threads 1
