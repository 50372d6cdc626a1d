// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/number_text.hpp>
#include <cairn/io/calibration_forms.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/io/names_and_numbers.hpp>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <system_error>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;

// TIFF is included so that reading it gives a helpful message. These are the names searched for.
constexpr std::array kPictureExtensions = {".png", ".jpg", ".jpeg", ".pgm", ".ppm", ".pnm", ".tif", ".tiff",
                                           ".PNG", ".JPG", ".JPEG", ".PGM", ".PPM", ".PNM", ".TIF", ".TIFF"};
constexpr std::array kCalibrations = {"calib.txt", "calib.yaml", "calib.yml",           "calib.json",
                                      "calib.xml", "left.yaml",  "calib_cam_to_cam.txt"};

/// The image names of data sets; the first pair found is used. Folders of Middlebury with im2 and im6 also
/// have im0 and im1.
struct Names {
  const char* left;
  const char* right;
};
constexpr std::array kPairs = {Names{"left", "right"}, Names{"Left", "Right"}, Names{"im2", "im6"},
                               Names{"view1", "view5"}, Names{"im0", "im1"}};
/// Middlebury 2014 has disp0 and disp1 in a folder; disp0 belongs to the left image.
constexpr std::array kTrueDisparities = {"disp_left", "disp0GT", "disp0", "disp1", "disp2"};

// Of an RGB-D camera.
constexpr std::array kWithDepth = {"left", "rgb", "color", "colour", "image", "images", "infra1"};
constexpr double kTumUnitsPerMetre = 5000;

struct Folders {
  const char* left;
  const char* right;
  bool grey_cameras;
  Cameras cameras;
};
constexpr std::array kFolders = {Folders{"left", "right", false, Cameras::rectified},
                                 Folders{"Left", "Right", false, Cameras::rectified},
                                 Folders{"image_left", "image_right", false, Cameras::rectified},
                                 Folders{"image_2", "image_3", false, Cameras::rectified},
                                 Folders{"image_02/data", "image_03/data", false, Cameras::rectified},
                                 Folders{"colored_0", "colored_1", false, Cameras::rectified},
                                 Folders{"image_0", "image_1", true, Cameras::rectified},
                                 Folders{"image_00/data", "image_01/data", true, Cameras::rectified},
                                 Folders{"cam0/data", "cam1/data", false, Cameras::raw},
                                 Folders{"mav0/cam0/data", "mav0/cam1/data", false, Cameras::raw}};

bool is_file(const fs::path& path) {
  std::error_code unknown;
  return fs::is_regular_file(path, unknown);
}

std::optional<fs::path> file(const fs::path& path) {
  if (is_file(path)) return path;
  return std::nullopt;
}

std::optional<fs::path> picture(const fs::path& folder, const std::string& stem) {
  for (const char* extension : kPictureExtensions) {
    if (std::optional<fs::path> found = file(folder / (stem + extension))) return found;
  }
  return std::nullopt;
}

