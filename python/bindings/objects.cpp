// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/objects/fuse.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/objects/measure.hpp>
#include <cairn/objects/refine_objects.hpp>
#include <cairn/objects/space.hpp>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

/// Throws Error unless every label is below `count`.
void expect_labels(const Labels& labels, std::size_t count, const std::string& name,
                   const std::string& counted) {
  for (int y = 0; y < labels.size().height; ++y) {
    const std::int32_t* const row = labels.view().row(y);
    const auto fits = [&](std::int32_t region) { return region >= 0 && slot(region) < count; };
    if (std::all_of(row, row + labels.size().width, fits)) continue;
    throw Error(name + ": found a region without an entry in " + counted + ", expected 0 … " +
                std::to_string(count) + " - 1");
  }
}

Objects measured(const Call& call, const Labels& candidates, const std::vector<bool>& is_background,
                 const DisparityInput& disparity, const Picture& left, NoiseSigma noise) {
  expect_labels(candidates, is_background.size(), "candidates", "is_background");
  return measure(candidates.as<RegionId>(), is_background, disparity.map(), left.gray(), left.rgb(),
                 noise.value, call.config.objects, call.exec);
}

Objects measured_chosen(const Call& call, const Labels& chosen, const std::vector<float>& scores,
                        const DisparityInput& disparity, const Picture& left, NoiseSigma noise) {
  expect_labels(chosen, scores.size(), "chosen", "scores");
  if (!std::all_of(scores.begin(), scores.end(), [](float score) { return score >= 0 && score <= 1; }))
    throw Error("scores: found one outside 0 … 1, expected a confidence for each region");
  return measure(chosen.as<RegionId>(), scores, disparity.map(), left.gray(), left.rgb(), noise.value,
                 call.exec);
}

Image<Space> space_of(const Call& call, const Objects& objects, const DisparityInput& disparity,
                      const Disparities& confidence, const Ground& ground, const Background& background,
                      const Superpixels& superpixels, const Disparities& seen_px, const KnownRig& rig) {
  const SpaceCues cues{disparity.map(), seen_px.view(),     confidence.view(), ground,
                       background,      superpixels.labels, objects.labels};
  return label_space(cues, rig.rig(), call.config.ground, call.exec);
}

/// An element, or for a slice a list.
py::object chosen(const py::object& self, const py::object& index) {
  const auto& list = self.cast<const Objects&>().list;
  const auto count = static_cast<py::ssize_t>(list.size());
  const auto at = [&](py::ssize_t i) {
    return py::cast(list[static_cast<std::size_t>(i)], py::return_value_policy::reference_internal, self);
  };
  if (py::isinstance<py::slice>(index)) {
    py::ssize_t start = 0, stop = 0, step = 0, length = 0;
    if (!py::reinterpret_borrow<py::slice>(index).compute(count, &start, &stop, &step, &length))
      throw py::error_already_set();
    py::list some;
    for (; length > 0; --length, start += step) some.append(at(start));
    return some;
  }
  const auto wanted = whole(index);
  if (!wanted) refuse("index", index, "int");
  const py::ssize_t i = *wanted < 0 ? *wanted + count : *wanted;
  if (i < 0 || i >= count)
    throw py::index_error("object " + std::to_string(i) + " of " + std::to_string(count));
  return at(i);
}

