// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/image/sparse_points.hpp>
#include <cairn/stereo/epipolar_correction.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <vector>

namespace cairn {
namespace {
using sparse::cubic;
using sparse::halved;
using sparse::kWindow;
using sparse::kWindowArea;
using sparse::Place;
using sparse::refine;

// Lengths are pixels of the halved images, unless the name says rows or px: then of the full images.
constexpr float kRivalRatio = 1.25F;  // times the lowest cost: the least in rows more than one away
constexpr float kAgreeRows = 0.5F;
constexpr int kMinPoints = 16;
constexpr std::size_t kMinPointsForRoll = 24;
constexpr std::size_t kMaxPoints = 60;
constexpr float kCertain = 4.0F;  // standard errors

/// Zero-mean sum of squared differences of two windows (ZSSD), times their area.
int difference(View<const Gray> left, Point a, View<const Gray> right, Point b) {
  int sum = 0;
  int squares = 0;
  for (int y = 0; y < kWindow; ++y) {
    const Gray* l = left.row(a.y + y) + a.x;
    const Gray* r = right.row(b.y + y) + b.x;
    for (int x = 0; x < kWindow; ++x) {
      const auto step = static_cast<std::int16_t>(l[x] - r[x]);
      sum += step;
      squares += step * step;
    }
  }
  return kWindowArea * squares - sum * sum;
}

struct Search {
  int first_px = 0;  // disparities
  int last_px = 0;
  int rows = 0;  // in each direction
};

struct Candidate {
  Point at;
  int cost = std::numeric_limits<int>::max();
};

/// The most similar window; nullopt if there is none, or a window in more distant rows is nearly as similar.
std::optional<Candidate> find(View<const Gray> left, Point p, View<const Gray> right, const Search& search) {
  std::vector<Candidate> best_of_row;
  for (int y = p.y - search.rows; y <= p.y + search.rows; ++y) {
    Candidate best;
    if (y >= 0 && y + kWindow <= right.height()) {
      const int last = std::min(p.x - search.first_px, right.width() - kWindow);
      for (int x = std::max(p.x - search.last_px, 0); x <= last; ++x) {
        if (const int cost = difference(left, p, right, {x, y}); cost < best.cost) best = {{x, y}, cost};
      }
    }
    best_of_row.push_back(best);
  }
  const auto less = [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; };
  const Candidate best = *std::min_element(best_of_row.begin(), best_of_row.end(), less);
  if (best.cost == std::numeric_limits<int>::max()) return std::nullopt;
  for (const Candidate& other : best_of_row) {
    const bool near = std::abs(other.at.y - best.at.y) <= 1;
    const bool rivals = other.cost == best.cost ||  // also where both are 0
                        static_cast<float>(other.cost) < kRivalRatio * static_cast<float>(best.cost);
    if (!near && rivals) return std::nullopt;
  }
  return best;
}

/// A matched point: column in the right image, and row difference.
struct Sighting {
  float x_px = 0;
  float rows = 0;
};

/// A pair at full and at half size.
struct Pyramid {
  View<const Gray> left;
  View<const Gray> right;
  View<const Gray> left_half;
  View<const Gray> right_half;
};

/// Finds `p` at half size and refines the centre of its window at full size, where subpixel positions are
/// more accurate. Both are interpolated as in shift_rows().
std::optional<Sighting> sight(const Pyramid& pyramid, Point p, const Search& search) {
  const auto match = find(pyramid.left_half, p, pyramid.right_half, search);
  if (!match) return std::nullopt;
  const Place start{static_cast<float>(match->at.x), static_cast<float>(match->at.y)};
  const auto coarse = refine(pyramid.left_half, p, pyramid.right_half, start);
  if (!coarse) return std::nullopt;
  constexpr int kMiddle = kWindow / 2;
  const Point full{2 * p.x + kMiddle, 2 * p.y + kMiddle};
  const auto fine =
      refine(pyramid.left, full, pyramid.right, {2 * coarse->x + kMiddle, 2 * coarse->y + kMiddle});
  if (!fine) return std::nullopt;
  return Sighting{fine->x + 0.5F * (kWindow - 1), fine->y - static_cast<float>(full.y)};
}

std::vector<Sighting> sight_all(const Pyramid& pyramid, const Search& search, const Exec& exec) {
  const std::vector<Point> points = sparse::textured_points(pyramid.left_half, kMaxPoints, exec);
  std::vector<std::optional<Sighting>> found(points.size());
  parallel_for(exec, static_cast<int>(points.size()), 16, [&](int first, int last) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      found[i] = sight(pyramid, points[i], search);
    }
  });
  std::vector<Sighting> sightings;
  for (const auto& sighting : found) {
    if (sighting) sightings.push_back(*sighting);
  }
  return sightings;
}

