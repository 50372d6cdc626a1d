// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <source/follow_files.hpp>
#include <source/sequence_run.hpp>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "frame.hpp"
#include "options.hpp"
#include "pickling.hpp"
#include "refusals.hpp"
#include "rig.hpp"

namespace cairn::python {

template <>
struct NumbersOf<TrackId> {
  using Type = std::int64_t;
  static constexpr int kCount = 1;
};
CAIRN_PARTS(Stamp, ns)
CAIRN_PARTS(Point3, x, y, z)
CAIRN_PARTS(Pose, rotation, translation)
CAIRN_PARTS(MotionPrior, kind, now_from_before, covariance)
CAIRN_PARTS(Motion, now_from_before, covariance, refusal, is_new_keyframe, is_new_segment, followed, inliers,
            chi2, inlier_share)
CAIRN_PARTS(Filter3, position, covariance)
CAIRN_PARTS(Filter6, position, velocity, covariance)
CAIRN_PARTS(Place, stamp, position, covariance)
CAIRN_PARTS(Track, id, state, is_moving, object, parts, is_joined, has_place, position, covariance, velocity,
            extent, height, look, confidence, hits, misses, first, last, doubt, in_parts, as_static,
            as_moving, against_label, places, recent, is_cut, measured, seen_from)
CAIRN_PARTS(Tracks, list, next, stamp, odometry_suspect)
CAIRN_PARTS(Witnesses, stereo, photometric, temporal, floor, odometry, scan)
CAIRN_PARTS(FloorInCamera, up, height)
CAIRN_PARTS(Reliability, mean, witnesses, weakest, steady, weak_frames, is_unreliable, floor)
CAIRN_PARTS(Step, index, stamp, frame, ids, motion, map_from_camera, pose_covariance, is_lost, tracks, trust)

namespace {

namespace fs = std::filesystem;
using TripleOfDoubles = std::tuple<double, double, double>;

// ---- numbers ----

template <std::size_t N>
Array<double> matrix(const std::array<double, N>& numbers) {
  constexpr py::ssize_t kSide = N == 9 ? 3 : 6;
  static_assert(kSide * kSide == N);
  py::array_t<double> made({kSide, kSide});
  std::copy(numbers.begin(), numbers.end(), made.mutable_data());
  return Array<double>(std::move(made));
}

Array<double> matrix(const Pose& pose) {
  py::array_t<double> made({4, 4});
  auto to = made.mutable_unchecked<2>();
  const std::array<double, 3> t{pose.translation_m.x, pose.translation_m.y, pose.translation_m.z};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      const auto r = static_cast<std::size_t>(row);
      if (row == 3) {
        to(row, column) = column == 3 ? 1 : 0;
      } else {
        to(row, column) = column == 3 ? t[r] : pose.rotation[r * 3 + static_cast<std::size_t>(column)];
      }
    }
  }
  return Array<double>(std::move(made));
}

/// Throws Error unless it is a square of finite numbers.
py::array_t<double> square(const py::object& value, py::ssize_t side, const std::string& name) {
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  PyErr_Clear();
  const std::string expected =
      ", expected " + std::to_string(side) + " x " + std::to_string(side) + " numbers";
  if (!numbers) throw ArgumentError(name + ": found " + shown(value) + expected);
  if (numbers.ndim() != 2 || numbers.shape(0) != side || numbers.shape(1) != side) {
    throw Error(name + ": found an array of shape " + py::str(numbers.attr("shape")).cast<std::string>() +
                expected);
  }
  if (!std::all_of(numbers.data(), numbers.data() + numbers.size(),
                   [](double v) { return std::isfinite(v); }))
    throw Error(name + ": found a number that is not finite" + expected);
  return numbers;
}

