// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/topics.hpp>

#include <algorithm>
#include <array>
#include <cairn/io/raster.hpp>
#include <cairn/io/text_lines.hpp>
#include <cairn/live/view/frame_json.hpp>
#include <cairn/ros/from_step.hpp>
#include <cmath>

namespace cairn::live {
namespace {

using output::Json;

constexpr int kJpegQuality = 85;

ros::FrameNames names_of(const LiveFrame& frame, const MessageForm& form) {
  return ros::frame_names(form.camera_frame.empty() ? frame.pair->frame_id : form.camera_frame);
}

ros::Header header_of(const LiveFrame& frame, const MessageForm& form) {
  return ros::header_of(frame.step.stamp, names_of(frame, form).camera);
}

/// Three digits are enough for people.
std::string short_text(double value) {
  return io::text_of("%.3g", value);
}

bool is_same(View<const Gray> a, View<const Gray> b) {
  for (int y = 0; y < a.height(); ++y)
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) return false;
  return true;
}

// ---- the pair ----

Message left(const LiveFrame& frame, const MessageForm& form) {
  const io::LoadedImage& image = frame.pair->left;
  const ros::Header header = header_of(frame, form);
  return ros::encode(image.rgb.empty() ? ros::image_of(header, image.gray.view())
                                       : ros::image_of(header, image.rgb.view()));
}

/// In pairs rectified here, colour and grey are interpolated separately, so grey may differ.
Message left_grey(const LiveFrame& frame, const MessageForm& form) {
  const io::LoadedImage& image = frame.pair->left;
  if (image.rgb.empty()) return std::nullopt;
  const Image<Gray> grey = io::grey_of(image.rgb.view());
  if (is_same(grey, image.gray)) return std::nullopt;
  return ros::encode(ros::image_of(header_of(frame, form), image.gray.view()));
}

Message right(const LiveFrame& frame, const MessageForm& form) {
  if (!frame.pair->disparity_px.empty()) return std::nullopt;  // not processed
  return ros::encode(ros::image_of(header_of(frame, form), frame.pair->right.view()));
}

/// Given disparities, which were processed instead of a right image.
Message given_disparity(const LiveFrame& frame, const MessageForm& form) {
  const View<const float> disparity_px = frame.pair->disparity_px;
  if (disparity_px.empty()) return std::nullopt;
  ros::DisparityImage message = ros::disparity_image_of(header_of(frame, form), disparity_px, form.rig,
                                                        frame.config->segmentation.match);
  // The search range is the matcher's.
  message.min_disparity = -kMaxDisparity;
  message.max_disparity = kMaxDisparity;
  return ros::encode(message);
}

template <ros::Side side>
Message camera_info(const LiveFrame& frame, const MessageForm& form) {
  if (!form.rig) return std::nullopt;
  return ros::encode(
      ros::camera_info_of(header_of(frame, form), *form.rig, frame.pair->left.gray.size(), side));
}

Message left_compressed(const LiveFrame& frame, const MessageForm& form) {
  const auto jpeg = left_jpeg(frame);
  return ros::encode(
      ros::CompressedImage{header_of(frame, form), "jpeg", ros::Bytes(jpeg->begin(), jpeg->end())});
}

// ---- what was found ----

Message objects(const LiveFrame& frame, const MessageForm& form) {
  return ros::encode(ros::detections_of(header_of(frame, form), frame.step, form.rig));
}

Message frames(const LiveFrame& frame, const MessageForm& form) {
  return ros::encode(ros::String{*text_of(frame, form)});
}

Message stats(const LiveFrame& frame, const MessageForm& form) {
  Json stages = Json::object();
  for (const output::StageTime& stage : frame.stages) stages[stage.stage] = stage.milliseconds;
  Json dropped{{"at_source", frame.drops.at_source},
               {"replaced", frame.drops.replaced},
               {"too_old", frame.drops.too_old}};
  if (form.not_published) dropped["not_published"] = *form.not_published;
  Json all{{"frame", frame.step.index},
           {"name", frame.pair->name},
           {"index", frame.pair->index},
           {"stamp_ns", frame.step.stamp.ns},
           {"objects", frame.step.frame.objects.list.size()},
           {"tracks", frame.step.tracks.list.size()},
           {"rate_hz", frame.rate_hz},
           {"waited_ms", ms_between(frame.arrived, frame.started)},
           {"worked_ms", ms_between(frame.started, frame.done)},
           {"stages_ms", stages},
           {"dropped", dropped},
           {"connected", frame.source.is_connected},
           {"trouble", frame.source.trouble},
           {"findings", output::json_of(frame.findings)},
           {"revision", frame.revision}};
  if (frame.device) all["device"] = output::json_of(*frame.device);
  return ros::encode(ros::String{output::json_text(all)});
}

ros::DiagnosticStatus empty_status(const LiveFrame& frame, const MessageForm& form) {
  ros::DiagnosticStatus status;
  status.name = "cairn: perception";
  status.hardware_id = names_of(frame, form).camera;
  return status;
}

/// In the convention of ROS: one status, its level by what a planner should know first.
Message diagnostics(const LiveFrame& frame, const MessageForm& form) {
  const Reliability& judged = frame.step.reliability;
  ros::DiagnosticStatus status = empty_status(frame, form);
  const auto raise = [&](std::byte level, const std::string& message) {
    if (level < status.level || (level == status.level && !status.message.empty())) return;
    status.level = level;
    status.message = message;
  };
  const auto add = [&](const std::string& key, const std::string& value) {
    status.values.push_back({key, value});
  };
  for (const Finding& finding : frame.findings) {
    if (finding.severity == Severity::broken)
      raise(ros::DiagnosticStatus::kError, std::string(info(finding.kind).name));
  }
  const bool has_tracks = !frame.step.ids.empty();
  if (has_tracks && form.rig && frame.step.is_lost)
    raise(ros::DiagnosticStatus::kError, "place of the camera unknown");
  if (judged.is_unreliable) raise(ros::DiagnosticStatus::kWarn, "unreliable, weakest: " + judged.weakest);
  for (const Finding& finding : frame.findings) {
    if (finding.severity == Severity::warning)
      raise(ros::DiagnosticStatus::kWarn, std::string(info(finding.kind).name));
  }
  raise(ros::DiagnosticStatus::kOk, "ok");
  add("reliability", judged.value ? short_text(double{*judged.value}) : "unknown");
  add("weakest", judged.weakest);
  for (const WitnessName& witness : kWitnesses) {
    const std::optional<float> value = judged.witnesses.*witness.value;
    add("reliability/" + std::string(witness.name), value ? short_text(double{*value}) : "unknown");
  }
  add("objects", std::to_string(frame.step.frame.objects.list.size()));
  add("tracks", std::to_string(frame.step.tracks.list.size()));
  add("rate_hz", short_text(frame.rate_hz));
  add("image_to_objects_ms", short_text(ms_between(frame.arrived, frame.done)));
  add("dropped", std::to_string(frame.drops.at_source + frame.drops.replaced + frame.drops.too_old));
  add("revision", std::to_string(frame.revision));
  for (const Finding& finding : frame.findings)
    add("finding: " + std::string(info(finding.kind).name), finding.says);
  return ros::encode(ros::DiagnosticArray{ros::header_of(frame.step.stamp, ""), {std::move(status)}});
}

Message transforms(const LiveFrame& frame, const MessageForm& form) {
  const ros::TFMessage all = ros::transforms_of(names_of(frame, form), frame.step, form.rig);
  return all.transforms.empty() ? std::nullopt : std::optional(ros::encode(all));
}

Message floor_transform(const LiveFrame& frame, const MessageForm& form) {
  const auto floor =
      ros::floor_transform_of(frame.step.stamp, names_of(frame, form), frame.step.frame.ground, form.rig);
  if (!floor) return std::nullopt;
  return ros::encode(ros::TFMessage{{*floor}});
}

Message disparity(const LiveFrame& frame, const MessageForm& form) {
  const MatchConfig& match = frame.config->segmentation.match;
  std::optional<float> hole_px;
  // Below the least disparity, which the message counts from the principal points.
  if (form.marks_holes_as_ros)
    hole_px = static_cast<float>(match.min_disparity) + (form.rig ? form.rig->doffs_px : 0.0F) - 1.0F;
  return ros::encode(
      ros::disparity_image_of(header_of(frame, form), frame.step.frame, form.rig, match, hole_px));
}

/// 0 = hole, 1 … 255 over the search range.
Message disparity_picture(const LiveFrame& frame, const MessageForm& form) {
  const View<const float> disparity_px = frame.step.frame.disparity.disparity_px;
  const MatchConfig& match = frame.config->segmentation.match;
  Image<Gray> grey(disparity_px.size());
  const auto low = static_cast<float>(match.min_disparity);
  const float scale = 254.0F / static_cast<float>(match.num_disparities);
  for (int y = 0; y < disparity_px.height(); ++y) {
    const float* const from = disparity_px.row(y);
    std::transform(from, from + disparity_px.width(), grey.row(y), [&](float d) {
      if (!std::isfinite(d)) return Gray{0};
      // Rounds, as numbers from 1 on: std::round() is a call for each pixel, and took a third of all encoding.
      return static_cast<Gray>(std::clamp(1 + (d - low) * scale, 1.0F, 255.0F) + 0.5F);
    });
  }
  return ros::encode(ros::image_of(header_of(frame, form), View<const Gray>(grey)));
}

Message labels(const LiveFrame& frame, const MessageForm& form) {
  return ros::encode(ros::labels_of(header_of(frame, form), frame.step));
}

Message reject(const LiveFrame& frame, const MessageForm& form) {
  return ros::encode(ros::reject_of(header_of(frame, form), frame.step.frame));
}

/// nullopt if it is unknown, or the frame was not processed.
std::optional<FloorFrame> floor_of(const LiveFrame& frame, const MessageForm& form) {
  const Frame& found = frame.step.frame;
  return found.space.empty() ? std::nullopt : floor_frame(found.ground, form.rig);
}

/// The steps of the ground, for all topics that show them.
std::shared_ptr<const std::vector<GroundStep>> steps_of(const LiveFrame& frame, const MessageForm& form,
                                                        const FloorFrame& floor) {
  return frame.products.get("ground_steps", [&] {
    return find_steps(frame.step.frame, floor, *form.rig, frame.config->segmentation.obstacles);
  });
}

template <ObstacleLabel space>
Message cloud(const LiveFrame& frame, const MessageForm& form) {
  const io::LoadedImage& image = frame.pair->left;
  ros::PointCloud2 points = ros::cloud_of(header_of(frame, form), frame.step.frame, space, form.rig,
                                          image.gray, image.rgb, form.cloud_stride);
  if (space == ObstacleLabel::obstacle) {
    if (const auto floor = floor_of(frame, form))
      ros::add_steps(points, *steps_of(frame, form, *floor), *floor);
  }
  return ros::encode(points);
}

Message grid(const LiveFrame& frame, const MessageForm& form) {
  const auto floor = floor_of(frame, form);
  if (!floor) return std::nullopt;
  return ros::encode(ros::grid_of(ros::header_of(frame.step.stamp, names_of(frame, form).floor),
                                  map_obstacles(frame.step.frame, *steps_of(frame, form, *floor), *floor,
                                                *form.rig, frame.config->segmentation.obstacles)));
}

Message scene(const LiveFrame& frame, const MessageForm& form) {
  const std::string json = scene_json(frame, form.rig);
  return ros::Bytes(json.begin(), json.end());
}

// ---- the table ----

template <ros::Message M>
std::string schema_of() {
  return ros::schema_of<M>();
}
std::string stats_schema() {
  return std::string(kStatsSchema);
}
std::string scene_schema() {
  return std::string(kSceneSchema);
}

template <ros::Message M>
constexpr Topic of_ros(std::string_view name, decltype(Topic::make) make, bool RecordWhat::*recorded,
                       int published = 0, int viewed = 0, Announcement declared = Announcement::always) {
  return {.name = name,
          .type = M::kType,
          .schema = &schema_of<M>,
          .make = make,
          .recorded = recorded,
          .published = published,
          .viewed = viewed,
          .declared = declared,
          .has_stride = M::kType == ros::PointCloud2::kType,
          .has_holes = M::kType == ros::DisparityImage::kType};
}

constexpr auto kInput = &RecordWhat::input;
constexpr auto kObjects = &RecordWhat::objects;
constexpr auto kMasks = &RecordWhat::masks;
constexpr auto kClouds = &RecordWhat::clouds;

constexpr std::array kTopics{
    // name, made by, recorded with, order on ROS 2, number in the view
    of_ros<ros::Image>("/stereo/left/image_rect", left, kInput),
    of_ros<ros::Image>("/stereo/left/image_grey", left_grey, kInput, 0, 0, Announcement::with_first_message),
    of_ros<ros::Image>("/stereo/right/image_rect", right, kInput, 0, 0, Announcement::with_first_message),
    of_ros<ros::DisparityImage>("/stereo/disparity", given_disparity, kInput, 0, 0,
                                Announcement::with_first_message),
    of_ros<ros::CameraInfo>("/stereo/left/camera_info", camera_info<ros::Side::left>, kInput, 0, 0,
                            Announcement::with_rig),
    of_ros<ros::CameraInfo>("/stereo/right/camera_info", camera_info<ros::Side::right>, kInput, 0, 0,
                            Announcement::with_rig),
    of_ros<ros::Detection3DArray>("objects", objects, kObjects, 2, 5),
    of_ros<ros::String>("frames", frames, kObjects),
    of_ros<ros::String>("stats", stats, kObjects, 3),
    of_ros<ros::TFMessage>("/tf", transforms, kObjects, 0, 9),
    of_ros<ros::TFMessage>("/tf", floor_transform, nullptr, 1),
    of_ros<ros::DisparityImage>("disparity", disparity, &RecordWhat::disparity, 7),
    of_ros<ros::Image>("labels", labels, kMasks, 5, 2),
    of_ros<ros::Image>("reject", reject, kMasks, 6, 3),
    of_ros<ros::PointCloud2>("obstacles", cloud<ObstacleLabel::obstacle>, kClouds, 8, 6),
    of_ros<ros::PointCloud2>("floor", cloud<ObstacleLabel::floor>, kClouds, 9),
    of_ros<ros::OccupancyGrid>("grid", grid, &RecordWhat::grid, 4),
    of_ros<ros::CompressedImage>("left", left_compressed, nullptr, 0, 1),
    of_ros<ros::Image>("disparity", disparity_picture, nullptr, 0, 4),
    Topic{.name = kDiagnosticsTopic,
          .type = ros::DiagnosticArray::kType,
          .schema = &schema_of<ros::DiagnosticArray>,
          .make = diagnostics,
          .published = 10,
          .interval = std::chrono::seconds(1)},
    Topic{
        .name = "scene", .type = "foxglove.SceneUpdate", .schema = &scene_schema, .make = scene, .viewed = 7},
    Topic{.name = "stats", .type = "cairn.Stats", .schema = &stats_schema, .make = nullptr, .viewed = 8},
};

}  // namespace

