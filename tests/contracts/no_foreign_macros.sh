#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# no_foreign_macros.sh COMPILER SOURCE_DIR: checks that including the whole library defines no macro, neither of its
# dependencies nor its own.
set -euo pipefail
macros=$(echo '#include <cairn/cairn.hpp>' | "$1" -std=c++20 -I"$2" -dM -E -x c++ -)
grep -q '#define __cplusplus' <<<"$macros" || { echo "no macro at all: the preprocessor printed nothing"; exit 1; }
! grep -E '#define (HWY_|CV_|TBB_|__TBB_|CAIRN_)' <<<"$macros"
