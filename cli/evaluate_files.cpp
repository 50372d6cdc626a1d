// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "evaluate_files.hpp"

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/read_file.hpp>
#include <cairn/output/results.hpp>

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

std::optional<fs::path> file_in(const fs::path& folder, const char* name) {
  std::error_code ignored;
  return fs::is_regular_file(folder / name, ignored) ? std::optional(folder / name) : std::nullopt;
}

/// A map for the page; it must have the size of the earlier ones.
class SizeCheck {
 public:
  void operator()(const fs::path& path, Size size) {
    if (first_) require_equal_size(path, size, *first_, size_);
    first_ = path;
    size_ = size;
  }

 private:
  std::optional<fs::path> first_;
  Size size_;
};

/// The frame's left image: in the truth's folder, or next to it under the result's name.
std::optional<fs::path> left_picture(const fs::path& truth_folder, const std::string& name) {
  for (const fs::path& folder : {truth_folder, truth_folder.parent_path() / name}) {
    try {
      const std::vector<io::FrameFiles> frames = io::find_frames(folder);
      for (const io::FrameFiles& frame : frames) {
        if (frame.folder == folder && (frames.size() == 1 || frame.name == name)) return frame.left;
      }
    } catch (const Error&) {
      continue;  // truth without an image is valid
    }
  }
  return std::nullopt;
}

template <class T, class Convert>
Image<T> converted(const io::Labels& labels, const Convert& convert) {
  Image<T> map(labels.ids.size());
  for (int y = 0; y < map.height(); ++y) {
    std::transform(labels.ids.row(y), labels.ids.row(y) + map.width(), map.row(y), convert);
  }
  return map;
}

}  // namespace

std::optional<ResultFiles> result_in(const fs::path& folder) {
  ResultFiles files;
  files.name = folder.filename().string();
  files.objects = file_in(folder, "objects.png");
  files.disparity = file_in(folder, "disparity.png");
  if (!files.disparity) files.disparity = file_in(folder, "disparity.pfm");
  files.reject = file_in(folder, "reject.png");
  files.confidence = file_in(folder, "confidence.png");
  files.space = file_in(folder, "space.png");
  files.json = file_in(folder, "objects.json");
  if (!files.objects && !files.disparity) return std::nullopt;
  return files;
}

Image<ObjectId> ours_of(const io::Labels& labels) {
  return converted<ObjectId>(labels, [](std::uint16_t id) { return ObjectId{id}; });
}

void require_equal_size(const fs::path& ours, Size our_size, const fs::path& theirs, Size their_size) {
  if (our_size == their_size) return;
  throw Error(ours.string() + ": is " + text(our_size) + ", the truth " + theirs.string() + " is " +
              text(their_size));
}

namespace {

/// Reads a map of the result or the truth, if there is one, and lets the page show it.
template <class T, class Load>
Image<T> shown_map(const std::optional<fs::path>& path, Load load, SizeCheck& check, View<const T>& shown) {
  if (!path) return {};
  Image<T> map = load(*path);
  check(*path, map.size());
  shown = map;
  return map;
}

}  // namespace

output::EncodedFrame encode_frame(const ResultFiles& result, const io::TruthFiles& truth) {
  SizeCheck check;
  output::PageFrame shown;
  shown.name = result.name;
  const std::optional<fs::path> none;
  const auto objects = shown_map<ObjectId>(
      result.objects, [](const fs::path& path) { return ours_of(io::load_labels(path)); }, check,
      shown.objects);
  const auto true_objects = shown_map<TruthId>(
      truth.objects, [](const fs::path& path) { return io::truth_ids(io::load_labels(path)); }, check,
      shown.true_objects);
  const auto load_disparity = [](const fs::path& path) { return io::load_disparity(path); };
  const auto disparity = shown_map<float>(result.disparity, load_disparity, check, shown.disparity_px);
  const auto true_disparity =
      shown_map<float>(truth.disparity, load_disparity, check, shown.true_disparity_px);
  const auto reject = shown_map<Reject>(
      result.disparity ? result.reject : none,
      [](const fs::path& path) {
        return converted<Reject>(io::load_labels(path),
                                 [](std::uint16_t bits) { return static_cast<Reject>(bits); });
      },
      check, shown.reject);
  const auto confidence = shown_map<float>(
      result.disparity ? result.confidence : none,
      [](const fs::path& path) {
        return converted<float>(io::load_labels(path),
                                [](std::uint16_t c) { return static_cast<float>(c & 0xff) / 255; });
      },
      check, shown.confidence);
  const auto space = shown_map<ObstacleLabel>(
      result.space,
      [](const fs::path& path) {
        return converted<ObstacleLabel>(io::load_labels(path), [](std::uint16_t value) {
          return static_cast<ObstacleLabel>(value & 0xff);
        });
      },
      check, shown.space);
  io::LoadedImage left;
  if (const auto path = left_picture(truth.folder, result.name)) {
    left = io::load_picture(*path);
    check(*path, left.gray.size());
    shown.left = left.gray;
    shown.left_rgb = left.rgb;
  }
  if (result.json) {
    (void)output::load_confidences(*result.json);  // rejects a file that is no objects.json, with its name
    constexpr std::size_t kMax = std::size_t{256} << 20;
    shown.objects_json = io::read_file(*result.json, kMax);
  }
  return output::encode_frame(shown);
}

}  // namespace cairn::cli
