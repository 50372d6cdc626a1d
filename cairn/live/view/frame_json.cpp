// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/view/frame_json.hpp>

#include <algorithm>
#include <array>
#include <cairn/output/json.hpp>
#include <cairn/output/overlay.hpp>
#include <cairn/ros/from_step.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <cmath>
#include <cstdio>
#include <optional>

namespace cairn::live {
namespace {

using output::Json;

/// With the seven significant digits of a float.
Json json(double value) {
  return output::significant(value, 7);
}
Json json(Vec3 v) {
  return Json::array({json(v.x), json(v.y), json(v.z)});
}
Json json(Point3 p) {
  return Json::array({json(p.x), json(p.y), json(p.z)});
}

// ---- boxes ----

/// A box in the left camera's frame.
struct Box {
  Pose camera_from_box;  // at its centre
  Vec3 size_m;
};

Point3 point(Vec3 v) {
  return {v.x, v.y, v.z};
}

/// Aligned with the floor if it is known, else with the camera's axes.
std::optional<Box> box_of(const Object& object, const std::optional<FloorFrame>& floor) {
  if (object.box_on_floor && floor) {
    const FloorBox& box = *object.box_on_floor;
    const double c = std::cos(double{box.yaw_rad});
    const double s = std::sin(double{box.yaw_rad});
    const Point3 ahead = c * point(floor->forward) + s * point(floor->left);
    const Point3 aside = c * point(floor->left) - s * point(floor->forward);
    const Point3 up = point(floor->up);
    Box all{{}, box.size_m};
    all.camera_from_box.rotation = {ahead.x, aside.x, up.x, ahead.y, aside.y, up.y, ahead.z, aside.z, up.z};
    all.camera_from_box.translation_m = point(floor->to_camera(box.centre_in_floor_m));
    return all;
  }
  if (!object.position_in_camera_m || !object.extent_in_camera_m) return std::nullopt;
  Box all{{}, *object.extent_in_camera_m};
  all.camera_from_box.translation_m = point(*object.position_in_camera_m);
  return all;
}

/// The lower four corners, then the upper ones in the same order; lower is −z of the box.
Json corners_of(const Box& box) {
  Json all = Json::array();
  for (const double z : {-0.5, 0.5}) {
    for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
      all.push_back(json(box.camera_from_box(
          {x * double{box.size_m.x}, y * double{box.size_m.y}, z * double{box.size_m.z}})));
    }
  }
  return all;
}

// ---- objects ----

/// An object to show, with its id in the labels.
struct ShownObject {
  std::int64_t id = 0;
  const Object* object = nullptr;
  const Track* track = nullptr;  // nullptr without tracking
};

std::vector<ShownObject> shown_objects(const TrackedFrame& step) {
  std::vector<ShownObject> all;
  const auto& objects = step.frame.objects.list;
  if (step.ids.empty()) {
    for (const Object& object : objects) all.push_back({number(object.id), &object, nullptr});
    return all;
  }
  for (const Track& track : step.tracks.list) {
    if (track.object == ObjectId::none) continue;
    all.push_back({number(track.id), &objects[static_cast<std::size_t>(number(track.object)) - 1], &track});
  }
  return all;
}

std::optional<double> distance_m(const Object& object) {
  if (!object.position_in_camera_m) return std::nullopt;
  return length(point(*object.position_in_camera_m));
}

Json object_json(const ShownObject& shown, const std::optional<FloorFrame>& floor) {
  const Object& object = *shown.object;
  const std::optional<Box> box = box_of(object, floor);
  const std::optional<double> distance = distance_m(object);
  Json j{{"id", shown.id},
         {"object", number(object.id)},
         {"confidence", json(double{shown.track != nullptr ? shown.track->confidence : object.confidence})},
         {"bbox", {object.box_px.x, object.box_px.y, object.box_px.width, object.box_px.height}},
         {"disparity_px", json(double{object.disparity_px})},
         {"position_m", object.position_in_camera_m ? json(*object.position_in_camera_m) : Json(nullptr)},
         {"distance_m", distance ? json(*distance) : Json(nullptr)},
         {"size_m", box ? json(box->size_m) : Json(nullptr)},
         {"corners_m", box ? corners_of(*box) : Json(nullptr)},
         {"is_moving", shown.track != nullptr && shown.track->is_moving},
         {"state", nullptr}};
  if (shown.track != nullptr) {
    j["state"] = choice_name(shown.track->state, kTrackStates);
    if (shown.track->has_place) j["velocity_m_s"] = json(shown.track->velocity_m_s);
  }
  return j;
}

// ---- statistics ----

Json rig_json(const std::optional<StereoRig>& rig) {
  if (!rig) return nullptr;
  return {{"focal_px", json(double{rig->focal_px})},
          {"cx_px", json(double{rig->cx_px})},
          {"cy_px", json(double{rig->cy_px})},
          {"baseline_m", json(double{rig->baseline_m})},
          {"doffs_px", json(double{rig->doffs_px})}};
}

Json ground_json(const Ground& ground, const std::optional<FloorFrame>& floor) {
  if (!ground.plane) return nullptr;
  Json j{{"a", json(double{ground.plane->a})},
         {"b", json(double{ground.plane->b})},
         {"c", json(double{ground.plane->c})},
         {"support", json(double{ground.support})},
         {"normal", nullptr},
         {"height_m", nullptr}};
  if (floor) {
    j["normal"] = json(floor->up);
    j["forward"] = json(floor->forward);
    j["left"] = json(floor->left);
    j["height_m"] = json(double{floor->camera_height_m});
  }
  return j;
}

Json source_json(const input::SourceStatus& source) {
  return {{"is_live", source.is_live},   {"is_connected", source.is_connected}, {"dropped", source.dropped},
          {"unpaired", source.unpaired}, {"reconnects", source.reconnects},     {"trouble", source.trouble},
          {"clock", source.clock}};
}

Json camera_json(const TrackedFrame& step, const std::optional<StereoRig>& rig) {
  if (step.is_lost || !rig || step.ids.empty()) return nullptr;
  Json turn = Json::array();
  for (const double entry : quaternion(step.map_from_camera)) turn.push_back(json(entry));
  return {{"position_m", json(step.map_from_camera.translation_m)}, {"quaternion_xyzw", turn}};
}

Json image_json(const LiveFrame& frame) {
  const Size size = frame.pair->left.gray.size();
  return {{"width", size.width}, {"height", size.height}};
}

// ---- the scene ----

Json colour_json(std::int64_t id, double opacity) {
  constexpr std::int64_t kColours = 1000;  // the number of different colours of object_colour()
  const Rgb c = output::object_colour(ObjectId{static_cast<std::int32_t>(id % kColours)});
  return {{"r", json(c.r / 255.0)}, {"g", json(c.g / 255.0)}, {"b", json(c.b / 255.0)}, {"a", opacity}};
}

Json vector_json(Point3 p) {
  return {{"x", json(p.x)}, {"y", json(p.y)}, {"z", json(p.z)}};
}

Json pose_json(const Pose& pose) {
  const auto q = quaternion(pose);
  return {{"position", vector_json(pose.translation_m)},
          {"orientation", {{"x", json(q[0])}, {"y", json(q[1])}, {"z", json(q[2])}, {"w", json(q[3])}}}};
}

std::string words_of(const ShownObject& shown) {
  std::string words = std::to_string(shown.id);
  if (const auto distance = distance_m(*shown.object)) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "  %.2f m", *distance);
    words += text.data();
  }
  return words;
}

