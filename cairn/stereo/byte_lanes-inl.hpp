// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// No include guard: compiled once for each target; provides the vocabulary `bytes` for kernels. Sources
// include byte_lanes_plain.hpp before.
#if CAIRN_PLAIN_KERNELS
namespace cairn::kernels::plain_kernels {
namespace bytes = plain_bytes;
}
#else
#include <cairn/stereo/byte_lanes_highway-inl.hpp>
#endif
