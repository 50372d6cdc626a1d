// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/disparity/gradient.hpp>
#include <cairn/image/gradient.hpp>
#include <cairn/regions/grow_near_to_far.hpp>
#include <cairn/regions/grow_statistical.hpp>
#include <cairn/regions/segment_disparity.hpp>
#include <cairn/regions/segment_intensity.hpp>
#include <cairn/regions/watershed.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "disparity.hpp"
#include "options.hpp"
#include "pickling.hpp"
#include "rig.hpp"
#include "whole.hpp"

namespace cairn::python {
namespace {

// ---- arrays from outside that index others ----

/// How many regions the labels tell apart. Throws Error unless each of 0 … count − 1 has a pixel.
int count_of(View<const std::int32_t> labels) {
  const auto area = static_cast<std::size_t>(labels.size().area());
  std::vector<bool> seen;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const std::int32_t label = labels(x, y);
      if (label < 0 || static_cast<std::size_t>(label) >= area) {
        throw Error("labels: found " + std::to_string(label) + " at x " + std::to_string(x) + ", y " +
                    std::to_string(y) + ", expected regions numbered from 0 on");
      }
      if (static_cast<std::size_t>(label) >= seen.size()) seen.resize(static_cast<std::size_t>(label) + 1);
      seen[static_cast<std::size_t>(label)] = true;
    }
  }
  const auto gap = std::find(seen.begin(), seen.end(), false);
  if (gap != seen.end()) {
    throw Error("labels: found no pixel of region " + std::to_string(gap - seen.begin()) +
                ", expected every one of 0 … " + std::to_string(seen.size() - 1));
  }
  return static_cast<int>(seen.size());
}

/// Throws Error unless every entry names a survivor: a region that ended in itself.
void check_merges(const Merges& merged_into, std::size_t count) {
  if (merged_into.size() != count) {
    throw Error("merged_into: found " + std::to_string(merged_into.size()) + " entries, expected " +
                std::to_string(count) + ", one for each region of the graph");
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t into = merged_into[i];
    if (into >= 0 && static_cast<std::size_t>(into) < count &&
        merged_into[static_cast<std::size_t>(into)] == into)
      continue;
    throw Error("merged_into: found " + std::to_string(into) + " for region " + std::to_string(i) +
                ", expected a region that ended in itself");
  }
}

float smoothing(float sigma) {
  if (sigma >= 0 && sigma <= 5) return sigma;
  throw Error("smoothing_sigma: found " + std::to_string(sigma) + ", expected 0 … 5 px");
}

// ---- stages ----

ArrayOf<std::uint16_t> gradient_of(const Config&, const Exec& exec, const NumbersArgument& image,
                                   float sigma) {
  smoothing(sigma);
  if (py::isinstance<py::array_t<std::int16_t>>(image)) {
    const Borrowed<std::int16_t> in(image, "image");
    return array_from(released([&] { return gradient(in.view(), sigma, exec); }));
  }
  const Picture in(image, "image", false, exec.pool);
  return array_from(released([&] { return gradient(in.gray(), sigma, exec); }));
}

ArrayOf<std::uint16_t> edges(const Config&, const Exec& exec, const ImageArgument& left, float sigma,
                             bool bgr) {
  smoothing(sigma);
  const Picture in(left, "left", bgr, exec.pool);
  return array_from(released([&] { return edge_strength(in.gray(), in.rgb(), sigma, exec); }));
}

ArrayOf<std::int16_t> sixteenths(const Config&, const Exec& exec, const DisparityArgument& disparity) {
  const DisparityInput map(disparity, "disparity", exec);
  return array_from(released([&] { return quantised(map.map(), exec); }));
}

Basins basins(const Config&, const Exec& exec, const NumbersArgument& gradient) {
  const Borrowed<std::uint16_t> in(gradient, "gradient");
  return released([&] { return watershed(in.view(), exec); });
}

RegionGraph graph_of(const Config&, const Exec& exec, const LabelsArgument& labels,
                     const NumbersArgument& values, const MaskArgument& floor) {
  const Borrowed<std::int32_t> regions(labels, "labels");
  const int count = count_of(regions.view());
  if (py::isinstance<py::array_t<std::int16_t>>(values)) {
    const Borrowed<std::int16_t> in(values, "values");
    expect_size(in.size(), "values", regions.size(), "labels");
    const BorrowedMask mask(floor, "floor");
    if (!mask.view().empty()) expect_size(mask.view().size(), "floor", regions.size(), "labels");
    return released(
        [&] { return build_graph(as_regions(regions.view()), count, in.view(), mask.view(), exec); });
  }
  const Borrowed<std::uint8_t> in(values, "values");
  expect_size(in.size(), "values", regions.size(), "labels");
  if (!floor.is_none())
    throw Error("floor: found a mask beside grey levels, expected None: grey levels have no floor");
  return released([&] { return build_graph(as_regions(regions.view()), count, in.view(), exec); });
}

