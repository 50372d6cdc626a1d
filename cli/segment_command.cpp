// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/diagnosis/given_disparity.hpp>
#include <cairn/diagnosis/rig_watch.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/output/json.hpp>
#include <cairn/output/web/html_page.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>
#include <set>
#include <sstream>

#include "commands.hpp"
#include "common.hpp"
#include "findings.hpp"
#include "refusals.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct SegmentOptions {
  InputOptions input;
  ExecOptions exec;
  std::string output;
  bool json = false;
  bool ply = false;
  bool ply_objects = false;
  bool depth = false;
  bool grid = false;
  bool html = false;
};

double valid_share(const DisparityMap& map) {
  std::int64_t valid = 0;
  for (int y = 0; y < map.reject.height(); ++y) {
    valid += std::count(map.reject.row(y), map.reject.row(y) + map.reject.width(), Reject::none);
  }
  return static_cast<double>(valid) / static_cast<double>(map.reject.size().area());
}

std::string point_text(const std::optional<Vec3>& v) {
  if (!v) return {};
  return text_of("%.2f", double(v->x)) + ", " + text_of("%.2f", double(v->y)) + ", " +
         text_of("%.2f", double(v->z));
}

std::string interval_text(const std::optional<Interval>& i) {
  if (!i) return {};
  return text_of("%.2f", double(i->low)) + " … " +
         (std::isinf(i->high) ? "∞" : text_of("%.2f", double(i->high)));
}

/// "3 obstacles left out: 2 background, 1 low confidence; the nearest at …"; empty without any.
std::string left_out_text(const std::vector<cairn::RejectedObstacle>& left_out) {
  if (left_out.empty()) return {};
  std::string text = std::to_string(left_out.size()) +
                     (left_out.size() == 1 ? " obstacle is not an object:" : " obstacles are not objects:");
  const char* between = " ";
  for (const auto& reason : kLeftOutReasons) {
    const auto count =
        std::count_if(left_out.begin(), left_out.end(),
                      [&](const cairn::RejectedObstacle& left) { return left.reason == reason.value; });
    if (count == 0) continue;
    text += between + std::to_string(count) + " " + std::string(reason.name);
    between = ", ";
  }
  const cairn::RejectedObstacle& nearest = left_out.front();
  text += "; the nearest, " + std::to_string(nearest.pixel_count) + " px, ";
  text += nearest.position_in_camera_m ? text_of("%.2f m away", double(nearest.position_in_camera_m->z))
                                       : text_of("at %.1f px of disparity", double(nearest.disparity_px));
  return text + " (objects.json lists them)\n";
}

std::string object_table(const std::vector<Object>& objects) {
  Table table({"id", "distance_m", "95 % within", "disparity_px", "position_m (x, y, z)",
               "extent_m (x, y, z)", "area_px", "box (x, y, w, h)", "confidence"});
  for (const Object& o : objects) {
    const Rect b = o.box_px;
    table.add({std::to_string(number(o.id)),
               o.position_in_camera_m ? text_of("%.2f", double(o.position_in_camera_m->z)) : "",
               interval_text(o.depth_interval_m), text_of("%.1f", double(o.disparity_px)),
               point_text(o.position_in_camera_m), point_text(o.extent_in_camera_m),
               std::to_string(o.pixel_count),
               std::to_string(b.x) + ", " + std::to_string(b.y) + ", " + std::to_string(b.width) + ", " +
                   std::to_string(b.height),
               text_of("%.2f", double(o.confidence))});
  }
  return table.text();
}

/// Over the frames processed.
struct Totals {
  int frames = 0;
  std::size_t objects = 0;
  double valid_share = 0;  // a sum, as are the times
  int grounds = 0;
  double milliseconds = 0;

  Totals& operator+=(const Totals& other) {
    frames += other.frames;
    objects += other.objects;
    valid_share += other.valid_share;
    grounds += other.grounds;
    milliseconds += other.milliseconds;
    return *this;
  }
};

std::string summary(const Totals& frame) {
  return std::to_string(frame.objects) + (frame.objects == 1 ? " object" : " objects") + ", disparity on " +
         percent(frame.valid_share) + " of the pixels, " +
         (frame.grounds == 1 ? "ground found, " : "no ground, ") + text_of("%.1f ms", frame.milliseconds);
}

struct Report {
  Totals totals;       // of this frame
  std::string out;     // for stdout
  std::string note;    // for stderr; usually empty
  std::string remark;  // like note, but printed once for all frames that have it
  std::vector<Finding> findings;
  bool is_doubtful = false;
  output::EncodedFrame frame;  // for the page; empty without --html
};

