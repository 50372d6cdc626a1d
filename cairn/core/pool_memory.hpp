// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <bit>
#include <cairn/core/pool.hpp>
#include <cstddef>
#include <memory_resource>
#include <new>
#include <utility>

namespace cairn {

/// Memory of a pool for standard containers (std::pmr::vector). Heap arrays of some hundred kilobytes return
/// to the system at the end of a frame, and faulting their pages in again costs more than filling them. Small
/// arrays come from the heap. Sizes are rounded up to a power of two, as in Scratch.
class PoolMemory final : public std::pmr::memory_resource {
 public:
  explicit PoolMemory(Pool pool) : pool_(std::move(pool)) {}

 private:
  static constexpr std::size_t kMin = std::size_t{1} << 14U;
  static constexpr std::size_t kHeader = 64;  // holds the Buffer; keeps the data aligned
  static_assert(sizeof(Pool::Buffer) <= kHeader);

  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    if (bytes < kMin) return std::pmr::new_delete_resource()->allocate(bytes, alignment);
    Pool::Buffer buffer = pool_.take(std::bit_ceil(bytes + kHeader));
    std::byte* const data = buffer.data();
    new (data) Pool::Buffer(std::move(buffer));
    return data + kHeader;
  }
  void do_deallocate(void* data, std::size_t bytes, std::size_t alignment) override {
    if (bytes < kMin) return std::pmr::new_delete_resource()->deallocate(data, bytes, alignment);
    auto* const kept = std::launder(reinterpret_cast<Pool::Buffer*>(static_cast<std::byte*>(data) - kHeader));
    const Pool::Buffer buffer = std::move(*kept);
    kept->~Buffer();
  }
  [[nodiscard]] bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }

  Pool pool_;
};

}  // namespace cairn
