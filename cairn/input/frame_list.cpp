// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/frame_list.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/number_text.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/frame_names.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <system_error>

#include <cairn/io/names_and_numbers.hpp>
#include <cairn/sequence/stamps.hpp>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;

constexpr double kUsualRateHz = 10;

bool is_file(const fs::path& path) {
  std::error_code unknown;
  return fs::is_regular_file(path, unknown);
}

// ---- one side with its stamps ----

struct Side {
  std::vector<fs::path> files;
  std::optional<std::vector<Stamp>> stamps;  // of each file
  std::string stamps_from;
};

std::optional<fs::path> first_file(std::initializer_list<fs::path> candidates) {
  for (const fs::path& candidate : candidates) {
    if (is_file(candidate)) return candidate;
  }
  return std::nullopt;
}

std::vector<std::string> stems_of(const std::vector<fs::path>& files) {
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(file.stem().string());
  return names;
}

/// EuRoC's image names are their stamps in ns, those of TUM RGB-D in s.
std::optional<std::vector<Stamp>> stamps_in_names(const std::vector<std::string>& names) {
  constexpr std::size_t kMinDigits = 16;
  std::vector<Stamp> stamps;
  for (const std::string& name : names) {
    // A number with leading zeros is a frame number.
    const bool may_be = name.size() >= kMinDigits && name.front() != '0';
    const std::optional<Stamp> stamp = may_be ? parse_stamp(name) : std::nullopt;
    const auto is_of_stamp = [](char c) { return io::is_digit(c) || c == '.'; };
    if (!stamp || !std::all_of(name.begin(), name.end(), is_of_stamp)) return std::nullopt;
    stamps.push_back(*stamp);
  }
  return stamps;
}

Side side_in(const fs::path& folder) {
  Side side{io::images_in(folder), {}, {}};
  if (side.files.empty()) throw Error(folder.string() + ": contains no images (.png .jpg .pgm .ppm)");
  const std::vector<std::string> names = stems_of(side.files);
  if (const auto path =
          first_file({folder / "stamps.txt", folder / "timestamps.txt", folder / "times.txt",
                      folder.parent_path() / (folder.filename() == "data" ? "timestamps.txt" : "-")})) {
    side.stamps = stamps_by_line(*path, names);
    side.stamps_from = path->string();
  } else if (auto stamps = stamps_in_names(names)) {
    side.stamps = std::move(stamps);
    side.stamps_from = "the file names";
  }
  return side;
}

Side euroc_side(const fs::path& camera) {
  Side side;
  const fs::path table = camera / "data.csv";
  side.stamps_from = table.string();
  side.stamps.emplace();
  for (const NamedStamp& named : load_named_stamps(table)) {
    side.files.push_back(camera / "data" / named.file);
    side.stamps->push_back(named.stamp);
  }
  if (side.files.empty()) throw Error(table.string() + ": names no images");
  return side;
}

// ---- pairs ----

void remark_alone(FrameList& list, const std::vector<std::size_t>& alone, const Side& side,
                  const std::string& what) {
  if (alone.empty()) return;
  list.remarks.push_back({what, alone.size(), side.files[alone.front()].stem().string(), true, false});
}

FrameList paired(const Side& left, const Side& right, const StampPairs& pairs, const SourceOptions& options) {
  FrameList list;
  const double rate = rate_of(options);
  list.stamps_from = left.stamps ? left.stamps_from : rate_text(rate);
  for (const auto& [l, r] : pairs.pairs) {
    const std::size_t index = list.frames.size();
    const Stamp stamp = left.stamps ? (*left.stamps)[l] : stamp_at(index, rate);
    list.frames.push_back({left.files[l].stem().string(), index, left.files[l], right.files[r], {}, stamp});
  }
  remark_alone(list, pairs.left_alone, left, "left image without a right one");
  remark_alone(list, pairs.right_alone, right, "right image without a left one");
  return list;
}

