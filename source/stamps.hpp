// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "../tracking/pose.hpp"

/// The stamps of frames, as text files and names say them. (docs/formats.md, "Stamps")
namespace cairn::io {

/// "1403715274312143104": whole numbers are ns. "1.036" and "1.036e-01": s. "2011-09-26 13:02:25.964389445":
/// a date in UTC. Nothing where the text is none of these or outside the range of a Stamp.
std::optional<Stamp> parse_stamp(std::string_view text);
/// A number of seconds, whole or not, to the ns. Nothing where it is none.
std::optional<Stamp> parse_seconds(std::string_view text);

/// "0.2 s" or "1403715274.312143104 s": a stamp without trailing zeros, for messages.
std::string stamp_text(Stamp stamp);

/// One stamp a line; lines that begin with # and empty ones do not count. Throws Error, naming the line.
std::vector<Stamp> load_stamps(const std::filesystem::path& path);

/// A camera's data.csv as EuRoC has it: a stamp in ns, a file's name.
struct NamedStamp {
  Stamp stamp;
  std::string file;  // the stamp with .png where the line names none
};
std::vector<NamedStamp> load_named_stamps(const std::filesystem::path& path);

/// The column t_s of a table whose first line names its columns (odometry.csv, trajectory.csv of a tour).
struct FrameStamp {
  std::optional<std::size_t> frame;  // the column of that name
  Stamp stamp;
};
/// Nothing where the table has no column t_s. Throws Error, naming the line.
std::optional<std::vector<FrameStamp>> load_frame_stamps(const std::filesystem::path& path);

/// Throws Error unless the stamps rise, naming the frame and both values; where all of them lie less than 1
/// us apart, it says that they are no ns. `where`: what the stamps are from; `names`: of the frames.
void check_rising(std::span<const Stamp> stamps, std::span<const std::string> names,
                  const std::string& where);

/// Left and right frames of one moment.
struct StampPairs {
  struct Pair {
    std::size_t left = 0;
    std::size_t right = 0;
  };
  std::vector<Pair> pairs;
  std::vector<std::size_t> left_alone;
  std::vector<std::size_t> right_alone;
};
/// Pairs what is each other's nearest and not more than `max_skew_ms` apart; each is used once. Both rise.
StampPairs pair_by_stamps(std::span<const Stamp> left, std::span<const Stamp> right, double max_skew_ms);

}  // namespace cairn::io