void bind_classes(py::module_& m) {
  using py::literals::operator""_a;
  Class<Fusion>(m, "Fusion", "Which intensity regions make up each fused region: the candidates for objects.")
      .shows("labels", &Fusion::labels, "(H, W) int32, read-only: indexes `parts`")
      .shows("parts", &Fusion::parts, "for each fused region its intensity regions, ascending")
      .shows("disparity_region", &Fusion::disparity_region,
             "for each fused region the disparity region that it follows")
      .shows("is_floor", &Fusion::is_floor, "for each fused region: does it follow the floor?")
      .method("__len__", "Fused regions.", [](const Fusion& self) { return self.parts.size(); });

  Class<FloorBox>(
      m, "FloorBox",
      "A box about what is seen of an object, upright on the floor and turned as it is. In the floor's "
      "frame: x forward, y left, z up, from the floor below the left camera.")
      .shows("centre_in_floor_m", &FloorBox::centre_in_floor_m, "(x, y, z), m")
      .shows("size_m", &FloorBox::size_m, "(along its longer side, along its shorter one, up), m")
      .shows("yaw_rad", &FloorBox::yaw_rad,
             "-pi/2 to pi/2: of the longer side, counter-clockwise from x as seen from above")
      .shows(
          "centre_covariance_m2",
          [](const FloorBox& self) {
            const auto& [xx, xy, xz, yy, yz, zz] = self.centre_covariance_m2;
            return Numbers<float>{{xx, xy, xz, xy, yy, yz, xz, yz, zz}, {3, 3}};
          },
          "3 x 3, m^2: how well the centre is known");

  Class<Object>(m, "Object", "An object in front of the background.")
      .shows("id", &Object::id, "from 1, the nearest, on; its pixels in the map of objects")
      .shows(
          "distance_m",
          [](const Object& self) {
            return self.position_in_camera_m ? std::optional(self.position_in_camera_m->z) : std::nullopt;
          },
          "z of its position, m; None without a rig")
      .shows("position_in_camera_m", &Object::position_in_camera_m,
             "(x right, y down, z forward), m: in the middle of its main part, at the depth of disparity_px; "
             "None "
             "without a rig")
      .shows(
          "extent_in_camera_m", &Object::extent_in_camera_m,
          "(x, y, z), m: the box around the points of its main part, without wild ones; None without a rig")
      .shows("depth_interval_m", &Object::depth_interval_m,
             "(nearest, farthest), m: where its depth lies with 95 %; None without a rig")
      .shows("disparity_px", &Object::disparity_px, "median of its valid pixels, px")
      .shows("disparity_sigma_px", &Object::disparity_sigma_px, "standard deviation of disparity_px, px")
      .shows("pixel_count", &Object::pixel_count, "area of its mask, px")
      .shows("box_px", &Object::box_px, "(x, y, width, height), px")
      .shows("valid_share", &Object::valid_share, "0 to 1: pixels of the mask that have a disparity")
      .shows("mean_colour", &Object::mean_colour,
             "(red, green, blue), 0 to 255; grey where the input had no colour")
      .shows("edge_share", &Object::edge_share, "0 to 1: of its outline, where the image shows an edge")
      .shows("cut_share", &Object::cut_share, "0 to 1: of its outline, what lies at the image's border")
      .shows("confidence", &Object::confidence,
             "0 to 1: how likely it covers a true object by more than half")
      .shows("box_on_floor", &Object::box_on_floor,
             "its box, upright on the floor: a FloorBox; None without a rig or a ground");

  Class<LeftOut>(m, "LeftOut", "An obstacle that is no object, and why.")
      .shows(
          "reason", [](const LeftOut& self) { return choice_name(self.reason, kLeftOutReasons); },
          "'background', 'too small' or 'low confidence'")
      .shows("box_px", &LeftOut::box_px, "(x, y, width, height), px")
      .shows("pixel_count", &LeftOut::pixel_count, "area, px")
      .shows("disparity_px", &LeftOut::disparity_px, "mean of its pixels, px")
      .shows("position_in_camera_m", &LeftOut::position_in_camera_m,
             "(x right, y down, z forward), m: of its middle; None without a rig")
      .shows("confidence", &LeftOut::confidence,
             "0 to 1: the best of a region that holds some of it; 0 where none was judged");

  Class<ObstacleScan>(
      m, "ObstacleScan",
      "The nearest obstacle in each direction, as a laser scanner has it, seen from the floor below "
      "the left camera.")
      .shows("angle_min_rad", &ObstacleScan::angle_min_rad,
             "of the first; counter-clockwise from straight ahead")
      .shows("angle_increment_rad", &ObstacleScan::angle_increment_rad, "from one to the next")
      .shows("range_max_m", &ObstacleScan::range_max_m, "how far it reaches, m")
      .shows(
          "ranges_m", [](const ObstacleScan& self) { return Numbers<float>{self.ranges_m}; },
          "(N,) float32, m; NaN: no obstacle seen there, though there may be one")
      .method("__len__", "Directions.", [](const ObstacleScan& self) { return self.ranges_m.size(); });

  Class<ObstacleGrid>(m, "ObstacleGrid",
                      "Obstacles on the floor: rows along y, from the right to the left, of cells along x, "
                      "from the camera forward.")
      .shows("cell_size_m", &ObstacleGrid::cell_size_m, "side of a cell, m")
      .shows(
          "origin_in_floor_m",
          [](const ObstacleGrid& self) {
            return std::pair{self.origin_x_m, self.origin_y_m};
          },
          "(x, y), m: corner of the first cell")
      .shows(
          "cells",
          [](const ObstacleGrid& self) {
            return Numbers<std::int8_t>{self.cells, {self.height, self.width}};
          },
          "(height, width) int8: -1 = unknown, 0 = free, 100 = occupied");

  Class<Objects>(m, "Objects", "The objects of a frame, nearest first: a sequence of Object, and their map.")
      .shows("labels", &Objects::labels, "(H, W) int32, read-only: ids, 0 = no object")
      .method("__len__", "Objects.", [](const Objects& self) { return self.list.size(); })
      .method(
          "__getitem__", "One object, or with a slice a list of some.",
          [](const py::object& self, const py::object& index) { return chosen(self, index); }, "index"_a)
      .method("__iter__", "Nearest first.",
              [](const py::object& self) {
                const py::object all = py::slice(0, PY_SSIZE_T_MAX, 1);
                return Typed<"Iterator[Object]">(py::iter(chosen(self, all)));
              })
      .says([](const Objects& self) {
        std::string text = "Objects(" + std::to_string(self.list.size());
        for (const Object& object : self.list)
          text += "\n  " + py::repr(py::cast(object)).cast<std::string>();
        return text + ")";
      });
}

}  // namespace

