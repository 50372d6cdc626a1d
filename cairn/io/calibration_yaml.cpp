// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/nearest.hpp>
#include <cairn/core/number_text.hpp>
#include <cairn/io/calibration_forms.hpp>
#include <cairn/io/read_file.hpp>
#include <cctype>
#include <utility>

#include <cairn/io/yaml_text.hpp>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;
using Numbers = std::vector<double>;

constexpr std::array kSides = {std::pair{"left", "right"}, std::pair{"Left", "Right"},
                               std::pair{"LEFT", "RIGHT"}, std::pair{"_L.", "_R."}};

/// The path with the last `word` of its name replaced; nullopt without it.
std::optional<fs::path> renamed(const fs::path& path, std::string_view word, std::string_view other) {
  std::string name = path.filename().string();
  const std::size_t at = name.rfind(word);
  if (at == std::string::npos) return std::nullopt;
  return path.parent_path() / name.replace(at, word.size(), other);
}

/// A matrix in the format of OpenCV or ROS.
struct Matrix {
  double rows = 0;
  double cols = 0;
  std::vector<double> data;
};

// ---- YAML ----

/// OpenCV's first line is not valid YAML ("%YAML:1.0").
std::string_view without_directive(std::string_view text) {
  const std::string_view begin = trimmed(text);
  if (!begin.starts_with("%YAML")) return text;
  return begin.substr(std::min(begin.find('\n'), begin.size()));
}

/// OpenCV reads "data:[1, 2]", which YAML takes for a word; a space is missing.
std::string with_spaces_before_lists(std::string_view text) {
  std::string spaced;
  for (std::size_t i = 0; i < text.size(); ++i) {
    spaced += text[i];
    const bool is_key =
        i > 0 && (std::isalnum(static_cast<unsigned char>(text[i - 1])) != 0 || text[i - 1] == '_');
    if (text[i] == ':' && is_key && i + 1 < text.size() && text[i + 1] == '[') spaced += ' ';
  }
  return spaced;
}

std::vector<YAML::Node> documents_of(std::string_view text) {
  try {
    std::vector<YAML::Node> documents = yaml_documents(with_spaces_before_lists(without_directive(text)));
    // `ros2 topic echo` ends each message with "---".
    while (documents.size() > 1 && documents.back().IsNull()) documents.pop_back();
    return documents;
  } catch (const YAML::Exception& exception) {
    const std::string line =
        exception.mark.is_null() ? "" : "line " + std::to_string(exception.mark.line + 1) + ": ";
    throw Error(line + "is not YAML (" + exception.msg + "), expected a calibration");
  }
}

std::optional<double> number_at(const YAML::Node& map, const char* key) {
  const YAML::Node node = map[key];
  if (!node) return std::nullopt;
  if (!node.IsScalar()) throw Error(std::string(key) + " is not a number");
  return finite_number(node.Scalar(), key);
}

/// A list, or a list of rows.
std::vector<double> numbers_of(const YAML::Node& sequence, const char* key) {
  // The longest list of any format is 4x4.
  constexpr std::size_t kMaxNumbers = 16;
  const auto is_list = [](const YAML::Node& node) { return node.IsSequence() && node.size() <= kMaxNumbers; };
  if (!is_list(sequence)) throw Error(std::string(key) + " is not a list of at most 16 numbers");
  std::vector<double> numbers;
  const auto add = [&](const YAML::Node& item) {
    if (!item.IsScalar()) throw Error(std::string(key) + " contains something that is not a number");
    numbers.push_back(finite_number(item.Scalar(), key));
  };
  for (const YAML::Node& item : sequence) {
    if (!is_list(item)) {
      add(item);
    } else {
      for (const YAML::Node& number : item) add(number);
    }
  }
  return numbers;
}

/// OpenCV's map with `data`, or a plain or nested list, whose length tells its shape.
std::optional<Matrix> matrix_at(const YAML::Node& map, const char* key) {
  const YAML::Node node = map[key];
  if (node && node.IsSequence()) {
    std::vector<double> numbers = numbers_of(node, key);
    const double rows = numbers.size() == 16 ? 4 : numbers.size() == 9 || numbers.size() == 12 ? 3 : 1;
    return Matrix{rows, static_cast<double>(numbers.size()) / rows, std::move(numbers)};
  }
  if (!node || !node.IsMap() || !node["data"]) return std::nullopt;
  return Matrix{number_at(node, "rows").value_or(0), number_at(node, "cols").value_or(0),
                numbers_of(node["data"], key)};
}

