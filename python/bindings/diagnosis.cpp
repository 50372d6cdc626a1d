// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/nearest.hpp>
#include <cairn/diagnosis/diagnose.hpp>
#include <cairn/diagnosis/synchrony.hpp>
#include <io/calibration_files.hpp>
#include <io/diagnosis_json.hpp>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

// ---- measuring ----

/// The images of several pairs, kept alive with the pairs.
struct Sequence {
  std::vector<Picture> pictures;
  std::vector<StereoPair> pairs;

  void add(const py::handle& entry, bool bgr, const Pool& pool) {
    const std::string number = std::to_string(pairs.size());
    if (!py::isinstance<py::sequence>(entry) || py::len(entry) != 2)
      throw ArgumentError("pairs: found " + shown(entry) + " as number " + number +
                          ", expected (left, right)");
    const auto both = py::reinterpret_borrow<py::sequence>(entry);
    const std::string left_name = "left of pair " + number;
    const std::string right_name = "right of pair " + number;
    const auto& left = pictures.emplace_back(py::object(both[0]), left_name.c_str(), bgr, pool).gray();
    const auto& right = pictures.emplace_back(py::object(both[1]), right_name.c_str(), bgr, pool).gray();
    const Size expected = pairs.empty() ? left.size() : pairs.front().size();
    expect_size(left.size(), left_name, expected, "left of pair 0");
    expect_size(right.size(), right_name, expected, "left of pair 0");
    pairs.push_back(StereoPair::from(left, right));
  }
};

Synchrony measure_many(const Call& call, const Typed<"Iterable[Tuple[ImageLike, ImageLike]]">& pairs,
                       bool bgr) {
  if (!py::isinstance<py::iterable>(pairs))
    throw ArgumentError("pairs: found " + shown(pairs) + ", expected a sequence of (left, right)");
  Sequence sequence;
  for (const py::handle entry : pairs) sequence.add(entry, bgr, call.exec.pool);
  return released([&] { return measure_synchrony(sequence.pairs, call.exec); });
}

// ---- judging ----

template <class T>
std::string range_text(const Range<T>& range) {
  const auto number = [](T value) {
    return py::str("{:g}").format(double(value)).template cast<std::string>();
  };
  return number(range.lowest) + " … " + number(range.highest);
}

template <class T>
void set_limit(const std::string& name, T& limit, const Range<T>& range, const py::handle& value) {
  const bool is_number =
      PyFloat_Check(value.ptr()) != 0 || PyIndex_Check(value.ptr()) != 0 || py::hasattr(value, "__float__");
  const double number =
      is_number ? py::float_(py::reinterpret_borrow<py::object>(value)).cast<double>() : NAN;
  if (number >= double(range.lowest) && number <= double(range.highest) &&
      (!std::is_integral_v<T> || number == std::floor(number))) {
    limit = static_cast<T>(number);
    return;
  }
  throw Error("limits: " + name + ": found " + py::repr(value).cast<std::string>() + ", expected a " +
              (std::is_integral_v<T> ? "whole number, " : "number, ") + range_text(range));
}

/// The keys are those of fields(DiagnosisConfig).
DiagnosisConfig limits_of(const std::optional<py::dict>& limits) {
  DiagnosisConfig config;
  for (const auto& [key, value] : limits.value_or(py::dict())) {
    const auto wanted = py::str(key).cast<std::string>();
    std::vector<std::string> names;
    bool found = false;
    fields(config,
           [&, &given = value](const char* name, auto& limit, const char*, const char*, const auto& range) {
             names.emplace_back(name);
             if (wanted != name) return;
             set_limit(wanted, limit, range, given);
             found = true;
           });
    if (found) continue;
    const std::string close = nearest(wanted, names);
    throw Error("limits: there is no '" + wanted.substr(0, 80) + "'" +
                (close.empty() ? "; help(cairn.diagnose) lists them" : ", did you mean '" + close + "'?"));
  }
  return config;
}

std::string limits_text() {
  DiagnosisConfig config;
  std::string text = "\n\nlimits, a dict of what is to differ:\n";
  fields(config, [&](const char* name, const auto& limit, const std::string& unit, const char* help,
                     const auto& range) {
    text += "    " + std::string(name) + " = " + py::str("{:g}").format(limit).template cast<std::string>() +
            (unit.empty() ? "" : " " + unit) + " (" + range_text(range) + "): " + help + "\n";
  });
  return text;
}

