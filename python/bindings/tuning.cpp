// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <pybind11/stl/filesystem.h>

#include <array>
#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/tuning/tune.hpp>
#include <io/dataset.hpp>
#include <io/disparity_files.hpp>
#include <io/image_files.hpp>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "options.hpp"
#include "pickling.hpp"
#include "refusals.hpp"
#include "rig.hpp"
#include "whole.hpp"

namespace cairn::python {
namespace {

// ---- frames ----

/// What a TuningFrame borrows from.
struct PyTuningFrame {
  std::string name;
  Picture left;
  Picture right;
  PyCalibration calibration;
  std::optional<Borrowed<std::int32_t>> objects;
  bool partial = false;
  std::optional<Borrowed<float>> truth_px;
  BorrowedMask hidden;

  [[nodiscard]] TuningFrame frame(std::string shown_name, const PyConfig& config) const {
    io::check_size(calibration.calibration, left.size(), calibration.path);
    io::check_search_range(calibration.calibration, calibration.path);
    TuningFrame made{std::move(shown_name), StereoPair::from(left.gray(), right.gray(), left.rgb()),
                     calibration.calibration.rig, config.suited(calibration.calibration)};
    if (objects) {
      const View<const std::int32_t> ids = objects->view();
      made.objects = {reinterpret_cast<const TruthId*>(ids.data()), ids.size(), ids.stride()};
    }
    if (truth_px) made.truth_px = truth_px->view();
    made.hidden = hidden.view();
    made.partial = partial;
    return made;
  }
};

void check_ids(View<const std::int32_t> ids) {
  for (int y = 0; y < ids.height(); ++y) {
    for (int x = 0; x < ids.width(); ++x) {
      if (ids(x, y) >= -1) continue;
      throw Error("objects: found " + std::to_string(ids(x, y)) + " at x " + std::to_string(x) + ", y " +
                  std::to_string(y) + ", expected ids from 0 on, or -1 = don't care");
    }
  }
}

std::unique_ptr<PyTuningFrame> make_frame(const ImageArgument& left, const ImageArgument& right,
                                          const RigArgument& rig, const LabelsArgument& objects,
                                          const FloatsArgument& truth_px, const MaskArgument& hidden,
                                          bool partial, const std::string& name, bool bgr) {
  auto made = std::make_unique<PyTuningFrame>(PyTuningFrame{name,
                                                            Picture(left, "left", bgr, {}),
                                                            Picture(right, "right", bgr, {}),
                                                            calibration_of(rig),
                                                            {},
                                                            partial,
                                                            {},
                                                            BorrowedMask(hidden, "hidden")});
  const Size size = made->left.size();
  (void)StereoPair::from(made->left.gray(), made->right.gray());
  if (!objects.is_none()) {
    made->objects.emplace(objects, "objects");
    expect_size(made->objects->size(), "objects", size, "left");
    check_ids(made->objects->view());
  }
  if (!truth_px.is_none()) {
    made->truth_px.emplace(truth_px, "truth_px");
    expect_size(made->truth_px->size(), "truth_px", size, "left");
  }
  if (!made->hidden.view().empty()) expect_size(made->hidden.view().size(), "hidden", size, "left");
  return made;
}

template <class T>
py::object array_or_nothing(Image<T> image) {
  return image.empty() ? py::object(py::none()) : py::object(array_from(std::move(image)));
}

std::unique_ptr<PyTuningFrame> read_frame(const io::FrameFiles& files, bool truth) {
  if (!files.right) throw Error(files.folder.string() + ": found no right picture, expected a pair");
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
  const auto picture = [](io::Picture from) {
    return from.rgb.empty() ? Array<std::uint8_t>(array_from(std::move(from.gray)))
                            : array_from(std::move(from.rgb));
  };
  const py::object rig =
      files.calib
          ? py::cast(PyCalibration{io::load_calibration(*files.calib, files.grey_cameras), *files.calib})
          : py::none();
  return make_frame(picture(std::move(pair.left)), picture(std::move(pair.right)), rig,
                    array_or_nothing(std::move(objects)), array_or_nothing(std::move(truth_px)),
                    array_or_nothing(std::move(hidden)), partial, files.name, false);
}

std::vector<std::unique_ptr<PyTuningFrame>> read_frames(const std::filesystem::path& folder, bool truth) {
  std::vector<std::unique_ptr<PyTuningFrame>> frames;
  for (const io::FrameFiles& files : io::find_frames(folder)) frames.push_back(read_frame(files, truth));
  return frames;
}

/// The frames themselves, and pairs made into such.
class Frames {
 public:
  explicit Frames(const FramesArgument& given) {
    if (!py::isinstance<py::iterable>(given)) {
      throw ArgumentError("frames: found " + shown(given) +
                          ", expected cairn.TuningFrame or (left, right) of each frame");
    }
    for (const py::handle entry : given) add(entry);
  }