// ---- XML ----

std::string without_comments(std::string_view text) {
  std::string rest;
  for (std::size_t begin = 0; (begin = text.find("<!--")) != std::string_view::npos;) {
    rest += text.substr(0, begin);
    const std::size_t end = text.find("-->", begin);
    if (end == std::string_view::npos) throw Error("is damaged XML: a comment does not end");
    text.remove_prefix(end + 3);
  }
  return rest += text;
}

/// The content of <name …>…</name>; nullopt without such an element.
std::optional<std::string_view> element(std::string_view xml, std::string_view name) {
  const std::string open = "<" + std::string(name);
  for (std::size_t at = 0; (at = xml.find(open, at)) != std::string_view::npos; at += open.size()) {
    const std::size_t after = at + open.size();
    if (after < xml.size() && std::string_view("> \t\r\n").find(xml[after]) == std::string_view::npos)
      continue;
    const std::size_t begin = xml.find('>', after);
    const std::size_t end = xml.find("</" + std::string(name) + ">", after);
    if (begin == std::string_view::npos || end == std::string_view::npos || end < begin) {
      throw Error("is damaged XML: <" + std::string(name) + "> does not end");
    }
    return xml.substr(begin + 1, end - begin - 1);
  }
  return std::nullopt;
}

std::optional<double> number_at(std::string_view xml, const char* key) {
  const std::optional<std::string_view> text = element(xml, key);
  if (!text) return std::nullopt;
  return finite_number(*text, key);
}

std::optional<Matrix> matrix_at(std::string_view xml, const char* key) {
  const std::optional<std::string_view> node = element(xml, key);
  if (!node) return std::nullopt;
  const std::optional<std::string_view> data = element(*node, "data");
  if (!data) return std::nullopt;
  return Matrix{number_at(*node, "rows").value_or(0), number_at(*node, "cols").value_or(0),
                finite_numbers(*data, key)};
}

std::optional<std::vector<double>> list_at(std::string_view xml, const char* key) {
  const std::optional<std::string_view> node = element(xml, key);
  if (!node) return std::nullopt;
  return finite_numbers(*node, key);
}
std::optional<std::vector<double>> list_at(const YAML::Node& map, const char* key) {
  const YAML::Node node = map[key];
  if (!node) return std::nullopt;
  return numbers_of(node, key);
}

// ---- mounting of the rig, from either ----

std::optional<std::vector<double>> points_at(std::string_view xml) {
  return list_at(xml, kGroundPointsKey);
}
/// A list of numbers, a list of points, or text with these.
std::optional<std::vector<double>> points_at(const YAML::Node& map) {
  const YAML::Node node = map[kGroundPointsKey];
  if (!node) return std::nullopt;
  if (node.IsScalar()) return finite_numbers(node.Scalar(), kGroundPointsKey);
  constexpr std::size_t kMaxPoints = 4096;
  if (!node.IsSequence() || node.size() > kMaxPoints)
    throw Error(std::string(kGroundPointsKey) + " is not a list of at most 4096 points");
  std::vector<double> all;
  for (const YAML::Node& item : node) {
    if (item.IsScalar()) {
      all.push_back(finite_number(item.Scalar(), kGroundPointsKey));
    } else {
      const std::vector<double> point = numbers_of(item, kGroundPointsKey);
      all.insert(all.end(), point.begin(), point.end());
    }
  }
  return all;
}

template <class Document>
void read_mounting(const Document& document, Statement& says) {
  for (const auto& [key, member] : kMountingKeys) says.*member = number_at(document, key);
  says.ground_points = points_at(document).value_or(std::vector<double>{});
}

// ---- OpenCV, from either ----

void check_shape(const Matrix& matrix, const char* key, int rows, int cols) {
  const auto count = static_cast<std::size_t>(rows * cols);
  if (matrix.rows == rows && matrix.cols == cols && matrix.data.size() == count) return;
  throw Error(std::string(key) + " is not a " + std::to_string(rows) + "x" + std::to_string(cols) +
              " matrix");
}