std::span<const Topic> topics() {
  return kTopics;
}

std::vector<const Topic*> topics_by(int Topic::*order) {
  std::vector<const Topic*> chosen;
  for (const Topic& topic : kTopics)
    if (topic.*order > 0) chosen.push_back(&topic);
  std::ranges::sort(chosen, {}, [order](const Topic* topic) { return topic->*order; });
  return chosen;
}

std::string full_name(const Topic& topic, const std::string& name_space) {
  return topic.name.starts_with('/') ? std::string(topic.name) : name_space + "/" + std::string(topic.name);
}

MessagePtr message_of(const Topic& topic, const LiveFrame& frame, const MessageForm& form) {
  std::string key = std::to_string(&topic - kTopics.data()) + " " + form.camera_frame;
  if (topic.has_stride) key += " " + std::to_string(form.cloud_stride);
  if (topic.has_holes && form.marks_holes_as_ros) key += " ros";
  if (topic.make == stats && form.not_published) key += " " + std::to_string(*form.not_published);
  const auto made = frame.products.get(key, [&] { return topic.make(frame, form); });
  return *made ? MessagePtr(made, &**made) : nullptr;
}

ros::Bytes silence_message(const LiveFrame& last, const MessageForm& form, double seconds) {
  ros::DiagnosticStatus status = empty_status(last, form);
  status.level = ros::DiagnosticStatus::kError;
  status.message = "no frame for " + short_text(seconds) + " s";
  const auto ns = static_cast<std::int64_t>(seconds * 1e9);
  return ros::encode(
      ros::DiagnosticArray{ros::header_of({last.step.stamp.ns + ns}, ""), {std::move(status)}});
}

