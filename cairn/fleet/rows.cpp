// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/fleet/rows.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cmath>
#include <limits>
#include <tuple>

namespace cairn::fleet {
namespace {

constexpr double kFarthest_m = 10'000;
constexpr double kLargest_m = 1000;
constexpr double kLargestVariance_m2 = 1e6;
constexpr double kLeastVariance_m2 = 1e-9;
constexpr std::int32_t kMostFrames = 1 << 30;
constexpr double kMostLogOdds = 5;
constexpr std::size_t kLongestName = 64;
constexpr std::size_t kMostLooks = 8;
constexpr std::int64_t kLastId = std::int64_t{1} << 53U;
constexpr std::size_t kRobotLength = std::tuple_size_v<NameBytes>;

template <class Row>
std::string robot_fault(const Row& row) {
  const std::string name = robot_of(row).name;
  const bool is_filled_up = std::all_of(row.robot.begin() + static_cast<std::ptrdiff_t>(name.size()),
                                        row.robot.end(), [](std::uint8_t byte) { return byte == 0; });
  return is_filled_up && is_robot_name(name) ? "" : "the name of its robot";
}

/// Symmetric, and positive definite by its leading minors, with an inverse.
bool is_covariance(const Covariance3& c) {
  for (const double value : c) {
    if (!(std::abs(value) <= kLargestVariance_m2)) return false;
  }
  constexpr double kRounding = 1e-9;
  const double scale = c[0] + c[4] + c[8];
  if (std::abs(c[1] - c[3]) > kRounding * scale || std::abs(c[2] - c[6]) > kRounding * scale ||
      std::abs(c[5] - c[7]) > kRounding * scale)
    return false;
  const double minor = c[0] * c[4] - c[1] * c[3];
  const double all = c[0] * (c[4] * c[8] - c[5] * c[7]) - c[1] * (c[3] * c[8] - c[5] * c[6]) +
                     c[2] * (c[3] * c[7] - c[4] * c[6]);
  constexpr double kLeastShare = 1e-9;  // of the product of the variances: else the inverse is not finite
  return std::min({c[0], c[4], c[8]}) >= kLeastVariance_m2 && minor > 0 &&
         all > kLeastShare * c[0] * c[4] * c[8];
}

bool is_distribution(const float* from, const float* to) {
  constexpr double kRounding = 1e-3;
  double sum = 0;
  for (const float* value = from; value != to; ++value) {
    if (!(*value >= 0 && *value <= 1 + kRounding)) return false;
    sum += static_cast<double>(*value);
  }
  return sum == 0 || std::abs(sum - 1) <= kRounding;  // 0: never seen in colour
}

std::string look_fault(const std::vector<LookRow>& looks) {
  constexpr int kLightness = 8;
  if (looks.size() > kMostLooks) return "more than 8 looks";
  int before = -1;
  for (const LookRow& look : looks) {
    if (look.octant > 7 || look.octant <= before) return "the octants of its looks";
    before = look.octant;
    if (look.pixels < 0) return "a look of less than no pixels";
    const float* const colours = look.colours.data();
    if (!is_distribution(colours, colours + kLightness) ||
        !is_distribution(colours + kLightness, colours + look.colours.size()))
      return "the colours of a look";
  }
  return "";
}

bool is_line(const std::string& text, std::size_t longest) {
  return text.size() <= longest &&
         std::ranges::none_of(text, [](char c) { return static_cast<unsigned char>(c) < ' ' || c == 127; });
}

int floor_division(int value, int divisor) {
  return value >= 0 ? value / divisor : -((divisor - 1 - value) / divisor);
}

}  // namespace

std::optional<MapId> map_id_of(const std::string& digits) {
  MapId id{};
  if (digits.size() != 2 * id.size()) return std::nullopt;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    const auto at = std::string("0123456789abcdef").find(digits[i]);
    if (at == std::string::npos) return std::nullopt;
    id[i / 2] = static_cast<std::uint8_t>(id[i / 2] * 16 + at);
  }
  return id;
}

std::string digits_of(const MapId& id) {
  std::string digits;
  for (const std::uint8_t byte : id) {
    digits += "0123456789abcdef"[byte / 16];
    digits += "0123456789abcdef"[byte % 16];
  }
  return digits;
}

bool is_robot_name(const std::string& name) {
  const auto is_lower = [](char c) { return c >= 'a' && c <= 'z'; };
  return !name.empty() && name.size() <= kRobotLength && name != "map" && is_lower(name[0]) &&
         std::ranges::all_of(name, [&](char c) { return is_lower(c) || (c >= '0' && c <= '9') || c == '_'; });
}

std::string checked_robot(const std::string& name, const std::string& option) {
  if (!is_robot_name(name)) {
    throw Error(option + ": found \"" + name + "\", expected up to " + std::to_string(kRobotLength) +
                " of a-z, 0-9 and _, beginning with a letter, and not map");
  }
  return name;
}

