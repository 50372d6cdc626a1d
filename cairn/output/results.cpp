// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/point_cloud.hpp>
#include <cairn/io/read_file.hpp>
#include <cairn/io/rle.hpp>
#include <cairn/objects/ground_steps.hpp>
#include <cairn/output/json.hpp>
#include <cairn/output/overlay.hpp>
#include <cairn/output/results.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <system_error>

namespace cairn::output {
namespace {

namespace fs = std::filesystem;

// ---- objects.json ----

Json json(float value) {
  return shortest(value);
}

Json json(const std::optional<Vec3>& v) {
  if (!v) return nullptr;
  return Json::array({json(v->x), json(v->y), json(v->z)});
}

Json json(const std::optional<Interval>& i) {
  if (!i) return nullptr;
  return Json::array({json(i->low), json(i->high)});
}

Json json(const std::optional<FloorBox>& box) {
  if (!box) return nullptr;
  Json covariance = Json::array();
  for (const float entry : box->centre_covariance_m2) covariance.push_back(json(entry));
  return {{"centre_m", json(std::optional(box->centre_in_floor_m))},
          {"size_m", json(std::optional(box->size_m))},
          {"yaw_rad", json(box->yaw_rad)},
          {"centre_covariance_m2", covariance}};
}

Json json(const std::optional<StereoRig>& rig) {
  if (!rig) return nullptr;
  return {{"focal_px", json(rig->focal_px)},
          {"cx_px", json(rig->cx_px)},
          {"cy_px", json(rig->cy_px)},
          {"baseline_m", json(rig->baseline_m)},
          {"doffs_px", json(rig->doffs_px)}};
}

Json floor_json(const Frame& frame, const Provenance& provenance) {
  const auto floor = floor_frame(frame.ground, provenance.rig);
  if (!floor) return nullptr;
  Json matrix = Json::array();
  for (const float entry : floor->floor_from_camera()) matrix.push_back(json(entry));
  return {{"camera_height_m", json(floor->camera_height_m)},
          {"camera_pitch_rad", json(floor->pitch_rad())},
          {"camera_roll_rad", json(floor->roll_rad())},
          {"floor_from_camera", matrix}};
}

Json json(const Ground& ground) {
  Json j;
  j["plane"] = nullptr;
  if (ground.plane)
    j["plane"] = {{"a", json(ground.plane->a)}, {"b", json(ground.plane->b)}, {"c", json(ground.plane->c)}};
  j["support"] = json(ground.support);
  j["residual_px"] = json(ground.residual_px);
  j["refusal"] = choice_name(ground.refusal, kRefusals);
  return j;
}

Json json(const EpipolarOffset& epipolar) {
  Json j{{"rows", json(epipolar.rows)},
         {"rows_per_px", json(epipolar.rows_per_px)},
         {"points", epipolar.points},
         {"agreeing", epipolar.agreeing}};
  j["outcome"] = choice_name(epipolar.outcome, kEpipolarOutcomes);
  return j;
}

Json json(const RejectedObstacle& left) {
  const Rect box = left.box_px;
  Json j;
  j["reason"] = choice_name(left.reason, kLeftOutReasons);
  j["bbox"] = {box.x, box.y, box.width, box.height};
  j["area"] = left.pixel_count;
  j["disparity_px"] = json(left.disparity_px);
  j["position_m"] = json(left.position_in_camera_m);
  j["confidence"] = json(left.confidence);
  return j;
}

/// The floor and its steps.
struct FloorWithSteps {
  FloorFrame frame;
  std::vector<GroundStep> steps;
};

/// nullopt if no floor is known in metres, or without `frame.space`.
std::optional<FloorWithSteps> floor_with_steps(const Frame& frame, const Provenance& provenance) {
  const auto floor = floor_frame(frame.ground, provenance.rig);
  if (!floor || frame.space.empty()) return std::nullopt;
  return FloorWithSteps{*floor, find_steps(frame, *floor, *provenance.rig, provenance.config.obstacles)};
}

Json scan_json(const Frame& frame, const FloorFrame& floor, const Provenance& provenance) {
  const ObstacleScan scan = scan_obstacles(frame, floor, *provenance.rig, provenance.config.obstacles);
  Json ranges = Json::array();
  for (const float range : scan.ranges_m) ranges.push_back(json(range));
  return {{"angle_min_rad", json(scan.angle_min_rad)},
          {"angle_increment_rad", json(scan.angle_increment_rad)},
          {"range_max_m", json(scan.range_max_m)},
          {"ranges_m", ranges}};
}

Json steps_json(const std::vector<GroundStep>& steps) {
  Json all = Json::array();
  for (const GroundStep& step : steps) {
    all.push_back(
        {{"from_m", json(step.from_m)}, {"to_m", json(step.to_m)}, {"height_m", json(step.height_m)}});
  }
  return all;
}

Json option_value(const OptionInfo& option) {
  if (option.type == "bool") return option.value == "true";
  if (option.type == "int" || option.type == "float") {
    const char* end = option.value.data() + option.value.size();
    if (std::int64_t whole = 0;
        option.type == "int" && std::from_chars(option.value.data(), end, whole).ptr == end) {
      return whole;
    }
    if (double number = 0; std::from_chars(option.value.data(), end, number).ptr == end) return number;
  }
  return option.value;
}

Json json(const Object& object, View<const ObjectId> labels) {
  const Rect box = object.box_px;
  const io::Rle rle = io::encode_rle(labels, object.id, box);
  Json j;
  j["id"] = number(object.id);
  j["bbox"] = {box.x, box.y, box.width, box.height};
  j["area"] = object.pixel_count;
  j["segmentation"] = {{"size", {rle.size.height, rle.size.width}}, {"counts", rle.counts}};
  j["disparity_px"] = json(object.disparity_px);
  j["disparity_sigma_px"] = json(object.disparity_sigma_px);
  j["position_m"] = json(object.position_in_camera_m);
  j["depth_interval_m"] = json(object.depth_interval_m);
  j["extent_m"] = json(object.extent_in_camera_m);
  j["box_on_floor"] = json(object.box_on_floor);
  j["mean_colour"] = {object.mean_colour.r, object.mean_colour.g, object.mean_colour.b};
  j["valid_share"] = json(object.valid_share);
  j["edge_share"] = json(object.edge_share);
  j["cut_share"] = json(object.cut_share);
  j["confidence"] = json(object.confidence);
  return j;
}

Json size_json(const Frame& frame) {
  const Size size = frame.disparity.disparity_px.size();
  return {{"width", size.width}, {"height", size.height}};
}

/// Writes the results, up to the end of the document.
void add_findings(Json& j, const Frame& frame, const Provenance& provenance,
                  const std::optional<FloorWithSteps>& floor) {
  j["epipolar"] = json(frame.epipolar);
  j["ground"] = json(frame.ground);
  j["floor_frame"] = floor_json(frame, provenance);
  j["objects"] = Json::array();
  for (const Object& object : frame.objects.list) j["objects"].push_back(json(object, frame.objects.labels));
  j["left_out"] = Json::array();
  for (const RejectedObstacle& left : frame.left_out) j["left_out"].push_back(json(left));
  j["obstacle_scan"] = floor ? scan_json(frame, floor->frame, provenance) : Json(nullptr);
  j["ground_steps"] = floor ? steps_json(floor->steps) : Json(nullptr);
}

Json document_of(const Frame& frame, const Provenance& provenance,
                 const std::optional<FloorWithSteps>& floor) {
  Json j;
  j["cairn"] = CAIRN_VERSION;
  j["schema"] = kObjectsSchema;
  j["stamp_ns"] = provenance.stamp_ns ? Json(*provenance.stamp_ns) : Json(nullptr);
  j["image"] = size_json(frame);
  j["rig"] = json(provenance.rig);
  j["preset"] = provenance.preset;
  j["config"] = json_of(provenance.config);
  j["external_disparity"] = provenance.external_disparity;
  j["timings_ms"] = Json::object();
  for (const StageTime& time : provenance.timings) {
    j["timings_ms"][time.stage] = std::round(time.milliseconds * 1000) / 1000;
  }
  add_findings(j, frame, provenance, floor);
  return j;
}

std::string file_text(const Json& j) {
  return json_text(j, 1) + "\n";
}

Image<Rgb> draw_frame(View<const Gray> left, View<const Rgb> left_rgb, const Frame& frame,
                      const Provenance& provenance, const std::optional<FloorWithSteps>& floor) {
  std::vector<DrawnStep> steps;
  if (floor) steps = drawn_steps(floor->steps, floor->frame, *provenance.rig);
  return draw_objects(left, left_rgb, frame.objects, frame.floor, steps);
}

// ---- the folder ----

/// A folder that is deleted with its content unless it is kept.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const fs::path& parent) {
    std::random_device random;
    std::error_code error;
    for (int attempt = 0; attempt < 100; ++attempt) {
      path_ = parent / (".cairn-" + std::to_string(random()));
      if (fs::create_directory(path_, error)) return;
      if (error) break;
    }
    throw Error(parent.string() + ": cannot write into this folder (" + error.message() + ")");
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Creates the missing parents of a folder; removes them again unless they are kept.
class Ancestors {
 public:
  explicit Ancestors(const fs::path& folder) {
    std::error_code ignored;
    for (fs::path p = folder; !p.empty() && !fs::exists(p, ignored); p = p.parent_path()) {
      made_.push_back(p);
      if (p == p.parent_path()) break;
    }
    io::make_folder(folder);
  }
  Ancestors(const Ancestors&) = delete;
  Ancestors& operator=(const Ancestors&) = delete;
  ~Ancestors() {
    if (kept_) return;
    std::error_code ignored;
    for (const fs::path& p : made_) fs::remove(p, ignored);  // innermost first; non-empty ones remain
  }
  void keep() { kept_ = true; }

