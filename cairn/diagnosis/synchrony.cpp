// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/diagnosis/correspondences.hpp>
#include <cairn/diagnosis/row_alignment.hpp>
#include <cairn/diagnosis/synchrony.hpp>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

namespace cairn {
namespace {

constexpr int kLeastFrames = 8;
constexpr int kBands = 16;
constexpr std::size_t kMostTried = 6;  // frames whose points are looked for in neighbours
constexpr double kLeastCorrelation = 0.6;
constexpr double kClearCorrelation = 0.2;  // above that of no lag
constexpr double kClearAgreement = 1.25;   // times that of no lag

/// Mean change of each band of rows from one picture to the next, grey levels.
using Change = std::array<double, kBands>;

Change change(View<const Gray> before, View<const Gray> after) {
  Change bands{};
  const int height = after.height();
  for (int band = 0; band < kBands; ++band) {
    const int first = band * height / kBands;
    const int last = (band + 1) * height / kBands;
    std::int64_t sum = 0;
    for (int y = first; y < last; ++y) {
      const Gray* a = before.row(y);
      const Gray* b = after.row(y);
      for (int x = 0; x < after.width(); ++x) sum += std::abs(a[x] - b[x]);
    }
    const auto area = static_cast<double>(std::max(1, last - first)) * after.width();
    bands[static_cast<std::size_t>(band)] = static_cast<double>(sum) / area;
  }
  return bands;
}

bool is_still(const Change& change) {
  return std::all_of(change.begin(), change.end(), [](double band) { return band == 0; });
}

/// Each band less its mean over time: what stays the same says nothing about when.
void remove_means(std::vector<Change>& changes) {
  for (std::size_t band = 0; band < kBands; ++band) {
    double mean = 0;
    for (const Change& one : changes) mean += one[band] / static_cast<double>(changes.size());
    for (Change& one : changes) one[band] -= mean;
  }
}

/// Of left[i] with right[i + lag].
double correlation(const std::vector<Change>& left, const std::vector<Change>& right, int lag) {
  double products = 0;
  double of_left = 0;
  double of_right = 0;
  const int count = static_cast<int>(left.size());
  for (int i = std::max(0, -lag); i < std::min(count, count - lag); ++i) {
    const Change& a = left[static_cast<std::size_t>(i)];
    const Change& b = right[static_cast<std::size_t>(i + lag)];
    for (std::size_t band = 0; band < kBands; ++band) {
      products += a[band] * b[band];
      of_left += a[band] * a[band];
      of_right += b[band] * b[band];
    }
  }
  const double scale = std::sqrt(of_left * of_right);
  return scale > 0 ? products / scale : 0.0;
}

double agreement(const StereoPair& pair, const Exec& exec) {
  const Correspondences found = find_correspondences(pair, exec);
  return found.points == 0 ? 0.0 : static_cast<double>(agreeing_ones(found).list.size()) / found.points;
}

std::size_t index(int lag) {
  return static_cast<std::size_t>(lag + Synchrony::kMostLag);
}

}  // namespace

Synchrony measure_synchrony(std::span<const StereoPair> sequence, const Exec& exec) {
  Synchrony result;
  result.frames = static_cast<int>(sequence.size());
  std::vector<Change> left;
  std::vector<Change> right;
  for (std::size_t i = 1; i < sequence.size(); ++i) {
    left.push_back(change(sequence[i - 1].left(), sequence[i].left()));
    right.push_back(change(sequence[i - 1].right(), sequence[i].right()));
    const bool left_still = is_still(left.back());
    const bool right_still = is_still(right.back());
    result.left_repeats += left_still && !right_still ? 1 : 0;
    result.right_repeats += right_still && !left_still ? 1 : 0;
  }
  if (result.frames < kLeastFrames) return result;
  remove_means(left);
  remove_means(right);
  for (int lag = -Synchrony::kMostLag; lag <= Synchrony::kMostLag; ++lag)
    result.motion[index(lag)] = correlation(left, right, lag);

  const std::size_t inner = sequence.size() - 2 * Synchrony::kMostLag;
  const std::size_t tried = std::min(kMostTried, inner);
  for (std::size_t k = 0; k < tried; ++k) {
    const std::size_t i = Synchrony::kMostLag + k * inner / tried;
    for (int lag = -Synchrony::kMostLag; lag <= Synchrony::kMostLag; ++lag) {
      const auto other = static_cast<std::size_t>(static_cast<int>(i) + lag);
      const auto pair = StereoPair::from(sequence[i].left(), sequence[other].right());
      result.agreement[index(lag)] += agreement(pair, exec) / static_cast<double>(tried);
    }
  }
  return result;
}

int Synchrony::lag() const {
  const auto best_of = [](const std::array<double, kLags>& values) {
    return static_cast<int>(std::max_element(values.begin(), values.end()) - values.begin()) - kMostLag;
  };
  const int by_motion = best_of(motion);
  if (motion[index(by_motion)] >= kLeastCorrelation &&
      motion[index(by_motion)] >= motion[index(0)] + kClearCorrelation) {
    return by_motion;
  }
  const int by_agreement = best_of(agreement);
  if (agreement[index(by_agreement)] > kClearAgreement * agreement[index(0)]) return by_agreement;
  return 0;
}

std::optional<Finding> diagnose(const Synchrony& synchrony) {
  const int lag = synchrony.lag();
  const int repeats = std::max(synchrony.left_repeats, synchrony.right_repeats);
  if (lag == 0 && repeats == 0) return std::nullopt;
  const auto share = [](double value) { return std::to_string(std::lround(100 * value)) + " %"; };
  Finding finding{FindingKind::synchrony, Severity::broken, static_cast<double>(lag), {}};
  if (lag != 0) {
    finding.says = std::string("the right camera's pictures come ") + std::to_string(std::abs(lag)) +
                   (std::abs(lag) == 1 ? " frame " : " frames ") + (lag > 0 ? "late" : "early") +
                   ": the changes in both correlate to " + share(synchrony.motion[index(lag)]) +
                   " then, and to " + share(synchrony.motion[index(0)]) + " as they are";
    return finding;
  }
  finding.severity = Severity::warning;
  finding.says = std::string("the ") +
                 (synchrony.right_repeats >= synchrony.left_repeats ? "right" : "left") +
                 " camera repeats its picture in " + std::to_string(repeats) + " of " +
                 std::to_string(synchrony.frames) + " frames while the other one's changes";
  return finding;
}

}  // namespace cairn
