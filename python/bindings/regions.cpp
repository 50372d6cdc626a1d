// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/disparity/gradient.hpp>
#include <cairn/image/gradient.hpp>
#include <cairn/regions/grow_near_to_far.hpp>
#include <cairn/regions/grow_statistical.hpp>
#include <cairn/regions/segment_disparity.hpp>
#include <cairn/regions/segment_intensity.hpp>
#include <cairn/regions/watershed.hpp>
#include <cmath>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

// ---- index arrays given by the user ----

/// The number of regions in the labels. Throws Error unless each of 0 … count − 1 has a pixel.
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

/// Throws Error unless every entry is a survivor, that is, a region merged into itself.
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

struct SmoothingSigma {
  static constexpr const char* kType = "float";
  float value = 0;
  SmoothingSigma(const py::object& given, const char* name) {
    Taken<float> number;
    number.take(given, {name, kType, {}}, {});
    value = number.get();
    if (!(value >= 0 && value <= 5))
      throw Error(std::string(name) + ": found " + std::to_string(value) + ", expected 0 … 5 px");
  }
};

/// Grey levels, or disparities in 1/16 px.
template <class GreyInput>
struct Values {
  static constexpr const char* kType = "NumbersLike";
  std::optional<GreyInput> grey;
  std::optional<Borrowed<std::int16_t>> sixteenths;

  Values(const py::object& value, const char* name, const Exec& exec) {
    if (py::isinstance<py::array_t<std::int16_t>>(value)) {
      sixteenths.emplace(value, name);
    } else if constexpr (std::is_same_v<GreyInput, Picture>) {
      grey.emplace(value, name, false, exec.pool);
    } else {
      grey.emplace(value, name);
    }
  }
  [[nodiscard]] Size size() const { return grey ? grey->size() : sixteenths->size(); }
};

RegionGraph graph_of(const Call& call, const Labels& labels, const Values<Borrowed<std::uint8_t>>& values,
                     const Mask& floor) {
  const int count = count_of(labels.view());
  if (values.sixteenths)
    return build_graph(labels.as<RegionId>(), count, values.sixteenths->view(), floor.view(), call.exec);
  if (!floor.view().empty())
    throw Error("floor: found a mask with grey levels, expected None: grey levels have no floor");
  return build_graph(labels.as<RegionId>(), count, values.grey->view(), call.exec);
}

template <Merges (*grow)(const RegionGraph&, const GrowCriteria&, const Exec&)>
Numbers<std::int32_t> grown(const Call& call, const RegionGraph& graph, double mean_difference_max,
                            double deviation_max, double sigma_min, int min_region_area) {
  if (!(mean_difference_max >= 0 && deviation_max >= 0 && sigma_min > 0 && std::isfinite(sigma_min)) ||
      min_region_area < 0) {
    throw Error("growing: found mean_difference_max " + std::to_string(mean_difference_max) +
                ", deviation_max " + std::to_string(deviation_max) + ", sigma_min " +
                std::to_string(sigma_min) + ", min_region_area " + std::to_string(min_region_area) +
                ", expected none below 0 and a sigma_min above");
  }
  return {grow(graph, {mean_difference_max, deviation_max, sigma_min, min_region_area}, call.exec)};
}

Segmentation merged(const Call& call, const Labels& labels, const RegionGraph& graph,
                    const Merges& merged_into, double value_scale) {
  const int count = count_of(labels.view());
  if (slot(count) != graph.nodes.size()) {
    throw Error("labels: found " + std::to_string(count) + " regions, expected the " +
                std::to_string(graph.nodes.size()) + " of the graph");
  }
  check_merges(merged_into, graph.nodes.size());
  return apply_merges(labels.as<RegionId>(), graph, merged_into, value_scale, call.exec);
}

std::vector<std::int32_t> neighbours(const RegionGraph& self, int region) {
  if (region < 0 || slot(region) >= self.nodes.size()) throw py::index_error("no such region");
  return {self.arcs.begin() + self.first_arc[slot(region)],
          self.arcs.begin() + self.first_arc[slot(region) + 1]};
}

}  // namespace

