// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/stereo/epipolar_correction.hpp>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

/// Text for the terminal: numbers, tables, progress.
namespace cairn::cli {

/// printf's format for one number; "-" for NaN.
std::string text_of(const char* format, double value);
/// "62.1 %" of 0.621; "-" for NaN.
std::string percent(double share);
/// "1 frame", "3 frames".
std::string count_of(std::size_t count, const std::string& noun);

/// The last part of a path, with or without a trailing slash: "frames" of "data/frames/".
std::string name_of(const std::filesystem::path& path);

/// The outcome of the epipolar correction, in words; "" if it is off.
std::string describe(const EpipolarOffset& epipolar);

/// Columns of text for the terminal: the first left-aligned, the others right-aligned; empty columns are left
/// out.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : rows_{std::move(header)} {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  [[nodiscard]] std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// The skipped frames of a folder run, whose files are unusable. The others are processed.
class SkippedFiles {
 public:
  /// Also prints a line on stderr.
  void add(const std::string& frame, const std::string& why);
  [[nodiscard]] const std::vector<std::string>& frames() const { return frames_; }
  /// 0; 2 if frames were skipped, with their number on stderr.
  [[nodiscard]] int exit_code(std::size_t frames_in_all) const;

 private:
  std::vector<std::string> frames_;
};

/// The progress of a folder run, on stderr if that is a terminal; else silent.
class Progress {
 public:
  explicit Progress(std::size_t count);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  void at(std::size_t index, const std::string& name) const;
  /// A bar of which `share` (0 … 1) is filled, followed by words; also for a single frame.
  void bar(double share, const std::string& words) const;
  /// Removes the bar before other output.
  void clear() const;

 private:
  std::size_t count_;
  bool shown_;
};

}  // namespace cairn::cli
