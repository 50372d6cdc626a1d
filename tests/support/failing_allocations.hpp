// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <limits>

// Replaces malloc() in the one program whose main file includes this, and so operator new and the allocations
// of libpng, libjpeg, OpenCV, SQLite and zlib.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);
}

namespace cairn::support {

/// While it lives, fails one allocation of this thread by number, from 0, or all from there on.
class FailingAllocations {
 public:
  enum class Those : std::uint8_t { one, all_after };

  FailingAllocations(int number, Those those) {
    has_failed_ = false;
    living_ = 0;
    goes_on_ = those == Those::all_after;
    left_ = number;
  }
  FailingAllocations(const FailingAllocations&) = delete;
  FailingAllocations& operator=(const FailingAllocations&) = delete;
  ~FailingAllocations() { left_ = kNever; }

  /// Stops failing; returns whether an allocation has failed.
  static bool end() {
    left_ = kNever;
    return has_failed_;
  }
  /// Number of allocations of this thread since construction that are not freed.
  static std::int64_t living() { return living_; }

  static bool next_fails() {
    if (left_ == kNever || left_-- > 0) return false;
    left_ = goes_on_ ? 0 : kNever;
    has_failed_ = true;
    errno = ENOMEM;
    return true;
  }
  static void* counted(void* memory) {
    if (memory != nullptr) ++living_;
    return memory;
  }
  static void freed(const void* memory) {
    if (memory != nullptr) --living_;
  }

 private:
  static constexpr int kNever = std::numeric_limits<int>::max();
  static inline thread_local int left_ = kNever;  // number of allocations until the failing one
  static inline thread_local bool goes_on_ = false;
  static inline thread_local bool has_failed_ = false;
  static inline thread_local std::int64_t living_ = 0;
};

}  // namespace cairn::support

extern "C" {
// NOLINTBEGIN: names of the C library, raw memory
void* malloc(std::size_t size) {
  using cairn::support::FailingAllocations;
  return FailingAllocations::next_fails() ? nullptr : FailingAllocations::counted(__libc_malloc(size));
}
void* calloc(std::size_t count, std::size_t size) {
  using cairn::support::FailingAllocations;
  return FailingAllocations::next_fails() ? nullptr : FailingAllocations::counted(__libc_calloc(count, size));
}
void* realloc(void* memory, std::size_t size) {
  using cairn::support::FailingAllocations;
  if (FailingAllocations::next_fails()) return nullptr;
  void* const moved = __libc_realloc(memory, size);
  return memory == nullptr ? FailingAllocations::counted(moved) : moved;
}
void* memalign(std::size_t alignment, std::size_t size) {
  using cairn::support::FailingAllocations;
  return FailingAllocations::next_fails() ? nullptr
                                          : FailingAllocations::counted(__libc_memalign(alignment, size));
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  *memory = memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
void free(void* memory) {
  cairn::support::FailingAllocations::freed(memory);
  __libc_free(memory);
}
// NOLINTEND
}