Segmentation merged(const Config&, const Exec& exec, const LabelsArgument& labels, const RegionGraph& graph,
                    const Merges& merged_into, double value_scale) {
  const Borrowed<std::int32_t> regions(labels, "labels");
  const int count = count_of(regions.view());
  if (static_cast<std::size_t>(count) != graph.nodes.size()) {
    throw Error("labels: found " + std::to_string(count) + " regions, expected the " +
                std::to_string(graph.nodes.size()) + " of the graph");
  }
  check_merges(merged_into, graph.nodes.size());
  return released(
      [&] { return apply_merges(as_regions(regions.view()), graph, merged_into, value_scale, exec); });
}

template <Merges (*grow)(const RegionGraph&, const GrowCriteria&, const Exec&)>
Array<std::int32_t> grown(const Config&, const Exec& exec, const RegionGraph& graph,
                          double mean_difference_max, double deviation_max, double sigma_min,
                          Whole least_area) {
  const std::int64_t min_region_area = least_area.value;
  if (!(mean_difference_max >= 0 && deviation_max >= 0 && sigma_min > 0 && std::isfinite(sigma_min)) ||
      min_region_area < 0) {
    throw Error("growing: found mean_difference_max " + std::to_string(mean_difference_max) +
                ", deviation_max " + std::to_string(deviation_max) + ", sigma_min " +
                std::to_string(sigma_min) + ", min_region_area " + std::to_string(min_region_area) +
                ", expected none below 0 and a sigma_min above");
  }
  const GrowCriteria criteria{mean_difference_max, deviation_max, sigma_min, min_region_area};
  return array_from(released([&] { return grow(graph, criteria, exec); }));
}

Segmentation by_intensity(const Config& config, const Exec& exec, const ImageArgument& left, bool bgr) {
  const Picture in(left, "left", bgr, exec.pool);
  return released([&] { return segment_intensity(in.gray(), config.intensity, exec); });
}

Segmentation by_disparity(const Config& config, const Exec& exec, const DisparityArgument& disparity,
                          const MaskArgument& floor) {
  const DisparityInput map(disparity, "disparity", exec);
  const BorrowedMask mask(floor, "floor");
  if (!mask.view().empty()) expect_size(mask.view().size(), "floor", map.size(), "disparity");
  return released([&] { return segment_disparity(map.map(), mask.view(), config.disparity, exec); });
}

// ---- what the classes show ----

std::vector<std::int32_t> neighbours(const RegionGraph& self, Whole region) {
  const int node = region.value;
  if (node < 0 || static_cast<std::size_t>(node) >= self.nodes.size())
    throw py::index_error("no such region");
  const auto at = static_cast<std::size_t>(node);
  return {self.arcs.begin() + self.first_arc[at], self.arcs.begin() + self.first_arc[at + 1]};
}

std::string region_repr(const Region& r) {
  return "<cairn.Region " + std::to_string(r.pixel_count) + " px at (" + std::to_string(r.box.x) + ", " +
         std::to_string(r.box.y) + ", " + std::to_string(r.box.width) + ", " + std::to_string(r.box.height) +
         "), mean " + std::to_string(r.mean) + (r.is_floor ? ", floor" : "") +
         (r.is_background ? ", background>" : ">");
}

