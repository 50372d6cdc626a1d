// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/output/follow_files.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/diagnosis/rig_watch.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/rle.hpp>
#include <cairn/output/json.hpp>
#include <cairn/output/overlay.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <system_error>

namespace cairn::output {
namespace {

namespace fs = std::filesystem;

template <class Rows>
Json matrix(const Rows& rows) {
  Json all = Json::array();
  for (const double entry : rows) all.push_back(significant(entry));
  return all;
}

/// The tracks in a frame: labels with track ids, and their positions.
struct TrackLabels {
  Image<ObjectId> labels;
  std::map<std::int64_t, Rect> boxes;
};

TrackLabels track_labels_of(const TrackedFrame& step) {
  TrackLabels shown{Image<ObjectId>(step.ids.size()), {}};
  for (int y = 0; y < step.ids.height(); ++y) {
    for (int x = 0; x < step.ids.width(); ++x)
      shown.labels(x, y) = ObjectId{static_cast<std::int32_t>(number(step.ids(x, y)))};
  }
  for (const Track& track : step.tracks.list) {
    if (track.object == ObjectId::none) continue;
    Rect& box = shown.boxes[number(track.id)];
    box = step.frame.objects.list[slot(number(track.object)) - 1].box_px;
    for (const ObjectId part : track.parts)
      box = united(box, step.frame.objects.list[slot(number(part)) - 1].box_px);
  }
  return shown;
}

io::Rle rle_of(const TrackLabels& shown, TrackId id) {
  return io::encode_rle(shown.labels, ObjectId{static_cast<std::int32_t>(number(id))},
                        shown.boxes.at(number(id)));
}

/// Without a rig there are no metric positions, so the pose is null.
bool has_place(const TrackedFrame& step) {
  return !step.is_lost && step.motion.refusal != MotionRefusal::no_rig;
}

Json pose_json(const TrackedFrame& step) {
  if (!has_place(step)) return nullptr;
  Json turn = Json::array();
  for (const double entry : quaternion(step.map_from_camera)) turn.push_back(rounded(entry));
  return {{"position_m", rounded(step.map_from_camera.translation_m)},
          {"quaternion_xyzw", turn},
          {"covariance", matrix(step.pose_covariance)}};
}

Json motion_json(const Motion& motion) {
  return {{"refusal", choice_name(motion.refusal, kMotionRefusals)},
          {"new_keyframe", motion.is_new_keyframe},
          {"followed", motion.followed},
          {"inliers", motion.inliers},
          {"chi2_per_dof", significant(double{motion.chi2_per_dof})}};
}

Json reliability_json(const Reliability& reliability) {
  const auto share = [](std::optional<float> value) {
    return value ? significant(double{*value}) : Json(nullptr);
  };
  Json j{{"value", share(reliability.value)},
         {"weakest", reliability.weakest},
         {"unreliable", reliability.is_unreliable}};
  for (const WitnessName& witness : kWitnesses)
    j[std::string(witness.name)] = share(reliability.witnesses.*witness.value);
  j["steadiness"] = significant(double{reliability.steadiness});
  return j;
}

Json track_json(const Track& track, const TrackedFrame& step, const TrackLabels& shown,
                const std::vector<LandmarkOfTrack>& landmarks) {
  Json j{{"id", number(track.id)},
         {"state", choice_name(track.state, kTrackStates)},
         {"moving", track.is_moving},
         {"object", number(track.object)},
         {"position_m", nullptr},
         {"covariance_m2", nullptr},
         {"velocity_m_s", nullptr},
         {"extent_m", nullptr},
         {"confidence", significant(double{track.confidence})},
         {"hits", track.hits},
         {"misses", track.misses}};
  if (track.has_place) {
    j["position_m"] = rounded(track.position_m);
    j["covariance_m2"] = matrix(covariance_in_map(track, step.map_from_camera, step.pose_covariance));
    j["velocity_m_s"] = rounded(track.velocity_m_s);
    j["extent_m"] = {rounded(track.extent_m.x), rounded(track.extent_m.y), rounded(track.extent_m.z)};
  }
  const auto of = std::ranges::find(landmarks, track.id, &LandmarkOfTrack::track);
  if (of != landmarks.end()) {
    if (of->landmark != LandmarkId::none) {
      j["landmark"] = number(of->landmark);
      j["recognised"] = of->is_recognised;
    } else {
      j["no_landmark"] = choice_name(of->refusal, kLandmarkRefusals);
    }
  }
  if (track.object == ObjectId::none) return j;
  const Rect box = shown.boxes.at(number(track.id));
  const io::Rle rle = rle_of(shown, track.id);
  j["bbox"] = {box.x, box.y, box.width, box.height};
  j["rle"] = {{"size", {rle.size.height, rle.size.width}}, {"counts", rle.counts}};
  return j;
}

Json control_json(const ControlEvent& event) {
  return {{"option", event.candidate.option},
          {"from", event.before},
          {"to", event.candidate.value},
          {"lead", event.gain},
          {"set", event.is_set}};
}

/// What the lines of events.jsonl begin with.
Json event_of(const TrackedFrame& step, const std::string& kind) {
  return {{"frame", step.index}, {"stamp_ns", step.stamp.ns}, {"kind", kind}};
}

Json landmark_event_of(const TrackedFrame& step, const LandmarkEvent& event,
                       const std::vector<LandmarkOfTrack>& landmarks) {
  Json j = event_of(step, choice_name(event.kind, kLandmarkEventKinds));
  j["stamp_ns"] = event.stamp.ns;
  if (event.landmark != LandmarkId::none) {
    j["landmark"] = number(event.landmark);
    for (const LandmarkOfTrack& of : landmarks) {
      if (of.landmark == event.landmark && of.track != TrackId::none) j["track"] = number(of.track);
    }
  }
  const auto point = [](Point3 p) { return Json::array({p.x, p.y, p.z}); };
  j["to_m"] = point(event.position_m);
  if (event.kind == LandmarkEventKind::moved || event.kind == LandmarkEventKind::relocated)
    j["from_m"] = point(event.position_m - event.moved_by_m);
  j["probability"] = event.probability;
  j["frames"] = event.frames;
  return j;
}

}  // namespace

std::vector<Json> event_lines(const TrackedFrame& step, const std::vector<LandmarkOfTrack>& landmarks,
                              const std::vector<LandmarkEvent>& events,
                              const std::vector<FindingChange>& changes) {
  std::vector<Json> lines;
  if (step.control) {
    const ControlEvent& event = *step.control;
    Json& j = lines.emplace_back(event_of(step, event.is_set ? "option_set" : "option_better"));
    j["option"] = event.candidate.option;
    j["from"] = event.before;
    j["to"] = event.candidate.value;
    j["lead"] = event.gain;
  }
  if (becomes_unreliable(step)) {
    Json& j = lines.emplace_back(event_of(step, "unreliable"));
    j["weakest"] = step.reliability.weakest;
    j["reliability"] = step.reliability.value.value_or(0);
  }
  for (const auto& [finding, is_gone] : changes) {
    Json& j = lines.emplace_back(event_of(step, is_gone ? "finding_gone" : "finding"));
    j["finding"] = info(finding.kind).name;
    j["severity"] = choice_name(finding.severity, kSeverities);
    j["says"] = finding.says;
  }
  for (const LandmarkEvent& event : events) lines.push_back(landmark_event_of(step, event, landmarks));
  return lines;
}

bool becomes_unreliable(const TrackedFrame& step) {
  return step.reliability.is_unreliable && step.reliability.weak_frames == kUnreliableFrames;
}

Json json_of(const TrackedFrame& step, const std::string& name, const std::vector<LandmarkOfTrack>& landmarks,
             const std::string& frame_id) {
  const TrackLabels shown = track_labels_of(step);
  Json tracks = Json::array();
  for (const Track& track : step.tracks.list) tracks.push_back(track_json(track, step, shown, landmarks));
  Json line{{"frame", step.index}, {"name", name}, {"stamp_ns", step.stamp.ns}};
  if (!frame_id.empty()) line["frame_id"] = frame_id;
  line.update({{"pose", pose_json(step)},
               {"motion", motion_json(step.motion)},
               {"reliability", reliability_json(step.reliability)},
               {"objects", step.frame.objects.list.size()},
               {"tracks", tracks}});
  if (step.control) line["control"] = control_json(*step.control);
  return line;
}

std::string step_json(const TrackedFrame& step, const std::string& name, const LandmarkUpdate& marked,
                      const std::string& frame_id) {
  return json_text(json_of(step, name, marked.tracks, frame_id)) + "\n";
}

std::string pose_tum(const TrackedFrame& step) {
  if (!has_place(step)) return {};
  const Point3 p = step.map_from_camera.translation_m;
  const auto q = quaternion(step.map_from_camera);
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), " %.6f %.6f %.6f %.8f %.8f %.8f %.8f\n", p.x, p.y, p.z, q[0], q[1],
                q[2], q[3]);
  return seconds_text(step.stamp) + text.data();
}

