// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/exec.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/grouping/look_kernels.hpp>
#include <cairn/grouping/looks.hpp>
#include <cstdint>
#include <memory_resource>
#include <vector>

namespace cairn {

/// How near to each other and how alike facets are: an exponential of squared deviations, 1 = the same. Those
/// that are more than three deviations apart in one way are not alike at all. Private to the library.
class Likeness {
 public:
  explicit Likeness(int width);
  /// The most pixels between two that are near each other.
  [[nodiscard]] int most_across() const { return static_cast<int>(squares_across_.size()) - 1; }
  [[nodiscard]] int most_down() const { return static_cast<int>(squares_down_.size()) - 1; }
  /// The logarithm of the likeness; positive where two are not alike.
  [[nodiscard]] double logarithm(const Look& here, const Look& there) const;

  static constexpr double kSpread = 6;    // grey levels
  static constexpr double kFarthest = 9;  // squared deviations

 private:
  std::vector<double> squares_across_;  // of so many pixels, in deviations
  std::vector<double> squares_down_;
};

/// Facets that count, to be asked for those that are like another one. Private to the library.
class LikeFacets {
 public:
  /// Those of `looks` whose `pixels` are more than 0. `looks`, `likeness` and `memory` are borrowed.
  LikeFacets(const std::pmr::vector<Look>& looks, const std::pmr::vector<double>& pixels,
             const Likeness& likeness, const Exec& exec, std::pmr::memory_resource* memory);

  /// Lists of the facets that one facet may be like; working memory.
  struct Work {
    explicit Work(const LikeFacets& of) : found(of.entries_.size() + kernels::kLookSlack) {}
    std::vector<std::int32_t> found;
    std::vector<double> pixels;
    std::vector<double> likeness;  // at first its logarithm
  };

  /// The pixels of those that facet i is near to, each weighed with its likeness, summed. Of a sum that is
  /// `enough` or more only that is sure: most are many times that, and few facets are needed to know it.
  double pixels_like(std::size_t i, double enough, Work& work) const;

 private:
  static constexpr int kBins = 16;
  static constexpr int kBinWidth = 256 / kBins;  // grey levels

  struct Entry {
    std::int32_t facet = 0;
    double pixels = 0;  // that count
  };
  struct Range {
    std::int32_t first = 0;
    std::int32_t last = 0;
  };

  static double grey_of(const Look& look) { return (look.colour[0] + look.colour[1] + look.colour[2]) / 3; }
  static int bin_of(double grey);
  void sort_by_grey(const std::pmr::vector<double>& pixels);
  [[nodiscard]] const Look& look_of(const Entry& entry) const { return looks_[slot(entry.facet)]; }
  [[nodiscard]] Range bin(int number) const;
  [[nodiscard]] std::int32_t first_from(int row, Range among) const;
  [[nodiscard]] kernels::LookArrays arrays() const;
  [[nodiscard]] kernels::LookWindow window_about(const Look& look) const;
  double add_found(std::size_t i, Range among, double sum, Work& work) const;
  double add_tall(std::size_t i, double sum, Work& work) const;
  double add_up(double sum, Work& work) const;
  void take(std::size_t i, const Entry& entry, Work& work) const;
  [[nodiscard]] bool are_surely(double enough, std::size_t i, Work& work) const;

  const kernels::LookKernels& run_;
  const std::pmr::vector<Look>& looks_;
  const Likeness& likeness_;
  std::pmr::vector<Entry> tall_;
  bool in_order_ = true;
  // Sorted by grey; what is tested first in one list per quantity.
  std::array<std::int32_t, kBins + 1> bin_end_{};
  std::pmr::vector<Entry> entries_;
  std::array<std::pmr::vector<std::int32_t>, 4> sides_;
  std::array<std::pmr::vector<float>, 3> channels_;
};

}  // namespace cairn
