// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/output/track_files.hpp>

#include <cairn/output/json_line.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <new>
#include <set>
#include <string_view>

namespace cairn::output {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::int64_t kMaxFrames = 10'000'000;
constexpr std::int64_t kMaxSide = 65'535;
constexpr std::size_t kMaxLine = std::size_t{64} << 20;
constexpr std::size_t kMaxShown = 40;
constexpr std::int64_t kMaxNumber = JsonLine::kMaxNumber;

std::optional<Pose> pose_in(const JsonLine& line) {
  if (line.at("pose").is_null()) return std::nullopt;
  const JsonLine pose(line.at("pose"));
  const auto place = pose.maybe_point("position_m");
  const auto turn = pose.maybe_numbers<4>("quaternion_xyzw");
  if (!place || !turn) return std::nullopt;
  constexpr double kShortest = 1e-6;
  double squares = 0;
  for (const double entry : *turn) squares += entry * entry;
  if (squares < kShortest) pose.refuse("quaternion_xyzw", "a rotation, not zeros");
  return pose_of(*place, *turn);
}

io::Rle mask_in(const JsonLine& track) {
  const JsonLine rle(track.at("rle"));
  const Json& size = rle.at("size");
  const auto is_side = [](const Json& side) {
    return side.is_number_integer() && side >= 1 && side <= kMaxSide;
  };
  if (!size.is_array() || size.size() != 2 || !is_side(size[0]) || !is_side(size[1]))
    rle.refuse("size", "[height, width] from 1 to " + std::to_string(kMaxSide));
  return {{size[1].get<int>(), size[0].get<int>()}, rle.text("counts")};
}

TrackState state_in(const JsonLine& track) {
  const std::string word = track.text("state");
  std::string words;
  for (const auto& state : kTrackStates) {
    if (word == state.name) return state.value;
    words += (words.empty() ? "" : ", ") + std::string(state.name);
  }
  track.refuse("state", "one of " + words);
}

TrackRecord track_of(const Json& json) {
  const JsonLine line(json);
  TrackRecord track;
  track.id = TrackId{line.integer("id", 1, kMaxNumber)};
  track.state = state_in(line);
  track.is_moving = line.flag("moving");
  track.position_m = line.maybe_point("position_m");
  track.covariance_m2 = line.maybe_numbers<9>("covariance_m2");
  track.landmark = line.maybe_integer("landmark", 0, kMaxNumber);
  if (!line.at("rle").is_null()) track.mask = mask_in(line);
  return track;
}

TrackFrame frame_of(const Json& json) {
  const JsonLine line(json);
  TrackFrame frame;
  frame.index = line.integer("frame", 0, kMaxFrames);
  frame.name = line.text("name");
  frame.stamp = Stamp{line.integer("stamp_ns", std::numeric_limits<std::int64_t>::min(), kMaxNumber)};
  frame.map_from_camera = pose_in(line);
  if (!line.at("motion").is_null()) {
    const JsonLine motion(line.at("motion"));
    if (!motion.at("refusal").is_null()) frame.refusal = motion.text("refusal");
  }
  const Json& tracks = line.at("tracks");
  if (!tracks.is_array()) line.refuse("tracks", "a list");
  std::set<TrackId> ids;
  for (const Json& one : tracks) {
    frame.tracks.push_back(track_of(one));
    const TrackId id = frame.tracks.back().id;
    if (!ids.insert(id).second) throw Error("track " + std::to_string(number(id)) + " occurs twice");
  }
  return frame;
}

/// The words between blanks. (A stream would silently stop when out of memory.)
std::vector<std::string> words_of(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\v\f";
  std::vector<std::string> words;
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
    if (text.empty()) return words;
    const std::size_t end = std::min(text.find_first_of(kBlanks), text.size());
    words.emplace_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

/// Calls visit(text, number, has_end) for each non-empty line.
void each_line(const fs::path& path,
               const std::function<void(const std::string&, std::size_t, bool)>& visit) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) throw Error(path.string() + ": is a folder, expected a file");
  std::ifstream file(path, std::ios::binary);
  if (!file && errno == ENOMEM) throw std::bad_alloc();
  if (!file) throw Error(path.string() + ": no such file, or it cannot be read");
  std::string text;
  std::size_t line = 0;
  const auto where = [&] { return path.string() + ": line " + std::to_string(line) + ": "; };
  for (;;) {
    ++line;
    text.clear();
    bool has_end = false;
    for (int c = file.get(); c != std::ifstream::traits_type::eof(); c = file.get()) {
      if (c == '\n') {
        has_end = true;
        break;
      }
      if (text.size() == kMaxLine) throw Error(where() + "is longer than 64 MiB");
      text.push_back(static_cast<char>(c));
    }
    if (file.bad()) throw Error(path.string() + ": cannot be read");
    if (!text.empty() && text.back() == '\r') text.pop_back();
    if (!text.empty()) {
      try {
        visit(text, line, has_end);
      } catch (const Error& error) {
        throw Error(where() + error.what());
      }
    }
    if (!has_end) return;
  }
}

/// Calls take(json, line) for each line. Skips a truncated last line; returns whether there is one.
bool each_json(const fs::path& path, const std::function<void(const Json&, std::size_t)>& take) {
  bool is_cut_off = false;
  each_line(path, [&](const std::string& text, std::size_t line, bool has_end) {
    const std::optional<Json> json = parsed_json(text);
    if (json) {
      take(*json, line);
    } else if (has_end) {
      throw Error("is not JSON");
    } else {
      is_cut_off = true;
    }
  });
  return is_cut_off;
}

