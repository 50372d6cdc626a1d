// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <atomic>
#include <cairn/live/topics.hpp>
#include <string>

namespace cairn::cli {

/// One line of JSON per frame on stdout: a line of tracks.jsonl, and without tracks objects.json.
class JsonLines : public live::Sink {
 public:
  explicit JsonLines(live::MessageForm form) : form_(std::move(form)) {}
  /// Waits for the reader, unless the run is interrupted.
  void offer(const live::LiveFramePtr& frame) override;
  /// Whether the reader has closed the stream.
  [[nodiscard]] bool is_closed() const { return is_closed_; }

 private:
  [[nodiscard]] std::string line_of(const live::LiveFrame& frame) const;

  live::MessageForm form_;
  std::atomic<bool> is_closed_ = false;
};

}  // namespace cairn::cli
