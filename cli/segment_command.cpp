// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/pipeline/segment.hpp>
#include <filesystem>
#include <io/atomic_file.hpp>
#include <io/calibration_files.hpp>
#include <iostream>
#include <optional>
#include <page/html_page.hpp>
#include <set>

#include "commands.hpp"
#include "common.hpp"

namespace cairn::cli {
namespace {

namespace fs = std::filesystem;

struct SegmentOptions {
  InputOptions input;
  ExecOptions exec;
  std::string output;
  bool json = false;
  bool ply = false;
  bool html = false;
};

Frame segment_frame(LoadedFrame& loaded, const Exec& exec) {
  if (loaded.given) {
    return segment(loaded.left.gray, loaded.left.rgb, std::move(*loaded.given), loaded.rig, loaded.config,
                   exec);
  }
  return segment(StereoPair::from(loaded.left.gray, loaded.right, loaded.left.rgb), loaded.rig, loaded.config,
                 exec);
}

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

std::string object_table(const std::vector<Object>& objects) {
  Table table({"id", "distance_m", "disparity_px", "position_m (x, y, z)", "extent_m (x, y, z)", "area_px",
               "box (x, y, w, h)", "confidence"});
  for (const Object& o : objects) {
    const Rect b = o.box_px;
    table.add({std::to_string(number(o.id)),
               o.position_in_camera_m ? text_of("%.2f", double(o.position_in_camera_m->z)) : "",
               text_of("%.1f", double(o.disparity_px)), point_text(o.position_in_camera_m),
               point_text(o.extent_in_camera_m), std::to_string(o.pixel_count),
               std::to_string(b.x) + ", " + std::to_string(b.y) + ", " + std::to_string(b.width) + ", " +
                   std::to_string(b.height),
               text_of("%.2f", double(o.confidence))});
  }
  return table.text();
}

std::string summary(const Frame& frame, double milliseconds) {
  const std::size_t count = frame.objects.list.size();
  return std::to_string(count) + (count == 1 ? " object" : " objects") + ", disparity on " +
         percent(valid_share(frame.disparity)) + " of the pixels, " +
         (frame.ground.plane ? "ground found, " : "no ground, ") + text_of("%.1f ms", milliseconds);
}

struct Report {
  std::string out;         // for stdout
  std::string note;        // for stderr; mostly empty
  std::string remark;      // the same, but once for all frames that have it
  io::EncodedFrame frame;  // for the page; empty without --html
};

constexpr const char* kPageName = "segment.html";

io::EncodedFrame encode(const std::string& name, const LoadedFrame& loaded, const Frame& frame,
                        const io::Provenance& provenance) {
  io::PageFrame shown;
  shown.name = name;
  shown.left = loaded.left.gray;
  shown.left_rgb = loaded.left.rgb;
  shown.disparity_px = frame.disparity.disparity_px;
  shown.reject = frame.disparity.reject;
  shown.confidence = frame.confidence;
  shown.by_intensity = frame.by_intensity.labels;
  shown.by_disparity = frame.by_disparity.labels;
  shown.superpixels = frame.superpixels.labels;
  shown.groups = frame.groups.labels;
  shown.objects = frame.objects.labels;
  shown.objects_json = io::objects_json(frame, provenance);
  return io::encode_frame(shown);
}

std::string no_metres(const io::FrameFiles& files) {
  return "--ply: a point cloud is in metres, and " + files.left.string() +
         " has no calibration with a baseline; give one with --calib";
}

/// An older page would speak of results that are no longer there.
void remove_older_page(const fs::path& folder) {
  std::error_code ignored;
  fs::remove(folder / kPageName, ignored);
}

LoadedFrame load(const io::FrameFiles& files, const SegmentOptions& options, const Exec& exec) {
  LoadedFrame loaded = load_frame(files, options.input, exec);
  if (options.ply && !loaded.rig) throw Error(no_metres(files));
  return loaded;
}

/// One frame from its pictures to results.
Report work_on(LoadedFrame loaded, const io::FrameFiles& files, const SegmentOptions& options,
               const fs::path& folder, bool one_of_many, Exec& exec) {
  Report report;
  report.remark = remark_on_calibration(loaded);
  const Stopwatch watch(exec);
  const Frame frame = segment_frame(loaded, exec);
  const io::Provenance provenance{loaded.preset, loaded.config, loaded.rig, watch.times(),
                                  loaded.given.has_value()};
  if (!folder.empty()) {
    remove_older_page(options.output);
    io::write_result(folder, loaded.left.gray, loaded.left.rgb, frame, provenance,
                     {.point_cloud = options.ply});
    if (io::disparity_file_name(frame, provenance) == "disparity.pfm") {
      report.note = "cairn: " + (folder / "disparity.pfm").string() +
                    ": written instead of disparity.png, since 16 bits cannot hold disparities below 0 or "
                    "from 256 on\n";
    }
  }
  if (options.html) report.frame = encode(files.name, loaded, frame, provenance);
  if (options.json) {
    report.out = io::objects_json(frame, provenance);
    return report;
  }
  report.out = files.name + ": " + summary(frame, watch.total_ms()) + "\n";
  if (frame.epipolar.outcome == EpipolarOutcome::corrected) report.out += describe(frame.epipolar) + "\n";
  if (one_of_many && !folder.empty()) return report;
  if (!frame.objects.list.empty()) report.out += object_table(frame.objects.list);
  if (one_of_many) report.out += "\n";
  return report;
}

/// Whether `input` is a folder of frames, each with a result of its own, rather than the only frame itself.
bool is_folder_of_frames(const fs::path& input, const std::vector<io::FrameFiles>& frames) {
  std::error_code ignored;
  return frames.size() > 1 ||
         (fs::is_directory(input, ignored) && !fs::equivalent(frames.front().folder, input, ignored));
}

/// Files that are asked for without a folder for them.
void require_output(const SegmentOptions& options) {
  if (!options.output.empty()) return;
  for (const auto& [asked, name] : {std::pair{options.ply, "--ply"}, {options.html, "--html"}}) {
    if (asked) throw Error(std::string(name) + ": needs -o DIR, the folder to write into");
  }
}

int segment_all(const SegmentOptions& options) {
  require_output(options);
  const std::vector<io::FrameFiles> frames = frames_of(options.input);
  (void)resolve(options.input.config);  // what is bad for all frames is so before any of them
  if (!options.input.calib.empty()) (void)io::load_calibration(options.input.calib);
  Exec exec = make_exec(options.exec);
  const bool many = is_folder_of_frames(options.input.left, frames);
  const Progress progress(frames.size());
  std::vector<io::EncodedFrame> encoded;
  std::set<std::string> remarks;
  LeftOut left_out;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    progress.at(i, frames[i].name);
    fs::path folder = options.output;
    if (many && !options.output.empty()) folder /= frames[i].name;
    std::optional<LoadedFrame> loaded;
    try {
      loaded = load(frames[i], options, exec);
    } catch (const Error& error) {
      if (frames.size() == 1) throw;
      progress.clear();
      left_out.add(frames[i].name, error.what());
      continue;
    }
    try {
      Report report = work_on(std::move(*loaded), frames[i], options, folder, many, exec);
      if (options.html) encoded.push_back(std::move(report.frame));
      progress.clear();
      if (remarks.insert(report.remark).second) std::cerr << report.remark;
      std::cerr << report.note;
      std::cout << report.out << std::flush;
    } catch (const Error& error) {
      if (!many) throw;
      throw Error("frame " + frames[i].name + ": " + error.what());
    }
  }
  if (options.html && !encoded.empty()) {
    const io::PageHead head{"segment", name_of(options.input.left), {}};
    io::write_file(fs::path(options.output) / kPageName, io::html_page(head, encoded));
  }
  return left_out.exit_code(frames.size());
}

}  // namespace

Work declare_segment(CLI::App& app) {
  auto options = std::make_shared<SegmentOptions>();
  add_input_options(app, options->input);
  app.add_option("--disparity", options->input.disparity,
                 "disparity map (.png, .pfm, .npy) to use instead of matching, or a folder of maps named "
                 "like the frames; RIGHT may be left out")
      ->type_name("PATH");
  add_exec_options(app, options->exec);
  app.add_option("-o,--output", options->output,
                 "folder for objects.json and its maps and pictures; docs/formats.md names them")
      ->type_name("DIR");
  app.add_flag("--json", options->json, "print the content of objects.json instead of a table");
  app.add_flag(
      "--ply", options->ply,
      "also write cloud.ply: the coloured points in metres, each with its object; needs a calibration");
  app.add_flag("--html", options->html,
               "also write segment.html into DIR: one page of all frames, to look at in a browser");
  app.footer(
      "LEFT may also be a folder of such folders: each is a frame, and its result goes to a folder of its "
      "name in DIR.\n"
      "A frame whose files cannot be used is left out with a line on stderr; the exit code is 2 then.");
  return [options] { return segment_all(*options); };
}

}  // namespace cairn::cli
