// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target.
#if CAIRN_PLAIN_KERNELS
namespace cairn::kernels {
namespace plain_kernels = plain_labels;
}
#else
#include <cairn/stereo/label_kernels_highway-inl.hpp>
#endif
