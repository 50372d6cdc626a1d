// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <atomic>
#include <cairn/tuning/tune.hpp>
#include <io/dataset.hpp>
#include <io/disparity_files.hpp>
#include <io/image_files.hpp>
#include <io/tuning_json.hpp>
#include <thread>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

// ---- frames ----

/// The arrays that a TuningFrame borrows from.
struct PyTuningFrame {
  std::string name;
  Picture left;
  Picture right;
  PyCalibration calibration;
  std::optional<Labels> objects;
  std::optional<Floats> truth_px;
  Mask hidden;
  bool partial = false;

  [[nodiscard]] TuningFrame frame(std::string shown_name, const PyConfig& config) const {
    calibration.check(left.size());
    TuningFrame made{std::move(shown_name), StereoPair::from(left.gray(), right.gray(), left.rgb()),
                     calibration.calibration.rig, config.suited(calibration.calibration)};
    if (objects) made.objects = objects->as<TruthId>();
    if (truth_px) made.truth_px = truth_px->view();
    made.hidden = hidden.view();
    made.partial = partial;
    return made;
  }
};

/// Throws Error for ids that are not in the truth.
void check_ids(View<const std::int32_t> ids) {
  for (int y = 0; y < ids.height(); ++y) {
    for (int x = 0; x < ids.width(); ++x) {
      if (ids(x, y) >= -1) continue;
      throw Error("objects: found " + std::to_string(ids(x, y)) + " at x " + std::to_string(x) + ", y " +
                  std::to_string(y) + ", expected ids from 0 on, or -1 = don't care");
    }
  }
}

PyTuningFrame make_frame(Picture& left, Picture& right, const KnownRig& rig, std::optional<Labels>& objects,
                         std::optional<Floats>& truth_px, Mask& hidden, bool partial,
                         const std::string& name) {
  (void)StereoPair::from(left.gray(), right.gray());
  if (objects) check_ids(objects->view());
  return {name,
          std::move(left),
          std::move(right),
          rig,
          std::move(objects),
          std::move(truth_px),
          std::move(hidden),
          partial};
}

template <class T>
std::optional<T> some(const py::object& array, const char* name) {
  return array.is_none() ? std::nullopt : std::optional<T>(std::in_place, array, name);
}

/// The same as arrays; None if unknown.
PyTuningFrame frame_of(const py::object& left, const py::object& right, const py::object& rig,
                       const py::object& objects, const py::object& truth_px, const py::object& hidden,
                       bool partial, const std::string& name) {
  Picture l(left, "left", false, {});
  Picture r(right, "right", false, {});
  auto ids = some<Labels>(objects, "objects");
  auto px = some<Floats>(truth_px, "truth_px");
  Mask mask(hidden, "hidden");
  return make_frame(l, r, KnownRig(rig, "rig"), ids, px, mask, partial, name);
}

PyTuningFrame read_frame(const io::FrameFiles& files, bool truth) {
  if (!files.right) throw Error(files.folder.string() + ": found no right image, expected a pair");
  io::PicturePair pair = io::load_pair(files.left, *files.right);
  Image<TruthId> objects;
  Image<float> truth_px;
  Image<std::uint8_t> hidden;
  bool partial = false;
  if (truth) {
    const io::TruthFiles known = io::find_truth(files);
    if (known.objects) objects = io::truth_ids(io::load_labels(*known.objects));
    if (known.disparity) truth_px = io::load_disparity(*known.disparity);
    if (known.occlusion) hidden = io::load_hidden(*known.occlusion);
    partial = known.partial;
  }
  py::object rig = py::none();
  if (files.calib)
    rig = py::cast(PyCalibration{io::load_calibration(*files.calib, files.grey_cameras), *files.calib});
  return frame_of(picture_array(std::move(pair.left)), picture_array(std::move(pair.right)), rig,
                  array_from(std::move(objects)), array_from(std::move(truth_px)),
                  array_from(std::move(hidden)), partial, files.name);
}

std::vector<PyTuningFrame> read_frames(const std::filesystem::path& folder, bool truth) {
  std::vector<PyTuningFrame> frames;
  for (const io::FrameFiles& files : io::find_frames(folder)) frames.push_back(read_frame(files, truth));
  return frames;
}

/// Accepts frames, and converts pairs to frames.
struct Frames {
  static constexpr const char* kType = "Iterable[Union[TuningFrame, Tuple[ImageLike, ImageLike]]]";
  std::vector<py::object> kept;

