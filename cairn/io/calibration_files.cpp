// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/core/nearest.hpp>
#include <cairn/core/number_text.hpp>
#include <cairn/image/binning.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/calibration_forms.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/io/read_file.hpp>
#include <cairn/pipeline/config.hpp>
#include <cctype>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;

/// A rectified calibration has fx = fy; smaller relative differences are rounding.
constexpr double kRounding = 1e-3;
/// Published calibrations of rectified images have fx and fy up to a few tenths of a percent apart. Only heights
/// suffer: distances use fx.
constexpr double kSameFocal = 1e-2;

/// `tolerance`: relative; between the two cameras only rounding, since disparities would suffer.
void check_same_focal(double a, const char* name_a, double b, const char* name_b,
                      double tolerance = kRounding) {
  if (std::abs(a - b) <= tolerance * std::abs(a)) return;
  throw Error(std::string(name_a) + " is " + shortest_text(a) + ", " + name_b + " is " + shortest_text(b) +
              "; a rectified pair has one focal length");
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(trimmed(text.substr(0, end)));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// key → value of each line `key<mark>value`; comments and empty lines are ignored.
std::map<std::string, std::string_view, std::less<>> pairs_of(std::string_view text, char mark) {
  std::map<std::string, std::string_view, std::less<>> pairs;
  int number = 0;
  for (std::string_view line : lines_of(text)) {
    ++number;
    line = trimmed(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    const std::size_t at = line.find(mark);
    if (at == std::string_view::npos) {
      throw Error("line " + std::to_string(number) + " is " + excerpt(line) + ", expected key" + mark +
                  "value");
    }
    const std::string key(trimmed(line.substr(0, at)));
    if (!pairs.emplace(key, trimmed(line.substr(at + 1))).second)
      throw Error("has " + excerpt(key) + " twice");
  }
  return pairs;
}

using Pairs = std::map<std::string, std::string_view, std::less<>>;

std::optional<double> number_in(const Pairs& pairs, std::string_view key) {
  const auto found = pairs.find(key);
  if (found == pairs.end()) return std::nullopt;
  return finite_number(found->second, key);
}

void read_size(const Pairs& pairs, Statement& says) {
  says.width = number_in(pairs, "width");
  says.height = number_in(pairs, "height");
  says.ndisp = number_in(pairs, "ndisp");
}

void read_mounting(const Pairs& pairs, Statement& says) {
  for (const auto& [key, member] : kMountingKeys) says.*member = number_in(pairs, key);
  if (const auto points = pairs.find(kGroundPointsKey); points != pairs.end())
    says.ground_points = finite_numbers(points->second, kGroundPointsKey);
}

/// [f 0 cx; 0 f cy; 0 0 1]
std::array<double, 9> camera_matrix(const Pairs& pairs, std::string_view key) {
  const std::string_view text = pairs.find(key)->second;
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') {
    throw Error(std::string(key) + " is " + excerpt(text) + ", expected [f 0 cx; 0 f cy; 0 0 1]");
  }
  const std::vector<double> numbers = finite_numbers(text.substr(1, text.size() - 2), key);
  std::array<double, 9> matrix{};
  if (numbers.size() != matrix.size()) {
    throw Error(std::string(key) + " has " + std::to_string(numbers.size()) + " numbers, expected 9");
  }
  std::copy(numbers.begin(), numbers.end(), matrix.begin());
  return matrix;
}

/// Whether a line starts with a KITTI projection matrix: "P2: 7.2e+02 …" or "P_rect_02: …".
bool has_kitti_projection(std::string_view text) {
  const auto lines = lines_of(text);
  return std::any_of(lines.begin(), lines.end(), [](std::string_view line) {
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) return false;
    const std::string_view key = line.substr(0, colon);
    const bool named = (key.starts_with("P_rect_0") && key.size() == 9) || (key.size() == 2 && key[0] == 'P');
    const std::string_view value = trimmed(line.substr(colon + 1));
    return named && key.back() >= '0' && key.back() <= '3' && !value.empty() &&
           (std::isdigit(static_cast<unsigned char>(value[0])) != 0 || value[0] == '-' || value[0] == '.');
  });
}

