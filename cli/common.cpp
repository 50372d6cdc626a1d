// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "common.hpp"

#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/core/target.hpp>
#include <cairn/device/device.hpp>
#include <cairn/image/binning.hpp>
#include <cairn/input/frame_list.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "terminal.hpp"

namespace cairn::cli {
namespace fs = std::filesystem;

// ---- options ----

void add_config_options(CLI::App& app, ConfigOptions& options) {
  app.add_option("--preset", options.preset, "preset to start from: default or paper")->capture_default_str();
  app.add_option("--config", options.file, "YAML file of options, in the form of `cairn config`")
      ->type_name("FILE");
  app.add_option("--set", options.sets, "one option, e.g. match.window_size=9; may be repeated")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

namespace {

std::string_view name_in(std::string_view assignment) {
  return assignment.substr(0, assignment.find('='));
}

using Elsewhere = std::function<bool(std::string_view, std::string_view)>;

void set_from_text(Config& config, const std::string& assignment, const Elsewhere& elsewhere) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw Error("--set " + assignment + ": expected NAME=VALUE, e.g. match.window_size=9");
  }
  const std::string_view name = name_in(assignment);
  const std::string_view value = std::string_view(assignment).substr(equals + 1);
  if (!elsewhere || !elsewhere(name, value)) set(config, name, value);
}

}  // namespace

bool sets_search_range(const ConfigOptions& options) {
  return std::ranges::any_of(options.sets, [](const std::string& assignment) {
    return name_in(assignment) == "match.num_disparities";
  });
}

ResolvedConfig resolve(const ConfigOptions& options, std::optional<int> calibrated_disparities,
                       const Elsewhere& elsewhere) {
  ResolvedConfig resolved;
  const auto from_preset = [&](std::string_view name) {
    Config config = Config::preset(name);
    if (calibrated_disparities) set(config, "match.num_disparities", std::to_string(*calibrated_disparities));
    resolved.preset = name;
    return config;
  };
  const auto set_all = [&](Config& config) {
    for (const std::string& assignment : options.sets) set_from_text(config, assignment, elsewhere);
  };
  resolved.config = from_preset(options.preset);
  if (!options.file.empty()) io::load_config(options.file, resolved.config, from_preset, set_all, elsewhere);
  set_all(resolved.config);
  // Checked last, so the order of the options does not matter.
  for (const std::string& assignment : options.sets) {
    const std::string_view name = name_in(assignment);
    const std::string_view value = std::string_view(assignment).substr(name.size() + 1);
    if (!elsewhere || !elsewhere(name, value)) require_active(resolved.config, name);
  }
  return resolved;
}

void add_exec_options(CLI::App& app, ExecOptions& options) {
  constexpr int kMaxThreads = 1024;
  app.add_option("--threads", options.threads, "number of threads; 0 = one per processor")
      ->check(CLI::Range(0, kMaxThreads).name(""))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--target", options.target,
                 "instruction set of the kernels (scalar, sse4, avx2, avx512, neon); default: $CAIRN_TARGET, "
                 "else the best")
      ->type_name("NAME");
}

void add_device_option(CLI::App& app, ExecOptions& options) {
  options.takes_device = true;
  app.add_option("--device", options.device,
                 "graphics processor for matching, see `cairn info`; default: $CAIRN_DEVICE, else off")
      ->type_name("NAME");
}

namespace {

/// What a user wants, and where it was said; both empty if nowhere.
std::pair<std::string, const char*> wanted(const std::string& option, const char* name,
                                           const char* variable) {
  if (!option.empty()) return {option, name};
  const char* const value = std::getenv(variable);
  return value != nullptr && *value != '\0' ? std::pair(std::string(value), variable)
                                            : std::pair(std::string(), "");
}

}  // namespace

Target wanted_target(const std::string& option) {
  const auto [name, source] = wanted(option, "--target", "CAIRN_TARGET");
  return name.empty() ? Target::best : cairn::wanted_target(name, source);
}