FrameList paired_by_stamps(const Side& left, const Side& right, const SourceOptions& options) {
  check_unit(*left.stamps, left.stamps_from);
  check_unit(*right.stamps, right.stamps_from);
  FrameList list =
      paired(left, right, pair_by_stamps(*left.stamps, *right.stamps, options.max_skew_ms), options);
  if (!list.frames.empty()) return list;
  throw Error(left.stamps_from + ": " +
              skew_text(left.stamps->front(), right.stamps->front(), options.max_skew_ms));
}

/// Pairs by keys present on both sides, such as names or numbers. Both sides are sorted.
template <class Key>
StampPairs pair_by_keys(const std::vector<Key>& left, const std::vector<Key>& right) {
  std::map<Key, std::size_t> of_right;
  for (std::size_t r = 0; r < right.size(); ++r) of_right.emplace(right[r], r);
  StampPairs found;
  for (std::size_t l = 0; l < left.size(); ++l) {
    const auto partner = of_right.find(left[l]);
    if (partner == of_right.end()) {
      found.left_alone.push_back(l);
    } else {
      found.pairs.push_back({l, partner->second});
      of_right.erase(partner);
    }
  }
  for (const auto& [key, r] : of_right) found.right_alone.push_back(r);
  std::sort(found.right_alone.begin(), found.right_alone.end());
  return found;
}

/// Common to all kinds: the range, and checking the unit of stamps.
FrameList finished(FrameList list, const SourceOptions& options, const std::string& source) {
  const std::size_t all = list.frames.size();
  std::erase_if(list.frames, [&](const ListedFrame& frame) { return !options.frames.contains(frame.index); });
  if (list.frames.empty()) {
    throw Error(source + ": has " + std::to_string(all) + (all == 1 ? " frame" : " frames") +
                ", and none of them is in --frames");
  }
  std::vector<Stamp> stamps;
  for (const ListedFrame& frame : list.frames) stamps.push_back(frame.stamp);
  check_unit(stamps, list.stamps_from);
  return list;
}

// ---- kinds of sequences ----

FrameList list_two_folders(const fs::path& left_folder, const fs::path& right_folder,
                           const SourceOptions& options) {
  const Side left = side_in(left_folder);
  const Side right = side_in(right_folder);
  if (left.stamps && right.stamps) return paired_by_stamps(left, right, options);
  const StampPairs by_name = pair_by_keys(stems_of(left.files), stems_of(right.files));
  if (!by_name.pairs.empty()) return paired(left, right, by_name, options);
  if (left.files.size() != right.files.size()) {
    throw Error(right_folder.string() + ": holds " + std::to_string(right.files.size()) + " images, " +
                left_folder.string() + " " + std::to_string(left.files.size()) +
                ", with different names and without stamps.txt: cannot be paired");
  }
  StampPairs in_order;
  for (std::size_t i = 0; i < left.files.size(); ++i) in_order.pairs.push_back({i, i});
  return paired(left, right, in_order, options);
}

struct Pattern {
  fs::path folder;
  std::string before;
  std::string after;
  std::size_t digits = 1;  // least number, padded with zeros
};

std::optional<Pattern> pattern_of(const std::string& text) {
  const fs::path path = text;
  const std::string name = path.filename().string();
  const std::size_t percent = name.find('%');
  if (percent == std::string::npos) return std::nullopt;
  std::size_t at = percent + 1;
  const bool is_padded = at < name.size() && name[at] == '0';
  std::size_t digits = 0;
  while (at < name.size() && io::is_digit(name[at]) && digits < 20)
    digits = 10 * digits + static_cast<std::size_t>(name[at++] - '0');
  if (at >= name.size() || name[at] != 'd' || name.find('%', at) != std::string::npos) return std::nullopt;
  return Pattern{path.parent_path().empty() ? "." : path.parent_path(), name.substr(0, percent),
                 name.substr(at + 1), is_padded && digits > 0 ? digits : 1};
}

struct NumberedFiles {
  Side side;
  std::vector<std::size_t> numbers;
};

