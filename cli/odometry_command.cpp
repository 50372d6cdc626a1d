// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/input/camera/without_password.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/live/runner.hpp>
#include <cairn/live/sensors.hpp>
#include <cairn/output/trajectory_files.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/sequence/first_pose.hpp>
#include <cairn/sequence/odometry.hpp>
#include <cairn/sequence/stamps.hpp>
#include <iostream>
#include <map>

#include "commands.hpp"
#include "common.hpp"
#include "findings.hpp"
#include "follow_options.hpp"
#include "interrupt.hpp"
#include "source_options.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

struct OdometryOptions {
  SourceInput input;
  ConfigOptions config;
  ExecOptions exec;
  std::string wheels;
  std::string imu;
  std::string form = "tum";
  std::string output;
};

FollowConfig resolve_odometry(const OdometryOptions& options, const input::Sequence& source) {
  FollowConfig config = resolve_follow(options.config, source.disparities(), source.ground());
  if (config.odometry.method == OdometryMethod::off)
    throw Error("option odometry.method: found off, expected keyframe or frame");
  return config;
}

live::Sensors open_sensors(const OdometryOptions& options, const input::Sequence& source) {
  refuse_two_priors(options.wheels, options.imu);
  live::SensorFiles files;
  if (!options.wheels.empty()) files.odometry = options.wheels;
  if (!options.imu.empty()) files.imu = options.imu;
  return {files, options.input.source, source};
}

/// Totals of the frames, for the last line.
struct Run {
  std::vector<TimedPose> poses;  // to be written: known ones, or one per frame if the format requires
  std::vector<double> milliseconds;
  std::map<std::string, int> refusals;
  std::size_t frames = 0;
  std::size_t lost = 0;
  std::size_t keyframes = 0;
  std::size_t with_prior = 0;
  double path_m = 0;
};

/// Adds the frame's pose; returns whether the format has a line for it.
bool add(Run& run, const TrackedFrame& step, bool keep_lost) {
  if (step.motion.is_new_keyframe) ++run.keyframes;
  if (step.motion.refusal != MotionRefusal::none)
    ++run.refusals[choice_name(step.motion.refusal, kMotionRefusals)];
  if (step.is_lost) ++run.lost;
  if (!step.is_lost && run.frames > 0) run.path_m += length(step.motion.now_from_before.translation_m);
  ++run.frames;
  if (step.is_lost && !keep_lost) return false;
  run.poses.push_back({step.stamp, step.map_from_camera});
  return true;
}

/// The camera's motion without objects.
class CameraMotion {
 public:
  CameraMotion(const StereoRig& rig, const live::Sensors& sensors, Run& run)
      : rig_(rig), sensors_(sensors), run_(run) {}

  TrackedFrame next(const input::SequenceFrame& frame, const FollowConfig& config, const Exec& exec) {
    FrameInput in{{frame.left.gray, frame.left.rgb}, frame.right};
    if (!frame.disparity_px.empty()) in = {in.left, {}, with_holes_marked(frame.disparity_px, exec)};
    StereoResult scene = estimate_disparity(std::move(in), {rig_, config.segmentation, exec});
    const auto start = live::Clock::now();
    if (before_ && clock_step(*before_, frame.stamp) == ClockStep::set_back) before_.reset();
    if (!before_) {
      const Pose first = first_pose(scene.ground, rig_);
      from_level_ = camera_from_level(first);
      state_ = begin_odometry(first);
    }
    std::optional<MotionPrior> prior;
    if (before_) prior = sensors_.between(*before_, frame.stamp, from_level_);
    if (prior) ++run_.with_prior;
    if (before_ && frame.after_gap) state_ = after_gap(std::move(state_));
    OdometryStep moved = advance_odometry(state_, {frame.left.gray, scene.disparity, scene.confidence, {}},
                                          *rig_, prior, config.odometry);
    run_.milliseconds.push_back(live::ms_between(start, live::Clock::now()));
    state_ = std::move(moved.state);
    before_ = frame.stamp;
    TrackedFrame step;
    step.stamp = frame.stamp;
    step.motion = moved.motion;
    step.map_from_camera = state_.map_from_camera;
    step.is_lost = state_.lost;
    static_cast<StereoResult&>(step.frame) = std::move(scene);  // by which the rig is judged
    return step;
  }

 private:
  std::optional<StereoRig> rig_;  // always known
  const live::Sensors& sensors_;
  Run& run_;
  OdometryState state_;
  Pose from_level_;
  std::optional<Stamp> before_;
};