void bind_objects(py::module_& m) {
  using py::literals::operator""_a;
  bind_classes(m);

  stage(
      m, "fuse", {},
      "Each intensity region goes to the disparity region with the greatest overlap (paper, Eq. 4).",
      [](const Call& call, const Segmentation& by_intensity, const Segmentation& by_disparity) {
        return fuse(by_intensity, by_disparity, call.exec);
      },
      "by_intensity"_a, "by_disparity"_a);
  stage(
      m, "measure", {"objects"},
      "Turns candidates into objects: what is background, too large, too small, unseen or unlikely is none. "
      "candidates: (H, W) integers, the regions of a Fusion; is_background: for each of them, whether it is "
      "known to "
      "be no object; noise_sigma as noise_sigma() gives it.",
      &measured, "candidates"_a, "is_background"_a, "disparity"_a, "left"_a, "noise_sigma"_a);
  stage(
      m, "refine_objects", {},
      "Refines the disparity of each object by both images, and numbers the objects anew if their order "
      "changes. Returns Objects.",
      [](const Call& call, const Objects& objects, const DisparityInput& disparity, const Picture& left,
         const Picture& right) {
        return refine_objects({objects.labels.clone({}), objects.list}, disparity.map(), left.gray(),
                              right.gray(), call.exec);
      },
      "objects"_a, "disparity"_a, "left"_a, "right"_a);
  stage(
      m, "locate", {},
      "Where objects are: the uncertainty of their disparity and, with a rig, position, interval of depth, "
      "extent, and "
      "with a ground their box on the floor. Returns Objects.",
      [](const Call& call, const Objects& objects, const DisparityInput& disparity, const Ground& ground,
         const KnownRig& rig) {
        return locate({objects.labels.clone({}), objects.list}, disparity.map(), ground, rig.rig(),
                      call.exec);
      },
      "objects"_a, "disparity"_a, "ground"_a, "rig"_a = py::none());
  stage(m, "label_space", {"ground"},
        "What each pixel shows: (H, W) uint8, 255 = obstacle, 128 = floor, 0 = unknown. seen_px as "
        "floor_under_reflections() gives it.",
        &space_of, "objects"_a, "disparity"_a, "confidence"_a, "ground"_a, "background"_a, "superpixels"_a,
        "seen_px"_a, "rig"_a = py::none());
  stage(m, "measure_chosen", {},
        "Measures regions that were chosen to be objects: measure() of C++ with scores. chosen: (H, W) "
        "integers, the "
        "labels of groups_of(); scores: for each region its confidence, 0 to 1, as choose_objects() gives "
        "them; 0 = no "
        "object.",
        &measured_chosen, "chosen"_a, "scores"_a, "disparity"_a, "left"_a, "noise_sigma"_a);
}

}  // namespace cairn::python
