// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/priors.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/io/read_file.hpp>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <system_error>
#include <vector>

#include <cairn/io/text_lines.hpp>
#include <cairn/output/trajectory_files.hpp>
#include <cairn/sequence/stamps.hpp>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kLongestGapNs = 200'000'000;
constexpr double kDegree = std::numbers::pi / 180;

// Assumed accuracy of wheels and trajectories: a share of the distance and of the rotation, plus a constant.
constexpr double kShareOfWay = 0.05;
constexpr double kWayM = 0.005;
constexpr double kShareOfTurn = 0.05;
constexpr double kTurnRad = 0.3 * kDegree;
/// For directions in which wheels do not move.
constexpr double kSidewaysM = 0.003;

// Implausible values for a robot, or for a car between two poses.
constexpr double kFastestWheels = 20;  // m/s
constexpr double kFastestPoses = 60;   // m/s
constexpr double kFastestTurn = 20;    // rad/s
constexpr double kFastestGyro = 35;    // 2000 degrees per second, above the range of most gyroscopes

using Vector3 = std::array<double, 3>;

Pose rotation_of(const Pose& pose) {
  return {pose.rotation, {}};
}

/// For independent axes: the camera's, or those rotated by `to_camera`.
Covariance6 covariance_of(const Vector3& sigma_m, const Vector3& sigma_rad, const Pose& to_camera) {
  const auto block = [&](const Vector3& sigma) {
    const Covariance3 squares{sigma[0] * sigma[0], 0, 0, 0, sigma[1] * sigma[1], 0, 0, 0,
                              sigma[2] * sigma[2]};
    return rotated(to_camera, squares);
  };
  const Covariance3 places = block(sigma_m);
  const Covariance3 turns = block(sigma_rad);
  Covariance6 covariance{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      covariance[6 * i + j] = places[3 * i + j];
      covariance[6 * (i + 3) + j + 3] = turns[3 * i + j];
    }
  }
  return covariance;
}

/// "100 rows at 5 Hz"
std::string rows_text(const std::vector<Stamp>& stamps) {
  const double length_s = seconds_between(stamps.front(), stamps.back());
  return std::to_string(stamps.size()) + " rows" +
         (length_s > 0 ? io::text_of(" at %.3g Hz", static_cast<double>(stamps.size() - 1) / length_s) : "");
}

void check_stamps(const fs::path& path, const std::vector<Stamp>& stamps,
                  const std::vector<std::string>& names) {
  if (stamps.size() < 2) {
    throw Error(path.string() + ": has " + std::to_string(stamps.size()) +
                (stamps.size() == 1 ? " row" : " rows") + " of numbers, expected more");
  }
  check_rising(stamps, names, path.string());
}

/// The 90th percentile of the magnitudes; less frequent outliers are left to between().
double common_largest(std::vector<double> sizes) {
  std::erase_if(sizes, [](double size) { return !std::isfinite(size); });
  if (sizes.empty()) return 0;
  std::sort(sizes.begin(), sizes.end());
  return sizes[(sizes.size() - 1) * 9 / 10];
}

void check_common(const fs::path& path, const std::vector<double>& sizes, double most, const char* what,
                  const char* unit, const char* hint) {
  const double found = common_largest(sizes);
  if (found <= most) return;
  throw Error(path.string() + ": found " + what + " of " + io::text_of("%.4g ", found) + unit +
              " and more in one row of ten, expected at most " + io::text_of("%g ", most) + unit + ": " +
              hint);
}

/// The index of the first stamp after `moment`.
std::size_t after(const std::vector<Stamp>& stamps, Stamp moment) {
  return static_cast<std::size_t>(std::upper_bound(stamps.begin(), stamps.end(), moment) - stamps.begin());
}

/// Calls visit(i, from, to) with the overlap of each interval (stamps[i − 1], stamps[i]] and (before, now].
/// False if the file does not cover that time, has a gap, or a call returns false.
template <class Visit>
bool walk(const std::vector<Stamp>& stamps, Stamp before, Stamp now, const Visit& visit) {
  if (!(before < now) || before < stamps.front() || now > stamps.back()) return false;
  for (std::size_t i = after(stamps, before); i < stamps.size() && stamps[i - 1] < now; ++i) {
    if (stamps[i].ns - stamps[i - 1].ns > kLongestGapNs) return false;
    if (!visit(i, std::max(stamps[i - 1], before), std::min(stamps[i], now))) return false;
  }
  return true;
}

