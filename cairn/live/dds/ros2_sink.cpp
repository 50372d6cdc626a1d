// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/dds/ros2_sink.hpp>

#include <atomic>
#include <cairn/core/error.hpp>
#include <deque>
#include <thread>

#include <cairn/live/newest_slot.hpp>
#include <cairn/live/topics.hpp>
#include <cairn/ros/dds/participant.hpp>

namespace cairn::live {
namespace {

using namespace std::chrono_literals;

/// How long to wait at the end until readers have received the last messages.
constexpr auto kLastWords = 1s;
/// After which /diagnostics says that no frame arrives.
constexpr double kSilent_s = 1;

/// A topic and its counters.
class Publisher {
 public:
  Publisher(const ros::Participant& participant, const Topic& topic, const std::string& name_space)
      : topic_(topic), name_(full_name(topic, name_space)), writer_(participant, name_, {topic.type, {}}) {}

  /// Makes the message only if there are readers.
  void publish(const LiveFrame& frame, const MessageForm& form) {
    publish([&]() -> std::optional<ros::Bytes> {
      const MessagePtr message = message_of(topic_, frame, form);
      return message ? std::optional(*message) : std::nullopt;
    });
  }
  template <class Make>
  void publish(const Make& make) {
    if (!writer_.has_reader()) return;
    const auto now = std::chrono::steady_clock::now();
    if (last_ && now - *last_ < topic_.interval) return;
    last_ = now;
    std::optional<ros::Bytes> message = make();
    if (!message) return;
    if (writer_.write(std::move(*message))) {
      ++sent_;
    } else {
      ++blocked_;
    }
  }
  [[nodiscard]] std::string summary() const {
    std::string text = name_ + " " + std::to_string(sent_);
    if (blocked_ > 0) text += " (" + std::to_string(blocked_) + " held up by slow readers)";
    return text;
  }
  [[nodiscard]] bool is_of(std::string_view topic) const { return topic_.name == topic; }
  [[nodiscard]] bool has_sent() const { return sent_ + blocked_ > 0; }
  void finish(std::chrono::steady_clock::time_point deadline) const {
    const auto left = deadline - std::chrono::steady_clock::now();
    if (sent_ > 0 && left > 0s && writer_.has_reader()) writer_.wait_for_readers(left);
  }

 private:
  const Topic& topic_;
  std::string name_;
  ros::BytesWriter writer_;
  std::optional<std::chrono::steady_clock::time_point> last_;
  std::uint64_t sent_ = 0;
  std::uint64_t blocked_ = 0;
};

class Ros2Sink : public Sink {
 public:
  Ros2Sink(const Ros2Options& options, const std::optional<StereoRig>& rig)
      : form_{.rig = rig,
              .camera_frame = options.camera_frame,
              .marks_holes_as_ros = options.marks_holes_as_ros} {
    const std::string name_space = ros::checked_name(options.name_space, "--ros2");
    for (const Topic* topic : topics_by(&Topic::published))
      publishers_.emplace_back(participant_, *topic, name_space);
    thread_ = std::thread([this] { work(); });
  }
  ~Ros2Sink() override { end(); }

  void offer(const LiveFramePtr& frame) override { slot_.put(frame); }

  void finish() override {
    end();
    const auto deadline = std::chrono::steady_clock::now() + kLastWords;
    for (const Publisher& publisher : publishers_) publisher.finish(deadline);
  }

  [[nodiscard]] std::string summary() const override {
    std::string text = "ros2 in domain " + std::to_string(participant_.domain()) + ":";
    bool has_any = false;
    for (const Publisher& publisher : publishers_) {
      if (!publisher.has_sent()) continue;
      text += (has_any ? ", " : " ") + publisher.summary();
      has_any = true;
    }
    if (!has_any) text += " no subscriber";
    if (slot_.replaced() > 0)
      text += "; " + std::to_string(slot_.replaced()) + " frames replaced by newer ones";
    if (!trouble_.empty()) text += "; " + trouble_;
    return text;
  }

 private:
  void end() {
    slot_.close();
    if (thread_.joinable()) thread_.join();
  }

  void work() {
    while (!slot_.is_closed()) {
      const auto frame = slot_.take(200ms);
      if (!frame) {
        report_silence();
        continue;
      }
      last_ = *frame;
      last_at_ = std::chrono::steady_clock::now();
      try {
        form_.not_published = slot_.replaced();
        for (Publisher& publisher : publishers_) publisher.publish(**frame, form_);
      } catch (const std::exception& error) {
        trouble_ = error.what();  // reported at the end; the next frame may succeed
      }
    }
  }

  /// A camera that is lost delivers no frame that could say so.
  void report_silence() {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - last_at_).count();
    if (!last_ || seconds < kSilent_s) return;
    for (Publisher& publisher : publishers_) {
      if (publisher.is_of(kDiagnosticsTopic))
        publisher.publish([&] { return silence_message(*last_, form_, seconds); });
    }
  }

  MessageForm form_;
  LiveFramePtr last_;
  std::chrono::steady_clock::time_point last_at_;
  ros::Participant participant_;
  std::deque<Publisher> publishers_;
  NewestSlot<LiveFramePtr> slot_;
  std::string trouble_;
  std::thread thread_;  // runs work()
};

}  // namespace

std::unique_ptr<Sink> ros2_sink(const Ros2Options& options, const std::optional<StereoRig>& rig) {
  return std::make_unique<Ros2Sink>(options, rig);
}

}  // namespace cairn::live
