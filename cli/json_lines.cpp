// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "json_lines.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cairn/output/follow_files.hpp>
#include <cerrno>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string_view>

#include "interrupt.hpp"

namespace cairn::cli {
namespace {

using Json = nlohmann::ordered_json;
using namespace std::chrono_literals;

constexpr std::size_t kMaxWaiting = 16;  // frames
constexpr int kNotice_ms = 50;
/// poll() guarantees that a writable pipe takes this much without blocking (POSIX: PIPE_BUF is at least 512;
/// Linux: 4096).
constexpr std::size_t kPiece = 4096;

/// False if the reader closed the pipe, or does not read and `is_over`.
template <class IsOver>
bool write_to_stdout(std::string_view text, IsOver&& is_over) {
  while (!text.empty()) {
    pollfd out{STDOUT_FILENO, POLLOUT, 0};
    const int ready = ::poll(&out, 1, kNotice_ms);
    if (ready < 0 && errno != EINTR) return false;
    if (ready <= 0) {
      if (is_over()) return false;
      continue;
    }
    const ssize_t written = ::write(STDOUT_FILENO, text.data(), std::min(text.size(), kPiece));
    if (written < 0 && errno != EINTR && errno != EAGAIN) return false;
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

}  // namespace

JsonLines::JsonLines(std::string preset, std::optional<StereoRig> rig, bool tracks, bool waits)
    : preset_(std::move(preset)), rig_(rig), tracks_(tracks), waits_(waits), thread_([this] { work(); }) {}

JsonLines::~JsonLines() {
  finish();
}

void JsonLines::offer(const live::LiveFramePtr& frame) {
  std::unique_lock lock(mutex_);
  while (waits_ && queue_.size() >= kMaxWaiting && !is_closed_ && !is_interrupted())
    changed_.wait_for(lock, std::chrono::milliseconds(kNotice_ms));
  if (is_closed_) return;
  if (queue_.size() >= kMaxWaiting) {
    ++skipped_;
    return;
  }
  queue_.push_back(frame);
  changed_.notify_all();
}

void JsonLines::finish() {
  {
    const std::lock_guard lock(mutex_);
    is_finishing_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

std::string JsonLines::summary() const {
  const std::lock_guard lock(mutex_);
  return skipped_ == 0
             ? ""
             : "stdout: " + std::to_string(skipped_) + " lines dropped, because they were read too slowly";
}

bool JsonLines::is_closed() const {
  const std::lock_guard lock(mutex_);
  return is_closed_;
}

std::string JsonLines::line_of(const live::LiveFrame& frame) const {
  if (tracks_) {
    LandmarkUpdate marked;
    marked.tracks = frame.landmarks;
    marked.events = frame.events;
    return io::step_json(frame.step, frame.pair->name, marked, frame.pair->frame_id);
  }
  Json line{{"name", frame.pair->name}, {"stamp_ns", frame.step.stamp.ns}};
  if (!frame.pair->frame_id.empty()) line["frame_id"] = frame.pair->frame_id;
  line.update(Json::parse(io::objects_json(
      frame.step.frame, {preset_, frame.config->segmentation, rig_, {}, false, frame.step.stamp.ns})));
  return line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void JsonLines::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return !queue_.empty() || is_finishing_; });
    if (queue_.empty()) return;
    const live::LiveFramePtr frame = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    changed_.notify_all();
    const bool is_written = write_to_stdout(line_of(*frame), [&] {
      const std::lock_guard finishing(mutex_);
      return is_finishing_ && is_interrupted();
    });
    lock.lock();
    if (!is_written) {
      is_closed_ = true;
      queue_.clear();
      return;
    }
  }
}

}  // namespace cairn::cli