Json entity_json(const ShownObject& shown, const Box& box, const Json& stamp,
                 const std::string& camera_frame) {
  const Json size{{"x", json(double{box.size_m.x})},
                  {"y", json(double{box.size_m.y})},
                  {"z", json(double{box.size_m.z})}};
  Pose above = box.camera_from_box;
  above.translation_m.y -= 0.5 * double{std::max({box.size_m.x, box.size_m.y, box.size_m.z})};
  const Json cube{
      {"pose", pose_json(box.camera_from_box)}, {"size", size}, {"color", colour_json(shown.id, 0.5)}};
  const Json text{{"pose", pose_json(above)},
                  {"billboard", true},
                  {"font_size", 14},
                  {"scale_invariant", true},
                  {"color", colour_json(shown.id, 1)},
                  {"text", words_of(shown)}};
  const Json none = Json::array();
  // Entities of objects no longer seen expire by their lifetime.
  return {{"timestamp", stamp},
          {"frame_id", camera_frame},
          {"id", std::to_string(shown.id)},
          {"lifetime", {{"sec", 1}, {"nsec", 0}}},
          {"frame_locked", false},
          {"metadata", none},
          {"arrows", none},
          {"cubes", Json::array({cube})},
          {"spheres", none},
          {"cylinders", none},
          {"lines", none},
          {"triangles", none},
          {"texts", Json::array({text})},
          {"models", none}};
}

}  // namespace

