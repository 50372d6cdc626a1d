// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <utility>

namespace cairn::live {

/// Passes values between threads and keeps only the newest: put() never waits, take() gets the latest. Counts
/// values that were replaced before being taken.
template <class T>
class NewestSlot {
 public:
  /// No effect after close(). `merge(value, replaced)` carries over data of a value that was not taken.
  template <class Merge>
  void put(T value, Merge&& merge) {
    {
      const std::lock_guard lock(mutex_);
      if (is_closed_) return;
      if (value_) {
        ++replaced_;
        merge(value, *value_);
      }
      value_ = std::move(value);
    }
    changed_.notify_one();
  }

  void put(T value) {
    put(std::move(value), [](T&, const T&) {});
  }

  /// Waits for a value; nullopt if the slot is closed and empty, or on timeout.
  std::optional<T> take(std::chrono::nanoseconds timeout) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [&] { return value_ || is_closed_; });
    return std::exchange(value_, std::nullopt);
  }

  /// A value in the slot may still be taken.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      is_closed_ = true;
    }
    changed_.notify_all();
  }

  [[nodiscard]] bool is_closed() const {
    const std::lock_guard lock(mutex_);
    return is_closed_ && !value_;
  }
  [[nodiscard]] std::uint64_t replaced() const {
    const std::lock_guard lock(mutex_);
    return replaced_;
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<T> value_;
  std::uint64_t replaced_ = 0;
  bool is_closed_ = false;
};

}  // namespace cairn::live
