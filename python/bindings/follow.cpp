// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/sequence_scores_json.hpp>
#include <cairn/live/runner.hpp>
#include <cairn/output/diagnosis_json.hpp>
#include <cairn/output/follow_files.hpp>
#include <map>
#include <mutex>
#include <set>

#include "bindings.hpp"
#include "frame.hpp"

namespace cairn::python {

/// The source of follow(), a tuple in Python as are the files of its sensors.
struct SourceArguments {
  std::string calib;
  std::string layout;
  double rate_hz = 0;
  std::string frames;
  bool rectify = false;
  std::string topics;
  std::string disparity;
  std::string depth_image;
  std::optional<double> depth_units;
  int binning = 1;
};
CAIRN_TUPLE(SourceArguments, calib, layout, rate_hz, frames, rectify, topics, disparity, depth_image,
            depth_units, binning)
CAIRN_TUPLE(live::SensorFiles, odometry, imu, poses, scan, map, is_map_read_only, start)

CAIRN_NAMES(MotionRefusal, kMotionRefusals)
CAIRN_NAMES(TrackState, kTrackStates)
CAIRN_TUPLE(Point3, x, y, z)
CAIRN_MEMBERS(LandmarkOfTrack, track, landmark, refusal, is_recognised, score)
CAIRN_MEMBERS(Stamp, ns)
CAIRN_MEMBERS(Pose, _rotation, _translation)
CAIRN_MEMBERS(MotionPrior, _kind, now_from_before, covariance)
CAIRN_MEMBERS(Motion, now_from_before, covariance, refusal, is_new_keyframe, is_new_segment, followed,
              inliers, chi2_per_dof, inlier_share)
CAIRN_MEMBERS(Filter3, _position, _covariance)
CAIRN_MEMBERS(Filter6, _position, _velocity, _covariance)
CAIRN_MEMBERS(Place, _stamp, _position, _covariance)
CAIRN_MEMBERS(Track, id, state, is_moving, object, parts, is_joined, _has_place, _position, _covariance,
              _velocity, _extent, _height, _look, confidence, hits, misses, _first, _last, _doubt, _in_parts,
              _as_static, _as_moving, _against_label, _places, _recent, _is_cut, _measured, _seen_from)
CAIRN_MEMBERS(Tracks, _list, _next, _stamp, _odometry_suspect)
CAIRN_MEMBERS(Witnesses, _stereo, _photometric, _temporal, _floor, _odometry, _scan)
CAIRN_MEMBERS(FloorInCamera, _up, _height)
CAIRN_MEMBERS(Reliability, _value, _witnesses, _weakest, _steadiness, _weak_frames, _is_unreliable, _floor)
CAIRN_MEMBERS(OptionCandidate, _option, _value, _restores)
CAIRN_MEMBERS(ControlEvent, _candidate, _is_set, _before, _gain)
CAIRN_MEMBERS(TrackedFrame, index, _stamp, frame, ids, motion, map_from_camera, pose_covariance, is_lost,
              _tracks, _reliability, _control)

}  // namespace cairn::python

namespace pybind11::detail {

/// 4 x 4 numbers.
template <>
struct type_caster<cairn::Pose> {
  PYBIND11_TYPE_CASTER(cairn::Pose, const_name("array"));
  static handle cast(const cairn::Pose& pose, return_value_policy, handle) {
    const auto& r = pose.rotation;
    const cairn::Point3 t = pose.translation_m;
    return cairn::python::array_from(
               cairn::python::Numbers<double>{
                   {r[0], r[1], r[2], t.x, r[3], r[4], r[5], t.y, r[6], r[7], r[8], t.z, 0, 0, 0, 1}, {4, 4}})
        .release();
  }
  bool load(handle from, bool) {
    const auto numbers = array_t<double, array::c_style>::ensure(from);
    if (!numbers || numbers.size() != 16) return false;
    const double* const m = numbers.data();
    value = {{m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]}, {m[3], m[7], m[11]}};
    return true;
  }
};

/// Covariances are square matrices.
template <std::size_t N, ssize_t kSide>
struct matrix_caster {
  using Matrix = std::array<double, N>;
  PYBIND11_TYPE_CASTER(Matrix, const_name("array"));
  static handle cast(const Matrix& from, return_value_policy, handle) {
    return cairn::python::array_from(
               cairn::python::Numbers<double>{{from.begin(), from.end()}, {kSide, kSide}})
        .release();
  }
  bool load(handle from, bool) {
    const auto numbers = array_t<double, array::c_style>::ensure(from);
    if (!numbers || numbers.size() != N) return false;
    std::copy_n(numbers.data(), N, value.begin());
    return true;
  }
};
template <>
struct type_caster<cairn::Covariance3> : matrix_caster<9, 3> {};
template <>
struct type_caster<cairn::Covariance6> : matrix_caster<36, 6> {};

}  // namespace pybind11::detail

