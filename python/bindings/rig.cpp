// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "rig.hpp"

#include <pybind11/stl/filesystem.h>

#include <cairn/core/error.hpp>
#include <string>

#include "bindings.hpp"
#include "pickling.hpp"
#include "refusals.hpp"
#include "whole.hpp"

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

std::string number(float value) {
  return py::repr(py::float_(py::str(py::str("{:.7g}").format(double(value))))).cast<std::string>();
}

std::string rig_repr(const StereoRig& rig) {
  return "Rig(focal_px=" + number(rig.focal_px) + ", baseline_m=" + number(rig.baseline_m) +
         ", cx_px=" + number(rig.cx_px) + ", cy_px=" + number(rig.cy_px) +
         ", doffs_px=" + number(rig.doffs_px) + ")";
}

bool equal(const StereoRig& a, const StereoRig& b) {
  return a.focal_px == b.focal_px && a.cx_px == b.cx_px && a.cy_px == b.cy_px &&
         a.baseline_m == b.baseline_m && a.doffs_px == b.doffs_px;
}

using Points = std::vector<std::tuple<float, float, float, float>>;

PyCalibration make_calibration(const std::optional<StereoRig>& rig,
                               const std::optional<std::pair<int, int>>& image_size,
                               std::optional<Whole> num_disparities, const Points& ground_points,
                               std::optional<float> camera_height_m, float camera_pitch_deg,
                               float camera_roll_deg) {
  PyCalibration made;
  made.path = "Calibration()";
  io::Calibration& c = made.calibration;
  c.rig = rig;
  if (image_size) c.image_size = Size{image_size->first, image_size->second};
  if (num_disparities) c.num_disparities = num_disparities->value;
  for (const auto& [x_left, y_left, x_right, y_right] : ground_points)
    c.ground.points.push_back({x_left, y_left, x_right, y_right});
  c.ground.camera_height_m = camera_height_m;
  c.ground.camera_pitch_deg = camera_pitch_deg;
  c.ground.camera_roll_deg = camera_roll_deg;
  io::check_ground(c.ground);
  return made;
}

Points ground_points(const PyCalibration& self) {
  Points all;
  for (const PointPair& p : self.calibration.ground.points)
    all.emplace_back(p.x_left, p.y_left, p.x_right, p.y_right);
  return all;
}

std::optional<std::pair<int, int>> image_size(const PyCalibration& self) {
  if (!self.calibration.image_size) return std::nullopt;
  return std::pair{self.calibration.image_size->width, self.calibration.image_size->height};
}

std::string calibration_repr(const PyCalibration& self) {
  const io::Calibration& c = self.calibration;
  return "<cairn.Calibration " + self.path.string() + ": " + (c.rig ? rig_repr(*c.rig) : "no rig") +
         (c.image_size ? ", for " + text(*c.image_size) : "") +
         (c.num_disparities ? ", " + std::to_string(*c.num_disparities) + " disparities" : "") + ">";
}

}  // namespace

PyCalibration calibration_of(const RigArgument& rig) {
  if (rig.is_none()) return {};
  if (py::isinstance<PyCalibration>(rig)) return rig.cast<PyCalibration>();
  if (py::isinstance<StereoRig>(rig)) return {{rig.cast<StereoRig>(), {}, {}, {}}, {}};
  throw ArgumentError("rig: found " + shown(rig) + ", expected a cairn.Rig, a cairn.Calibration or None");
}

std::optional<StereoRig> rig_of(const RigArgument& rig) {
  return calibration_of(rig).calibration.rig;
}

