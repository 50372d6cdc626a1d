// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/geometry.hpp>
#include <cassert>
#include <cstddef>
#include <type_traits>

namespace cairn {

/// A borrowed two-dimensional window onto pixels with another owner: pointer, size, stride in elements.
/// Passed by value. View<T> converts to View<const T>.
template <class T>
class View {
 public:
  using Pixel = T;

  constexpr View() = default;
  constexpr View(T* data, Size size, std::ptrdiff_t stride) : data_(data), size_(size), stride_(stride) {}
  // clang-format off
  template <class U>
    requires(std::is_const_v<T> && std::is_same_v<const U, T>)
  constexpr View(View<U> other)  // NOLINT(google-explicit-constructor): adding const is always safe
      : data_(other.data()), size_(other.size()), stride_(other.stride()) {}
  // clang-format on

  [[nodiscard]] constexpr T* data() const { return data_; }
  [[nodiscard]] constexpr Size size() const { return size_; }
  [[nodiscard]] constexpr int width() const { return size_.width; }
  [[nodiscard]] constexpr int height() const { return size_.height; }
  [[nodiscard]] constexpr std::ptrdiff_t stride() const { return stride_; }
  [[nodiscard]] constexpr bool empty() const { return size_.width == 0 || size_.height == 0; }
  [[nodiscard]] constexpr bool contains(int x, int y) const {
    return x >= 0 && y >= 0 && x < size_.width && y < size_.height;
  }

  [[nodiscard]] constexpr T* row(int y) const {
    assert(y >= 0 && y < size_.height);
    return data_ + y * stride_;
  }
  [[nodiscard]] constexpr T& operator()(int x, int y) const {
    assert(contains(x, y));
    return data_[y * stride_ + x];
  }
  /// The part of this view covered by `rect`, which must lie inside.
  [[nodiscard]] constexpr View sub(Rect rect) const {
    assert(rect.x >= 0 && rect.y >= 0 && rect.x + rect.width <= size_.width &&
           rect.y + rect.height <= size_.height);
    return {data_ + rect.y * stride_ + rect.x, {rect.width, rect.height}, stride_};
  }

 private:
  T* data_ = nullptr;
  Size size_;
  std::ptrdiff_t stride_ = 0;
};

}  // namespace cairn