/// The number of doubtful frames per run to diagnose, each of which takes as long as segmenting one.
constexpr std::size_t kMaxMeasured = 5;

constexpr const char* kPageName = "segment.html";

output::EncodedFrame encode(const std::string& name, const LoadedFrame& loaded, const Frame& frame,
                            const output::Provenance& provenance) {
  output::PageFrame shown;
  shown.name = name;
  shown.left = loaded.left.gray;
  shown.left_rgb = loaded.left.rgb;
  shown.right = loaded.right;
  shown.disparity_px = frame.disparity.disparity_px;
  shown.reject = frame.disparity.reject;
  shown.confidence = frame.confidence;
  shown.by_intensity = frame.by_intensity.labels;
  shown.by_disparity = frame.by_disparity.labels;
  shown.superpixels = frame.superpixels.labels;
  shown.groups = frame.groups.labels;
  shown.objects = frame.objects.labels;
  shown.space = frame.space;
  return output::encode_frame(shown, output::json_of(frame, provenance));
}

/// Optional outputs in metres, by flag.
std::array<std::pair<bool, const char*>, 4> metric_outputs(const SegmentOptions& options) {
  return {{{options.ply, "--ply"},
           {options.ply_objects, "--ply-objects"},
           {options.depth, "--depth"},
           {options.grid, "--grid"}}};
}

std::string no_metres(const std::string& flag, const io::FrameFiles& files) {
  return flag + ": needs metres, but " + files.left.string() +
         " has no calibration with a baseline; give one with --calib";
}

/// Removes an outdated page, which would show old results.
void remove_older_page(const fs::path& folder) {
  std::error_code ignored;
  fs::remove(folder / kPageName, ignored);
}

LoadedFrame load(const io::FrameFiles& files, const SegmentOptions& options, const Exec& exec) {
  LoadedFrame loaded = load_frame(files, options.input, exec);
  for (const auto& [requested, name] : metric_outputs(options)) {
    if (requested && !loaded.rig) throw Error(no_metres(name, files));
  }
  return loaded;
}

/// Processes one frame, from its images to its results.
struct FrameTask {
  const io::FrameFiles& files;
  std::optional<std::int64_t> stamp_ns;
  const fs::path& folder;  // of its result; may be empty
  bool one_of_many = false;
  bool may_measure = false;           // its images, if the result is doubtful
  std::optional<Finding> of_given{};  // about the given disparity
};

Report work_on(LoadedFrame loaded, const FrameTask& task, const SegmentOptions& options, Exec& exec) {
  const auto& [files, stamp_ns, folder, one_of_many, may_measure, of_given] = task;
  Report report;
  report.remark = loaded.calibration_remarks;
  const Stopwatch watch(exec);
  const Frame frame = segment_frame(loaded, exec);
  report.totals = {1, frame.objects.list.size(), valid_share(frame.disparity), frame.ground.plane ? 1 : 0,
                   watch.total_ms()};
  const output::Provenance provenance{
      loaded.preset, loaded.config, loaded.rig, watch.times(), loaded.given.has_value(), stamp_ns};
  FrameFindings judged =
      judge(frame, loaded.left.gray, loaded.right, loaded.rig, loaded.config, may_measure, exec);
  report.is_doubtful = judged.is_doubtful;
  if (of_given) judged.list.push_back(*of_given);
  report.findings = united({judged.list});
  if (!folder.empty()) {
    remove_older_page(options.output);
    output::write_result(folder, loaded.left.gray, loaded.left.rgb, frame, provenance,
                         {.point_cloud = options.ply,
                          .object_clouds = options.ply_objects,
                          .depth = options.depth,
                          .grid = options.grid});
    if (output::disparity_file_name(frame, provenance) == "disparity.pfm") {
      report.note = "cairn: " + (folder / "disparity.pfm").string() +
                    ": written instead of disparity.png, which cannot hold disparities below 0 or from 256 "
                    "on\n";
    }
  }
  if (options.html) report.frame = encode(files.name, loaded, frame, provenance);
  if (options.json) {
    report.out = one_of_many ? output::frame_row(files.name, frame, provenance) + "\n"
                             : output::objects_json(frame, provenance);
    return report;
  }
  report.out = on_one_line(files.name) + ": " + summary(report.totals) + "\n";
  if (frame.epipolar.outcome == EpipolarOutcome::corrected) report.out += describe(frame.epipolar) + "\n";
  if (one_of_many && !folder.empty()) return report;
  const Reject in_force = reasons_in_force(loaded.config, loaded.given.has_value());
  const std::string refused =
      refusals_line(count_refusals(frame.disparity, loaded.left.gray, in_force, exec));
  if (!refused.empty()) report.out += refused + "\n";
  if (!frame.objects.list.empty()) report.out += object_table(frame.objects.list);
  report.out += left_out_text(frame.left_out);
  if (one_of_many) report.out += "\n";
  return report;
}

