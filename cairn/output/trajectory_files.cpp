// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/output/trajectory_files.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/io/read_file.hpp>
#include <cmath>
#include <cstdio>

#include <cairn/io/names_and_numbers.hpp>
#include <cairn/io/text_lines.hpp>
#include <cairn/sequence/stamps.hpp>

namespace cairn::output {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kStep_ns = 100'000'000;  // between poses without stamps

template <std::size_t n>
std::array<double, n> numbers(const std::vector<std::string_view>& fields, std::size_t first,
                              const fs::path& path, std::size_t line) {
  std::array<double, n> all{};
  for (std::size_t k = 0; k < n; ++k) {
    all[k] = io::number_in(fields[first + k], path, line);
    if (std::isnan(all[k]))
      throw Error(io::place(path, line) + ": found " + io::quoted(fields[first + k]) +
                  ", expected a finite number");
  }
  return all;
}

/// Lines of 3×4 numbers whose left part is a rotation within its precision.
Pose pose_of_rows(const std::array<double, 12>& m, const std::string& where) {
  const std::array<double, 9> r{m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]};
  const double determinant = r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) +
                             r[2] * (r[3] * r[7] - r[4] * r[6]);
  constexpr double kTolerance = 0.01;
  bool is_rotation = std::abs(determinant - 1) <= kTolerance;
  for (std::size_t row = 0; row < 3; ++row) {
    const double square =
        r[3 * row] * r[3 * row] + r[3 * row + 1] * r[3 * row + 1] + r[3 * row + 2] * r[3 * row + 2];
    is_rotation = is_rotation && std::abs(square - 1) <= kTolerance;
  }
  if (!is_rotation) throw Error(where + ": the left 3x3 numbers are not a rotation");
  const Pose rounded{r, {m[3], m[7], m[11]}};
  return pose_of(rounded.translation_m, quaternion(rounded));  // orthonormal beyond the precision of the file
}

Pose pose_of_quaternion(const std::array<double, 3>& t, const std::array<double, 4>& q,
                        const std::string& where) {
  const double square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  constexpr double kTolerance = 0.05;
  if (std::abs(square - 1) > kTolerance)
    throw Error(where + ": the quaternion's length is not 1; expected t x y z qx qy qz qw");
  return pose_of({t[0], t[1], t[2]}, q);
}

Stamp stamp_in(std::optional<Stamp> stamp, std::string_view text, const std::string& where) {
  if (!stamp) throw Error(where + ": found " + io::quoted(text) + ", expected a stamp");
  return *stamp;
}

TimedPose pose_in(const std::vector<std::string_view>& fields, TrajectoryForm form, const fs::path& path,
                  std::size_t line) {
  const std::string where = io::place(path, line);
  switch (form) {
    case TrajectoryForm::tum:
      return {
          stamp_in(parse_seconds(fields[0]), fields[0], where),
          pose_of_quaternion(numbers<3>(fields, 1, path, line), numbers<4>(fields, 4, path, line), where)};
    case TrajectoryForm::euroc: {
      const auto q = numbers<4>(fields, 4, path, line);
      return {stamp_in(parse_stamp(fields[0]), fields[0], where),
              pose_of_quaternion(numbers<3>(fields, 1, path, line), {q[1], q[2], q[3], q[0]}, where)};
    }
    case TrajectoryForm::kitti:
      break;
  }
  return {{}, pose_of_rows(numbers<12>(fields, 0, path, line), where)};
}

TrajectoryForm form_of(std::string_view line, const fs::path& path, std::size_t number) {
  constexpr std::size_t kTum = 8;
  constexpr std::size_t kKitti = 12;
  const std::size_t fields = io::fields_of(line).size();
  if (line.find(',') != std::string_view::npos) {
    if (fields >= kTum) return TrajectoryForm::euroc;
  } else if (fields == kTum) {
    return TrajectoryForm::tum;
  } else if (fields == kKitti) {
    return TrajectoryForm::kitti;
  }
  throw Error(io::place(path, number) + ": found " + std::to_string(fields) +
              " fields, expected 8 (TUM: t x y z qx qy qz qw), 12 (KITTI) or EuRoC's ns,x,y,z,qw,qx,qy,qz");
}

void check_order(const std::vector<TimedPose>& poses, const fs::path& path) {
  for (std::size_t k = 1; k < poses.size(); ++k) {
    if (poses[k].stamp <= poses[k - 1].stamp) {
      throw Error(path.string() + ": stamp " + stamp_text(poses[k].stamp) + " of pose " +
                  std::to_string(k + 1) + " is not later than " + stamp_text(poses[k - 1].stamp));
    }
  }
}

void number_stamps(std::vector<TimedPose>& poses) {
  for (std::size_t k = 0; k < poses.size(); ++k) poses[k].stamp = {static_cast<std::int64_t>(k) * kStep_ns};
}

bool take_stamps(std::vector<TimedPose>& poses, const std::vector<Stamp>& stamps) {
  if (stamps.size() != poses.size()) return false;
  for (std::size_t k = 0; k < poses.size(); ++k) poses[k].stamp = stamps[k];
  return true;
}

