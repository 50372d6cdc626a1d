#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# io_headers_move.sh SOURCE_DIR: checks that no header of io/, page/, tracking/, landmarks/ or source/ includes
# another as <io/...> or similar, because an installed cairn does not have these paths.
set -euo pipefail
cd "$1"
! grep -nE '#include <(io|page|tracking|landmarks|source)/' {io,page,tracking,landmarks,source}/*.hpp source/*/*.hpp