/// Absolute and without a trailing slash, so that it has a name and a parent.
fs::path clean(const fs::path& folder) {
  fs::path path = fs::absolute(folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

fs::path truth_beside(const fs::path& folder) {
  return clean(folder).parent_path() / "gt";
}

/// The frame's own file, else the one next to the truth.
std::optional<fs::path> calibration_of(const fs::path& folder) {
  std::optional<fs::path> calib = calibration_in(folder);
  return calib ? calib : calibration_in(truth_beside(folder));
}

/// The map with this name, without its extension.
std::optional<fs::path> map_file(const fs::path& stem) {
  for (const char* extension : {".png", ".pfm", ".npy"}) {
    if (std::optional<fs::path> found = file(stem.string() + extension)) return found;
  }
  return std::nullopt;
}

std::optional<GivenMap> depth_image(const fs::path& stem) {
  const std::optional<fs::path> path = map_file(stem);
  return path ? std::optional(GivenMap{*path, kDepthUnitsPerMetre}) : std::nullopt;
}

std::optional<FrameFiles> frame_in(const fs::path& folder) {
  for (const auto& [left_name, right_name] : kPairs) {
    const std::optional<fs::path> left = picture(folder, left_name);
    if (!left) continue;
    const fs::path expected = folder / (right_name + left->extension().string());
    std::optional<fs::path> right = file(expected);
    if (!right) right = picture(folder, right_name);
    if (!right && picture(folder, "im0") && left_name == std::string_view("im2")) continue;
    FrameFiles frame{
        clean(folder).filename().string(), folder, *left, right, calibration_of(folder), expected};
    if (!right) frame.given = depth_image(folder / "depth");
    if (const auto map = map_file(folder / "disparity"); !right && !frame.given && map)
      frame.given = GivenMap{*map};
    return frame;
  }
  for (const char* name : kWithDepth) {
    const std::optional<fs::path> left = picture(folder, name);
    const std::optional<GivenMap> depth = depth_image(folder / "depth");
    if (!left || !depth) continue;
    FrameFiles frame{clean(folder).filename().string(), folder, *left, {}, calibration_of(folder)};
    frame.given = depth;
    return frame;
  }
  return std::nullopt;
}

std::optional<fs::path> true_disparity_in(const fs::path& folder) {
  for (const std::string name : kTrueDisparities) {
    for (const char* extension : {".png", ".pfm", ".pgm"}) {
      if (std::optional<fs::path> found = file(folder / (name + extension))) return found;
    }
  }
  return std::nullopt;
}

std::optional<TruthFiles> truth_in(const fs::path& folder) {
  TruthFiles truth;
  truth.folder = folder;
  truth.objects = file(folder / "objects.png");
  truth.disparity = true_disparity_in(folder);
  if (!truth.objects && !truth.disparity) return std::nullopt;
  truth.occlusion = file(folder / "occlusion.png");
  if (!truth.occlusion) truth.occlusion = file(folder / "mask0nocc.png");
  truth.ground = file(folder / "ground.png");
  truth.ground_plane = file(folder / "ground.txt");
  truth.calib = calibration_in(folder);
  std::error_code unknown;
  truth.partial = fs::exists(folder / "partial", unknown);
  return truth;
}

/// KITTI 2015 (disp_occ_0) and 2012 (disp_occ).
std::optional<TruthFiles> kitti_truth(const fs::path& folder, const std::string& name) {
  for (const auto& [all, seen] : {std::pair{"disp_occ_0", "disp_noc_0"}, std::pair{"disp_occ", "disp_noc"}}) {
    TruthFiles truth;
    truth.folder = folder;
    truth.disparity = file(folder / all / (name + ".png"));
    truth.occlusion = file(folder / seen / (name + ".png"));
    if (truth.disparity) return truth;
  }
  return std::nullopt;
}

void check_folder(const fs::path& folder) {
  std::error_code reason;
  if (fs::is_directory(folder, reason)) return;
  throw Error(folder.string() + ": " +
              (fs::exists(folder, reason) ? "is not a folder, expected one" : "no such folder"));
}

/// The results of `visit` for each entry, in natural order of their names. Throws Error if the folder cannot
/// be listed.
template <class Visit>
std::vector<FrameFiles> each_in(const fs::path& folder, const Visit& visit) {
  std::vector<FrameFiles> frames;
  std::error_code reason;
  for (fs::directory_iterator it(folder, reason), end; !reason && it != end; it.increment(reason)) {
    if (is_hidden(it->path())) continue;
    if (std::optional<FrameFiles> frame = visit(it->path())) frames.push_back(std::move(*frame));
  }
  if (reason) throw Error(folder.string() + ": cannot be listed: " + reason.message());
  std::sort(frames.begin(), frames.end(),
            [](const FrameFiles& a, const FrameFiles& b) { return in_natural_order(a.name, b.name); });
  return frames;
}

std::vector<FrameFiles> frames_below(const fs::path& folder) {
  return each_in(folder, [](const fs::path& path) -> std::optional<FrameFiles> {
    return is_folder(path) ? frame_in(path) : std::nullopt;
  });
}

/// The right image for a left one, by its name.
std::optional<fs::path> partner(const fs::path& left) {
  if (left.filename().string().starts_with("disp")) return std::nullopt;
  return right_named_like(left);
}

/// The calibration of one frame of many: KITTI has a file per frame, named by the part before the _, and one
/// above the folders of its raw recordings.
std::optional<fs::path> calibration_among(const fs::path& folder, const fs::path& left) {
  const std::string stem = left.stem().string();
  const std::string number = stem.substr(0, stem.find('_')) + ".txt";
  for (const char* files : {"calib_cam_to_cam", "calib"}) {
    if (std::optional<fs::path> found = file(folder / files / number)) return found;
  }
  if (std::optional<fs::path> found = calibration_of(folder)) return found;
  return file(clean(folder).parent_path() / "calib_cam_to_cam.txt");
}

bool is_pair(const FrameFiles& frame) {
  return frame.right.has_value();
}

/// The pairs; the left images of the others go to `alone`.
std::vector<FrameFiles> pairs_among(std::vector<FrameFiles> all, std::vector<fs::path>& alone) {
  for (const FrameFiles& frame : all) {
    if (!is_pair(frame)) alone.push_back(frame.left);
  }
  std::erase_if(all, std::not_fn(is_pair));
  return all;
}

/// left01.jpg and right01.jpg.
std::vector<FrameFiles> pairs_of_names(const fs::path& folder, std::vector<fs::path>& alone) {
  const std::optional<fs::path> calib = calibration_of(folder);
  std::vector<FrameFiles> all = each_in(folder, [&](const fs::path& left) -> std::optional<FrameFiles> {
    if (!is_picture(left)) return std::nullopt;
    const std::optional<fs::path> right = partner(left);
    if (!right) return std::nullopt;
    return FrameFiles{left.stem().string(), folder, left, file(*right), calib, *right};
  });
  return pairs_among(std::move(all), alone);
}

/// left/01.jpg and right/01.jpg, image_left/01_left.png and image_right/01_right.png. Without any pair, the left images alone.
std::vector<FrameFiles> pairs_in(const fs::path& folder, const Folders& names, std::vector<fs::path>& alone) {
  std::vector<FrameFiles> all =
      each_in(folder / names.left, [&](const fs::path& left) -> std::optional<FrameFiles> {
        if (!is_picture(left)) return std::nullopt;
        fs::path right = folder / names.right / left.filename();
        const std::optional<fs::path> renamed = partner(left);
        if (!is_file(right) && renamed) right = folder / names.right / renamed->filename();
        return FrameFiles{
            left.stem().string(), folder, left, file(right), calibration_among(folder, left), right,
            names.grey_cameras};
      });
  return std::any_of(all.begin(), all.end(), is_pair) ? pairs_among(std::move(all), alone) : all;
}

/// The names of TUM RGB-D are stamps in s.
std::optional<double> seconds_in(const fs::path& path) {
  const std::string stem = path.stem().string();
  double seconds = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), seconds);
  const bool is_number = error == std::errc{} && end == stem.data() + stem.size();
  return is_number && stem.find('.') != std::string::npos ? std::optional(seconds) : std::nullopt;
}

