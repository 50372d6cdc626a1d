// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/ros/from_step.hpp>

#include <algorithm>
#include <bit>
#include <cairn/core/error.hpp>
#include <cairn/io/raster.hpp>
#include <cmath>
#include <limits>

namespace cairn::ros {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

/// An image with contiguous rows to be filled in.
Image blank(const Header& header, Size size, const char* encoding, std::uint32_t pixel_bytes) {
  Image message;
  message.header = header;
  message.width = static_cast<std::uint32_t>(size.width);
  message.height = static_cast<std::uint32_t>(size.height);
  message.encoding = encoding;
  message.step = message.width * pixel_bytes;
  message.data.resize(std::size_t{message.step} * message.height);
  return message;
}

void store(std::uint8_t* to, std::uint32_t value) {
  for (unsigned i = 0; i < 4; ++i) to[i] = static_cast<std::uint8_t>(value >> 8 * i & 0xff);
}
void store(std::uint8_t* to, float value) {
  store(to, std::bit_cast<std::uint32_t>(value));
}

/// mono16 with value_of(pixel).
template <class T, class ValueOf>
Image mono16(const Header& header, View<const T> image, ValueOf value_of) {
  Image message = blank(header, image.size(), "mono16", 2);
  std::uint8_t* to = message.data.data();
  for (int y = 0; y < image.height(); ++y) {
    const T* const row = image.row(y);
    for (int x = 0; x < image.width(); ++x) {
      const auto value = static_cast<std::uint16_t>(value_of(row[x]));
      *to++ = static_cast<std::uint8_t>(value & 0xff);
      *to++ = static_cast<std::uint8_t>(value >> 8);
    }
  }
  return message;
}

Quaternion quaternion_of(const cairn::Pose& pose) {
  const auto [x, y, z, w] = quaternion(pose);
  return {x, y, z, w};
}
Vector3 vector_of(Vec3 v) {
  return {double{v.x}, double{v.y}, double{v.z}};
}

/// The track of an object, or of the object that it is a piece of.
TrackId track_of(const Tracks& tracks, ObjectId object) {
  for (const Track& track : tracks.list) {
    if (track.object == object ||
        std::find(track.parts.begin(), track.parts.end(), object) != track.parts.end())
      return track.id;
  }
  return TrackId::none;
}

/// Along the ray from the disparity's uncertainty, across it half a pixel from the edge.
std::array<double, 36> covariance_of(const Object& object, Vec3 position, const StereoRig& rig) {
  const double z = double{position.z};
  const double across = z * 0.5 / double{rig.focal_px};
  const double along =
      z * z * double{object.disparity_sigma_px} / (double{rig.focal_px} * double{rig.baseline_m});
  const std::array<double, 3> ray{double{position.x} / z, double{position.y} / z, 1};
  std::array<double, 36> covariance{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column)
      covariance[row * 6 + column] = along * along * ray[row] * ray[column];
    if (row < 2) covariance[row * 7] += across * across;
  }
  return covariance;
}

/// A thing in the frame of a map.
Detection3D detection_of(const Header& header, const std::string& id, Point3 at,
                         const Covariance3& covariance, Vector3 size, double score) {
  Detection3D found;
  found.header = header;
  found.id = id;
  found.bbox.center.position = {at.x, at.y, at.z};
  found.bbox.size = size;
  ObjectHypothesisWithPose result;
  result.hypothesis = {"object", score};
  result.pose.pose = found.bbox.center;
  for (std::ptrdiff_t row = 0; row < 3; ++row)
    std::copy_n(covariance.begin() + 3 * row, 3, result.pose.covariance.begin() + 6 * row);
  found.results.push_back(std::move(result));
  return found;
}

}  // namespace

FrameNames frame_names(const std::string& camera) {
  FrameNames names;
  if (!camera.empty()) names.camera = camera;
  return names;
}

std::string camera_of(const Header& header) {
  return header.frame_id == FrameNames().camera ? "" : header.frame_id;
}

Header header_of(Stamp stamp, const std::string& frame_id) {
  return {time_of(stamp), frame_id};
}

