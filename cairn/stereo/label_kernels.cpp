// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/stereo/label_kernels.hpp>
#include <cairn/stereo/label_kernels_plain.hpp>

#define CAIRN_KERNELS "cairn/stereo/label_kernels-inl.hpp"
#define CAIRN_KERNELS_USE_VECTORS
#include <cairn/core/each_target-inl.hpp>

CAIRN_CHOOSE_KERNELS(LabelKernels, label_kernels, kLabelKernels)
