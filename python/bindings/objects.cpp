// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "objects.hpp"

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/objects/fuse.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/objects/measure.hpp>
#include <cairn/objects/space.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "disparity.hpp"
#include "options.hpp"
#include "pickling.hpp"
#include "rig.hpp"

namespace cairn::python {
namespace {

// ---- stages ----

Fusion fused(const Config&, const Exec& exec, const Segmentation& by_intensity,
             const Segmentation& by_disparity) {
  expect_size(by_disparity.labels.size(), "by_disparity", by_intensity.labels.size(), "by_intensity");
  return released([&] { return fuse(by_intensity, by_disparity, exec); });
}

/// Throws Error unless every label is below `count`.
void expect_labels(const Borrowed<std::int32_t>& labels, std::size_t count, const std::string& name,
                   const std::string& counted) {
  for (int y = 0; y < labels.size().height; ++y) {
    const std::int32_t* const row = labels.view().row(y);
    const bool fits = std::all_of(row, row + labels.size().width, [&](std::int32_t region) {
      return region >= 0 && static_cast<std::size_t>(region) < count;
    });
    if (fits) continue;
    throw Error(name + ": found a region without an entry in " + counted + ", expected 0 … " +
                std::to_string(count) + " - 1");
  }
}

Objects measured(const Config& config, const Exec& exec, const LabelsArgument& candidates,
                 const std::vector<bool>& is_background, const DisparityArgument& disparity,
                 const ImageArgument& left, float noise_sigma, bool bgr) {
  const Borrowed<std::int32_t> labels(candidates, "candidates");
  const DisparityInput map(disparity, "disparity", exec);
  const Picture in(left, "left", bgr, exec.pool);
  expect_size(map.size(), "disparity", labels.size(), "candidates");
  expect_size(in.size(), "left", labels.size(), "candidates");
  expect_noise(noise_sigma);
  expect_labels(labels, is_background.size(), "candidates", "is_background");
  return released([&] {
    return measure(as_regions(labels.view()), is_background, map.map(), in.gray(), in.rgb(), noise_sigma,
                   config.objects, exec);
  });
}

Objects measured_chosen(const Config&, const Exec& exec, const LabelsArgument& chosen,
                        const std::vector<float>& scores, const DisparityArgument& disparity,
                        const ImageArgument& left, float noise_sigma, bool bgr) {
  const Borrowed<std::int32_t> labels(chosen, "chosen");
  const DisparityInput map(disparity, "disparity", exec);
  const Picture in(left, "left", bgr, exec.pool);
  expect_size(map.size(), "disparity", labels.size(), "chosen");
  expect_size(in.size(), "left", labels.size(), "chosen");
  expect_noise(noise_sigma);
  expect_labels(labels, scores.size(), "chosen", "scores");
  if (!std::all_of(scores.begin(), scores.end(), [](float score) { return score >= 0 && score <= 1; }))
    throw Error("scores: found one outside 0 … 1, expected a confidence for each region");
  return released([&] {
    return measure(as_regions(labels.view()), scores, map.map(), in.gray(), in.rgb(), noise_sigma, exec);
  });
}

Objects located(const Config&, const Exec& exec, const Objects& objects, const DisparityArgument& disparity,
                const Ground& ground, const RigArgument& rig) {
  const auto known = rig_of(rig);
  const DisparityInput map(disparity, "disparity", exec);
  expect_size(map.size(), "disparity", objects.labels.size(), "objects");
  return released([&] {
    return locate({objects.labels.clone({}), objects.list}, map.map(), ground, known, exec);
  });
}

ArrayOf<Space> space_of(const Config& config, const Exec& exec, const Objects& objects,
                        const DisparityArgument& disparity, const FloatsArgument& confidence,
                        const Ground& ground, const Background& background, const Superpixels& superpixels,
                        const FloatsArgument& seen_px, const RigArgument& rig) {
  const auto known = rig_of(rig);
  const DisparityInput map(disparity, "disparity", exec);
  const BorrowedDisparities sure(confidence, "confidence");
  const BorrowedDisparities seen(seen_px, "seen_px");
  const Size size = objects.labels.size();
  expect_size(map.size(), "disparity", size, "objects");
  expect_size(sure.size(), "confidence", size, "objects");
  expect_size(superpixels.labels.size(), "superpixels", size, "objects");
  expect_size(seen.size(), "seen_px", size, "objects");
  return array_from(released([&] {
    const SpaceCues cues{map.map(),  seen.view(),        sure.view(),   ground,
                         background, superpixels.labels, objects.labels};
    return label_space(cues, known, config.ground, exec);
  }));
}

// ---- what the classes show ----

std::string decimal(const char* format, double value) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

std::string objects_repr(const Objects& self) {
  std::string text = "<cairn.Objects " + std::to_string(self.list.size());
  for (const Object& object : self.list) text += "\n  " + object_repr(object);
  return text + ">";
}

const Object& object_at(const Objects& self, py::ssize_t i) {
  const auto count = static_cast<py::ssize_t>(self.list.size());
  if (i < 0) i += count;
  if (i < 0 || i >= count)
    throw py::index_error("object " + std::to_string(i) + " of " + std::to_string(count));
  return self.list[static_cast<std::size_t>(i)];
}

std::vector<std::vector<std::int32_t>> parts(const Fusion& self) {
  std::vector<std::vector<std::int32_t>> all;
  for (const auto& regions : self.parts) {
    auto& part = all.emplace_back();
    std::transform(regions.begin(), regions.end(), std::back_inserter(part),
                   [](RegionId id) { return number(id); });
  }
  return all;
}

std::vector<std::int32_t> disparity_region(const Fusion& self) {
  std::vector<std::int32_t> all;
  for (const RegionId id : self.disparity_region) all.push_back(number(id));
  return all;
}

void bind_classes(py::module_& m) {
  py::class_<Fusion>(m, "Fusion",
                     "Which intensity regions make up each fused region: the candidates for objects.")
      .def_property_readonly("labels", always_shown(&Fusion::labels),
                             "(H, W) int32, read-only: indexes `parts`")
      .def_property_readonly("parts", &parts, "for each fused region its intensity regions, ascending")
      .def_property_readonly("disparity_region", &disparity_region,
                             "for each fused region the disparity region that it follows")
      .def_readonly("is_floor", &Fusion::is_floor, "for each fused region: does it follow the floor?")
      .def("__len__", [](const Fusion& self) { return self.parts.size(); })
      .def("__repr__",
           [](const Fusion& self) {
             return "<cairn.Fusion " + text(self.labels.size()) + ", " + std::to_string(self.parts.size()) +
                    " regions>";
           })
      .def(pickled<Fusion>());

  py::class_<FloorBox>(
      m, "FloorBox",
      "A box about what is seen of an object, upright on the floor and turned as it is. In the "
      "floor's frame: x forward, y left, z up, from the floor below the left camera.")
      .def_property_readonly(
          "centre_in_floor_m", [](const FloorBox& self) { return triple(self.centre_in_floor_m); },
          "(x, y, z), m")
      .def_property_readonly(
          "size_m", [](const FloorBox& self) { return triple(self.size_m); },
          "(along its longer side, along its shorter one, up), m")
      .def_readonly("yaw_rad", &FloorBox::yaw_rad,
                    "-pi/2 to pi/2: of the longer side, counter-clockwise from x as seen from above")
      .def_property_readonly(
          "centre_covariance_m2",
          [](const FloorBox& self) {
            const auto& [xx, xy, xz, yy, yz, zz] = self.centre_covariance_m2;
            return std::array{std::array{xx, xy, xz}, std::array{xy, yy, yz}, std::array{xz, yz, zz}};
          },
          "3 rows of 3, m^2: how well the centre is known")
      .def("__repr__",
           [](const FloorBox& self) {
             const Vec3 at = self.centre_in_floor_m;
             const Vec3 size = self.size_m;
             return "<cairn.FloorBox " + decimal("%.2f x ", double(size.x)) +
                    decimal("%.2f x ", double(size.y)) + decimal("%.2f m at (", double(size.z)) +
                    decimal("%.2f, ", double(at.x)) + decimal("%.2f, ", double(at.y)) +
                    decimal("%.2f) m, ", double(at.z)) + decimal("yaw %.2f rad>", double(self.yaw_rad));
           })
      .def(pickled<FloorBox>());

  py::class_<Object>(m, "Object", "Something that stands or hangs in front of the background.")
      .def_property_readonly(
          "id", [](const Object& self) { return number(self.id); },
          "from 1, the nearest, on; its pixels in the map of objects")
      .def_property_readonly(
          "box_px", [](const Object& self) { return box(self.box_px); }, "(x, y, width, height), px")
      .def_readonly("pixel_count", &Object::pixel_count, "area of its mask, px")
      .def_readonly("disparity_px", &Object::disparity_px, "median of its valid pixels, px")
      .def_readonly("valid_share", &Object::valid_share, "0 to 1: pixels of the mask that have a disparity")
      .def_property_readonly(
          "mean_colour",
          [](const Object& self) {
            return std::tuple<int, int, int>{self.mean_colour.r, self.mean_colour.g, self.mean_colour.b};
          },
          "(red, green, blue), 0 to 255; grey where the input had no colour")
      .def_property_readonly(
          "position_in_camera_m", [](const Object& self) { return triple(self.position_in_camera_m); },
          "(x right, y down, z forward), m: in the middle of its main part, at the depth of disparity_px; "
          "None "
          "without a rig")
      .def_readonly("disparity_sigma_px", &Object::disparity_sigma_px,
                    "standard deviation of disparity_px, px")
      .def_property_readonly(
          "depth_interval_m",
          [](const Object& self) -> std::optional<std::pair<float, float>> {
            if (!self.depth_interval_m) return std::nullopt;
            return std::pair{self.depth_interval_m->low, self.depth_interval_m->high};
          },
          "(nearest, farthest), m: where its depth lies with 95 %; None without a rig")
      .def_property_readonly(
          "extent_in_camera_m", [](const Object& self) { return triple(self.extent_in_camera_m); },
          "(x, y, z), m: the box around the points of its main part, without wild ones; None without a "
          "rig")
      .def_readonly("box_on_floor", &Object::box_on_floor,
                    "its box, upright on the floor: a FloorBox; None without a rig or a ground")
      .def_property_readonly(
          "distance_m",
          [](const Object& self) -> std::optional<float> {
            if (!self.position_in_camera_m) return std::nullopt;
            return self.position_in_camera_m->z;
          },
          "z of its position, m; None without a rig")
      .def_readonly("edge_share", &Object::edge_share,
                    "0 to 1: of its outline, where the picture shows an edge")
      .def_readonly("cut_share", &Object::cut_share,
                    "0 to 1: of its outline, what lies at the picture's border")
      .def_readonly("confidence", &Object::confidence,
                    "0 to 1: how likely it covers a true object by more than half")
      .def("__repr__", &object_repr)
      .def(pickled<Object>());

  py::class_<LeftOut>(m, "LeftOut", "An obstacle that is no object, and why.")
      .def_property_readonly(
          "reason", [](const LeftOut& self) { return choice_name(self.reason, kLeftOutReasons); },
          "'background', 'too small' or 'low confidence'")
      .def_property_readonly(
          "box_px", [](const LeftOut& self) { return box(self.box_px); }, "(x, y, width, height), px")
      .def_readonly("pixel_count", &LeftOut::pixel_count, "area, px")
      .def_readonly("disparity_px", &LeftOut::disparity_px, "mean of its pixels, px")
      .def_property_readonly(
          "position_in_camera_m", [](const LeftOut& self) { return triple(self.position_in_camera_m); },
          "(x right, y down, z forward), m: of its middle; None without a rig")
      .def_readonly("confidence", &LeftOut::confidence,
                    "0 to 1: the best of a region that holds some of it; 0 where none was judged")
      .def("__repr__",
           [](const LeftOut& self) {
             return "<cairn.LeftOut " + choice_name(self.reason, kLeftOutReasons) + ": " +
                    std::to_string(self.pixel_count) + " px in box (" + std::to_string(self.box_px.x) + ", " +
                    std::to_string(self.box_px.y) + ", " + std::to_string(self.box_px.width) + ", " +
                    std::to_string(self.box_px.height) + ")>";
           })
      .def(pickled<LeftOut>());

  py::class_<ObstacleScan>(m, "ObstacleScan",
                           "The nearest obstacle in each direction, as a laser scanner has it, seen from the "
                           "floor below the left camera.")
      .def_readonly("angle_min_rad", &ObstacleScan::angle_min_rad,
                    "of the first; counter-clockwise from straight ahead")
      .def_readonly("angle_increment_rad", &ObstacleScan::angle_increment_rad, "from one to the next")
      .def_readonly("range_max_m", &ObstacleScan::range_max_m, "how far it reaches, m")
      .def_property_readonly(
          "ranges_m",
          [](const ObstacleScan& self) {
            return py::array_t<float>(static_cast<py::ssize_t>(self.ranges_m.size()), self.ranges_m.data());
          },
          "(N,) float32, m; NaN: no obstacle is seen there, which does not say that there is none")
      .def("__len__", [](const ObstacleScan& self) { return self.ranges_m.size(); })
      .def("__repr__",
           [](const ObstacleScan& self) {
             return "<cairn.ObstacleScan " + std::to_string(self.ranges_m.size()) + " directions>";
           })
      .def(pickled<ObstacleScan>());

  py::class_<ObstacleGrid>(
      m, "ObstacleGrid",
      "What stands where on the floor: rows along y, from the right to the left, of cells "
      "along x, from the camera forward.")
      .def_readonly("cell_size_m", &ObstacleGrid::cell_size_m, "side of a cell, m")
      .def_property_readonly(
          "origin_in_floor_m",
          [](const ObstacleGrid& self) {
            return std::pair{self.origin_x_m, self.origin_y_m};
          },
          "(x, y), m: corner of the first cell")
      .def_property_readonly(
          "cells",
          [](const ObstacleGrid& self) {
            return py::array_t<std::int8_t>(std::vector<py::ssize_t>{self.height, self.width},
                                            self.cells.data());
          },
          "(height, width) int8: -1 = unknown, 0 = free, 100 = occupied")
      .def("__repr__",
           [](const ObstacleGrid& self) {
             return "<cairn.ObstacleGrid " + text(Size{self.width, self.height}) + " cells of " +
                    decimal("%.3f m>", double(self.cell_size_m));
           })
      .def(pickled<ObstacleGrid>());

  py::class_<Objects>(m, "Objects",
                      "The objects of a frame, nearest first: a sequence of Object, and their map.")
      .def_property_readonly("labels", always_shown(&Objects::labels),
                             "(H, W) int32, read-only: ids, 0 = no object")
      .def("__len__", [](const Objects& self) { return self.list.size(); })
      .def("__getitem__", &object_at, py::arg("index"), py::return_value_policy::reference_internal)
      .def(
          "__getitem__",
          [](const Objects& self, const py::slice& range) {
            std::size_t start = 0, stop = 0, step = 0, length = 0;
            if (!range.compute(self.list.size(), &start, &stop, &step, &length))
              throw py::error_already_set();
            std::vector<Object> chosen;
            for (; length > 0; --length, start += step) chosen.push_back(self.list[start]);
            return chosen;
          },
          py::arg("range"))
      .def(
          "__iter__",
          [](const Objects& self) { return py::make_iterator(self.list.begin(), self.list.end()); },
          py::keep_alive<0, 1>())
      .def("__repr__", &objects_repr)
      .def(pickled<Objects>());
}

}  // namespace

std::string object_repr(const Object& o) {
  std::string text = "<cairn.Object " + std::to_string(number(o.id)) + ": ";
  if (o.position_in_camera_m) {
    const Vec3 at = *o.position_in_camera_m;
    text += decimal("%.2f m away at (", double(at.z)) + decimal("%.2f, ", double(at.x)) +
            decimal("%.2f, ", double(at.y)) + decimal("%.2f) m", double(at.z));
    if (o.extent_in_camera_m) {
      const Vec3 size = *o.extent_in_camera_m;
      text += decimal(", size (%.2f, ", double(size.x)) + decimal("%.2f, ", double(size.y)) +
              decimal("%.2f) m", double(size.z));
    }
    text += ", ";
  }
  return text + decimal("disparity %.1f px, ", double(o.disparity_px)) + std::to_string(o.pixel_count) +
         " px in box (" + std::to_string(o.box_px.x) + ", " + std::to_string(o.box_px.y) + ", " +
         std::to_string(o.box_px.width) + ", " + std::to_string(o.box_px.height) + "), " +
         decimal("confidence %.2f>", double(o.confidence));
}

void bind_objects(py::module_& m) {
  using py::literals::operator""_a;
  bind_classes(m);

  def_stage(m, "fuse", {},
            "Each intensity region goes to the disparity region with the greatest overlap (paper, Eq. 4).",
            &fused, "by_intensity"_a, "by_disparity"_a, py::kw_only());
  def_stage(
      m, "measure", {"objects"},
      "Turns candidates into objects: what is background, too large, too small, unseen or unlikely is none. "
      "candidates: (H, W) integers, the regions of a Fusion; is_background: for each of them, whether it is "
      "known to be no object; noise_sigma as noise_sigma() gives it.",
      &measured, "candidates"_a, "is_background"_a, "disparity"_a, "left"_a, "noise_sigma"_a, py::kw_only(),
      "bgr"_a = false);
  def_stage(
      m, "locate", {},
      "Where objects are: the uncertainty of their disparity and, with a rig, position, interval of depth, "
      "extent, and with a ground their box on the floor. Returns Objects.",
      &located, "objects"_a, "disparity"_a, "ground"_a, "rig"_a = py::none(), py::kw_only());
  def_stage(m, "label_space", {"ground"},
            "What each pixel shows: (H, W) uint8, 255 = obstacle, 128 = floor, 0 = unknown. seen_px as "
            "floor_under_reflections() gives it.",
            &space_of, "objects"_a, "disparity"_a, "confidence"_a, "ground"_a, "background"_a,
            "superpixels"_a, "seen_px"_a, "rig"_a = py::none(), py::kw_only());
  def_stage(m, "measure_chosen", {},
            "Measures regions that were chosen to be objects: measure() of C++ with scores. chosen: (H, W) "
            "integers, the labels of groups_of(); scores: for each region its confidence, 0 to 1, as "
            "choose_objects() gives them; 0 = no object.",
            &measured_chosen, "chosen"_a, "scores"_a, "disparity"_a, "left"_a, "noise_sigma"_a, py::kw_only(),
            "bgr"_a = false);
}

}  // namespace cairn::python