// ---- fitting a line to the sightings ----

float median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Line {
  float rows = 0;  // at column `middle_px`
  float slope = 0;
  float middle_px = 0;
  [[nodiscard]] float at(float x_px) const { return rows + slope * (x_px - middle_px); }
};

std::vector<Sighting> within(const std::vector<Sighting>& all, const Line& line, float rows) {
  std::vector<Sighting> near;
  for (const Sighting& s : all) {
    if (std::abs(s.rows - line.at(s.x_px)) <= rows) near.push_back(s);
  }
  return near;
}

/// A robust line: tolerates a quarter of outliers. Slopes are those of pairs half of the sightings apart
/// (Theil 1950, Sen 1968).
Line line_by_medians(std::vector<Sighting> all, float middle_px) {
  std::stable_sort(all.begin(), all.end(),
                   [](const Sighting& a, const Sighting& b) { return a.x_px < b.x_px; });
  const std::size_t half = all.size() / 2;
  std::vector<float> slopes;
  for (std::size_t i = 0; i < half; ++i) {
    const float apart = all[i + half].x_px - all[i].x_px;
    if (apart > 0) slopes.push_back((all[i + half].rows - all[i].rows) / apart);
  }
  Line line{0, slopes.empty() ? 0.0F : median(slopes), middle_px};
  std::vector<float> rows;
  rows.reserve(all.size());
  for (const Sighting& s : all) rows.push_back(s.rows - line.slope * (s.x_px - middle_px));
  line.rows = median(rows);
  return line;
}

/// The least-squares line; level unless its slope is significant and visibly moves the image's ends.
Line line_by_squares(const std::vector<Sighting>& all, float middle_px) {
  const auto count = static_cast<double>(all.size());
  double mean_x = 0;
  double mean_rows = 0;
  for (const Sighting& s : all) {
    mean_x += static_cast<double>(s.x_px) / count;
    mean_rows += static_cast<double>(s.rows) / count;
  }
  double xx = 0;
  double xr = 0;
  double rr = 0;
  for (const Sighting& s : all) {
    const double x = static_cast<double>(s.x_px) - mean_x;
    const double rows = static_cast<double>(s.rows) - mean_rows;
    xx += x * x;
    xr += x * rows;
    rr += rows * rows;
  }
  const double slope = xx > 0 ? xr / xx : 0;
  const double error = xx > 0 ? std::sqrt(std::max(0.0, rr - slope * xr) / (count * xx)) : 0;
  const bool certain =
      all.size() >= kMinPointsForRoll && std::abs(slope) > static_cast<double>(kCertain) * error &&
      std::abs(slope) * static_cast<double>(middle_px) > static_cast<double>(kEpipolarLeastRows);
  if (!certain) return {static_cast<float>(mean_rows), 0, middle_px};
  return {static_cast<float>(mean_rows + slope * (static_cast<double>(middle_px) - mean_x)),
          static_cast<float>(slope), middle_px};
}

EpipolarOffset judge(const std::vector<Sighting>& all, float max_rows, int width) {
  EpipolarOffset offset;
  offset.points = static_cast<int>(all.size());
  offset.outcome = EpipolarOutcome::few_points;
  if (offset.points < kMinPoints) return offset;

  const float middle_px = 0.5F * static_cast<float>(width - 1);
  Line line = line_by_medians(all, middle_px);
  for (int i = 0; i < 2; ++i) {
    const std::vector<Sighting> agreeing = within(all, line, kAgreeRows);
    if (!agreeing.empty()) line = line_by_squares(agreeing, middle_px);
  }
  offset.agreeing = static_cast<int>(within(all, line, kAgreeRows).size());
  const float ends = std::abs(line.slope) * middle_px;
  offset.outcome = EpipolarOutcome::no_agreement;
  if (offset.agreeing < kMinPoints || 2 * offset.agreeing < offset.points) return offset;
  if (std::abs(line.rows) + ends > max_rows + kAgreeRows) return offset;

  offset.rows = line.rows;
  offset.rows_per_px = line.slope;
  offset.outcome =
      std::abs(line.rows) + ends < kEpipolarLeastRows ? EpipolarOutcome::aligned : EpipolarOutcome::corrected;
  return offset;
}

// ---- shifting rows ----