  [[nodiscard]] std::vector<TuningFrame> borrowed(const PyConfig& config) const {
    std::vector<TuningFrame> frames;
    for (const py::object& entry : kept_) {
      const auto& frame = entry.cast<const PyTuningFrame&>();
      const std::string number = std::to_string(frames.size());
      TuningFrame made = frame.frame(frame.name.empty() ? number : frame.name, config);
      made.follows = !frames.empty() && shows_the_same(frames.back().pair.left(), made.pair.left());
      frames.push_back(std::move(made));
    }
    return frames;
  }

 private:
  void add(const py::handle& entry) {
    if (py::isinstance<PyTuningFrame>(entry)) {
      kept_.push_back(py::reinterpret_borrow<py::object>(entry));
      return;
    }
    const bool is_pair =
        py::isinstance<py::sequence>(entry) && !py::isinstance<py::str>(entry) && py::len(entry) == 2;
    if (!is_pair) {
      throw ArgumentError("frames: found " + shown(entry) + " as number " + std::to_string(kept_.size()) +
                          ", expected a cairn.TuningFrame or (left, right)");
    }
    const auto pair = py::reinterpret_borrow<py::sequence>(entry);
    kept_.push_back(py::cast(make_frame(py::object(pair[0]), py::object(pair[1]), py::none(), py::none(),
                                        py::none(), py::none(), false, "", false)));
  }

  std::vector<py::object> kept_;
};

// ---- the search ----

constexpr std::array kGoals{"objects", "disparities", "consistency"};
constexpr std::array kEnds{"converged", "evaluations", "time", "interrupted"};

/// Ctrl-C and what progress() raises. KeyboardInterrupt ends the search, which keeps the best so far; any
/// other exception goes on to the caller.
class Interrupts {
 public:
  /// On any thread; only the caller's hears of signals.
  bool asked() {
    if (std::this_thread::get_id() != caller_) return stopped_;
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) take();
    return stopped_;
  }
  /// Where a call into Python has failed, with the lock.
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
  py::dict all;
  all["goal"] = kGoals.at(static_cast<std::size_t>(now.goal));
  all["evaluations"] = now.evaluations;
  all["seconds"] = now.seconds;
  all["share"] = now.share;
  all["before"] = now.before;
  all["best"] = now.best;
  return all;
}

double loss_of_all(const std::vector<FrameMeasure>& measures) {
  return mean_loss(losses_of(measures));
}

PyTuning summary_of(const Tuning& found, const PyConfig& base) {
  PyTuning made;
  made.goal = kGoals.at(static_cast<std::size_t>(found.goal));
  made.end = kEnds.at(static_cast<std::size_t>(found.end));
  made.kept_because = found.kept_because;
  made.evaluations = found.search.evaluations;
  made.seconds = found.seconds;
  made.before = loss_of_all(found.before);
  made.after = loss_of_all(found.after);
  if (!found.held_out_before.empty()) {
    made.held_out_before = loss_of_all(found.held_out_before);
    made.held_out_after = loss_of_all(found.held_out_after);
  }
  for (std::size_t i = 0; i < found.held_out.size(); ++i) {
    if (found.held_out[i]) made.held_out.push_back(static_cast<int>(i));
  }
  for (const Tunable& tunable : found.tunables) made.options.push_back(tunable.name);
  made.not_judged = found.not_judged;
  made.start = found.search.start;
  made.best = found.search.best;
  made.config = base;
  made.config.config = with_settings(base.config, found.settings());
  for (const Setting& setting : found.settings())
    made.config.range_given |= setting.option == "match.num_disparities";
  return made;
}

PyTuning tune_frames(const FramesArgument& frames, const std::vector<std::string>& wanted, double budget_s,
                     Whole evaluations, double holdout, Whole seed, const py::object& progress,
                     const std::string& preset, const py::object& config, const py::object& exec,
                     const py::kwargs& options) {
  if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0)
    throw ArgumentError("progress: found " + shown(progress) + ", expected a function or None");
  if (seed.value < 0) throw Error("seed: found " + std::to_string(seed.value) + ", expected 0 or more");
  const PyConfig base = config_of(config, preset, options);
  const Exec how = exec_of(exec);
  const Frames given(frames);
  const std::vector<TuningFrame> borrowed = given.borrowed(base);
  const TuneConfig search{wanted, budget_s, evaluations.value, holdout,
                          static_cast<std::uint32_t>(seed.value)};
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
    return tune(borrowed, search, how, {[&] { return interrupts.asked(); }, tell});
  });
  if (found.before.empty()) {  // there is no best so far
    PyErr_SetNone(PyExc_KeyboardInterrupt);
    throw py::error_already_set();
  }
  return summary_of(found, base);
}