Exec make_exec(const ExecOptions& options) {
  Exec exec = Exec::with_threads(options.threads, wanted_target(options.target));
  exec.pool = Pool::make();
  if (options.takes_device) {
    const auto [name, source] = wanted(options.device, "--device", "CAIRN_DEVICE");
    exec.device = device::open(name, source, [](const std::string& says) { std::cerr << says + "\n"; });
  }
  return exec;
}

void add_map_options(CLI::App& app, io::MapOptions& maps) {
  app.add_option("--disparity", maps.disparity,
                 "disparity map (.png, .pfm, .npy) instead of matching, or a folder of maps named like the "
                 "frames; a right image checks it")
      ->type_name("FILE|DIR");
  app.add_option("--depth-image", maps.depth,
                 "depth image instead of matching, or a folder of them: 16-bit .png in mm, .pfm or .npy in m")
      ->type_name("FILE|DIR");
  app.add_option("--depth-units", maps.depth_units_per_m,
                 "units per metre of 16-bit depth images; default: 1000 (mm), in folders of TUM RGB-D 5000")
      ->type_name("N");
}

void add_binning_option(CLI::App& app, int& binning, const std::string& prefix) {
  app.add_option("--binning", binning,
                 prefix + "N x N pixels in one: faster, but finds fewer small objects; 1 to " +
                     std::to_string(kMaxBinning))
      ->type_name("N")
      ->capture_default_str();
}

void add_layout_option(CLI::App& app, std::string& layout) {
  app.add_option("--layout", layout, "side_by_side or top_bottom: each image file holds both images")
      ->type_name("NAME");
}

void add_input_options(CLI::App& app, InputOptions& options) {
  app.add_option("LEFT", options.left,
                 "left image of a rectified pair, or a folder with left.png and right.png")
      ->required()
      ->type_name("");
  app.add_option("RIGHT", options.right, "right image; not with a folder")->type_name("");
  app.add_option("--calib", options.calib,
                 "calibration; default: calib.txt next to the left image, else ../gt/calib.txt, else "
                 "none: no metres")
      ->type_name("FILE");
  app.add_flag("--scale-calibration", options.scale_calibration,
               "scale a calibration for images of another size of the same shape");
  add_layout_option(app, options.layout);
  add_config_options(app, options.config);
}

// ---- frames ----

namespace {

std::optional<fs::path> calibration_next_to(const fs::path& left) {
  std::error_code ignored;
  const fs::path folder = fs::absolute(left, ignored).parent_path();
  for (const fs::path& candidate :
       {left.parent_path() / "calib.txt", folder.parent_path() / "gt" / "calib.txt"}) {
    if (fs::is_regular_file(candidate, ignored)) return candidate;
  }
  return std::nullopt;
}

io::FrameFiles frame_of_files(const InputOptions& options) {
  const fs::path left = options.left;
  io::FrameFiles files;
  files.name = left.stem().string();
  // A frame without a name of its own is called after its folder.
  if (files.name == "left" || files.name == "right") files.name = name_of(fs::absolute(left).parent_path());
  files.folder = left.parent_path();
  files.left = left;
  if (!options.right.empty()) files.right = options.right;
  files.calib = calibration_next_to(left);
  return files;
}

/// The frames with their maps, if the command takes them.
std::vector<io::FrameFiles> with_maps(std::vector<io::FrameFiles> frames, const InputOptions& options) {
  if (options.takes_maps) {
    io::give_maps(frames, options.maps);
  } else {
    for (io::FrameFiles& files : frames) files.given.reset();
  }
  return frames;
}

bool has_maps(const InputOptions& options) {
  return !options.maps.disparity.empty() || !options.maps.depth.empty();
}

void check_rights(const std::vector<io::FrameFiles>& frames, bool takes_maps) {
  const auto is_complete = [&](const io::FrameFiles& files) {
    return files.right || (takes_maps && files.given);
  };
  if (std::none_of(frames.begin(), frames.end(), is_complete)) (void)right_of(frames.front());
}

/// The frames of files that hold both images.
std::vector<io::FrameFiles> frames_with_both(const InputOptions& options) {
  const io::Layout layout = io::layout_of(options.layout);
  if (!options.right.empty()) {
    throw Error("--layout " + options.layout + ": found the right image " + options.right + ", expected " +
                options.left + " only, with both images");
  }
  std::vector<io::FrameFiles> frames;
  std::error_code ignored;
  if (fs::is_directory(options.left, ignored)) {
    frames = io::find_both(options.left, layout);
  } else {
    frames.push_back(frame_of_files(options));
    frames.back().right = frames.back().left;
    frames.back().layout = layout;
  }
  return with_maps(std::move(frames), options);
}

/// Recognises MCAP by its first bytes, since the reader may not be built in.
bool is_recording(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string begin(6, '\0');
  return file.read(begin.data(), 6) && begin == "\x89MCAP0";
}

}  // namespace

