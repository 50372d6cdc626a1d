// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/map_exports.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include <cairn/sequence/landmark_geometry.hpp>

namespace cairn {
namespace {

using landmarks::kPositionAndYaw;
using landmarks::Matrix3;
using landmarks::Matrix4;
using landmarks::Matrix6;
using landmarks::position_and_yaw;

[[gnu::format(printf, 1, 2)]] std::string line(const char* format, ...) {
  std::array<char, 512> text{};
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(text.data(), text.size(), format, values);
  va_end(values);
  return text.data();
}

double rounded(double metres) {
  return std::round(metres * 1e4) / 1e4;
}

std::string numbers_of(const Pose& pose) {
  const auto q = quaternion(pose);
  const Point3 t = pose.translation_m;
  return line("%.6f %.6f %.6f %.9f %.9f %.9f %.9f", t.x, t.y, t.z, q[0], q[1], q[2], q[3]);
}

/// The upper triangle of an information matrix.
template <int N>
std::string information_text(const Eigen::Matrix<double, N, N, Eigen::RowMajor>& information) {
  std::string text;
  for (int r = 0; r < N; ++r) {
    for (int c = r; c < N; ++c) text += line(" %.6g", information(r, c));
  }
  return text;
}

Matrix3 information_of(const Covariance3& covariance) {
  constexpr double kMin = 1e-8;  // 0.1 mm; an exact position would have no inverse
  return (landmarks::matrix(covariance) + kMin * Matrix3::Identity()).inverse();
}

/// Covariance of the motion between two poses of a run, along the map's axes: the second covariance minus the
/// first one propagated. Where a correction by landmarks between the two reduced it, the step gets the
/// covariances of both poses together.
Matrix6 covariance_of_step(const MapPose& before, const MapPose& now) {
  constexpr double kMin = 1e-6;       // 1 mm, 1 mrad
  constexpr double kRounding = 1e-3;  // of the larger one
  constexpr std::array<Eigen::Index, 2> kTilt{3, 4};
  const Matrix6 a = landmarks::matrix(before.covariance);
  const Matrix6 b = landmarks::matrix(now.covariance);
  const Matrix4 placed = position_and_yaw(now.covariance);
  const Matrix4 carried =
      landmarks::carried(position_and_yaw(before.covariance),
                         now.map_from_camera.translation_m - before.map_from_camera.translation_m);
  const Matrix4 grown = placed - carried;
  const double smallest =
      Eigen::SelfAdjointEigenSolver<Matrix4>(grown, Eigen::EigenvaluesOnly).eigenvalues()[0];
  const bool is_corrected = smallest < -kRounding * carried.trace() - kMin;
  Matrix6 step = Matrix6::Zero();
  step(kPositionAndYaw, kPositionAndYaw) = is_corrected ? Matrix4(placed + carried) : grown;
  step(kTilt, kTilt) = is_corrected ? Eigen::Matrix2d(b(kTilt, kTilt) + a(kTilt, kTilt))
                                    : Eigen::Matrix2d(b(kTilt, kTilt) - a(kTilt, kTilt));
  return landmarks::with_clamped_eigenvalues(step, kMin);
}

/// For EDGE_SE3:QUAT, whose error is (t, q): the deviation in the frame of the second camera, q being the
/// vector part of the quaternion, hence half the angle (g2o, types/slam3d/isometry3d_mappings.h,
/// toVectorMQT).
Matrix6 information_of_step(const MapPose& before, const MapPose& now) {
  const Pose camera_from_map = inverse(now.map_from_camera);
  const Eigen::Map<const Matrix3> turn(camera_from_map.rotation.data());
  Matrix6 to_error = Matrix6::Zero();
  to_error.topLeftCorner<3, 3>() = turn;
  to_error.bottomRightCorner<3, 3>() = turn / 2;
  return Matrix6(to_error * covariance_of_step(before, now) * to_error.transpose()).inverse();
}

}  // namespace

std::string as_geojson(const MapFile& file) {
  constexpr int kCorners = 12;
  using nlohmann::json;
  json features = json::array();
  for (const Landmark& l : file.load().list) {
    const double radius = (l.size.narrowest_m + l.size.widest_m) / 4;
    json ring = json::array();
    for (int i = 0; i <= kCorners; ++i) {
      const double angle = 2 * std::numbers::pi * (i % kCorners) / kCorners;
      ring.push_back({rounded(l.position_m.x + radius * std::cos(angle)),
                      rounded(l.position_m.y + radius * std::sin(angle))});
    }
    json properties{{"id", number(l.id)},
                    {"name", l.name},
                    {"state", l.is_gone ? "gone" : "present"},
                    {"centre", {rounded(l.position_m.x), rounded(l.position_m.y), rounded(l.position_m.z)}},
                    {"sigma",
                     {rounded(std::sqrt(l.covariance_m2[0])), rounded(std::sqrt(l.covariance_m2[4])),
                      rounded(std::sqrt(l.covariance_m2[8]))}},
                    {"width", rounded((l.size.narrowest_m + l.size.widest_m) / 2)},
                    {"height", rounded(l.size.height_m)},
                    {"probability", rounded(1 / (1 + std::exp(-l.log_odds)))},
                    {"seen", l.seen},
                    {"expected", l.expected}};
    features.push_back({{"type", "Feature"},
                        {"id", number(l.id)},
                        {"geometry", {{"type", "Polygon"}, {"coordinates", json::array({ring})}}},
                        {"properties", properties}});
  }
  std::map<std::int64_t, json> paths;
  for (const MapPose& pose : file.poses()) {
    auto [at, is_new] = paths.try_emplace(pose.run, json::array());
    at->second.push_back(
        {rounded(pose.map_from_camera.translation_m.x), rounded(pose.map_from_camera.translation_m.y)});
  }
  for (const auto& [run, path] : paths) {
    if (path.size() < 2) continue;
    features.push_back({{"type", "Feature"},
                        {"geometry", {{"type", "LineString"}, {"coordinates", path}}},
                        {"properties", {{"run", run}}}});
  }
  const json all{{"type", "FeatureCollection"},
                 {"frame_id", "map"},
                 {"units", "m"},
                 {"note", "coordinates are metres in the frame of the map, not WGS84"},
                 {"features", features}};
  return all.dump(1) + "\n";
}

std::string as_g2o(const MapFile& file) {
  constexpr std::int64_t kFirstLandmark = 1'000'000;
  std::string text = "PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\n";
  const std::vector<MapPose> poses = file.poses();
  std::map<std::pair<std::int64_t, std::int64_t>, std::size_t> at;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    at[{poses[i].run, poses[i].stamp.ns}] = i;
    text += line("VERTEX_SE3:QUAT %zu ", i) + numbers_of(poses[i].map_from_camera) + "\n";
  }
  if (!poses.empty()) text += "FIX 0\n";
  for (const Landmark& l : file.load().list) {
    text +=
        line("VERTEX_TRACKXYZ %lld %.6f %.6f %.6f\n", static_cast<long long>(kFirstLandmark + number(l.id)),
             l.position_m.x, l.position_m.y, l.position_m.z);
  }
  for (std::size_t i = 1; i < poses.size(); ++i) {
    if (poses[i].run != poses[i - 1].run) continue;
    text += line("EDGE_SE3:QUAT %zu %zu ", i - 1, i) +
            numbers_of(inverse(poses[i - 1].map_from_camera) * poses[i].map_from_camera) +
            information_text<6>(information_of_step(poses[i - 1], poses[i])) + "\n";
  }
  for (const MapObservation& one : file.observations()) {
    const auto pose = at.find({one.run, one.stamp.ns});
    if (pose == at.end()) continue;
    const Pose camera_from_map = inverse(poses[pose->second].map_from_camera);
    const Point3 p = camera_from_map(one.position_m);
    const Covariance3 c = rotated(camera_from_map, one.covariance_m2);
    text += line("EDGE_SE3_TRACKXYZ %zu %lld 0 %.6f %.6f %.6f", pose->second,
                 static_cast<long long>(kFirstLandmark + number(one.landmark)), p.x, p.y, p.z) +
            information_text<3>(information_of(c)) + "\n";
  }
  return text;
}