// ---- wheel speeds ----

class Speeds : public MotionPriors {
 public:
  struct Rows {
    std::vector<Stamp> stamps;
    std::vector<double> ahead_m_s;
    std::vector<double> left_rad_s;
  };
  explicit Speeds(Rows rows) : rows_(std::move(rows)) {}

  [[nodiscard]] std::optional<MotionPrior> between(Stamp before, Stamp now,
                                                   const Pose& camera_from_level) const override {
    Pose before_from_now;  // of the level camera
    double way_m = 0;
    double turn_rad = 0;
    const bool is_known = walk(rows_.stamps, before, now, [&](std::size_t i, Stamp from, Stamp to) {
      const double speed = rows_.ahead_m_s[i];
      const double rate = rows_.left_rad_s[i];
      if (!(std::abs(speed) <= kFastestWheels && std::abs(rate) <= kFastestTurn)) return false;
      const double time_s = seconds_between(from, to);
      before_from_now = before_from_now * arc(speed * time_s, rate * time_s);
      way_m += std::abs(speed * time_s);
      turn_rad += std::abs(rate * time_s);
      return true;
    });
    if (!is_known) return std::nullopt;
    const Pose to_camera = rotation_of(camera_from_level);
    MotionPrior prior;
    prior.kind = PriorKind::wheels;
    prior.now_from_before = to_camera * inverse(before_from_now) * inverse(to_camera);
    prior.covariance = covariance_of({kSidewaysM, kSidewaysM, kShareOfWay * way_m + kWayM},
                                     {kTurnRad, kShareOfTurn * turn_rad + kTurnRad, kTurnRad}, to_camera);
    return prior;
  }
  [[nodiscard]] PriorKind kind() const override { return PriorKind::wheels; }
  [[nodiscard]] Stamp first() const override { return rows_.stamps.front(); }
  [[nodiscard]] Stamp last() const override { return rows_.stamps.back(); }
  [[nodiscard]] std::string description() const override {
    return "speeds of wheels, " + rows_text(rows_.stamps);
  }

 private:
  /// Motion along an arc: the new camera pose in the frame of the old one.
  static Pose arc(double way_m, double turn_rad) {
    constexpr double kStraightRad = 1e-6;
    Pose pose = rotation_about({0, -turn_rad, 0});  // up is -y
    const bool is_straight = std::abs(turn_rad) < kStraightRad;
    const double left = is_straight ? way_m * turn_rad / 2 : way_m * (1 - std::cos(turn_rad)) / turn_rad;
    const double ahead = is_straight ? way_m : way_m * std::sin(turn_rad) / turn_rad;
    pose.translation_m = {-left, 0, ahead};
    return pose;
  }

  Rows rows_;
};

Speeds::Rows speeds_of(const fs::path& path, const std::vector<io::TextLine>& lines) {
  const std::vector<std::string_view> header = io::fields_of(lines.front().text);
  const auto column = [&](std::string_view name) {
    const auto found = std::find(header.begin(), header.end(), name);
    if (found == header.end()) {
      throw Error(
          io::place(path, lines.front().number) + ": has no column " + std::string(name) +
          ", expected t_s, v_m_per_s, omega_rad_per_s; or TUM's lines of 8 numbers, or KITTI's of 12");
    }
    return static_cast<std::size_t>(found - header.begin());
  };
  const std::size_t time = column("t_s");
  const std::size_t ahead = column("v_m_per_s");
  const std::size_t left = column("omega_rad_per_s");
  Speeds::Rows rows;
  std::vector<std::string> names;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string_view> fields = io::fields_of(lines[i].text);
    if (fields.size() < header.size()) {
      throw Error(io::place(path, lines[i].number) + ": has " + std::to_string(fields.size()) +
                  " fields, expected " + std::to_string(header.size()));
    }
    const std::optional<Stamp> stamp = parse_seconds(fields[time]);
    if (!stamp)
      throw Error(io::place(path, lines[i].number) + ": found " + io::quoted(fields[time]) + ", expected s");
    rows.stamps.push_back(*stamp);
    rows.ahead_m_s.push_back(io::number_in(fields[ahead], path, lines[i].number));
    rows.left_rad_s.push_back(io::number_in(fields[left], path, lines[i].number));
    names.push_back("of line " + std::to_string(lines[i].number));
  }
  check_stamps(path, rows.stamps, names);
  const auto sizes = [](std::vector<double> values) {
    for (double& value : values) value = std::abs(value);
    return values;
  };
  check_common(path, sizes(rows.ahead_m_s), kFastestWheels, "speeds", "m/s", "are they mm/s?");
  check_common(path, sizes(rows.left_rad_s), kFastestTurn, "turn rates", "rad/s",
               "are they degrees per second?");
  return rows;
}

