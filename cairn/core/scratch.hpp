// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <bit>
#include <cairn/core/pool.hpp>
#include <cassert>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace cairn {

/// A flat array for working memory, aligned like the rows of an image. Elements are undefined unless a value
/// is given.
template <class T>
class Scratch {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  /// Memory from a pool: with some thousand regions, the arrays of a graph are as large as images, and new
  /// heap memory costs as much time as filling it. Sizes differ from frame to frame; rounded up to a power of
  /// two, the pool can reuse a buffer.
  Scratch(std::size_t size, const Pool& pool)
      : size_(size), buffer_(pool.take(std::bit_ceil(std::max<std::size_t>(size, 1024)) * sizeof(T))) {}
  Scratch(std::size_t size, T value, const Pool& pool) : Scratch(size, pool) {
    std::fill_n(data(), size_, value);
  }
  /// Zeros, for one band of rows. From the heap, not from the pool: the number of bands at work depends on
  /// the threads, and the contents of a pool must not.
  explicit Scratch(int size)
      : size_(static_cast<std::size_t>(size)), buffer_(Pool().take(size_ * sizeof(T))) {
    std::fill_n(data(), size_, T{0});
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T* data() const { return reinterpret_cast<T*>(buffer_.data()); }
  [[nodiscard]] T* begin() const { return data(); }
  [[nodiscard]] T* end() const { return data() + size_; }
  // Indices are region numbers, rows and the like: plain ints.
  [[nodiscard]] T& operator[](std::ptrdiff_t i) const {
    assert(i >= 0 && static_cast<std::size_t>(i) < size_);
    return data()[i];
  }

 private:
  std::size_t size_;
  Pool::Buffer buffer_;
};

/// A Scratch that grows: a list in the memory of a pool.
template <class T>
class ScratchList {
 public:
  ScratchList(std::size_t capacity, const Pool& pool) : pool_(pool), array_(capacity, pool) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::size_t capacity() const { return array_.size(); }
  [[nodiscard]] T* data() { return array_.data(); }
  [[nodiscard]] T* begin() { return array_.data(); }
  [[nodiscard]] T* end() { return array_.data() + size_; }
  [[nodiscard]] const T* begin() const { return array_.begin(); }
  [[nodiscard]] const T* end() const { return array_.begin() + size_; }
  void clear() { size_ = 0; }
  /// Reserves `count` more elements at end(); grown(n) then appends the first n of them to the list.
  T* room_for(std::size_t count) {
    if (size_ + count > array_.size()) {
      Scratch<T> larger(2 * (size_ + count), pool_);
      std::copy_n(array_.data(), size_, larger.data());
      array_ = std::move(larger);
    }
    return end();
  }
  void grown(std::size_t count) { size_ += count; }
  void shrink_to(std::size_t size) { size_ = size; }
  void push_back(const T& value) {
    *room_for(1) = value;
    ++size_;
  }

 private:
  Pool pool_;
  Scratch<T> array_;
  std::size_t size_ = 0;
};

}  // namespace cairn
