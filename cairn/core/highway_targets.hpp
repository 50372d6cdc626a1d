// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

/// Which of Highway's targets are compiled: only what Target names. To be included before any header of
/// Highway's. SSSE3 alone, the finer kinds of AVX-512 and Highway's emulation are never asked for; vectors
/// whose length is known at run time only (SVE) cannot stand in an array.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