std::string stats_json(const LiveFrame& frame, const std::optional<StereoRig>& rig, const ViewState& state) {
  const TrackedFrame& step = frame.step;
  const auto floor = floor_frame(step.frame.ground, rig);
  Json stages = Json::array();
  for (const output::StageTime& stage : frame.stages)
    stages.push_back({{"stage", stage.stage}, {"ms", json(stage.milliseconds)}});
  Json objects = Json::array();
  for (const ShownObject& shown : shown_objects(step)) objects.push_back(object_json(shown, floor));
  Json all{{"frame", step.index},
           {"name", frame.pair->name},
           {"stamp_ns", step.stamp.ns},
           {"rate_hz", json(frame.rate_hz)},
           {"latency_ms", json(ms_between(frame.arrived, frame.done))},
           {"stages", stages},
           {"drops",
            {{"at_source", frame.drops.at_source},
             {"replaced", frame.drops.replaced},
             {"too_old", frame.drops.too_old}}},
           {"source", source_json(state.source.value_or(frame.source))},
           {"findings", output::json_of(frame.findings)},
           {"revision", frame.revision},
           {"clients", state.clients},
           {"skipped", state.skipped},
           {"num_disparities", frame.config->segmentation.match.num_disparities},
           {"min_disparity", frame.config->segmentation.match.min_disparity},
           {"image", image_json(frame)},
           {"rig", rig_json(rig)},
           {"ground", ground_json(step.frame.ground, floor)},
           {"tunable", state.is_tunable},
           {"can_record", state.can_record},
           {"recording", state.is_recording},
           {"is_file", state.is_file},
           {"paused", state.is_paused},
           {"objects", objects},
           {"camera", camera_json(step, rig)}};
  if (frame.device) all["device"] = output::json_of(*frame.device);
  return output::json_text(all);
}

std::string stats_json(const ViewState& state) {
  return output::json_text({{"frame", nullptr},
                            {"clients", state.clients},
                            {"source", source_json(state.source.value_or(input::SourceStatus{}))}});
}

std::string scene_json(const LiveFrame& frame, const std::optional<StereoRig>& rig) {
  const auto floor = floor_frame(frame.step.frame.ground, rig);
  const ros::Time time = ros::time_of(frame.step.stamp);
  const Json stamp{{"sec", time.sec}, {"nsec", time.nanosec}};
  const std::string camera_frame = ros::frame_names(frame.pair->frame_id).camera;
  Json entities = Json::array();
  for (const ShownObject& shown : shown_objects(frame.step)) {
    if (const auto box = box_of(*shown.object, floor))
      entities.push_back(entity_json(shown, *box, stamp, camera_frame));
  }
  // Deletes all entities of the previous frame; those still present are sent again.
  const Json deletion{{"timestamp", stamp}, {"type", 1}, {"id", ""}};
  return output::json_text({{"deletions", Json::array({deletion})}, {"entities", entities}});
}

const std::string_view kStatsSchema = R"({
  "type": "object", "title": "cairn.Stats",
  "properties": {
    "frame": {"type": "integer"}, "name": {"type": "string"}, "stamp_ns": {"type": "integer"},
    "rate_hz": {"type": "number"}, "latency_ms": {"type": "number"},
    "stages": {"type": "array", "items": {"type": "object",
      "properties": {"stage": {"type": "string"}, "ms": {"type": "number"}}}},
    "drops": {"type": "object", "properties": {"at_source": {"type": "integer"},
      "replaced": {"type": "integer"}, "too_old": {"type": "integer"}}},
    "source": {"type": "object", "properties": {"is_live": {"type": "boolean"},
      "is_connected": {"type": "boolean"}, "dropped": {"type": "integer"}, "unpaired": {"type": "integer"},
      "reconnects": {"type": "integer"}, "trouble": {"type": "string"}, "clock": {"type": "string"}}},
    "findings": {"type": "array", "items": {"type": "object", "properties": {"finding": {"type": "string"},
      "severity": {"type": "string"}, "value": {"type": "number"}, "number": {"type": "string"},
      "unit": {"type": "string"}, "says": {"type": "string"}, "remedy": {"type": "string"}}}},
    "revision": {"type": "integer"}, "clients": {"type": "integer"}, "skipped": {"type": "integer"},
    "num_disparities": {"type": "integer"}, "min_disparity": {"type": "integer"},
    "image": {"type": "object", "properties": {"width": {"type": "integer"}, "height": {"type": "integer"}}},
    "rig": {"type": "object", "properties": {"focal_px": {"type": "number"}, "cx_px": {"type": "number"},
      "cy_px": {"type": "number"}, "baseline_m": {"type": "number"}, "doffs_px": {"type": "number"}}},
    "ground": {"type": "object", "properties": {"a": {"type": "number"}, "b": {"type": "number"},
      "c": {"type": "number"}, "support": {"type": "number"}, "height_m": {"type": "number"},
      "normal": {"type": "array", "items": {"type": "number"}},
      "forward": {"type": "array", "items": {"type": "number"}},
      "left": {"type": "array", "items": {"type": "number"}}}},
    "device": {"type": "object", "properties": {"wanted": {"type": "string"}, "name": {"type": "string"}, "on_device": {"type": "integer"},
      "on_processor": {"type": "integer"}, "reason": {"type": "string"}, "kernels": {"type": "object"},
      "memory_bytes": {"type": "integer"}}},
    "tunable": {"type": "boolean"}, "can_record": {"type": "boolean"}, "recording": {"type": "boolean"},
    "is_file": {"type": "boolean"}, "paused": {"type": "boolean"},
    "objects": {"type": "array", "items": {"type": "object", "properties": {
      "id": {"type": "integer"}, "object": {"type": "integer"}, "confidence": {"type": "number"},
      "bbox": {"type": "array", "items": {"type": "integer"}}, "disparity_px": {"type": "number"},
      "position_m": {"type": "array", "items": {"type": "number"}}, "distance_m": {"type": "number"},
      "size_m": {"type": "array", "items": {"type": "number"}},
      "corners_m": {"type": "array", "items": {"type": "array", "items": {"type": "number"}}},
      "velocity_m_s": {"type": "array", "items": {"type": "number"}},
      "is_moving": {"type": "boolean"}, "state": {"type": "string"}}}},
    "camera": {"type": "object", "properties": {
      "position_m": {"type": "array", "items": {"type": "number"}},
      "quaternion_xyzw": {"type": "array", "items": {"type": "number"}}}}
  }
})";