namespace cairn::python {
namespace {

// ---- options ----

/// The options of a frame and, without these, of following. `own`: those set by a file or keyword.
struct FollowSettings {
  PyConfig segmentation;
  FollowConfig config;
  std::set<std::string> own;

  [[nodiscard]] FollowConfig suited(const io::Calibration& calibration) const {
    FollowConfig wanted = config;
    wanted.segmentation = segmentation.suited(calibration).config;
    for (const std::string& name : own) require_active(wanted, name);
    return wanted;
  }
};

/// `base`, or what a preset, a file and settings make.
FollowSettings settings(const std::optional<PyConfig>& base, const std::string& preset,
                        const std::optional<std::string>& file, const Settings& of_frame,
                        const Settings& own) {
  FollowSettings made;
  const auto elsewhere = [&](std::string_view name, std::string_view value) {
    if (!is_of_following(name)) return false;
    set(made.config, name, value);
    made.own.emplace(name);
    return true;
  };
  made.segmentation = base ? *base : make_config(preset, file, of_frame, elsewhere);
  for (const auto& [name, text] : own) elsewhere(name, text);
  return made;
}

std::vector<OptionInfo> follow_options() {
  std::vector<OptionInfo> found = options(FollowConfig{});
  std::erase_if(found, [](const OptionInfo& option) { return !is_of_following(option.name); });
  return found;
}

// ---- following ----

output::Provenance provenance(const FollowSettings& settings, const Config& config,
                              const std::optional<StereoRig>& rig, Stamp stamp, bool is_given) {
  return {settings.segmentation.preset, config, rig, {}, is_given, stamp.ns};
}

/// Pair by pair: a step, and the provenance of its frame.
class PyFollower {
 public:
  PyFollower(FollowSettings settings, PyCalibration calibration, const Exec& exec)
      : settings_(std::move(settings)),
        calibration_(std::move(calibration)),
        follower_(settings_.suited(calibration_.calibration), calibration_.rig(), exec) {}

  std::tuple<TrackedFrame, output::Provenance> next(const LoadedImage& left, const LoadedImage& right,
                                                    std::int64_t ns, const std::optional<MotionPrior>& prior,
                                                    const std::optional<Pose>& pose) {
    const auto pair = StereoPair::from(left.gray(), right.gray(), left.rgb());
    calibration_.check(pair.size());
    const std::lock_guard<std::mutex> one_at_a_time(busy_);
    const Config used = follower_.config().segmentation;  // the frame may change it for the next one
    TrackedFrame step = follower_.next(pair, Stamp{ns}, prior, pose);
    return {std::move(step), provenance(settings_, used, calibration_.rig(), Stamp{ns}, false)};
  }
  std::tuple<TrackedFrame, output::Provenance> next_given(const LoadedImage& left,
                                                          View<const float> disparity_px, std::int64_t ns,
                                                          const std::optional<MotionPrior>& prior,
                                                          const std::optional<Pose>& pose) {
    calibration_.check(left.gray().size());
    const std::lock_guard<std::mutex> one_at_a_time(busy_);
    const Config used = follower_.config().segmentation;
    TrackedFrame step = follower_.next({left.gray(), left.rgb()}, disparity_px, Stamp{ns}, prior, pose);
    return {std::move(step), provenance(settings_, used, calibration_.rig(), Stamp{ns}, true)};
  }
  void prefetch(const LoadedImage& left, const LoadedImage& right) {
    const auto pair = StereoPair::from(left.gray(), right.gray(), left.rgb());
    calibration_.check(pair.size());
    follower_.prefetch(pair);
  }
  std::vector<OptionInfo> options() {
    const std::lock_guard<std::mutex> one_at_a_time(busy_);
    return cairn::options(follower_.config());
  }