/// Q = [1 0 0 −cx; 0 1 0 −cy; 0 0 0 f; 0 0 1/B (cx'−cx)/B], as written by cv::stereoRectify.
Statement from_reprojection(const Matrix& matrix) {
  check_shape(matrix, "Q", 4, 4);
  const std::vector<double>& q = matrix.data;
  if (q[14] == 0) throw Error("Q has no baseline (its row 4, column 3 is 0)");
  return {q[11], q[11], -q[3], -q[7], 1 / q[14], q[15] / q[14], {}, {}, {}};
}

bool is_distorted(const std::vector<double>& coefficients) {
  return std::any_of(coefficients.begin(), coefficients.end(), [](double value) { return value != 0; });
}

constexpr std::initializer_list<const char*> kLeftDistortion = {"D1", "distCoeffs1", "dist_coeffs_1"};
constexpr std::initializer_list<const char*> kRightDistortion = {"D2", "distCoeffs2", "dist_coeffs_2"};

template <class Document>
bool has_distortion(const Document& document) {
  for (const auto& names : {kLeftDistortion, kRightDistortion}) {
    for (const char* name : names) {
      const std::optional<Matrix> matrix = matrix_at(document, name);
      if (matrix && is_distorted(matrix->data)) return true;
    }
  }
  return false;
}

template <class Document>
void read_size(const Document& document, Statement& says) {
  for (const auto& [width, height] :
       {std::pair{"image_width", "image_height"}, std::pair{"width", "height"}}) {
    if (!says.width) says.width = number_at(document, width);
    if (!says.height) says.height = number_at(document, height);
  }
  for (const char* key : {"image_size", "imageSize", "size", "resolution"}) {
    if (says.width && says.height) return;
    const std::optional<std::vector<double>> sides = list_at(document, key);
    if (!sides) continue;
    if (sides->size() != 2) throw Error(std::string(key) + " is not two numbers, expected width and height");
    says.width = (*sides)[0];
    says.height = (*sides)[1];
  }
}

/// nullopt without any of OpenCV's matrices.
template <class Document>
std::optional<Statement> read_opencv(const Document& document) {
  const std::optional<Matrix> left = matrix_at(document, "P1");
  const std::optional<Matrix> right = matrix_at(document, "P2");
  const std::optional<Matrix> reprojection = matrix_at(document, "Q");
  Statement says;
  if (left && right) {
    check_shape(*left, "P1", 3, 4);
    check_shape(*right, "P2", 3, 4);
    says = from_projections(projection_of(left->data, "P1"), projection_of(right->data, "P2"));
  } else if (reprojection) {
    says = from_reprojection(*reprojection);
  } else {
    for (const char* key :
         {"M1", "K1", "cameraMatrix1", "camera_matrix", "Camera_Matrix", "P1", "P2", "R", "T"}) {
      if (!matrix_at(document, key)) continue;
      throw Error(std::string("has ") + key +
                  " but neither P1 and P2 nor Q, expected the calibration of rectified images");
    }
    return std::nullopt;
  }
  read_size(document, says);
  if (!says.ndisp) says.ndisp = number_at(document, "ndisp");
  read_mounting(document, says);
  says.has_distortion = has_distortion(document);
  return says;
}

// ---- ROS camera_info ----

/// The projection matrix of a camera: `projection_matrix` in files of camera_calibration, `P` or `p` in a
/// printed message.
std::optional<Projection> ros_projection(const YAML::Node& camera) {
  if (!camera.IsMap()) return std::nullopt;
  if (const std::optional<Matrix> matrix = matrix_at(camera, "projection_matrix")) {
    return projection_of(matrix->data, "projection_matrix");
  }
  for (const char* key : {"P", "p"}) {
    if (camera[key] && camera[key].IsSequence()) return projection_of(numbers_of(camera[key], key), key);
  }
  return std::nullopt;
}