Pose pose_from(const py::object& value, const std::string& name) {
  const auto numbers = square(value, 4, name);
  const auto at = numbers.unchecked<2>();
  Pose pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      pose.rotation[static_cast<std::size_t>(row * 3 + column)] = at(row, column);
  }
  pose.translation_m = {at(0, 3), at(1, 3), at(2, 3)};
  constexpr double kNear = 1e-3;
  bool is_rigid = at(3, 0) == 0 && at(3, 1) == 0 && at(3, 2) == 0 && at(3, 3) == 1;
  const auto row = [&](int r) { return Point3{at(r, 0), at(r, 1), at(r, 2)}; };
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b)
      is_rigid = is_rigid && std::abs(dot(row(a), row(b)) - (a == b ? 1 : 0)) < kNear;
  }
  const Point3 across{at(0, 1) * at(1, 2) - at(0, 2) * at(1, 1), at(0, 2) * at(1, 0) - at(0, 0) * at(1, 2),
                      at(0, 0) * at(1, 1) - at(0, 1) * at(1, 0)};
  if (!is_rigid || dot(across, row(2)) < 0) {
    throw Error(name +
                ": found no rigid motion, expected a rotation and a translation above a row of 0, 0, 0, 1");
  }
  return pose;
}

MotionPrior make_prior(const py::object& now_from_before, const py::object& covariance,
                       const std::string& kind) {
  MotionPrior prior;
  prior.now_from_before = pose_from(now_from_before, "now_from_before");
  const auto numbers = square(covariance, 6, "covariance");
  std::copy_n(numbers.data(), prior.covariance.size(), prior.covariance.begin());
  if (kind != "wheels" && kind != "gyroscope")
    throw Error("kind: found '" + kind + "', expected 'wheels' or 'gyroscope'");
  prior.kind = kind == "wheels" ? PriorKind::wheels : PriorKind::gyroscope;
  return prior;
}

std::string name_of(PriorKind kind) {
  return kind == PriorKind::wheels ? "wheels" : "gyroscope";
}

Stamp stamp_from(const py::object& stamp_ns, std::optional<double> seconds) {
  if (stamp_ns.is_none() != seconds.has_value())
    throw ArgumentError(std::string("stamp_ns: found ") +
                        (seconds ? "seconds as well" : "neither it nor seconds") +
                        ", expected one of the two");
  if (!seconds) {
    if (PyIndex_Check(stamp_ns.ptr()) == 0)
      throw ArgumentError("stamp_ns: found " + shown(stamp_ns) + ", expected a whole number");
    return {py::int_(stamp_ns).cast<std::int64_t>()};
  }
  constexpr double kMost = 9.2e9;
  if (!(std::abs(*seconds) < kMost))
    throw Error("seconds: found " + py::repr(py::float_(*seconds)).cast<std::string>() +
                ", expected ±9.2e9 at most");
  return {std::llround(*seconds * 1e9)};
}

// ---- options ----

struct Settings {
  PyConfig segmentation;
  FollowConfig config;  // segmentation left out
  std::set<std::string> own;

  [[nodiscard]] FollowConfig suited(const io::Calibration& calibration) const {
    FollowConfig wanted = config;
    wanted.segmentation = segmentation.suited(calibration);
    for (const std::string& name : own) require_active(wanted, name);
    return wanted;
  }
};

Settings settings(const py::object& config, const std::string& preset, const py::kwargs& groups) {
  Settings made;
  const auto elsewhere = [&](std::string_view name, std::string_view value) {
    if (!is_of_following(name)) return false;
    set(made.config, name, value);
    made.own.emplace(name);
    return true;
  };
  py::kwargs of_segmentation;
  std::vector<std::pair<std::string, std::string>> of_following;
  for (const auto& [key, value] : groups) {
    const auto group = key.cast<std::string>();
    if (!is_of_following(group)) {
      of_segmentation[key] = value;
    } else {
      for (auto& setting : settings_of(group, value)) of_following.push_back(std::move(setting));
    }
  }
  made.segmentation = config_of(config, preset, of_segmentation, elsewhere);
  for (const auto& [name, text] : of_following) elsewhere(name, text);
  return made;
}

