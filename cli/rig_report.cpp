// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "rig_report.hpp"

#include <sys/utsname.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/core/target.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/output/web/page_parts.hpp>
#include <cairn/timing/opencv_matchers.hpp>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <thread>

namespace cairn::cli {
namespace {

using output::Json;
namespace fs = std::filesystem;

/// The value of the first line "KEY SEPARATOR VALUE", without quotes; "unknown" without one.
std::string value_in(const char* file, const std::string& key, char separator) {
  std::ifstream lines(file);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find(separator);
    if (!line.starts_with(key) || at == std::string::npos) continue;
    std::string value = line.substr(line.find_first_not_of(" \t\"", at + 1));
    value.erase(value.find_last_not_of(" \t\"") + 1);
    return value;
  }
  return "unknown";
}

Json system_json() {
  utsname names{};
  (void)uname(&names);  // its nodename is not reported
  return {{"os", value_in("/etc/os-release", "PRETTY_NAME", '=')},
          {"kernel", std::string(names.sysname) + " " + names.release},
          {"machine", names.machine},
          {"processor", value_in("/proc/cpuinfo", "model name", ':')},
          {"processors", std::thread::hardware_concurrency()}};
}

Json build_json(const Exec& exec) {
  Json build{{"compiler", __VERSION__}, {"target", name(active_target(exec))}, {"threads", exec.threads()}};
  build["compiled_targets"] = Json::array();
  for (const Target target : compiled_targets()) build["compiled_targets"].push_back(name(target));
  build["opencv"] =
      timing::opencv_version().empty() ? Json(nullptr) : Json(std::string(timing::opencv_version()));
  for (const BuiltPart& part : built_parts()) build["built_in"][part.what] = part.is_in;
  return build;
}

/// The names of all keys of the file, without their values, which may be serial numbers or addresses.
Json keys_of(const fs::path& path) {
  constexpr std::size_t kMaxKeys = 200;
  Json keys = Json::array();
  std::set<std::string> known;
  std::ifstream file(path, std::ios::binary);
  std::string line;
  static const std::regex key(
      R"re(^[\s{\-]*(?:<(\w[\w.\-]{0,39})[^>]*>|"?([A-Za-z_][\w.\-]{0,39})"?\s*[:=]).*)re");
  while (keys.size() < kMaxKeys && std::getline(file, line)) {
    line.resize(std::min<std::size_t>(line.size(), 200));
    line.erase(std::remove(line.begin(), line.end(), '\r'), line.end());
    std::smatch match;
    if (!std::regex_match(line, match, key)) continue;
    const std::string found = match[1].matched ? match[1].str() : match[2].str();
    if (known.insert(found).second) keys.push_back(found);
  }
  return keys;
}

Json calibration_json(const fs::path& path, bool grey_cameras) {
  Json json{{"file", path.filename().string()}, {"keys", keys_of(path)}};
  try {
    const io::Calibration read = io::load_calibration(path, grey_cameras);
    json["size"] = read.image_size ? Json(text(*read.image_size)) : Json(nullptr);
    json["num_disparities"] = read.num_disparities ? Json(*read.num_disparities) : Json(nullptr);
    json["of_raw_cameras"] = read.of_raw_cameras;
    json["remarks"] = read.remarks;
    json["rig"] = nullptr;
    if (read.rig) {
      json["rig"] = {{"focal_px", output::shortest(read.rig->focal_px)},
                     {"cx_px", output::shortest(read.rig->cx_px)},
                     {"cy_px", output::shortest(read.rig->cy_px)},
                     {"baseline_m", output::shortest(read.rig->baseline_m)},
                     {"doffs_px", output::shortest(read.rig->doffs_px)}};
    }
  } catch (const Error& error) {
    json["error"] = error.what();
  }
  return json;
}

std::string png(View<const Gray> grey, View<const Rgb> colour) {
  const std::string file =
      io::encode_png(colour.empty() ? io::PixelRows{grey.size(), 1, 1, grey.data(), grey.stride()}
                                    : io::PixelRows{colour.size(), 3, 1,
                                                    reinterpret_cast<const std::uint8_t*>(colour.data()),
                                                    colour.stride() * 3});
  return "data:image/png;base64," +
         output::base64(reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
}

Json image_json(const fs::path& path, bool with_pixels) {
  Json json{{"type", path.extension().string()}};
  try {
    const io::LoadedImage image = io::load_picture(path);
    json["size"] = text(image.gray.size());
    json["colour"] = !image.rgb.empty();
    if (with_pixels) json["png"] = png(image.gray, image.rgb);
  } catch (const Error& error) {
    json["error"] = error.what();
  }
  return json;
}

/// The options that differ from the preset, by calibration, --config or --set.
Json changed_options(const LoadedFrame& frame) {
  const std::vector<OptionInfo> defaults = options(Config::preset(frame.preset));
  const std::vector<OptionInfo> used = options(frame.config);
  Json changed = Json::object();
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i].value != defaults[i].value) changed[used[i].name] = used[i].value;
  }
  return changed;
}

