// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "disparity.hpp"

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/disparity/confidence.hpp>
#include <cairn/disparity/flatness.hpp>
#include <cairn/disparity/left_right.hpp>
#include <cairn/disparity/speckle.hpp>
#include <cairn/disparity/texture.hpp>
#include <cairn/disparity/uniqueness.hpp>
#include <cairn/grouping/evidence.hpp>
#include <cairn/image/noise.hpp>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "options.hpp"
#include "pickling.hpp"

namespace cairn::python {
namespace {

ArrayOf<Reject> inconsistent(const Config& config, const Exec& exec, const Matches& matches) {
  return array_from(released([&] { return reject_inconsistent(matches, config.left_right, exec); }));
}

ArrayOf<Reject> ambiguous(const Config& config, const Exec& exec, const Matches& matches) {
  return array_from(released([&] { return reject_ambiguous(matches, config.uniqueness, exec); }));
}

ArrayOf<Reject> flat(const Config& config, const Exec& exec, const Matches& matches) {
  return array_from(released([&] { return reject_flat(matches, config.flatness, exec); }));
}

ArrayOf<Reject> textureless(const Config& config, const Exec& exec, const ImageArgument& left, bool bgr) {
  const Picture in(left, "left", bgr, exec.pool);
  return array_from(released([&] { return reject_textureless(in.gray(), config.texture, exec); }));
}

/// combine() itself takes a list of fixed length; the union of the verdicts is one verdict.
Image<Reject> united(const std::vector<Borrowed<Reject>>& verdicts, Size size, const Pool& pool) {
  Image<Reject> all(size, Reject::none, pool);
  for (const Borrowed<Reject>& verdict : verdicts) {
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) all(x, y) |= verdict.view()(x, y);
    }
  }
  return all;
}

DisparityMap combine_verdicts(const Config&, const Exec& exec, const FloatsArgument& refined_px,
                              const py::sequence& verdicts) {
  const BorrowedDisparities refined(refined_px, "refined_px");
  std::vector<Borrowed<Reject>> borrowed;
  for (const py::handle& verdict : verdicts) {
    borrowed.emplace_back(py::reinterpret_borrow<py::object>(verdict), "verdicts");
    expect_size(borrowed.back().size(), "verdicts", refined.size(), "refined_px");
  }
  return released([&] {
    const Image<Reject> all = united(borrowed, refined.size(), exec.pool);
    return combine(copied(refined.view(), exec.pool), {all}, exec);
  });
}

DisparityMap from_outside(const Config&, const Exec& exec, const FloatsArgument& disparity_px) {
  const Borrowed<float> in(disparity_px, "disparity_px");
  return released([&] { return external_disparity(in.view(), exec); });
}

ArrayOf<float> evidence(const Config& config, const Exec& exec, const ImageArgument& left,
                        const DisparityArgument& disparity, float noise_sigma, bool bgr) {
  const Picture in(left, "left", bgr, exec.pool);
  const DisparityInput map(disparity, "disparity", exec);
  expect_size(map.size(), "disparity", in.size(), "left");
  expect_noise(noise_sigma);
  return array_from(
      released([&] { return find_evidence(in.gray(), map.map(), noise_sigma, config.evidence, exec); }));
}

float noise_of(const Config&, const Exec& exec, const ImageArgument& left, bool bgr) {
  const Picture in(left, "left", bgr, exec.pool);
  return released([&] { return noise_sigma(in.gray(), exec); });
}

DisparityMap without_speckles(const Config& config, const Exec& exec, const DisparityArgument& disparity) {
  DisparityInput map(disparity, "disparity", exec);
  return released([&] { return reject_speckles(map.taken(exec), config.speckle, exec); });
}

ArrayOf<float> confidence(const Config& config, const Exec& exec, const Matches& matches,
                          const DisparityArgument& disparity) {
  const DisparityInput map(disparity, "disparity", exec);
  expect_size(map.size(), "disparity", matches.best.size(), "matches");
  return array_from(released(
      [&] { return estimate_confidence(matches, map.map(), confidence_model(config.match.method), exec); }));
}

/// enum.IntFlag: names the bits of an array of reasons, and of a union of them.
py::object reject_enum() {
  py::list members;
  members.append(py::make_tuple("none", 0));
  for (const auto& [name, bit] : kRejects) members.append(py::make_tuple(std::string(name), int(bit)));
  py::object made =
      py::module_::import("enum").attr("IntFlag")("Reject", members, py::arg("module") = "cairn");
  std::string doc =
      "Why a pixel has no disparity: a set of bits, as in frame.reject.\n"
      "    frame.reject & cairn.Reject.left_right != 0   # seen by one camera only\n";
  const char* between = "";
  for (const auto& [name, bit] : kRejects) {
    const auto reason =
        std::find_if(kReasons.begin(), kReasons.end(), [bit = bit](const Reason& r) { return r.bit == bit; });
    doc += between + std::string(name) + ": " + std::string(reason->says);
    between = "; ";
  }
  made.attr("__doc__") = doc + ".";
  return made;
}

}  // namespace