py::object diagnosis(const Call& call, const Typed<"Union[PairMeasures, Synchrony]">& measures,
                     const KnownRig& rig, const std::optional<py::dict>& limits) {
  if (py::isinstance<Synchrony>(measures)) return py::cast(diagnose(measures.cast<const Synchrony&>()));
  if (!py::isinstance<PairMeasures>(measures))
    throw ArgumentError("measures: found " + shown(measures) +
                        ", expected a cairn.PairMeasures or a cairn.Synchrony");
  const auto& pair = measures.cast<const PairMeasures&>();
  rig.check(pair.size);
  PyConfig wanted{"default", call.config, call.options.contains("num_disparities")};
  if (!call.given_config.is_none())
    wanted.range_given |= call.given_config.cast<const PyConfig&>().range_given;
  return py::cast(diagnose(pair, rig.rig(), wanted.suited(rig.calibration).match, limits_of(limits)));
}

double disparity_below(const PairMeasures& self, double share) {
  if (share >= 0 && share <= 1) return self.disparity_px(share);
  throw Error("share: found " + py::str("{:g}").format(share).cast<std::string>() + ", expected 0 … 1");
}

}  // namespace

void bind_diagnosis(py::module_& m) {
  using py::literals::operator""_a;
  Class<PairMeasures>(
      m, "PairMeasures",
      "Result of measure_pair(): the numbers of `cairn doctor --json` (docs/formats.md) as items and "
      "attributes, e.g. measures.offset_rows; None where one was not measured.")
      .shows("size", &PairMeasures::size, "(width, height), px")
      .shows("identical", &PairMeasures::identical, "the right image is the left one, pixel for pixel")
      .shows(
          "disparities_px", [](const PairMeasures& self) { return Numbers<float>{self.disparities_px}; },
          "float32, px, ascending: of the points that agree and are not alone with theirs; a copy")
      .shows_json([](const PairMeasures& self) { return io::measures_json(self); })
      .method("disparity_px",
              "The disparity, px, that `share` (0 to 1) of the points stay below; NaN without points.",
              &disparity_below, "share"_a);
  Class<Synchrony>(
      m, "Synchrony",
      "Whether the two cameras of a sequence took their images at the same moments: the numbers of `cairn "
      "doctor --json` (docs/formats.md) as items and attributes: lag is how many frames the right camera "
      "is late.")
      .shows("tells", &Synchrony::tells,
             "whether the numbers tell one lag from another: False where too little moves")
      .shows_json([](const Synchrony& self) { return io::synchrony_json(self, {}); });
  Class<Finding>(
      m, "Finding",
      "One thing that is wrong with a rig, as `cairn doctor --json` has it (docs/formats.md): severity, "
      "value, number, unit, says and remedy as items and attributes.")
      .shows(
          "kind", [](const Finding& self) { return info(self.kind).name; },
          "what it is, 'cameras swapped'; `cairn doctor` calls it the same")
      .shows_json([](const Finding& self) { return io::finding_json(self, {}); });

  define(
      m, "measure_pair",
      "Measures what diagnose() judges: rows, disparities, brightness, exposure and sharpness of a pair. "
      "left, right: "
      "(H, W) or (H, W, 3) uint8 of one size; they need not be rectified.",
      [](const Call& call, const Picture& left, const Picture& right) {
        const auto pair = StereoPair::from(left.gray(), right.gray());
        return released([&] { return measure_pair(pair, call.exec); });
      },
      "left"_a, "right"_a);
  define(m, "measure_synchrony",
         "Measures whether both cameras of consecutive pairs, (left, right) each and all of one size, took "
         "their images "
         "at the same moments. All of them are held at once; of fewer than 8 only repeats are measured.",
         &measure_many, "pairs"_a, py::kw_only(), "bgr"_a = false);
  define(
      m, "diagnose", Options{Keywords::of_stage, {"match"}, nullptr, false},
      "What is wrong with a pair, a list of Finding, a cause before what follows from it; [] for a good one. "
      "As in "
      "segment(), a Calibration brings its number of disparities as default and must be of the images' size; "
      "without rig no calibration is judged. Of the options only min_disparity and num_disparities count: "
      "the range "
      "that would be searched. Of a Synchrony: a Finding, or None where the cameras run together." +
          limits_text(),
      &diagnosis, "measures"_a, "rig"_a = py::none(), py::kw_only(), "limits"_a = py::none());
}

}  // namespace cairn::python