/// The depth image nearest in time.
std::optional<fs::path> nearest_in_time(const std::map<double, fs::path>& depths, const fs::path& image) {
  constexpr double kMaxSkew = 0.02;  // s, as the tools of that data set
  const std::optional<double> stamp = seconds_in(image);
  if (!stamp || depths.empty()) return std::nullopt;
  auto best = depths.lower_bound(*stamp);
  if (best == depths.end() ||
      (best != depths.begin() && *stamp - std::prev(best)->first < best->first - *stamp))
    --best;
  return std::abs(best->first - *stamp) <= kMaxSkew ? std::optional(best->second) : std::nullopt;
}

/// rgb/01.png and depth/01.png.
std::vector<FrameFiles> frames_with_depth(const fs::path& folder, std::vector<fs::path>& alone) {
  const auto* const images =
      std::ranges::find_if(kWithDepth, [&](const char* name) { return is_folder(folder / name); });
  if (images == kWithDepth.end() || !is_folder(folder / "depth") || is_folder(folder / "right")) return {};
  const bool is_tum = is_file(folder / "rgb.txt") || is_file(folder / "associations.txt");
  std::map<double, fs::path> by_time;
  for (const fs::path& path : images_in(folder / "depth")) {
    if (const auto stamp = seconds_in(path)) by_time.emplace(*stamp, path);
  }
  const std::optional<fs::path> calib = calibration_of(folder);
  std::vector<FrameFiles> frames =
      each_in(folder / *images, [&](const fs::path& image) -> std::optional<FrameFiles> {
        if (!is_picture(image)) return std::nullopt;
        std::optional<fs::path> depth = map_file(folder / "depth" / image.stem());
        if (!depth) depth = nearest_in_time(by_time, image);
        FrameFiles frame{image.stem().string(), folder, image, {}, calib};
        if (depth) frame.given = GivenMap{*depth, is_tum ? kTumUnitsPerMetre : kDepthUnitsPerMetre};
        return frame;
      });
  for (const FrameFiles& frame : frames)
    if (!frame.given) alone.push_back(frame.left);
  std::erase_if(frames, [](const FrameFiles& frame) { return !frame.given; });
  return frames;
}