// ---- poses ----

class PoseTrack : public MotionPriors {
 public:
  explicit PoseTrack(PoseRows rows) : rows_(std::move(rows)) {}

  [[nodiscard]] std::optional<MotionPrior> between(Stamp before, Stamp now,
                                                   const Pose& camera_from_level) const override {
    const std::optional<Pose> then = at(before);
    const std::optional<Pose> here = at(now);
    double way_m = 0;
    double turn_rad = 0;
    const bool is_known = walk(rows_.stamps, before, now, [&](std::size_t i, Stamp from, Stamp to) {
      const double step_s = seconds_between(rows_.stamps[i - 1], rows_.stamps[i]);
      const double share = seconds_between(from, to) / step_s;
      const Pose step = inverse(rows_.world_from_camera[i - 1]) * rows_.world_from_camera[i];
      if (length(step.translation_m) > kFastestPoses * step_s || angle_of(step) > kFastestTurn * step_s)
        return false;
      way_m += share * length(step.translation_m);
      turn_rad += share * angle_of(step);
      return true;
    });
    if (!is_known || !then || !here) return std::nullopt;
    MotionPrior prior;
    prior.kind = PriorKind::wheels;
    prior.now_from_before = inverse(*here) * *then;
    const Pose to_camera = rotation_of(camera_from_level);
    if (rows_.is_of_robot) prior.now_from_before = to_camera * prior.now_from_before * inverse(to_camera);
    const double sigma_m = kShareOfWay * way_m + kWayM;
    const double sigma_rad = kShareOfTurn * turn_rad + kTurnRad;
    prior.covariance = covariance_of({sigma_m, sigma_m, sigma_m}, {sigma_rad, sigma_rad, sigma_rad}, Pose{});
    return prior;
  }
  [[nodiscard]] PriorKind kind() const override { return PriorKind::wheels; }
  [[nodiscard]] Stamp first() const override { return rows_.stamps.front(); }
  [[nodiscard]] Stamp last() const override { return rows_.stamps.back(); }
  [[nodiscard]] std::string description() const override {
    return std::string("poses of the ") + (rows_.is_of_robot ? "robot, " : "camera, ") +
           rows_text(rows_.stamps);
  }

 private:
  /// Interpolates between the neighbouring poses: linearly, and by rotation about one axis.
  [[nodiscard]] std::optional<Pose> at(Stamp moment) const {
    if (moment < first() || moment > last()) return std::nullopt;
    const std::size_t i = std::clamp<std::size_t>(after(rows_.stamps, moment), 1, rows_.stamps.size() - 1);
    const Pose& a = rows_.world_from_camera[i - 1];
    const Pose& b = rows_.world_from_camera[i];
    const double share =
        seconds_between(rows_.stamps[i - 1], moment) / seconds_between(rows_.stamps[i - 1], rows_.stamps[i]);
    const Point3 turn = share * rotation_vector(inverse(rotation_of(a)) * rotation_of(b));
    Pose pose = rotation_of(a) * rotation_about(turn);
    pose.translation_m = a.translation_m + share * (b.translation_m - a.translation_m);
    return pose;
  }

  PoseRows rows_;
};

/// Converts a robot's axes (x forward, y left, z up) to the level camera's (x right, y down, z forward).
constexpr Pose kLevelFromRobot{{0, -1, 0, 0, 0, -1, 1, 0, 0}, {}};

/// Stamps for lines without one.
std::vector<Stamp> stamps_beside(const fs::path& path, const fs::path& source_folder, std::size_t lines) {
  std::string tried;
  for (const fs::path& folder : {path.parent_path(), source_folder}) {
    for (const char* name : {"times.txt", "stamps.txt"}) {
      const fs::path file = folder.empty() ? fs::path(name) : folder / name;
      std::error_code unknown;
      if (!fs::is_regular_file(file, unknown)) continue;
      std::vector<Stamp> stamps = load_stamps(file);
      if (stamps.size() == lines) return stamps;
      tried = "; " + file.string() + " has " + std::to_string(stamps.size());
    }
  }
  throw Error(path.string() + ": its lines have no stamps, expected times.txt or stamps.txt with " +
              std::to_string(lines) + " of them next to it or in the folder of the source" + tried);
}