void bind_rig(py::module_& m) {
  py::class_<StereoRig>(m, "Rig",
                        "The calibration of a rectified pair (C++: StereoRig). Depth in metres: "
                        "Z = focal_px * baseline_m / (d + doffs_px), d in px.")
      .def(py::init(&make_rig), py::arg("focal_px"), py::arg("baseline_m"), py::arg("cx_px") = 0.0F,
           py::arg("cy_px") = 0.0F, py::arg("doffs_px") = 0.0F,
           "Raises cairn.Error unless every number is finite and focal length and baseline are positive.")
      .def_static(
          "from_file", &rig_from_file, py::arg("path"),
          "The rig of a calibration file, see load_calibration(). Raises cairn.Error where it has none.")
      .def_readonly("focal_px", &StereoRig::focal_px, "focal length, px")
      .def_readonly("baseline_m", &StereoRig::baseline_m, "distance of the cameras, m")
      .def_readonly("cx_px", &StereoRig::cx_px, "principal point of the left camera, px")
      .def_readonly("cy_px", &StereoRig::cy_px, "principal point of the left camera, px")
      .def_readonly("doffs_px", &StereoRig::doffs_px, "cx of the right camera less cx of the left one, px")
      .def(
          "point_in_camera_m",
          [](const StereoRig& self, float x, float y, float d) {
            return triple(self.point_in_camera_m(x, y, d));
          },
          py::arg("x"), py::arg("y"), py::arg("disparity_px"),
          "The point (x right, y down, z forward; m) that pixel (x, y) with this disparity shows in the left "
          "camera's "
          "frame; None at or beyond infinity.")
      .def("__eq__", &equal, py::is_operator())
      .def("__repr__", &rig_repr)
      .def(pickled<StereoRig>());

  py::class_<PyCalibration>(
      m, "Calibration",
      "What a calibration file says of a rectified pair. Stands wherever a Rig does; segment() "
      "then also checks the pictures' size and takes the file's number of disparities as default.")
      .def(py::init(&make_calibration), py::arg("rig") = py::none(), py::arg("image_size") = py::none(),
           py::arg("num_disparities") = py::none(), py::arg("ground_points") = Points{},
           py::arg("camera_height_m") = py::none(), py::arg("camera_pitch_deg") = 0.0F,
           py::arg("camera_roll_deg") = 0.0F,
           "What a file would say, see load_calibration(). ground_points: (x_left, y_left, x_right, y_right) "
           "in px of four and more points of the floor, for ground={'source': 'points'}. camera_height_m: of "
           "the left camera above the floor, for 'pose'. Raises cairn.Error.")
      .def_property_readonly(
          "rig", [](const PyCalibration& self) { return self.calibration.rig; },
          "None where the file has no focal length or no baseline")
      .def_property_readonly("image_size", &image_size,
                             "(width, height) of the pictures that it was made for, or None")
      .def_property_readonly(
          "num_disparities", [](const PyCalibration& self) { return self.calibration.num_disparities; },
          "the default of match.num_disparities, or None")
      .def_property_readonly("ground_points", &ground_points,
                             "points of the floor: (x_left, y_left, x_right, y_right) in px")
      .def_property_readonly(
          "camera_height_m",
          [](const PyCalibration& self) { return self.calibration.ground.camera_height_m; },
          "of the left camera above the floor, m, or None")
      .def_property_readonly(
          "camera_pitch_deg",
          [](const PyCalibration& self) { return self.calibration.ground.camera_pitch_deg; },
          "degrees; positive looks down")
      .def_property_readonly(
          "camera_roll_deg",
          [](const PyCalibration& self) { return self.calibration.ground.camera_roll_deg; },
          "degrees; positive lowers the camera's right side")
      .def_property_readonly(
          "of_raw_cameras", [](const PyCalibration& self) { return self.calibration.of_raw_cameras; },
          "whether the file describes the lenses of the raw cameras as well: the rig fits pictures that were "
          "rectified with it")
      .def("__repr__", &calibration_repr)
      .def(pickled<PyCalibration>());
  m.def(
      "load_calibration",
      [](const std::filesystem::path& path) {
        return PyCalibration{io::load_calibration(path), path};
      },
      py::arg("path"),
      "Reads a calibration, its form recognised by content: our own YAML, Middlebury, KITTI, OpenCV "
      "FileStorage, ROS "
      "camera_info (or the folder of a pair of them), key=value lines. Raises cairn.Error.");
}

}  // namespace cairn::python
