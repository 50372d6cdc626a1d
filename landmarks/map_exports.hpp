// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

#include "map_file.hpp"

namespace cairn {

/// GeoJSON's features in metres of the map's frame, not degrees, which "frame_id" and "units" say: landmarks
/// as polygons (their footprint: a circle of their mean width), the runs' paths as lines.
std::string as_geojson(const MapFile& file);
/// g2o's text: keyframes (VERTEX_SE3:QUAT), landmarks (VERTEX_TRACKXYZ, ids from 1000000 on), edges between
/// successive keyframes of a run, and from keyframes to what they saw.
std::string as_g2o(const MapFile& file);
/// Keyframes of one run (0: of the last one that has any) as `t x y z qx qy qz qw` lines.
std::string as_tum(const MapFile& file, std::int64_t run = 0);
/// Landmarks, a line each, with a header.
std::string as_csv(const LandmarkMap& map);

}  // namespace cairn