bool says_robot(const fs::path& path, std::string_view text) {
  const std::string name = path.filename().string();
  for (const std::string_view word : {"base_link", "base_footprint"}) {
    if (name.find(word) != std::string::npos) return true;
    for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
      const std::size_t line = text.rfind('\n', at);
      const std::size_t begin = text.find_first_not_of(" \t", line == std::string_view::npos ? 0 : line + 1);
      if (text[begin] == '#') return true;
    }
  }
  return false;
}

void check_speeds(const fs::path& path, const PoseRows& rows) {
  std::vector<double> speeds;
  for (std::size_t i = 1; i < rows.stamps.size(); ++i) {
    const Point3 way = rows.world_from_camera[i].translation_m - rows.world_from_camera[i - 1].translation_m;
    speeds.push_back(length(way) / seconds_between(rows.stamps[i - 1], rows.stamps[i]));
  }
  check_common(path, speeds, kFastestPoses, "speeds", "m/s", "are the positions in mm?");
}

PoseRows poses_of(const fs::path& path, std::string_view text, const fs::path& source_folder) {
  const output::Trajectory file = output::load_trajectory(path);
  PoseRows rows;
  rows.is_of_robot = says_robot(path, text);
  std::vector<std::string> names;
  for (const TimedPose& pose : file.poses) {
    rows.stamps.push_back(pose.stamp);
    rows.world_from_camera.push_back(rows.is_of_robot ? level_camera_of(pose.map_from_camera)
                                                      : pose.map_from_camera);
    names.push_back(std::to_string(names.size()));
  }
  if (!file.has_stamps) rows.stamps = stamps_beside(path, source_folder, file.poses.size());
  check_stamps(path, rows.stamps, names);
  check_speeds(path, rows);
  return rows;
}

// ---- gyroscopes ----

class Gyroscope : public MotionPriors {
 public:
  Gyroscope(GyroscopeRows rows, const std::optional<Vector3>& bias, const Pose& camera_from_imu)
      : rows_(std::move(rows)), bias_(bias), camera_from_imu_(rotation_of(camera_from_imu)) {}

  [[nodiscard]] std::optional<MotionPrior> between(Stamp before, Stamp now,
                                                   const Pose& /*camera_from_level*/) const override {
    Pose before_from_now;
    const bool is_known = walk(rows_.stamps, before, now, [&](std::size_t i, Stamp from, Stamp to) {
      const double step_s = seconds_between(rows_.stamps[i - 1], rows_.stamps[i]);
      const double time_s = seconds_between(from, to);
      const double middle = (seconds_between(rows_.stamps[i - 1], from) + time_s / 2) / step_s;
      const Vector3 bias = bias_.value_or(Vector3{});
      Vector3 turn{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double a = rows_.rates_rad_s[i - 1][axis];
        const double b = rows_.rates_rad_s[i][axis];
        if (!(std::abs(a) <= kFastestGyro && std::abs(b) <= kFastestGyro)) return false;
        turn[axis] = (a + middle * (b - a) - bias[axis]) * time_s;
      }
      before_from_now = before_from_now * rotation_about({turn[0], turn[1], turn[2]});
      return true;
    });
    if (!is_known) return std::nullopt;
    const double time_s = seconds_between(before, now);
    constexpr double kNoiseRad = 0.05 * kDegree;
    constexpr double kKnownBias = 0.005;    // rad/s, error of a bias that was subtracted
    constexpr double kUnknownBias = 0.1;    // rad/s; EuRoC's is 0.08 about one axis
    constexpr double kNothingKnownM = 1e3;  // a gyroscope does not measure translation
    const double sigma_rad = kNoiseRad + (bias_ ? kKnownBias : kUnknownBias) * time_s;
    MotionPrior prior;
    prior.kind = PriorKind::gyroscope;
    prior.now_from_before =
        rotation_of(camera_from_imu_ * inverse(before_from_now) * inverse(camera_from_imu_));
    prior.covariance = covariance_of({kNothingKnownM, kNothingKnownM, kNothingKnownM},
                                     {sigma_rad, sigma_rad, sigma_rad}, Pose{});
    return prior;
  }
  [[nodiscard]] PriorKind kind() const override { return PriorKind::gyroscope; }
  [[nodiscard]] Stamp first() const override { return rows_.stamps.front(); }
  [[nodiscard]] Stamp last() const override { return rows_.stamps.back(); }
  [[nodiscard]] std::string description() const override {
    return "a gyroscope, " + rows_text(rows_.stamps) +
           (bias_ ? ", bias from the rest at the beginning" : ", bias unknown");
  }