Trajectory load_folder(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code unknown;
  std::error_code reason;
  for (fs::directory_iterator it(folder, reason), end; !reason && it != end; it.increment(reason)) {
    if (fs::is_regular_file(it->path() / "pose.txt", unknown))
      names.push_back(it->path().filename().string());
  }
  if (reason) throw Error(folder.string() + ": cannot be listed: " + reason.message());
  std::sort(names.begin(), names.end(), io::in_natural_order);
  if (names.empty()) throw Error(folder.string() + ": no frame in this folder contains a pose.txt");
  Trajectory all;
  for (const std::string& name : names) all.poses.push_back({{}, load_pose(folder / name / "pose.txt")});
  fs::path from = folder / "stamps.txt";
  std::vector<Stamp> stamps;
  if (fs::is_regular_file(from, unknown)) {
    stamps = stamps_by_line(from, names);
  } else if (from = folder / "trajectory.csv"; fs::is_regular_file(from, unknown)) {
    if (const auto rows = load_frame_stamps(from)) stamps = stamps_by_frame(from, *rows, names);
  }
  all.has_stamps = !stamps.empty();
  if (all.has_stamps) {
    for (std::size_t k = 0; k < stamps.size(); ++k) all.poses[k].stamp = stamps[k];
    check_order(all.poses, from);
  } else {
    number_stamps(all.poses);
  }
  return all;
}

}  // namespace

Pose load_pose(const fs::path& path) {
  const std::string text = io::read_file(path, io::kMaxTextBytes);
  std::vector<double> values;
  for (const io::TextLine& line : io::lines_of(text)) {
    for (const std::string_view field : io::fields_of(line.text)) {
      values.push_back(io::number_in(field, path, line.number));
      if (std::isnan(values.back()))
        throw Error(io::place(path, line.number) + ": found " + io::quoted(field) +
                    ", expected a finite number");
    }
  }
  constexpr std::size_t kRows = 12;
  constexpr std::size_t kSquare = 16;
  if (values.size() != kRows && values.size() != kSquare) {
    throw Error(path.string() + ": found " + std::to_string(values.size()) +
                " numbers, expected the 16 or 12 of a camera-to-world matrix");
  }
  std::array<double, kRows> rows{};
  std::copy_n(values.begin(), kRows, rows.begin());
  return pose_of_rows(rows, path.string());
}

Trajectory load_trajectory(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return load_folder(path);
  constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
  const std::string text = io::read_file(path, kMaxBytes);
  Trajectory all;
  std::optional<TrajectoryForm> form;
  for (const io::TextLine& line : io::lines_of(text)) {
    const std::vector<std::string_view> fields = io::fields_of(line.text);
    if (!form) {
      form = form_of(line.text, path, line.number);
      // EuRoC's truth has a header of column names, which may lack the #.
      if (*form == TrajectoryForm::euroc && !parse_stamp(fields.front())) continue;
    } else if (form_of(line.text, path, line.number) != *form) {
      throw Error(io::place(path, line.number) + ": differs in form from the lines before");
    }
    all.poses.push_back(pose_in(fields, *form, path, line.number));
  }
  if (all.poses.empty()) throw Error(path.string() + ": contains no pose");
  if (*form != TrajectoryForm::kitti) {
    check_order(all.poses, path);
    return all;
  }
  const fs::path times = path.parent_path() / "times.txt";
  all.has_stamps = false;
  number_stamps(all.poses);
  if (fs::is_regular_file(times, ignored)) {
    std::vector<Stamp> stamps;
    const std::string times_text = io::read_file(times, kMaxBytes);
    for (const io::TextLine& line : io::lines_of(times_text))
      stamps.push_back(stamp_in(parse_seconds(line.text), line.text, io::place(times, line.number)));
    all.has_stamps = take_stamps(all.poses, stamps);
  }
  if (all.has_stamps) check_order(all.poses, times);
  return all;
}

std::string trajectory_text(const std::vector<TimedPose>& poses, TrajectoryForm form) {
  std::string all;
  for (const TimedPose& pose : poses) {
    const Pose& p = pose.map_from_camera;
    const Point3 t = p.translation_m;
    const std::array<double, 4> q = quaternion(p);
    std::vector<double> values;
    const char* separator = " ";
    switch (form) {
      case TrajectoryForm::tum:
        all += seconds_text(pose.stamp);
        values = {t.x, t.y, t.z, q[0], q[1], q[2], q[3]};
        break;
      case TrajectoryForm::euroc:
        all += std::to_string(pose.stamp.ns);
        values = {t.x, t.y, t.z, q[3], q[0], q[1], q[2]};
        separator = ",";
        break;
      case TrajectoryForm::kitti:
        for (std::size_t row = 0; row < 3; ++row) {
          values.insert(values.end(), p.rotation.begin() + static_cast<std::ptrdiff_t>(3 * row),
                        p.rotation.begin() + static_cast<std::ptrdiff_t>(3 * row + 3));
          values.push_back(row == 0 ? t.x : row == 1 ? t.y : t.z);
        }
        break;
    }
    bool first = form == TrajectoryForm::kitti;
    for (const double value : values) {
      if (!first) all += separator;
      first = false;
      all += io::text_of("%.9g", value);
    }
    all += '\n';
  }
  return all;
}

}  // namespace cairn::output
