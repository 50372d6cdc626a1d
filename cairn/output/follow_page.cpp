// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/output/follow_page.hpp>

#include <algorithm>
#include <cairn/output/json.hpp>
#include <cairn/output/overlay.hpp>
#include <cairn/output/web/html_template.hpp>
#include <cairn/output/web/page_parts.hpp>
#include <cmath>
#include <utility>

namespace cairn::output {
namespace {

/// The bounding box of a track's visible parts; empty if there are none.
Rect box_of(const Track& track, const Objects& objects) {
  if (track.object == ObjectId::none) return {};
  Rect box = objects.list[slot(number(track.object)) - 1].box_px;
  for (const ObjectId part : track.parts) box = united(box, objects.list[slot(number(part)) - 1].box_px);
  return box;
}

bool is_empty(View<const std::uint8_t> mask) {
  for (int y = 0; y < mask.height(); ++y) {
    if (std::any_of(mask.row(y), mask.row(y) + mask.width(), [](std::uint8_t v) { return v != 0; }))
      return false;
  }
  return true;
}

/// `slot`: as in the map, the index of the track in the list, from 1.
Json label_places(const TrackedFrame& step) {
  Json all = Json::array();
  for (std::size_t i = 0; i < step.tracks.list.size(); ++i) {
    const Track& track = step.tracks.list[i];
    const Rect box = box_of(track, step.frame.objects);
    if (box.width == 0) continue;
    const Image<std::uint8_t> mask = mask_of(View<const TrackId>(step.ids), track.id, box);
    // If two tracks are seen as one object, one of them has the pixels.
    if (is_empty(mask)) continue;
    const LabelPlace place = label_place(mask);
    all.push_back({{"id", i + 1}, {"x", box.x + place.x}, {"y", box.y + place.y}});
  }
  return all;
}

/// Of the pose's uncertainty, the page needs only that of the position.
void keep_covariance_of_place(Json& pose) {
  if (pose.is_null()) return;
  const Json& rows = pose.at("covariance");
  Json place = Json::array();
  for (const std::size_t row : {0U, 1U, 2U}) {
    for (const std::size_t column : {0U, 1U, 2U}) place.push_back(rows.at(6 * row + column));
  }
  pose["covariance_m2"] = place;
  pose.erase("covariance");
}

/// The odometry frame in the map: a rotation about z and a translation. Null if unknown.
Json place_of_odometry(const std::optional<Pose>& pose) {
  if (!pose) return nullptr;
  return {{"yaw_rad", rounded(yaw_of(*pose))}, {"position_m", rounded(pose->translation_m)}};
}

/// `line`: of tracks.jsonl, without frame_id.
Json facts(Json line, const TrackedFrame& step, std::optional<double> milliseconds,
           const std::optional<Pose>& map_from_odom) {
  line["map_from_odom"] = place_of_odometry(map_from_odom);
  keep_covariance_of_place(line.at("pose"));
  for (Json& track : line.at("tracks")) {
    track.erase("rle");
    track.erase("bbox");
  }
  line["marks"] = label_places(step);
  if (milliseconds) line["ms"] = std::round(*milliseconds * 100) / 100;
  return line;
}

/// The index of each pixel's track in the list, from 1: smaller than ids, which grow.
Json packed_tracks(const TrackedFrame& step) {
  const auto& list = step.tracks.list;  // sorted by id
  TrackId before = TrackId::none;
  long number_before = 0;
  return packed(View<const TrackId>(step.ids), [&](TrackId id) {
    if (id == before) return number_before;
    before = id;
    const auto at = std::lower_bound(list.begin(), list.end(), id,
                                     [](const Track& track, TrackId wanted) { return track.id < wanted; });
    return number_before = at != list.end() && at->id == id ? at - list.begin() + 1 : 0L;
  });
}

Json rig_json(const std::optional<StereoRig>& rig) {
  if (!rig) return nullptr;
  return {{"focal_px", rig->focal_px},
          {"cx_px", rig->cx_px},
          {"cy_px", rig->cy_px},
          {"baseline_m", rig->baseline_m}};
}

}  // namespace

EncodedFrame encode_step(Json line, const TrackedFrame& step, View<const Gray> left, View<const Rgb> left_rgb,
                         std::optional<double> milliseconds, const std::optional<Pose>& map_from_odom) {
  line.erase("frame_id");
  const Json maps{{"left", picture_as_uri(left, left_rgb)}, {"tracks", packed_tracks(step)}};
  return {for_script(facts(std::move(line), step, milliseconds, map_from_odom)), for_script(maps)};
}

EncodedFrame encode_step(const TrackedFrame& step, const std::string& name, View<const Gray> left,
                         View<const Rgb> left_rgb, std::optional<double> milliseconds,
                         const LandmarkUpdate& marked) {
  return encode_step(json_of(step, name, marked.tracks, {}), step, left, left_rgb, milliseconds,
                     marked.state.map_from_odom());
}

FollowPage::FollowPage(const std::filesystem::path& file, FollowPageHead head)
    : head_(std::move(head)), file_(file) {
  PageShell shell = page_shell(kFollowLayout, kFollowStyle, kFollowScript, "cairn follow: " + head_.title);
  file_.append(shell.before);
  end_ = std::move(shell.after);
}

void FollowPage::add(const EncodedFrame& step) {
  const std::string number = std::to_string(frames_++);
  file_.append(script_block("facts-" + number, step.facts));
  file_.append(script_block("maps-" + number, step.maps));
}

void FollowPage::add_event(const std::string& line) {
  if (!events_.empty()) events_ += ",";
  events_ += script_text(line);
}

void FollowPage::finish(const LandmarkMap& map) {
  Json landmarks = Json::array();
  for (const Landmark& landmark : map.list) {
    landmarks.push_back({{"id", number(landmark.id)},
                         {"name", landmark.name},
                         {"position_m", rounded(landmark.position_m)},
                         {"gone", landmark.is_gone}});
  }
  const Json run{{"command", "follow"},        {"title", head_.title},
                 {"cairn", CAIRN_VERSION},     {"frames", frames_},
                 {"width", head_.image.width}, {"height", head_.image.height},
                 {"rig", rig_json(head_.rig)}, {"look", {{"objects", id_colours()}}},
                 {"landmarks", landmarks}};
  file_.append(script_block("run", for_script(run)));
  file_.append(script_block("happened", "[" + events_ + "]"));
  file_.append(end_);
  file_.finish();
}

}  // namespace cairn::output