 private:
  FollowSettings settings_;
  PyCalibration calibration_;
  std::mutex busy_;
  Follower follower_;
};

struct FollowedFrame {
  io::LoadedImage left;
  TrackedFrame step;
  output::Provenance how;
  std::string name;
  std::string frame_id;
  std::vector<LandmarkOfTrack> marks;
  std::map<std::int64_t, std::int64_t> landmarks;  // by track id
  std::vector<std::pair<std::string, std::int64_t>> events;
};

/// A whole sequence.
class SequenceIterator {
 public:
  SequenceIterator(const std::string& source, const input::SourceOptions& options,
                   const live::SensorFiles& files, FollowSettings settings, const Exec& exec)
      : settings_(std::move(settings)), source_(input::open_sequence(source, options, exec.pool)) {
    if (!source_->rig() && (files.odometry || files.imu || files.poses || files.map)) {
      throw Error(source_->name() +
                  ": found no calibration with a baseline, expected one: the other files are "
                  "in metres; give one with calib");
    }
    run_.emplace(*source_, source, files,
                 settings_.suited({source_->rig(), {}, source_->disparities(), source_->ground()}),
                 live::LiveOptions::unpaced(), exec);
  }

  std::optional<FollowedFrame> next() {
    const std::lock_guard<std::mutex> one_at_a_time(busy_);
    if (closed_) return std::nullopt;
    const std::shared_ptr<live::LiveFrame> found = run_->next();
    if (!found) {
      close_run(RunState::done);
      return std::nullopt;
    }
    findings_.clear();
    for (const Finding& finding : found->findings) findings_.push_back(output::finding_json(finding, {}));
    const input::SequenceFrame& pair = *found->pair;
    FollowedFrame made{{pair.left.gray.clone(), pair.left.rgb.clone()},
                       std::move(found->step),
                       provenance(settings_, found->config->segmentation, source_->rig(), pair.stamp,
                                  !pair.disparity_px.empty()),
                       pair.name,
                       pair.frame_id,
                       std::move(found->landmarks),
                       {},
                       {}};
    for (const LandmarkOfTrack& of : made.marks) {
      if (of.landmark != LandmarkId::none) made.landmarks[number(of.track)] = number(of.landmark);
    }
    for (const LandmarkEvent& event : found->events)
      made.events.emplace_back(choice_name(event.kind, kLandmarkEventKinds), number(event.landmark));
    return made;
  }

  void close() {
    const std::lock_guard<std::mutex> one_at_a_time(busy_);
    close_run(RunState::aborted);  // before the end of the source
  }
  [[nodiscard]] const input::Sequence& source() const { return *source_; }
  [[nodiscard]] const std::vector<std::string>& findings() const { return findings_; }

 private:
  void close_run(RunState state) {
    if (!closed_) run_->close(state);
    closed_ = true;
  }