/// Options and times of one frame, as `cairn segment` runs it.
Json frame_json(const io::FrameFiles& files, const InputOptions& input, Exec exec) {
  try {
    LoadedFrame frame = load_frame(files, input, exec);
    Json json{{"preset", frame.preset}, {"changed_options", changed_options(frame)}};
    const Stopwatch watch(exec);
    const Frame result = segment_frame(frame, exec);
    json["objects"] = result.objects.list.size();
    json["total_ms"] = output::significant(watch.total_ms());
    for (const output::StageTime& stage : watch.times())
      json["stages_ms"][stage.stage] = output::significant(stage.milliseconds);
    return json;
  } catch (const Error& error) {
    return {{"error", error.what()}};
  }
}

void replace_all(std::string& text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
}

void shorten(Json& json, const std::vector<std::pair<std::string, std::string>>& known) {
  if (json.is_structured()) {
    for (Json& part : json) shorten(part, known);
  } else if (json.is_string()) {
    auto& text = json.get_ref<std::string&>();
    if (text.starts_with("data:image/")) return;
    for (const auto& [what, with] : known) replace_all(text, what, with);
    static const std::regex absolute(R"((^|[\s"'(=,])(?:~|\.{1,2})?/(?:[^\s"':,]*/)?(?=[^\s/]))");
    text = std::regex_replace(text, absolute, "$1");
  }
}

/// Replaces every text that is this name.
void name_pair(Json& json, const std::string& name) {
  if (json.is_structured()) {
    for (Json& part : json) name_pair(part, name);
  } else if (json.is_string() && json.get_ref<const std::string&>() == name) {
    json = "pair";
  }
}

}  // namespace

Json rig_report(const io::FrameFiles& first, const InputOptions& input, const ExecOptions& exec_options,
                bool images) {
  const Exec exec = make_exec(exec_options);
  Json report{{"cairn", CAIRN_VERSION}, {"build", build_json(exec)}, {"system", system_json()}};
  std::optional<fs::path> calibration = first.calib;
  if (!input.calib.empty()) calibration = input.calib;
  report["calibration"] = calibration ? calibration_json(*calibration, first.grey_cameras) : Json(nullptr);
  report["images"] = {{"left", image_json(first.left, images)},
                      {"right", image_json(right_of(first), images)}};
  report["frame"] = frame_json(first, input, exec);
  return report;
}

Json without_folders(Json json, const std::vector<io::FrameFiles>& frames, const InputOptions& input) {
  std::set<fs::path> paths;
  for (const std::string& path : {input.left, input.right, input.calib, input.config.file}) {
    if (!path.empty()) paths.insert(path);
  }
  for (const io::FrameFiles& frame : frames) {
    for (const fs::path& path : {fs::path(frame.name), frame.folder, frame.left,
                                 frame.right.value_or(fs::path()), frame.calib.value_or(fs::path())}) {
      if (!path.empty()) paths.insert(path);
    }
  }
  std::set<std::string> folders;
  for (const fs::path& path : paths) {
    for (const fs::path& form : {path, fs::absolute(path)}) {
      const std::string folder = form.parent_path().string();
      if (folder.find_first_not_of('/') != std::string::npos) folders.insert(folder + "/");
    }
  }
  std::vector<std::pair<std::string, std::string>> known;
  for (const std::string& folder : folders) known.emplace_back(folder, "");
  const char* home = std::getenv("HOME");
  if (home != nullptr && std::string(home).size() > 1) known.emplace_back(home, "~");
  // A folder within another one first.
  std::stable_sort(known.begin(), known.end(),
                   [](const auto& a, const auto& b) { return a.first.size() > b.first.size(); });
  shorten(json, known);
  // The name of a single pair is that of its folder, which may be the user's.
  if (frames.size() == 1) name_pair(json, fs::path(frames.front().name).filename().string());
  return json;
}

}  // namespace cairn::cli
