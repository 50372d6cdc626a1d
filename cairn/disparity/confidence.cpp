// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <bit>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/confidence.hpp>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 48;  // rows; each range first sums a whole window's height
constexpr int kRadius = kConfidenceWindow / 2;
constexpr float kJump = 1.0F;        // px
constexpr float kLeastMean = 1e-6F;  // keeps costs that are all 0 from dividing by it
constexpr float kGreatestExponent = 30.0F;

/// Two counts in one number, holes in the low byte and jumps in the high one: a whole window's fit.
using Counts = std::uint16_t;
constexpr Counts kHole = 1;
constexpr Counts kIsJump = 256;
static_assert(kConfidenceWindow * kConfidenceWindow < 256);

/// The last row is its own neighbour below, and so is the last pixel of a row to the right: no jump.
void mark_row(const float* here, const float* below, int width, Counts* marks) {
  const auto mark = [&](int x, int right) {
    const float d = here[x];
    // NaN differs from nothing by more than anything. Both are compared always: a branch would keep the loop
    // from becoming vector code.
    const int along = std::abs(d - here[right]) > kJump ? kIsJump : 0;
    const int down = std::abs(d - below[x]) > kJump ? kIsJump : 0;
    return static_cast<Counts>((std::isnan(d) ? kHole : 0) | along | down);
  };
  for (int x = 0; x + 1 < width; ++x) marks[x] = mark(x, x + 1);
  marks[width - 1] = mark(width - 1, width - 1);
}

Image<Counts> mark(View<const float> disparity_px, const Exec& exec) {
  const int height = disparity_px.height();
  Image<Counts> marks(disparity_px.size(), exec.pool);
  parallel_for(exec, height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      mark_row(disparity_px.row(y), disparity_px.row(std::min(y + 1, height - 1)), disparity_px.width(),
               marks.row(y));
    }
  });
  return marks;
}

/// How many of p − kRadius … p + kRadius lie inside 0 … length − 1.
int inside(int p, int length) {
  return std::min(p + kRadius, length - 1) - std::max(p - kRadius, 0) + 1;
}

/// Counts around each pixel, for rows from the top down.
class WindowCounts {
 public:
  WindowCounts(View<const Counts> marks, int first_row)
      : marks_(marks),
        row_(first_row),
        columns_(static_cast<std::size_t>(marks.width())),
        prefix_(static_cast<std::size_t>(marks.width() + kConfidenceWindow)),
        inverse_area_(static_cast<std::size_t>(marks.width())) {
    for (int y = first_row - kRadius; y < first_row + kRadius; ++y) add(y, 1);
  }

  void next_row() {
    add(row_ + kRadius, 1);
    sum_along();
    if (const int rows = inside(row_, marks_.height()); rows != rows_) measure_areas(rows);
    add(row_ - kRadius, -1);
    ++row_;
  }

  /// The counts of the window around x are prefix()[x + kConfidenceWindow] − prefix()[x], modulo 2¹⁶.
  [[nodiscard]] const Counts* prefix() const { return prefix_.data(); }
  [[nodiscard]] const float* inverse_area() const { return inverse_area_.data(); }

 private:
  void add(int y, int sign) {
    if (y < 0 || y >= marks_.height()) return;
    const Counts* row = marks_.row(y);
    Counts* const columns = columns_.data();
    for (int x = 0; x < marks_.width(); ++x) columns[x] = static_cast<Counts>(columns[x] + sign * row[x]);
  }

  void sum_along() {
    Counts sum = 0;
    Counts* const out = prefix_.data() + kRadius + 1;  // before it stay zeros
    const int width = marks_.width();
    for (int x = 0; x < width; ++x)
      out[x] = sum = static_cast<Counts>(sum + columns_[static_cast<std::size_t>(x)]);
    std::fill_n(out + width, kRadius, sum);
  }

  void measure_areas(int rows) {
    rows_ = rows;
    for (int x = 0; x < marks_.width(); ++x) {
      inverse_area_[static_cast<std::size_t>(x)] =
          1.0F / static_cast<float>(rows * inside(x, marks_.width()));
    }
  }

  View<const Counts> marks_;
  int row_;
  int rows_ = 0;  // of the window, inside the image
  std::vector<Counts> columns_;
  std::vector<Counts> prefix_;
  std::vector<float> inverse_area_;
};

/// 2^t for |t| ≤ kGreatestExponent, to 2·10⁻⁷ of it; in arithmetic that is the same everywhere, as no
/// library's is.
float power_of_two(float t) {
  constexpr int kOffset = 64;
  const int whole = static_cast<int>(t + kOffset) - kOffset;
  const float f = t - static_cast<float>(whole);
  const float fraction =
      1.0F + f * (0.6931514F + f * (0.2401641F + f * (0.0558005F + f * (0.00901663F + f * 0.00186721F))));
  return std::bit_cast<float>((whole + 127) << 23) * fraction;
}

float logistic(float log_odds) {
  constexpr float kLog2OfE = 1.44269504F;
  // In this order of arguments NaN, which pixels without a match have, is held at the bound, too.
  const float exponent = std::max(-kGreatestExponent, std::min(kGreatestExponent, -kLog2OfE * log_odds));
  return 1.0F / (1.0F + power_of_two(exponent));
}

struct CostRows {
  const float* cost;
  const float* runner_up;
  const float* mean;
};

void judge_row(const CostRows& costs, const float* disparity_px, const Counts* prefix,
               const float* inverse_area, int width, const ConfidenceModel& model, float* out) {
  for (int x = 0; x < width; ++x) {
    const float inverse_mean = 1.0F / std::max(costs.mean[x], kLeastMean);
    const float margin = std::min((costs.runner_up[x] - costs.cost[x]) * inverse_mean, 1.0F);
    const float cost = std::min(costs.cost[x] * inverse_mean, 1.0F);
    const int counts = static_cast<Counts>(prefix[x + kConfidenceWindow] - prefix[x]);
    const float jumps = std::sqrt(static_cast<float>(counts >> 8) * inverse_area[x]);
    const float holes = std::sqrt(static_cast<float>(counts & 255) * inverse_area[x]);
    const float log_odds =
        model.bias + model.margin * margin + model.cost * cost + model.jumps * jumps + model.holes * holes;
    const float confidence = logistic(log_odds);
    out[x] = std::isnan(disparity_px[x]) ? 0.0F : confidence;
  }
}

}  // namespace

Image<float> estimate_confidence(const Matches& matches, const DisparityMap& disparity,
                                 const ConfidenceModel& model, const ConfidenceConfig& config,
                                 const Exec& exec) {
  if (!config.enabled || matches.runner_up.empty() || matches.mean_cost.empty()) return {};
  const View<const float> disparity_px = disparity.disparity_px;
  const Size size = disparity_px.size();
  assert(matches.runner_up.size() == size && matches.mean_cost.size() == size);
  const Image<Counts> marks = mark(disparity_px, exec);
  Image<float> confidence(size, exec.pool);
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    WindowCounts counts(marks, first);
    for (int y = first; y < last; ++y) {
      counts.next_row();
      judge_row({matches.cost.row(y), matches.runner_up.row(y), matches.mean_cost.row(y)},
                disparity_px.row(y), counts.prefix(), counts.inverse_area(), size.width, model,
                confidence.row(y));
    }
  });
  return confidence;
}

}  // namespace cairn