 private:
  std::vector<fs::path> made_;
  bool kept_ = false;
};

// ---- its files ----

/// The data for the files of a result.
struct Result {
  View<const Gray> left;
  View<const Rgb> left_rgb;
  const Frame& frame;
  const Provenance& provenance;
  Extras extras;
  std::optional<FloorWithSteps> floor{};
  std::optional<ObstacleGrid> grid{};  // if wanted and known
};

void write_disparity(const fs::path& path, const Result& r) {
  io::save_disparity(path, r.frame.disparity.disparity_px);
}

void write_objects(const fs::path& path, const Result& r) {
  const View<const ObjectId> labels = r.frame.objects.labels;
  Image<std::uint16_t> ids(labels.size());
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const std::int32_t id = number(labels(x, y));
      if (id > std::numeric_limits<std::uint16_t>::max()) {
        throw Error(path.parent_path().string() +
                    ": more than 65535 objects do not fit into objects.png; raise objects.min_area");
      }
      ids(x, y) = static_cast<std::uint16_t>(id);
    }
  }
  io::save_png(path, View<const std::uint16_t>(ids));
}

void write_cloud(const fs::path& path, const Result& r) {
  io::save_ply(path, r.left, r.left_rgb, r.frame.disparity.disparity_px, r.frame.objects.labels,
               *r.provenance.rig);
}