/// The distortion of a camera: `distortion_coefficients` in files of camera_calibration, `D` or `d` in a
/// printed message.
bool ros_distortion(const YAML::Node& camera) {
  if (const auto matrix = matrix_at(camera, "distortion_coefficients")) return is_distorted(matrix->data);
  for (const char* key : {"D", "d"}) {
    if (camera[key] && camera[key].IsSequence()) return is_distorted(numbers_of(camera[key], key));
  }
  return false;
}

/// The two cameras. The mounting of the rig and the size of the images are in the file that was named.
struct RosPair {
  YAML::Node left;
  YAML::Node right;
  YAML::Node named;
};

/// Throws Error unless both have a projection, and P[0][3], which is −fx·B for the right camera, agrees with the names.
void check_order(const std::optional<Projection>& left, const std::optional<Projection>& right) {
  if (!left || !right) throw Error("the other camera has no projection_matrix");
  if ((*left)[3] >= (*right)[3]) return;
  throw Error("the names are exchanged: the projection_matrix of the left camera has " +
              shortest_text((*left)[3]) + " as its fourth number, that of the right one " +
              shortest_text((*right)[3]) + ", expected -fx * baseline for the right one");
}

Statement from_ros_pair(const RosPair& pair) {
  const std::optional<Projection> left = ros_projection(pair.left);
  const std::optional<Projection> right = ros_projection(pair.right);
  check_order(left, right);
  Statement says = from_projections(*left, *right);
  read_size(pair.named, says);
  read_mounting(pair.named, says);
  says.has_distortion = ros_distortion(pair.left) || ros_distortion(pair.right);
  return says;
}

/// The file of the other camera, in the same folder.
YAML::Node ros_partner(const fs::path& path) {
  const std::optional<fs::path> partner = other_camera(path);
  std::error_code unknown;
  if (!partner || !fs::is_regular_file(*partner, unknown)) {
    throw Error("is of one camera, expected the file of the other next to it" +
                (partner ? ": " + partner->filename().string()
                         : std::string(", named alike with left and right (left.yaml, right.yaml)")));
  }
  const std::vector<YAML::Node> documents = documents_of(read_file(*partner, kMaxTextBytes));
  if (documents.empty())
    throw Error("the file of the other camera " + partner->filename().string() + " is empty");
  return documents.front();
}

/// Both cameras, from one file or the two of a pair; nullopt if the file is no camera_info.
std::optional<RosPair> ros_pair(const std::vector<YAML::Node>& documents, const fs::path& path) {
  const YAML::Node& map = documents.front();
  if (documents.size() == 2 && ros_projection(map)) {
    // Without names, P tells them apart.
    const std::optional<Projection> first = ros_projection(map);
    const std::optional<Projection> second = ros_projection(documents.back());
    const bool in_order = !second || (*first)[3] >= (*second)[3];
    return in_order ? RosPair{map, documents.back(), map} : RosPair{documents.back(), map, map};
  }
  for (const auto& [left, right] : {std::pair{"left", "right"}, std::pair{"left_rect", "right_rect"}}) {
    if (map[left] && map[right]) return RosPair{map[left], map[right], map[left]};
  }
  if (!ros_projection(map)) return std::nullopt;
  const YAML::Node partner = ros_partner(path);
  return right_named_like(path) ? RosPair{map, partner, map} : RosPair{partner, map, map};
}

// ---- the two files of OpenCV's sample stereo_calib ----

/// intrinsics.yml ↔ extrinsics.yml, if it exists.
std::optional<fs::path> other_half(const fs::path& path) {
  for (const auto& [word, other] :
       {std::pair{"intrinsic", "extrinsic"}, std::pair{"extrinsic", "intrinsic"}}) {
    std::string name = path.filename().string();
    const std::size_t at = name.rfind(word);
    if (at == std::string::npos) continue;
    fs::path half = path.parent_path() / name.replace(at, std::string_view(word).size(), other);
    std::error_code unknown;
    if (fs::is_regular_file(half, unknown)) return half;
  }
  return std::nullopt;
}

