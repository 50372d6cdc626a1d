// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "rig.hpp"

#include <cairn/core/error.hpp>
#include <string>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

StereoRig make_rig(float focal_px, float baseline_m, float cx_px, float cy_px, float doffs_px) {
  const StereoRig rig{focal_px, cx_px, cy_px, baseline_m, doffs_px};
  rig.validate();
  return rig;
}

StereoRig rig_from_file(const std::filesystem::path& path) {
  const io::Calibration calibration = io::load_calibration(path);
  if (!calibration.rig) {
    throw Error(path.string() + ": found no focal length or no baseline, expected both for a rig");
  }
  return *calibration.rig;
}

bool equal(const StereoRig& a, const StereoRig& b) {
  return a.focal_px == b.focal_px && a.cx_px == b.cx_px && a.cy_px == b.cy_px &&
         a.baseline_m == b.baseline_m && a.doffs_px == b.doffs_px;
}

using Points = std::vector<std::tuple<float, float, float, float>>;

PyCalibration make_calibration(const std::optional<StereoRig>& rig,
                               const std::optional<std::pair<int, int>>& image_size,
                               std::optional<int> num_disparities, const Points& ground_points,
                               std::optional<float> camera_height_m, float camera_pitch_deg,
                               float camera_roll_deg) {
  PyCalibration made{{rig, {}, num_disparities, {}}, "Calibration()"};
  if (image_size) made.calibration.image_size = Size{image_size->first, image_size->second};
  KnownGround& ground = made.calibration.ground;
  for (const auto& [x_left, y_left, x_right, y_right] : ground_points)
    ground.points.push_back({x_left, y_left, x_right, y_right});
  ground.camera_height_m = camera_height_m;
  ground.camera_pitch_deg = camera_pitch_deg;
  ground.camera_roll_deg = camera_roll_deg;
  io::check_ground(ground);
  return made;
}

Points ground_points(const PyCalibration& self) {
  Points all;
  for (const PointPair& p : self.calibration.ground.points)
    all.emplace_back(p.x_left, p.y_left, p.x_right, p.y_right);
  return all;
}

/// An attribute of the calibration, or of its ground.
template <auto member>
auto of_calibration(const PyCalibration& self) {
  if constexpr (std::is_invocable_v<decltype(member), const io::Calibration&>) {
    return self.calibration.*member;
  } else {
    return self.calibration.ground.*member;
  }
}

}  // namespace

KnownRig::KnownRig(const py::object& value, const char* name) {
  if (py::isinstance<PyCalibration>(value)) {
    static_cast<PyCalibration&>(*this) = value.cast<PyCalibration>();
  } else if (py::isinstance<StereoRig>(value)) {
    calibration.rig = value.cast<StereoRig>();
  } else if (!value.is_none()) {
    throw ArgumentError(std::string(name) + ": found " + shown(value) +
                        ", expected a cairn.Rig, a cairn.Calibration or None");
  }
}

void bind_rig(py::module_& m) {
  using py::literals::operator""_a;
  Class<StereoRig>(
      m, "Rig",
      "The calibration of a rectified pair (C++: StereoRig). Depth in metres: Z = focal_px * baseline_m / "
      "(d + doffs_px), d in px.")
      .made_by(
          {}, "Raises cairn.Error unless every number is finite and focal length and baseline are positive.",
          &make_rig, "focal_px"_a, "baseline_m"_a, "cx_px"_a = 0.0F, "cy_px"_a = 0.0F, "doffs_px"_a = 0.0F)
      .static_method(
          "from_file",
          "The rig of a calibration file, see load_calibration(). Raises cairn.Error where it has none.",
          &rig_from_file, "path"_a)
      .shows("focal_px", &StereoRig::focal_px, "focal length, px")
      .shows("baseline_m", &StereoRig::baseline_m, "distance of the cameras, m")
      .shows("cx_px", &StereoRig::cx_px, "principal point of the left camera, px")
      .shows("cy_px", &StereoRig::cy_px, "principal point of the left camera, px")
      .shows("doffs_px", &StereoRig::doffs_px, "cx of the right camera less cx of the left one, px")
      .method(
          "point_in_camera_m",
          "The point (x right, y down, z forward; m) that pixel (x, y) with this disparity shows in the left "
          "camera's "
          "frame; None at or beyond infinity.",
          [](const StereoRig& self, float x, float y, float d) { return self.point_in_camera_m(x, y, d); },
          "x"_a, "y"_a, "disparity_px"_a)
      .def("__eq__", &equal, py::is_operator());

  Class<PyCalibration>(
      m, "Calibration",
      "What a calibration file says of a rectified pair. Takes the place of a Rig everywhere; "
      "segment() then also checks the images' size and takes the file's number of disparities as "
      "default.")
      .made_by({},
               "What a file would say, see load_calibration(). ground_points: (x_left, y_left, x_right, "
               "y_right) in px "
               "of four and more points of the floor, for ground={'source': 'points'}. camera_height_m: of "
               "the left "
               "camera above the floor, for 'pose'. Raises cairn.Error.",
               &make_calibration, "rig"_a = py::none(), "image_size"_a = py::none(),
               "num_disparities"_a = py::none(), "ground_points"_a = Points{},
               "camera_height_m"_a = py::none(), "camera_pitch_deg"_a = 0.0F, "camera_roll_deg"_a = 0.0F)
      .shows("rig", &of_calibration<&io::Calibration::rig>,
             "None where the file has no focal length or no baseline")
      .shows("image_size", &of_calibration<&io::Calibration::image_size>,
             "(width, height) of the images that it was made for, or None")
      .shows("num_disparities", &of_calibration<&io::Calibration::num_disparities>,
             "the default of match.num_disparities, or None")
      .shows("ground_points", &ground_points, "points of the floor: (x_left, y_left, x_right, y_right) in px")
      .shows("camera_height_m", &of_calibration<&KnownGround::camera_height_m>,
             "of the left camera above the floor, m, or None")
      .shows("camera_pitch_deg", &of_calibration<&KnownGround::camera_pitch_deg>,
             "degrees; positive looks down")
      .shows("camera_roll_deg", &of_calibration<&KnownGround::camera_roll_deg>,
             "degrees; positive lowers the camera's right side")
      .shows(
          "of_raw_cameras", &of_calibration<&io::Calibration::of_raw_cameras>,
          "whether the file describes the lenses of the raw cameras as well: the rig fits images that were "
          "rectified with it");
  define(
      m, "load_calibration",
      "Reads a calibration, its form recognised by content: our own YAML, Middlebury, KITTI, OpenCV "
      "FileStorage, ROS "
      "camera_info (or the folder of a pair of them), key=value lines. Raises cairn.Error.",
      [](const std::filesystem::path& path) {
        return PyCalibration{io::load_calibration(path), path};
      },
      "path"_a);
}

}  // namespace cairn::python