bool has_line(std::string_view text, const std::function<bool(std::string_view)>& is) {
  const auto lines = lines_of(text);
  return std::any_of(lines.begin(), lines.end(), is);
}

bool is_camera_zero(std::string_view line) {
  return line.starts_with("cam0") && trimmed(line.substr(4)).starts_with('=');
}

/// key=value, not a YAML line with a comment or text that contains '='.
bool is_assignment(std::string_view line) {
  line = trimmed(line.substr(0, line.find('#')));
  const std::string_view key = trimmed(line.substr(0, line.find('=')));
  return key.size() < line.size() && !key.empty() && key.find_first_of(" \t:{[\"'") == std::string_view::npos;
}

Statement read_statement(std::string_view text, const fs::path& path, bool grey_cameras) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // byte order mark
  if (trimmed(text).empty()) throw Error("is empty, expected a calibration");
  if (text.find('\0') != std::string_view::npos) throw Error("is not text, expected a calibration");
  if (trimmed(text).starts_with('<')) return read_opencv_xml(text);
  if (const auto program = known_but_unread(text)) throw Error(*program);
  if (has_line(text, is_camera_zero)) return read_middlebury(text);
  if (has_kitti_projection(text)) return read_kitti(text, grey_cameras);
  if (has_line(text, is_assignment)) return read_key_value_lines(text);
  if (std::optional<Statement> says = read_camera_matrix_and_baseline(text)) return *says;
  if (std::optional<Statement> says = read_yaml(text, path)) return *says;
  throw Error("is not a calibration in a known form (docs/formats.md lists them); it begins with " +
              excerpt(lines_of(trimmed(text)).front()));
}

/// An integer in 1 … most.
int counted(double value, const char* key, int most) {
  if (!(value >= 1 && value <= most) || value != std::floor(value)) {
    throw Error(std::string(key) + " is " + shortest_text(value) + ", expected a whole number in 1 ... " +
                std::to_string(most));
  }
  return static_cast<int>(value);
}

void check_positive(const std::optional<double>& value, const char* name) {
  if (value && !(*value > 0)) {
    throw ImpossibleCalibration(
        std::string(name) + " is " + shortest_text(*value) + ", expected a positive number", *value);
  }
}

float center(const std::optional<double>& value, const char* name) {
  if (value) return static_cast<float>(*value);
  throw Error(std::string("has a focal length and a baseline but no ") + name +
              ", expected all of them or no metres");
}

KnownGround mounting(const Statement& says) {
  KnownGround known;
  if (says.camera_height) known.camera_height_m = static_cast<float>(*says.camera_height);
  known.camera_pitch_deg = static_cast<float>(says.camera_pitch.value_or(0));
  known.camera_roll_deg = static_cast<float>(says.camera_roll.value_or(0));
  const std::vector<double>& p = says.ground_points;
  if (p.size() % 4 != 0) {
    throw Error(std::string(kGroundPointsKey) + " has " + std::to_string(p.size()) +
                " numbers, expected x_left,y_left,x_right,y_right of each point");
  }
  for (std::size_t i = 0; i < p.size(); i += 4) {
    known.points.push_back({static_cast<float>(p[i]), static_cast<float>(p[i + 1]),
                            static_cast<float>(p[i + 2]), static_cast<float>(p[i + 3])});
  }
  validate(known);
  return known;
}

std::string listed(const std::vector<std::string>& keys) {
  std::string text;
  for (const std::string& key : keys) text += (text.empty() ? "" : ", ") + excerpt(key);
  return text;
}

