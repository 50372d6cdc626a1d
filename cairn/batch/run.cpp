// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/batch/run.hpp>
#include <cairn/core/error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/read_file.hpp>
#include <cairn/io/sha256.hpp>
#include <fstream>
#include <system_error>
#include <unordered_set>

namespace cairn::batch {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = std::size_t{16} << 20;  // of run.json and config.yaml

std::string id_of(const Run& run) {
  return io::sha256(std::string("cairn batch ") + CAIRN_VERSION + "\n" + run.manifest_sha256 + "\n" +
                    run.config_sha256 + "\n" + Json(run.sequences).dump() + "\n");
}

/// The `sequences` of run.json. Throws Error unless they ascend from 0.
std::vector<std::size_t> sequences_in(const Json& json, std::size_t frames, const fs::path& file) {
  std::vector<std::size_t> sequences;
  const auto found = json.find("sequences");
  if (found == json.end()) return sequences;
  bool is_good = found->is_array();
  for (const Json& begin : *found) {
    is_good = is_good && begin.is_number_unsigned() && begin < frames &&
              (sequences.empty() ? begin == 0U : begin > sequences.back());
    if (is_good) sequences.push_back(begin.get<std::size_t>());
  }
  if (!is_good) throw Error(file.string() + ": `sequences`: expected ascending numbers of frames, from 0");
  return sequences;
}

/// A line of the manifest. Throws Error for names that are not UTF-8, which JSON cannot represent.
std::string line_of(const PlannedFrame& frame) {
  try {
    return frame.how.dump() + "\n";
  } catch (const nlohmann::json::exception&) {
    throw Error("the name or file of a frame is not UTF-8, expected UTF-8 in a manifest: " +
                frame.how.dump(-1, ' ', true, Json::error_handler_t::replace));
  }
}

void check_names(const std::vector<PlannedFrame>& frames) {
  std::unordered_set<std::string_view> seen;
  for (const PlannedFrame& frame : frames) {
    if (!seen.insert(frame.name).second) {
      throw Error("two frames would have the name " + frame.name +
                  ", expected inputs that differ by more than their parent folders");
    }
  }
}

/// Throws Error for any file not left by an interrupted plan.
void check_is_free(const fs::path& folder) {
  constexpr std::array kOurs = {"manifest.jsonl", "config.yaml"};
  std::error_code reason;
  for (fs::directory_iterator it(folder, reason), end; !reason && it != end; it.increment(reason)) {
    const std::string name = it->path().filename().string();
    if (std::find(kOurs.begin(), kOurs.end(), name) != kOurs.end() || name.starts_with(".")) continue;
    throw Error(folder.string() + ": holds " + name + " and no run.json, expected an empty or a new folder");
  }
}

std::string text_at(const Json& json, const char* key, const fs::path& file) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string())
    throw Error(file.string() + ": found no text `" + key + "`, expected a file written by cairn batch plan");
  return found->get<std::string>();
}

std::string file_sha256(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path.string() + ": cannot be read");
  io::Sha256 sum;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || file.gcount() > 0)
    sum.add({buffer.data(), static_cast<std::size_t>(file.gcount())});
  return sum.hex();
}

}  // namespace

PlanResult plan(const fs::path& folder, const std::vector<PlannedFrame>& frames,
                const std::vector<std::size_t>& sequences, std::string_view config_yaml) {
  if (frames.empty()) throw Error("the inputs contain no frame");
  check_names(frames);
  Run run{folder, {}, frames.size(), sequences, {}, io::sha256(config_yaml)};
  io::Sha256 sum;
  for (const PlannedFrame& frame : frames) sum.add(line_of(frame));
  run.manifest_sha256 = sum.hex();
  run.id = id_of(run);
  std::error_code unknown;
  if (fs::exists(folder / "run.json", unknown)) {
    const Run there = open_run(folder);
    if (there.id != run.id) {
      throw Error(folder.string() + ": holds another run (" + there.id.substr(0, 12) + ", " +
                  std::to_string(there.frames) + " frames), expected a new folder for this one (" +
                  run.id.substr(0, 12) + ", " + std::to_string(run.frames) + " frames)");
    }
    check_unchanged(there);
    return {there, true};
  }
  io::make_folder(folder);
  check_is_free(folder);
  io::GrowingFile manifest(run.manifest());
  for (const PlannedFrame& frame : frames) manifest.append(line_of(frame));
  manifest.finish();
  io::write_file(run.config(), config_yaml);
  Json json{{"cairn", CAIRN_VERSION},
            {"run", run.id},
            {"frames", run.frames},
            {"manifest_sha256", run.manifest_sha256},
            {"config_sha256", run.config_sha256}};
  if (!sequences.empty()) json["sequences"] = sequences;
  io::write_file(folder / "run.json", json.dump(1) + "\n");
  return {run, false};
}