std::vector<io::FrameFiles> frames_of(const InputOptions& options) {
  if (options.left.empty()) throw Error("LEFT: found an empty name, expected a file or a folder");
  std::error_code ignored;
  if (!options.layout.empty()) return frames_with_both(options);
  if (options.right.empty() && fs::is_directory(options.left, ignored)) {
    std::vector<fs::path> alone;
    auto frames = io::find_frames(options.left, options.cameras, &alone);
    if (!alone.empty()) {
      std::cerr << "cairn: " << options.left << ": left image without a right one: " << alone.size()
                << (alone.size() == 1 ? " frame" : " frames") << " skipped, the first is "
                << on_one_line(alone.front().filename().string()) << "\n";
    }
    if (!has_maps(options)) check_rights(frames, options.takes_maps);
    return with_maps(std::move(frames), options);
  }
  if (options.right.empty() && !has_maps(options) && fs::exists(options.left, ignored)) {
    if (is_recording(options.left)) {
      throw Error(options.left + ": is a recording, expected images (cairn record " + options.left +
                  " -o DIR converts it to a folder of frames; cairn follow and cairn live read it directly)");
    }
    throw Error(options.left + ": found a left image, but no right image");
  }
  if (options.right.empty() && !has_maps(options)) throw Error(options.left + ": no such file or folder");
  return with_maps({frame_of_files(options)}, options);
}

std::vector<std::optional<std::int64_t>> stamps_of(const InputOptions& options,
                                                   const std::vector<io::FrameFiles>& frames) {
  std::vector<std::optional<std::int64_t>> stamps(frames.size());
  std::error_code unknown;
  if (!fs::is_directory(options.left, unknown)) return stamps;
  try {
    const auto known = input::stamps_in(options.left, frames);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if (const auto found = known.find(frames[i].left); found != known.end()) stamps[i] = found->second.ns;
    }
  } catch (const Error& error) {
    std::cerr << "cairn: " << error.what() << "; the results have no stamps\n";
  }
  return stamps;
}

const fs::path& right_of(const io::FrameFiles& files) {
  if (files.right) return *files.right;
  throw Error(files.left.string() + ": no right image" +
              (files.expected_right.empty() ? "" : ", expected " + files.expected_right.string()));
}

io::LoadedPair load_images(const io::FrameFiles& files, const Pool& pool) {
  (void)right_of(files);
  return io::load_pair(files, pool);
}

Image<Gray> right_grey(const io::FrameFiles& files, int binning, const Pool& pool) {
  io::LoadedImage right = files.layout == io::Layout::one ? io::load_picture(*files.right, pool)
                                                          : io::load_pair(files, pool).right;
  return binning == 1 ? std::move(right.gray) : binned(right.gray, binning, pool);
}

