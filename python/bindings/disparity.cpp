// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/disparity/confidence.hpp>
#include <cairn/disparity/flatness.hpp>
#include <cairn/disparity/left_right.hpp>
#include <cairn/disparity/speckle.hpp>
#include <cairn/disparity/texture.hpp>
#include <cairn/disparity/uniqueness.hpp>
#include <cairn/grouping/evidence.hpp>
#include <cairn/image/noise.hpp>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

struct Verdicts {
  static constexpr const char* kType = "Sequence[NDArray[numpy.uint16]]";
  std::vector<Borrowed<Reject>> all;

  Verdicts(const py::object& value, const char* name) {
    if (!py::isinstance<py::sequence>(value)) refuse(name, value, "sequence");
    for (const py::handle verdict : value)
      all.emplace_back(py::reinterpret_borrow<py::object>(verdict), name);
  }
};

/// combine() takes a list of fixed length, so the verdicts are united into one.
Image<Reject> united(const Verdicts& verdicts, Size size, const Pool& pool) {
  Image<Reject> all(size, Reject::none, pool);
  for (const Borrowed<Reject>& verdict : verdicts.all) {
    expect_size(verdict.size(), "verdicts", size, "refined_px");
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) all(x, y) |= verdict.view()(x, y);
    }
  }
  return all;
}

/// An enum.IntFlag, which names the bits in an array of reasons.
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

void bind_disparity(py::module_& m) {
  using py::literals::operator""_a;
  m.attr("Reject") = reject_enum();

  Class<DisparityMap>(
      m, "DisparityMap",
      "Disparity for each pixel of the left image, and for each one without the reason. Arrays (H, W), "
      "read-only. A hole is where reject is not 0, and there disparity_px is NaN.")
      .shows("disparity_px", &DisparityMap::disparity_px, "float32, px; NaN = hole")
      .shows("reject", &DisparityMap::reject, "uint16, the bits of cairn.Reject; 0 = none");

  stage(
      m, "reject_inconsistent", {"left_right"},
      "Pixels whose match, followed back from the right image, does not return to them: (H, W) uint16, "
      "Reject.left_right or 0.",
      [](const Call& call, const Matches& matches) {
        return reject_inconsistent(matches, call.config.left_right, call.exec);
      },
      "matches"_a);
  stage(
      m, "reject_ambiguous", {"uniqueness"},
      "Pixels with more than one suitable minimum: (H, W) uint16, Reject.not_unique or 0.",
      [](const Call& call, const Matches& matches) {
        return reject_ambiguous(matches, call.config.uniqueness, call.exec);
      },
      "matches"_a);
  stage(
      m, "reject_flat", {"flatness"},
      "Pixels with a constant correlation function: (H, W) uint16, Reject.flat or 0.",
      [](const Call& call, const Matches& matches) {
        return reject_flat(matches, call.config.flatness, call.exec);
      },
      "matches"_a);
  stage(
      m, "reject_textureless", {"texture"},
      "Pixels without enough texture (Moravec operator): (H, W) uint16, Reject.no_texture or 0. left: (H, W) "
      "or (H, "
      "W, 3) uint8.",
      [](const Call& call, const Picture& left) {
        return reject_textureless(left.gray(), call.config.texture, call.exec);
      },
      "left"_a);
  stage(
      m, "combine", {},
      "Unites verdicts, arrays (H, W) uint16 of cairn.Reject bits (yours among them), with the disparities: "
      "a pixel "
      "keeps every bit that it got, NaN adds Reject.border. refined_px: (H, W) float32, px.",
      [](const Call& call, const Disparities& refined_px, const Verdicts& verdicts) {
        const Image<Reject> all = united(verdicts, refined_px.size(), call.exec.pool);
        return combine(copied(refined_px.view(), call.exec.pool), {all}, call.exec);
      },
      "refined_px"_a, "verdicts"_a);
  stage(
      m, "external_disparity", {},
      "A map from outside (depth camera, learned matcher), (H, W) float32 in px: NaN and inf become holes "
      "with "
      "Reject.no_data.",
      [](const Call& call, const Floats& disparity_px) {
        return external_disparity(disparity_px.view(), call.exec);
      },
      "disparity_px"_a);
  stage(
      m, "noise_sigma", {},
      "The standard deviation of the image's noise, grey levels; stages that weigh edges ask for it.",
      [](const Call& call, const Picture& left) { return noise_sigma(left.gray(), call.exec); }, "left"_a);
  stage(
      m, "find_evidence", {"evidence"},
      "The disparities that rest on the pixel's own texture, NaN elsewhere: (H, W) float32, px. noise_sigma "
      "as "
      "noise_sigma() gives it.",
      [](const Call& call, const Picture& left, const DisparityInput& disparity, NoiseSigma noise) {
        return find_evidence(left.gray(), disparity.map(), noise.value, call.config.evidence, call.exec);
      },
      "left"_a, "disparity"_a, "noise_sigma"_a);
  stage(
      m, "reject_speckles", {"speckle"}, "Rejects small islands of disparity.",
      [](const Call& call, DisparityInput& disparity) {
        return reject_speckles(disparity.taken(call.exec), call.config.speckle, call.exec);
      },
      "disparity"_a);
  stage(
      m, "estimate_confidence", {"match"},
      "How likely each disparity is within 1 px of the truth: (H, W) float32, 0 to 1; 0 where there is none. "
      "Of the "
      "group match only `method` counts: how `matches` was made.",
      [](const Call& call, const Matches& matches, const DisparityInput& disparity) {
        return estimate_confidence(matches, disparity.map(), confidence_model(call.config.match.method),
                                   call.exec);
      },
      "matches"_a, "disparity"_a);
}

}  // namespace cairn::python
