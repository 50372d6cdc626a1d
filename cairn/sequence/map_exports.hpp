// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <string>

#include <cairn/sequence/map_file.hpp>

namespace cairn {

/// GeoJSON features in metres of the map frame, not degrees, as "frame_id" and "units" state: landmarks as
/// polygons (footprint: a circle of the mean width), the paths of the runs as lines.
std::string as_geojson(const MapFile& file);
/// g2o text: keyframes (VERTEX_SE3:QUAT), landmarks (VERTEX_TRACKXYZ, ids from 1000000), edges between
/// successive keyframes of a run, and from keyframes to observed landmarks.
std::string as_g2o(const MapFile& file);
/// The keyframes of one run (0: of the last one with keyframes) as `t x y z qx qy qz qw` lines.
std::string as_tum(const MapFile& file, std::int64_t run = 0);
/// One line per landmark, with a header.
std::string as_csv(const LandmarkMap& map);

}  // namespace cairn