/// The map, with the keys of the other file that it lacks.
YAML::Node with_other_half(const YAML::Node& map, const fs::path& path) {
  if (map["M1"].IsDefined() == map["R"].IsDefined()) return map;
  const std::optional<fs::path> half = other_half(path);
  if (!half) return map;
  const std::vector<YAML::Node> documents = documents_of(read_file(*half, kMaxTextBytes));
  if (documents.empty() || !documents.front().IsMap()) throw Error(half->string() + " is not a YAML map");
  YAML::Node both = YAML::Clone(map);
  for (const auto& entry : documents.front()) {
    if (entry.first.IsScalar() && !both[entry.first.Scalar()]) both[entry.first.Scalar()] = entry.second;
  }
  return both;
}

// ---- raw cameras ----

template <std::size_t N>
std::array<double, N> fixed(const std::vector<double>& numbers, const char* key) {
  if (numbers.size() != N) {
    throw Error(std::string(key) + " has " + std::to_string(numbers.size()) + " numbers, expected " +
                std::to_string(N));
  }
  std::array<double, N> array{};
  std::copy(numbers.begin(), numbers.end(), array.begin());
  return array;
}

using Names = std::initializer_list<const char*>;

/// The elements of the matrix with one of these names.
template <class Document>
std::optional<std::vector<double>> matrix_named(const Document& document, Names names) {
  for (const char* name : names) {
    if (const std::optional<Matrix> matrix = matrix_at(document, name)) return matrix->data;
  }
  return std::nullopt;
}

template <std::size_t N, class Document>
std::optional<std::array<double, N>> fixed_named(const Document& document, Names names) {
  const auto numbers = matrix_named(document, names);
  if (!numbers) return std::nullopt;
  return fixed<N>(*numbers, *names.begin());
}

template <std::size_t N, class Document>
std::array<double, N> needed(const Document& document, Names names) {
  if (const auto numbers = fixed_named<N>(document, names)) return *numbers;
  throw Error(std::string("has no ") + *names.begin() + ", expected the calibration of raw cameras");
}

/// Empty without width and height: that of the images.
Size raw_size(const Statement& says) {
  if (!says.width && !says.height) return {};
  constexpr double kMax = 32768;
  const auto counted = [](const std::optional<double>& side, const char* name) {
    if (side && *side >= 1 && *side <= kMax && *side == static_cast<int>(*side))
      return static_cast<int>(*side);
    throw Error(std::string("has no ") + name + " of the images, expected a whole number");
  };
  return {counted(says.width, "width"), counted(says.height, "height")};
}

template <class Document>
RawCalibration read_raw_opencv(const Document& document) {
  RawCalibration raw;
  Statement says;
  read_size(document, says);
  raw.image_size = raw_size(says);
  raw.left.matrix = needed<9>(document, {"M1", "K1", "cameraMatrix1", "camera_matrix_1"});
  raw.right.matrix = needed<9>(document, {"M2", "K2", "cameraMatrix2", "camera_matrix_2"});
  raw.left.distortion = matrix_named(document, kLeftDistortion).value_or(Numbers{});
  raw.right.distortion = matrix_named(document, kRightDistortion).value_or(Numbers{});
  raw.left.rotation = fixed_named<9>(document, {"R1"});
  raw.right.rotation = fixed_named<9>(document, {"R2"});
  raw.left.projection = fixed_named<12>(document, {"P1"});
  raw.right.projection = fixed_named<12>(document, {"P2"});
  raw.rotation = fixed_named<9>(document, {"R"});
  raw.translation_m = fixed_named<3>(document, {"T"});
  return raw;
}

std::string text_at(const YAML::Node& map, const char* key) {
  const YAML::Node node = map[key];
  return node && node.IsScalar() ? node.Scalar() : "";
}

RawCamera raw_camera(const YAML::Node& camera) {
  const std::string model = text_at(camera, "distortion_model");
  const bool is_fisheye = model == "equidistant" || model == "fisheye";
  if (!model.empty() && model != "plumb_bob" && model != "rational_polynomial" && !is_fisheye) {
    throw Error("distortion_model is " + excerpt(model) +
                ", expected plumb_bob, rational_polynomial or equidistant");
  }
  return {needed<9>(camera, {"camera_matrix"}),
          matrix_named(camera, {"distortion_coefficients"}).value_or(Numbers{}),
          needed<9>(camera, {"rectification_matrix"}), ros_projection(camera), is_fisheye};
}

