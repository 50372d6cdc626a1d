// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

/// Which of Highway's targets are compiled: what Target names, and Highway's stand-in for no vectors at all,
/// which it wants to exist. Newer versions know ever more of them; none is compiled unasked. To be included
/// before any header of Highway's.
#define HWY_DISABLED_TARGETS (~(HWY_SSE4 | HWY_AVX2 | HWY_AVX3 | HWY_NEON | HWY_EMU128 | HWY_SCALAR))
