// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace cairn {

/// Keeps the buffers of images that have died, so that the next frame's images need no allocation.
/// A handle: copies share one store. The store lives until the last handle and the last image of it are gone.
/// Thread-safe.
class Pool {
 public:
  /// What an image holds: `bytes` at `data`, aligned to 64, and the store that it returns to (none = the
  /// heap).
  class Buffer {
   public:
    Buffer() = default;
    Buffer(Buffer&& other) noexcept;
    Buffer& operator=(Buffer&& other) noexcept;
    Buffer(const Buffer&) = delete;
    Buffer& operator=(const Buffer&) = delete;
    ~Buffer();
    [[nodiscard]] std::byte* data() const { return data_; }

   private:
    friend class Pool;
    struct Store;
    Buffer(std::byte* data, std::size_t bytes, std::shared_ptr<Store> store);
    void release() noexcept;
    std::byte* data_ = nullptr;
    std::size_t bytes_ = 0;
    std::shared_ptr<Store> store_;
  };

  /// No store: every buffer comes from the heap and goes back to it.
  Pool() = default;
  /// A store of its own, empty.
  static Pool make();

  /// A store beside this one, always the same: for work that goes on at the same time, so that what either
  /// finds does not depend on who takes first. Its numbers are part of this one's. No store: none either.
  [[nodiscard]] Pool beside() const;

  /// A buffer of at least `bytes`, contents undefined.
  [[nodiscard]] Buffer take(std::size_t bytes) const;
  /// How many buffers this store has asked the heap for so far; 0 for a pool without store.
  [[nodiscard]] std::int64_t heap_allocations() const;
  /// Bytes that this store holds at present, lent out or free.
  [[nodiscard]] std::int64_t bytes() const;

 private:
  std::shared_ptr<Buffer::Store> store_;
};

}  // namespace cairn
