#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# io_headers_move.sh SOURCE_DIR: no header of io/ and page/ names another by <io/...> or <page/...>, paths that
# an installed cairn does not have.
set -euo pipefail
cd "$1"
! grep -nE '#include <(io|page)/' io/*.hpp page/*.hpp