void bind_regions(py::module_& m) {
  using py::literals::operator""_a;
  Class<Region>(
      m, "Region",
      "A set of connected pixels. Mean and variance are over its valid pixels: of grey levels, or of "
      "disparities in px.")
      .shows("pixel_count", &Region::pixel_count, "its area, px")
      .shows("valid_count", &Region::valid_count, "pixels that carry a value")
      .shows("box", &Region::box, "(x, y, width, height), px")
      .shows("mean", &Region::mean,
             "of its valid pixels: grey levels, 0 to 255, or px of disparity; 0 without any")
      .shows("variance", &Region::variance,
             "of its valid pixels (population), at least 0: grey levels squared, or px squared")
      .shows("is_floor", &Region::is_floor, "the one floor region of a disparity segmentation")
      .shows("is_background", &Region::is_background,
             "the region that holds all that is no object, in the groups of a frame");
  Class<Segmentation>(m, "Segmentation", "Regions: every pixel belongs to one.")
      .shows("labels", &Segmentation::labels, "(H, W) int32, read-only: indexes `regions`")
      .shows("regions", &Segmentation::regions, "a list of Region, in raster order of their first pixel")
      .method("__len__", "Regions.", [](const Segmentation& self) { return self.regions.size(); });
  Class<Basins>(m, "Basins", "Result of watershed().")
      .shows("labels", &Basins::labels, "(H, W) int32, read-only: 0 to count - 1")
      .shows("count", &Basins::count, "number of basins, 1 or more");
  Class<RegionGraph>(m, "RegionGraph", "Regions and which of them touch (4-neighbourhood).")
      .method("__len__", "Regions.", [](const RegionGraph& self) { return self.nodes.size(); })
      .method("neighbours", "The regions that touch this one, ascending.", &neighbours, "region"_a);

  stage(
      m, "gradient", {},
      "Gradient magnitude: of an image, (H, W) uint8, in grey levels, capped at 255; or of quantised() "
      "disparities, "
      "int16, in 1/16 px, 65535 in holes. (H, W) uint16, from one side of a pixel to the other.",
      [](const Call& call, const Values<Picture>& image, SmoothingSigma sigma) {
        if (image.sixteenths) return gradient(image.sixteenths->view(), sigma.value, call.exec);
        return gradient(image.grey->gray(), sigma.value, call.exec);
      },
      "image"_a, "smoothing_sigma"_a = 0.0F);
  stage(
      m, "edge_strength", {},
      "Edges that superpixels follow: central differences in 1/4 grey level, of colour the strongest "
      "channel's. (H, W) "
      "uint16.",
      [](const Call& call, const Picture& left, SmoothingSigma sigma) {
        return edge_strength(left.gray(), left.rgb(), sigma.value, call.exec);
      },
      "left"_a, "smoothing_sigma"_a = 0.7);
  stage(
      m, "quantised", {}, "Disparities in 1/16 px: (H, W) int16, HOLE_16 in holes.",
      [](const Call& call, const DisparityInput& disparity) { return quantised(disparity.map(), call.exec); },
      "disparity"_a);
  m.attr("HOLE_16") = int{kHole16};
  stage(
      m, "watershed", {},
      "Watershed by steepest descent, 4-connected, no ridge lines. gradient: (H, W) uint16.",
      [](const Call& call, const Borrowed<std::uint16_t>& gradient) {
        return watershed(gradient.view(), call.exec);
      },
      "gradient"_a);
  stage(m, "build_graph", {},
        "Counts and links regions. labels: (H, W) integers from 0 on; values: what the statistics are of, "
        "(H, W) uint8 "
        "grey levels, or int16 as quantised() gives them, then with floor: (H, W) uint8, not 0 = floor, or "
        "None.",
        &graph_of, "labels"_a, "values"_a, "floor"_a = py::none());
  stage(m, "grow_statistical", {},
        "Statistical region growing (paper, Eq. 1 to 3): for each region that in which it ended, int32. The "
        "criteria "
        "are in units of the graph's values; min_region_area in px.",
        &grown<&grow_statistical>, "graph"_a, py::kw_only(), "mean_difference_max"_a, "deviation_max"_a,
        "sigma_min"_a, "min_region_area"_a = 0);
  stage(m, "grow_near_to_far", {},
        "The paper's region growing for disparity, from the nearest region to the farthest; else as "
        "grow_statistical().",
        &grown<&grow_near_to_far>, "graph"_a, py::kw_only(), "mean_difference_max"_a, "deviation_max"_a,
        "sigma_min"_a, "min_region_area"_a = 0);
  stage(m, "apply_merges", {},
        "Writes what growing made. value_scale: what one unit of the graph's values is (1/16 px for "
        "disparities).",
        &merged, "labels"_a, "graph"_a, "merged_into"_a, "value_scale"_a = 1.0);
  stage(
      m, "segment_intensity", {"intensity"},
      "Regions of like intensity: gradient, watershed, build_graph, grow_statistical. left: (H, W) or (H, W, "
      "3) "
      "uint8.",
      [](const Call& call, const Picture& left) {
        return segment_intensity(left.gray(), call.config.intensity, call.exec);
      },
      "left"_a);
  stage(
      m, "segment_disparity", {"disparity"},
      "Regions of like disparity, nearest first: gradient, watershed, build_graph, grow_near_to_far. floor: "
      "(H, W) "
      "uint8 as label_floor() gives it, one region of its own; or None.",
      [](const Call& call, const DisparityInput& disparity, const Mask& floor) {
        return segment_disparity(disparity.map(), floor.view(), call.config.disparity, call.exec);
      },
      "disparity"_a, "floor"_a = py::none());
}

}  // namespace cairn::python
