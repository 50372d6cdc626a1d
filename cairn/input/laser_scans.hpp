// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <filesystem>
#include <optional>

#include <vector>

#include <cairn/sequence/reliability.hpp>

namespace cairn::input {

/// Reads laser scans from a table: a header line `stamp,angle_min,angle_increment,r0,…`, then one line per
/// scan: its stamp (t_s instead of stamp: in s; see parse_stamp()), angles in rad from straight ahead
/// counter-clockwise, ranges in m; empty, nan, inf or 0 without an echo. The laser is assumed to be at the
/// left camera unless a comment `# laser_in_level_camera_m: x y z` gives its position (x right, y down along
/// gravity, z forward). Throws Error (file, line, what was found): missing columns, a field that is not a
/// number, no range, stamps that do not ascend, angles beyond a full turn.
std::vector<LaserScan> load_scans(const std::filesystem::path& path);

/// The scan nearest to a time; nullptr if it is more than 50 ms off.
const LaserScan* scan_at(const std::vector<LaserScan>& scans, Stamp moment);

}  // namespace cairn::input
