// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <initializer_list>
#include <random>
#include <vector>

/// Images as text grids, readable in a test's source and in failure messages.
namespace cairn::grids {

/// An image from rows of numbers, converted to the pixel type (or ids).
template <class T, class Number = int>
Image<T> grid(std::initializer_list<std::initializer_list<Number>> rows) {
  const auto height = static_cast<int>(rows.size());
  Image<T> image(Size{static_cast<int>(rows.begin()->size()), height});
  int y = 0;
  for (const auto& row : rows) {
    int x = 0;
    for (const Number value : row) image(x++, y) = static_cast<T>(value);
    ++y;
  }
  return image;
}

/// The numbers of an image by rows, for printing and comparison.
template <class T>
std::vector<std::vector<std::int64_t>> numbers(View<const T> image) {
  std::vector<std::vector<std::int64_t>> rows;
  for (int y = 0; y < image.height(); ++y) {
    rows.emplace_back();
    for (int x = 0; x < image.width(); ++x) rows.back().push_back(static_cast<std::int64_t>(image(x, y)));
  }
  return rows;
}
template <class T>
std::vector<std::vector<std::int64_t>> numbers(const Image<T>& image) {
  return numbers(image.view());
}

/// Random pixels in `lowest` … `highest`. Few distinct values make plateaus, many make none.
template <class T>
Image<T> random_image(Size size, int lowest, int highest, std::uint32_t seed) {
  std::mt19937 random(seed);
  Image<T> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      // Not std::uniform_int_distribution: its results differ between standard libraries.
      image(x, y) =
          static_cast<T>(lowest + static_cast<int>(random() % static_cast<unsigned>(highest - lowest + 1)));
    }
  }
  return image;
}

}  // namespace cairn::grids
