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

constexpr int kBands = 16;
constexpr std::size_t kMaxTried = 6;  // frames to match with their neighbours
constexpr double kMinCorrelation = 0.6;
constexpr double kClearCorrelation = 0.2;    // above the correlation of lag 0
constexpr double kClearAgreement = 1.25;     // times the agreement of lag 0
constexpr double kTellingCorrelation = 0.1;  // above that of any other lag: the lags are distinguishable
constexpr double kTellingAgreement = 1.1;    // times that of any other lag
constexpr double kUnexplained = 0.5;  // 1 − correlation of two lags, as a share of that of one; at most
constexpr std::size_t kMinPart = 6;   // changes; shortest part with a lag of its own

/// Mean change of each band of rows between consecutive images, in grey levels.
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

/// Each band minus its mean over time: constant changes carry no timing.
std::vector<Change> without_means(std::span<const Change> changes) {
  std::vector<Change> rest(changes.begin(), changes.end());
  for (std::size_t band = 0; band < kBands; ++band) {
    double mean = 0;
    for (const Change& one : changes) mean += one[band] / static_cast<double>(changes.size());
    for (Change& one : rest) one[band] -= mean;
  }
  return rest;
}

/// The sums of a correlation coefficient.
struct Sums {
  double products = 0;
  double of_left = 0;
  double of_right = 0;

  [[nodiscard]] double correlation() const {
    const double scale = std::sqrt(of_left * of_right);
    return scale > 0 ? products / scale : 0.0;
  }
  Sums operator+(const Sums& other) const {
    return {products + other.products, of_left + other.of_left, of_right + other.of_right};
  }
};
using SumsByLag = std::array<Sums, Synchrony::kLags>;

std::size_t index(int lag) {
  return static_cast<std::size_t>(lag + Synchrony::kMaxLag);
}

/// Over left[i] and right[i + lag].
Sums sums_of(std::span<const Change> left, std::span<const Change> right, int lag) {
  Sums sums;
  const int count = static_cast<int>(left.size());
  for (int i = std::max(0, -lag); i < std::min(count, count - lag); ++i) {
    const Change& a = left[static_cast<std::size_t>(i)];
    const Change& b = right[static_cast<std::size_t>(i + lag)];
    for (std::size_t band = 0; band < kBands; ++band) {
      sums.products += a[band] * b[band];
      sums.of_left += a[band] * a[band];
      sums.of_right += b[band] * b[band];
    }
  }
  return sums;
}

SumsByLag sums_by_lag(std::span<const Change> left, std::span<const Change> right) {
  SumsByLag sums;
  const std::vector<Change> of_left = without_means(left);
  const std::vector<Change> of_right = without_means(right);
  for (int lag = -Synchrony::kMaxLag; lag <= Synchrony::kMaxLag; ++lag)
    sums[index(lag)] = sums_of(of_left, of_right, lag);
  return sums;
}

/// Whether `lag` explains a part much better than `other`.
bool is_clear(const SumsByLag& part, int lag, int other) {
  const double correlation = part[index(lag)].correlation();
  return correlation >= kMinCorrelation &&
         correlation >= part[index(other)].correlation() + kClearCorrelation;
}

/// The best change of lag over all frames and pairs of lags; nullopt if none is clearly better than `by_one`,
/// the best correlation with one lag throughout.
std::optional<LagChange> find_change(std::span<const Change> left, std::span<const Change> right,
                                     double by_one) {
  std::optional<LagChange> best;
  // Change i is from frame i to frame i + 1; the change across the boundary belongs to neither part.
  for (std::size_t from = kMinPart + 1; from + kMinPart <= left.size(); ++from) {
    const SumsByLag first = sums_by_lag(left.first(from - 1), right.first(from - 1));
    const SumsByLag second = sums_by_lag(left.subspan(from), right.subspan(from));
    for (int before = -Synchrony::kMaxLag; before <= Synchrony::kMaxLag; ++before) {
      for (int after = -Synchrony::kMaxLag; after <= Synchrony::kMaxLag; ++after) {
        if (!is_clear(first, before, after) || !is_clear(second, after, before)) continue;
        const double both = (first[index(before)] + second[index(after)]).correlation();
        if (both < (best ? best->motion : 1 - kUnexplained * (1 - by_one))) continue;
        best = LagChange{static_cast<int>(from), before, after, both};
      }
    }
  }
  return best;
}

double agreement(const StereoPair& pair, const Exec& exec) {
  const Correspondences found = find_correspondences(pair, exec);
  return found.points == 0 ? 0.0 : static_cast<double>(agreeing_ones(found).list.size()) / found.points;
}

/// The lag with the greatest value.
int best_of(const std::array<double, Synchrony::kLags>& values) {
  return static_cast<int>(std::max_element(values.begin(), values.end()) - values.begin()) -
         Synchrony::kMaxLag;
}