std::vector<OptionInfo> follow_options() {
  std::vector<OptionInfo> found;
  for (OptionInfo& option : options(FollowConfig{})) {
    if (is_of_following(option.name)) found.push_back(std::move(option));
  }
  return found;
}

Groups follow_groups() {
  Groups groups = all_groups();
  for (const OptionInfo& option : follow_options()) {
    const std::string group = option.name.substr(0, option.name.find('.'));
    if (groups.back() != group) groups.push_back(group);
  }
  return groups;
}

// ---- steps ----

/// A step, its pictures, and what `cairn follow` says of it.
struct PyStep {
  std::shared_ptr<Step> step;
  py::object frame;  // a PyFrame over step->frame
  std::string json;
  std::map<std::int64_t, std::int64_t> landmarks;  // by track
  std::vector<std::pair<std::string, std::int64_t>> events;
};

py::object frame_over(const std::shared_ptr<Step>& step, Picture left, io::Provenance provenance) {
  const std::shared_ptr<Frame> whole(step, &step->frame);
  return py::cast(std::make_unique<PyFrame>(std::move(left), whole, std::move(provenance)));
}

Image<Rgb> overlay(const PyStep& self) {
  const auto& left = self.frame.cast<const PyFrame&>().left;
  return released([&] { return io::draw_tracks(left.gray(), left.rgb(), *self.step); });
}

class PyFollower {
 public:
  PyFollower(const RigArgument& rig, const std::string& preset, const py::object& config,
             const py::object& exec, const py::kwargs& options)
      : PyFollower(calibration_of(rig), settings(config, preset, options), exec_of(exec)) {}
  PyFollower(PyCalibration calibration, const Settings& settings, const Exec& exec)
      : calibration_(std::move(calibration)),
        preset_(settings.segmentation.preset),
        pool_(exec.pool),
        follower_(settings.suited(calibration_.calibration), calibration_.calibration.rig, exec) {}

  std::unique_ptr<PyStep> next(const ImageArgument& left, const ImageArgument& right,
                               const py::object& stamp_ns, std::optional<double> seconds,
                               const std::optional<MotionPrior>& prior, const py::object& pose, bool bgr) {
    Picture l(left, "left", bgr, pool_);
    const Picture r(right, "right", bgr, pool_);
    const auto pair = StereoPair::from(l.gray(), r.gray(), l.rgb());
    io::check_size(calibration_.calibration, pair.size(), calibration_.path);
    io::check_search_range(calibration_.calibration, calibration_.path);
    const Stamp stamp = stamp_from(stamp_ns, seconds);
    std::optional<Pose> known;
    if (!pose.is_none()) known = pose_from(pose, "pose");
    auto made = std::make_unique<PyStep>();
    made->step = released([&] {
      const std::lock_guard<std::mutex> one_at_a_time(busy_);
      return std::make_shared<Step>(follower_.next(pair, stamp, prior, known));
    });
    made->json = io::step_json(*made->step, std::to_string(made->step->index));
    io::Provenance provenance{preset_, config().segmentation, calibration_.calibration.rig, {}};
    made->frame = frame_over(made->step, std::move(l), std::move(provenance));
    return made;
  }

  [[nodiscard]] const PyCalibration& calibration() const { return calibration_; }
  [[nodiscard]] const FollowConfig& config() const { return follower_.config(); }

 private:
  PyCalibration calibration_;
  std::string preset_;
  Pool pool_;
  std::mutex busy_;
  Follower follower_;
};

// ---- whole sequences ----

void check(const io::CompanionFiles& files, const io::Sequence& source) {
  if (files.odometry.has_value() + files.imu.has_value() + files.poses.has_value() > 1)
    throw Error("odometry_file, imu_file, poses_file: found more than one, expected one of the three");
  if (files.is_map_read_only && !files.map)
    throw Error("read_only: found True without map_file, expected both");
  if (!source.rig() && (files.odometry || files.imu || files.poses || files.map))
    throw Error(source.name() +
                ": found no calibration with a baseline, expected one: the other files are "
                "in metres; give one with calib");
}

