// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <string>
#include <thread>

#include <cairn/live/live_frame.hpp>

namespace cairn::live {

/// Passes frames to a sink on a thread of its own, so that slow work there does not block the run.
class QueuedSink : public Sink {
 public:
  /// 16 frames may wait; further ones are skipped and counted. `name` and `skipped`: words before and after their
  /// number, for summary(). `sink` must outlive it.
  QueuedSink(Sink& sink, std::string name, std::string skipped);
  ~QueuedSink() override;

  /// Rethrows an error of the sink, which then gets no further frames.
  void offer(const LiveFramePtr& frame) override;
  /// Passes the waiting frames, then finishes the sink. Throws as offer().
  void finish() override;
  [[nodiscard]] std::string summary() const override;

 private:
  void work();
  void end();

  Sink& sink_;
  std::string name_;
  std::string skipped_words_;
  mutable std::mutex mutex_;  // of the next five
  std::condition_variable changed_;
  std::deque<LiveFramePtr> queue_;
  std::uint64_t skipped_ = 0;
  bool is_finishing_ = false;
  std::exception_ptr trouble_;
  std::thread thread_;
};

}  // namespace cairn::live