std::vector<std::string> remarks_on(const Statement& says) {
  std::vector<std::string> remarks;
  if (!says.unknown_keys.empty())
    remarks.push_back("ignores the unknown " + std::string(says.unknown_keys.size() == 1 ? "key " : "keys ") +
                      listed(says.unknown_keys));
  if (says.fx && says.fy && std::abs(*says.fx - *says.fy) > kRounding * *says.fx) {
    std::array<char, 32> percent{};
    std::snprintf(percent.data(), percent.size(), "%.2f %%", 100 * std::abs(*says.fy / *says.fx - 1));
    remarks.push_back("fx is " + shortest_text(*says.fx) + ", fy is " + shortest_text(*says.fy) +
                      ": heights are off by " + percent.data() + ", distances and widths are not");
  }
  return remarks;
}

/// Without metres because of keys of another program, such as f and bf.
void refuse_keys_instead_of_metres(const Statement& says) {
  if (says.unknown_keys.empty() || ((says.fx || says.fy) && says.baseline_m)) return;
  throw Error(std::string("has no ") + (says.fx || says.fy ? "baseline" : "fx") + ", but the unknown " +
              (says.unknown_keys.size() == 1 ? "key " : "keys ") + listed(says.unknown_keys) +
              ", expected fx fy cx cy (px) and baseline (m)");
}

Calibration judged(const Statement& says) {
  refuse_keys_instead_of_metres(says);
  check_positive(says.fx, "the focal length (fx)");
  check_positive(says.fy, "the focal length (fy)");
  check_positive(says.baseline_m, "the baseline in metres");
  if (says.fx && says.fy) check_same_focal(*says.fx, "fx", *says.fy, "fy", kSameFocal);
  Calibration calibration;
  const std::optional<double> focal = says.fx ? says.fx : says.fy;
  if (focal && says.baseline_m) {
    calibration.rig =
        StereoRig{static_cast<float>(*focal), center(says.cx, "cx"), center(says.cy, "cy"),
                  static_cast<float>(*says.baseline_m), static_cast<float>(says.doffs.value_or(0.0))};
  } else if (focal && says.cx && says.cy) {
    calibration.one_camera =
        StereoRig{static_cast<float>(*focal), static_cast<float>(*says.cx), static_cast<float>(*says.cy)};
  }
  if (says.width && says.height) {
    calibration.image_size = Size{counted(*says.width, "width", kMaxPixelsPerSide),
                                  counted(*says.height, "height", kMaxPixelsPerSide)};
  }
  if (says.ndisp) calibration.num_disparities = counted(*says.ndisp, "ndisp", kMaxPixelsPerSide);
  calibration.of_raw_cameras = says.has_distortion;
  calibration.remarks = remarks_on(says);
  calibration.ground = mounting(says);
  return calibration;
}

/// The calibration file in a folder given to --calib; it must be unambiguous.
fs::path file_in(const fs::path& folder) {
  std::vector<fs::path> pairs;
  std::error_code reason;
  for (fs::directory_iterator it(folder, reason), end; !reason && it != end; it.increment(reason)) {
    const fs::path& path = it->path();
    const bool yaml = path.extension() == ".yaml" || path.extension() == ".yml";
    const std::optional<fs::path> other = other_camera(path);
    if (yaml && !is_hidden(path) && right_named_like(path) && other && fs::is_regular_file(*other)) {
      pairs.push_back(path);
    }
  }
  if (pairs.size() == 1) return pairs.front();
  const std::optional<fs::path> one = calibration_in(folder);
  if (one && (pairs.empty() || one->filename() != "left.yaml")) return *one;
  throw Error(folder.string() + ": is a folder with " + std::to_string(pairs.size()) +
              " pairs of left/right YAML files and no calib.txt, expected one calibration");
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\n\v\f";
  const std::size_t begin = std::min(text.find_first_not_of(kBlank), text.size());
  text.remove_prefix(begin);
  return text.substr(0, text.find_last_not_of(kBlank) + 1);
}

std::string excerpt(std::string_view text) {
  std::string line(text.substr(0, 60));
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  }
  return "'" + line + (text.size() > 60 ? "...'" : "'");
}