  Frames(const py::object& given, const char* name) {
    const std::string expected = ", expected cairn.TuningFrame or (left, right)";
    if (!py::isinstance<py::iterable>(given))
      throw ArgumentError(std::string(name) + ": found " + shown(given) + expected + " of each frame");
    for (const py::handle entry : given) {
      if (py::isinstance<PyTuningFrame>(entry)) {
        kept.push_back(py::reinterpret_borrow<py::object>(entry));
        continue;
      }
      const bool is_pair =
          py::isinstance<py::sequence>(entry) && !py::isinstance<py::str>(entry) && py::len(entry) == 2;
      if (!is_pair) {
        throw ArgumentError(std::string(name) + ": found " + shown(entry) + " as number " +
                            std::to_string(kept.size()) + expected);
      }
      const auto pair = py::reinterpret_borrow<py::sequence>(entry);
      const py::none none;
      kept.push_back(py::cast(frame_of(pair[0], pair[1], none, none, none, none, false, "")));
    }
  }

  [[nodiscard]] std::vector<TuningFrame> borrowed(const PyConfig& config) const {
    std::vector<TuningFrame> frames;
    for (const py::object& entry : kept) {
      const auto& frame = entry.cast<const PyTuningFrame&>();
      TuningFrame made = frame.frame(frame.name.empty() ? std::to_string(frames.size()) : frame.name, config);
      made.follows = !frames.empty() && shows_the_same(frames.back().pair.left(), made.pair.left());
      frames.push_back(std::move(made));
    }
    return frames;
  }
};

// ---- the search ----

/// Handles Ctrl-C and exceptions of progress(). KeyboardInterrupt ends the search, which keeps the best
/// result so far; other exceptions propagate to the caller.
class Interrupts {
 public:
  /// On any thread; signals reach the caller's only.
  bool asked() {
    if (std::this_thread::get_id() != caller_) return stopped_;
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) take();
    return stopped_;
  }
  /// After a failed call into Python, with the GIL held.
  void take() {
    if (PyErr_ExceptionMatches(PyExc_KeyboardInterrupt) == 0) throw py::error_already_set();
    PyErr_Clear();
    stopped_ = true;
  }

 private:
  std::thread::id caller_ = std::this_thread::get_id();
  std::atomic<bool> stopped_ = false;
};

py::dict progress_dict(const TuneProgress& now) {
  constexpr std::array kGoals{"objects", "disparities", "consistency"};
  py::dict all;
  all["goal"] = kGoals.at(static_cast<std::size_t>(now.goal));
  all["evaluations"] = now.evaluations;
  all["seconds"] = now.seconds;
  all["share"] = now.share;
  all["before"] = now.before;
  all["best"] = now.best;
  return all;
}

PyTuning tune_frames(const Call& call, const Frames& frames, const std::vector<std::string>& wanted,
                     double budget_s, int evaluations, double holdout, int seed,
                     const Typed<"Optional[Callable[[Dict[str, Any]], object]]">& progress) {
  if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0)
    throw ArgumentError("progress: found " + shown(progress) + ", expected a function or None");
  if (seed < 0) throw Error("seed: found " + std::to_string(seed) + ", expected 0 or more");
  const PyConfig base = call.settings();
  const std::vector<TuningFrame> borrowed = frames.borrowed(base);
  const TuneConfig search{wanted, budget_s, evaluations, holdout, static_cast<std::uint32_t>(seed)};
  Interrupts interrupts;
  const auto tell = [&](const TuneProgress& now) {
    (void)interrupts.asked();
    if (progress.is_none()) return;
    const py::gil_scoped_acquire lock;
    const py::dict words = progress_dict(now);
    if (!py::reinterpret_steal<py::object>(PyObject_CallOneArg(progress.ptr(), words.ptr())))
      interrupts.take();
  };
  const Tuning found = released([&] {
    return tune(borrowed, search, call.exec, {[&] { return interrupts.asked(); }, tell});
  });
  if (found.before.empty()) {  // there is no best result yet
    PyErr_SetNone(PyExc_KeyboardInterrupt);
    throw py::error_already_set();
  }
  std::vector<std::string> names;
  for (const TuningFrame& frame : borrowed) names.push_back(frame.name);
  PyTuning made{io::tuning_json(found, names, search.seed), base};
  made.config.config = with_settings(base.config, found.settings());
  for (const Setting& setting : found.settings())
    made.config.range_given |= setting.option == "match.num_disparities";
  return made;
}

template <class T>
py::object copy_of(View<const T> array) {
  return array.empty() ? py::none() : array_from(copied(array));
}
Typed<"Optional[NDArray[numpy.int32]]"> found_ids(const PyTuningFrame& self) {
  return self.objects ? copy_of(self.objects->view()) : py::none();
}
Typed<"Optional[NDArray[numpy.float32]]"> known_disparity(const PyTuningFrame& self) {
  return self.truth_px ? copy_of(self.truth_px->view()) : py::none();
}
Typed<"Optional[NDArray[numpy.uint8]]"> hidden_mask(const PyTuningFrame& self) {
  return copy_of(self.hidden.view());
}

}  // namespace