 private:
  GyroscopeRows rows_;
  std::optional<Vector3> bias_;
  Pose camera_from_imu_;
};

/// The rotation in T_BS of an EuRoC sensor.yaml: from the sensor to the body.
Pose body_from_sensor(const fs::path& path) {
  const std::string text = io::read_file(path, io::kMaxTextBytes);
  const std::size_t pose = text.find("T_BS");
  const std::size_t open = pose == std::string::npos ? pose : text.find('[', pose);
  const std::size_t close = open == std::string::npos ? open : text.find(']', open);
  if (close == std::string::npos)
    throw Error(path.string() + ": has no T_BS with its data, expected a 4x4 matrix");
  std::string list = text.substr(open + 1, close - open - 1);
  std::replace(list.begin(), list.end(), '\n', ' ');
  const std::vector<std::string_view> fields = io::fields_of(list);
  if (fields.size() != 16)
    throw Error(path.string() + ": T_BS has " + std::to_string(fields.size()) + " numbers, expected 16");
  std::array<double, 16> n{};
  for (std::size_t i = 0; i < n.size(); ++i) {
    n[i] = io::number_in(fields[i], path, 1);
    if (!std::isfinite(n[i]))
      throw Error(path.string() + ": T_BS has " + io::quoted(fields[i]) + ", expected a number");
  }
  return {{n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10]}, {}};
}

void check_rates(const fs::path& path, const GyroscopeRows& rows) {
  std::vector<double> sizes;
  for (const auto& [x, y, z] : rows.rates_rad_s) sizes.push_back(std::sqrt(x * x + y * y + z * z));
  check_common(path, sizes, kFastestGyro, "turn rates", "rad/s", "are they degrees per second?");
}

std::vector<std::string> numbers_of(std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.push_back(std::to_string(i));
  return names;
}

}  // namespace

Pose camera_from_level(double pitch_deg, double roll_deg) {
  // Pitch about the camera's x, then roll about its optical axis: level directions appear rotated the other
  // way.
  const Pose level_from_camera =
      rotation_about({-pitch_deg * kDegree, 0, 0}) * rotation_about({0, 0, roll_deg * kDegree});
  return inverse(level_from_camera);
}

std::unique_ptr<MotionPriors> load_odometry(const fs::path& path, const fs::path& source_folder) {
  const std::string text = io::read_file(path, io::kMaxLogBytes);
  const std::vector<io::TextLine> lines = io::lines_of(text);
  if (lines.empty()) throw Error(path.string() + ": contains no lines of numbers, expected odometry");
  const std::vector<std::string_view> fields = io::fields_of(lines.front().text);
  const bool is_table = std::any_of(fields.begin(), fields.end(), [](std::string_view field) {
    const std::size_t letter = field.find_first_of("abcdfghijklmnopqrstuvwxyz_");
    return letter != std::string_view::npos && field != "nan" && field != "inf" && field != "-nan";
  });
  if (is_table) return std::make_unique<Speeds>(speeds_of(path, lines));
  if (fields.size() == 8 || fields.size() == 12) {
    return priors_of(poses_of(path, text, source_folder));
  }
  throw Error(io::place(path, lines.front().number) + ": has " + std::to_string(fields.size()) +
              " numbers, expected a table with t_s, v_m_per_s, omega_rad_per_s, TUM's lines of 8 numbers, or "
              "KITTI's of 12");
}