/// Whether `input` is a folder of frames, each with a result of its own, rather than a single frame.
bool is_folder_of_frames(const fs::path& input, const std::vector<io::FrameFiles>& frames) {
  std::error_code ignored;
  return frames.size() > 1 ||
         (fs::is_directory(input, ignored) && !fs::equivalent(frames.front().folder, input, ignored));
}

/// Rejects options that write files but need an output folder.
void require_output(const SegmentOptions& options) {
  if (!options.output.empty()) return;
  const auto require = [](bool requested, const char* name) {
    if (requested) throw Error(std::string(name) + ": needs -o DIR, the folder for output");
  };
  for (const auto& [requested, name] : metric_outputs(options)) require(requested, name);
  require(options.html, "--html");
}

struct Outcome {
  Totals totals;
  int exit_code = 0;
};

/// The output folder of a frame; empty without -o.
fs::path result_folder(const SegmentOptions& options, const io::FrameFiles& frame, bool many) {
  if (options.output.empty()) return {};
  return many ? fs::path(options.output) / frame.name : fs::path(options.output);
}

/// Throws Error if a result would overwrite an objects.png that is not ours: data sets use this name for
/// truth next to the images.
void keep_truth(const fs::path& folder) {
  std::error_code unknown;
  if (folder.empty() || !fs::exists(folder / "objects.png", unknown)) return;
  if (fs::exists(folder / "objects.json", unknown)) return;
  throw Error(
      (folder / "objects.png").string() +
      ": exists without an objects.json, so it is not a result of cairn (the truth?); expected another "
      "folder for -o");
}

Outcome segment_all(const SegmentOptions& options) {
  const std::vector<io::FrameFiles> frames = frames_of(options.input);
  (void)resolve(options.input.config);  // reports bad options before any work
  if (!options.input.calib.empty()) (void)io::load_calibration(options.input.calib);
  Exec exec = make_exec(options.exec);
  const bool many = is_folder_of_frames(options.input.left, frames);
  for (const io::FrameFiles& frame : frames) keep_truth(result_folder(options, frame, many));
  const auto stamps = stamps_of(options.input, frames);
  const Progress progress(frames.size());
  std::vector<output::EncodedFrame> encoded;
  std::set<std::string> remarks;
  PassingFindings findings;
  GivenCheck given;
  std::size_t doubtful = 0;
  bool is_any_broken = false;  // any of the doubtful ones
  SkippedFiles left_out;
  Totals totals;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    progress.at(i, frames[i].name);
    const fs::path folder = result_folder(options, frames[i], many);
    std::optional<LoadedFrame> loaded;
    std::optional<Finding> of_given;
    try {
      loaded = load(frames[i], options, exec);
      if (loaded->given && frames[i].right) {
        of_given = given.check(
            loaded->given->disparity_px, loaded->left.gray,
            [&] { return right_grey(frames[i], options.input.binning, exec.pool); }, loaded->rig,
            loaded->given_name, exec);
      }
    } catch (const Error& error) {
      if (frames.size() == 1) throw;
      progress.clear();
      left_out.add(frames[i].name, error.what());
      if (!folder.empty())
        output::remove_result(folder);  // of an earlier run: it would pass for one of this run
      continue;
    }
    try {
      const FrameTask task{frames[i], stamps[i], folder, many, doubtful < kMaxMeasured, of_given};
      Report report = work_on(std::move(*loaded), task, options, exec);
      if (options.html) encoded.push_back(std::move(report.frame));
      totals += report.totals;
      progress.clear();
      if (remarks.insert(report.remark).second) std::cerr << report.remark;
      std::cerr << report.note;
      if (report.is_doubtful) {
        is_any_broken = is_any_broken || is_broken(report.findings);
        if (++doubtful > kMaxMeasured && is_any_broken) findings.add_doubtful();
      }
      findings.add(frames[i].name, std::move(report.findings));
      std::cout << report.out << std::flush;
    } catch (const Error& error) {
      if (!many) throw;
      throw Error("frame " + frames[i].name + ": " + error.what());
    }
  }
  if (options.html && !encoded.empty()) {
    const output::PageHead head{"segment", name_of(options.input.left), {}};
    io::write_file(fs::path(options.output) / kPageName, output::html_page(head, encoded));
  }
  findings.tell();
  return {totals, left_out.exit_code(frames.size())};
}