Run open_run(const fs::path& folder) {
  const fs::path file = folder / "run.json";
  std::error_code unknown;
  if (!fs::is_regular_file(file, unknown))
    throw Error(folder.string() + ": holds no run.json, expected the folder of cairn batch plan -o");
  const Json json = Json::parse(io::read_file(file, kMaxBytes), nullptr, false);
  if (!json.is_object())
    throw Error(file.string() + ": is not a JSON object, expected a file written by cairn batch plan");
  const std::string version = text_at(json, "cairn", file);
  if (version != CAIRN_VERSION) {
    throw Error(file.string() + ": was planned by cairn " + version +
                ", and this is " CAIRN_VERSION
                ", which may find other objects; expected that version or a new plan");
  }
  Run run{folder,
          text_at(json, "run", file),
          0,
          {},
          text_at(json, "manifest_sha256", file),
          text_at(json, "config_sha256", file)};
  const auto frames = json.find("frames");
  if (frames == json.end() || !frames->is_number_unsigned() || *frames == 0U)
    throw Error(file.string() + ": `frames` is not a count, expected a file written by cairn batch plan");
  run.frames = frames->get<std::size_t>();
  run.sequences = sequences_in(json, run.frames, file);
  if (run.id != id_of(run))
    throw Error(file.string() + ": was changed: its `run` does not match manifest and configuration");
  return run;
}

void check_unchanged(const Run& run) {
  for (const auto& [file, expected] :
       {std::pair{run.manifest(), run.manifest_sha256}, {run.config(), run.config_sha256}}) {
    if (file_sha256(file) != expected) {
      throw Error(file.string() +
                  ": was changed since it was planned; other options or frames need a new run: cairn batch "
                  "plan with another -o");
    }
  }
}

void each_planned(const Run& run, std::size_t begin, std::size_t end,
                  const std::function<void(std::size_t, PlannedFrame)>& visit) {
  std::ifstream file(run.manifest(), std::ios::binary);
  std::string line;
  for (std::size_t i = 0; i < end; ++i) {
    const bool is_there = static_cast<bool>(std::getline(file, line));
    if (i < begin && is_there) continue;
    Json json = Json::parse(line, nullptr, false);
    if (!is_there || !json.is_object() || !json.contains("frame") || !json["frame"].is_string())
      throw Error(run.manifest().string() + ":" + std::to_string(i + 1) + ": is not a frame of a manifest");
    std::string name = json["frame"].get<std::string>();
    const std::filesystem::path below(name);
    if (name.empty() || below.is_absolute() || std::ranges::find(below, "..") != below.end()) {
      throw Error(run.manifest().string() + ":" + std::to_string(i + 1) + ": found the frame " + name +
                  ", expected a name inside the folder of the run");
    }
    visit(i, {std::move(name), std::move(json)});
  }
}

std::string row_begin(const std::string& frame) {
  return "{\"frame\":" + Json(frame).dump() + ",";
}

std::string error_row(const std::string& frame, const std::string& why) {
  return row_begin(frame) + "\"error\":" + Json(why).dump(-1, ' ', false, Json::error_handler_t::replace) +
         "}";
}

bool is_error_row(std::string_view row, const std::string& frame) {
  const std::string begin = row_begin(frame);
  return row.starts_with(begin) && row.substr(begin.size()).starts_with("\"error\":");
}

}  // namespace cairn::batch
