// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/stamps.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/io/frame_names.hpp>
#include <cairn/io/read_file.hpp>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>

#include <cairn/io/names_and_numbers.hpp>
#include <cairn/io/text_lines.hpp>
#include <cairn/sequence/stamp_pairing.hpp>

namespace cairn {

std::string seconds_text(Stamp stamp) {
  constexpr std::uint64_t kPerSecond = 1'000'000'000;
  // A double has no room for both; and the least of stamps has no opposite.
  const auto bits = static_cast<std::uint64_t>(stamp.ns);
  const std::uint64_t ns = stamp.ns < 0 ? 0 - bits : bits;
  const std::string fraction = std::to_string(ns % kPerSecond);
  return (stamp.ns < 0 ? "-" : "") + std::to_string(ns / kPerSecond) + "." +
         std::string(9 - fraction.size(), '0') + fraction;
}

}  // namespace cairn

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
/// More than a century before and after 1970; sums and differences fit 64 bits.
constexpr std::int64_t kMaxNs = std::numeric_limits<std::int64_t>::max() / 2;

bool is_digits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), io::is_digit);
}

std::optional<Stamp> stamp_of(std::int64_t seconds, std::int64_t ns) {
  if (std::llabs(seconds) > kMaxNs / kNsPerSecond) return std::nullopt;
  return Stamp{seconds * kNsPerSecond + ns};
}

/// The first nine decimals, in ns.
std::int64_t fraction_ns(std::string_view digits) {
  constexpr std::size_t kDigits = 9;
  std::string nine(digits.substr(0, kDigits));
  nine.resize(kDigits, '0');
  return io::whole<std::int64_t>(nine).value_or(0);
}

/// Parses decimals without a double, whose resolution for current stamps is 100 ns.
std::optional<Stamp> decimal(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  const std::size_t point = std::min(text.find('.'), text.size());
  const std::string_view seconds = text.substr(0, point);
  const std::string_view fraction = text.substr(std::min(point + 1, text.size()));
  if (!is_digits(seconds) && !is_digits(fraction)) return std::nullopt;
  if (!(seconds.empty() || is_digits(seconds)) || !(fraction.empty() || is_digits(fraction)))
    return std::nullopt;
  const auto count = seconds.empty() ? std::optional<std::int64_t>(0) : io::whole<std::int64_t>(seconds);
  if (!count) return std::nullopt;
  const std::optional<Stamp> stamp = stamp_of(*count, fraction_ns(fraction));
  return stamp && negative ? Stamp{-stamp->ns} : stamp;
}

/// "2011-09-26 13:02:25.964389445", UTC.
std::optional<Stamp> date(std::string_view text) {
  constexpr std::string_view kForm = "0000-00-00 00:00:00";
  if (text.size() < kForm.size()) return std::nullopt;
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    const bool fits =
        kForm[i] == '0' ? io::is_digit(text[i]) : text[i] == kForm[i] || (kForm[i] == ' ' && text[i] == 'T');
    if (!fits) return std::nullopt;
  }
  const std::string_view fraction = text.substr(kForm.size());
  if (!fraction.empty() && (fraction.front() != '.' || !is_digits(fraction.substr(1)))) return std::nullopt;
  const auto number = [&](std::size_t at, std::size_t length) {
    return io::whole<unsigned>(text.substr(at, length)).value_or(0);
  };
  const std::chrono::year_month_day day{std::chrono::year(static_cast<int>(number(0, 4))),
                                        std::chrono::month(number(5, 2)), std::chrono::day(number(8, 2))};
  if (!day.ok() || number(11, 2) > 23 || number(14, 2) > 59 || number(17, 2) > 60) return std::nullopt;
  const std::int64_t days = std::chrono::sys_days(day).time_since_epoch().count();
  const std::int64_t seconds = ((days * 24 + number(11, 2)) * 60 + number(14, 2)) * 60 + number(17, 2);
  return stamp_of(seconds, fraction.empty() ? 0 : fraction_ns(fraction.substr(1)));
}

