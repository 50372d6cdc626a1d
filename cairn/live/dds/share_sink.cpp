// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/fleet/rows.hpp>
#include <mutex>
#include <thread>
#include <utility>

#include <cairn/live/dds/agents.hpp>
#include <cairn/live/newest_slot.hpp>
#include <cairn/live/topics.hpp>
#include <cairn/output/follow_files.hpp>
#include <cairn/ros/from_step.hpp>

namespace cairn::live {
namespace {

using namespace std::chrono_literals;
namespace topics = fleet_topics;

/// Between two words of the agent.
constexpr auto kInterval = 1s;
/// How long to wait at the end until others have received the last rows.
constexpr auto kLastWords = 1s;
/// How long rows of a map may take, before the rest waits for the next time.
constexpr auto kPatience = 250ms;

fleet::RobotKey robot_key(const ShareOptions& options) {
  const std::optional<fleet::MapId> map_id = fleet::map_id_of(options.map_id);
  if (!map_id) {
    throw Error("--share: the map has the identity \"" + options.map_id +
                "\", expected 32 hexadecimal digits: cairn writes them since maps can be merged");
  }
  return {*map_id, fleet::checked_robot(options.robot, "--share")};
}

class ShareSink : public Sink {
 public:
  explicit ShareSink(const ShareOptions& options)
      : robot_(robot_key(options)),
        form_{.rig = options.rig},
        participant_(fleet_participant(options.domain)),
        landmarks_(participant_, topics::kLandmarks, topics::kRows),
        floor_(participant_, topics::kFloor, topics::kRows),
        index_(participant_, topics::kIndex, topics::kRows),
        events_(participant_, topics::kEvents, topics::kLastEvents),
        differences_(robot_),
        tracks_(participant_, "/" + robot_.name + "/cairn/tracks"),
        pose_(participant_, "/" + robot_.name + "/cairn/pose"),
        voice_(participant_, "perception", robot_.name, robot_.map_id),
        domain_(options.domain.id) {
    status_.message = "no frame yet";
    status_.level = ros::DiagnosticStatus::kWarn;
    thread_ = std::thread([this] { work(); });
  }
  ~ShareSink() override { end(); }

  void offer(const LiveFramePtr& frame) override {
    note_alive();
    if (!frame->events.empty()) {
      const std::lock_guard lock(mutex_);
      for (output::Json& line : output::event_lines(frame->step, frame->landmarks, frame->events, {})) {
        line["robot"] = robot_.name;
        happened_.push_back(output::json_text(line));
      }
    }
    slot_.put(frame);
  }
  /// The lease is asserted here, by the work itself: a thread of its own would outlive a loop that hangs.
  void note_alive() override {
    constexpr Clock::duration kBetween = topics::kLease / 8;
    const Clock::duration now = Clock::now().time_since_epoch();
    Clock::duration::rep before = alive_;
    if (now.count() - before < kBetween.count() || !alive_.compare_exchange_strong(before, now.count()))
      return;
    voice_.assert_alive();
  }
  [[nodiscard]] bool wants_map() const override { return true; }
  void offer_map(const std::shared_ptr<const LandmarkMap>& map, std::int64_t run) override {
    maps_.put({map, run});
  }

  void finish() override {
    end();
    const auto deadline = Clock::now() + kLastWords;
    const auto wait = [&](const ros::BytesWriter& writer) {
      if (writer.has_reader())
        writer.wait_for_readers(std::max<Clock::duration>(deadline - Clock::now(), 1ms));
    };
    send_rows(deadline);
    send_events();
    wait(landmarks_);
    wait(floor_);
    wait(index_);
    wait(events_);
    voice_.end(status_);
  }

  [[nodiscard]] std::string summary() const override {
    std::string text = "shared as " + robot_.name + " in domain " + std::to_string(domain_) + ": " +
                       std::to_string(voice_.row.landmarks) + " landmarks, " + std::to_string(sent_) +
                       " rows sent";
    if (held_up_ > 0) text += " (held up by slow readers " + std::to_string(held_up_) + " times)";
    return trouble_.empty() ? text : text + "; " + trouble_;
  }

 private:
  void end() {
    slot_.close();
    if (thread_.joinable()) thread_.join();
  }

  void work() {
    Clock::time_point said;
    while (!slot_.is_closed()) {
      const auto frame = slot_.take(100ms);
      try {
        if (frame) publish(*frame);
        send_rows(Clock::now() + kPatience);
        send_events();
        const Clock::duration since_alive = Clock::now().time_since_epoch() - Clock::duration(alive_);
        if (Clock::now() - said < kInterval || since_alive > topics::kLease / 2) continue;
        said = Clock::now();
        say();
      } catch (const std::exception& error) {
        trouble_ = error.what();  // reported at the end; the next frame may succeed
      }
    }
  }

