// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "batch_frames.hpp"

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/io/read_file.hpp>
#include <cairn/io/sha256.hpp>
#include <system_error>

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;
using batch::Json;
using batch::PlannedFrame;

bool is_there(const fs::path& path) {
  std::error_code unknown;
  return fs::exists(path, unknown);
}

bool is_folder(const fs::path& path) {
  std::error_code unknown;
  return fs::is_directory(path, unknown);
}

/// The absolute path, because workers may run in any folder.
std::string whole(const fs::path& path) {
  fs::path clean = fs::absolute(path).lexically_normal();
  if (!clean.has_filename()) clean = clean.parent_path();
  return clean.string();
}

/// Splits "LEFT,RIGHT"; nullopt if a file has that very name.
std::optional<std::pair<std::string, std::string>> two_of(const std::string& input) {
  const std::size_t comma = input.find(',');
  if (comma == std::string::npos || is_there(input)) return std::nullopt;
  return std::pair{input.substr(0, comma), input.substr(comma + 1)};
}

/// An input's path as part of a name: relative, without "..".
std::string name_of_input(const std::string& input) {
  const auto two = two_of(input);
  fs::path name;
  for (const fs::path& part : fs::path(two ? two->first : input).lexically_normal()) {
    if (part.has_filename() && part != "." && part != "..") name /= part;
  }
  return name.string();
}

std::string joined(const std::string& parent, const std::string& child) {
  return parent.empty() ? child : parent + "/" + child;
}

/// Collects the frames of the inputs, one after the other.
class Planner {
 public:
  Planner(const BatchInputs& inputs, const Pool& pool)
      : inputs_(inputs),
        range_(inputs.frames.empty() ? input::FrameRange{} : range_of(inputs.frames)),
        pool_(pool) {}

  PlannedFrames planned() && { return {std::move(frames_), std::move(sequences_)}; }

  void add(const std::string& input) {
    if (input.empty()) throw Error("INPUT: found an empty name, expected a folder, a video or LEFT,RIGHT");
    const std::string name = inputs_.paths.size() == 1 ? "" : name_of_input(input);
    const auto two = two_of(input);
    if (inputs_.tracks) {
      sequences_.push_back(frames_.size());
      add_sequence(input, two, name);
    } else if (two && io::is_picture(two->first) && io::is_picture(two->second)) {
      const fs::path left = two->first;
      io::FrameFiles files{left.stem().string(), left.parent_path(), left, two->second, {}};
      files.calib = io::calibration_in(left.parent_path().empty() ? "." : left.parent_path());
      add_files(name.empty() ? files.name : name, files);
    } else if (!two && is_folder(input) && !inputs_.rectify && inputs_.layout.empty() &&
               !is_of_raw_cameras(input)) {
      add_folder(input, name);
    } else {
      add_sequence(input, two, name);
    }
  }

 private:
  /// Whether it is an EuRoC sequence, which open_sequence() rectifies.
  static bool is_of_raw_cameras(const fs::path& folder) {
    return is_folder(folder / "mav0/cam0/data") || is_folder(folder / "cam0/data");
  }

  void add_folder(const std::string& input, const std::string& name) {
    const std::vector<io::FrameFiles> found = io::find_frames(input);
    if (std::none_of(found.begin(), found.end(),
                     [](const io::FrameFiles& files) { return files.right || files.given; }))
      (void)right_of(found.front());
    std::error_code unknown;
    const bool is_one = found.size() == 1 && fs::equivalent(found.front().folder, input, unknown);
    const std::size_t before = frames_.size();
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (range_.contains(i))
        add_files(is_one && !name.empty() ? name : joined(name, found[i].name), found[i]);
    }
    if (frames_.size() == before)
      throw Error(input + ": has " + std::to_string(found.size()) + " frames, and none is in --frames");
  }

  void add_files(const std::string& name, const io::FrameFiles& files) {
    Json how{{"frame", name}, {"left", whole(files.left)}};
    if (files.right) {
      how["right"] = whole(*files.right);
    } else if (!files.expected_right.empty()) {
      how["right"] = whole(files.expected_right);
    }
    if (files.given) {
      how["given"] = whole(files.given->path);
      if (files.given->depth_units_per_m) how["depth_units_per_m"] = *files.given->depth_units_per_m;
    }
    std::optional<fs::path> calib = files.calib;
    if (!inputs_.calib.empty()) calib = inputs_.calib;
    if (calib) {
      how["calib"] = whole(*calib);
      how["calib_sha256"] = sum_of(whole(*calib));
    }
    if (files.grey_cameras) how["grey_cameras"] = true;
    if (inputs_.scale_calibration) how["scale_calibration"] = true;
    if (inputs_.binning != 1) how["binning"] = inputs_.binning;
    frames_.push_back({name, std::move(how)});
  }

  void add_sequence(const std::string& input, const std::optional<std::pair<std::string, std::string>>& two,
                    const std::string& name) {
    BatchSequence sequence;
    sequence.source = two ? whole(two->first) + "," + whole(two->second) : whole(input);
    sequence.layout = inputs_.layout;
    sequence.rectify = inputs_.rectify;
    sequence.scale_calibration = inputs_.scale_calibration;
    sequence.binning = inputs_.binning;
    sequence.step = range_.step;
    if (!inputs_.calib.empty()) sequence.calib = whole(inputs_.calib);
    for (const std::size_t index : sequence_frames(sequence, range_, pool_)) {
      const std::string frame = joined(name, io::number_text(index));
      Json how{{"frame", frame}, {"source", sequence.source}, {"index", index}};
      if (inputs_.tracks) how["first"] = range_.first;
      if (sequence.step != 1) how["step"] = sequence.step;
      if (!sequence.layout.empty()) how["layout"] = sequence.layout;
      if (sequence.rectify) how["rectify"] = true;
      if (sequence.scale_calibration) how["scale_calibration"] = true;
      if (sequence.binning != 1) how["binning"] = sequence.binning;
      if (!sequence.calib.empty()) {
        how["calib"] = sequence.calib;
        how["calib_sha256"] = sum_of(sequence.calib);
      }
      frames_.push_back({frame, std::move(how)});
    }
  }

  const std::string& sum_of(const std::string& calib) {
    std::string& sum = sums_[calib];
    if (sum.empty()) sum = io::sha256(io::read_file(calib, io::kMaxTextBytes));
    return sum;
  }

  const BatchInputs& inputs_;
  input::FrameRange range_;
  const Pool& pool_;
  std::vector<PlannedFrame> frames_;
  std::vector<std::size_t> sequences_;
  std::map<std::string, std::string> sums_;
};