double finite_number(std::string_view text, std::string_view key) {
  const std::string_view word = trimmed(text);
  const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value)) {
    throw Error(std::string(key) + " is " + excerpt(word) + ", expected a finite number");
  }
  return value;
}

std::vector<double> finite_numbers(std::string_view text, std::string_view key) {
  constexpr std::string_view kBetween = " \t\r\n,;";
  std::vector<double> numbers;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kBetween), text.size()));
    if (text.empty()) return numbers;
    const std::size_t end = std::min(text.find_first_of(kBetween), text.size());
    numbers.push_back(finite_number(text.substr(0, end), key));
    text.remove_prefix(end);
  }
}

Projection projection_of(const std::vector<double>& numbers, std::string_view key) {
  Projection matrix{};
  if (numbers.size() != matrix.size()) {
    throw Error(std::string(key) + " has " + std::to_string(numbers.size()) + " numbers, expected 12 (3x4)");
  }
  std::copy(numbers.begin(), numbers.end(), matrix.begin());
  return matrix;
}

Statement from_projections(const Projection& left, const Projection& right) {
  Statement says{left[0], left[5], left[2], left[6], {}, right[2] - left[2], {}, {}, {}};
  check_positive(says.fx, "the focal length (fx)");
  check_same_focal(left[0], "the left focal length", right[0], "the right one");
  // x_left = (f X + l3) / Z + cx and x_right = (f X + r3) / Z + cx', so B = (l3 − r3) / f and doffs = cx' −
  // cx.
  says.baseline_m = (left[3] - right[3]) / left[0];
  if (std::abs(left[7] - right[7]) > std::abs(left[3] - right[3])) {
    throw Error(
        "is of two cameras one above the other, expected side by side: rotate their images "
        "(docs/use_your_own_camera.md)");
  }
  return says;
}

StereoRig rig_of(const Projection& left, const Projection& right) {
  const Calibration calibration = judged(from_projections(left, right));
  calibration.rig->validate("calibration");
  return *calibration.rig;
}

/// Unknown keys are ignored, but without a baseline there are no metres. `unit`: of the form's baseline.
void refuse_misspelt_baseline(const Pairs& pairs, const char* unit) {
  const std::string right_key = "baseline";
  if (pairs.contains(right_key)) return;
  for (const auto& [key, value] : pairs) {
    if (key.starts_with(right_key) || !nearest(key, {right_key}).empty())
      throw Error("has no key 'baseline', but " + excerpt(key) + ", expected 'baseline' in " + unit);
  }
}

/// The keys that are not among `known`, nor of the mounting.
template <std::size_t N>
std::vector<std::string> unknown_among(const Pairs& pairs, const std::array<const char*, N>& known) {
  std::vector<std::string> unknown;
  for (const auto& [key, value] : pairs) {
    const bool is_mounting = key == kGroundPointsKey ||
                             std::any_of(kMountingKeys.begin(), kMountingKeys.end(),
                                         [&](const MountingKey& mounting) { return key == mounting.key; });
    if (!is_mounting && std::find(known.begin(), known.end(), key) == known.end()) unknown.push_back(key);
  }
  return unknown;
}

Statement read_key_value_lines(std::string_view text) {
  const Pairs pairs = pairs_of(text, '=');
  refuse_misspelt_baseline(pairs, "metres");
  Statement says;
  says.fx = number_in(pairs, "fx");
  says.fy = number_in(pairs, "fy");
  says.cx = number_in(pairs, "cx");
  says.cy = number_in(pairs, "cy");
  says.baseline_m = number_in(pairs, "baseline");
  says.doffs = number_in(pairs, "doffs");
  read_size(pairs, says);
  read_mounting(pairs, says);
  constexpr std::array kKeys = {"fx", "fy", "cx", "cy", "baseline", "doffs", "width", "height", "ndisp"};
  says.unknown_keys = unknown_among(pairs, kKeys);
  if (says.unknown_keys.size() == pairs.size()) {
    throw Error("has none of the keys fx fy cx cy baseline doffs width height ndisp, expected a calibration");
  }
  return says;
}

