// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "json_lines.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string_view>

#include "interrupt.hpp"

namespace cairn::cli {
namespace {

constexpr int kNotice_ms = 50;
/// poll() guarantees that a writable pipe takes this much without blocking (POSIX: PIPE_BUF is at least 512;
/// Linux: 4096).
constexpr std::size_t kPiece = 4096;

/// False if the reader closed the pipe, or does not read and the run is interrupted.
bool write_to_stdout(std::string_view text) {
  while (!text.empty()) {
    pollfd out{STDOUT_FILENO, POLLOUT, 0};
    const int ready = ::poll(&out, 1, kNotice_ms);
    if (ready < 0 && errno != EINTR) return false;
    if (ready <= 0) {
      if (is_interrupted()) return false;
      continue;
    }
    const ssize_t written = ::write(STDOUT_FILENO, text.data(), std::min(text.size(), kPiece));
    if (written < 0 && errno != EINTR && errno != EAGAIN) return false;
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

void JsonLines::offer(const live::LiveFramePtr& frame) {
  if (!is_closed_) is_closed_ = !write_to_stdout(line_of(*frame));
}

std::string JsonLines::line_of(const live::LiveFrame& frame) const {
  if (form_.tracks) return *text_of(frame, form_);
  const input::SequenceFrame& pair = *frame.pair;
  output::Json line{{"name", pair.name}, {"stamp_ns", frame.step.stamp.ns}};
  if (!pair.frame_id.empty()) line["frame_id"] = pair.frame_id;
  line.update(*results_of(frame, form_));
  return output::json_text(line) + "\n";
}

}  // namespace cairn::cli