std::vector<std::string> tunable_names(const std::vector<std::string>& patterns) {
  std::vector<std::string> names;
  for (const Tunable& tunable : tunables(patterns)) names.push_back(tunable.name);
  return names;
}

// ---- what the classes show ----

py::dict changes(const PyTuning& self) {
  py::dict all;
  for (std::size_t i = 0; i < self.best.size(); ++i) {
    if (self.best[i] == self.start[i]) continue;
    const auto value = [&](const Setting& setting) {
      return option_of(PyConfig{"default", with_settings(Config{}, {setting}), false}, setting.option);
    };
    all[py::str(self.best[i].option)] = py::make_tuple(value(self.start[i]), value(self.best[i]));
  }
  return all;
}

std::string share_text(double loss) {
  return py::str("{:.1%}").format(loss).cast<std::string>();
}

std::string tuning_repr(const PyTuning& self) {
  std::string text =
      "<cairn.Tuning " + self.goal + ": loss " + share_text(self.before) + " -> " + share_text(self.after);
  if (self.held_out_before)
    text += ", held out " + share_text(*self.held_out_before) + " -> " + share_text(*self.held_out_after);
  text += ", " + std::to_string(self.evaluations) + " evaluations, " + self.end;
  if (!self.kept_because.empty()) text += "; the start is kept: " + self.kept_because;
  return text + ">";
}

py::object found_ids(const PyTuningFrame& self) {
  return self.objects ? py::object(array_from(copied(self.objects->view()))) : py::none();
}
py::object known_disparity(const PyTuningFrame& self) {
  return self.truth_px ? py::object(array_from(copied(self.truth_px->view()))) : py::none();
}
py::object hidden_mask(const PyTuningFrame& self) {
  return self.hidden.view().empty() ? py::none() : py::object(array_from(copied(self.hidden.view())));
}

py::tuple frame_state(const PyTuningFrame& self) {
  return versioned(py::make_tuple(self.left.copy(), self.right.copy(), py::cast(self.calibration),
                                  found_ids(self), known_disparity(self), hidden_mask(self), self.partial,
                                  self.name));
}

std::unique_ptr<PyTuningFrame> frame_of(const py::tuple& state) {
  const auto parts = py::reinterpret_borrow<py::tuple>(of_this_version(state));
  return make_frame(py::object(parts[0]), py::object(parts[1]), py::object(parts[2]), py::object(parts[3]),
                    py::object(parts[4]), py::object(parts[5]), parts[6].cast<bool>(),
                    parts[7].cast<std::string>(), false);
}

std::string frame_repr(const PyTuningFrame& self) {
  const char* const known = self.objects ? "objects known" : self.truth_px ? "disparities known" : "no truth";
  return "<cairn.TuningFrame " + (self.name.empty() ? "" : self.name + ", ") + text(self.left.size()) + ", " +
         known + ">";
}

}  // namespace