Statement read_middlebury(std::string_view text) {
  const Pairs pairs = pairs_of(text, '=');
  refuse_misspelt_baseline(pairs, "millimetres");
  const std::array<double, 9> left = camera_matrix(pairs, "cam0");
  Statement says;
  says.fx = left[0];
  says.fy = left[4];
  says.cx = left[2];
  says.cy = left[5];
  if (const std::optional<double> millimetres = number_in(pairs, "baseline"))
    says.baseline_m = *millimetres / 1000;
  says.doffs = number_in(pairs, "doffs");
  if (pairs.contains("cam1")) {
    const std::array<double, 9> right = camera_matrix(pairs, "cam1");
    check_same_focal(left[0], "the focal length of cam0", right[0], "that of cam1");
    if (!says.doffs) says.doffs = right[2] - left[2];
  }
  read_size(pairs, says);
  read_mounting(pairs, says);
  return says;
}

std::optional<Statement> read_camera_matrix_and_baseline(std::string_view text) {
  std::vector<double> numbers;
  try {
    numbers = finite_numbers(text, "K");
  } catch (const Error&) {
    return std::nullopt;
  }
  if (numbers.size() != 10 || numbers[6] != 0 || numbers[7] != 0 || numbers[8] != 1) return std::nullopt;
  Statement says;
  says.fx = numbers[0];
  says.cx = numbers[2];
  says.fy = numbers[4];
  says.cy = numbers[5];
  says.baseline_m = numbers[9];
  return says;
}

std::optional<std::string> known_but_unread(std::string_view text) {
  struct Known {
    std::array<std::string_view, 2> marks;  // each occurs in the text
    const char* program;
    const char* conversion;
  };
  static constexpr std::array kKnown = {
      Known{{"Camera.fx", "Camera."},
            "ORB-SLAM",
            "fx=Camera.fx, cy=Camera.cy …, baseline=Camera.bf / Camera.fx"},
      Known{{"Camera1.fx", "Camera1."}, "ORB-SLAM3", "P1 and P2, or those of its Stereo.T_c1_c2"},
      Known{{"model_type:", "projection_parameters:"},
            "VINS",
            "M1 D1 M2 D2 and R T of body_T_cam0, body_T_cam1"},
      Known{{"\"value0\"", "\"T_imu_cam\""}, "Basalt", "M1 M2 of its intrinsics and R T of its T_imu_cam"},
      Known{{"[LEFT_CAM_", "[STEREO]"}, "the ZED", "M1 D1 M2 D2 and R T of one resolution, T in metres"},
      Known{{"\"cameraData\"", "\"extrinsics\""},
            "DepthAI",
            "M1 D1 M2 D2 and R T of its two sockets, T in metres"},
      Known{
          {"P_rect_101", "P_rect_103"}, "DrivingStereo", "P2: P_rect_101, P3: P_rect_103, in KITTI's form"}};
  for (const Known& known : kKnown) {
    if (text.find(known.marks[0]) == std::string_view::npos ||
        text.find(known.marks[1]) == std::string_view::npos)
      continue;
    return std::string("is a calibration of ") + known.program + ", which is not read; write " +
           known.conversion + " (docs/formats.md, \"Calibrations in\")";
  }
  return std::nullopt;
}