std::string masks_mots(const TrackedFrame& step) {
  const TrackLabels shown = track_labels_of(step);
  std::string lines;
  for (const Track& track : step.tracks.list) {
    if (track.object == ObjectId::none || track.state == TrackState::tentative) continue;
    const io::Rle rle = rle_of(shown, track.id);
    lines += std::to_string(step.index) + " " + std::to_string(number(track.id)) + " 1 " +
             std::to_string(rle.size.height) + " " + std::to_string(rle.size.width) + " " + rle.counts + "\n";
  }
  return lines;
}

Image<Rgb> draw_tracks(View<const Gray> left, View<const Rgb> left_rgb, const TrackedFrame& step) {
  // Objects with their track ids, by which the overlay colours and labels them.
  TrackLabels shown = track_labels_of(step);
  Objects tracked;
  std::vector<std::int64_t> drawn;
  for (const Track& track : step.tracks.list) {
    if (track.object == ObjectId::none || track.state == TrackState::tentative) continue;
    drawn.push_back(number(track.id));
    tracked.list.push_back(step.frame.objects.list[slot(number(track.object)) - 1]);
    tracked.list.back().id = ObjectId{static_cast<std::int32_t>(number(track.id))};
    tracked.list.back().box_px = shown.boxes.at(number(track.id));
  }
  tracked.labels = std::move(shown.labels);
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) {
      ObjectId& label = tracked.labels(x, y);
      if (!std::ranges::binary_search(drawn, std::int64_t{number(label)})) label = ObjectId::none;
    }
  }
  return draw_objects(left, left_rgb, tracked, step.frame.floor);
}

FollowFiles::FollowFiles(fs::path folder) : folder_(std::move(folder)) {
  io::make_folder(folder_);
  for (const auto& [file, name] : {std::pair{&tracks_, "tracks.jsonl"},
                                   {&poses_, "poses.tum"},
                                   {&masks_, "tracks.mots.txt"},
                                   {&events_, "events.jsonl"}}) {
    file->open(folder_ / name, std::ios::binary | std::ios::trunc);
    if (!*file) {
      throw Error((folder_ / name).string() +
                  ": cannot be written: " + std::generic_category().message(errno));
    }
  }
}

void FollowFiles::append(std::ofstream& file, const char* name, const std::string& text) {
  errno = 0;
  file << text << std::flush;
  if (!file)
    throw Error((folder_ / name).string() + ": cannot be written: " + std::generic_category().message(errno));
}

void FollowFiles::add(const TrackedFrame& step, const std::string& line) {
  append(tracks_, "tracks.jsonl", line);
  append(poses_, "poses.tum", pose_tum(step));
  append(masks_, "tracks.mots.txt", masks_mots(step));
}

void FollowFiles::add_event(const std::string& line) {
  append(events_, "events.jsonl", line);
}

}  // namespace cairn::output