std::optional<std::array<double, 3>> bias_at_rest(const GyroscopeRows& rows) {
  constexpr double kRestS = 0.5;
  constexpr std::size_t kMin = 20;
  constexpr double kSteadyRate = 0.05;         // rad/s, standard deviation
  constexpr double kLargestBias = 0.15;        // rad/s
  constexpr double kSteadyAcceleration = 0.7;  // m/s^2, standard deviation
  std::size_t count = 0;
  while (count < rows.stamps.size() && seconds_between(rows.stamps.front(), rows.stamps[count]) < kRestS)
    ++count;
  if (count < kMin) return std::nullopt;
  const auto is_steady = [&](const std::vector<Vector3>& values, double most, Vector3& mean) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      double sum = 0;
      double squares = 0;
      for (std::size_t i = 0; i < count; ++i) sum += values[i][axis];
      mean[axis] = sum / static_cast<double>(count);
      for (std::size_t i = 0; i < count; ++i) squares += std::pow(values[i][axis] - mean[axis], 2);
      if (!(std::sqrt(squares / static_cast<double>(count)) <= most)) return false;
    }
    return true;
  };
  Vector3 bias{};
  Vector3 unused{};
  if (!is_steady(rows.rates_rad_s, kSteadyRate, bias)) return std::nullopt;
  if (!rows.accelerations_m_s2.empty() && !is_steady(rows.accelerations_m_s2, kSteadyAcceleration, unused))
    return std::nullopt;
  if (std::any_of(bias.begin(), bias.end(), [](double b) { return std::abs(b) > kLargestBias; }))
    return std::nullopt;
  return bias;
}

Pose level_camera_of(const Pose& world_from_robot) {
  return world_from_robot * inverse(kLevelFromRobot);
}

std::unique_ptr<MotionPriors> priors_of(PoseRows rows) {
  return std::make_unique<PoseTrack>(std::move(rows));
}

std::unique_ptr<MotionPriors> priors_of(GyroscopeRows rows, const std::optional<Vector3>& bias,
                                        const Pose& camera_from_imu) {
  return std::make_unique<Gyroscope>(std::move(rows), bias, camera_from_imu);
}

void check_rows(const PoseRows& rows, const std::string& source) {
  check_stamps(source, rows.stamps, numbers_of(rows.stamps.size()));
  check_speeds(source, rows);
}

void check_rows(const GyroscopeRows& rows, const std::string& source) {
  check_stamps(source, rows.stamps, numbers_of(rows.stamps.size()));
  check_rates(source, rows);
}

std::unique_ptr<MotionPriors> load_imu(const fs::path& path, const Pose& camera_from_imu) {
  const std::string text = io::read_file(path, io::kMaxLogBytes);
  GyroscopeRows rows;
  std::vector<std::string> names;
  for (const io::TextLine& line : io::lines_of(text)) {
    const std::vector<std::string_view> fields = io::fields_of(line.text);
    if (fields.size() < 4) {
      throw Error(io::place(path, line.number) + ": has " + std::to_string(fields.size()) +
                  " fields, expected a stamp in ns and rates in rad/s about x, y and z");
    }
    const std::optional<Stamp> stamp = parse_stamp(fields.front());
    const bool is_whole = fields.front().find_first_not_of("-0123456789") == std::string_view::npos;
    if (!stamp || !is_whole) {
      throw Error(io::place(path, line.number) + ": found " + io::quoted(fields.front()) +
                  ", expected a stamp in whole ns" + (stamp ? "; these are s" : ""));
    }
    const auto three_from = [&](std::size_t first) {
      return Vector3{io::number_in(fields[first], path, line.number),
                     io::number_in(fields[first + 1], path, line.number),
                     io::number_in(fields[first + 2], path, line.number)};
    };
    rows.stamps.push_back(*stamp);
    rows.rates_rad_s.push_back(three_from(1));
    if (fields.size() >= 7) rows.accelerations_m_s2.push_back(three_from(4));
    names.push_back("of line " + std::to_string(line.number));
  }
  if (rows.accelerations_m_s2.size() != rows.rates_rad_s.size()) rows.accelerations_m_s2.clear();
  check_stamps(path, rows.stamps, names);
  check_rates(path, rows);
  const auto bias = bias_at_rest(rows);
  return priors_of(std::move(rows), bias, camera_from_imu);
}

std::optional<Pose> mounting_of_imu(const fs::path& path, const io::Rectifier* rectifier) {
  const fs::path folder = path.parent_path();
  const fs::path imu = folder / "sensor.yaml";
  const fs::path camera = folder / ".." / "cam0" / "sensor.yaml";
  std::error_code unknown;
  if (!fs::is_regular_file(imu, unknown) || !fs::is_regular_file(camera, unknown)) return std::nullopt;
  const Pose camera_from_imu = inverse(body_from_sensor(camera)) * body_from_sensor(imu);
  const Pose rectified_from_camera{rectifier != nullptr ? rectifier->left_rotation() : Pose{}.rotation, {}};
  return rectified_from_camera * camera_from_imu;
}

}  // namespace cairn::input