std::string as_tum(const MapFile& file, std::int64_t run) {
  const std::vector<MapPose> poses = file.poses();
  if (run == 0 && !poses.empty()) run = poses.back().run;
  std::string text = "# t x y z qx qy qz qw: the camera in the map, run " + std::to_string(run) + "\n";
  for (const MapPose& pose : poses) {
    if (pose.run == run) text += seconds_text(pose.stamp) + " " + numbers_of(pose.map_from_camera) + "\n";
  }
  return text;
}

std::string as_csv(const LandmarkMap& map) {
  std::string text =
      "id,name,state,x_m,y_m,z_m,sigma_x_m,sigma_y_m,sigma_z_m,narrowest_m,widest_m,height_m,"
      "probability,seen,expected\n";
  for (const Landmark& l : map.list) {
    std::string name = l.name;
    if (name.find_first_of(",\"\n") != std::string::npos) {
      std::string quoted = "\"";
      for (const char c : name) quoted += c == '"' ? "\"\"" : std::string(1, c);
      name = quoted + "\"";
    }
    text += std::to_string(number(l.id)) + "," + name + "," + (l.is_gone ? "gone" : "present") +
            line(",%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%d,%d\n", l.position_m.x, l.position_m.y,
                 l.position_m.z, std::sqrt(l.covariance_m2[0]), std::sqrt(l.covariance_m2[4]),
                 std::sqrt(l.covariance_m2[8]), l.size.narrowest_m, l.size.widest_m, l.size.height_m,
                 1 / (1 + std::exp(-l.log_odds)), l.seen, l.expected);
  }
  return text;
}

}  // namespace cairn