// ---- depth and the grid of obstacles ----

bool wants_depth(const Result& r) {
  return r.extras.depth && r.provenance.rig.has_value();
}

Image<float> depth_m(const Result& r) {
  const View<const float> d = r.frame.disparity.disparity_px;
  Image<float> depth(d.size());
  for (int y = 0; y < d.height(); ++y) {
    for (int x = 0; x < d.width(); ++x) {
      const auto point =
          r.provenance.rig->point_in_camera_m(static_cast<float>(x), static_cast<float>(y), d(x, y));
      depth(x, y) = point ? point->z : std::numeric_limits<float>::quiet_NaN();
    }
  }
  return depth;
}

/// In mm; 0 without depth, or beyond 16 bits.
void save_depth(const fs::path& path, const Image<float>& depth) {
  Image<std::uint16_t> millimetres(depth.size());
  for (int y = 0; y < depth.height(); ++y) {
    std::transform(depth.row(y), depth.row(y) + depth.width(), millimetres.row(y), [](float metres) {
      const float whole = std::round(metres * 1000);
      return whole > 0 && whole <= 65535 ? static_cast<std::uint16_t>(whole) : std::uint16_t{0};
    });
  }
  io::save_png(path, View<const std::uint16_t>(millimetres));
}

/// NumPy's format, version 1.0, for a matrix of 32-bit floats.
std::string npy_bytes(View<const float> image) {
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (" +
                       std::to_string(image.height()) + ", " + std::to_string(image.width()) + "), }";
  constexpr std::size_t kBefore = 10;  // bytes; the whole header is a multiple of 64
  header.resize((kBefore + header.size() + 1 + 63) / 64 * 64 - kBefore - 1, ' ');
  header += '\n';
  std::string bytes("\x93NUMPY\x01\x00", 8);
  bytes += static_cast<char>(header.size() & 0xff);
  bytes += static_cast<char>(header.size() >> 8);
  bytes += header;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const auto bits = std::bit_cast<std::uint32_t>(image(x, y));
      for (unsigned shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(bits >> shift & 0xff);
    }
  }
  return bytes;
}

