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

/// Hands values from one thread to another and keeps only the newest: who puts never waits, who takes gets
/// what is latest. What was replaced before anybody took it is counted.
template <class T>
class NewestSlot {
 public:
  /// Nothing after close(). `merge(value, replaced)`: what of a value that nobody took goes on with this one.
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

  /// Waits for a value; none where the slot is closed and empty, or the time is over.
  std::optional<T> take(std::chrono::nanoseconds timeout) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [&] { return value_ || is_closed_; });
    return std::exchange(value_, std::nullopt);
  }

  /// What is in the slot may still be taken.
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
