// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/live/topics.hpp>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace cairn::cli {

/// One line of JSON per frame on stdout: as from cairn follow, and without tracks as objects.json. Written on
/// its own thread: a slow reader loses lines, which are counted, but does not block the run.
class JsonLines : public live::Sink {
 public:
  /// `waits`: wait for the reader, so that no line is lost.
  JsonLines(live::MessageForm form, bool waits);
  ~JsonLines() override;

  void offer(const live::LiveFramePtr& frame) override;
  /// Writes waiting lines, unless the reader blocks and the run is interrupted.
  void finish() override;
  [[nodiscard]] std::string summary() const override;
  /// Whether the reader has closed the stream.
  [[nodiscard]] bool is_closed() const;

 private:
  [[nodiscard]] std::string line_of(const live::LiveFrame& frame) const;
  void work();

  live::MessageForm form_;
  bool waits_;
  mutable std::mutex mutex_;  // of the next four
  std::condition_variable changed_;
  std::deque<live::LiveFramePtr> queue_;
  std::uint64_t skipped_ = 0;
  bool is_finishing_ = false;
  bool is_closed_ = false;
  std::thread thread_;
};

}  // namespace cairn::cli
