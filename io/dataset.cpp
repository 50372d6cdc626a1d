// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <io/calibration_forms.hpp>
#include <io/dataset.hpp>
#include <system_error>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;

constexpr std::array kPictureExtensions = {".png", ".jpg", ".jpeg", ".pgm", ".ppm", ".pnm", ".tif", ".tiff",
                                           ".PNG", ".JPG", ".JPEG", ".PGM", ".PPM", ".PNM", ".TIF", ".TIFF"};
constexpr std::array kCalibrations = {"calib.txt", "calib.yaml", "calib.yml",           "calib.json",
                                      "calib.xml", "left.yaml",  "calib_cam_to_cam.txt"};

bool is_file(const fs::path& path) {
  std::error_code unknown;
  return fs::is_regular_file(path, unknown);
}

std::optional<fs::path> file(const fs::path& path) {
  if (is_file(path)) return path;
  return std::nullopt;
}

bool is_picture(const fs::path& path) {
  const std::string extension = path.extension().string();
  return is_file(path) && std::find(kPictureExtensions.begin(), kPictureExtensions.end(), extension) !=
                              kPictureExtensions.end();
}

std::optional<fs::path> picture(const fs::path& folder, const std::string& stem) {
  for (const char* extension : kPictureExtensions) {
    if (std::optional<fs::path> found = file(folder / (stem + extension))) return found;
  }
  return std::nullopt;
}

std::optional<fs::path> calibration(const fs::path& folder) {
  for (const char* name : kCalibrations) {
    if (std::optional<fs::path> found = file(folder / name)) return found;
  }
  return std::nullopt;
}

/// Without a slash at its end, "." written out: so that it has a name and a parent.
fs::path clean(const fs::path& folder) {
  fs::path path = fs::absolute(folder).lexically_normal();
  return path.has_filename() ? path : path.parent_path();
}

fs::path truth_beside(const fs::path& folder) {
  return clean(folder).parent_path() / "gt";
}

/// A frame's own, else that of the truth beside it.
std::optional<fs::path> calibration_of(const fs::path& folder) {
  std::optional<fs::path> calib = calibration(folder);
  return calib ? calib : calibration(truth_beside(folder));
}

std::optional<FrameFiles> frame_in(const fs::path& folder) {
  const std::optional<fs::path> left = picture(folder, "left");
  if (!left) return std::nullopt;
  std::optional<fs::path> right = file(folder / ("right" + left->extension().string()));
  if (!right) right = picture(folder, "right");
  return FrameFiles{clean(folder).filename().string(), folder, *left, right, calibration_of(folder)};
}

std::optional<TruthFiles> truth_in(const fs::path& folder) {
  TruthFiles truth;
  truth.folder = folder;
  truth.objects = file(folder / "objects.png");
  truth.disparity = file(folder / "disp_left.png");
  if (!truth.disparity) truth.disparity = file(folder / "disp_left.pfm");
  if (!truth.objects && !truth.disparity) return std::nullopt;
  truth.occlusion = file(folder / "occlusion.png");
  truth.ground = file(folder / "ground.png");
  truth.ground_plane = file(folder / "ground.txt");
  truth.calib = calibration(folder);
  std::error_code unknown;
  truth.partial = fs::exists(folder / "partial", unknown);
  return truth;
}

void check_folder(const fs::path& folder) {
  std::error_code reason;
  if (fs::is_directory(folder, reason)) return;
  throw Error(
      folder.string() + ": " +
      (fs::exists(folder, reason) ? "is no folder, expected one" : "is not there, expected a folder"));
}

/// What `visit` makes of each entry, sorted by name. Throws Error where the folder cannot be listed.
template <class Visit>
std::vector<FrameFiles> each_in(const fs::path& folder, const Visit& visit) {
  std::vector<FrameFiles> frames;
  std::error_code reason;
  for (fs::directory_iterator it(folder, reason), end; !reason && it != end; it.increment(reason)) {
    if (std::optional<FrameFiles> frame = visit(it->path())) frames.push_back(std::move(*frame));
  }
  if (reason) throw Error(folder.string() + ": cannot be listed: " + reason.message());
  std::sort(frames.begin(), frames.end(),
            [](const FrameFiles& a, const FrameFiles& b) { return a.name < b.name; });
  return frames;
}

std::vector<FrameFiles> frames_below(const fs::path& folder) {
  return each_in(folder, [](const fs::path& path) -> std::optional<FrameFiles> {
    std::error_code unknown;
    if (!fs::is_directory(path, unknown)) return std::nullopt;
    return frame_in(path);
  });
}

/// The right picture of a left one whose name says that it is one.
std::optional<fs::path> partner(const fs::path& left) {
  const std::string name = left.filename().string();
  const bool is_left = name.find("left") != std::string::npos && !name.starts_with("disp");
  return is_left ? other_camera(left) : std::nullopt;
}

/// left01.jpg and right01.jpg, or left/01.jpg and right/01.jpg.
std::vector<FrameFiles> pairs_by_name(const fs::path& folder) {
  const bool in_folders = fs::is_directory(folder / "left") && fs::is_directory(folder / "right");
  const std::optional<fs::path> calib = calibration_of(folder);
  return each_in(
      in_folders ? folder / "left" : folder, [&](const fs::path& left) -> std::optional<FrameFiles> {
        if (!is_picture(left)) return std::nullopt;
        const std::optional<fs::path> right = in_folders ? folder / "right" / left.filename() : partner(left);
        if (!right || !is_file(*right)) return std::nullopt;
        return FrameFiles{left.stem().string(), folder, left, *right, calib};
      });
}

}  // namespace

std::vector<FrameFiles> find_frames(const fs::path& folder) {
  check_folder(folder);
  if (std::optional<FrameFiles> frame = frame_in(folder)) return {*frame};
  std::vector<FrameFiles> frames = frames_below(folder);
  if (frames.empty()) frames = pairs_by_name(folder);
  if (frames.empty()) {
    throw Error(
        folder.string() +
        ": holds no left.png (.jpg .pgm .ppm .tif), nor does a folder in it, nor pairs such as left01.png "
        "and right01.png, or left/01.png and right/01.png");
  }
  return frames;
}

std::vector<FrameFiles> find_pairs(const fs::path& folder) {
  check_folder(folder);
  std::vector<FrameFiles> pairs = pairs_by_name(folder);
  return pairs.size() > 1 ? pairs : find_frames(folder);
}

TruthFiles find_truth(const fs::path& folder) {
  check_folder(folder);
  if (std::optional<TruthFiles> truth = truth_in(folder)) return *truth;
  if (std::optional<TruthFiles> truth = truth_in(truth_beside(folder))) return *truth;
  throw Error(folder.string() + ": holds no truth (objects.png or disp_left.png), nor does " +
              truth_beside(folder).string());
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

Image<std::uint8_t> hidden_pixels(const Labels& labels) {
  constexpr std::uint16_t kHidden = 255;
  Image<std::uint8_t> hidden(labels.ids.size());
  for (int y = 0; y < hidden.height(); ++y) {
    std::transform(labels.ids.row(y), labels.ids.row(y) + hidden.width(), hidden.row(y),
                   [](std::uint16_t id) { return static_cast<std::uint8_t>(id == kHidden ? 1 : 0); });
  }
  return hidden;
}

}  // namespace cairn::io
