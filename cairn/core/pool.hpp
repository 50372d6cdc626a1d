// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

namespace cairn {

/// A store of the buffers of destroyed images, so that the images of the next frame need no allocation. A
/// handle: copies share one store, which lives until its last handle and last image are destroyed.
/// Thread-safe.
class Pool {
 public:
  /// The memory of an image: `bytes` at `data`, aligned to 64, and the store that it returns to (null = the
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

  /// No store: every buffer comes from the heap and returns to it.
  Pool() = default;
  /// A new, empty store.
  static Pool make();

  /// Another store for concurrent work, the same one on every call with this number ≥ 0, so that the buffers found in
  /// any of them do not depend on timing. Its counts are included in those of this pool. Without a store, the result
  /// has none either.
  [[nodiscard]] Pool beside(std::size_t which = 0) const;

  /// A buffer of at least `bytes`, contents undefined.
  [[nodiscard]] Buffer take(std::size_t bytes) const;
  /// Number of heap allocations of this store so far; 0 without a store.
  [[nodiscard]] std::int64_t heap_allocations() const;
  /// Bytes held by this store, in use or free.
  [[nodiscard]] std::int64_t bytes() const;

 private:
  std::shared_ptr<Buffer::Store> store_;
};

}  // namespace cairn