  /// What people look at, only if somebody does.
  void publish(const LiveFramePtr& frame) {
    last_ = frame;
    last_at_ = Clock::now();
    if (!frame->map_from_odom || frame->step.is_lost) return;
    const Pose& map_from_odom = *frame->map_from_odom;
    const ros::Header header = ros::header_of(frame->step.stamp, robot_.name + "/map");
    if (tracks_.has_reader())
      tracks_.write(ros::tracks_of(header, frame->step, map_from_odom, robot_.name + "/"));
    if (pose_.has_reader())
      pose_.write(ros::camera_pose_of(header, frame->step, map_from_odom, frame->camera_covariance));
  }

  /// What has changed in the map. What readers are too slow to accept, or is left at the deadline, comes again.
  void send_rows(Clock::time_point deadline) {
    if (auto newer = maps_.take(0ns)) {
      map_ = newer->first;
      differences_.begin_run(newer->second);
      is_unsent_ = true;
    }
    if (!map_ || !is_unsent_) return;
    const fleet::RowDifferences::Changes changes = differences_.next(*map_);
    is_unsent_ = false;
    const auto send = [&](auto& writer, const auto& row) {
      if (!is_unsent_ && Clock::now() < deadline && writer.write(row)) {
        ++sent_;
        return;
      }
      held_up_ += is_unsent_ ? 0 : 1;
      is_unsent_ = true;
      differences_.is_unsent(row);
    };
    for (const fleet::LandmarkRow& row : changes.landmarks) send(landmarks_, row);
    for (const fleet::FloorRow& row : changes.floor) send(floor_, row);
    if (changes.index) send(index_, *changes.index);
    voice_.row.landmarks = static_cast<std::int32_t>(map_->list.size());
  }

  void send_events() {
    std::vector<std::string> lines;
    {
      const std::lock_guard lock(mutex_);
      lines.swap(happened_);
    }
    for (std::string& line : lines) events_.write({std::move(line)});
  }

  void say() {
    if (last_) {
      const double silent_s = std::chrono::duration<double>(Clock::now() - last_at_).count();
      const MessagePtr message = message_of(diagnostics_topic(), *last_, form_);
      const ros::Bytes bytes = silent_s > 1 ? silence_message(*last_, form_, silent_s) : *message;
      status_ = ros::decode<ros::DiagnosticArray>(bytes).status.front();
      status_.name = robot_.name + "/" + status_.name;
      voice_.row.rate_hz = silent_s > 1 ? 0 : last_->rate_hz;
      voice_.row.reliability = double{last_->step.reliability.value.value_or(-1.0F)};
      voice_.row.weakest = last_->step.reliability.weakest;
      voice_.row.frames = static_cast<std::uint64_t>(last_->step.index) + 1;
      voice_.row.objects = static_cast<std::int32_t>(last_->step.frame.objects.list.size());
      voice_.row.tracks = static_cast<std::int32_t>(last_->step.tracks.list.size());
    }
    voice_.send(status_);
  }

  static const Topic& diagnostics_topic() {
    for (const Topic& topic : cairn::live::topics())
      if (topic.name == kDiagnosticsTopic) return topic;
    std::abort();  // it is in the table
  }

  fleet::RobotKey robot_;
  std::shared_ptr<const LandmarkMap> map_;
  bool is_unsent_ = false;  // some rows of the map
  MessageForm form_;
  ros::Participant participant_;
  ros::Writer<fleet::LandmarkRow> landmarks_;
  ros::Writer<fleet::FloorRow> floor_;
  ros::Writer<fleet::IndexRow> index_;
  ros::Writer<ros::String> events_;
  fleet::RowDifferences differences_;
  ros::Writer<ros::Detection3DArray> tracks_;
  ros::Writer<ros::PoseWithCovarianceStamped> pose_;
  AgentVoice voice_;
  std::uint32_t domain_;
  LiveFramePtr last_;
  Clock::time_point last_at_;
  ros::DiagnosticStatus status_;
  std::atomic<Clock::duration::rep> alive_ = 0;
  NewestSlot<LiveFramePtr> slot_;
  NewestSlot<std::pair<std::shared_ptr<const LandmarkMap>, std::int64_t>> maps_;
  std::mutex mutex_;  // of the next one
  std::vector<std::string> happened_;
  std::uint64_t sent_ = 0;
  std::uint64_t held_up_ = 0;
  std::string trouble_;
  std::thread thread_;  // runs work()
};

}  // namespace

std::unique_ptr<Sink> share_sink(const ShareOptions& options) {
  return std::make_unique<ShareSink>(options);
}

}  // namespace cairn::live