Statement read_kitti(std::string_view text, bool grey_cameras) {
  Pairs pairs;
  for (const std::string_view line : lines_of(text)) {
    const std::size_t colon = line.find(':');
    if (colon == std::string_view::npos) continue;  // unrelated lines: dates, corner distances
    const auto [at, fresh] = pairs.emplace(line.substr(0, colon), trimmed(line.substr(colon + 1)));
    if (!fresh && line.starts_with('P')) throw Error("has " + excerpt(at->first) + " twice");
  }
  std::array pairs_of_cameras{std::pair{'2', '3'}, std::pair{'0', '1'}};
  if (grey_cameras) std::swap(pairs_of_cameras[0], pairs_of_cameras[1]);
  for (const auto& [left, right] : pairs_of_cameras) {
    for (const std::string prefix : {"P_rect_0", "P"}) {
      const auto first = pairs.find(prefix + left);
      const auto second = pairs.find(prefix + right);
      if (first == pairs.end() || second == pairs.end()) continue;
      const Projection of_left = projection_of(finite_numbers(first->second, first->first), first->first);
      const Projection of_right = projection_of(finite_numbers(second->second, second->first), second->first);
      Statement says = from_projections(of_left, of_right);
      read_mounting(pairs, says);
      if (const auto size = pairs.find(std::string("S_rect_0") + left); size != pairs.end()) {
        const std::vector<double> sides = finite_numbers(size->second, size->first);
        if (sides.size() != 2)
          throw Error(size->first + " is " + excerpt(size->second) + ", expected width and height");
        says.width = sides[0];
        says.height = sides[1];
      }
      return says;
    }
  }
  throw Error(
      "has no projections of a complete pair, expected P_rect_02 and P_rect_03, or 00 and 01 "
      "(or P2 and P3, ...)");
}

Calibration load_calibration(const fs::path& path, bool grey_cameras) {
  std::error_code unknown;
  const fs::path file = fs::is_directory(path, unknown) ? file_in(path) : path;
  return parse_calibration(read_file(file, kMaxTextBytes), file, grey_cameras);
}

Calibration parse_calibration(std::string_view text, const fs::path& file, bool grey_cameras) {
  try {
    Calibration calibration = judged(read_statement(text, file, grey_cameras));
    // Finite double values can overflow float.
    if (calibration.rig) calibration.rig->validate("calibration");
    return calibration;
  } catch (const ImpossibleCalibration& error) {
    throw ImpossibleCalibration(file.string() + ": " + error.what(), error.value());
  } catch (const Error& error) {
    throw Error(file.string() + ": " + error.what());
  }
}

void save_calibration(const fs::path& path, const StereoRig& rig, Size image,
                      std::optional<int> num_disparities, const KnownGround& ground) {
  write_file(path, calibration_text(rig, image, num_disparities, ground));
}

std::string calibration_text(const StereoRig& rig, Size image, std::optional<int> num_disparities,
                             const KnownGround& ground) {
  std::string file;
  const auto add = [&](const char* key, float value) {
    file += std::string(key) + "=" + shortest_text(value) + "\n";
  };
  add("fx", rig.focal_px);
  add("fy", rig.focal_px);
  add("cx", rig.cx_px);
  add("cy", rig.cy_px);
  add("baseline", rig.baseline_m);
  add("doffs", rig.doffs_px);
  file += "width=" + std::to_string(image.width) + "\nheight=" + std::to_string(image.height) + "\n";
  if (num_disparities) file += "ndisp=" + std::to_string(*num_disparities) + "\n";
  if (!ground.points.empty()) {
    file += std::string(kGroundPointsKey) + "=";
    for (const PointPair& point : ground.points) {
      file += shortest_text(point.x_left) + "," + shortest_text(point.y_left) + "," +
              shortest_text(point.x_right) + "," + shortest_text(point.y_right) + ";";
    }
    file.back() = '\n';
  }
  if (ground.camera_height_m) add("camera_height", *ground.camera_height_m);
  if (ground.camera_pitch_deg != 0) add("camera_pitch", ground.camera_pitch_deg);
  if (ground.camera_roll_deg != 0) add("camera_roll", ground.camera_roll_deg);
  return file;
}

std::optional<StereoRig> rig_of_depth(const Calibration& calibration) {
  if (calibration.rig || !calibration.one_camera) return calibration.rig;
  StereoRig rig = *calibration.one_camera;
  rig.baseline_m = kDepthBaseline_m;
  return rig;
}