void expect_noise(float noise_sigma) {
  if (noise_sigma >= 0 && std::isfinite(noise_sigma)) return;
  throw Error("noise_sigma: found " + std::to_string(noise_sigma) + ", expected 0 or more grey levels");
}

DisparityInput::DisparityInput(const DisparityArgument& argument, const char* name, const Exec& exec) {
  if (py::isinstance<DisparityMap>(argument)) {
    borrowed_ = &argument.cast<const DisparityMap&>();
    return;
  }
  const Borrowed<float> in(argument, name);
  own_ = released([&] { return external_disparity(in.view(), exec); });
}

DisparityMap DisparityInput::taken(const Exec& exec) {
  if (own_) return std::move(*own_);
  return {borrowed_->disparity_px.clone(exec.pool), borrowed_->reject.clone(exec.pool)};
}

void bind_disparity(py::module_& m) {
  using py::literals::operator""_a;
  m.attr("Reject") = reject_enum();

  py::class_<DisparityMap>(
      m, "DisparityMap",
      "Disparity for each pixel of the left picture, and for each one without the reason. Arrays "
      "(H, W), read-only. A hole is where reject is not 0, and there disparity_px is NaN.")
      .def_property_readonly("disparity_px", always_shown(&DisparityMap::disparity_px),
                             "float32, px; NaN = hole")
      .def_property_readonly("reject", always_shown(&DisparityMap::reject),
                             "uint16, the bits of cairn.Reject; 0 = none")
      .def("__repr__",
           [](const DisparityMap& self) {
             return "<cairn.DisparityMap " + text(self.disparity_px.size()) + ">";
           })
      .def(pickled<DisparityMap>());

  def_stage(
      m, "reject_inconsistent", {"left_right"},
      "Pixels whose match, followed back from the right picture, does not return to them: (H, W) uint16, "
      "Reject.left_right or 0.",
      &inconsistent, "matches"_a, py::kw_only());
  def_stage(m, "reject_ambiguous", {"uniqueness"},
            "Pixels with more than one suitable minimum: (H, W) uint16, Reject.not_unique or 0.", &ambiguous,
            "matches"_a, py::kw_only());
  def_stage(m, "reject_flat", {"flatness"},
            "Pixels with a constant correlation function: (H, W) uint16, Reject.flat or 0.", &flat,
            "matches"_a, py::kw_only());
  def_stage(m, "reject_textureless", {"texture"},
            "Pixels without enough texture (Moravec operator): (H, W) uint16, Reject.no_texture or 0. left: "
            "(H, W) or "
            "(H, W, 3) uint8.",
            &textureless, "left"_a, py::kw_only(), "bgr"_a = false);
  def_stage(m, "combine", {},
            "Unites verdicts, arrays (H, W) uint16 of cairn.Reject bits (yours among them), with the "
            "disparities: a pixel "
            "keeps every bit that it got, NaN adds Reject.border. refined_px: (H, W) float32, px.",
            &combine_verdicts, "refined_px"_a, "verdicts"_a, py::kw_only());
  def_stage(m, "external_disparity", {},
            "A map from outside (depth camera, learned matcher), (H, W) float32 in px: NaN and inf become "
            "holes with "
            "Reject.no_data.",
            &from_outside, "disparity_px"_a, py::kw_only());
  def_stage(m, "noise_sigma", {},
            "The standard deviation of the picture's noise, grey levels; stages that weigh edges ask for it.",
            &noise_of, "left"_a, py::kw_only(), "bgr"_a = false);
  def_stage(m, "find_evidence", {"evidence"},
            "The disparities that rest on the pixel's own texture, NaN elsewhere: (H, W) float32, px. "
            "noise_sigma as noise_sigma() gives it.",
            &evidence, "left"_a, "disparity"_a, "noise_sigma"_a, py::kw_only(), "bgr"_a = false);
  def_stage(m, "reject_speckles", {"speckle"}, "Rejects small islands of disparity.", &without_speckles,
            "disparity"_a, py::kw_only());
  def_stage(m, "estimate_confidence", {"match"},
            "How likely each disparity is within 1 px of the truth: (H, W) float32, 0 to 1; 0 where there is "
            "none. Of the group match only `method` counts: how `matches` was made.",
            &confidence, "matches"_a, "disparity"_a, py::kw_only());
}

}  // namespace cairn::python
