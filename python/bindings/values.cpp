// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "values.hpp"

#include "bindings.hpp"

namespace cairn::python {
namespace {

void bind_disparities(py::module_& m) {
  value_class<EpipolarOffset>(m, "EpipolarOffset").def(py::init([](float rows, float rows_per_px) {
    return EpipolarOffset{rows, rows_per_px, 0, 0, EpipolarOutcome::corrected};
  }));
  value_class<EpipolarCorrection>(m, "EpipolarCorrection");
  value_class<Matches>(m, "Matches");
  m.attr("NO_MATCH") = int{kNoMatch};
  value_class<DisparityMap>(m, "DisparityMap");
  m.attr("MAX_DISPARITY") = kMaxDisparity;
  py::list reasons;
  for (const auto& [name, bit] : kRejects) {
    const auto of_bit = [bit = bit](const Reason& r) { return r.bit == bit; };
    const auto reason = std::find_if(kReasons.begin(), kReasons.end(), of_bit);
    reasons.append(py::make_tuple(std::string(name), int(bit), std::string(reason->says)));
  }
  m.attr("REASONS") = reasons;
}

void bind_floor_and_walls(py::module_& m) {
  value_class<GroundPlane>(m, "GroundPlane").def("_disparity", &GroundPlane::disparity_px);
  value_class<Ground>(m, "Ground");
  auto floor = value_class<FloorFrame>(m, "FloorFrame");
  shows(floor, "pitch_rad", &FloorFrame::pitch_rad);
  shows(floor, "roll_rad", &FloorFrame::roll_rad);
  shows(floor, "_matrix", &FloorFrame::floor_from_camera);
  m.def("floor_frame", py::overload_cast<const GroundPlane&, const StereoRig&>(&floor_frame));
  value_class<Background>(m, "Background").def("_disparity", &Background::disparity_px);
}

void bind_regions(py::module_& m) {
  value_class<Region>(m, "Region");
  value_class<Segmentation>(m, "Segmentation");
  value_class<Basins>(m, "Basins");
  value_class<RegionGraph>(m, "RegionGraph")
      .def("__len__", [](const RegionGraph& self) { return self.nodes.size(); })
      .def("_neighbours", [](const RegionGraph& self, int region) {
        return std::vector<std::int32_t>(self.arcs.begin() + self.first_arc[slot(region)],
                                         self.arcs.begin() + self.first_arc[slot(region) + 1]);
      });
  m.attr("HOLE_16") = int{kHole16};

  value_class<Superpixels>(m, "Superpixels");
  auto tree = value_class<MergeTree>(m, "MergeTree");
  shows(tree, "parents", [](const MergeTree& self) {
    Numbers<std::int32_t> all;
    for (const MergeNode& node : self.nodes) all.values.push_back(node.whole);
    return all;
  });
  value_class<ChosenObjects>(m, "ChosenObjects");
  value_class<RefinedDisparity>(m, "RefinedDisparity");
  value_class<Fusion>(m, "Fusion");
}

void bind_objects(py::module_& m) {
  auto box = value_class<FloorBox>(m, "FloorBox");
  shows(box, "_covariance", [](const FloorBox& self) { return self.centre_covariance_m2; });
  value_class<Object>(m, "Object");
  auto objects = value_class<Objects>(m, "Objects");
  shows(
      objects, "_list", [](const Objects& self) -> const auto& { return self.list; });
  value_class<RejectedObstacle>(m, "LeftOut");
  value_class<GroundStep>(m, "GroundStep");
  auto scan = value_class<ObstacleScan>(m, "ObstacleScan");
  shows(scan, "ranges_m", [](const ObstacleScan& self) { return Numbers<float>{self.ranges_m}; });
  auto grid = value_class<ObstacleGrid>(m, "ObstacleGrid");
  shows(grid, "_origin", [](const ObstacleGrid& self) {
    return std::pair{self.origin_x_m, self.origin_y_m};
  });
  shows(grid, "cells", [](const ObstacleGrid& self) {
    return Numbers<std::int8_t>{self.cells, {self.height, self.width}};
  });
  value_class<StereoResult>(m, "StereoResult");
}

}  // namespace

void bind_values(py::module_& m) {
  bind_disparities(m);
  bind_floor_and_walls(m);
  bind_regions(m);
  bind_objects(m);
}

}  // namespace cairn::python