class Following {
 public:
  Following(std::unique_ptr<io::Sequence> source, const std::string& name, const io::CompanionFiles& files,
            const Settings& settings, const Exec& exec)
      : source_(std::move(source)), preset_(settings.segmentation.preset) {
    check(files, *source_);
    run_.emplace(*source_, name, files,
                 settings.suited({source_->rig(), {}, source_->disparities(), source_->ground()}), exec);
  }

  std::unique_ptr<PyStep> next() {
    auto made = std::make_unique<PyStep>();
    std::optional<io::SequenceFrame> frame;
    released([&] {
      const std::lock_guard<std::mutex> one_at_a_time(busy_);
      if (closed_) return;
      frame = source_->next();
      if (!frame) return;
      made->step = std::make_shared<Step>(run_->next(*frame));
      const Landmarked& marked = run_->marked();
      made->json = io::step_json(*made->step, frame->name, marked);
      for (const LandmarkOfTrack& of : marked.tracks) {
        if (of.landmark != LandmarkId::none) made->landmarks[number(of.track)] = number(of.landmark);
      }
      for (const LandmarkEvent& event : marked.events)
        made->events.emplace_back(choice_name(event.kind, kLandmarkEventKinds), number(event.landmark));
    });
    if (!frame) {
      close();
      throw py::stop_iteration();
    }
    const py::object left = frame->left.rgb.empty() ? py::object(array_from(std::move(frame->left.gray)))
                                                    : py::object(array_from(std::move(frame->left.rgb)));
    io::Provenance provenance{preset_, run_->config().segmentation, source_->rig(), {}};
    made->frame = frame_over(made->step, Picture(left, "left", false, {}), std::move(provenance));
    return made;
  }

  void close() {
    released([&] {
      const std::lock_guard<std::mutex> one_at_a_time(busy_);
      if (closed_) return;
      closed_ = true;
      run_->close(RunState::done);
    });
  }
  [[nodiscard]] const io::Sequence& source() const { return *source_; }

 private:
  std::unique_ptr<io::Sequence> source_;
  std::string preset_;
  std::optional<io::SequenceRun> run_;
  std::mutex busy_;
  bool closed_ = false;
};

std::unique_ptr<Following> follow(const std::string& source, const std::optional<fs::path>& calib,
                                  const std::string& layout, double rate_hz, const std::string& frames,
                                  bool rectify, const io::CompanionFiles& files, const Settings& settings,
                                  const Exec& exec) {
  io::SourceOptions options;
  if (calib) options.calib = calib->string();
  options.layout = layout;
  options.rate_hz = rate_hz;
  options.rectify = rectify;
  if (!frames.empty()) options.frames = io::parse_frame_range(frames);
  auto opened = released([&] { return io::open_sequence(source, options, exec.pool); });
  return std::make_unique<Following>(std::move(opened), source, files, settings, exec);
}

// ---- what the classes show ----

std::string decimal(const char* format, double value) {
  return py::str(format).format(value).cast<std::string>();
}
std::string at_m(Point3 p) {
  return "(" + decimal("{:.2f}, ", p.x) + decimal("{:.2f}, ", p.y) + decimal("{:.2f}) m", p.z);
}

TripleOfDoubles triple_of(Point3 p) {
  return {p.x, p.y, p.z};
}
/// A property that is None where the track has no place in metres.
template <class Show>
auto if_placed(Show show) {
  return [show](const Track& self) -> std::optional<decltype(show(self))> {
    if (!self.has_place) return std::nullopt;
    return show(self);
  };
}

std::string track_repr(const Track& self) {
  return "<cairn.Track " + std::to_string(number(self.id)) + ": " + choice_name(self.state, kTrackStates) +
         (self.is_moving ? ", moving" : "") + (self.has_place ? ", at " + at_m(self.position_m) : "") + ">";
}