bool has_grid(const Result& r) {
  return r.grid.has_value();
}

/// In the format of ROS map_server: the row with the greatest y first.
std::string grid_pgm(const ObstacleGrid& grid) {
  constexpr char kUnknown = static_cast<char>(205);
  constexpr char kFree = static_cast<char>(254);
  std::string bytes = "P5\n" + std::to_string(grid.width) + " " + std::to_string(grid.height) + "\n255\n";
  for (int row = grid.height; row-- > 0;) {
    for (int column = 0; column < grid.width; ++column) {
      const std::int8_t cell = grid.cells[slot(row) * slot(grid.width) + slot(column)];
      bytes += cell == ObstacleGrid::kUnknown ? kUnknown : cell == ObstacleGrid::kFree ? kFree : '\0';
    }
  }
  return bytes;
}

std::string grid_yaml(const ObstacleGrid& grid) {
  return "image: grid.pgm\nresolution: " + json(grid.cell_size_m).dump() + "\norigin: [" +
         json(grid.origin_x_m).dump() + ", " + json(grid.origin_y_m).dump() +
         ", 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
}

bool always(const Result&) {
  return true;
}

struct ResultFile {
  const char* name;
  bool (*is_wanted)(const Result&);
  void (*write)(const fs::path&, const Result&);
};

/// All possible files of a result: those to write, and old ones to remove. In the order in which they are
/// moved into place: objects.json last, so that it never describes other files.
constexpr std::array kResultFiles{
    ResultFile{"disparity.png",
               [](const Result& r) { return disparity_file_name(r.frame, r.provenance) == "disparity.png"; },
               write_disparity},
    ResultFile{"disparity.pfm",
               [](const Result& r) { return disparity_file_name(r.frame, r.provenance) == "disparity.pfm"; },
               write_disparity},
    ResultFile{"reject.png", always,
               [](const fs::path& path, const Result& r) {
                 io::save_png(path, View<const Reject>(r.frame.disparity.reject));
               }},
    ResultFile{"confidence.png", [](const Result& r) { return !r.frame.confidence.empty(); },
               [](const fs::path& path, const Result& r) { save_confidence(path, r.frame.confidence); }},
    ResultFile{"objects.png", always, write_objects},
    ResultFile{"floor.png", [](const Result& r) { return !r.frame.floor.empty(); },
               [](const fs::path& path, const Result& r) {
                 io::save_png(path, View<const std::uint8_t>(r.frame.floor));
               }},
    ResultFile{"space.png", [](const Result& r) { return !r.frame.space.empty(); },
               [](const fs::path& path, const Result& r) {
                 io::save_png(path, View<const ObstacleLabel>(r.frame.space));
               }},
    ResultFile{"depth.png", wants_depth,
               [](const fs::path& path, const Result& r) { save_depth(path, depth_m(r)); }},
    ResultFile{"depth.npy", wants_depth,
               [](const fs::path& path, const Result& r) {
                 const Image<float> depth = depth_m(r);
                 io::write_file(path, npy_bytes(depth));
               }},
    ResultFile{"grid.pgm", has_grid,
               [](const fs::path& path, const Result& r) { io::write_file(path, grid_pgm(*r.grid)); }},
    ResultFile{"grid.yaml", has_grid,
               [](const fs::path& path, const Result& r) { io::write_file(path, grid_yaml(*r.grid)); }},
    ResultFile{"overlay.png", always,
               [](const fs::path& path, const Result& r) {
                 const Image<Rgb> picture = draw_frame(r.left, r.left_rgb, r.frame, r.provenance, r.floor);
                 io::save_png(path, View<const Rgb>(picture));
               }},
    ResultFile{"disparity_view.png", always,
               [](const fs::path& path, const Result& r) {
                 const Image<Rgb> picture =
                     draw_disparity(r.frame.disparity, r.provenance.rig,
                                    reasons_in_force(r.provenance.config, r.provenance.external_disparity));
                 io::save_png(path, View<const Rgb>(picture));
               }},
    ResultFile{"cloud.ply",
               [](const Result& r) { return r.extras.point_cloud && r.provenance.rig.has_value(); },
               write_cloud},
    ResultFile{"objects.json", always, [](const fs::path& path, const Result& r) {
                 io::write_file(path, file_text(document_of(r.frame, r.provenance, r.floor)));
               }}};

