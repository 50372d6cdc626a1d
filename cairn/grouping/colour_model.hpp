// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/grouping/look_kernels.hpp>
#include <cairn/grouping/looks.hpp>
#include <cstdint>
#include <memory_resource>
#include <vector>

namespace cairn {

/// How common colours are in the ground and in the figure. Colours are gathered in cells of the colour cube,
/// each with its own mean. Private to the library.
class ColourModel {
 public:
  /// `counted`: the pixels that each of `looks` counts, as ground where `figure` is 0, else as figure.
  ColourModel(const std::pmr::vector<Look>& looks, const std::vector<std::int32_t>& figure,
              const std::pmr::vector<double>& counted, const Exec& exec, std::pmr::memory_resource* memory);

  /// Logarithm of how many times as common a colour is in the ground as in the figure, −3 … 3. `work`:
  /// working memory.
  [[nodiscard]] double ground_over_figure(const Colour& colour, std::vector<double>& work) const;

  struct Bounds {
    double low = 0;
    double high = 0;
  };
  /// Close bounds of the same, several times as fast.
  [[nodiscard]] Bounds rough_ground_over_figure(const Colour& colour) const;

 private:
  [[nodiscard]] kernels::ColourCells cells() const;
  [[nodiscard]] double logarithm(const kernels::NearPixels& near) const;

  const kernels::LookKernels& run_;
  std::size_t count_ = 0;                    // of the cells
  std::array<std::vector<double>, 3> mean_;  // one list per channel, each with its slack
  std::array<std::vector<double>, 2> pixels_;
  std::array<double, 2> total_{};
};

}  // namespace cairn