/// Prints the poses, or keeps them for the file.
class Poses : public live::Sink {
 public:
  Poses(output::TrajectoryForm form, bool prints, std::optional<std::size_t> frames, Run& run)
      : form_(form), prints_(prints), run_(run), progress_(frames.value_or(2)) {}
  void offer(const live::LiveFramePtr& frame) override {
    progress_.at(run_.frames, frame->pair->name);
    if (!frame->changes.empty()) {
      progress_.clear();
      std::cerr << changes_text(frame->pair->name, frame->changes);
    }
    if (!add(run_, frame->step, form_ == output::TrajectoryForm::kitti) || !prints_) return;
    progress_.clear();
    std::cout << output::trajectory_text({run_.poses.back()}, form_) << std::flush;
    run_.poses.clear();
  }
  void finish() override { progress_.clear(); }

 private:
  output::TrajectoryForm form_;
  bool prints_;
  Run& run_;
  Progress progress_;
};

std::string summary(const Run& run, const live::Sensors& sensors) {
  std::string all = std::to_string(run.frames) + (run.frames == 1 ? " frame, " : " frames, ") +
                    text_of("%.2f m", run.path_m) + " of path, " + std::to_string(run.keyframes) +
                    (run.keyframes == 1 ? " keyframe" : " keyframes");
  if (!run.milliseconds.empty()) {
    std::vector<double> sorted = run.milliseconds;
    std::sort(sorted.begin(), sorted.end());
    all += ", " + text_of("%.1f ms", sorted[sorted.size() / 2]) + " per frame without matching";
  }
  all += "\n";
  if (!sensors.description().empty())
    all += "prior: " + sensors.description() + ", used for " + std::to_string(run.with_prior) + " frames\n";
  for (const std::string& assumed : sensors.assumptions()) all += "cairn: " + assumed + "\n";
  for (const auto& [reason, count] : run.refusals)
    all += "refused: " + std::to_string(count) + " " + reason + "\n";
  if (run.lost > 0) all += "lost: " + std::to_string(run.lost) + " frames, pose unknown\n";
  return all;
}

output::TrajectoryForm form_named(const std::string& name) {
  for (const auto& choice : output::kTrajectoryForms)
    if (choice.name == name) return choice.value;
  throw Error("--form: found " + name + ", expected tum, kitti or euroc");
}

int estimate(const OdometryOptions& options) {
  const output::TrajectoryForm form = form_named(options.form);
  const Exec exec = make_exec(options.exec);
  const std::unique_ptr<input::Sequence> source = open_source(options.input, exec.pool, options.config);
  const EndsBySignal ends(*source);
  const FollowConfig config = resolve_odometry(options, *source);
  if (!source->rig()) {
    throw Error(input::without_password(options.input.source) +
                ": has no calibration, expected --calib (poses are in metres)");
  }
  const live::Sensors sensors = open_sensors(options, *source);
  Run run;
  CameraMotion motion(*source->rig(), sensors, run);
  live::LiveOptions how = live::LiveOptions::unpaced();
  how.is_ended = [] { return is_interrupted() || !std::cout; };
  how.step = [&motion](const auto& frame, const auto& used, const auto& by) {
    return motion.next(frame, used, by);
  };
  live::Runner runner(*source, options.input.source, {}, config, how, exec);
  Poses poses(form, options.output.empty(), source->size(), run);
  runner.add(poses);
  catch_interrupts();
  runner.run();
  if (!options.output.empty()) io::write_file(options.output, output::trajectory_text(run.poses, form));
  std::cerr << remarks_text(*source) << summary(run, sensors);
  return is_interrupted() ? kInterrupted : exit_code_of(*source);
}

}  // namespace

Work declare_odometry(CLI::App& app) {
  auto options = std::make_shared<OdometryOptions>();
  add_source_options(app, options->input);
  add_motion_options(app, options->wheels, options->imu);
  app.add_option("--form", options->form, "form of the poses: tum, kitti or euroc")
      ->type_name("NAME")
      ->capture_default_str();
  add_config_options(app, options->config);
  add_exec_options(app, options->exec);
  add_device_option(app, options->exec);
  app.add_option("-o,--output", options->output, "file for the poses; default: standard output")
      ->type_name("FILE");
  app.footer(
      "A pose is map_from_camera of the left camera (x right, y down, z forward); the origin "
      "of the map is on the\n"
      "floor below the first camera, x forward, y left, z up. Lost frames have no line, except "
      "with --form kitti.\n"
      "docs/stages/odometry.md describes the method and its limits.");
  return [options] { return estimate(*options); };
}

}  // namespace cairn::cli