/// The folder with one file per object.
constexpr const char* kObjectClouds = "objects";

bool wants_object_clouds(const Result& r) {
  return r.extras.object_clouds && r.provenance.rig.has_value();
}

void write_files(const fs::path& folder, const Result& result) {
  for (const ResultFile& file : kResultFiles) {
    if (file.is_wanted(result)) file.write(folder / file.name, result);
  }
  if (wants_object_clouds(result)) {
    io::save_object_plys(folder / kObjectClouds, result.left, result.left_rgb,
                         result.frame.disparity.disparity_px, result.frame.objects, *result.provenance.rig);
  }
}

/// Whether save_object_plys() gives such a name.
bool is_object_cloud(const fs::path& path) {
  const std::string name = path.stem().string();
  return path.extension() == ".ply" &&
         std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Like replace(), but keeps other files of the folder.
void replace_object_clouds(const fs::path& made, const fs::path& folder) {
  std::vector<fs::path> older;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    if (is_object_cloud(entry.path())) older.push_back(entry.path());
  }
  for (const fs::path& path : older) fs::remove(path);
  if (!fs::exists(made)) {
    if (!older.empty()) fs::remove(folder, ignored);  // unless it contains other files
    return;
  }
  fs::create_directory(folder);
  for (const auto& entry : fs::directory_iterator(made))
    fs::rename(entry.path(), folder / entry.path().filename());
}

/// Moves a complete result over an older one, file by file.
void replace(const fs::path& made, const fs::path& folder) {
  replace_object_clouds(made / kObjectClouds, folder / kObjectClouds);
  for (const ResultFile& file : kResultFiles) {
    if (fs::exists(made / file.name)) {
      fs::rename(made / file.name, folder / file.name);
    } else {
      fs::remove(folder / file.name);
    }
  }
}

}  // namespace

Json json_of(const Config& config) {
  Json all = Json::object();
  for (const OptionInfo& option : active_options(config)) {
    const std::size_t dot = option.name.find('.');
    all[option.name.substr(0, dot)][option.name.substr(dot + 1)] = option_value(option);
  }
  return all;
}

Json json_of(const Frame& frame, const Provenance& provenance) {
  return document_of(frame, provenance, floor_with_steps(frame, provenance));
}

std::string objects_json(const Frame& frame, const Provenance& provenance) {
  return file_text(json_of(frame, provenance));
}

Image<Rgb> draw_frame(View<const Gray> left, View<const Rgb> left_rgb, const Frame& frame,
                      const Provenance& provenance) {
  return draw_frame(left, left_rgb, frame, provenance, floor_with_steps(frame, provenance));
}

std::string frame_row(const std::string& name, const Frame& frame, const Provenance& provenance) {
  Json j;
  j["frame"] = name;
  if (provenance.stamp_ns) j["stamp_ns"] = *provenance.stamp_ns;
  j["image"] = size_json(frame);
  j["rig"] = json(provenance.rig);
  add_findings(j, frame, provenance, floor_with_steps(frame, provenance));
  return j.dump();
}