// The fields of foxglove.SceneUpdate that our messages use; the item type of empty lists is arbitrary.
const std::string_view kSceneSchema = R"({
  "type": "object", "title": "foxglove.SceneUpdate",
  "$defs": {
    "time": {"type": "object", "title": "time", "properties": {"sec": {"type": "integer", "minimum": 0},
      "nsec": {"type": "integer", "minimum": 0, "maximum": 999999999}}},
    "duration": {"type": "object", "title": "duration", "properties": {"sec": {"type": "integer"},
      "nsec": {"type": "integer", "minimum": 0, "maximum": 999999999}}},
    "vector": {"type": "object", "title": "foxglove.Vector3", "properties": {"x": {"type": "number"},
      "y": {"type": "number"}, "z": {"type": "number"}}},
    "color": {"type": "object", "title": "foxglove.Color", "properties": {"r": {"type": "number"},
      "g": {"type": "number"}, "b": {"type": "number"}, "a": {"type": "number"}}},
    "pose": {"type": "object", "title": "foxglove.Pose", "properties": {
      "position": {"$ref": "#/$defs/vector"},
      "orientation": {"type": "object", "title": "foxglove.Quaternion", "properties": {
        "x": {"type": "number"}, "y": {"type": "number"}, "z": {"type": "number"}, "w": {"type": "number"}}}}},
    "none": {"type": "array", "items": {"type": "object"}}
  },
  "properties": {
    "deletions": {"type": "array", "items": {"type": "object", "title": "foxglove.SceneEntityDeletion",
      "properties": {"timestamp": {"$ref": "#/$defs/time"}, "type": {"type": "integer"},
        "id": {"type": "string"}}}},
    "entities": {"type": "array", "items": {"type": "object", "title": "foxglove.SceneEntity", "properties": {
      "timestamp": {"$ref": "#/$defs/time"}, "frame_id": {"type": "string"}, "id": {"type": "string"},
      "lifetime": {"$ref": "#/$defs/duration"}, "frame_locked": {"type": "boolean"},
      "metadata": {"$ref": "#/$defs/none"}, "arrows": {"$ref": "#/$defs/none"},
      "cubes": {"type": "array", "items": {"type": "object", "title": "foxglove.CubePrimitive", "properties": {
        "pose": {"$ref": "#/$defs/pose"}, "size": {"$ref": "#/$defs/vector"},
        "color": {"$ref": "#/$defs/color"}}}},
      "spheres": {"$ref": "#/$defs/none"}, "cylinders": {"$ref": "#/$defs/none"},
      "lines": {"$ref": "#/$defs/none"}, "triangles": {"$ref": "#/$defs/none"},
      "texts": {"type": "array", "items": {"type": "object", "title": "foxglove.TextPrimitive", "properties": {
        "pose": {"$ref": "#/$defs/pose"}, "billboard": {"type": "boolean"}, "font_size": {"type": "number"},
        "scale_invariant": {"type": "boolean"}, "color": {"$ref": "#/$defs/color"},
        "text": {"type": "string"}}}},
      "models": {"$ref": "#/$defs/none"}}}}
  }
})";

}  // namespace cairn::live
