// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <pybind11/stl.h>

#include <cairn/core/error.hpp>
#include <cairn/core/nearest.hpp>
#include <cairn/diagnosis/diagnose.hpp>
#include <cairn/diagnosis/synchrony.hpp>
#include <io/calibration_files.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "options.hpp"
#include "pickling.hpp"
#include "rig.hpp"

namespace cairn::python {
namespace {

// ---- measuring ----

PairMeasures measure_one(const ImageArgument& left, const ImageArgument& right, bool bgr,
                         const py::object& exec) {
  const Exec how = exec_of(exec);
  const Picture l(left, "left", bgr, how.pool);
  const Picture r(right, "right", bgr, how.pool);
  const auto pair = StereoPair::from(l.gray(), r.gray());
  return released([&] { return measure_pair(pair, how); });
}

std::string type_of(const py::handle& value) {
  return py::type::handle_of(value).attr("__name__").cast<std::string>();
}

/// The pictures of many pairs, kept as long as the pairs.
struct Sequence {
  std::vector<Picture> pictures;
  std::vector<StereoPair> pairs;

  void add(const py::handle& entry, bool bgr, const Pool& pool) {
    const std::string number = std::to_string(pairs.size());
    if (!py::isinstance<py::sequence>(entry) || py::len(entry) != 2) {
      throw Error("pairs: found a value of type " + type_of(entry) + " as number " + number +
                  ", expected (left, right)");
    }
    const auto both = py::reinterpret_borrow<py::sequence>(entry);
    const std::string left_name = "left of pair " + number;
    const std::string right_name = "right of pair " + number;
    pictures.emplace_back(py::object(both[0]), left_name.c_str(), bgr, pool);
    pictures.emplace_back(py::object(both[1]), right_name.c_str(), bgr, pool);
    const View<const Gray> left = pictures[pictures.size() - 2].gray();
    const View<const Gray> right = pictures.back().gray();
    const Size expected = pairs.empty() ? left.size() : pairs.front().size();
    expect_size(left.size(), left_name.c_str(), expected, "left of pair 0");
    expect_size(right.size(), right_name.c_str(), expected, "left of pair 0");
    pairs.push_back(StereoPair::from(left, right));
  }
};

Synchrony measure_many(const PairsArgument& pairs, bool bgr, const py::object& exec) {
  if (!py::isinstance<py::iterable>(pairs)) {
    throw Error("pairs: found a value of type " + type_of(pairs) + ", expected a sequence of (left, right)");
  }
  const Exec how = exec_of(exec);
  Sequence sequence;
  for (const py::handle entry : pairs) sequence.add(entry, bgr, how.pool);
  return released([&] { return measure_synchrony(sequence.pairs, how); });
}

// ---- judging ----

std::string short_text(double value) {
  return py::str("{:g}").format(value).cast<std::string>();
}

template <class T>
std::string range_text(const Range<T>& range) {
  return short_text(static_cast<double>(range.lowest)) + " … " +
         short_text(static_cast<double>(range.highest));
}

template <class T>
void set_limit(const std::string& name, T& limit, const Range<T>& range, const py::handle& value) {
  const auto refuse = [&] {
    throw Error("limits: " + name + ": found " + py::repr(value).cast<std::string>() + ", expected a " +
                (std::is_integral_v<T> ? "whole number, " : "number, ") + range_text(range));
  };
  if (PyFloat_Check(value.ptr()) == 0 && PyIndex_Check(value.ptr()) == 0 && !py::hasattr(value, "__float__"))
    refuse();
  const auto number = py::float_(py::reinterpret_borrow<py::object>(value)).cast<double>();
  const bool inside =
      number >= static_cast<double>(range.lowest) && number <= static_cast<double>(range.highest);
  if (!inside) refuse();
  limit = static_cast<T>(number);
  if (std::is_integral_v<T> && static_cast<double>(limit) != number) refuse();
}

/// Keys are those of fields(DiagnosisConfig).
DiagnosisConfig limits_of(const std::optional<py::dict>& limits) {
  DiagnosisConfig config;
  if (!limits) return config;
  for (const auto& [key, value] : *limits) {
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
    text += "    " + std::string(name) + " = " + short_text(static_cast<double>(limit)) +
            (unit.empty() ? "" : " " + unit) + " (" + range_text(range) + "): " + help + "\n";
  });
  return text;
}

std::vector<Finding> diagnose_pair(const PairMeasures& measures, const RigArgument& rig,
                                   const std::optional<py::dict>& limits, const py::object& config,
                                   const py::object& exec, const py::kwargs& options) {
  (void)exec_of(exec);  // as every stage takes one; there is nothing to share out
  const PyCalibration known = calibration_of(rig);
  io::check_size(known.calibration, measures.size, known.path);
  io::check_search_range(known.calibration, known.path);
  PyConfig wanted;
  wanted.config = stage_config(config);
  wanted.range_given = options.contains("num_disparities") ||
                       (!config.is_none() && config.cast<const PyConfig&>().range_given);
  set_flat(wanted.config, {"match"}, options);
  const Config ranged = wanted.suited(known.calibration);
  return diagnose(measures, known.calibration.rig, ranged.match, limits_of(limits));
}

// ---- showing ----

std::string text_of(const char* format, double value) {
  return py::str(format).format(value).cast<std::string>();
}
std::string percent(double share) {
  return text_of("{:.0%}", share);
}

std::string severity(const Finding& self) {
  return std::string(kSeverities.at(static_cast<std::size_t>(self.severity)).name);
}

template <std::string_view FindingInfo::*text>
std::string known_text(const Finding& self) {
  return std::string(info(self.kind).*text);
}

double share_px(const PairMeasures& self, double share) {
  if (!(share >= 0 && share <= 1)) throw Error("share: found " + short_text(share) + ", expected 0 … 1");
  return self.disparity_px(share);
}

/// Values of a Synchrony by how many frames the right camera is late.
template <std::array<double, Synchrony::kLags> Synchrony::*values>
py::dict by_lag(const Synchrony& self) {
  py::dict all;
  int lag = -Synchrony::kMostLag;
  for (const double value : self.*values) all[py::int_(lag++)] = value;
  return all;
}

py::dict by_rows(const RowAlignment& self) {
  py::dict all;
  int rows = -RowAlignment::kMostBins;
  for (const int points : self.histogram) all[py::int_(rows++)] = points;
  return all;
}

std::string rows_text(const RowAlignment& self) {
  return text_of("{:+.2f} rows", static_cast<double>(self.offset_rows)) +
         text_of(", {:+.2g} rows per px", static_cast<double>(self.rows_per_px)) + ", " +
         std::to_string(self.agreeing) + " of " + std::to_string(self.points) + " points agree";
}

std::string measures_repr(const PairMeasures& self) {
  return "<cairn.PairMeasures " + text(self.size) + ": " + rows_text(self.rows) +
         text_of(", disparities {:.1f}", self.disparity_px(0.02)) +
         text_of(" … {:.1f} px", self.disparity_px(0.98)) + ">";
}

std::string finding_repr(const Finding& self) {
  return "<cairn.Finding " + severity(self) + ", " + std::string(info(self.kind).name) + ": " + self.says +
         ">";
}

std::string exposure_repr(const Exposure& self) {
  return "<cairn.Exposure " + percent(static_cast<double>(self.black)) + " black, " +
         percent(static_cast<double>(self.white)) +
         text_of(" white, contrast {:.0f} grey levels>", static_cast<double>(self.contrast));
}

std::string brightness_repr(const BrightnessDifference& self) {
  if (!self.is_measured()) {
    return "<cairn.BrightnessDifference not measured: " + std::to_string(self.points) +
           " windows, it takes " + std::to_string(BrightnessDifference::kLeastPoints) + ">";
  }
  return "<cairn.BrightnessDifference right = " + text_of("{:.2f} * left ", static_cast<double>(self.gain)) +
         text_of("{:+.1f}, ", static_cast<double>(self.offset)) +
         text_of("{:.1f} grey levels apart, from ", static_cast<double>(self.median)) +
         std::to_string(self.points) + " windows>";
}

std::string sharpness_repr(const Sharpness& self) {
  return "<cairn.Sharpness " + text_of("{:.1f} px, from ", static_cast<double>(self.edge_px)) +
         std::to_string(self.edges) + " edges>";
}

std::optional<std::tuple<int, int, int>> change_of(const Synchrony& self) {
  if (!self.change) return std::nullopt;
  return std::tuple{self.change->from, self.change->before, self.change->after};
}

std::string synchrony_repr(const Synchrony& self) {
  return "<cairn.Synchrony " + std::to_string(self.frames) + " frames: lag " + std::to_string(self.lag()) +
         ", repeats left " + std::to_string(self.left_repeats) + ", right " +
         std::to_string(self.right_repeats) + ">";
}

// ---- classes ----

void bind_parts(py::module_& m) {
  py::class_<RowAlignment>(
      m, "RowAlignment",
      "How well the rows of both pictures are the same: what the left one shows in row y should stand in the "
      "right one's row y; it stands at y + offset_rows + rows_per_px * (x - (width - 1) / 2).")
      .def_readonly("points", &RowAlignment::points, "found in both pictures")
      .def_readonly("agreeing", &RowAlignment::agreeing,
                    "those of them within a row of what a smooth distortion explains")
      .def_property_readonly("agreeing_share", &RowAlignment::agreeing_share, "0 to 1: agreeing / points")
      .def_readonly("offset_rows", &RowAlignment::offset_rows, "rows, in the middle column")
      .def_readonly("rows_per_px", &RowAlignment::rows_per_px, "tangent of the roll")
      .def_readonly("left_over_rows", &RowAlignment::left_over_rows,
                    "rows that 9 in 10 points at most are off once shift and roll are taken back")
      .def_property_readonly("histogram", &by_rows,
                             "by rows that the right point is lower, -8 to 8: points; the outermost count "
                             "all beyond")
      .def("__repr__",
           [](const RowAlignment& self) { return "<cairn.RowAlignment " + rows_text(self) + ">"; })
      .def(pickled<RowAlignment>());
  py::class_<Exposure>(m, "Exposure", "How one camera used its 256 grey levels.")
      .def_readonly("black", &Exposure::black, "0 to 1: share of the pixels at level 0 or 1")
      .def_readonly("white", &Exposure::white, "0 to 1: share of the pixels at level 254 or 255")
      .def_readonly("contrast", &Exposure::contrast,
                    "grey levels between the darkest and the brightest hundredth of the pixels")
      .def("__repr__", &exposure_repr)
      .def(pickled<Exposure>());
  py::class_<BrightnessDifference>(
      m, "BrightnessDifference",
      "What the right camera makes of the left one's brightness: right = gain * left + offset.")
      .def_readonly("points", &BrightnessDifference::points,
                    "windows compared; with fewer than 50 no difference is measured")
      .def_property_readonly("is_measured", &BrightnessDifference::is_measured,
                             "otherwise gain, offset and median are those of equal cameras")
      .def_readonly("gain", &BrightnessDifference::gain,
                    "factor on the left one's grey levels; 1 where both agree, or too little varies")
      .def_readonly("offset", &BrightnessDifference::offset, "grey levels")
      .def_readonly("median", &BrightnessDifference::median, "of |right - left|, grey levels")
      .def("__repr__", &brightness_repr)
      .def(pickled<BrightnessDifference>());
  py::class_<Sharpness>(m, "Sharpness", "How many pixels an edge takes from dark to bright.")
      .def_readonly("edges", &Sharpness::edges, "that were measured")
      .def_readonly("edge_px", &Sharpness::edge_px,
                    "px, a quarter of them are narrower; 1 = a step; 0 = too few edges")
      .def("__repr__", &sharpness_repr)
      .def(pickled<Sharpness>());
}

void bind_measures(py::module_& m) {
  using py::literals::operator""_a;
  py::class_<PairMeasures>(m, "PairMeasures", "All that measure_pair() measures of one pair.")
      .def_property_readonly(
          "size",
          [](const PairMeasures& self) {
            return std::pair{self.size.width, self.size.height};
          },
          "(width, height), px")
      .def_readonly("identical", &PairMeasures::identical,
                    "the right picture is the left one, pixel for pixel")
      .def_readonly("textured_points", &PairMeasures::textured_points,
                    "of the left picture, that were looked for in the right one")
      .def_readonly("rows", &PairMeasures::rows, "a RowAlignment")
      .def_property_readonly(
          "disparities_px",
          [](const PairMeasures& self) { return array_from(std::vector<float>(self.disparities_px)); },
          "float32, px, ascending: of the points that agree and are not alone with theirs; a copy")
      .def("disparity_px", &share_px, "share"_a,
           "The disparity, px, that `share` (0 to 1) of the points stay below; NaN without points.")
      .def_readonly("brightness", &PairMeasures::brightness, "a BrightnessDifference")
      .def_readonly("left_exposure", &PairMeasures::left_exposure, "an Exposure")
      .def_readonly("right_exposure", &PairMeasures::right_exposure, "an Exposure")
      .def_readonly("left_sharpness", &PairMeasures::left_sharpness, "a Sharpness")
      .def_readonly("right_sharpness", &PairMeasures::right_sharpness, "a Sharpness")
      .def("__repr__", &measures_repr)
      .def(pickled<PairMeasures>());
  py::class_<Synchrony>(m, "Synchrony",
                        "Whether the two cameras of a sequence took their pictures at the same moments.")
      .def_readonly("frames", &Synchrony::frames, "pairs that were looked at")
      .def_property_readonly("lag", &Synchrony::lag,
                             "frames that the right camera is late, as the numbers say; 0 without evidence")
      .def_property_readonly(
          "motion", &by_lag<&Synchrony::motion>,
          "by frames that the right camera is late, -2 to 2: correlation of the changes in "
          "both pictures, -1 to 1; 0 where nothing changes")
      .def_property_readonly("agreement", &by_lag<&Synchrony::agreement>,
                             "by the same: share of the textured points that agree in their rows, 0 to 1; 0 "
                             "where not tried")
      .def_readonly("left_repeats", &Synchrony::left_repeats,
                    "frames in which only the left picture is the one before once more")
      .def_readonly("right_repeats", &Synchrony::right_repeats, "the same of the right one")
      .def_property_readonly(
          "change", &change_of,
          "None, or (frame, lag before, lag after): from that frame on, give or take one, the "
          "right camera is late by another number of frames")
      .def_property_readonly("tells", &Synchrony::tells,
                             "whether the numbers tell one lag from another: False where too little moves")
      .def("__repr__", &synchrony_repr)
      .def(pickled<Synchrony>());
  py::class_<Finding>(m, "Finding", "One thing that is wrong with a rig.")
      .def_property_readonly("kind", &known_text<&FindingInfo::name>,
                             "what it is, 'cameras swapped'; `cairn doctor` calls it the same")
      .def_property_readonly("severity", &severity,
                             "'note', 'warning': results suffer, or 'broken': no result can be trusted")
      .def_readonly("value", &Finding::value, "the number that was measured")
      .def_property_readonly("number", &known_text<&FindingInfo::number>, "what that number is, in words")
      .def_property_readonly("unit", &known_text<&FindingInfo::unit>, "its unit; may be empty")
      .def_readonly("says", &Finding::says, "one sentence with the numbers")
      .def_property_readonly("remedy", &known_text<&FindingInfo::remedy>, "what to do about it")
      .def("__repr__", &finding_repr)
      .def(pickled<Finding>());
}

}  // namespace

