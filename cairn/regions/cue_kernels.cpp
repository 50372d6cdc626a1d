// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/regions/cue_kernels.hpp>
#include <cairn/regions/region_cues.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <cmath>

#define CAIRN_KERNELS "cairn/regions/cue_kernels-inl.hpp"
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(CueKernels, cue_kernels, kCueKernels)
