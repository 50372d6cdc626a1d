// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/disparity/disparity_map.hpp>
#include <cairn/grouping/cue_kernels.hpp>
#include <cairn/grouping/region_cues.hpp>
#include <cmath>

#define CAIRN_KERNELS "cairn/grouping/cue_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(CueKernels, cue_kernels, kCueKernels)