std::string disparity_file_name(const Frame& frame, const Provenance& provenance) {
  const bool png =
      provenance.external_disparity
          ? io::png_can_hold(View<const float>(frame.disparity.disparity_px))
          : io::png_can_hold(provenance.config.match.min_disparity, provenance.config.match.num_disparities);
  return png ? "disparity.png" : "disparity.pfm";
}

void save_confidence(const fs::path& path, View<const float> confidence) {
  Image<std::uint8_t> bytes(confidence.size());
  for (int y = 0; y < bytes.height(); ++y) {
    std::transform(confidence.row(y), confidence.row(y) + bytes.width(), bytes.row(y),
                   [](float c) { return static_cast<std::uint8_t>(std::lround(255.0F * c)); });
  }
  io::save_png(path, View<const std::uint8_t>(bytes));
}

void write_result(const fs::path& given_folder, View<const Gray> left, View<const Rgb> left_rgb,
                  const Frame& frame, const Provenance& provenance, Extras extras) {
  std::error_code failed;
  // Absolute and without a trailing slash, so that every folder has a parent.
  fs::path folder = fs::absolute(given_folder, failed).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  Result result{left, left_rgb, frame, provenance, extras, floor_with_steps(frame, provenance)};
  if (extras.grid && result.floor) {
    result.grid = map_obstacles(frame, result.floor->steps, result.floor->frame, *provenance.rig,
                                provenance.config.obstacles);
  }
  try {
    if (fs::exists(folder)) {
      if (!fs::is_directory(folder)) throw Error(given_folder.string() + ": is a file, expected a folder");
      const fs::path clouds = folder / kObjectClouds;
      if (extras.object_clouds && fs::exists(clouds) && !fs::is_directory(clouds))
        throw Error(clouds.string() + ": is a file, expected a folder");
      const TemporaryFolder made(folder);  // inside the folder: one next to it might be on another disk
      write_files(made.path(), result);
      replace(made.path(), folder);
      return;
    }
    Ancestors ancestors(folder.parent_path());
    const TemporaryFolder made(folder.parent_path());
    write_files(made.path(), result);
    fs::rename(made.path(), folder);
    ancestors.keep();
  } catch (const fs::filesystem_error& error) {
    throw Error(given_folder.string() + ": cannot write the result (" + error.code().message() + ")");
  }
}

void remove_result(const fs::path& folder) {
  std::error_code unimportant;
  if (!fs::exists(folder / "objects.json", unimportant)) return;
  try {
    replace(folder / "nothing", folder);
  } catch (const fs::filesystem_error& error) {
    throw Error(folder.string() + ": cannot remove the older result (" + error.code().message() + ")");
  }
  fs::remove(folder, unimportant);  // unless it contains other files
}

namespace {

/// JSON's integer conversions do not check the range.
ObjectId id_of(const nlohmann::json& value) {
  constexpr std::int64_t kMax = 65'535;
  if (!value.is_number_integer() || value < 1 || value > kMax) {
    throw Error("an object's `id` is " + (value.is_number() ? value.dump() : std::string("no number")) +
                ", expected a whole number from 1 to " + std::to_string(kMax));
  }
  return ObjectId{value.get<std::int32_t>()};
}

}  // namespace

std::vector<ObjectConfidence> load_confidences(const fs::path& path) {
  constexpr std::size_t kMax = std::size_t{256} << 20;
  const std::string text = io::read_file(path, kMax);
  try {
    std::vector<ObjectConfidence> all;
    const auto whole = nlohmann::json::parse(text);
    for (const auto& object : whole.at("objects")) {
      all.push_back({id_of(object.at("id")), object.at("confidence").get<double>()});
    }
    return all;
  } catch (const Error& error) {
    throw Error(path.string() + ": " + error.what());
  } catch (const nlohmann::json::exception&) {
    throw Error(path.string() +
                ": not an objects.json of cairn, expected a list `objects` with `id` and `confidence`");
  }
}

}  // namespace cairn::output