void bind_diagnosis(py::module_& m) {
  using py::literals::operator""_a;
  bind_parts(m);
  bind_measures(m);

  m.def("measure_pair", &measure_one, "left"_a, "right"_a, py::kw_only(), "bgr"_a = false,
        "exec"_a = py::none(),
        "Measures what diagnose() judges: rows, disparities, brightness, exposure and sharpness of a pair. "
        "left, right: (H, W) or (H, W, 3) uint8 of one size; they need not be rectified.");
  m.def("measure_synchrony", &measure_many, "pairs"_a, py::kw_only(), "bgr"_a = false, "exec"_a = py::none(),
        "Measures whether both cameras of consecutive pairs, (left, right) each and all of one size, took "
        "their pictures at the same moments. All of them are held at once; of fewer than 8 nothing is "
        "measured but repeats.");

  const std::string doc =
      with_options(
          "What is wrong with a pair, a cause before what follows from it; nothing for a good one. As in "
          "segment(), a Calibration brings its number of disparities as default and must be of the pictures' "
          "size; without rig nothing is said of a calibration. Of the options only min_disparity and "
          "num_disparities count: the range that would be searched.",
          {"match"}, false) +
      limits_text();
  m.def("diagnose", &diagnose_pair, "measures"_a, "rig"_a = py::none(), py::kw_only(),
        "limits"_a = py::none(), "config"_a = py::none(), "exec"_a = py::none(), doc.c_str());
  m.def(
      "diagnose", [](const Synchrony& synchrony) { return diagnose(synchrony); }, "synchrony"_a,
      "The same of a sequence: None where the cameras run together, a note where the sequence does not "
      "tell.");
  note_groups(m, "diagnose", {"match"}, false);
}

}  // namespace cairn::python
