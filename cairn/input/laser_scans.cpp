// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/laser_scans.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/read_file.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <cairn/io/text_lines.hpp>
#include <cairn/sequence/stamps.hpp>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;

Point3 mounting_in(const fs::path& path, std::string_view text) {
  constexpr std::string_view kKey = "# laser_in_level_camera_m:";
  const std::size_t at = text.find(kKey);
  if (at == std::string_view::npos) return {};
  const std::size_t number = 1 + static_cast<std::size_t>(std::count(
                                     text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  const std::string_view rest = text.substr(at + kKey.size());
  std::vector<double> found;
  for (const std::string_view field : io::fields_of(rest.substr(0, rest.find_first_of("\r\n"))))
    if (!field.empty()) found.push_back(io::number_in(field, path, number));
  if (found.size() != 3 || std::ranges::any_of(found, [](double x) { return !std::isfinite(x); })) {
    throw Error(io::place(path, number) + ": has " + std::to_string(found.size()) +
                " numbers, expected 3: the position of the laser, x y z in m");
  }
  return {found[0], found[1], found[2]};
}

}  // namespace

std::vector<LaserScan> load_scans(const fs::path& path) {
  constexpr std::size_t kBeforeRanges = 3;
  const std::string text = io::read_file(path, io::kMaxLogBytes);
  const std::vector<io::TextLine> lines = io::lines_of(text);
  const std::vector<std::string_view> header =
      lines.empty() ? std::vector<std::string_view>{} : io::fields_of(lines.front().text);
  const bool in_seconds = !header.empty() && header[0] == "t_s";
  if (header.size() <= kBeforeRanges || !(in_seconds || header[0] == "stamp") || header[1] != "angle_min" ||
      header[2] != "angle_increment") {
    throw Error(path.string() + ": expected a first line stamp,angle_min,angle_increment,r0,... found " +
                (lines.empty() ? "none" : io::quoted(lines.front().text)));
  }
  const Point3 mounting = mounting_in(path, text);
  std::vector<LaserScan> scans;
  std::vector<Stamp> stamps;
  std::vector<std::string> names;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::string where = io::place(path, lines[i].number);
    const std::vector<std::string_view> fields = io::fields_of(lines[i].text);
    if (fields.size() <= kBeforeRanges)
      throw Error(where + ": has " + std::to_string(fields.size()) + " fields, expected 3 and then ranges");
    const auto stamp = in_seconds ? parse_seconds(fields[0]) : parse_stamp(fields[0]);
    if (!stamp) throw Error(where + ": found " + io::quoted(fields[0]) + ", expected a stamp");
    LaserScan scan{*stamp,
                   io::number_in(fields[1], path, lines[i].number),
                   io::number_in(fields[2], path, lines[i].number),
                   {},
                   mounting};
    const double last =
        scan.first_rad + scan.step_rad * static_cast<double>(fields.size() - kBeforeRanges - 1);
    constexpr double kMax = 2 * std::numbers::pi + 0.01;
    if (!(std::abs(scan.first_rad) <= kMax && std::abs(last - scan.first_rad) <= kMax))
      throw Error(where + ": found angles beyond a full turn, expected rad: are they degrees?");
    for (std::size_t k = kBeforeRanges; k < fields.size(); ++k) {
      const bool is_nothing = fields[k] == "inf" || fields[k] == "Inf" || fields[k] == "INF";
      scan.ranges_m.push_back(is_nothing
                                  ? std::numeric_limits<float>::quiet_NaN()
                                  : static_cast<float>(io::number_in(fields[k], path, lines[i].number)));
    }
    stamps.push_back(scan.stamp);
    names.push_back("of line " + std::to_string(lines[i].number));
    scans.push_back(std::move(scan));
  }
  if (scans.empty()) throw Error(path.string() + ": has no scan");
  check_rising(stamps, names, path.string());
  return scans;
}

const LaserScan* scan_at(const std::vector<LaserScan>& scans, Stamp moment) {
  constexpr std::int64_t kMaxNs = 50'000'000;
  const LaserScan* best = nullptr;
  auto at = std::ranges::lower_bound(scans, moment, {}, &LaserScan::stamp);
  if (at != scans.end()) best = &*at;
  if (at != scans.begin()) {
    --at;
    if (best == nullptr || moment.ns - at->stamp.ns < best->stamp.ns - moment.ns) best = &*at;
  }
  return best != nullptr && std::abs(best->stamp.ns - moment.ns) <= kMaxNs ? best : nullptr;
}

}  // namespace cairn::input