std::int64_t number_in(const std::string& word, const char* what, std::int64_t least, std::int64_t most) {
  const std::string expected = std::string(what) + " is `" + word.substr(0, kMaxShown) +
                               "`, expected a whole number from " + std::to_string(least) + " to " +
                               std::to_string(most);
  const bool are_digits =
      !word.empty() && word.size() <= 18 && word.find_first_not_of("0123456789") == std::string::npos;
  if (!are_digits) throw Error(expected);
  const std::int64_t number = std::stoll(word);
  if (number < least || number > most) throw Error(expected);
  return number;
}

}  // namespace

TrackFile load_tracks(const fs::path& path) {
  TrackFile file;
  std::map<std::string, std::int64_t> names;
  file.is_cut_off = each_json(path, [&](const Json& json, std::size_t line) {
    TrackFrame frame = frame_of(json);
    frame.line = line;
    if (!file.frames.empty()) {
      const TrackFrame& before = file.frames.back();
      if (frame.index <= before.index) {
        throw Error("`frame` is " + std::to_string(frame.index) + ", expected more than " +
                    std::to_string(before.index) + " of the line before");
      }
      if (frame.stamp <= before.stamp) {
        throw Error("`stamp_ns` is " + std::to_string(frame.stamp.ns) + ", expected more than " +
                    std::to_string(before.stamp.ns) + " of the line before");
      }
    }
    if (!names.emplace(frame.name, frame.index).second)
      throw Error("`name` is \"" + frame.name + "\", already used by an earlier line");
    file.frames.push_back(std::move(frame));
  });
  if (file.frames.empty()) throw Error(path.string() + ": has no frame");
  return file;
}

TrackFile load_mots(const fs::path& path) {
  constexpr std::int64_t kMaxOfMots = 1'000'000;  // missing frames are filled in up to this number
  constexpr std::int64_t kIgnored = 10;
  std::map<std::int64_t, std::map<std::int64_t, TrackRecord>> masks;
  each_line(path, [&](const std::string& text, std::size_t, bool) {
    const std::vector<std::string> word = words_of(text);
    if (word.size() != 6)
      throw Error("found `" + text.substr(0, kMaxShown) + "`, expected `frame id class height width rle`");
    const std::int64_t frame = number_in(word[0], "the frame", 0, kMaxOfMots);
    const std::int64_t id = number_in(word[1], "the id", 1, (std::int64_t{1} << 31) - 1);
    const std::int64_t kind = number_in(word[2], "the class", 0, std::int64_t{1} << 31);
    const auto height = static_cast<int>(number_in(word[3], "the height", 1, kMaxSide));
    const auto width = static_cast<int>(number_in(word[4], "the width", 1, kMaxSide));
    TrackRecord track;
    track.id = TrackId{id};
    track.mask = io::Rle{{width, height}, word[5]};
    track.is_dont_care = kind == kIgnored;
    if (!masks[frame].emplace(id, std::move(track)).second)
      throw Error("id " + word[1] + " occurs twice in frame " + word[0]);
  });
  if (masks.empty()) throw Error(path.string() + ": has no mask");
  TrackFile file;
  for (std::int64_t index = 0; index <= masks.rbegin()->first; ++index) {
    TrackFrame frame;
    frame.index = index;
    frame.name = std::to_string(index);
    frame.stamp = Stamp{index};
    for (auto& [id, track] : masks[index]) frame.tracks.push_back(std::move(track));
    file.frames.push_back(std::move(frame));
  }
  return file;
}

std::vector<ChangeRecord> load_changes(const fs::path& path) {
  std::vector<ChangeRecord> changes;
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return changes;
  each_json(path, [&](const Json& json, std::size_t) {
    const JsonLine line(json);
    ChangeRecord change;
    change.frame = line.integer("frame", 0, kMaxFrames);
    change.kind = line.text("kind");
    change.landmark = line.maybe_integer("landmark", 0, kMaxNumber);
    if (const auto track = line.maybe_integer("track", 0, kMaxNumber)) change.track = TrackId{*track};
    change.from_m = line.maybe_point("from_m");
    change.to_m = line.maybe_point("to_m");
    changes.push_back(std::move(change));
  });
  return changes;
}

Image<TrackId> track_labels(const std::vector<TrackRecord>& tracks, Size size, const std::string& where) {
  Image<TrackId> labels(size, TrackId::none, {});
  for (const TrackRecord& track : tracks) {
    if (!track.mask) continue;
    const std::string who = where + ": track " + std::to_string(number(track.id));
    if (track.mask->size != size)
      throw Error(who + ": its mask is " + text(track.mask->size) + ", expected " + text(size));
    Image<std::uint8_t> mask;
    try {
      mask = io::decode_rle(*track.mask);
    } catch (const Error& error) {
      throw Error(who + ": " + error.what());
    }
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        if (mask(x, y) == 0) continue;
        if (labels(x, y) != TrackId::none)
          throw Error(who + ": its mask overlaps that of track " + std::to_string(number(labels(x, y))));
        labels(x, y) = track.id;
      }
    }
  }
  return labels;
}

}  // namespace cairn::output