std::shared_ptr<const Json> results_of(const LiveFrame& frame, const MessageForm& form) {
  return frame.products.get("results", [&] {
    const input::SequenceFrame& pair = *frame.pair;
    if (form.tracks) return output::json_of(frame.step, pair.name, frame.landmarks, pair.frame_id);
    return output::json_of(frame.step.frame, {form.preset,
                                              frame.config->segmentation,
                                              form.rig,
                                              {},
                                              !frame.pair->disparity_px.empty(),
                                              frame.step.stamp.ns});
  });
}

std::shared_ptr<const std::string> text_of(const LiveFrame& frame, const MessageForm& form) {
  return frame.products.get(
      "text", [&] { return output::json_text(*results_of(frame, form), form.tracks ? -1 : 1) + "\n"; });
}

std::shared_ptr<const std::string> left_jpeg(const LiveFrame& frame) {
  return frame.products.get("left.jpg", [&] {
    const View<const Gray> grey = frame.pair->left.gray;
    const View<const Rgb> colour = frame.pair->left.rgb;
    io::PixelRows rows{grey.size(), 1, 1, grey.data(), grey.stride()};
    if (!colour.empty()) {
      rows = {colour.size(), 3, 1, reinterpret_cast<const std::uint8_t*>(colour.data()), colour.stride() * 3};
    }
    return io::encode_jpeg(rows, kJpegQuality);
  });
}

}  // namespace cairn::live