NumberedFiles files_of(const std::string& text) {
  const std::optional<Pattern> pattern = pattern_of(text);
  if (!pattern) throw Error(text + ": expected one %d, %04d or the like in the file name");
  if (!io::is_folder(pattern->folder)) throw Error(pattern->folder.string() + ": no such folder");
  NumberedFiles found;
  for (const fs::path& file : io::images_in(pattern->folder)) {
    const std::string name = file.filename().string();
    const std::size_t around = pattern->before.size() + pattern->after.size();
    if (name.size() < around + pattern->digits || !name.starts_with(pattern->before) ||
        !name.ends_with(pattern->after))
      continue;
    const std::string digits = name.substr(pattern->before.size(), name.size() - around);
    const bool is_padded = digits.size() == pattern->digits || digits.front() != '0';
    const std::optional<std::size_t> number = is_padded ? io::whole<std::size_t>(digits) : std::nullopt;
    if (!number) continue;
    found.side.files.push_back(file);
    found.numbers.push_back(*number);
  }
  if (found.numbers.empty()) throw Error(text + ": no file matches");
  return found;
}

FrameList list_patterns(const std::string& left_text, const std::string& right_text,
                        const SourceOptions& options) {
  NumberedFiles left = files_of(left_text);
  const NumberedFiles right = files_of(right_text);
  if (const auto path = first_file({left.side.files.front().parent_path() / "stamps.txt"})) {
    left.side.stamps = stamps_by_line(*path, stems_of(left.side.files));
    left.side.stamps_from = path->string();
  }
  const StampPairs pairs = pair_by_keys(left.numbers, right.numbers);
  if (pairs.pairs.empty()) throw Error(right_text + ": no number matches a file of " + left_text);
  return paired(left.side, right.side, pairs, options);
}

/// mav0/cam0, or cam0 if the folder is mav0 itself.
std::optional<fs::path> euroc_camera_in(const fs::path& folder) {
  for (const char* camera : {"mav0/cam0", "cam0"}) {
    if (io::is_folder(folder / camera / "data")) return folder / camera;
  }
  return std::nullopt;
}

FrameList list_euroc(const fs::path& camera, const SourceOptions& options) {
  const fs::path other = camera.parent_path() / "cam1";
  if (!io::is_folder(other))
    throw Error(other.string() + ": no such folder, expected that of the right camera");
  FrameList list = paired_by_stamps(euroc_side(camera), euroc_side(other), options);
  list.calib = camera / "sensor.yaml";
  list.is_raw = true;
  return list;
}

struct Stamps {
  std::vector<Stamp> all;
  std::string from;
};

/// Stamps of frames in separate folders.
std::optional<Stamps> stamps_of(const fs::path& source, const std::vector<std::string>& names) {
  if (const auto path = first_file({source / "stamps.txt", source / "times.txt"}))
    return Stamps{stamps_by_line(*path, names), path->string()};
  for (const char* name : {"trajectory.csv", "odometry.csv"}) {
    if (!is_file(source / name)) continue;
    if (const auto rows = load_frame_stamps(source / name))
      return Stamps{stamps_by_frame(source / name, *rows, names), (source / name).string()};
  }
  if (auto stamps = stamps_in_names(names)) return Stamps{std::move(*stamps), "the frames' names"};
  return std::nullopt;
}

/// Left images in a separate folder.
Side left_side(const fs::path& source, const fs::path& folder) {
  Side left = side_in(folder);
  if (const auto path = first_file({source / "stamps.txt", source / "times.txt"})) {
    left.stamps = stamps_by_line(*path, stems_of(left.files));
    left.stamps_from = path->string();
  }
  return left;
}

void sort_by_name(std::vector<io::FrameFiles>& frames) {
  std::sort(frames.begin(), frames.end(), [](const io::FrameFiles& a, const io::FrameFiles& b) {
    return io::in_natural_order(a.name, b.name);
  });
}

std::vector<std::string> names_of(const std::vector<io::FrameFiles>& frames) {
  std::vector<std::string> names;
  for (const io::FrameFiles& files : frames) names.push_back(files.name);
  return names;
}

