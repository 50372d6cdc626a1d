// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <CLI/CLI.hpp>
#include <cairn/core/exec.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/disparity/disparity_map.hpp>
#include <cairn/pipeline/config.hpp>
#include <filesystem>
#include <functional>
#include <io/dataset.hpp>
#include <io/image_files.hpp>
#include <io/results.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace cairn::cli {

// ---- options that several commands share ----

struct ConfigOptions {
  std::string preset = "default";
  std::string file;
  std::vector<std::string> sets;  // "match.window_size=9"
};
void add_config_options(CLI::App& app, ConfigOptions& options);
struct ResolvedConfig {
  Config config;
  std::string preset;  // what it started from: the config file's word, else --preset
};
/// Preset, then a calibration's number of disparities, then the config file, then --set; later ones win.
/// `elsewhere` takes the options of another configuration, see io::load_config().
ResolvedConfig resolve(const ConfigOptions& options, std::optional<int> calibrated_disparities = std::nullopt,
                       const std::function<bool(std::string_view, std::string_view)>& elsewhere = {});

/// The options of a sequence alone, as the config options leave them. Throws Error where sequences are not
/// built in.
std::vector<OptionInfo> sequence_options(const ConfigOptions& config);

struct ExecOptions {
  int threads = 0;  // 0 = one for each processor
  std::string target;
};
void add_exec_options(CLI::App& app, ExecOptions& options);
/// With a pool, so that the frames of a folder share their buffers.
Exec make_exec(const ExecOptions& options);
/// The instruction set that --target, else the environment variable CAIRN_TARGET, asks for.
Target wanted_target(const std::string& option);

struct InputOptions {
  std::string left;   // or a folder
  std::string right;  // empty with a folder, or where the disparity is given
  std::string calib;
  std::string disparity;
  ConfigOptions config;
  io::Cameras cameras = io::Cameras::rectified;  // whose pictures are taken
};

/// LEFT, RIGHT, --calib and those of add_config_options().
void add_input_options(CLI::App& app, InputOptions& options);

// ---- frames ----

/// The frames that the options name: one pair, one folder, or a folder of folders.
std::vector<io::FrameFiles> frames_of(const InputOptions& options);
/// Throws Error where the frame has none.
const std::filesystem::path& right_of(const io::FrameFiles& files);

/// A frame with all that is needed to work on it.
struct LoadedFrame {
  io::Picture left;
  Image<Gray> right;                  // empty where the disparity is given
  std::optional<DisparityMap> given;  // instead of the right picture
  std::optional<StereoRig> rig;
  Config config;
  std::string preset;
  std::optional<std::filesystem::path> raw_calibration;  // its file, where that describes raw cameras
};
/// Reads and checks everything before any work is done. Throws Error.
LoadedFrame load_frame(const io::FrameFiles& files, const InputOptions& options, const Exec& exec);
/// Takes the given disparity out of `loaded`, where there is one.
Frame segment_frame(LoadedFrame& loaded, const Exec& exec);

/// A line for stderr where the calibration is right only of pictures that were rectified with it; else "".
std::string remark_on_calibration(const LoadedFrame& loaded);

/// Collects the time of every stage while it lives.
class Stopwatch {
 public:
  explicit Stopwatch(Exec& exec);
  ~Stopwatch();
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;
  [[nodiscard]] const std::vector<io::StageTime>& times() const { return times_; }
  [[nodiscard]] double total_ms() const;

 private:
  Exec& exec_;
  std::vector<io::StageTime> times_;
};

// ---- text ----

/// printf's format for one number; "-" for NaN.
std::string text_of(const char* format, double value);
/// "62.1 %" of 0.621; "-" for NaN.
std::string percent(double share);

/// The last part of a path, whatever way it is written: "frames" of "data/frames/".
std::string name_of(const std::filesystem::path& path);

/// What became of the epipolar correction, in words; "" where it is switched off.
std::string describe(const EpipolarOffset& epipolar);

/// Columns of text for the terminal: the first to the left, the others to the right; columns without any text
/// are left out.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// The frames of a folder run whose own files cannot be used. The others are worked on nevertheless.
class LeftOut {
 public:
  /// With a line on stderr.
  void add(const std::string& frame, const std::string& why);
  [[nodiscard]] const std::vector<std::string>& frames() const { return frames_; }
  /// 0; where frames were left out 2, with a line on stderr that counts them.
  [[nodiscard]] int exit_code(std::size_t frames_in_all) const;

 private:
  std::vector<std::string> frames_;
};

/// How far a folder run has come, on stderr where that is a terminal; nothing elsewhere.
class Progress {
 public:
  explicit Progress(std::size_t count);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void at(std::size_t index, const std::string& name) const;
  /// A bar of which `share` (0 … 1) is done, with words behind it; also where there is but one frame.
  void bar(double share, const std::string& words) const;
  /// Takes the bar away, so that other text may follow.
  void clear() const;

 private:
  std::size_t count_;
  bool shown_;
};

}  // namespace cairn::cli
