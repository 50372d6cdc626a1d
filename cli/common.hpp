// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/output/results.hpp>
#include <cairn/pipeline/config.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace cairn::cli {

// ---- options common to several commands ----

struct ConfigOptions {
  std::string preset = "default";
  std::string file;
  std::vector<std::string> sets;  // "match.window_size=9"
};
void add_config_options(CLI::App& app, ConfigOptions& options);
struct ResolvedConfig {
  Config config;
  std::string preset;  // the base preset: from the config file, else --preset
};
/// Preset, then the number of disparities of a calibration, then the config file, then --set; later ones
/// override. `elsewhere` handles the options of another configuration, see io::load_config().
ResolvedConfig resolve(const ConfigOptions& options, std::optional<int> calibrated_disparities = std::nullopt,
                       const std::function<bool(std::string_view, std::string_view)>& elsewhere = {});

/// Whether --set has match.num_disparities; ndisp of a calibration is not read then.
bool sets_search_range(const ConfigOptions& options);

/// The options of a sequence only, after applying the config options. Throws Error if sequences are not built
/// in.
std::vector<OptionInfo> sequence_options(const ConfigOptions& config);

struct ExecOptions {
  int threads = 0;  // 0 = one per processor
  std::string target;
  bool takes_device = false;  // of a command that matches
  std::string device;
};
void add_exec_options(CLI::App& app, ExecOptions& options);
/// --device, for commands that match.
void add_device_option(CLI::App& app, ExecOptions& options);
/// With a pool, so that the frames of a folder share buffers. Opens the device, or says on stderr why not. Throws Error
/// for a target or device that is not there.
Exec make_exec(const ExecOptions& options);
/// The instruction set from --target, else from the environment variable CAIRN_TARGET.
Target wanted_target(const std::string& option);

struct InputOptions {
  std::string left;   // or a folder
  std::string right;  // empty with a folder, or with a given disparity
  std::string calib;
  bool scale_calibration = false;
  int binning = 1;          // of all images, after everything else that is read
  std::string layout;       // of files with both images; empty: each has one
  bool takes_maps = false;  // or depth.png and the like instead of a right image
  io::MapOptions maps;
  ConfigOptions config;
  io::Cameras cameras = io::Cameras::rectified;  // the kind of images searched for
};

void add_layout_option(CLI::App& app, std::string& layout);
/// LEFT, RIGHT, --calib, --layout and those of add_config_options().
void add_input_options(CLI::App& app, InputOptions& options);
/// --binning.
void add_binning_option(CLI::App& app, int& binning, const std::string& prefix = {});
/// --disparity, --depth-image and --depth-units.
void add_map_options(CLI::App& app, io::MapOptions& maps);

// ---- frames ----

/// The frames from the options: one pair, one folder, or a folder of folders.
std::vector<io::FrameFiles> frames_of(const InputOptions& options);
/// The stamp of each frame in ns, where the folder's files or the frames' names have stamps. Files of stamps
/// that do not fit the frames are reported on stderr, and no frame has a stamp then.
std::vector<std::optional<std::int64_t>> stamps_of(const InputOptions& options,
                                                   const std::vector<io::FrameFiles>& frames);
/// Throws Error if the frame has no right image.
const std::filesystem::path& right_of(const io::FrameFiles& files);
/// The images of a frame. Throws Error like right_of().
io::LoadedPair load_images(const io::FrameFiles& files, const Pool& pool = {});

/// The right image alone, binned, to compare given disparities with. Precondition: the frame has one.
Image<Gray> right_grey(const io::FrameFiles& files, int binning, const Pool& pool);

/// A frame with everything needed to process it.
struct LoadedFrame {
  io::LoadedImage left;
  Image<Gray> right;                  // empty with a given disparity
  std::optional<DisparityMap> given;  // instead of the right image
  std::string given_name;             // its option and file, for messages
  std::optional<StereoRig> rig;
  Config config;
  std::string preset;
  std::string calibration_remarks;  // lines for the user
};
/// Reads and checks everything before processing. Throws Error.
LoadedFrame load_frame(const io::FrameFiles& files, const InputOptions& options, const Exec& exec);
/// Moves the given disparity out of `loaded`, if there is one.
Frame segment_frame(LoadedFrame& loaded, const Exec& exec);

/// Collects the time of every stage during its lifetime.
class Stopwatch {
 public:
  explicit Stopwatch(Exec& exec);
  ~Stopwatch();
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  [[nodiscard]] const std::vector<output::StageTime>& times() const { return times_; }
  [[nodiscard]] double total_ms() const;

 private:
  Exec& exec_;
  std::vector<output::StageTime> times_;
};

}  // namespace cairn::cli
