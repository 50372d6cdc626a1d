// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

/// The Highway targets that are compiled: those of Target, and the two without vectors that Highway requires.
/// Newer versions of Highway know more targets; those are not compiled. Include before any Highway header.
#define HWY_DISABLED_TARGETS (~(HWY_SSE4 | HWY_AVX2 | HWY_AVX3 | HWY_NEON | HWY_EMU128 | HWY_SCALAR))
