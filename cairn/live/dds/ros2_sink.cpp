// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/dds/ros2_sink.hpp>

#include <atomic>
#include <cairn/core/error.hpp>
#include <nlohmann/json.hpp>
#include <thread>

#include <cairn/live/newest_slot.hpp>
#include <cairn/ros/dds/participant.hpp>

namespace cairn::dds {
namespace {

using namespace std::chrono_literals;

/// How long to wait at the end until readers have received the last messages.
constexpr auto kLastWords = 1s;

/// A topic and its counters.
template <ros::Message M>
class Topic {
 public:
  Topic(const Participant& participant, std::string name)
      : name_(std::move(name)), writer_(participant, name_) {}

  /// Calls `make` only if there are readers; it returns nullopt if the frame lacks the data.
  template <class Make>
  void publish(const Make& make) {
    if (!writer_.has_reader()) return;
    std::optional<M> message = make();
    if (!message) return;
    if (writer_.write(*message)) {
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
  [[nodiscard]] bool has_sent() const { return sent_ + blocked_ > 0; }
  void finish(std::chrono::steady_clock::time_point deadline) const {
    const auto left = deadline - std::chrono::steady_clock::now();
    if (sent_ > 0 && left > 0s && writer_.has_reader()) writer_.wait_for_readers(left);
  }

 private:
  std::string name_;
  Writer<M> writer_;
  std::uint64_t sent_ = 0;
  std::uint64_t blocked_ = 0;
};

class Ros2Sink : public live::Sink {
 public:
  Ros2Sink(const live::Ros2Options& options, const std::optional<StereoRig>& rig)
      : options_(options),
        rig_(rig),
        prefix_(checked_name(options.name_space, "--ros2")),
        objects_(participant_, prefix_ + "/objects"),
        disparity_(participant_, prefix_ + "/disparity"),
        obstacles_(participant_, prefix_ + "/obstacles"),
        floor_(participant_, prefix_ + "/floor"),
        labels_(participant_, prefix_ + "/labels"),
        reject_(participant_, prefix_ + "/reject"),
        grid_(participant_, prefix_ + "/grid"),
        stats_(participant_, prefix_ + "/stats"),
        transforms_(participant_, "/tf"),
        thread_([this] { work(); }) {}
  ~Ros2Sink() override { end(); }

  void offer(const live::LiveFramePtr& frame) override { slot_.put(frame); }

  void finish() override {
    end();
    const auto deadline = std::chrono::steady_clock::now() + kLastWords;
    each_topic([&](const auto& topic) { topic.finish(deadline); });
  }

  [[nodiscard]] std::string summary() const override {
    std::string text = "ros2 in domain " + std::to_string(participant_.domain()) + ":";
    bool has_any = false;
    each_topic([&](const auto& topic) {
      if (!topic.has_sent()) return;
      text += (has_any ? ", " : " ") + topic.summary();
      has_any = true;
    });
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
      if (!frame) continue;
      try {
        publish(**frame);
      } catch (const std::exception& error) {
        trouble_ = error.what();  // reported at the end; the next frame may succeed
      }
    }
  }

  void publish(const live::LiveFrame& live) {
    const TrackedFrame& step = live.step;
    const Frame& frame = step.frame;
    const Config& config = live.config->segmentation;
    const ros::FrameNames names =
        ros::frame_names(options_.camera_frame.empty() ? live.pair->frame_id : options_.camera_frame);
    const ros::Header header = ros::header_of(step.stamp, names.camera);
    const auto cloud_of = [&](ObstacleLabel space) {
      return std::optional(
          ros::cloud_of(header, frame, space, rig_, live.pair->left.gray.view(), live.pair->left.rgb.view()));
    };
    transforms_.publish([&]() -> std::optional<ros::TFMessage> {
      const auto floor = ros::floor_transform_of(step.stamp, names, frame.ground, rig_);
      if (!floor) return std::nullopt;
      return ros::TFMessage{{*floor}};
    });
    objects_.publish([&] { return std::optional(ros::detections_of(header, step, rig_)); });
    stats_.publish([&] { return std::optional(ros::String{stats_json(live, slot_.replaced())}); });
    grid_.publish(
        [&] { return ros::grid_of(ros::header_of(step.stamp, names.floor), frame, rig_, config.obstacles); });
    labels_.publish([&] { return std::optional(ros::labels_of(header, step)); });
    reject_.publish([&] { return std::optional(ros::reject_of(header, frame)); });
    disparity_.publish([&] {
      std::optional<float> hole_px;
      if (options_.marks_holes_as_ros) hole_px = hole_of_ros(config.match);
      return std::optional(ros::disparity_image_of(header, frame, rig_, config.match, hole_px));
    });
    obstacles_.publish([&] { return cloud_of(ObstacleLabel::obstacle); });
    floor_.publish([&] { return cloud_of(ObstacleLabel::floor); });
  }

  /// Below the least disparity, which the message counts from the principal points.
  [[nodiscard]] float hole_of_ros(const MatchConfig& config) const {
    return static_cast<float>(config.min_disparity) + (rig_ ? rig_->doffs_px : 0.0F) - 1.0F;
  }

  template <class Visit>
  void each_topic(const Visit& visit) const {
    visit(objects_);
    visit(disparity_);
    visit(obstacles_);
    visit(floor_);
    visit(labels_);
    visit(reject_);
    visit(grid_);
    visit(transforms_);
    visit(stats_);
  }

  live::Ros2Options options_;
  std::optional<StereoRig> rig_;
  std::string prefix_;
  Participant participant_;
  Topic<ros::Detection3DArray> objects_;
  Topic<ros::DisparityImage> disparity_;
  Topic<ros::PointCloud2> obstacles_;
  Topic<ros::PointCloud2> floor_;
  Topic<ros::Image> labels_;
  Topic<ros::Image> reject_;
  Topic<ros::OccupancyGrid> grid_;
  Topic<ros::String> stats_;
  Topic<ros::TFMessage> transforms_;
  live::NewestSlot<live::LiveFramePtr> slot_;
  std::string trouble_;
  std::thread thread_;  // runs work(); last member, so that it starts after all others exist
};

}  // namespace

std::string stats_json(const live::LiveFrame& frame, std::uint64_t skipped) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::object();
  for (const io::StageTime& stage : frame.stages) stages[stage.stage] = stage.milliseconds;
  const nlohmann::ordered_json json{{"frame", frame.step.index},
                                    {"name", frame.pair->name},
                                    {"stamp_ns", frame.step.stamp.ns},
                                    {"objects", frame.step.frame.objects.list.size()},
                                    {"tracks", frame.step.tracks.list.size()},
                                    {"rate_hz", frame.rate_hz},
                                    {"waited_ms", live::ms_between(frame.arrived, frame.started)},
                                    {"worked_ms", live::ms_between(frame.started, frame.done)},
                                    {"stages_ms", stages},
                                    {"dropped",
                                     {{"at_source", frame.drops.at_source},
                                      {"replaced", frame.drops.replaced},
                                      {"too_old", frame.drops.too_old},
                                      {"not_published", skipped}}},
                                    {"connected", frame.source.is_connected},
                                    {"trouble", frame.source.trouble},
                                    {"revision", frame.revision}};
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::unique_ptr<live::Sink> ros2_sink(const live::Ros2Options& options, const std::optional<StereoRig>& rig) {
  return std::make_unique<Ros2Sink>(options, rig);
}

}  // namespace cairn::dds