bool is_in_two_folders(const io::FrameFiles& frame) {
  return frame.left.parent_path() != frame.folder;
}

/// KITTI's raw recordings have stamps per camera; the odometry benchmark has one times.txt.
FrameList list_two_subfolders(const fs::path& source, const std::vector<io::FrameFiles>& frames,
                              const SourceOptions& options) {
  const fs::path left_folder = frames.front().left.parent_path();
  const fs::path right_folder = frames.front().expected_right.parent_path();
  const Side left = left_side(source, left_folder);
  const Side right = io::is_folder(right_folder) ? Side{io::images_in(right_folder), {}, {}} : Side{};
  const StampPairs pairs = pair_by_keys(stems_of(left.files), stems_of(right.files));
  if (pairs.pairs.empty()) {
    throw Error(left_folder.string() + ": no image has a right one, expected " +
                frames.front().expected_right.string());
  }
  if (const auto path = first_file({right_folder.parent_path() / "timestamps.txt"});
      path && left.stamps && right_folder.filename() == "data") {
    Side stamped = right;
    stamped.stamps = stamps_by_line(*path, stems_of(right.files));
    stamped.stamps_from = path->string();
    return paired_by_stamps(left, stamped, options);
  }
  return paired(left, right, pairs, options);
}

/// Stamps of left images in a folder of their own, which has more of them than there are frames.
std::optional<Stamps> stamps_among(const fs::path& source, const std::vector<io::FrameFiles>& frames) {
  Side left = left_side(source, frames.front().left.parent_path());
  if (!left.stamps) return std::nullopt;
  std::map<fs::path, Stamp> by_image;
  for (std::size_t i = 0; i < left.files.size(); ++i) by_image[left.files[i]] = (*left.stamps)[i];
  Stamps stamps{{}, left.stamps_from};
  for (const io::FrameFiles& files : frames) stamps.all.push_back(by_image.at(files.left));
  return stamps;
}

bool has_map(const io::FrameFiles& files) {
  return files.given.has_value();
}

/// Frames in folders of their own; or with depth images or disparities, which then every frame needs.
FrameList list_frames(const fs::path& source, const std::vector<io::FrameFiles>& frames,
                      const SourceOptions& options) {
  const bool has_maps = std::ranges::any_of(frames, &has_map);
  const auto is_whole = [&](const io::FrameFiles& files) {
    return has_maps ? has_map(files) : files.right.has_value();
  };
  if (std::ranges::none_of(frames, is_whole)) {
    throw Error(frames.front().left.string() + ": no right image" +
                (frames.front().expected_right.empty()
                     ? ""
                     : ", expected " + frames.front().expected_right.string()));
  }
  FrameList list;
  const std::optional<Stamps> stamps =
      is_in_two_folders(frames.front()) ? stamps_among(source, frames) : stamps_of(source, names_of(frames));
  const double rate = rate_of(options);
  list.stamps_from = stamps ? stamps->from : rate_text(rate);
  list.calib = io::calibration_in(source);
  list.grey_cameras = frames.front().grey_cameras;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!is_whole(frames[i])) {
      if (options.frames.contains(i)) {
        remark(list.remarks, {has_maps ? "image without a map" : "left image without a right one", 1,
                              frames[i].name, true, false});
      }
      continue;
    }
    list.frames.push_back({frames[i].name, i, frames[i].left, frames[i].right.value_or(fs::path()),
                           frames[i].calib, stamps ? stamps->all[i] : stamp_at(i, rate), frames[i].layout,
                           frames[i].given});
  }
  return list;
}

}  // namespace

std::string skew_text(Stamp left, Stamp right, double max_skew_ms, const std::string& what) {
  std::array<char, 128> skew{};
  std::snprintf(skew.data(), skew.size(), " are within %g ms; the first are %g ms apart", max_skew_ms,
                std::abs(seconds_between(left, right)) * 1000);
  return "no " + what + std::string(skew.data()) + " (" + stamp_text(left) + " and " + stamp_text(right) +
         "): --max-skew MS";
}