[[noreturn]] void refuse(const fs::path& path, const io::TextLine& line, std::string_view found) {
  throw Error(io::place(path, line.number) + ": found " + io::quoted(found) +
              ", expected a stamp: a whole number of ns, or s with a decimal point");
}

[[noreturn]] void refuse_count(const fs::path& path, std::size_t stamps, std::size_t frames) {
  throw Error(path.string() + ": has " + std::to_string(stamps) + " stamps, expected one for each of the " +
              std::to_string(frames) + " frames");
}

}  // namespace

std::optional<Stamp> parse_seconds(std::string_view text) {
  if (const std::optional<Stamp> stamp = decimal(text)) return stamp;
  const std::optional<double> seconds = io::whole<double>(text);
  if (!seconds || !(std::abs(*seconds) * static_cast<double>(kNsPerSecond) < static_cast<double>(kMaxNs)))
    return std::nullopt;
  return Stamp{std::llround(*seconds * static_cast<double>(kNsPerSecond))};
}

std::optional<Stamp> parse_stamp(std::string_view text) {
  if (const std::optional<std::int64_t> ns = io::whole<std::int64_t>(text)) {
    if (*ns > kMaxNs || *ns < -kMaxNs) return std::nullopt;
    return Stamp{*ns};
  }
  if (is_digits(text)) return std::nullopt;
  if (const std::optional<Stamp> stamp = parse_seconds(text)) return stamp;
  return date(text);
}

std::string stamp_text(Stamp stamp) {
  std::string text = seconds_text(stamp);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text + " s";
}

std::vector<Stamp> load_stamps(const fs::path& path) {
  const std::string text = io::read_file(path, io::kMaxLogBytes);
  std::vector<Stamp> stamps;
  // One line with a decimal point means that all are seconds: "5" before "5.1" is not 5 ns.
  const std::vector<io::TextLine> lines = io::lines_of(text);
  const bool in_seconds =
      std::ranges::all_of(lines, [](const io::TextLine& line) { return decimal(line.text).has_value(); }) &&
      std::ranges::any_of(
          lines, [](const io::TextLine& line) { return line.text.find('.') != std::string_view::npos; });
  for (const io::TextLine& line : lines) {
    const std::optional<Stamp> stamp = in_seconds ? parse_seconds(line.text) : parse_stamp(line.text);
    if (!stamp) refuse(path, line, line.text);
    stamps.push_back(*stamp);
  }
  return stamps;
}

std::vector<NamedStamp> load_named_stamps(const fs::path& path) {
  const std::string text = io::read_file(path, io::kMaxLogBytes);
  std::vector<NamedStamp> stamps;
  for (const io::TextLine& line : io::lines_of(text)) {
    const std::vector<std::string_view> fields = io::fields_of(line.text);
    const std::optional<std::int64_t> ns = io::whole<std::int64_t>(fields.front());
    if (!ns) {
      const bool is_seconds = parse_seconds(fields.front()).has_value();
      throw Error(io::place(path, line.number) + ": found " + io::quoted(fields.front()) +
                  ", expected a stamp in whole ns" + (is_seconds ? "; these are s" : ""));
    }
    std::string file(fields.size() > 1 ? fields[1] : "");
    if (file.empty()) file = std::string(fields.front()) + ".png";
    stamps.push_back({Stamp{std::clamp(*ns, -kMaxNs, kMaxNs)}, std::move(file)});
  }
  return stamps;
}

std::optional<std::vector<FrameStamp>> load_frame_stamps(const fs::path& path) {
  const std::string text = io::read_file(path, io::kMaxLogBytes);
  const std::vector<io::TextLine> lines = io::lines_of(text);
  if (lines.empty()) return std::nullopt;
  const std::vector<std::string_view> header = io::fields_of(lines.front().text);
  const auto time = static_cast<std::size_t>(std::find(header.begin(), header.end(), "t_s") - header.begin());
  const auto frame =
      static_cast<std::size_t>(std::find(header.begin(), header.end(), "frame") - header.begin());
  if (time == header.size()) return std::nullopt;
  std::vector<FrameStamp> stamps;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string_view> fields = io::fields_of(lines[i].text);
    const std::string_view field = time < fields.size() ? fields[time] : std::string_view{};
    const std::optional<Stamp> stamp = parse_seconds(field);
    if (!stamp)
      throw Error(io::place(path, lines[i].number) + ": found " + io::quoted(field) + " as t_s, expected s");
    stamps.push_back({{}, *stamp});
    if (frame < fields.size()) stamps.back().frame = io::whole<std::size_t>(fields[frame]);
  }
  return stamps;
}

