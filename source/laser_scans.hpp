// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <optional>

#include <vector>

#include "../tracking/reliability.hpp"

namespace cairn::io {

/// Reads scans of a laser from a table: a first line `stamp,angle_min,angle_increment,r0,…`, then a line a
/// scan: its stamp (t_s in place of stamp: in s; see parse_stamp()), angles in rad from straight ahead to the
/// left, ranges in m, empty, nan, inf or 0 where nothing was hit. The laser is taken to be where the left
/// camera is, unless a comment `# laser_in_level_camera_m: x y z` says where (x right, y down along gravity,
/// z forward). Throws Error (file, line, what was found): no such columns, a field that is no number, no
/// range, stamps that do not rise, angles beyond a full turn.
std::vector<LaserScan> load_scans(const std::filesystem::path& path);

/// The scan nearest to a moment, none where it is more than 50 ms off.
const LaserScan* scan_at(const std::vector<LaserScan>& scans, Stamp moment);

}  // namespace cairn::io