constexpr int kSteps = 64;    // per row
constexpr int kWeights = 64;  // sum of the four weights: 16 bits hold every weighted sum

using Taps = std::array<std::vector<std::int16_t>, 4>;

/// The columns first … last − 1 interpolate from the same rows.
struct Run {
  int first = 0;
  int last = 0;
  int row = 0;  // of the second of the four rows, minus y
};

std::array<std::int16_t, 4> whole_weights(int step) {
  const std::array<float, 4> w = cubic(static_cast<float>(step) / kSteps);
  const auto whole = [](float weight) { return static_cast<std::int16_t>(std::lround(kWeights * weight)); };
  const int others = whole(w[0]) + whole(w[2]) + whole(w[3]);
  return {whole(w[0]), static_cast<std::int16_t>(kWeights - others), whole(w[2]), whole(w[3])};
}

/// A short loop over local copies, so that compilers vectorise it.
void blend(const std::array<const Gray*, 4>& rows, const Taps& taps, Run run, Gray* out) {
  const Gray* r0 = rows[0];
  const Gray* r1 = rows[1];
  const Gray* r2 = rows[2];
  const Gray* r3 = rows[3];
  const std::int16_t* w0 = taps[0].data();
  const std::int16_t* w1 = taps[1].data();
  const std::int16_t* w2 = taps[2].data();
  const std::int16_t* w3 = taps[3].data();
  constexpr std::int16_t kBlack = 0;
  constexpr std::int16_t kWhite = 255;
  const int last = run.last;
  for (int x = run.first; x < last; ++x) {
    const auto a = static_cast<std::int16_t>(w0[x] * r0[x] + w1[x] * r1[x]);
    const auto b = static_cast<std::int16_t>(w2[x] * r2[x] + w3[x] * r3[x]);
    const auto grey = static_cast<std::int16_t>(static_cast<std::int16_t>(a + b + kWeights / 2) >> 6);
    out[x] = static_cast<Gray>(std::clamp(grey, kBlack, kWhite));
  }
}

}  // namespace

EpipolarOffset find_epipolar_offset(const StereoPair& pair, const MatchConfig& range,
                                    const EpipolarCorrectionConfig& config, const Exec& exec) {
  if (config.max_rows < 0) return {};
  const Image<Gray> left = halved(pair.left(), exec);
  const Image<Gray> right = halved(pair.right(), exec);
  const int last = range.min_disparity + range.num_disparities - 1;
  const Search search{range.min_disparity >> 1, (last + 1) >> 1,
                      static_cast<int>(std::ceil(0.5F * config.max_rows))};
  return judge(sight_all({pair.left(), pair.right(), left, right}, search, exec), config.max_rows,
               pair.size().width);
}

Image<Gray> shift_rows(View<const Gray> right, const EpipolarOffset& offset, const Exec& exec) {
  const Size size = right.size();
  Taps taps;
  for (auto& tap : taps) tap.resize(static_cast<std::size_t>(size.width));
  std::vector<Run> runs;
  const float middle_px = 0.5F * static_cast<float>(size.width - 1);
  for (int x = 0; x < size.width; ++x) {
    const float rows = offset.rows + offset.rows_per_px * (static_cast<float>(x) - middle_px);
    const int steps = static_cast<int>(std::lround(kSteps * rows));
    const int row = steps >> 6;  // rounds down
    const auto weights = whole_weights(steps - kSteps * row);
    for (std::size_t k = 0; k < 4; ++k) taps[k][static_cast<std::size_t>(x)] = weights[k];
    if (runs.empty() || runs.back().row != row) runs.push_back({x, x, row});
    runs.back().last = x + 1;
  }
  Image<Gray> moved(size, exec.pool);
  parallel_for(exec, size.height, 32, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      for (const Run& run : runs) {
        std::array<const Gray*, 4> rows{};
        for (int k = 0; k < 4; ++k) {
          rows[static_cast<std::size_t>(k)] = right.row(std::clamp(y + run.row + k - 1, 0, size.height - 1));
        }
        blend(rows, taps, run, moved.row(y));
      }
    }
  });
  return moved;
}

EpipolarCorrection correct_epipolar(const StereoPair& pair, const MatchConfig& range,
                                    const EpipolarCorrectionConfig& config, const Exec& exec) {
  EpipolarCorrection correction{find_epipolar_offset(pair, range, config, exec), {}};
  if (correction.offset.outcome == EpipolarOutcome::corrected) {
    correction.right = shift_rows(pair.right(), correction.offset, exec);
  }
  return correction;
}

}  // namespace cairn