std::vector<Stamp> stamps_by_line(const fs::path& path, const std::vector<std::string>& names) {
  std::vector<Stamp> all = load_stamps(path);
  if (all.size() == names.size()) return all;
  std::vector<Stamp> some;
  for (const std::string& name : names) {
    const std::optional<std::size_t> number = io::whole<std::size_t>(name);
    if (!number || *number >= all.size()) refuse_count(path, all.size(), names.size());
    some.push_back(all[*number]);
  }
  return some;
}

std::vector<Stamp> stamps_by_frame(const fs::path& path, const std::vector<FrameStamp>& rows,
                                   const std::vector<std::string>& names) {
  std::map<std::size_t, Stamp> by_frame;
  for (const FrameStamp& row : rows) {
    if (row.frame) by_frame[*row.frame] = row.stamp;
  }
  std::vector<Stamp> stamps;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto found = by_frame.find(io::whole<std::size_t>(names[i]).value_or(i));
    if (found != by_frame.end()) stamps.push_back(found->second);
  }
  if (stamps.size() == names.size()) return stamps;
  if (rows.size() != names.size()) refuse_count(path, rows.size(), names.size());
  stamps.clear();
  for (const FrameStamp& row : rows) stamps.push_back(row.stamp);
  return stamps;
}

void check_unit(std::span<const Stamp> stamps, const std::string& where) {
  constexpr std::int64_t kShortestStepNs = 1000;
  std::int64_t longest = 0;
  for (std::size_t i = 1; i < stamps.size(); ++i)
    longest = std::max<std::int64_t>(longest, std::llabs(stamps[i].ns - stamps[i - 1].ns));
  if (longest > 0 && longest < kShortestStepNs) {
    throw Error(where + ": all stamps are less than 1 us apart (" + std::to_string(stamps[0].ns) + " ns, " +
                std::to_string(stamps[1].ns) + " ns), expected ns; write s with a decimal point");
  }
}

void check_rising(std::span<const Stamp> stamps, std::span<const std::string> names,
                  const std::string& where) {
  check_unit(stamps, where);
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    if (stamps[i] > stamps[i - 1]) continue;
    throw Error(where + ": frame " + names[i] + " has the stamp " + stamp_text(stamps[i]) +
                ", expected one later than the " + stamp_text(stamps[i - 1]) + " of frame " + names[i - 1]);
  }
}

StampPairs pair_by_stamps(std::span<const Stamp> left, std::span<const Stamp> right, double max_skew_ms) {
  StampPairs found;
  using Pairing = StampPairing<std::size_t>;
  Pairing pairing(max_skew_ms, [&](std::size_t side, Pairing::WaitingItem&& alone) {
    (side == 0 ? found.left_alone : found.right_alone).push_back(alone.value);
  });
  const std::array all{left, right};
  std::array<std::size_t, 2> read{};
  // One by one, so that neither side is beyond a clock set back before the other one.
  const auto reading_on = [&](std::size_t side, std::size_t count) {
    for (std::size_t& i = read[side]; pairing.waiting(side).size() < count && i < all[side].size(); ++i)
      pairing.push(side, all[side][i], i);
    return pairing.waiting(side).size() >= count;
  };
  while (const auto pair = pairing.next(reading_on))
    found.pairs.push_back({pair->left.value, pair->right.value});
  pairing.leave_all(reading_on);
  std::ranges::sort(found.left_alone);
  std::ranges::sort(found.right_alone);
  return found;
}

}  // namespace cairn