std::vector<std::string> words_of(const std::string& list) {
  std::vector<std::string> words;
  std::istringstream in(list + ",");
  for (std::string word; std::getline(in, word, ',');) words.push_back(word);
  return words;
}

/// Checked before any work: that every preset is valid for a run of its own.
void check_presets(const std::vector<SegmentOptions>& runs, const SegmentOptions& all) {
  const std::string list = "--preset " + all.input.config.preset;
  if (all.output.empty()) throw Error(list + ": needs -o DIR, with a sub-folder for each preset");
  if (all.json) throw Error("--json: needs one preset, found " + list);
  const auto refuse = [](const std::string& where, const std::string& what) {
    throw Error(where + ": " + what);
  };
  std::set<std::string> seen;
  for (const SegmentOptions& run : runs) {
    const std::string& name = run.input.config.preset;
    if (!seen.insert(name).second) refuse(list, "has " + name + " twice");
    const std::string from_file = resolve(run.input.config).preset;
    if (from_file != name)
      refuse(run.input.config.file, "says preset: " + from_file + ", expected none with several presets");
  }
}

int segment_by_presets(const SegmentOptions& options) {
  require_output(options);
  const std::vector<std::string> presets = words_of(options.input.config.preset);
  if (presets.size() == 1) return segment_all(options).exit_code;
  std::vector<SegmentOptions> runs(presets.size(), options);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    runs[i].input.config.preset = presets[i];
    runs[i].output = fs::path(options.output) / presets[i];
  }
  check_presets(runs, options);
  Table table({"preset", "frames", "objects a frame", "disparity", "ground", "ms a frame"});
  int code = 0;
  for (const SegmentOptions& run : runs) {
    const std::string& name = run.input.config.preset;
    std::cout << "preset " << name << "\n";
    const auto [totals, exit_code] = segment_all(run);
    code = std::max(code, exit_code);
    const double frames = totals.frames;
    table.add({name, std::to_string(totals.frames),
               text_of("%.2f", static_cast<double>(totals.objects) / frames),
               percent(totals.valid_share / frames), percent(totals.grounds / frames),
               text_of("%.1f", totals.milliseconds / frames)});
  }
  std::cout << "\n" << table.text();
  return code;
}

}  // namespace

Work declare_segment(CLI::App& app) {
  auto options = std::make_shared<SegmentOptions>();
  add_input_options(app, options->input);
  add_binning_option(app, options->input.binning);
  app.get_option("--preset")
      ->description(
          "preset to start from: default or paper; or a list, e.g. paper,default, each with its "
          "sub-folder of DIR");
  options->input.takes_maps = true;
  add_map_options(app, options->input.maps);
  add_exec_options(app, options->exec);
  add_device_option(app, options->exec);
  app.add_option("-o,--output", options->output,
                 "output folder for objects.json, maps and images (docs/formats.md)")
      ->type_name("DIR");
  app.add_flag("--json", options->json,
               "objects.json on standard output instead of a table; for a folder one line per frame");
  app.add_flag("--ply", options->ply,
               "cloud.ply in DIR: coloured points in metres with their objects; needs a calibration");
  app.add_flag("--ply-objects", options->ply_objects,
               "objects/1.ply, 2.ply, ... in DIR: the points of each object; needs a calibration");
  app.add_flag("--depth", options->depth,
               "depth.png (16 bits, mm, 0 = none) and depth.npy (m) in DIR; needs a calibration");
  app.add_flag("--grid", options->grid,
               "grid.pgm and grid.yaml in DIR: obstacle map for ROS; needs a calibration and a floor");
  app.add_flag("--html", options->html, "segment.html in DIR: a page of all frames for the browser");
  app.footer(
      "LEFT may also be a folder of such folders, one per frame; each result goes to a "
      "sub-folder of DIR of the same name.\n"
      "Unusable frames are skipped with a line on stderr; the exit code is then 2.");
  return [options] { return segment_by_presets(*options); };
}

}  // namespace cairn::cli
