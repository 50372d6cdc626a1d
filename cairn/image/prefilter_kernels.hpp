// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

/// The seam to the instruction sets: what filter_xsobel() does for each pixel of a row. Private to the
/// library.
namespace cairn::kernels {

struct PrefilterKernels {
  /// Out of three rows of an image one of filter_xsobel(). `columns`: room for a row.
  void (*filter_row)(const Gray* above, const Gray* here, const Gray* below, int width, int cap,
                     std::int16_t* columns, Gray* out);
};

/// The functions of this build for `target`, nullptr where it has none. Never nullptr for Target::scalar.
const PrefilterKernels* prefilter_kernels(Target target);
/// Those for the target that `exec` gets.
const PrefilterKernels& prefilter_kernels(const Exec& exec);

}  // namespace cairn::kernels
