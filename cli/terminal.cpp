// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "terminal.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cmath>
#include <cstdio>
#include <iostream>

namespace cairn::cli {

namespace fs = std::filesystem;

std::string text_of(const char* format, double value) {
  if (std::isnan(value)) return "-";
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

std::string count_of(std::size_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string percent(double share) {
  return std::isnan(share) ? "-" : text_of("%.1f %%", 100 * share);
}

std::string name_of(const fs::path& path) {
  std::error_code ignored;
  const fs::path whole = fs::absolute(path, ignored).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

namespace {

/// Counts characters, not bytes: names may be UTF-8.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

}  // namespace

std::string describe(const EpipolarOffset& epipolar) {
  if (epipolar.outcome == EpipolarOutcome::off) return {};
  std::string words = "epipolar lines: " + choice_name(epipolar.outcome, kEpipolarOutcomes);
  if (epipolar.outcome == EpipolarOutcome::aligned || epipolar.outcome == EpipolarOutcome::corrected) {
    constexpr double kDegrees = 57.29577951308232;
    words += ", the right image " + text_of("%+.2f", double(epipolar.rows)) + " rows lower, roll " +
             text_of("%+.2f", std::atan(double(epipolar.rows_per_px)) * kDegrees) + " degrees";
  }
  return words + ", " + std::to_string(epipolar.agreeing) + " of " + std::to_string(epipolar.points) +
         " points agree";
}

std::string Table::text() const {
  std::vector<std::vector<std::string>> rows = rows_;
  for (auto& row : rows) {
    for (std::string& cell : row) cell = on_one_line(cell);
  }
  std::vector<std::size_t> widths(rows.front().size(), 0);
  std::vector<bool> used(rows.front().size(), false);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      widths[c] = std::max(widths[c], width_of(rows[r][c]));
      if (r > 0 && !rows[r][c].empty()) used[c] = true;
    }
  }
  std::string all;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      if (c > 0 && !used[c]) continue;
      const std::string padding(widths[c] - width_of(row[c]), ' ');
      line += c == 0 ? row[c] + padding : "  " + padding + row[c];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    all += line + '\n';
  }
  return all;
}

void SkippedFiles::add(const std::string& frame, const std::string& why) {
  std::cerr << "cairn: " << on_one_line("frame " + frame + " is skipped: " + why) << "\n";
  frames_.push_back(frame);
}

int SkippedFiles::exit_code(std::size_t frames_in_all) const {
  if (frames_.empty()) return 0;
  std::cout.flush();
  std::cerr << "cairn: " << frames_.size() << " of " << frames_in_all << " frames skipped\n";
  return 2;
}

Progress::Progress(std::size_t count) : count_(count), shown_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  clear();
}

void Progress::clear() const {
  if (shown_) std::fputs("\r\033[K", stderr);
}

void Progress::at(std::size_t index, const std::string& name) const {
  if (count_ < 2) return;
  bar(static_cast<double>(index) / static_cast<double>(count_),
      std::to_string(index + 1) + "/" + std::to_string(count_) + " " + on_one_line(name));
}

void Progress::bar(double share, const std::string& words) const {
  if (!shown_) return;
  constexpr std::size_t kWidth = 30;
  const auto done = static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * kWidth);
  std::fprintf(stderr, "\r\033[K[%s%s] %s", std::string(done, '#').c_str(),
               std::string(kWidth - done, '.').c_str(), words.c_str());
  std::fflush(stderr);
}

}  // namespace cairn::cli