void bind_tuning(py::module_& m) {
  using py::literals::operator""_a;
  py::class_<PyTuningFrame>(
      m, "TuningFrame",
      "A pair to tune on, with what is known to be true of it. Borrows its arrays, as segment() "
      "does.")
      .def(py::init(&make_frame), "left"_a, "right"_a, "rig"_a = py::none(), py::kw_only(),
           "objects"_a = py::none(), "truth_px"_a = py::none(), "hidden"_a = py::none(), "partial"_a = false,
           "name"_a = "", "bgr"_a = false,
           "left, right, rig, bgr: as for segment(). objects: (H, W) integers, the true objects' ids, 0 = "
           "none, -1 = "
           "don't care; truth_px: (H, W) float32, true disparities in px, NaN = not known; hidden: (H, W) "
           "uint8, not 0 "
           "= not seen by the right camera; each may be None. partial: not every object is labelled. name: "
           "frames of "
           "one name show the same scene.")
      .def_readonly("name", &PyTuningFrame::name, "as errors call it; frames of one name show the same scene")
      .def_property_readonly("objects", &found_ids,
                             "(H, W) int32, the true ids, a copy; None where not known")
      .def_property_readonly("truth_px", &known_disparity, "(H, W) float32, px, a copy; None where not known")
      .def_property_readonly("hidden", &hidden_mask, "(H, W) uint8, a copy; None where not known")
      .def_readonly("partial", &PyTuningFrame::partial, "whether objects may be missing in the truth")
      .def("__repr__", &frame_repr)
      .def(py::pickle(&frame_state, &frame_of));
  m.def("load_tuning_frames", &read_frames, "folder"_a, "truth"_a = false,
        "Every frame of a folder, as `cairn tune` reads them: a folder with left.png and right.png is one, "
        "else each of "
        "its sub-folders with those; a calib.txt belongs to it. truth: with objects.png, disp_left.png and "
        "occlusion.png, of which one of the first two must be there.");

  py::class_<PyTuning>(m, "Tuning", "What tune() found.")
      .def_readonly("config", &PyTuning::config,
                    "the Config to use: the tuned one, or the start where that is kept")
      .def_readonly("goal", &PyTuning::goal,
                    "what was made small: 'objects' (the paper's E), 'disparities' (off by more than 1 px; a "
                    "hole counts "
                    "half) or 'consistency' (contradictions, where no truth is known)")
      .def_readonly("before", &PyTuning::before,
                    "mean loss of the start on the frames tuned on, from 0; 0 is best")
      .def_readonly("after", &PyTuning::after, "the same of the best that was found")
      .def_readonly("held_out_before", &PyTuning::held_out_before,
                    "mean loss of the start on the frames held out; None where none are")
      .def_readonly("held_out_after", &PyTuning::held_out_after, "the same of the best that was found")
      .def_readonly("held_out", &PyTuning::held_out, "indices of the frames held out")
      .def_property_readonly(
          "changes", &changes,
          "what the best changes: by option, (value before, value after); also where the start is kept")
      .def_property_readonly(
          "kept_because",
          [](const PyTuning& self) {
            return self.kept_because.empty() ? std::nullopt : std::optional(self.kept_because);
          },
          "why `config` is the start; None where it is the best that was found")
      .def_readonly("options", &PyTuning::options, "the names of the options that were searched")
      .def_readonly("not_judged", &PyTuning::not_judged,
                    "names that were asked for but change nothing that can be judged")
      .def_readonly("evaluations", &PyTuning::evaluations,
                    "settings that were measured, the start among them")
      .def_readonly("seconds", &PyTuning::seconds, "that it took")
      .def_readonly("end", &PyTuning::end,
                    "'converged' (nothing near the best is better), 'evaluations', 'time' or 'interrupted'")
      .def("__repr__", &tuning_repr)
      .def(pickled<PyTuning>());
  m.def("tunables", &tunable_names, "patterns"_a = std::vector<std::string>{"*"},
        "The names of the options that tune() can search: those that the patterns ('match.window_size', "
        "'match.*', '*') "
        "name, in the order of options().");

  const TuneConfig defaults;
  const std::string doc = with_options(
      "Searches the options that do best on frames of yours, as `cairn tune` does (docs/tune.md). Returns a "
      "Tuning.\n"
      "frames: a TuningFrame or (left, right) each; all are held at once. options: patterns as tunables() "
      "takes them, "
      "none = a sensible choice. budget_s: seconds, more than 0; the start is measured all the same. "
      "evaluations: end "
      "after so many as well, for a result that does not depend on the machine's speed; 0 = no limit. "
      "holdout: 0 to 0.9, "
      "the share of the frames that only judge the result. seed: which frames these are, and in which order "
      "options are "
      "tried. progress: called before each evaluation with a dict: goal, evaluations, seconds, share (0 to "
      "1), before "
      "and best (mean losses; None until the start is measured). Ctrl-C (KeyboardInterrupt) ends the search "
      "and keeps "
      "the best so far. The search starts from preset, config and the options, as in segment(). Other Python "
      "threads "
      "run meanwhile. Raises cairn.Error for what cannot be used.",
      all_groups(), true);
  m.def("tune", &tune_frames, "frames"_a, py::kw_only(), "options"_a = std::vector<std::string>{},
        "budget_s"_a = defaults.budget_s, "evaluations"_a = defaults.evaluations,
        "holdout"_a = defaults.holdout, "seed"_a = defaults.seed, "progress"_a = py::none(),
        "preset"_a = "default", "config"_a = py::none(), "exec"_a = py::none(), doc.c_str());
  note_groups(m, "tune", all_groups(), true);
}

}  // namespace cairn::python
