// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/queued_sink.hpp>

#include <utility>

namespace cairn::live {
namespace {

constexpr std::size_t kMaxWaiting = 16;  // frames

}  // namespace

QueuedSink::QueuedSink(Sink& sink, std::string name, std::string skipped)
    : sink_(sink), name_(std::move(name)), skipped_words_(std::move(skipped)), thread_([this] { work(); }) {}

QueuedSink::~QueuedSink() {
  end();
}

void QueuedSink::offer(const LiveFramePtr& frame) {
  const std::lock_guard lock(mutex_);
  if (trouble_) std::rethrow_exception(trouble_);
  if (queue_.size() >= kMaxWaiting) {
    ++skipped_;
    return;
  }
  queue_.push_back(frame);
  changed_.notify_all();
}

void QueuedSink::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return !queue_.empty() || is_finishing_; });
    if (queue_.empty()) return;
    const LiveFramePtr frame = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    std::exception_ptr trouble;
    try {
      sink_.offer(frame);
    } catch (...) {
      trouble = std::current_exception();
    }
    lock.lock();
    if (!trouble) continue;
    trouble_ = trouble;
    queue_.clear();
    return;
  }
}

void QueuedSink::end() {
  {
    const std::lock_guard lock(mutex_);
    is_finishing_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void QueuedSink::finish() {
  end();
  sink_.finish();
  if (trouble_) std::rethrow_exception(trouble_);
}

std::string QueuedSink::summary() const {
  const std::lock_guard lock(mutex_);
  return skipped_ == 0 ? "" : name_ + ": " + std::to_string(skipped_) + " " + skipped_words_;
}

}  // namespace cairn::live