std::string text_at(const PlannedFrame& frame, const char* key) {
  const auto found = frame.how.find(key);
  return found == frame.how.end() || !found->is_string() ? "" : found->get<std::string>();
}

template <class Value>
Value value_at(const PlannedFrame& frame, const char* key, Value otherwise) {
  const auto found = frame.how.find(key);
  return found == frame.how.end() || found->is_string() ? otherwise : found->get<Value>();
}

/// The folder of a frame's files: it depends on the machine rather than on the frame.
fs::path folder_of(const PlannedFrame& frame) {
  const std::string left = text_at(frame, "left");
  if (!left.empty()) return fs::path(left).parent_path();
  const std::string source = text_at(frame, "source");
  const auto two = two_of(source);
  return fs::path(two ? two->first : source).parent_path();
}

}  // namespace

BatchSequence sequence_of(const PlannedFrame& frame) {
  return {text_at(frame, "source"),
          text_at(frame, "calib"),
          text_at(frame, "layout"),
          value_at(frame, "rectify", false),
          value_at(frame, "scale_calibration", false),
          value_at(frame, "binning", 1),
          value_at(frame, "step", std::size_t{1}),
          value_at(frame, "first", std::size_t{0})};
}

std::size_t index_of(const PlannedFrame& frame) {
  return value_at(frame, "index", std::size_t{0});
}

PlannedFrames planned_frames(const BatchInputs& inputs, const Pool& pool) {
  io::check_binning(inputs.binning);
  if (!inputs.calib.empty() && !inputs.rectify) (void)io::load_calibration(inputs.calib);
  Planner planner(inputs, pool);
  for (const std::string& input : inputs.paths) planner.add(input);
  return std::move(planner).planned();
}

std::string config_of_run(const ConfigOptions& options,
                          const std::function<bool(std::string_view, std::string_view)>& elsewhere) {
  const ResolvedConfig resolved = resolve(options, std::nullopt, elsewhere);
  std::vector<std::string> also;
  for (const std::string& assignment : options.sets)
    also.push_back(assignment.substr(0, assignment.find('=')));
  // Options from the file or from --set take precedence over a calibration, even if equal to the preset's.
  constexpr int kSome = 32;
  constexpr int kOthers = 48;
  if (resolve(options, kSome, elsewhere).config.match.num_disparities ==
      resolve(options, kOthers, elsewhere).config.match.num_disparities)
    also.emplace_back("match.num_disparities");
  return io::changed_config_yaml(resolved.preset, resolved.config, also);
}

BatchReader::BatchReader(ConfigOptions config, const Exec& exec)
    : config_(std::move(config)), exec_(exec), sequences_(config_, exec.pool) {}

void BatchReader::check(const PlannedFrame& frame) {
  const fs::path folder = folder_of(frame);
  if (!is_there(folder)) {
    throw Error(folder.string() +
                ": not found on this machine, but existed when the run was planned: frame " + frame.name +
                " needs it");
  }
  const std::string calib = text_at(frame, "calib");
  if (calib.empty()) return;
  std::string& sum = calibrations_[calib];
  if (sum.empty()) sum = io::sha256(io::read_file(calib, io::kMaxTextBytes));
  if (sum != text_at(frame, "calib_sha256")) {
    throw Error(calib + ": changed since the run was planned, expected the calibration of frame " +
                frame.name + " unchanged, or a new plan");
  }
}

BatchFrame BatchReader::read(const PlannedFrame& frame) {
  if (!text_at(frame, "source").empty()) return sequences_.read(sequence_of(frame), index_of(frame));
  io::FrameFiles files;
  files.name = frame.name;
  files.left = text_at(frame, "left");
  files.folder = files.left.parent_path();
  if (const std::string right = text_at(frame, "right"); !right.empty()) files.right = right;
  if (const std::string calib = text_at(frame, "calib"); !calib.empty()) files.calib = calib;
  if (const std::string given = text_at(frame, "given"); !given.empty()) {
    files.given = io::GivenMap{given};
    if (const double units = value_at(frame, "depth_units_per_m", 0.0); units > 0)
      files.given->depth_units_per_m = units;
  }
  files.grey_cameras = value_at(frame, "grey_cameras", false);
  InputOptions input;
  input.config = config_;
  input.scale_calibration = value_at(frame, "scale_calibration", false);
  input.binning = value_at(frame, "binning", 1);
  return {load_frame(files, input, exec_), {}};
}

}  // namespace cairn::cli