Image image_of(const Header& header, View<const Gray> image) {
  Image message = blank(header, image.size(), "mono8", 1);
  for (int y = 0; y < image.height(); ++y)
    std::copy_n(image.row(y), image.width(), message.data.begin() + std::ptrdiff_t{y} * image.width());
  return message;
}

Image image_of(const Header& header, View<const Rgb> image) {
  Image message = blank(header, image.size(), "rgb8", 3);
  std::uint8_t* to = message.data.data();
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const Rgb colour = image(x, y);
      *to++ = colour.r;
      *to++ = colour.g;
      *to++ = colour.b;
    }
  }
  return message;
}

Image image_of(const Header& header, View<const float> image) {
  Image message = blank(header, image.size(), "32FC1", 4);
  std::uint8_t* to = message.data.data();
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x, to += 4) store(to, image(x, y));
  return message;
}

CameraInfo camera_info_of(const Header& header, const StereoRig& rig, Size size, Side side) {
  const double focal = rig.focal_px;
  const double cx = side == Side::left ? double{rig.cx_px} : double{rig.cx_px} + double{rig.doffs_px};
  const double cy = rig.cy_px;
  CameraInfo info;
  info.header = header;
  info.height = static_cast<std::uint32_t>(size.height);
  info.width = static_cast<std::uint32_t>(size.width);
  info.distortion_model = "plumb_bob";
  info.d.assign(5, 0.0);
  info.k = {focal, 0, cx, 0, focal, cy, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {focal, 0, cx, side == Side::left ? 0.0 : -focal * double{rig.baseline_m}, 0, focal, cy, 0, 0,
            0,     1, 0};
  return info;
}

CameraInfo as_published(CameraInfo info) {
  const RegionOfInterest& roi = info.roi;
  const double offset[2] = {static_cast<double>(roi.x_offset), static_cast<double>(roi.y_offset)};
  const double binning[2] = {std::max(1.0, static_cast<double>(info.binning_x)),
                             std::max(1.0, static_cast<double>(info.binning_y))};
  for (std::size_t row = 0; row < 2; ++row) {
    info.k[3 * row + 2] -= offset[row];
    info.p[4 * row + 2] -= offset[row];
    for (std::size_t i = 0; i < 3; ++i) info.k[3 * row + i] /= binning[row];
    for (std::size_t i = 0; i < 4; ++i) info.p[4 * row + i] /= binning[row];
  }
  const auto binned = [](std::uint32_t full, std::uint32_t part, double by) {
    return static_cast<std::uint32_t>((part == 0 ? full : part) / by);
  };
  info.width = binned(info.width, roi.width, binning[0]);
  info.height = binned(info.height, roi.height, binning[1]);
  info.roi = {};
  info.binning_x = info.binning_y = 0;
  return info;
}

Size image_size_of(const CameraInfo& info) {
  if (info.width == 0 || info.height == 0) return {};
  io::check_sides(info.width, info.height);
  const CameraInfo published = as_published(info);
  return {static_cast<int>(published.width), static_cast<int>(published.height)};
}

namespace {

void check_size(const CameraInfo& info, std::optional<Size> images) {
  const Size size = image_size_of(info);
  if (!images || size.area() == 0 || size == *images) return;
  throw Error("camera_info: is of images of " + text(size) + ", expected " + text(*images) + " as they come");
}

}  // namespace

std::optional<StereoRig> one_camera_of(const CameraInfo& info, bool is_raw, std::optional<Size> images) {
  check_size(info, images);
  const CameraInfo published = as_published(info);
  // Drivers of depth cameras often leave P empty, since their images have no distortion.
  const auto& [p, k] = std::pair(published.p, published.k);
  const bool has_p = p[0] > 0 && !(is_raw && k[0] > 0);
  const StereoRig camera{static_cast<float>(has_p ? p[0] : k[0]), static_cast<float>(has_p ? p[2] : k[2]),
                         static_cast<float>(has_p ? p[6] : k[5])};
  if (!(camera.focal_px > 0)) return std::nullopt;
  return camera;
}

StereoRig rig_of(const CameraInfo& left_info, const CameraInfo& right_info, std::optional<Size> images) {
  for (const CameraInfo* info : {&left_info, &right_info}) check_size(*info, images);
  const CameraInfo left = as_published(left_info);
  const CameraInfo right = as_published(right_info);
  if (!(left.p[0] > 0) || !(right.p[0] > 0)) {
    throw Error("camera_info: found a focal length of " +
                std::to_string(!(left.p[0] > 0) ? left.p[0] : right.p[0]) +
                " in P, expected one of rectified cameras, above 0");
  }
  if (std::abs(left.p[0] - right.p[0]) > 1e-3 * left.p[0] || std::abs(left.p[6] - right.p[6]) > 0.5) {
    throw Error("camera_info: found P of cameras that differ in focal length or cy (" +
                std::to_string(left.p[0]) + ", " + std::to_string(left.p[6]) + " and " +
                std::to_string(right.p[0]) + ", " + std::to_string(right.p[6]) +
                "), expected those of a rectified pair");
  }
  if (left.p[3] < right.p[3]) {
    throw Error("camera_info: the two are exchanged: P[3] of the left camera is " +
                std::to_string(left.p[3]) + ", that of the right one " + std::to_string(right.p[3]) +
                ", expected -focal * baseline for the right one");
  }
  const StereoRig rig{static_cast<float>(left.p[0]), static_cast<float>(left.p[2]),
                      static_cast<float>(left.p[6]), static_cast<float>((left.p[3] - right.p[3]) / left.p[0]),
                      static_cast<float>(right.p[2] - left.p[2])};
  rig.validate("camera_info");
  return rig;
}

DisparityImage disparity_image_of(const Header& header, const Frame& frame,
                                  const std::optional<StereoRig>& rig, const MatchConfig& config,
                                  std::optional<float> hole_px) {
  return disparity_image_of(header, View<const float>(frame.disparity.disparity_px), rig, config, hole_px);
}

DisparityImage disparity_image_of(const Header& header, View<const float> disparity_px,
                                  const std::optional<StereoRig>& rig, const MatchConfig& config,
                                  std::optional<float> hole_px) {
  const float offset = rig ? rig->doffs_px : 0.0F;
  DisparityImage message;
  message.header = header;
  message.image = blank(header, disparity_px.size(), "32FC1", 4);
  std::uint8_t* to = message.image.data.data();
  for (int y = 0; y < disparity_px.height(); ++y) {
    for (int x = 0; x < disparity_px.width(); ++x, to += 4) {
      const float d = disparity_px(x, y);
      store(to, std::isnan(d) ? hole_px.value_or(kHole) : d + offset);
    }
  }
  if (rig) {
    message.f = rig->focal_px;
    message.t = rig->baseline_m;
  }
  message.valid_window.width = message.image.width;
  message.valid_window.height = message.image.height;
  message.min_disparity = static_cast<float>(config.min_disparity) + offset;
  message.max_disparity = static_cast<float>(config.min_disparity + config.num_disparities - 1) + offset;
  message.delta_d = 1.0F / 16;
  return message;
}

Image labels_of(const Header& header, const TrackedFrame& step) {
  if (step.ids.empty()) {
    return mono16(header, View<const ObjectId>(step.frame.objects.labels),
                  [](ObjectId id) { return number(id); });
  }
  return mono16(header, View<const TrackId>(step.ids),
                [](TrackId id) { return id == TrackId::none ? 0 : (number(id) - 1) % 65535 + 1; });
}

Image reject_of(const Header& header, const Frame& frame) {
  return mono16(header, View<const Reject>(frame.disparity.reject),
                [](Reject reject) { return static_cast<std::uint16_t>(reject); });
}

Detection3DArray detections_of(const Header& header, const TrackedFrame& step,
                               const std::optional<StereoRig>& rig) {
  Detection3DArray message;
  message.header = header;
  if (!rig) return message;
  for (const Object& object : step.frame.objects.list) {
    if (!object.position_in_camera_m) continue;
    const Vec3 at = *object.position_in_camera_m;
    Detection3D found;
    found.header = header;
    found.bbox.center.position = {double{at.x}, double{at.y}, double{at.z}};
    found.bbox.size = vector_of(object.extent_in_camera_m.value_or(Vec3{}));
    if (step.ids.empty()) {
      found.id = std::to_string(number(object.id));
    } else if (const TrackId track = track_of(step.tracks, object.id); track != TrackId::none) {
      found.id = std::to_string(number(track));
    }
    ObjectHypothesisWithPose result;
    result.hypothesis = {"object", double{object.confidence}};
    result.pose.pose = found.bbox.center;
    result.pose.covariance = covariance_of(object, at, *rig);
    found.results.push_back(std::move(result));
    message.detections.push_back(std::move(found));
  }
  return message;
}

Detection3DArray tracks_of(const Header& header, const TrackedFrame& step, const cairn::Pose& map_from_odom,
                           const std::string& prefix) {
  Detection3DArray message;
  message.header = header;
  for (const Track& track : step.tracks.list) {
    if (track.state != TrackState::confirmed || !track.has_place) continue;
    const Covariance3 covariance =
        rotated(map_from_odom, covariance_in_map(track, step.map_from_camera, step.pose_covariance));
    const auto width = double{track.extent_m.x};
    message.detections.push_back(
        detection_of(header, prefix + std::to_string(number(track.id)), map_from_odom(track.position_m),
                     covariance, {width, width, double{track.extent_m.y}}, double{track.confidence}));
  }
  return message;
}

PoseWithCovarianceStamped camera_pose_of(const Header& header, const TrackedFrame& step,
                                         const cairn::Pose& map_from_odom, const Covariance6& covariance) {
  const cairn::Pose pose = map_from_odom * step.map_from_camera;
  const Point3 at = pose.translation_m;
  return {header, {{{at.x, at.y, at.z}, quaternion_of(pose)}, covariance}};
}

Detection3DArray landmarks_of(const Header& header, const std::vector<Landmark>& landmarks) {
  Detection3DArray message;
  message.header = header;
  for (const Landmark& landmark : landmarks) {
    if (landmark.is_gone) continue;
    const double width = (landmark.size.narrowest_m + landmark.size.widest_m) / 2;
    message.detections.push_back(
        detection_of(header, std::to_string(number(landmark.id)), landmark.position_m, landmark.covariance_m2,
                     {width, width, landmark.size.height_m}, probability_of(landmark.log_odds)));
  }
  return message;
}

namespace {

constexpr std::uint32_t kPointStep = 24;

void add_point(PointCloud2& cloud, const Vec3& at_m, Rgb colour, ObjectId object, float confidence) {
  const std::size_t at = cloud.data.size();
  cloud.data.resize(at + kPointStep);
  std::uint8_t* const to = cloud.data.data() + at;
  store(to, at_m.x);
  store(to + 4, at_m.y);
  store(to + 8, at_m.z);
  store(to + 12, std::uint32_t{colour.r} << 16U | std::uint32_t{colour.g} << 8U | colour.b);
  store(to + 16, static_cast<std::uint32_t>(number(object)));
  store(to + 20, confidence);
  cloud.row_step = static_cast<std::uint32_t>(cloud.data.size());
  cloud.width = cloud.row_step / kPointStep;
}

}  // namespace

PointCloud2 cloud_of(const Header& header, const Frame& frame, ObstacleLabel space,
                     const std::optional<StereoRig>& rig, View<const Gray> left, View<const Rgb> left_rgb,
                     int stride) {
  PointCloud2 message;
  message.header = header;
  std::uint32_t offset = 0;
  for (const char* const name : {"x", "y", "z", "rgb", "object", "confidence"}) {
    const bool is_id = std::string_view(name) == "object";
    message.fields.push_back({name, offset, is_id ? PointField::kUint32 : PointField::kFloat32, 1});
    offset += 4;
  }
  message.height = 1;
  message.point_step = kPointStep;
  message.is_dense = true;
  const Size size = rig ? frame.space.size() : Size{};
  const cairn::Image<float> disparities_px = obstacle_disparities(frame);
  for (int y = 0; y < size.height; y += stride) {
    for (int x = 0; x < size.width; x += stride) {
      const float disparity_px = disparities_px(x, y);
      if (frame.space(x, y) != space || std::isnan(disparity_px)) continue;
      const auto point = rig->point_in_camera_m(static_cast<float>(x), static_cast<float>(y), disparity_px);
      if (!point) continue;
      const Gray grey = left(x, y);
      const Rgb colour = left_rgb.empty() ? Rgb{grey, grey, grey} : left_rgb(x, y);
      add_point(message, *point, colour, frame.objects.labels(x, y),
                frame.confidence.empty() ? 1.0F : frame.confidence(x, y));
    }
  }
  return message;
}

void add_steps(PointCloud2& cloud, const std::vector<GroundStep>& steps, const FloorFrame& floor) {
  constexpr float kApart_m = 0.02F;
  constexpr Rgb kRed{255, 0, 0};
  for (const GroundStep& step : steps) {
    const Vec3 way{step.to_m.x - step.from_m.x, step.to_m.y - step.from_m.y, step.to_m.z - step.from_m.z};
    const int pieces = static_cast<int>(std::ceil(std::hypot(way.x, way.y) / kApart_m));
    for (int piece = 0; piece <= pieces; ++piece) {
      const float share = static_cast<float>(piece) / static_cast<float>(std::max(pieces, 1));
      const Vec3 edge{step.from_m.x + share * way.x, step.from_m.y + share * way.y,
                      step.from_m.z + share * way.z + std::max(step.height_m, 0.0F)};
      add_point(cloud, floor.to_camera(edge), kRed, ObjectId::none, 1);
    }
  }
}

OccupancyGrid grid_of(const Header& header, ObstacleGrid grid) {
  OccupancyGrid message;
  message.header = header;
  message.info.map_load_time = header.stamp;
  message.info.resolution = grid.cell_size_m;
  message.info.width = static_cast<std::uint32_t>(grid.width);
  message.info.height = static_cast<std::uint32_t>(grid.height);
  message.info.origin.position = {double{grid.origin_x_m}, double{grid.origin_y_m}, 0};
  message.data = std::move(grid.cells);
  return message;
}

std::optional<OccupancyGrid> grid_of(const Header& header, const Frame& frame,
                                     const std::optional<StereoRig>& rig, const ObstaclesConfig& config) {
  const auto floor = floor_frame(frame.ground, rig);
  if (!floor || frame.space.empty()) return std::nullopt;
  return grid_of(header, map_obstacles(frame, *floor, *rig, config));
}

std::optional<TransformStamped> floor_transform_of(Stamp stamp, const FrameNames& names, const Ground& ground,
                                                   const std::optional<StereoRig>& rig) {
  const auto floor = floor_frame(ground, rig);
  if (!floor) return std::nullopt;
  const auto [fx, fy, fz] = floor->forward;
  const auto [lx, ly, lz] = floor->left;
  const auto [ux, uy, uz] = floor->up;
  cairn::Pose camera_from_floor;
  camera_from_floor.rotation = {double{fx}, double{lx}, double{ux}, double{fy}, double{ly},
                                double{uy}, double{fz}, double{lz}, double{uz}};
  return TransformStamped{header_of(stamp, names.camera),
                          names.floor,
                          {vector_of(floor->to_camera({})), quaternion_of(camera_from_floor)}};
}

std::optional<TransformStamped> camera_transform_of(const FrameNames& names, const TrackedFrame& step) {
  if (step.is_lost) return std::nullopt;
  const Point3 at = step.map_from_camera.translation_m;
  return TransformStamped{header_of(step.stamp, names.map),
                          names.camera,
                          {{at.x, at.y, at.z}, quaternion_of(step.map_from_camera)}};
}

TFMessage transforms_of(const FrameNames& names, const TrackedFrame& step,
                        const std::optional<StereoRig>& rig) {
  TFMessage message;
  if (auto transform = camera_transform_of(names, step)) message.transforms.push_back(std::move(*transform));
  if (auto transform = floor_transform_of(step.stamp, names, step.frame.ground, rig))
    message.transforms.push_back(std::move(*transform));
  return message;
}

}  // namespace cairn::ros