RawCalibration raw_from_ros(const RosPair& pair) {
  RawCalibration raw;
  Statement says;
  read_size(pair.named, says);
  raw.image_size = raw_size(says);
  raw.left = raw_camera(pair.left);
  raw.right = raw_camera(pair.right);
  check_order(raw.left.projection, raw.right.projection);
  return raw;
}

// ---- EuRoC ----

/// Rows of T_BS: from the camera to the body.
using Pose = std::array<double, 16>;

/// With fx fy cx cy as `intrinsics`.
RawCamera camera_of_intrinsics(const YAML::Node& camera, const char* distortion, bool is_fisheye) {
  const auto [fx, fy, cx, cy] = fixed<4>(list_at(camera, "intrinsics").value_or(Numbers{}), "intrinsics");
  return {
      {fx, 0, cx, 0, fy, cy, 0, 0, 1}, list_at(camera, distortion).value_or(Numbers{}), {}, {}, is_fisheye};
}

RawCamera euroc_camera(const YAML::Node& camera) {
  const std::string name = text_at(camera, "distortion_model");
  if (name != "radial-tangential")
    throw Error("distortion_model is " + excerpt(name) + ", expected radial-tangential");
  return camera_of_intrinsics(camera, "distortion_coefficients", false);
}

/// x_right = Rᵣᵀ · (Rₗ · x_left + tₗ − tᵣ), with R and t of T_BS.
void relate(const Pose& left, const Pose& right, RawCalibration& raw) {
  std::array<double, 9> rotation{};
  std::array<double, 3> translation{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = 0; j < 3; ++j) rotation[3 * i + j] += right[4 * k + i] * left[4 * k + j];
      translation[i] += right[4 * k + i] * (left[4 * k + 3] - right[4 * k + 3]);
    }
  }
  raw.rotation = rotation;
  raw.translation_m = translation;
}

/// cam0/sensor.yaml, and cam1/sensor.yaml in the neighbouring folder.
RawCalibration raw_from_euroc(const YAML::Node& left, const fs::path& path) {
  const fs::path folder = fs::absolute(path).lexically_normal().parent_path();
  const fs::path partner = folder.parent_path() / "cam1" / path.filename();
  std::error_code unknown;
  if (folder.filename() != "cam0" || !fs::is_regular_file(partner, unknown))
    throw Error("is of one of EuRoC's cameras, expected cam0/sensor.yaml with cam1/sensor.yaml next to it");
  const std::vector<YAML::Node> documents = documents_of(read_file(partner, kMaxTextBytes));
  if (documents.empty() || !documents.front().IsMap()) throw Error(partner.string() + " is not a YAML map");
  const YAML::Node& right = documents.front();
  RawCalibration raw;
  Statement says;
  read_size(left, says);
  raw.image_size = raw_size(says);
  raw.left = euroc_camera(left);
  raw.right = euroc_camera(right);
  relate(needed<16>(left, {"T_BS"}), needed<16>(right, {"T_BS"}), raw);
  return raw;
}

// ---- Kalibr ----

bool is_kalibr(const YAML::Node& map) {
  return map["cam0"] && map["cam0"].IsMap() && map["cam0"]["intrinsics"];
}

RawCamera kalibr_camera(const YAML::Node& camera, const char* name) {
  const std::string model = text_at(camera, "camera_model");
  const std::string distortion = text_at(camera, "distortion_model");
  const bool is_known = distortion == "radtan" || distortion == "equidistant" || distortion == "none";
  if (model != "pinhole" || !is_known) {
    throw Error(std::string(name) + " has the model " + excerpt(model + "-" + distortion) +
                ", expected pinhole-radtan, pinhole-equidistant or pinhole-none");
  }
  return camera_of_intrinsics(camera, "distortion_coeffs", distortion == "equidistant");
}