namespace {

void bin(LoadedFrame& frame, io::Calibration& calibration, int factor, const Pool& pool) {
  calibration.rig = frame.rig;
  calibration = io::binned(calibration, frame.left.gray.size(), factor);
  frame.rig = calibration.rig;
  frame.left = io::binned(frame.left, factor, pool);
  if (!frame.right.empty()) frame.right = binned(frame.right, factor, pool);
  if (frame.given) {
    const Image<float> given = binned_disparity(frame.given->disparity_px, factor, pool);
    frame.given = external_disparity(given, {});
  }
}

}  // namespace

LoadedFrame load_frame(const io::FrameFiles& files, const InputOptions& options, const Exec& exec) {
  io::check_binning(options.binning);
  LoadedFrame frame;
  if (files.given) {
    frame.left = files.layout == io::Layout::one ? io::load_picture(files.left, exec.pool)
                                                 : io::load_pair(files, exec.pool).left;
  } else if (has_maps(options)) {
    const bool is_depth = options.maps.disparity.empty();
    throw Error((is_depth ? "--depth-image " + options.maps.depth : "--disparity " + options.maps.disparity) +
                ": has no map of the frame " + files.name + ", expected " + files.name +
                ".png, .pfm or .npy");
  } else {
    io::LoadedPair pair = load_images(files, exec.pool);
    frame.left = std::move(pair.left);
    frame.right = std::move(pair.right.gray);
  }

  std::optional<fs::path> calib = files.calib;
  if (!options.calib.empty()) calib = options.calib;
  io::Calibration calibration;
  if (calib) {
    calibration = io::load_calibration(*calib, files.grey_cameras);
    calibration = io::suited(calibration, frame.left.gray.size(), *calib, options.scale_calibration);
    if (sets_search_range(options.config)) calibration.num_disparities.reset();
  }
  frame.rig = calibration.rig;
  if (files.given) {
    if (files.given->depth_units_per_m) frame.rig = io::rig_of_depth(calibration);
    const Image<float> values = io::load_given(*files.given, frame.left.gray.size(), frame.rig, exec.pool);
    frame.given_name =
        (files.given->depth_units_per_m ? "--depth-image " : "--disparity ") + files.given->path.string();
    try {
      frame.given = external_disparity(values, exec);
    } catch (const Error& error) {
      throw Error(files.given->path.string() + ": " + error.what());
    }
  }
  for (const std::string& remark : calibration.remarks)
    frame.calibration_remarks += "cairn: " + calib->string() + ": " + remark + "\n";
  if (calibration.of_raw_cameras) {
    frame.calibration_remarks +=
        "cairn: " + calib->string() +
        ": describes raw cameras and their distortion; images are not rectified here and must be "
        "(cairn rectify does, and writes their calib.txt)\n";
  }
  if (options.binning != 1) bin(frame, calibration, options.binning, exec.pool);
  if (calib) io::check_search_range(calibration, *calib);
  ResolvedConfig resolved = resolve(options.config, calibration.num_disparities);
  frame.config = std::move(resolved.config);
  frame.config.ground.known = std::move(calibration.ground);
  frame.preset = std::move(resolved.preset);
  return frame;
}

Frame segment_frame(LoadedFrame& loaded, const Exec& exec) {
  if (loaded.given) {
    return segment({{loaded.left.gray, loaded.left.rgb}, {}, std::move(*loaded.given)},
                   {loaded.rig, loaded.config, exec});
  }
  return segment(StereoPair::from(loaded.left.gray, loaded.right, loaded.left.rgb), loaded.rig, loaded.config,
                 exec);
}

Stopwatch::Stopwatch(Exec& exec) : exec_(exec) {
  exec_.observe = [this](std::string_view stage, const StageResult&, double milliseconds) {
    times_.push_back({std::string(stage), milliseconds});
  };
}

Stopwatch::~Stopwatch() {
  exec_.observe = nullptr;
}

double Stopwatch::total_ms() const {
  double sum = 0;
  for (const output::StageTime& time : times_) sum += time.milliseconds;
  return sum;
}

}  // namespace cairn::cli