std::string step_repr(const PyStep& self) {
  const Step& step = *self.step;
  const auto seen =
      std::ranges::count_if(step.tracks.list, [](const Track& t) { return t.object != ObjectId::none; });
  return "<cairn.Step " + std::to_string(step.index) + " at " +
         decimal("{:.3f} s", double(step.stamp.ns) * 1e-9) + ": " + std::to_string(seen) +
         (seen == 1 ? " track in view" : " tracks in view") +
         (step.is_lost ? ", place not known" : ", camera at " + at_m(step.map_from_camera.translation_m)) +
         ">";
}

void bind_results(py::module_& m) {
  using py::literals::operator""_a;
  py::class_<Track>(m, "Track",
                    "An object over time. Metres are those of the map's frame: z up, its origin on the "
                    "floor below the first frame's camera, x forward.")
      .def_property_readonly(
          "id", [](const Track& t) { return number(t.id); }, "from 1; never used twice in a run")
      .def_property_readonly(
          "state", [](const Track& t) { return choice_name(t.state, kTrackStates); },
          "'tentative', 'confirmed', 'occluded', 'out_of_view', 'lost' or 'dead'")
      .def_readonly("is_moving", &Track::is_moving, "by itself, not by the camera's motion")
      .def_property_readonly(
          "object", [](const Track& t) { return number(t.object); },
          "id of its Object in this frame; 0 = not seen")
      .def_property_readonly(
          "parts",
          [](const Track& t) {
            std::vector<std::int32_t> ids;
            for (const ObjectId id : t.parts) ids.push_back(number(id));
            return ids;
          },
          "ids of further objects of this frame that are pieces of it")
      .def_readonly("is_joined", &Track::is_joined, "this frame shows it as one object with another track")
      .def_property_readonly("position_m", if_placed([](const Track& t) { return triple_of(t.position_m); }),
                             "(x, y, z), m; None without a rig")
      .def_property_readonly("covariance_m2",
                             if_placed([](const Track& t) { return matrix(t.covariance_m2); }),
                             "3 x 3 of position_m, m²; None without a rig")
      .def_property_readonly("velocity_m_s",
                             if_placed([](const Track& t) { return triple_of(t.velocity_m_s); }),
                             "(x, y, z), m/s; 0 where it stands; None without a rig")
      .def_property_readonly(
          "extent_m", if_placed([](const Track& t) { return triple(t.extent_m); }),
          "(x, y, z) in the camera's frame, m: the box around its points; None without a rig")
      .def_readonly("confidence", &Track::confidence, "0 to 1, smoothed")
      .def_readonly("hits", &Track::hits, "frames in which it was seen")
      .def_readonly("misses", &Track::misses, "frames since then in which it should have been seen")
      .def_property_readonly(
          "first_ns", [](const Track& t) { return t.first.ns; }, "stamp of its first frame, ns")
      .def_property_readonly(
          "last_ns", [](const Track& t) { return t.last.ns; }, "stamp when it was last seen, ns")
      .def("__repr__", &track_repr)
      .def(pickled<Track>());

  py::class_<Motion>(m, "Motion", "The camera's motion that one frame shows, or why it shows none.")
      .def_property_readonly(
          "now_from_before", [](const Motion& self) { return matrix(self.now_from_before); },
          "4 x 4: points of the frame before go to this one; where refused, its stand-in")
      .def_property_readonly(
          "covariance", [](const Motion& self) { return matrix(self.covariance); },
          "6 x 6 of the pose against the keyframe, translation (m) before rotation (rad)")
      .def_property_readonly(
          "refusal", [](const Motion& self) { return choice_name(self.refusal, kMotionRefusals); },
          "'none' where it was estimated, else why not: 'few_points', 'no_rig', …")
      .def_readonly("is_new_keyframe", &Motion::is_new_keyframe,
                    "whether the next motions are against this frame")
      .def_readonly("is_new_segment", &Motion::is_new_segment,
                    "whether only a guess ties what is seen from here on to what was seen before")
      .def_readonly("followed", &Motion::followed, "corners that were followed")
      .def_readonly("inliers", &Motion::inliers, "corners that agree")
      .def_readonly("inlier_share", &Motion::inlier_share, "0 to 1: of the corners that were followed")
      .def_readonly("chi2_per_dof", &Motion::chi2_per_dof, "1 where errors are as large as assumed")
      .def("__repr__",
           [](const Motion& self) {
             return "<cairn.Motion " + choice_name(self.refusal, kMotionRefusals) + ", " +
                    std::to_string(self.inliers) + " of " + std::to_string(self.followed) + " corners>";
           })
      .def(pickled<Motion>());

  py::class_<MotionPrior>(m, "MotionPrior",
                          "What another sensor says of the camera's motion since the frame before.")
      .def(py::init(&make_prior), "now_from_before"_a, "covariance"_a, "kind"_a = "wheels",
           "now_from_before: 4 x 4, takes points of the camera's frame then to its frame now. covariance: 6 "
           "x 6, "
           "translation (m) before rotation (rad). kind: 'wheels', or 'gyroscope', of which only the "
           "rotation counts.")
      .def_property_readonly(
          "now_from_before", [](const MotionPrior& self) { return matrix(self.now_from_before); },
          "4 x 4 float64")
      .def_property_readonly(
          "covariance", [](const MotionPrior& self) { return matrix(self.covariance); }, "6 x 6 float64")
      .def_property_readonly(
          "kind", [](const MotionPrior& self) { return name_of(self.kind); }, "'wheels' or 'gyroscope'")
      .def("__repr__",
           [](const MotionPrior& self) { return "<cairn.MotionPrior of " + name_of(self.kind) + ">"; })
      .def(pickled<MotionPrior>());

  py::class_<PyStep>(m, "Step", "All that is known after one frame of a sequence.")
      .def_property_readonly(
          "index", [](const PyStep& self) { return self.step->index; }, "the frame's number, from 0")
      .def_property_readonly(
          "stamp_ns", [](const PyStep& self) { return self.step->stamp.ns; }, "when it was taken, ns")
      .def_property_readonly(
          "seconds", [](const PyStep& self) { return double(self.step->stamp.ns) * 1e-9; },
          "when it was taken, s")
      .def_property_readonly(
          "frame", [](const PyStep& self) { return self.frame; }, "the Frame")
      .def_property_readonly(
          "ids",
          [](const py::object& self) {
            return array_over(self.cast<const PyStep&>().step->ids, self, false);
          },
          "(H, W) int64, read-only: the track that each pixel belongs to; 0 = none")
      .def_property_readonly(
          "tracks", [](const PyStep& self) { return self.step->tracks.list; },
          "a list of Track by id, those out of view included")
      .def_property_readonly(
          "motion", [](const PyStep& self) { return self.step->motion; }, "the camera's Motion")
      .def_property_readonly(
          "map_from_camera", [](const PyStep& self) { return matrix(self.step->map_from_camera); },
          "4 x 4 float64: where the left camera is; takes points of its frame to the map's")
      .def_property_readonly(
          "pose_covariance", [](const PyStep& self) { return matrix(self.step->pose_covariance); },
          "6 x 6 of map_from_camera, translation (m) before rotation (rad)")
      .def_property_readonly(
          "is_lost", [](const PyStep& self) { return self.step->is_lost; },
          "whether the camera's place is not known")
      .def_property_readonly(
          "reliability",
          [](const PyStep& self) {
            const Reliability& judged = self.step->reliability;
            py::dict known;
            for (const WitnessName& witness : kWitnesses)
              known[py::str(std::string(witness.name))] = judged.witnesses.*witness.value;
            known["value"] = judged.value;
            known["weakest"] = judged.weakest;
            known["steadiness"] = judged.steadiness;
            known["is_unreliable"] = judged.is_unreliable;
            return known;
          },
          "how far the frame is to be trusted: value (0 ... 1 or None), the witnesses it is the mean of, and "
          "the weakest one's name")
      .def_property_readonly(
          "odometry_suspect", [](const PyStep& self) { return self.step->tracks.odometry_suspect; },
          "whether most tracks began to move at once: rather the camera's motion is wrong")
      .def_readonly("landmarks", &PyStep::landmarks, "of follow(): landmark by track, both by id")
      .def_readonly("events", &PyStep::events,
                    "of follow(): (kind, landmark), kind 'new', 'moved', 'gone', 'back' or 'relocated'")
      .def(
          "to_json", [](const PyStep& self) { return self.json; },
          "The frame's line of tracks.jsonl, as `cairn follow --json-lines` prints it (docs/formats.md).")
      .def(
          "overlay", [](const PyStep& self) { return array_from(overlay(self)); },
          "The left picture with its tracks drawn in, each with its id: (h, w, 3) uint8, RGB.")
      .def("_repr_png_",
           [](const PyStep& self) {
             const Image<Rgb> drawn = overlay(self);
             return py::bytes(io::png_bytes(drawn));
           })
      .def("__repr__", &step_repr)
      .def(py::pickle(
          [](const PyStep& self) {
            const auto& frame = self.frame.cast<const PyFrame&>();
            return versioned(py::make_tuple(frame.left.copy(), state_of(*self.step),
                                            state_of(frame.provenance), self.json, self.landmarks,
                                            self.events));
          },
          [](const py::tuple& state) {
            const auto parts = py::reinterpret_borrow<py::tuple>(of_this_version(state));
            auto made = std::make_unique<PyStep>();
            made->step = std::make_shared<Step>();
            restore(parts[1], *made->step);
            io::Provenance provenance;
            restore(parts[2], provenance);
            made->frame = frame_over(made->step, Picture(parts[0], "left", false, {}), std::move(provenance));
            made->json = parts[3].cast<std::string>();
            made->landmarks = parts[4].cast<decltype(made->landmarks)>();
            made->events = parts[5].cast<decltype(made->events)>();
            return made;
          }));
}

}  // namespace