NameBytes bytes_of(const std::string& robot) {
  NameBytes bytes{};
  std::copy_n(robot.begin(), std::min(robot.size(), bytes.size()), bytes.begin());
  return bytes;
}

std::string fault_of(const LandmarkRow& row) {
  if (std::string fault = robot_fault(row); !fault.empty()) return fault;
  if (row.id < 1 || row.id > kLastId) return "an id outside of 1 … 2^53";
  if (!is_line(row.name, kLongestName)) return "a name of more than 64 bytes, or with control characters";
  for (const double at : {row.position.x, row.position.y, row.position.z}) {
    if (!(std::abs(at) <= kFarthest_m)) return "a position of more than 10 km";
  }
  if (!is_covariance(row.covariance)) return "a covariance that is none";
  for (const double side : {row.narrowest, row.widest, row.height}) {
    if (!(side >= 0 && side <= kLargest_m)) return "a size outside of 0 … 1000 m";
  }
  if (!(std::abs(row.height_over_floor) <= kFarthest_m)) return "a height of more than 10 km";
  if (!(std::abs(row.log_odds) <= kMostLogOdds)) return "log-odds outside of -5 … 5";
  for (const std::int32_t count : {row.seen, row.expected, row.seen_through}) {
    if (count < 0 || count > kMostFrames) return "a count outside of 0 … 2^30";
  }
  if (!(row.open_share >= 0 && row.open_share <= 1)) return "a share outside of 0 … 1";
  return look_fault(row.looks);
}

std::string fault_of(const FloorRow& row) {
  if (std::string fault = robot_fault(row); !fault.empty()) return fault;
  constexpr int kFarthest = static_cast<int>(kFarthest_m / (kFloorCell_m * FloorRow::kTile));
  if (std::abs(std::int64_t{row.x}) > kFarthest || std::abs(std::int64_t{row.y}) > kFarthest)
    return "a place of more than 10 km";
  const auto is_wrong = [](std::int32_t frames) { return frames < 0 || frames > kMostFrames; };
  return std::ranges::any_of(row.frames, is_wrong) ? "a count outside of 0 … 2^30" : "";
}

std::string fault_of(const IndexRow& row) {
  if (std::string fault = robot_fault(row); !fault.empty()) return fault;
  return row.tile_x.size() == row.tile_y.size() ? "" : "tiles without x or y";
}

std::string fault_of(const AgentRow& row) {
  constexpr std::size_t kLongestLine = 256;
  constexpr std::size_t kMostKnown = 256;
  const bool is_map = row.role == "map" && row.name == "map";
  if (!is_map && (row.role != "perception" || !is_robot_name(row.name))) return "its role or name";
  for (const std::string* text : {&row.host, &row.message, &row.weakest}) {
    if (!is_line(*text, kLongestLine)) return "a text of more than 256 bytes, or with control characters";
  }
  if (row.robots.size() > kMostKnown) return "more than 256 robots";
  for (const KnownRobotRow& robot : row.robots) {
    if (!is_robot_name(robot.name) || !is_line(robot.refusal, kLongestLine))
      return "a robot without a valid name";
  }
  return row.level > 2 ? "a level of more than 2" : "";
}

LandmarkRow row_of(const Landmark& landmark, const RobotKey& robot, std::uint64_t version) {
  LandmarkRow row;
  row.map_id = robot.map_id;
  row.robot = bytes_of(robot.name);
  row.id = number(landmark.id);
  row.version = version;
  row.name = landmark.name;
  row.is_gone = landmark.is_gone;
  row.position = {landmark.position_m.x, landmark.position_m.y, landmark.position_m.z};
  row.covariance = landmark.covariance_m2;
  row.narrowest = landmark.size.narrowest_m;
  row.widest = landmark.size.widest_m;
  row.height = landmark.size.height_m;
  row.height_over_floor = landmark.height_over_floor_m;
  row.log_odds = landmark.log_odds;
  row.seen = landmark.seen;
  row.expected = landmark.expected;
  row.seen_through = landmark.seen_through;
  row.open_share = landmark.open_share;
  row.first_ns = landmark.first.ns;
  row.last_ns = landmark.last.ns;
  row.run = landmark.run;
  for (const LandmarkLook& look : landmark.looks)
    row.looks.push_back({static_cast<std::uint8_t>(look.octant), look.pixels, look.colours});
  return row;
}