/// The greatest value of another lag.
double second_of(std::array<double, Synchrony::kLags> values) {
  values[index(best_of(values))] = -1;
  return *std::max_element(values.begin(), values.end());
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
  if (result.frames < Synchrony::kMinFrames) return result;
  const SumsByLag sums = sums_by_lag(left, right);
  for (std::size_t lag = 0; lag < sums.size(); ++lag) result.motion[lag] = sums[lag].correlation();
  result.change = find_change(left, right, result.motion[index(best_of(result.motion))]);

  const std::size_t inner = sequence.size() - 2 * Synchrony::kMaxLag;
  const std::size_t tried = std::min(kMaxTried, inner);
  for (std::size_t k = 0; k < tried; ++k) {
    const std::size_t i = Synchrony::kMaxLag + k * inner / tried;
    for (int lag = -Synchrony::kMaxLag; lag <= Synchrony::kMaxLag; ++lag) {
      const auto other = static_cast<std::size_t>(static_cast<int>(i) + lag);
      const auto pair = StereoPair::from(sequence[i].left(), sequence[other].right());
      result.agreement[index(lag)] += agreement(pair, exec) / static_cast<double>(tried);
    }
  }
  return result;
}

int Synchrony::lag() const {
  const int by_motion = best_of(motion);
  if (motion[index(by_motion)] >= kMinCorrelation &&
      motion[index(by_motion)] >= motion[index(0)] + kClearCorrelation) {
    return by_motion;
  }
  const int by_agreement = best_of(agreement);
  if (agreement[index(by_agreement)] > kClearAgreement * agreement[index(0)]) return by_agreement;
  return 0;
}

bool Synchrony::tells() const {
  const double correlation = motion[index(best_of(motion))];
  if (change || (correlation >= kMinCorrelation && correlation >= second_of(motion) + kTellingCorrelation))
    return true;
  return agreement[index(best_of(agreement))] > kTellingAgreement * second_of(agreement);
}

namespace {

std::string share_text(double value) {
  return std::to_string(std::lround(100 * value)) + " %";
}

std::string frames_text(int count) {
  return std::to_string(count) + (count == 1 ? " frame" : " frames");
}

/// "come 2 frames late"
std::string lag_text(int lag) {
  return lag == 0 ? "come in step" : "come " + frames_text(std::abs(lag)) + (lag > 0 ? " late" : " early");
}

Finding out_of_step(int lag, std::string says, int first, int last) {
  Finding finding{FindingKind::synchrony, Severity::broken, static_cast<double>(lag), std::move(says)};
  for (int i = first; i < last; ++i) finding.frames.push_back(static_cast<std::size_t>(i));
  return finding;
}

Finding changed(const LagChange& change, int frames, std::span<const std::string> names) {
  const auto at = static_cast<std::size_t>(change.from);
  const std::string says = "from frame " + (at < names.size() ? names[at] : std::to_string(change.from)) +
                           " on the images of the right camera " + lag_text(change.after) +
                           ", before that they " + lag_text(change.before) +
                           ": the changes in both correlate to " + share_text(change.motion) + " then";
  if (change.after == 0) return out_of_step(change.before, says, 0, change.from);
  return out_of_step(change.after, says, change.before == 0 ? change.from : 0, frames);
}

}  // namespace

std::optional<Finding> diagnose(const Synchrony& synchrony, std::span<const std::string> names) {
  if (synchrony.change) return changed(*synchrony.change, synchrony.frames, names);
  const double as_they_are = synchrony.motion[index(0)];
  if (const int lag = synchrony.lag(); lag != 0) {
    return out_of_step(lag,
                       "the images of the right camera " + lag_text(lag) +
                           ": the changes in both correlate to " + share_text(synchrony.motion[index(lag)]) +
                           " then, and to " + share_text(as_they_are) + " as they are",
                       0, synchrony.frames);
  }
  if (const int repeats = std::max(synchrony.left_repeats, synchrony.right_repeats); repeats > 0) {
    const bool is_right = synchrony.right_repeats >= synchrony.left_repeats;
    return Finding{FindingKind::synchrony,
                   Severity::warning,
                   0,
                   std::string("the ") + (is_right ? "right" : "left") + " camera repeats its image in " +
                       std::to_string(repeats) + " of " + frames_text(synchrony.frames) +
                       " while that of the other changes",
                   {},
                   is_right ? Camera::right : Camera::left};
  }
  if (synchrony.frames < Synchrony::kMinFrames || synchrony.tells()) return std::nullopt;
  return Finding{FindingKind::unknown_synchrony, Severity::note, 100 * as_they_are,
                 "too little motion, or too even, to determine whether a camera is late: the changes in "
                 "both images correlate to " +
                     share_text(as_they_are) + " as they are, and to " +
                     share_text(std::max(synchrony.motion[index(-1)], synchrony.motion[index(1)])) +
                     " one frame apart"};
}

}  // namespace cairn