void bind_classes(py::module_& m) {
  py::class_<Region>(m, "Region",
                     "A set of connected pixels. Mean and variance are over its valid pixels: of grey "
                     "levels, or of disparities in px.")
      .def_readonly("pixel_count", &Region::pixel_count, "its area, px")
      .def_readonly("valid_count", &Region::valid_count, "pixels that carry a value")
      .def_property_readonly(
          "box", [](const Region& self) { return box(self.box); }, "(x, y, width, height), px")
      .def_readonly("mean", &Region::mean,
                    "of its valid pixels: grey levels, 0 to 255, or px of disparity; 0 without any")
      .def_readonly("variance", &Region::variance,
                    "of its valid pixels (population), at least 0: grey levels squared, or px squared")
      .def_readonly("is_floor", &Region::is_floor, "the one floor region of a disparity segmentation")
      .def_readonly("is_background", &Region::is_background,
                    "the region that holds all that is no object, in the groups of a frame")
      .def("__repr__", &region_repr)
      .def(pickled<Region>());
  py::class_<Segmentation>(m, "Segmentation", "Regions: every pixel belongs to one.")
      .def_property_readonly("labels", always_shown(&Segmentation::labels),
                             "(H, W) int32, read-only: indexes `regions`")
      .def_readonly("regions", &Segmentation::regions,
                    "a list of Region, in raster order of their first pixel")
      .def("__len__", [](const Segmentation& self) { return self.regions.size(); })
      .def("__repr__",
           [](const Segmentation& self) {
             return "<cairn.Segmentation " + text(self.labels.size()) + ", " +
                    std::to_string(self.regions.size()) + " regions>";
           })
      .def(pickled<Segmentation>());
  py::class_<Basins>(m, "Basins", "What watershed() makes.")
      .def_property_readonly("labels", always_shown(&Basins::labels),
                             "(H, W) int32, read-only: 0 to count - 1")
      .def_readonly("count", &Basins::count, "how many basins there are, 1 or more")
      .def("__repr__",
           [](const Basins& self) {
             return "<cairn.Basins " + text(self.labels.size()) + ", " + std::to_string(self.count) +
                    " basins>";
           })
      .def(pickled<Basins>());
  py::class_<RegionGraph>(m, "RegionGraph", "Regions and which of them touch (4-neighbourhood).")
      .def("__len__", [](const RegionGraph& self) { return self.nodes.size(); })
      .def("neighbours", &neighbours, py::arg("region"), "The regions that touch this one, ascending.")
      .def("__repr__",
           [](const RegionGraph& self) {
             return "<cairn.RegionGraph " + std::to_string(self.nodes.size()) + " regions, " +
                    std::to_string(self.arcs.size() / 2) + " borders>";
           })
      .def(pickled<RegionGraph>());
}

}  // namespace

void bind_regions(py::module_& m) {
  using py::literals::operator""_a;
  bind_classes(m);

  def_stage(m, "gradient", {},
            "Gradient magnitude: of a picture, (H, W) uint8, in grey levels, capped at 255; or of "
            "quantised() disparities, "
            "int16, in 1/16 px, 65535 in holes. (H, W) uint16, from one side of a pixel to the other.",
            &gradient_of, "image"_a, "smoothing_sigma"_a = 0.0F, py::kw_only());
  def_stage(m, "edge_strength", {},
            "Edges that superpixels follow: central differences in 1/4 grey level, of colour the strongest "
            "channel's. "
            "(H, W) uint16.",
            &edges, "left"_a, "smoothing_sigma"_a = 0.7F, py::kw_only(), "bgr"_a = false);
  def_stage(m, "quantised", {}, "Disparities in 1/16 px: (H, W) int16, HOLE_16 in holes.", &sixteenths,
            "disparity"_a, py::kw_only());
  m.attr("HOLE_16") = int{kHole16};
  def_stage(m, "watershed", {},
            "Watershed by steepest descent, 4-connected, no ridge lines. gradient: (H, W) uint16.", &basins,
            "gradient"_a, py::kw_only());
  def_stage(m, "build_graph", {},
            "Counts and links regions. labels: (H, W) integers from 0 on; values: what the statistics are "
            "of, (H, W) uint8 "
            "grey levels, or int16 as quantised() gives them, then with floor: (H, W) uint8, not 0 = floor, "
            "or None.",
            &graph_of, "labels"_a, "values"_a, "floor"_a = py::none(), py::kw_only());
  def_stage(m, "grow_statistical", {},
            "Statistical region growing (paper, Eq. 1 to 3): for each region that in which it ended, int32. "
            "The criteria "
            "are in units of the graph's values; min_region_area in px.",
            &grown<&grow_statistical>, "graph"_a, py::kw_only(), "mean_difference_max"_a, "deviation_max"_a,
            "sigma_min"_a, "min_region_area"_a = 0);
  def_stage(m, "grow_near_to_far", {},
            "The paper's region growing for disparity, from the nearest region to the farthest; else as "
            "grow_statistical().",
            &grown<&grow_near_to_far>, "graph"_a, py::kw_only(), "mean_difference_max"_a, "deviation_max"_a,
            "sigma_min"_a, "min_region_area"_a = 0);
  def_stage(m, "apply_merges", {},
            "Writes what growing made. value_scale: what one unit of the graph's values is (1/16 px for "
            "disparities).",
            &merged, "labels"_a, "graph"_a, "merged_into"_a, "value_scale"_a = 1.0, py::kw_only());
  def_stage(m, "segment_intensity", {"intensity"},
            "Regions of like intensity: gradient, watershed, build_graph, grow_statistical. left: (H, W) or "
            "(H, W, 3) uint8.",
            &by_intensity, "left"_a, py::kw_only(), "bgr"_a = false);
  def_stage(m, "segment_disparity", {"disparity"},
            "Regions of like disparity, nearest first: gradient, watershed, build_graph, grow_near_to_far. "
            "floor: (H, W) "
            "uint8 as label_floor() gives it, one region of its own; or None.",
            &by_disparity, "disparity"_a, "floor"_a = py::none(), py::kw_only());
}

}  // namespace cairn::python
