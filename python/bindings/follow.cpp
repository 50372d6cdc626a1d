// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <set>
#include <source/follow_files.hpp>
#include <source/sequence_run.hpp>

#include "bindings.hpp"
#include "frame.hpp"

namespace cairn::python {

template <>
struct Plain<Point3> {
  static std::tuple<double, double, double> of(Point3 p) { return {p.x, p.y, p.z}; }
};
template <>
struct Plain<Pose> {
  static Numbers<double> of(const Pose& pose) {
    const auto& r = pose.rotation;
    const Point3 t = pose.translation_m;
    return {{r[0], r[1], r[2], t.x, r[3], r[4], r[5], t.y, r[6], r[7], r[8], t.z, 0, 0, 0, 1}, {4, 4}};
  }
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
using Matrix = Typed<"FloatsLike">;

template <std::size_t N>
Numbers<double> matrix(const std::array<double, N>& numbers) {
  constexpr py::ssize_t kSide = N == 9 ? 3 : 6;
  static_assert(kSide * kSide == N);
  return {{numbers.begin(), numbers.end()}, {kSide, kSide}};
}

/// Throws Error unless it is a square matrix of finite numbers.
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

MotionPrior make_prior(const Matrix& now_from_before, const Matrix& covariance, const std::string& kind) {
  MotionPrior prior;
  prior.now_from_before = pose_from(now_from_before, "now_from_before");
  const auto numbers = square(covariance, 6, "covariance");
  std::copy_n(numbers.data(), prior.covariance.size(), prior.covariance.begin());
  if (kind != "wheels" && kind != "gyroscope")
    throw Error("kind: found '" + kind + "', expected 'wheels' or 'gyroscope'");
  prior.kind = kind == "wheels" ? PriorKind::wheels : PriorKind::gyroscope;
  return prior;
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
  FollowConfig config;  // without segmentation
  std::set<std::string> own;

  [[nodiscard]] FollowConfig suited(const io::Calibration& calibration) const {
    FollowConfig wanted = config;
    wanted.segmentation = segmentation.suited(calibration);
    for (const std::string& name : own) require_active(wanted, name);
    return wanted;
  }
};

Settings settings(const Call& call) {
  Settings made;
  const auto elsewhere = [&](std::string_view name, std::string_view value) {
    if (!is_of_following(name)) return false;
    set(made.config, name, value);
    made.own.emplace(name);
    return true;
  };
  py::dict of_segmentation;
  std::vector<std::pair<std::string, std::string>> of_following;
  for (const auto& [key, value] : call.options) {
    const auto group = key.cast<std::string>();
    if (!is_of_following(group)) {
      of_segmentation[key] = value;
    } else {
      for (auto& setting : settings_of(group, value)) of_following.push_back(std::move(setting));
    }
  }
  made.segmentation = config_of(call.given_config, call.preset, of_segmentation, elsewhere);
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

/// A step, its images, and the output of `cairn follow` for it.
struct PyStep {
  std::shared_ptr<Step> step;
  py::object frame;  // a PyFrame that refers to step->frame
  std::string json;
  std::map<std::int64_t, std::int64_t> landmarks;  // by track id
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
  PyFollower(PyCalibration calibration, const Settings& settings, const Exec& exec)
      : calibration_(std::move(calibration)),
        preset_(settings.segmentation.preset),
        pool_(exec.pool),
        follower_(settings.suited(calibration_.calibration), calibration_.calibration.rig, exec) {}

  std::unique_ptr<PyStep> next(const py::object& left, const py::object& right, const py::object& stamp_ns,
                               std::optional<double> seconds, const std::optional<MotionPrior>& prior,
                               const py::object& pose, bool bgr) {
    Picture l(left, "left", bgr, pool_);
    const Picture r(right, "right", bgr, pool_);
    const auto pair = StereoPair::from(l.gray(), r.gray(), l.rgb());
    calibration_.check(pair.size());
    const Stamp stamp = stamp_from(stamp_ns, seconds);
    std::optional<Pose> known;
    if (!pose.is_none()) known = pose_from(pose, "pose");
    auto made = std::make_unique<PyStep>();
    made->step = released([&] {
      const std::lock_guard<std::mutex> one_at_a_time(busy_);
      return std::make_shared<Step>(follower_.next(pair, stamp, prior, known));
    });
    made->json = io::step_json(*made->step, std::to_string(made->step->index));
    io::Provenance provenance{preset_, config().segmentation, calibration_.calibration.rig, {},
                              false,   made->step->stamp.ns};
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
      made->json = io::step_json(*made->step, frame->name, marked, frame->frame_id);
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
    const py::object left = picture_array(std::move(frame->left));
    io::Provenance provenance{preset_, run_->config().segmentation, source_->rig(), {},
                              false,   made->step->stamp.ns};
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

std::unique_ptr<Following> follow(const Call& call, const fs::path& source,
                                  const std::optional<fs::path>& calib, const std::string& layout,
                                  double rate_hz, const std::string& frames, bool rectify,
                                  const std::optional<fs::path>& odometry_file,
                                  const std::optional<fs::path>& imu_file,
                                  const std::optional<fs::path>& poses_file,
                                  const std::optional<fs::path>& map_file, bool read_only) {
  io::SourceOptions options;
  if (calib) options.calib = calib->string();
  options.layout = layout;
  options.rate_hz = rate_hz;
  options.rectify = rectify;
  if (!frames.empty()) options.frames = io::parse_frame_range(frames);
  const Settings wanted = settings(call);
  const io::CompanionFiles files{odometry_file, imu_file, poses_file, {}, map_file, read_only, {}};
  auto opened = released([&] { return io::open_sequence(source.string(), options, call.exec.pool); });
  return std::make_unique<Following>(std::move(opened), source.string(), files, wanted, call.exec);
}

std::string value_of(const PyFollower& self, const std::string& name) {
  for (const OptionInfo& option : options(self.config())) {
    if (option.name == name) return option.value;
  }
  FollowConfig copy;
  set(copy, name, "");  // throws and suggests the nearest name
  return {};
}

// ---- classes ----

/// An attribute of tracks with a metric position, else None.
template <auto member>
auto if_placed(const Track& self) {
  return self.has_place ? std::optional(self.*member) : std::nullopt;
}

/// An attribute from the library's step.
template <auto member>
const auto& of_step(const PyStep& self) {
  return (*self.step).*member;
}

py::dict reliability_of(const PyStep& self) {
  const Reliability& judged = self.step->reliability;
  py::dict known;
  for (const WitnessName& witness : kWitnesses)
    known[py::str(std::string(witness.name))] = judged.witnesses.*witness.value;
  known["value"] = judged.value;
  known["weakest"] = judged.weakest;
  known["steadiness"] = judged.steadiness;
  known["is_unreliable"] = judged.is_unreliable;
  return known;
}

py::tuple step_state(const PyStep& self) {
  const auto& frame = self.frame.cast<const PyFrame&>();
  return versioned(py::make_tuple(frame.left.copy(), state_of(*self.step), state_of(frame.provenance),
                                  self.json, self.landmarks, self.events));
}

std::unique_ptr<PyStep> step_of(const py::tuple& state) {
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
}

void bind_results(py::module_& m) {
  using py::literals::operator""_a;
  Class<Track>(m, "Track",
               "An object over time. Metres are those of the map's frame: z up, its origin on the floor "
               "below the first "
               "frame's camera, x forward.")
      .shows("id", &Track::id, "from 1; never used twice in a run")
      .shows(
          "state", [](const Track& t) { return choice_name(t.state, kTrackStates); },
          "'tentative', 'confirmed', 'occluded', 'out_of_view', 'lost' or 'dead'")
      .shows("is_moving", &Track::is_moving, "by itself, not by the camera's motion")
      .shows("object", &Track::object, "id of its Object in this frame; 0 = not seen")
      .shows("parts", &Track::parts, "ids of further objects of this frame that are pieces of it")
      .shows("is_joined", &Track::is_joined, "this frame shows it as one object with another track")
      .shows("position_m", &if_placed<&Track::position_m>, "(x, y, z), m; None without a rig")
      .shows(
          "covariance_m2",
          [](const Track& t) { return t.has_place ? std::optional(matrix(t.covariance_m2)) : std::nullopt; },
          "3 x 3 of position_m, m²; None without a rig")
      .shows("velocity_m_s", &if_placed<&Track::velocity_m_s>,
             "(x, y, z), m/s; 0 if static; None without a rig")
      .shows("extent_m", &if_placed<&Track::extent_m>,
             "(x, y, z) in the camera's frame, m: the box around its points; None without a rig")
      .shows("confidence", &Track::confidence, "0 to 1, smoothed")
      .shows("hits", &Track::hits, "frames in which it was seen")
      .shows("misses", &Track::misses, "frames since then in which it should have been seen")
      .shows(
          "first_ns", [](const Track& t) { return t.first.ns; }, "stamp of its first frame, ns")
      .shows(
          "last_ns", [](const Track& t) { return t.last.ns; }, "stamp when it was last seen, ns");

  Class<Motion>(m, "Motion", "The camera's motion that one frame shows, or why it shows none.")
      .shows("now_from_before", &Motion::now_from_before,
             "4 x 4: points of the frame before go to this one; where refused, its stand-in")
      .shows(
          "covariance", [](const Motion& self) { return matrix(self.covariance); },
          "6 x 6 of the pose against the keyframe, translation (m) before rotation (rad)")
      .shows(
          "refusal", [](const Motion& self) { return choice_name(self.refusal, kMotionRefusals); },
          "'none' where it was estimated, else why not: 'few_points', 'no_rig', …")
      .shows("is_new_keyframe", &Motion::is_new_keyframe, "whether the next motions are against this frame")
      .shows("is_new_segment", &Motion::is_new_segment,
             "whether only a guess ties what is seen from here on to what was seen before")
      .shows("followed", &Motion::followed, "corners that were followed")
      .shows("inliers", &Motion::inliers, "corners that agree")
      .shows("inlier_share", &Motion::inlier_share, "0 to 1: of the corners that were followed")
      .shows("chi2_per_dof", &Motion::chi2_per_dof, "1 where errors are as large as assumed");

  Class<MotionPrior>(m, "MotionPrior",
                     "What another sensor says of the camera's motion since the frame before.")
      .made_by(
          {},
          "now_from_before: 4 x 4, takes points of the camera's frame then to its frame now. covariance: 6 x "
          "6, "
          "translation (m) before rotation (rad). kind: 'wheels', or 'gyroscope', of which only the rotation "
          "counts.",
          &make_prior, "now_from_before"_a, "covariance"_a, "kind"_a = "wheels")
      .shows("now_from_before", &MotionPrior::now_from_before, "4 x 4 float64")
      .shows(
          "covariance", [](const MotionPrior& self) { return matrix(self.covariance); }, "6 x 6 float64")
      .shows(
          "kind",
          [](const MotionPrior& self) { return self.kind == PriorKind::wheels ? "wheels" : "gyroscope"; },
          "'wheels' or 'gyroscope'");

  Class<PyStep>(m, "Step", "All that is known after one frame of a sequence.")
      .shows("index", &of_step<&Step::index>, "the frame's number, from 0")
      .shows(
          "stamp_ns", [](const PyStep& self) { return self.step->stamp.ns; }, "when it was taken, ns")
      .shows(
          "seconds", [](const PyStep& self) { return double(self.step->stamp.ns) * 1e-9; },
          "when it was taken, s")
      .shows("is_lost", &of_step<&Step::is_lost>, "whether the camera's place is not known")
      .shows("map_from_camera", &of_step<&Step::map_from_camera>,
             "4 x 4 float64: where the left camera is; takes points of its frame to the map's")
      .shows(
          "pose_covariance", [](const PyStep& self) { return matrix(self.step->pose_covariance); },
          "6 x 6 of map_from_camera, translation (m) before rotation (rad)")
      .shows("motion", &of_step<&Step::motion>, "the camera's Motion")
      .shows(
          "tracks",
          [](const PyStep& self) {  // in the map frame, as in tracks.jsonl
            std::vector<Track> tracks = self.step->tracks.list;
            for (Track& track : tracks)
              track.covariance_m2 =
                  covariance_in_map(track, self.step->map_from_camera, self.step->pose_covariance);
            return tracks;
          },
          "a list of Track by id, those out of view included")
      .shows("ids", &of_step<&Step::ids>,
             "(H, W) int64, read-only: the track that each pixel belongs to; 0 = none")
      .shows(
          "odometry_suspect", [](const PyStep& self) { return self.step->tracks.odometry_suspect; },
          "whether most tracks began to move at once: rather the camera's motion is wrong")
      .shows("reliability", &reliability_of,
             "how far the frame is to be trusted: value (0 ... 1 or None), the witnesses it is the mean of, "
             "and the "
             "weakest one's name")
      .shows("landmarks", &PyStep::landmarks, "of follow(): landmark by track, both by id")
      .shows("events", &PyStep::events,
             "of follow(): (kind, landmark), kind 'new', 'moved', 'gone', 'back' or 'relocated'")
      .shows(
          "frame", [](const PyStep& self) { return Typed<"Frame">(self.frame); }, "the Frame")
      .method("to_json",
              "The frame's line of tracks.jsonl, as `cairn follow --json-lines` prints it (docs/formats.md).",
              [](const PyStep& self) { return self.json; })
      .method("overlay", "The left image with its tracks drawn in, each with its id: (h, w, 3) uint8, RGB.",
              &overlay)
      .method("_repr_png_", "",
              [](const PyStep& self) {
                const Image<Rgb> drawn = overlay(self);
                return py::bytes(io::png_bytes(drawn));
              })
      .def(py::pickle(&step_state, &step_of));
}

}  // namespace

void bind_follow(py::module_& m) {
  using py::literals::operator""_a;
  bind_results(m);
  define(m, "follow_options",
         "Every option of sequences with its default, in the order of the stages; those of a frame are in "
         "options().",
         &follow_options);

  const Options options{Keywords::by_group, follow_groups()};
  const std::string about =
      " preset, config (a Config or a file's name) and options are those of segment(), with the groups of "
      "follow_options() besides: tracking={'min_hits': 2}.";
  Class<PyFollower>(m, "Follower", "Follows the camera and the objects through a sequence, pair by pair.")
      .made_by(
          options,
          "rig: a Rig, a Calibration or None: then there are ids, but no metres and no motion. Raises "
          "cairn.Error for "
          "what cannot be used." +
              about,
          [](const Call& call, const KnownRig& rig) {
            return std::make_unique<PyFollower>(rig, settings(call), call.exec);
          },
          "rig"_a = py::none())
      .method(
          "next",
          "The next frame: a Step. stamp_ns or seconds: when it was taken, later than the one before. prior: "
          "a "
          "MotionPrior since the frame before. pose: 4 x 4 map_from_camera of a robot that knows where it "
          "is; then no "
          "motion is estimated. Raises cairn.Error for another size than the first pair's and stamps that do "
          "not rise.",
          [](PyFollower& self, const Typed<"ImageLike">& left, const Typed<"ImageLike">& right,
             const Typed<"Optional[int]">& stamp_ns, std::optional<double> seconds,
             const std::optional<MotionPrior>& prior, const Typed<"Optional[FloatsLike]">& pose,
             bool bgr) { return self.next(left, right, stamp_ns, seconds, prior, pose, bgr); },
          "left"_a, "right"_a, "stamp_ns"_a = py::none(), py::kw_only(), "seconds"_a = py::none(),
          "prior"_a = py::none(), "pose"_a = py::none(), "bgr"_a = false)
      .shows(
          "rig", [](const PyFollower& self) { return self.calibration().calibration.rig; },
          "the Rig that it measures with, or None")
      .method("__getitem__", "The value of an option by its full name, as text.", &value_of, "name"_a);

  Class<Following>(m, "Following", "What follow() returns: an iterator of Steps over a source.")
      .method("__iter__", "Itself.", [](const Typed<"Following">& self) { return self; })
      .method("__next__", "The next Step.", [](Following& self) { return self.next(); })
      .method("__enter__", "Itself.", [](const Typed<"Following">& self) { return self; })
      .method(
          "__exit__", "Ends the run.",
          [](Following& self, const py::object&, const py::object&, const py::object&) { self.close(); },
          "kind"_a, "error"_a, "trace"_a)
      .method("close", "Ends the run, in the map, too; reading to the end does so by itself.",
              [](Following& self) { self.close(); })
      .shows(
          "rig", [](const Following& self) { return self.source().rig(); }, "the source's Rig, or None")
      .shows(
          "size", [](const Following& self) { return self.source().size(); },
          "frames at most; None where it is not known")
      .shows(
          "remarks",
          [](const Following& self) {
            std::vector<std::pair<std::string, std::size_t>> all;
            for (const io::SourceRemark& remark : self.source().remarks())
              all.emplace_back(remark.what, remark.count);
            return all;
          },
          "what was noticed of the source's frames up to now: (words, frames)")
      .shows(
          "ended_early", [](const Following& self) { return self.source().ended_early(); },
          "why the source ended before its end; '' where it did not");

  define(
      m, "follow", options,
      "Follows a whole sequence: an iterator of Steps.\n"
      "source: a folder of frames, of KITTI's or EuRoC's, 'LEFT,RIGHT', or a video with layout "
      "(docs/sequences.md). "
      "calib: instead of the source's own. frames: 'A:B:STEP'. rectify: the images are raw. odometry_file, "
      "imu_file, poses_file: what other sensors say of the motion. map_file: landmarks to recognise and to "
      "add to; "
      "read_only: it stays as it is. These are the options of `cairn follow`, and the steps are its own." +
          about,
      &follow, "source"_a, py::kw_only(), "calib"_a = py::none(), "layout"_a = "", "rate_hz"_a = 0.0,
      "frames"_a = "", "rectify"_a = false, "odometry_file"_a = py::none(), "imu_file"_a = py::none(),
      "poses_file"_a = py::none(), "map_file"_a = py::none(), "read_only"_a = false);
}

}  // namespace cairn::python
