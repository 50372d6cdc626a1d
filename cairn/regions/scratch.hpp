// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <bit>
#include <cairn/core/image.hpp>
#include <cassert>

namespace cairn {

/// A flat array from a pool, for the graph's working memory: at some thousand regions its arrays are as large
/// as images, and fresh memory from the heap costs as much time as filling it. Elements are undefined at
/// first. Sizes differ from frame to frame; rounding them up to a power of two lets the pool give the same
/// buffer again.
template <class T>
class Scratch {
 public:
  Scratch(std::size_t size, const Pool& pool)
      : size_(size),
        image_(Size{static_cast<int>(std::bit_ceil(std::max<std::size_t>(size, 1024))), 1}, pool),
        data_(image_.row(0)) {}
  Scratch(std::size_t size, T value, const Pool& pool) : Scratch(size, pool) {
    std::fill_n(data_, size_, value);
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T* data() { return data_; }
  [[nodiscard]] T* begin() { return data_; }
  [[nodiscard]] T* end() { return data_ + size_; }
  [[nodiscard]] const T* begin() const { return data_; }
  [[nodiscard]] const T* end() const { return data_ + size_; }
  // Indices are region numbers, rows and the like: plain ints.
  [[nodiscard]] T& operator[](std::ptrdiff_t i) {
    assert(i >= 0 && static_cast<std::size_t>(i) < size_);
    return data_[i];
  }
  [[nodiscard]] const T& operator[](std::ptrdiff_t i) const {
    assert(i >= 0 && static_cast<std::size_t>(i) < size_);
    return data_[i];
  }

 private:
  std::size_t size_;
  Image<T> image_;
  T* data_;  // moves along with image_, whose buffer stays where it is
};

/// A Scratch that grows: a list whose memory comes from a pool.
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
  /// Room for `count` more elements at end(); grown(n) then makes the first n of them part of the list.
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