void bind_follow(py::module_& m) {
  using py::literals::operator""_a;
  bind_results(m);
  m.def("follow_options", &follow_options,
        "Every option of sequences with its default, in the order of the stages; those of a frame are in "
        "options().");

  constexpr const char* kOptions =
      " preset, config (a Config or a file's name) and options are those of segment(), with the groups of "
      "follow_options() besides: tracking={'min_hits': 2}.";
  const std::string follower_doc =
      std::string("Follows the camera and the objects through a sequence, pair by pair.") + kOptions +
      " Without a rig there are ids, but no metres and no motion.";
  py::class_<PyFollower>(m, "Follower", follower_doc.c_str())
      .def(py::init<const RigArgument&, const std::string&, const py::object&, const py::object&,
                    const py::kwargs&>(),
           "rig"_a = py::none(), py::kw_only(), "preset"_a = "default", "config"_a = py::none(),
           "exec"_a = py::none(),
           "rig: a Rig, a Calibration or None. Raises cairn.Error for what cannot be used.")
      .def("next", &PyFollower::next, "left"_a, "right"_a, "stamp_ns"_a = py::none(), py::kw_only(),
           "seconds"_a = py::none(), "prior"_a = py::none(), "pose"_a = py::none(), "bgr"_a = false,
           "The next frame: a Step. stamp_ns or seconds: when it was taken, later than the one before. "
           "prior: a "
           "MotionPrior since the frame before. pose: 4 x 4 map_from_camera of a robot that knows where it "
           "is; then "
           "no motion is estimated. Raises cairn.Error for another size than the first pair's and stamps "
           "that do not "
           "rise.")
      .def_property_readonly(
          "rig", [](const PyFollower& self) { return self.calibration().calibration.rig; },
          "the Rig that it measures with, or None")
      .def(
          "__getitem__",
          [](const PyFollower& self, const std::string& name) {
            for (const OptionInfo& option : options(self.config())) {
              if (option.name == name) return option.value;
            }
            FollowConfig copy;
            set(copy, name, "");  // throws, with the nearest name
            return std::string();
          },
          "name"_a, "The value of an option by its full name, as text.")
      .def("__repr__", [](const PyFollower& self) {
        const auto& rig = self.calibration().calibration.rig;
        return "<cairn.Follower, " + (rig ? py::repr(py::cast(*rig)).cast<std::string>() : "no rig") + ">";
      });
  note_groups(m, "Follower", follow_groups(), true);

  py::class_<Following>(m, "Following", "What follow() returns: an iterator of Steps over a source.")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &Following::next)
      .def("__enter__", [](const py::object& self) { return self; })
      .def("__exit__", [](Following& self, const py::args&) { self.close(); })
      .def("close", &Following::close, "Ends the run, in the map, too; reading to the end does so by itself.")
      .def_property_readonly(
          "rig", [](const Following& self) { return self.source().rig(); }, "the source's Rig, or None")
      .def_property_readonly(
          "size", [](const Following& self) { return self.source().size(); },
          "frames at most; None where it is not known")
      .def_property_readonly(
          "remarks",
          [](const Following& self) {
            std::vector<std::pair<std::string, std::size_t>> all;
            for (const io::SourceRemark& remark : self.source().remarks())
              all.emplace_back(remark.what, remark.count);
            return all;
          },
          "what was noticed of the source's frames up to now: (words, frames)")
      .def_property_readonly(
          "ended_early", [](const Following& self) { return self.source().ended_early(); },
          "why the source ended before its end; '' where it did not")
      .def("__repr__",
           [](const Following& self) { return "<cairn.Following " + self.source().name() + ">"; });

  const std::string follow_doc =
      std::string(
          "Follows a whole sequence: an iterator of Steps.\n"
          "source: a folder of frames, of KITTI's or EuRoC's, 'LEFT,RIGHT', or a video with layout "
          "(docs/sequences.md). "
          "calib: instead of the source's own. frames: 'A:B:STEP'. rectify: the pictures are raw. "
          "odometry_file, imu_file, "
          "poses_file: what other sensors say of the motion. map_file: landmarks to recognise and to add to; "
          "read_only: it "
          "stays as it is. These are the options of `cairn follow`, and the steps are its own.") +
      kOptions;
  m.def(
      "follow",
      [](const fs::path& source, const std::optional<fs::path>& calib, const std::string& layout,
         double rate_hz, const std::string& frames, bool rectify,
         const std::optional<fs::path>& odometry_file, const std::optional<fs::path>& imu_file,
         const std::optional<fs::path>& poses_file, const std::optional<fs::path>& map_file, bool read_only,
         const std::string& preset, const py::object& config, const py::object& exec,
         const py::kwargs& options) {
        return follow(source.string(), calib, layout, rate_hz, frames, rectify,
                      {odometry_file, imu_file, poses_file, {}, map_file, read_only, {}},
                      settings(config, preset, options), exec_of(exec));
      },
      "source"_a, py::kw_only(), "calib"_a = py::none(), "layout"_a = "", "rate_hz"_a = 0.0, "frames"_a = "",
      "rectify"_a = false, "odometry_file"_a = py::none(), "imu_file"_a = py::none(),
      "poses_file"_a = py::none(), "map_file"_a = py::none(), "read_only"_a = false, "preset"_a = "default",
      "config"_a = py::none(), "exec"_a = py::none(), follow_doc.c_str());
  note_groups(m, "follow", follow_groups(), true);
}

}  // namespace cairn::python
