// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/scene/background.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <optional>
#include <string>

#include "bindings.hpp"
#include "disparity.hpp"
#include "options.hpp"
#include "pickling.hpp"
#include "rig.hpp"

namespace cairn::python {
namespace {

struct KnownRig {
  std::optional<StereoRig> rig;
  GroundConfig ground;
};

/// The options, with what the calibration says of the ground. Throws Error where they ask for more than that.
KnownRig known_rig(const Config& config, const RigArgument& rig) {
  const io::Calibration calibration = calibration_of(rig).calibration;
  KnownRig known{calibration.rig, config.ground};
  known.ground.known = calibration.ground;
  validate(known.ground, known.rig.has_value());
  return known;
}

Ground fit(const Config& config, const Exec& exec, const DisparityArgument& disparity, const RigArgument& rig,
           const std::optional<ImageArgument>& left, bool bgr) {
  const KnownRig known = known_rig(config, rig);
  if (py::isinstance<DisparityMap>(disparity)) {
    const auto& map = disparity.cast<const DisparityMap&>();
    return released([&] { return fit_ground(map, known.rig, known.ground, exec); });
  }
  const BorrowedDisparities in(disparity, "disparity");
  std::optional<Picture> picture;
  if (left) {
    picture.emplace(*left, "left", bgr, exec.pool);
    expect_size(picture->size(), "left", in.size(), "disparity");
  }
  return released([&] {
    return fit_ground(in.view(), known.rig, known.ground, exec,
                      picture ? picture->gray() : View<const Gray>{});
  });
}

Ground likely(const Config& config, const Exec& exec, const Ground& ground,
              const DisparityArgument& disparity, const RigArgument& rig) {
  const KnownRig known = known_rig(config, rig);
  const DisparityInput map(disparity, "disparity", exec);
  return released([&] { return likely_ground(ground, map.map(), known.rig, known.ground, exec); });
}

DisparityMap without_reflections(const Config& config, const Exec& exec, const DisparityArgument& disparity,
                                 const Ground& ground, const RigArgument& rig) {
  const auto known = rig_of(rig);
  DisparityInput map(disparity, "disparity", exec);
  return released([&] { return reject_below_ground(map.taken(exec), ground, known, config.ground, exec); });
}

ArrayOf<float> seen_of(const Config& /*config*/, const Exec& exec, const DisparityArgument& disparity,
                       const Ground& ground) {
  const DisparityInput map(disparity, "disparity", exec);
  return array_from(released([&] { return floor_under_reflections(map.map(), ground, exec); }));
}

std::optional<ArrayOf<std::uint8_t>> floor_of(const Config& config, const Exec& exec,
                                              const DisparityArgument& disparity, const Ground& ground,
                                              const RigArgument& rig) {
  const auto known = rig_of(rig);
  const DisparityInput map(disparity, "disparity", exec);
  return array_or_none(released([&] { return label_floor(map.map(), ground, known, config.ground, exec); }));
}

Background walls(const Config& config, const Exec& exec, const FloatsArgument& evidence_px,
                 const Ground& ground, const RigArgument& rig) {
  const auto known = rig_of(rig);
  const BorrowedDisparities in(evidence_px, "evidence_px");
  return released([&] { return fit_background(in.view(), ground, known, config.background, exec); });
}

std::string refusal(const Ground& self) {
  return choice_name(self.refusal, kRefusals);
}

std::string plane_text(const GroundPlane& p) {
  return "d = " + std::to_string(p.a) + " x + " + std::to_string(p.b) + " y + " + std::to_string(p.c);
}

}  // namespace

void bind_ground(py::module_& m) {
  using py::literals::operator""_a;

  py::class_<GroundPlane>(m, "GroundPlane",
                          "A plane as the left picture's disparity: d = a * x + b * y + c, all in px.")
      .def_readonly("a", &GroundPlane::a, "px of disparity for each px to the right")
      .def_readonly("b", &GroundPlane::b, "px of disparity for each px downwards; a floor's is above 0")
      .def_readonly("c", &GroundPlane::c, "px of disparity at x = 0, y = 0")
      .def("disparity_px", &GroundPlane::disparity_px, "x"_a, "y"_a,
           "The plane's disparity at (x, y), px; below 0 beyond the horizon.")
      .def("__iter__",
           [](const GroundPlane& self) { return py::iter(py::make_tuple(self.a, self.b, self.c)); })
      .def("__repr__", [](const GroundPlane& self) { return "<cairn.GroundPlane " + plane_text(self) + ">"; })
      .def(pickled<GroundPlane>());
  py::class_<Ground>(m, "Ground", "The floor, or why there is none.")
      .def_readonly("plane", &Ground::plane, "a GroundPlane, or None")
      .def_readonly("support", &Ground::support,
                    "0 to 1: share of the valid pixels under the horizon that lie on it")
      .def_readonly("residual_px", &Ground::residual_px, "root mean square distance of these from it, px")
      .def_property_readonly("refusal", &refusal,
                             "why there is no plane, in words; 'none' where there is one")
      .def("__bool__", [](const Ground& self) { return self.plane.has_value(); })
      .def("__repr__",
           [](const Ground& self) {
             if (!self.plane) return "<cairn.Ground none: " + refusal(self) + ">";
             return "<cairn.Ground " + plane_text(*self.plane) + ", support " + std::to_string(self.support) +
                    ">";
           })
      .def(pickled<Ground>());
  py::class_<FloorFrame>(
      m, "FloorFrame",
      "Where the floor is, in metres: its frame has its origin on the floor below the left "
      "camera, x forward, y left, z up.")
      .def_readonly("camera_height_m", &FloorFrame::camera_height_m, "of the left camera above the floor, m")
      .def_property_readonly("pitch_rad", &FloorFrame::pitch_rad, "of the camera: positive looks down")
      .def_property_readonly("roll_rad", &FloorFrame::roll_rad,
                             "of the camera: positive lowers its right side")
      .def_property_readonly(
          "floor_from_camera",
          [](const FloorFrame& self) {
            const std::array<float, 16> all = self.floor_from_camera();
            std::array<std::array<float, 4>, 4> rows{};
            for (std::size_t i = 0; i < all.size(); ++i) rows[i / 4][i % 4] = all[i];
            return rows;
          },
          "4 rows of 4: takes homogeneous points from the camera's frame to the floor's")
      .def("__repr__",
           [](const FloorFrame& self) {
             return "<cairn.FloorFrame camera " + std::to_string(self.camera_height_m) +
                    " m above the floor>";
           })
      .def(pickled<FloorFrame>());
  m.def(
      "floor_frame",
      [](const GroundPlane& ground, const RigArgument& rig) -> std::optional<FloorFrame> {
        const auto known = rig_of(rig);
        if (!known) throw Error("rig: found none, expected one: where the floor is is said in metres");
        return floor_frame(ground, *known);
      },
      "ground"_a, "rig"_a,
      "Where the floor is: a FloorFrame, or None for a plane that no floor below a camera can show.");
  py::class_<Background>(m, "Background", "The planes that bound the scene from behind: floor and walls.")
      .def_readonly("planes", &Background::planes, "a list of GroundPlane")
      .def_readonly("has_floor", &Background::has_floor, "whether the first of them is the floor")
      .def("disparity_px", &Background::disparity_px, "x"_a, "y"_a, "Of the nearest of them, at least 0; px.")
      .def("__repr__",
           [](const Background& self) {
             return "<cairn.Background " + std::to_string(self.planes.size()) + " planes" +
                    (self.has_floor ? ", the first is the floor>" : ">");
           })
      .def(pickled<Background>());

  def_stage(m, "fit_ground", {"ground"},
            "Finds the floor in a disparity map (or in floats, NaN = hole: in those alone that deserve "
            "trust; with these, "
            "`left` also shows a floor that mirrors so well that it has hardly any disparities of its own).",
            &fit, "disparity"_a, "rig"_a = py::none(), py::kw_only(), "left"_a = py::none(), "bgr"_a = false);
  def_stage(m, "reject_below_ground", {"ground"}, "Rejects matches under the floor, which are reflections.",
            &without_reflections, "disparity"_a, "ground"_a, "rig"_a = py::none(), py::kw_only());
  def_stage(m, "label_floor", {"ground"},
            "(H, W) uint8: 255 where the disparity is the floor's, else 0. None where there is no ground or "
            "label_floor is "
            "off.",
            &floor_of, "disparity"_a, "ground"_a, "rig"_a = py::none(), py::kw_only());
  def_stage(m, "likely_ground", {"ground"},
            "The ground itself, or where it was refused for want of evidence, one fitted to all disparities: "
            "a plain floor has no texture that would vouch for it.",
            &likely, "ground"_a, "disparity"_a, "rig"_a = py::none(), py::kw_only());
  def_stage(m, "floor_under_reflections", {},
            "(H, W) float32, px: the disparities of what is seen: those of the ground where a match was "
            "rejected as below it, NaN in other holes.",
            &seen_of, "disparity"_a, "ground"_a, py::kw_only());
  def_stage(m, "fit_background", {"background"},
            "Finds walls: upright planes with much evidence on them and hardly any behind. evidence_px as "
            "find_evidence() "
            "gives it.",
            &walls, "evidence_px"_a, "ground"_a, "rig"_a = py::none(), py::kw_only());
}

}  // namespace cairn::python