  FollowSettings settings_;
  std::unique_ptr<input::Sequence> source_;
  std::optional<live::Runner> run_;
  std::vector<std::string> findings_;  // about the rig, as of the last frame
  std::mutex busy_;
  bool closed_ = false;
};

std::unique_ptr<SequenceIterator> follow(const FollowSettings& settings, const Exec& exec,
                                         const std::string& source, const SourceArguments& how,
                                         const live::SensorFiles& files) {
  input::SourceOptions options;
  options.calib = how.calib;
  options.layout = how.layout;
  options.rate_hz = how.rate_hz;
  options.rectify = how.rectify;
  options.topics = how.topics;
  options.binning = how.binning;
  options.maps = {how.disparity, how.depth_image, how.depth_units};
  if (!how.frames.empty()) options.frames = input::parse_frame_range(how.frames);
  return std::make_unique<SequenceIterator>(source, options, files, settings, exec);
}

// ---- results ----

/// An attribute of tracks with a metric position, else None.
template <auto member>
auto if_placed(const Track& self) {
  return self.has_place ? std::optional(self.*member) : std::nullopt;
}

/// In the map frame, as in tracks.jsonl.
std::vector<Track> tracks_of(const TrackedFrame& step) {
  std::vector<Track> tracks = step.tracks.list;
  for (Track& track : tracks)
    track.covariance_m2 = covariance_in_map(track, step.map_from_camera, step.pose_covariance);
  return tracks;
}

py::dict reliability_of(const TrackedFrame& step) {
  const Reliability& judged = step.reliability;
  py::dict known;
  for (const WitnessName& witness : kWitnesses)
    known[py::str(std::string(witness.name))] = judged.witnesses.*witness.value;
  known["value"] = judged.value;
  known["weakest"] = judged.weakest;
  known["steadiness"] = judged.steadiness;
  known["is_unreliable"] = judged.is_unreliable;
  return known;
}

std::optional<py::dict> control_of(const TrackedFrame& step) {
  if (!step.control) return std::nullopt;
  py::dict known;
  known["option"] = step.control->candidate.option;
  known["value"] = step.control->candidate.value;
  known["before"] = step.control->before;
  known["lead"] = step.control->gain;
  known["is_set"] = step.control->is_set;
  return known;
}

void bind_results(py::module_& m) {
  auto track = value_class<Track>(m, "Track");
  shows(track, "position_m", &if_placed<&Track::position_m>);
  shows(track, "covariance_m2", &if_placed<&Track::covariance_m2>);
  shows(track, "velocity_m_s", &if_placed<&Track::velocity_m_s>);
  shows(track, "extent_m", &if_placed<&Track::extent_m>);
  shows(track, "first_ns", [](const Track& self) { return self.first.ns; });
  shows(track, "last_ns", [](const Track& self) { return self.last.ns; });
  value_class<Motion>(m, "Motion");
  auto prior = value_class<MotionPrior>(m, "MotionPrior");
  prior.def(py::init([](const Pose& now_from_before, const Covariance6& covariance, bool is_gyroscope) {
    return MotionPrior{is_gyroscope ? PriorKind::gyroscope : PriorKind::wheels, now_from_before, covariance};
  }));
  shows(prior, "_is_gyroscope", [](const MotionPrior& self) { return self.kind == PriorKind::gyroscope; });
  auto data = value_class<TrackedFrame>(m, "StepData");
  shows(data, "stamp_ns", [](const TrackedFrame& self) { return self.stamp.ns; });
  shows(data, "tracks", &tracks_of);
  shows(data, "odometry_suspect", [](const TrackedFrame& self) { return self.tracks.odometry_suspect; });
  shows(data, "reliability", &reliability_of);
  shows(data, "control", &control_of);
  m.def("step_json", [](const TrackedFrame& step, const std::string& name, const std::string& frame_id,
                        const py::list& landmarks) {
    LandmarkUpdate marked;
    restore(landmarks, marked.tracks);
    const py::gil_scoped_release others_run;
    return output::step_json(step, name, marked, frame_id);
  });
  m.def(
      "draw_tracks",
      [](const LoadedImage& left, const TrackedFrame& step) {
        return output::draw_tracks(left.gray(), left.rgb(), step);
      },
      Released());
}

}  // namespace

void bind_follow(py::module_& m) {
  bind_results(m);
  m.def("follow_options", &follow_options);
  py::class_<FollowSettings>(m, "FollowSettings").def(py::init(&settings));
  py::class_<PyFollower>(m, "Pairs")
      .def(py::init<FollowSettings, PyCalibration, const Exec&>())
      .def("prefetch", &PyFollower::prefetch, Released())
      .def("next", &PyFollower::next, Released())
      .def("next_given", &PyFollower::next_given, Released())
      .def("options", &PyFollower::options, Released());
  m.def("follow", &follow, Released());
  m.def(
      "score_sequence",
      [](const std::filesystem::path& result, const std::filesystem::path& truth, int min_area,
         bool tentative) {
        return output::json_text(
            input::json_of(input::score_sequence(result, input::load_truth(truth), {min_area, tentative})));
      },
      Released());
  py::class_<FollowedFrame> followed(m, "FollowedFrame");
  followed.def_readonly("landmarks", &FollowedFrame::landmarks)
      .def_readonly("events", &FollowedFrame::events)
      .def("line",
           [](const FollowedFrame& self) {
             return py::make_tuple(self.name, self.frame_id, state_of(self.marks));
           })
      .def("parts", [](FollowedFrame& self) {
        return std::tuple(std::move(self.left), std::move(self.step), std::move(self.how));
      });
  py::class_<SequenceIterator>(m, "Sequence")
      .def("next", &SequenceIterator::next, Released())
      .def("close", &SequenceIterator::close, Released())
      .def("rig", [](const SequenceIterator& self) { return self.source().rig(); })
      .def("size", [](const SequenceIterator& self) { return self.source().size(); })
      .def("findings", &SequenceIterator::findings)
      .def("ended_early", [](const SequenceIterator& self) { return self.source().ended_early(); })
      .def("remarks", [](const SequenceIterator& self) {
        std::vector<std::pair<std::string, std::size_t>> all;
        for (const input::SourceRemark& remark : self.source().remarks())
          all.emplace_back(remark.what, remark.count);
        return all;
      });
}

}  // namespace cairn::python