std::vector<FrameFiles> pairs_by_name(const fs::path& folder, Cameras cameras, std::vector<fs::path>& alone) {
  if (auto frames = frames_with_depth(folder, alone); !frames.empty()) return frames;
  for (const Folders& names : kFolders) {
    if (!is_folder(folder / names.left)) continue;
    std::vector<FrameFiles> pairs = pairs_in(folder, names, alone);
    if (pairs.empty()) continue;
    if (names.cameras == Cameras::raw && cameras == Cameras::rectified) {
      const fs::path sensor = (folder / names.left).parent_path() / "sensor.yaml";
      throw Error(folder.string() + ": contains EuRoC's raw images (" + names.left + ", " + names.right +
                  "), expected rectified ones: cairn rectify " + folder.string() + " --calib " +
                  sensor.string() + " -o DIR does that");
    }
    return pairs;
  }
  return pairs_of_names(folder, alone);
}

/// Empty if there is none.
std::vector<FrameFiles> frames_in(const fs::path& folder, Cameras cameras, std::vector<fs::path>& alone) {
  if (std::optional<FrameFiles> frame = frame_in(folder)) return {*frame};
  std::vector<FrameFiles> frames = frames_below(folder);
  return frames.empty() ? pairs_by_name(folder, cameras, alone) : frames;
}

void give_maps_in(const fs::path& maps, const std::string& option, std::vector<FrameFiles>& frames,
                  std::optional<double> depth_units_per_m) {
  const bool are_many = is_folder(maps);
  if (frames.size() > 1 && !are_many) {
    throw Error(option + " " + maps.string() + ": one map for the " + std::to_string(frames.size()) +
                " frames of " + frames.front().folder.string() + "; give a folder of maps, or one frame");
  }
  bool has_any = false;
  for (FrameFiles& frame : frames) {
    std::optional<fs::path> path = maps;
    if (are_many) path = map_file(maps / frame.name);
    if (!path) path = map_file(maps / frame.name / (depth_units_per_m ? "depth" : "disparity"));
    frame.given = path ? std::optional(GivenMap{*path, depth_units_per_m}) : std::nullopt;
    has_any = has_any || path;
  }
  if (!has_any) {
    const std::string& name = frames.front().name;
    throw Error(option + " " + maps.string() + ": has no map of the frame " + name + ", expected " + name +
                ".png, .pfm or .npy");
  }
}

/// The subfolder with frames, as in several data sets.
std::optional<fs::path> frames_deeper(const fs::path& folder) {
  std::optional<fs::path> first;
  std::vector<fs::path> alone;
  std::error_code reason;
  for (fs::directory_iterator it(folder, reason), end; !reason && it != end; it.increment(reason)) {
    if (is_folder(it->path()) && (!first || it->path() < *first) &&
        !frames_in(it->path(), Cameras::raw, alone).empty()) {
      first = it->path();
    }
  }
  return first;
}

}  // namespace

std::optional<fs::path> calibration_in(const fs::path& folder) {
  for (const char* name : kCalibrations) {
    if (std::optional<fs::path> found = file(folder / name)) return found;
  }
  return std::nullopt;
}

bool is_picture(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return is_file(path) && !is_hidden(path) &&
         std::find(kPictureExtensions.begin(), kPictureExtensions.end(), extension) !=
             kPictureExtensions.end();
}

LoadedPair load_pair(const FrameFiles& files, const Pool& pool, int least_bits) {
  return load_pair(files.left, files.right.value(), files.layout, pool, least_bits);
}

std::vector<fs::path> images_in(const fs::path& folder) {
  std::vector<fs::path> images;
  std::error_code reason;
  for (fs::directory_iterator it(folder, reason), end; !reason && it != end; it.increment(reason)) {
    if (is_picture(it->path())) images.push_back(it->path());
  }
  if (reason) throw Error(folder.string() + ": cannot be listed: " + reason.message());
  std::sort(images.begin(), images.end(), [](const fs::path& a, const fs::path& b) {
    return in_natural_order(a.filename().string(), b.filename().string());
  });
  return images;
}

std::vector<FrameFiles> find_both(const fs::path& folder, Layout layout) {
  std::vector<FrameFiles> frames;
  const std::optional<fs::path> calib = calibration_in(folder);
  for (const fs::path& file : images_in(folder))
    frames.push_back({file.stem().string(), folder, file, file, calib, {}, false, layout});
  if (frames.empty())
    throw Error(folder.string() +
                ": contains no images, expected some with both images of a pair (--layout)");
  return frames;
}

