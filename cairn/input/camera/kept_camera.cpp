// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/kept_camera.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <utility>

namespace cairn::input {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Interval at which a wait checks whether to give up.
constexpr auto kNotice = 50ms;

std::string seconds_of(std::chrono::milliseconds time) {
  std::string text = std::to_string(static_cast<double>(time.count()) / 1000);
  return text.substr(0, text.find('.') + 2) + " s";
}

}  // namespace

KeptCamera::KeptCamera(CameraMaker make, CameraTimes times, Take take)
    : make_(std::move(make)),
      times_(times),
      take_(std::move(take)),
      back_off_(times.first_back_off),
      thread_([this] { work(); }) {}

KeptCamera::~KeptCamera() {
  stop();
  thread_.join();
}

KeptCamera::State KeptCamera::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void KeptCamera::work() {
  while (!is_stopped_) {
    std::string why;
    try {
      const std::unique_ptr<Camera> camera = make_();
      note_opening(*camera);
      read(*camera);
      return;
    } catch (const std::exception& error) {
      why = error.what();
    }
    {
      const std::lock_guard lock(mutex_);
      state_.is_connected = false;
      state_.trouble = std::move(why);
      // An error of the first opening is reported at once: a wrong name or format does not go away.
      state_.has_failed = size_.area() == 0;
      if (state_.has_failed) return;
    }
    wait(back_off_);
    back_off_ = std::min(2 * back_off_, times_.most_back_off);
  }
}

void KeptCamera::note_opening(const Camera& camera) {
  const std::lock_guard lock(mutex_);
  state_.notes = camera.notes();
}

void KeptCamera::read(Camera& camera) {
  const bool is_first = size_.area() == 0;
  Clock::time_point last = Clock::now();
  bool has_image = false;
  while (!is_stopped_) {
    std::optional<CameraImage> image = camera.next(kNotice);
    if (!image) {
      if (camera.has_ended()) {
        const std::lock_guard lock(mutex_);
        state_.has_ended = true;
        state_.is_connected = false;
        return;
      }
      // The first image may take as long as the timeout for opening.
      if (is_first && !has_image) continue;
      const std::chrono::milliseconds most = has_image ? times_.silence : times_.first_image;
      if (Clock::now() - last > most) throw Error("delivers no frame for " + seconds_of(most));
      continue;
    }
    const Size size = image->left.gray.size();
    if (size_.area() > 0 && size != size_)
      throw Error("gives " + text(size) + ", expected " + text(size_) + " as before");
    size_ = size;
    last = Clock::now();
    {
      const std::lock_guard lock(mutex_);
      state_.dropped += image->dropped;
      if (!has_image && !is_first) {
        ++state_.reconnects;
        image->is_after_gap = true;
      }
      state_.is_connected = true;
      state_.trouble.clear();
    }
    has_image = true;
    back_off_ = times_.first_back_off;
    take_(std::move(*image));
  }
}

void KeptCamera::wait(std::chrono::milliseconds time) const {
  const Clock::time_point end = Clock::now() + time;
  while (!is_stopped_ && Clock::now() < end)
    std::this_thread::sleep_until(std::min(end, Clock::now() + kNotice));
}

}  // namespace cairn::input