/// A camchain of two cameras. The left one is the one that sees the other to its right.
RawCalibration raw_from_kalibr(const YAML::Node& map) {
  const YAML::Node first = map["cam0"];
  const YAML::Node second = map["cam1"];
  if (!second || !second.IsMap()) throw Error("is Kalibr's camchain without cam1, expected both cameras");
  Statement says;
  read_size(first, says);
  RawCalibration raw;
  raw.image_size = raw_size(says);
  raw.left = kalibr_camera(first, "cam0");
  raw.right = kalibr_camera(second, "cam1");
  // From cam0 to cam1: with cam1's pose as the identity, relate() returns this pose.
  const Pose from_first = needed<16>(second, {"T_cn_cnm1"});
  constexpr Pose kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  if (from_first[3] < 0) {
    relate(from_first, kIdentity, raw);
  } else {
    std::swap(raw.left, raw.right);
    relate(kIdentity, from_first, raw);
  }
  return raw;
}

// ---- our own ----

Statement read_own(const YAML::Node& map) {
  Statement says;
  const std::pair<const char*, std::optional<double> Statement::*> keys[] = {
      {"focal_px", &Statement::fx},           {"cx_px", &Statement::cx},       {"cy_px", &Statement::cy},
      {"baseline_m", &Statement::baseline_m}, {"doffs_px", &Statement::doffs}, {"width", &Statement::width},
      {"height", &Statement::height},         {"ndisp", &Statement::ndisp}};
  std::vector<std::string> names;
  for (const auto& [name, member] : keys) {
    says.*member = number_at(map, name);
    names.emplace_back(name);
  }
  read_mounting(map, says);
  names.emplace_back(kGroundPointsKey);
  for (const MountingKey& mounting : kMountingKeys) names.emplace_back(mounting.key);
  for (const auto& entry : map) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
    if (std::find(names.begin(), names.end(), key) != names.end()) continue;
    const std::string close = nearest(key, names);
    std::string all;
    for (const std::string& name : names) all += " " + name;
    throw Error("has the unknown key " + excerpt(key) +
                (close.empty() ? ", expected" + all : ", did you mean '" + close + "'?"));
  }
  return says;
}

}  // namespace

std::optional<fs::path> right_named_like(const fs::path& left) {
  for (const auto& [word, other] : kSides) {
    if (std::optional<fs::path> found = renamed(left, word, other)) return found;
  }
  return std::nullopt;
}

std::optional<fs::path> other_camera(const fs::path& path) {
  if (std::optional<fs::path> right = right_named_like(path)) return right;
  for (const auto& [other, word] : kSides) {
    if (std::optional<fs::path> left = renamed(path, word, other)) return left;
  }
  return std::nullopt;
}

std::optional<Statement> read_yaml(std::string_view text, const fs::path& path) try {
  const std::vector<YAML::Node> documents = documents_of(text);
  if (documents.empty() || !documents.front().IsMap()) return std::nullopt;
  if (const auto pair = ros_pair(documents, path)) return from_ros_pair(*pair);
  const YAML::Node map = with_other_half(documents.front(), path);
  if (is_kalibr(map))
    throw Error("is Kalibr's camchain of raw cameras: rectify the images with it (cairn rectify, --rectify)");
  if (std::optional<Statement> says = read_opencv(map)) return says;
  return read_own(map);
} catch (const YAML::Exception& exception) {
  throw Error("is not a calibration: " + exception.msg);
}

RawCalibration read_raw(std::string_view text, const fs::path& path) try {
  if (trimmed(text).starts_with('<')) {
    const std::string xml = without_comments(text);
    return read_raw_opencv(std::string_view(xml));
  }
  const std::vector<YAML::Node> documents = documents_of(text);
  if (documents.empty() || !documents.front().IsMap())
    throw Error("is not a YAML map, expected the calibration of raw cameras");
  if (const auto pair = ros_pair(documents, path)) return raw_from_ros(*pair);
  if (documents.front()["T_BS"]) return raw_from_euroc(documents.front(), path);
  if (is_kalibr(documents.front())) return raw_from_kalibr(documents.front());
  return read_raw_opencv(with_other_half(documents.front(), path));
} catch (const YAML::Exception& exception) {
  throw Error("is not a calibration: " + exception.msg);
}

Statement read_opencv_xml(std::string_view text) {
  const std::string xml = without_comments(text);
  if (const std::optional<Statement> says = read_opencv(std::string_view(xml))) return *says;
  throw Error("is XML without P1 and P2 or Q, expected OpenCV's calibration of rectified images");
}

}  // namespace cairn::io