std::vector<FrameFiles> find_frames(const fs::path& folder, Cameras cameras, std::vector<fs::path>* alone) {
  check_folder(folder);
  std::vector<fs::path> ignored;
  std::vector<FrameFiles> frames = frames_in(folder, cameras, alone != nullptr ? *alone : ignored);
  if (!frames.empty()) return frames;
  if (const std::optional<fs::path> deeper = frames_deeper(folder)) {
    throw Error(folder.string() + ": contains no left.png and no other frame, but " + deeper->string() +
                " does; give that folder");
  }
  throw Error(folder.string() +
              ": contains no left.png (.jpg .pgm .ppm), no folder with one, no pairs such as "
              "left01.png and right01.png, or left/01.png and right/01.png, and no known data set "
              "(docs/formats.md)");
}

void give_maps(std::vector<FrameFiles>& frames, const MapOptions& options) {
  const std::optional<double> units = options.depth_units_per_m;
  if (!options.disparity.empty() && !options.depth.empty())
    throw Error("--depth-image: found --disparity as well, expected one of the two");
  if (units && !(*units >= 1 && *units <= 1e6)) {
    throw Error("--depth-units: found " + shortest_text(*units) +
                ", expected units per metre, 1 ... 1e6 (1000: mm)");
  }
  if (!options.disparity.empty()) give_maps_in(options.disparity, "--disparity", frames, std::nullopt);
  if (!options.depth.empty()) give_maps_in(options.depth, "--depth-image", frames, kDepthUnitsPerMetre);
  if (!units) return;
  bool has_depth = false;
  for (FrameFiles& frame : frames) {
    if (!frame.given || !frame.given->depth_units_per_m) continue;
    has_depth = true;
    frame.given->depth_units_per_m = *units;
  }
  if (!has_depth) throw Error("--depth-units: there is no depth image that it could be of");
}

std::vector<FrameFiles> find_pairs(const fs::path& folder) {
  check_folder(folder);
  std::vector<fs::path> alone;
  std::vector<FrameFiles> pairs = pairs_by_name(folder, Cameras::raw, alone);
  return pairs.size() > 1 ? pairs : find_frames(folder, Cameras::raw);
}

TruthFiles find_truth(const fs::path& folder) {
  check_folder(folder);
  if (std::optional<TruthFiles> truth = truth_in(folder)) return *truth;
  if (std::optional<TruthFiles> truth = truth_in(truth_beside(folder))) return *truth;
  throw Error(folder.string() + ": contains no truth (objects.png or disp_left.png), nor does " +
              truth_beside(folder).string());
}

TruthFiles find_truth(const FrameFiles& frame) {
  if (std::optional<TruthFiles> truth = kitti_truth(frame.folder, frame.name)) return *truth;
  return find_truth(frame.folder);
}

TruthFiles find_truth(const fs::path& folder, const std::string& name) {
  if (std::optional<TruthFiles> truth = kitti_truth(folder, name)) return *truth;
  return find_truth(folder / name);
}

bool names_truth(const fs::path& folder, const std::string& name) {
  return is_folder(folder / name) || kitti_truth(folder, name);
}

Image<TruthId> truth_ids(const Labels& labels) {
  constexpr std::uint16_t kDontCare = 255;
  Image<TruthId> ids(labels.ids.size());
  const bool has_dont_care = labels.bits == 8;
  for (int y = 0; y < ids.height(); ++y) {
    std::transform(labels.ids.row(y), labels.ids.row(y) + ids.width(), ids.row(y), [&](std::uint16_t id) {
      return has_dont_care && id == kDontCare ? TruthId::dont_care : TruthId{id};
    });
  }
  return ids;
}

Image<std::uint8_t> load_hidden(const fs::path& path) {
  const Labels labels = load_labels(path);
  const bool is_mask = path.stem() == "mask0nocc";
  const bool is_map = path.parent_path().filename().string().starts_with("disp_noc");
  const auto is_hidden = [&](std::uint16_t value) {
    if (is_map) return value == 0;
    return (value == 255) != is_mask;
  };
  Image<std::uint8_t> hidden(labels.ids.size());
  for (int y = 0; y < hidden.height(); ++y) {
    std::transform(labels.ids.row(y), labels.ids.row(y) + hidden.width(), hidden.row(y),
                   [&](std::uint16_t value) { return static_cast<std::uint8_t>(is_hidden(value) ? 1 : 0); });
  }
  return hidden;
}

}  // namespace cairn::io
