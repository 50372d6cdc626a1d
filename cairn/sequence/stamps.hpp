// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <cairn/sequence/pose.hpp>

/// Parsing of frame stamps in text files and names. (docs/formats.md, "Stamps")
namespace cairn {

/// "1403715274312143104": integers are ns. "1.036" and "1.036e-01": s. "2011-09-26 13:02:25.964389445": a
/// date in UTC. nullopt for other text or outside the range of a Stamp.
std::optional<Stamp> parse_stamp(std::string_view text);
/// A number of seconds, integer or not, to the ns. nullopt if invalid.
std::optional<Stamp> parse_seconds(std::string_view text);

/// "0.2 s" or "1403715274.312143104 s": a stamp without trailing zeros, for messages.
std::string stamp_text(Stamp stamp);

/// How the stamp of a frame continues those before it: one rule for every reader of frames and for the Follower.
/// (docs/recordings.md, "Stamps that go back")
enum class ClockStep : std::uint8_t {
  forward,
  repeated,  // or out of order, at most 1 s earlier: such a frame is left out, or refused where a caller gives it
  set_back,  // more than 1 s earlier: the clock was set back, or a recording began again; a new run begins
};
constexpr ClockStep clock_step(Stamp before, Stamp now) {
  constexpr std::int64_t kOutOfOrderNs = 1'000'000'000;
  if (now > before) return ClockStep::forward;
  return before.ns - now.ns > kOutOfOrderNs ? ClockStep::set_back : ClockStep::repeated;
}

/// One stamp per line; lines that begin with # and empty ones are skipped. Throws Error naming the line.
std::vector<Stamp> load_stamps(const std::filesystem::path& path);

/// A line of a camera's data.csv in the form of EuRoC: a stamp in ns, a file name.
struct NamedStamp {
  Stamp stamp;
  std::string file;  // the stamp with .png if the line has no name
};
std::vector<NamedStamp> load_named_stamps(const std::filesystem::path& path);

/// The column t_s of a table with a header line (odometry.csv, trajectory.csv of a tour).
struct FrameStamp {
  std::optional<std::size_t> frame;  // the column of that name
  Stamp stamp;
};
/// nullopt if the table has no column t_s. Throws Error naming the line.
std::optional<std::vector<FrameStamp>> load_frame_stamps(const std::filesystem::path& path);

/// A stamp for each of the frames `names`: one per line, or, for an excerpt, the line numbered by the name. Throws
/// Error if there is none.
std::vector<Stamp> stamps_by_line(const std::filesystem::path& path, const std::vector<std::string>& names);
/// The same from the rows of a table: those of the numbers in `names`, else one row each, in order.
std::vector<Stamp> stamps_by_frame(const std::filesystem::path& path, const std::vector<FrameStamp>& rows,
                                   const std::vector<std::string>& names);

/// Throws Error if all stamps are within 1 us of each other: they are not ns. `where`: their origin.
void check_unit(std::span<const Stamp> stamps, const std::string& where);
/// Throws Error unless the stamps ascend, naming the frame and both values, and as check_unit(). `names`: of the frames.
void check_rising(std::span<const Stamp> stamps, std::span<const std::string> names,
                  const std::string& where);

/// Left and right frames with matching stamps.
struct StampPairs {
  struct Pair {
    std::size_t left = 0;
    std::size_t right = 0;
  };
  std::vector<Pair> pairs;
  std::vector<std::size_t> left_alone;
  std::vector<std::size_t> right_alone;
};
/// Pairs mutual nearest neighbours at most `max_skew_ms` apart; each frame is used once. Both lists ascend.
StampPairs pair_by_stamps(std::span<const Stamp> left, std::span<const Stamp> right, double max_skew_ms);

}  // namespace cairn
