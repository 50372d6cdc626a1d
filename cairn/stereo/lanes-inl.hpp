// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target; provides the vocabulary `lanes` for kernels. Sources
// include lanes_plain.hpp before.
#if CAIRN_PLAIN_KERNELS
namespace cairn::kernels::plain_kernels {
namespace lanes = plain;
}
#else
#include <cairn/stereo/lanes_highway-inl.hpp>
#endif
