// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/scene/background.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <cairn/scene/ground_plane.hpp>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

/// The options, completed by the calibration's ground. Throws Error if they need more than it has.
GroundConfig ground_config(const Config& config, const KnownRig& rig) {
  GroundConfig ground = config.ground;
  ground.known = rig.calibration.ground;
  validate(ground, rig.rig().has_value());
  return ground;
}

/// For a DisparityMap: only its supported disparities; for floats: all.
struct MapOrEvidence {
  static constexpr const char* kType = DisparityInput::kType;
  std::optional<DisparityInput> map;
  std::optional<Disparities> evidence;

  MapOrEvidence(const py::object& value, const char* name, const Exec& exec) {
    if (py::isinstance<DisparityMap>(value)) {
      map.emplace(value, name, exec);
    } else {
      evidence.emplace(value, name);
    }
  }
  [[nodiscard]] Size size() const { return map ? map->size() : evidence->size(); }
};

}  // namespace

void bind_ground(py::module_& m) {
  using py::literals::operator""_a;

  Class<GroundPlane>(m, "GroundPlane",
                     "A plane as the left image's disparity: d = a * x + b * y + c, all in px.")
      .shows("a", &GroundPlane::a, "px of disparity for each px to the right")
      .shows("b", &GroundPlane::b, "px of disparity for each px downwards; a floor's is above 0")
      .shows("c", &GroundPlane::c, "px of disparity at x = 0, y = 0")
      .method(
          "disparity_px", "The plane's disparity at (x, y), px; below 0 beyond the horizon.",
          [](const GroundPlane& self, float x, float y) { return self.disparity_px(x, y); }, "x"_a, "y"_a)
      .method("__iter__", "a, b and c.", [](const GroundPlane& self) {
        return Typed<"Iterator[float]">(py::iter(py::make_tuple(self.a, self.b, self.c)));
      });
  Class<Ground>(m, "Ground", "The floor, or why there is none.")
      .shows("plane", &Ground::plane, "a GroundPlane, or None")
      .shows("support", &Ground::support,
             "0 to 1: share of the valid pixels under the horizon that lie on it")
      .shows("residual_px", &Ground::residual_px, "root mean square distance of these from it, px")
      .shows(
          "refusal", [](const Ground& self) { return choice_name(self.refusal, kRefusals); },
          "why there is no plane, in words; 'none' where there is one")
      .method("__bool__", "Whether there is a plane.",
              [](const Ground& self) { return self.plane.has_value(); });
  Class<FloorFrame>(
      m, "FloorFrame",
      "Where the floor is, in metres: its frame has its origin on the floor below the left camera, x "
      "forward, y left, z up.")
      .shows("camera_height_m", &FloorFrame::camera_height_m, "of the left camera above the floor, m")
      .shows("pitch_rad", &FloorFrame::pitch_rad, "of the camera: positive looks down")
      .shows("roll_rad", &FloorFrame::roll_rad, "of the camera: positive lowers its right side")
      .shows(
          "floor_from_camera",
          [](const FloorFrame& self) {
            const std::array<float, 16> all = self.floor_from_camera();
            return Numbers<float>{{all.begin(), all.end()}, {4, 4}};
          },
          "4 x 4: takes homogeneous points from the camera's frame to the floor's");
  define(
      m, "floor_frame",
      "Where the floor is: a FloorFrame, or None for a plane that no floor below a camera can show.",
      [](const GroundPlane& ground, const KnownRig& rig) {
        if (!rig.rig()) throw Error("rig: found none, expected one: a frame of the floor is in metres");
        return floor_frame(ground, *rig.rig());
      },
      "ground"_a, "rig"_a);
  Class<Background>(m, "Background", "The planes that bound the scene from behind: floor and walls.")
      .shows("planes", &Background::planes, "a list of GroundPlane")
      .shows("has_floor", &Background::has_floor, "whether the first of them is the floor")
      .method(
          "disparity_px", "Of the nearest of them, at least 0; px.",
          [](const Background& self, float x, float y) { return self.disparity_px(x, y); }, "x"_a, "y"_a);

  stage(
      m, "fit_ground", {"ground"},
      "Finds the floor in a disparity map, or in floats, NaN = hole: those alone that deserve trust; with "
      "these, "
      "`left` also shows a floor that mirrors so well that it has hardly any disparities of its own.",
      [](const Call& call, const MapOrEvidence& disparity, const KnownRig& rig,
         const std::optional<Picture>& left) {
        const GroundConfig config = ground_config(call.config, rig);
        if (disparity.map) return fit_ground(disparity.map->map(), rig.rig(), config, call.exec);
        return fit_ground(disparity.evidence->view(), rig.rig(), config, call.exec,
                          left ? left->gray() : View<const Gray>{});
      },
      "disparity"_a, "rig"_a = py::none(), py::kw_only(), "left"_a = py::none());
  stage(
      m, "reject_below_ground", {"ground"}, "Rejects matches under the floor, which are reflections.",
      [](const Call& call, DisparityInput& disparity, const Ground& ground, const KnownRig& rig) {
        return reject_below_ground(disparity.taken(call.exec), ground, rig.rig(), call.config.ground,
                                   call.exec);
      },
      "disparity"_a, "ground"_a, "rig"_a = py::none());
  stage(
      m, "label_floor", {"ground"},
      "(H, W) uint8: 255 where the disparity is the floor's, else 0. None where there is no ground or "
      "label_floor is "
      "off.",
      [](const Call& call, const DisparityInput& disparity, const Ground& ground, const KnownRig& rig) {
        return std::optional(label_floor(disparity.map(), ground, rig.rig(), call.config.ground, call.exec));
      },
      "disparity"_a, "ground"_a, "rig"_a = py::none());
  stage(
      m, "likely_ground", {"ground"},
      "The ground itself, or where it was refused for want of evidence, one fitted to all disparities: a "
      "plain floor "
      "has no texture that would vouch for it. evidence_px, as find_evidence() gives it, and left refuse planes that "
      "textured disparities show to be upright, and allow a floor that mirrors.",
      [](const Call& call, const Ground& ground, const DisparityInput& disparity, const KnownRig& rig,
         const std::optional<Disparities>& evidence_px, const std::optional<Picture>& left) {
        return likely_ground(ground, disparity.map(), rig.rig(), ground_config(call.config, rig), call.exec,
                             evidence_px ? evidence_px->view() : View<const float>{},
                             left ? left->gray() : View<const Gray>{});
      },
      "ground"_a, "disparity"_a, "rig"_a = py::none(), py::kw_only(), "evidence_px"_a = py::none(),
      "left"_a = py::none());
  stage(
      m, "floor_under_reflections", {},
      "(H, W) float32, px: the disparities of what is seen: those of the ground where a match was rejected "
      "as below "
      "it, NaN in other holes.",
      [](const Call& call, const DisparityInput& disparity, const Ground& ground) {
        return floor_under_reflections(disparity.map(), ground, call.exec);
      },
      "disparity"_a, "ground"_a);
  stage(
      m, "fit_background", {"background"},
      "Finds walls: upright planes with much evidence on them and hardly any behind. evidence_px as "
      "find_evidence() "
      "gives it.",
      [](const Call& call, const Disparities& evidence_px, const Ground& ground, const KnownRig& rig) {
        return fit_background(evidence_px.view(), ground, rig.rig(), call.config.background, call.exec);
      },
      "evidence_px"_a, "ground"_a, "rig"_a = py::none());
}

}  // namespace cairn::python