int disparities_down_to(double nearest_m, const StereoRig& rig, int width) {
  constexpr int kStep = 16;
  constexpr int kMax = 1024;
  constexpr double kNearestBaselines = 5;
  const auto baseline = static_cast<double>(rig.baseline_m);
  if (nearest_m == 0) nearest_m = kNearestBaselines * baseline;
  const double last =
      static_cast<double>(rig.focal_px) * baseline / nearest_m - static_cast<double>(rig.doffs_px);
  const double steps = std::floor(std::max(last, 0.0) / kStep) + 1;
  return std::min(static_cast<int>(std::min(steps * kStep, double{kMax})), width);
}

Calibration scaled(const Calibration& calibration, Size image) {
  if (!calibration.image_size) throw Error("has no image size, expected width and height to scale it by");
  const Size from = *calibration.image_size;
  const double across = static_cast<double>(image.width) / from.width;
  const double down = static_cast<double>(image.height) / from.height;
  if (std::abs(across / down - 1) > kSameFocal) {
    throw Error("is for " + text(from) + ", which cannot be scaled to " + text(image) +
                ": the shape differs, so part of the image was cut off");
  }
  Calibration result = calibration;
  result.image_size = image;
  const auto scale = static_cast<float>(across);
  for (std::optional<StereoRig>* rig : {&result.rig, &result.one_camera}) {
    if (!*rig) continue;
    // Pixel centres are whole numbers: the border of the image, at -0.5, stays where it is.
    const auto moved = [](float at, double by) { return static_cast<float>((double{at} + 0.5) * by - 0.5); };
    (*rig)->focal_px *= scale;
    (*rig)->cx_px = moved((*rig)->cx_px, across);
    (*rig)->cy_px = moved((*rig)->cy_px, down);
    (*rig)->doffs_px *= scale;
  }
  if (result.num_disparities) {
    result.num_disparities =
        std::clamp(static_cast<int>(std::ceil(*result.num_disparities * across)), 1, image.width);
  }
  for (PointPair& point : result.ground.points) {
    for (float* at : {&point.x_left, &point.x_right})
      *at = static_cast<float>((double{*at} + 0.5) * across - 0.5);
    for (float* at : {&point.y_left, &point.y_right})
      *at = static_cast<float>((double{*at} + 0.5) * down - 0.5);
  }
  return result;
}

void check_binning(int factor) {
  if (factor < 1 || factor > kMaxBinning) {
    throw Error("--binning: found " + std::to_string(factor) + ", expected 1 to " +
                std::to_string(kMaxBinning));
  }
}

Calibration binned(const Calibration& calibration, Size image, int factor) {
  check_binning(factor);
  const Size small{image.width / factor, image.height / factor};
  if (small.area() == 0) {
    throw Error("--binning " + std::to_string(factor) + ": found images of " + text(image) +
                ", expected larger ones");
  }
  Calibration whole = calibration;
  whole.image_size =
      Size{small.width * factor, small.height * factor};  // what remains at the border is left out
  return scaled(whole, small);
}

Calibration suited(const Calibration& calibration, Size image, const fs::path& path, bool scales) try {
  if (!calibration.image_size || *calibration.image_size == image) return calibration;
  if (scales) return scaled(calibration, image);
  throw Error("the calibration is for " + text(*calibration.image_size) + ", the images are " + text(image) +
              " (--scale-calibration if they were only resized)");
} catch (const Error& error) {
  throw Error(path.string() + ": " + error.what());
}

void check_search_range(const Calibration& calibration, const fs::path& path) {
  if (!calibration.num_disparities) return;
  try {
    Config config;
    set(config, "match.num_disparities", std::to_string(*calibration.num_disparities));
  } catch (const Error& error) {
    throw Error(path.string() + ": ndisp, the default of " + error.what() +
                "; time and memory grow with it (--set match.num_disparities=N overrides it)");
  }
}

}  // namespace cairn::io