FrameList list_folder(const fs::path& folder, const SourceOptions& options) {
  const bool holds_both = !options.layout.empty();
  const std::optional<fs::path> camera = holds_both ? std::nullopt : euroc_camera_in(folder);
  if (camera) {
    if (options.maps.any())
      throw Error(folder.string() +
                  ": has EuRoC's raw images, expected rectified ones with --disparity and "
                  "--depth-image");
    return finished(list_euroc(*camera, options), options, folder.string());
  }
  std::vector<fs::path> alone;
  std::vector<io::FrameFiles> frames = holds_both ? io::find_both(folder, io::layout_of(options.layout))
                                                  : io::find_frames(folder, io::Cameras::rectified, &alone);
  sort_by_name(frames);
  io::give_maps(frames, options.maps);
  const io::FrameFiles& first = frames.front();
  if (std::ranges::any_of(frames, &has_map)) {
    FrameList list = list_frames(folder, frames, options);
    if (!list.calib) list.calib = first.calib;
    for (const fs::path& image : alone)
      remark(list.remarks, {"image without a map", 1, image.stem().string(), true, false});
    return finished(std::move(list), options, folder.string());
  }
  const bool in_two_folders = is_in_two_folders(first);
  FrameList list =
      in_two_folders ? list_two_subfolders(folder, frames, options) : list_frames(folder, frames, options);
  if (in_two_folders) {
    list.calib = first.calib;
    list.grey_cameras = first.grey_cameras;
  }
  return finished(std::move(list), options, folder.string());
}

std::map<fs::path, Stamp> stamps_in(const fs::path& folder, std::vector<io::FrameFiles> frames) {
  sort_by_name(frames);
  std::map<fs::path, Stamp> by_image;
  if (is_in_two_folders(frames.front())) {
    const Side left = left_side(folder, frames.front().left.parent_path());
    if (!left.stamps) return by_image;
    check_unit(*left.stamps, left.stamps_from);
    for (std::size_t i = 0; i < left.files.size(); ++i) by_image[left.files[i]] = (*left.stamps)[i];
  } else if (const std::optional<Stamps> stamps = stamps_of(folder, names_of(frames))) {
    check_unit(stamps->all, stamps->from);
    for (std::size_t i = 0; i < frames.size(); ++i) by_image[frames[i].left] = stamps->all[i];
  }
  return by_image;
}

FrameList list_two(const std::string& left, const std::string& right, const SourceOptions& options) {
  const bool are_folders = io::is_folder(left) && io::is_folder(right);
  FrameList list = are_folders ? list_two_folders(left, right, options) : list_patterns(left, right, options);
  const fs::path folder = list.frames.front().left.parent_path();
  list.calib = io::calibration_in(folder);
  if (!list.calib && are_folders)
    list.calib = io::calibration_in(fs::absolute(folder).lexically_normal().parent_path());
  return finished(std::move(list), options, left + "," + right);
}

bool is_pattern(const std::string& name) {
  return fs::path(name).filename().string().find('%') != std::string::npos;
}

void remark(std::vector<SourceRemark>& remarks, const SourceRemark& of_one) {
  const auto known = std::find_if(remarks.begin(), remarks.end(),
                                  [&](const SourceRemark& other) { return other.what == of_one.what; });
  if (known == remarks.end()) {
    remarks.push_back(of_one);
  } else {
    known->count += of_one.count;
  }
}

double rate_of(const SourceOptions& options) {
  return options.rate_hz > 0 ? options.rate_hz : kUsualRateHz;
}

std::string rate_text(double rate_hz) {
  return "a rate of " + shortest_text(rate_hz) + " Hz";
}

Stamp stamp_at(std::size_t index, double rate_hz) {
  return Stamp{std::llround(static_cast<double>(index) * 1e9 / rate_hz)};
}

}  // namespace cairn::input