void bind_tuning(py::module_& m) {
  using py::literals::operator""_a;
  Class<PyTuningFrame>(
      m, "TuningFrame",
      "A pair to tune on, with what is known to be true of it. Borrows its arrays, as segment() does.")
      .made_by({},
               "left, right, rig, bgr: as for segment(). objects: (H, W) integers, the true objects' ids, 0 "
               "= none, -1 "
               "= don't care; truth_px: (H, W) float32, true disparities in px, NaN = not known; hidden: (H, "
               "W) uint8, "
               "not 0 = not seen by the right camera; each may be None. partial: not every object is "
               "labelled. name: "
               "frames of one name show the same scene.",
               &make_frame, "left"_a, "right"_a, "rig"_a = py::none(), py::kw_only(),
               "objects"_a = py::none(), "truth_px"_a = py::none(), "hidden"_a = py::none(),
               "partial"_a = false, "name"_a = "")
      .shows("name", &PyTuningFrame::name, "as errors call it; frames of one name show the same scene")
      .shows("objects", &found_ids, "(H, W) int32, the true ids, a copy; None where not known")
      .shows("truth_px", &known_disparity, "(H, W) float32, px, a copy; None where not known")
      .shows("hidden", &hidden_mask, "(H, W) uint8, a copy; None where not known")
      .shows("partial", &PyTuningFrame::partial, "whether objects may be missing in the truth")
      .def(py::pickle(
          [](const PyTuningFrame& self) {
            return versioned(py::make_tuple(self.left.copy(), self.right.copy(), self.calibration,
                                            found_ids(self), known_disparity(self), hidden_mask(self),
                                            self.partial, self.name));
          },
          [](const py::tuple& state) {
            const auto parts = py::reinterpret_borrow<py::tuple>(of_this_version(state));
            return frame_of(parts[0], parts[1], parts[2], parts[3], parts[4], parts[5], parts[6].cast<bool>(),
                            parts[7].cast<std::string>());
          }));
  define(m, "load_tuning_frames",
         "Every frame of a folder, as `cairn tune` reads them: a folder with left.png and right.png is one, "
         "else each of "
         "its sub-folders with those; a calib.txt belongs to it. truth: with objects.png, disp_left.png and "
         "occlusion.png, of which one of the first two must be there.",
         &read_frames, "folder"_a, "truth"_a = false);

  Class<PyTuning>(
      m, "Tuning",
      "What tune() found: `config`, and what `cairn tune --json` writes (docs/formats.md) as items and "
      "attributes: goal, found, tuned_on, held_out, gain, kept_because, ….")
      .shows("config", &PyTuning::config, "the Config to use: the tuned one, or the start where that is kept")
      .shows_json([](const PyTuning& self) { return self.json; });
  define(
      m, "tunables",
      "The names of the options that tune() can search: those that the patterns ('match.window_size', "
      "'match.*', '*') "
      "name, in the order of options().",
      [](const std::vector<std::string>& patterns) {
        std::vector<std::string> names;
        for (const Tunable& tunable : tunables(patterns)) names.push_back(tunable.name);
        return names;
      },
      "patterns"_a = std::vector<std::string>{"*"});

  const TuneConfig defaults;
  define(
      m, "tune", Options{Keywords::by_group, all_groups()},
      "Searches the options that do best on frames of yours, as `cairn tune` does (docs/tune.md). Returns a "
      "Tuning.\n"
      "frames: a TuningFrame or (left, right) each; all are held at once. options: patterns as tunables() "
      "takes "
      "them, none = a sensible choice. budget_s: seconds, more than 0; the start is measured all the same. "
      "evaluations: end after this number as well, for a result that does not depend on the machine's speed; "
      "0 = no "
      "limit. holdout: 0 to 0.9, the share of the frames that only judge the result. seed: which frames "
      "these are, "
      "and in which order options are tried. progress: called before each evaluation with a dict: goal, "
      "evaluations, seconds, share (0 to 1), before and best (mean losses; None until the start is "
      "measured). Ctrl-C "
      "(KeyboardInterrupt) ends the search and keeps the best so far. The search starts from preset, config "
      "and the "
      "options, as in segment(). Other Python threads run meanwhile. Raises cairn.Error for what cannot be "
      "used.",
      &tune_frames, "frames"_a, py::kw_only(), "options"_a = std::vector<std::string>{},
      "budget_s"_a = defaults.budget_s, "evaluations"_a = defaults.evaluations,
      "holdout"_a = defaults.holdout, "seed"_a = defaults.seed, "progress"_a = py::none());
}

}  // namespace cairn::python
