// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cstdint>

/// The kernels of filter_xsobel(), per pixel of a row; one set per instruction set. Private to the library.
namespace cairn::kernels {

struct PrefilterKernels {
  /// One row of filter_xsobel() from three rows of the image. Working memory: `columns`, one row.
  void (*filter_row)(const Gray* above, const Gray* here, const Gray* below, int width, int cap,
                     std::int16_t* columns, Gray* out);
};

/// The functions of this build for `target`, nullptr if it has none. Never nullptr for Target::scalar.
const PrefilterKernels* prefilter_kernels(Target target);
/// The functions for the active target of `exec`.
const PrefilterKernels& prefilter_kernels(const Exec& exec);

}  // namespace cairn::kernels
