#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# io_headers_move.sh SOURCE_DIR: no header of io/ names another by <io/...>, a path that an installed cairn does not have.
set -euo pipefail
cd "$1"
! grep -n '#include <io/' io/*.hpp
