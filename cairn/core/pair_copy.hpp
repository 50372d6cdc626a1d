// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/stereo_pair.hpp>
#include <cstring>

namespace cairn {

/// A pair that owns its images, to find out later whether another is the same.
class PairCopy {
 public:
  PairCopy(const StereoPair& from, const Pool& pool)
      : left_(copied(from.left(), pool)),
        right_(copied(from.right(), pool)),
        left_rgb_(copied(from.left_rgb(), pool)) {}
  [[nodiscard]] StereoPair pair() const { return StereoPair::from(left_, right_, left_rgb_); }
  [[nodiscard]] bool equals(const StereoPair& pair) const {
    return is_equal<Gray>(left_, pair.left()) && is_equal<Gray>(right_, pair.right()) &&
           is_equal<Rgb>(left_rgb_, pair.left_rgb());
  }

 private:
  template <class T>
  static Image<T> copied(View<const T> from, const Pool& pool) {
    Image<T> copy(from.size(), pool);
    for (int y = 0; y < from.height(); ++y) std::copy_n(from.row(y), from.width(), copy.row(y));
    return copy;
  }
  template <class T>
  static bool is_equal(View<const T> a, View<const T> b) {
    if (a.size() != b.size()) return false;
    const std::size_t bytes = static_cast<std::size_t>(a.width()) * sizeof(T);
    for (int y = 0; y < a.height(); ++y)
      if (std::memcmp(a.row(y), b.row(y), bytes) != 0) return false;
    return true;
  }

  Image<Gray> left_;
  Image<Gray> right_;
  Image<Rgb> left_rgb_;
};

}  // namespace cairn
