// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/warp.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace cairn {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

// Between a disparity and a warped one: three standard deviations of 0.35 px · √2.
constexpr float kApart = 1.5F;  // px

const Track* find(const Tracks& tracks, TrackId id) {
  const auto at = std::ranges::lower_bound(tracks.list, id, {}, &Track::id);
  return at != tracks.list.end() && at->id == id ? &*at : nullptr;
}

/// Assigns a pixel to a track if two opposite neighbours belong to it.
void close_gaps(MaskPrediction& warped) {
  const Size size = warped.ids.size();
  const auto fill = [&](int x, int y, int dx, int dy) {
    const TrackId id = warped.ids(x - dx, y - dy);
    if (warped.ids(x, y) != TrackId::none || id == TrackId::none || warped.ids(x + dx, y + dy) != id) return;
    warped.ids(x, y) = id;
    warped.disparity_px(x, y) =
        (warped.disparity_px(x - dx, y - dy) + warped.disparity_px(x + dx, y + dy)) / 2;
  };
  for (int y = 0; y < size.height; ++y)
    for (int x = 1; x + 1 < size.width; ++x) fill(x, y, 1, 0);
  for (int y = 1; y + 1 < size.height; ++y)
    for (int x = 0; x < size.width; ++x) fill(x, y, 0, 1);
}

}  // namespace

MaskPrediction warp(const MaskMemory& remembered, const Tracks& tracks, const Pose& map_from_camera,
                    Stamp now, const StereoRig& rig, Size image, const Exec& exec) {
  MaskPrediction warped{
      {}, Image<TrackId>(image, TrackId::none, exec.pool), Image<float>(image, kNan, exec.pool)};
  Image<std::int32_t> covered(image, 0, exec.pool);  // last mask that covered the pixel, counted from 1
  const Pose camera_from_map = inverse(map_from_camera);
  const double focal_baseline = double{rig.focal_px} * double{rig.baseline_m};
  for (const MaskMemory::Mask& mask : remembered.masks) {
    const Track* const track = find(tracks, mask.track);
    if (track == nullptr || mask.points.empty()) continue;
    const Point3 moved = track->is_moving ? seconds_between(mask.seen, now) * track->velocity_m_s : Point3{};
    MaskPrediction::Mask shown{mask.track, 0, 0};
    int in_view = 0;
    const auto stamp = static_cast<std::int32_t>(warped.masks.size()) + 1;
    for (const SeenPoint& seen : mask.points) {
      const Point3 p = camera_from_map(seen.in_map_m + moved);
      if (!(p.z > 0)) continue;
      const double u = std::floor(double{rig.focal_px} * p.x / p.z + double{rig.cx_px} + 0.5);
      const double v = std::floor(double{rig.focal_px} * p.y / p.z + double{rig.cy_px} + 0.5);
      if (!(u >= 0 && v >= 0 && u < image.width && v < image.height)) continue;
      ++in_view;
      const int x = static_cast<int>(u);
      const int y = static_cast<int>(v);
      if (covered(x, y) != stamp) ++shown.area;
      covered(x, y) = stamp;
      const auto d = static_cast<float>(focal_baseline / p.z - double{rig.doffs_px});
      if (warped.ids(x, y) != TrackId::none && !(d > warped.disparity_px(x, y))) continue;
      warped.ids(x, y) = mask.track;
      warped.disparity_px(x, y) = d;
    }
    shown.in_view = static_cast<float>(in_view) / static_cast<float>(mask.points.size());
    warped.masks.push_back(shown);
  }
  close_gaps(warped);
  return warped;
}

MaskMemory remember(MaskMemory before, const Tracks& tracks, const Objects& objects,
                    const DisparityMap& disparity, const Pose& map_from_camera, Stamp now,
                    const StereoRig& rig) {
  MaskMemory after;
  after.masks.reserve(tracks.list.size());
  std::vector<std::int32_t> mask_of(objects.list.size() + 1, -1);  // −1 = not remembered from this frame
  auto old = before.masks.begin();
  for (const Track& track : tracks.list) {
    while (old != before.masks.end() && old->track < track.id) ++old;
    const bool is_known = old != before.masks.end() && old->track == track.id;
    if (track.object == ObjectId::none || track.is_joined) {
      if (is_known) after.masks.push_back(std::move(*old));
      continue;
    }
    const auto place = static_cast<std::int32_t>(after.masks.size());
    mask_of[slot(number(track.object))] = place;
    for (const ObjectId part : track.parts) mask_of[slot(number(part))] = place;
    after.masks.push_back({track.id, now, is_known ? std::move(old->points) : std::vector<SeenPoint>{}});
    after.masks.back().points.clear();
  }
  for (int y = 0; y < objects.labels.height(); ++y) {
    const ObjectId* const labels = objects.labels.row(y);
    const float* const d = disparity.disparity_px.row(y);
    for (int x = 0; x < objects.labels.width(); ++x) {
      if (labels[x] == ObjectId::none) continue;
      const std::int32_t place = mask_of[slot(number(labels[x]))];
      if (place < 0 || !(d[x] + rig.doffs_px > 0)) continue;  // NaN, or beyond infinity
      const double z = double{rig.focal_px} * double{rig.baseline_m} / (double{d[x]} + double{rig.doffs_px});
      const Point3 in_camera{(x - double{rig.cx_px}) * z / double{rig.focal_px},
                             (y - double{rig.cy_px}) * z / double{rig.focal_px}, z};
      after.masks[slot(place)].points.push_back({map_from_camera(in_camera), d[x]});
    }
  }
  return after;
}

Overlaps overlaps_of(const MaskPrediction& warped, const Tracks& tracks, const Objects& objects,
                     const DisparityMap& disparity) {
  const std::size_t count = tracks.list.size();
  Overlaps found;
  found.objects = static_cast<int>(objects.list.size());
  found.in_view.assign(count, 0);
  found.area.assign(count, 0);
  found.predicted.assign(count, 0);
  found.nearer.assign(count, 0);
  found.common.assign(count * objects.list.size(), 0);
  for (const Track& track : tracks.list) found.tracks.push_back(track.id);
  const auto row_of = [&](TrackId id) {
    return static_cast<std::size_t>(std::ranges::lower_bound(found.tracks, id) - found.tracks.begin());
  };
  for (const MaskPrediction::Mask& mask : warped.masks) {
    found.in_view[row_of(mask.track)] = mask.in_view;
    found.area[row_of(mask.track)] = mask.area;
  }
  TrackId last = TrackId::none;
  std::size_t row = 0;
  for (int y = 0; y < warped.ids.height(); ++y) {
    const TrackId* const ids = warped.ids.row(y);
    const float* const expected = warped.disparity_px.row(y);
    const float* const seen = disparity.disparity_px.row(y);
    const ObjectId* const labels = objects.labels.row(y);
    for (int x = 0; x < warped.ids.width(); ++x) {
      if (ids[x] == TrackId::none) continue;
      if (ids[x] != last) row = row_of(last = ids[x]);
      ++found.predicted[row];
      if (seen[x] > expected[x] + kApart) ++found.nearer[row];
      if (labels[x] != ObjectId::none)
        ++found.common[row * objects.list.size() + slot(number(labels[x])) - 1];
    }
  }
  return found;
}

}  // namespace cairn
