// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <cairn/core/pool.hpp>
#include <cairn/core/view.hpp>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace cairn {

using Gray = std::uint8_t;

struct Rgb {
  std::uint8_t r = 0;
  std::uint8_t g = 0;
  std::uint8_t b = 0;
  friend constexpr bool operator==(Rgb, Rgb) = default;
};

/// A two-dimensional array that owns its pixels. Move-only; clone() makes a copy. Every row starts at a
/// multiple of 64 bytes, so a vector load at the start of a row never crosses a cache line. The buffer
/// returns to the pool that it came from.
///
/// New pixels are undefined; the creator writes every one.
template <class T>
class Image {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  Image() = default;
  explicit Image(Size size, const Pool& pool = {})
      : size_(size), stride_(padded(size.width)), buffer_(pool.take(bytes(size))) {}
  Image(Size size, T value, const Pool& pool) : Image(size, pool) { fill(value); }

  Image(Image&& other) noexcept
      : size_(std::exchange(other.size_, {})), stride_(other.stride_), buffer_(std::move(other.buffer_)) {}
  Image& operator=(Image&& other) noexcept {
    size_ = std::exchange(other.size_, {});
    stride_ = other.stride_;
    buffer_ = std::move(other.buffer_);
    return *this;
  }
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;
  ~Image() = default;

  [[nodiscard]] Size size() const { return size_; }
  [[nodiscard]] int width() const { return size_.width; }
  [[nodiscard]] int height() const { return size_.height; }
  [[nodiscard]] bool empty() const { return size_.width == 0 || size_.height == 0; }

  [[nodiscard]] View<T> view() & { return {data(), size_, stride_}; }
  [[nodiscard]] View<const T> view() const& { return {data(), size_, stride_}; }
  View<T> view() && = delete;  // the view would outlive its pixels
  // NOLINTBEGIN(google-explicit-constructor): a named image converts to a view
  operator View<T>() & { return view(); }
  operator View<const T>() const& { return view(); }
  operator View<const T>() && = delete;
  // NOLINTEND(google-explicit-constructor)

  [[nodiscard]] T* row(int y) { return view().row(y); }
  [[nodiscard]] const T* row(int y) const { return view().row(y); }
  [[nodiscard]] T& operator()(int x, int y) { return view()(x, y); }
  [[nodiscard]] const T& operator()(int x, int y) const { return view()(x, y); }

  void fill(T value) {
    for (int y = 0; y < height(); ++y) std::fill_n(row(y), width(), value);
  }
  [[nodiscard]] Image clone(const Pool& pool = {}) const {
    Image copy(size_, pool);
    for (int y = 0; y < height(); ++y) std::copy_n(row(y), width(), copy.row(y));
    return copy;
  }

 private:
  static constexpr std::ptrdiff_t padded(int width) {
    // The stride counts elements; for odd element sizes (Rgb) 64 elements are a multiple of 64 bytes too.
    constexpr std::ptrdiff_t kStep = 64 % sizeof(T) == 0 ? 64 / sizeof(T) : 64;
    return (width + kStep - 1) / kStep * kStep;
  }
  static std::size_t bytes(Size size) {
    return static_cast<std::size_t>(padded(size.width)) * static_cast<std::size_t>(size.height) * sizeof(T);
  }
  [[nodiscard]] T* data() const { return reinterpret_cast<T*>(buffer_.data()); }

  Size size_;
  std::ptrdiff_t stride_ = 0;
  Pool::Buffer buffer_;
};

}  // namespace cairn