Landmark landmark_of(const LandmarkRow& row) {
  Landmark landmark;
  landmark.id = LandmarkId{row.id};
  landmark.name = row.name;
  landmark.is_gone = row.is_gone;
  landmark.position_m = {row.position.x, row.position.y, row.position.z};
  landmark.covariance_m2 = row.covariance;
  landmark.size = {row.narrowest, row.widest, row.height};
  landmark.height_over_floor_m = row.height_over_floor;
  landmark.log_odds = row.log_odds;
  landmark.seen = row.seen;
  landmark.expected = row.expected;
  landmark.seen_through = row.seen_through;
  landmark.open_share = row.open_share;
  landmark.first = {row.first_ns};
  landmark.last = {row.last_ns};
  landmark.run = row.run;
  for (const LookRow& look : row.looks) {
    LandmarkLook seen;
    seen.octant = look.octant;
    seen.colours = look.colours;
    seen.pixels = look.pixels;
    landmark.looks.push_back(std::move(seen));
  }
  return landmark;
}

std::vector<FloorRow> rows_of(const std::vector<FloorCell>& floor, const RobotKey& robot,
                              std::uint64_t version) {
  std::vector<FloorRow> tiles;
  for (const FloorCell cell : floor) {
    const int x = floor_division(cell.x, FloorRow::kTile);
    const int y = floor_division(cell.y, FloorRow::kTile);
    const auto at = std::ranges::lower_bound(tiles, std::tuple(x, y), {},
                                             [](const FloorRow& tile) { return std::tuple(tile.x, tile.y); });
    FloorRow& tile = at != tiles.end() && at->x == x && at->y == y ? *at : *tiles.insert(at, FloorRow{});
    tile.map_id = robot.map_id;
    tile.robot = bytes_of(robot.name);
    tile.x = x;
    tile.y = y;
    tile.version = version;
    const int inside = (cell.y - y * FloorRow::kTile) * FloorRow::kTile + cell.x - x * FloorRow::kTile;
    tile.frames[static_cast<std::size_t>(inside)] = cell.frames;
  }
  return tiles;
}

std::vector<FloorCell> cells_of(const std::vector<FloorRow>& tiles) {
  std::vector<FloorCell> cells;
  for (const FloorRow& tile : tiles) {
    for (int i = 0; i < FloorRow::kTile * FloorRow::kTile; ++i) {
      const std::int32_t frames = tile.frames[static_cast<std::size_t>(i)];
      if (frames == 0) continue;
      cells.push_back({tile.x * FloorRow::kTile + i % FloorRow::kTile,
                       tile.y * FloorRow::kTile + i / FloorRow::kTile, frames});
    }
  }
  std::ranges::sort(cells, {}, [](FloorCell cell) { return std::tuple(cell.x, cell.y); });
  return cells;
}

RowDifferences::Changes RowDifferences::next(const LandmarkMap& map) {
  Changes changes;
  const std::uint64_t version = version_ + 1;
  // Rows of equal content are equal bytes.
  const auto differs = [](auto now, const auto& before) {
    now.version = before.version;
    return ros::encode(now) != ros::encode(before);
  };
  /// Whether a row has left the map.
  const auto take = [&](auto& sent, auto now, auto& changed, const auto& key) {
    std::size_t still_there = 0;
    for (auto& row : now) {
      const auto before = std::ranges::lower_bound(sent, key(row), {}, key);
      const bool is_known = before != sent.end() && key(*before) == key(row);
      still_there += is_known ? 1 : 0;
      if (is_known && !differs(row, *before)) {
        row.version = before->version;
      } else {
        changed.push_back(row);
      }
    }
    const bool has_left = still_there < sent.size();
    sent = std::move(now);
    return has_left;
  };
  std::vector<LandmarkRow> landmarks;
  landmarks.reserve(map.list.size());
  for (const Landmark& landmark : map.list) landmarks.push_back(row_of(landmark, robot_, version));
  const bool has_left = take(landmarks_, std::move(landmarks), changes.landmarks,
                             [](const LandmarkRow& row) { return row.id; });
  const bool has_floor_left = take(floor_, rows_of(map.floor, robot_, version), changes.floor,
                                   [](const FloorRow& tile) { return std::tuple(tile.x, tile.y); });
  if (has_left || has_floor_left || !has_sent_index_) {
    IndexRow& index = changes.index.emplace();
    index.map_id = robot_.map_id;
    index.robot = bytes_of(robot_.name);
    index.version = version;
    for (const LandmarkRow& row : landmarks_) index.landmarks.push_back(row.id);
    for (const FloorRow& tile : floor_) {
      index.tile_x.push_back(tile.x);
      index.tile_y.push_back(tile.y);
    }
    has_sent_index_ = true;
  }
  if (!changes.landmarks.empty() || !changes.floor.empty() || changes.index) version_ = version;
  return changes;
}

void RowDifferences::is_unsent(const LandmarkRow& row) {
  std::erase_if(landmarks_, [&](const LandmarkRow& sent) { return sent.id == row.id; });
  has_sent_index_ = false;  // it may leave the map before it is sent
}

void RowDifferences::is_unsent(const FloorRow& row) {
  std::erase_if(floor_, [&](const FloorRow& sent) { return sent.x == row.x && sent.y == row.y; });
  has_sent_index_ = false;
}

}  // namespace cairn::fleet
