// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/diagnosis/correspondences.hpp>
#include <cairn/image/sparse_points.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>

namespace cairn {
namespace {
using sparse::kWindow;
using sparse::kWindowArea;
using sparse::Place;

constexpr int kCoarseWidth = 400;  // px; greatest width of the images searched …
constexpr int kFineWidth = 1400;   // px; … and where these have too little texture
constexpr std::size_t kEnoughPoints = 100;
constexpr std::size_t kMaxPoints = 500;
constexpr float kMinAlike = 0.75F;      // least correlation of a match, −1 … 1
constexpr float kRivalRatio = 1.2F;     // least ratio of 1 − score, of a rival to the best place
constexpr float kRivalMargin = 0.005F;  // added to that bound
constexpr int kNear = 2;                // px; a place this near is no rival, and confirms the search back

/// An image for correlation: its pixels, the sum of the window at each, and the inverse of its deviation.
struct Level {
  View<const Gray> gray;
  Image<float> values;
  Image<float> sums;
  Image<float> scales;  // 0 for a uniform window
};

void sum_window(View<const Gray> image, int x, int y, float& total, float& scale) {
  int sum = 0;
  int squares = 0;
  for (int j = 0; j < kWindow; ++j) {
    const Gray* row = image.row(y + j) + x;
    for (int i = 0; i < kWindow; ++i) {
      sum += row[i];
      squares += row[i] * row[i];
    }
  }
  const int variance = kWindowArea * squares - sum * sum;
  total = static_cast<float>(sum);
  scale = variance > 0 ? 1 / std::sqrt(static_cast<float>(variance)) : 0.0F;
}

Level make_level(View<const Gray> gray, const Exec& exec) {
  const Size size = gray.size();
  const Size places{std::max(0, size.width - kWindow + 1), std::max(0, size.height - kWindow + 1)};
  Level level{gray, Image<float>(size, exec.pool), Image<float>(places, exec.pool),
              Image<float>(places, exec.pool)};
  parallel_for(exec, size.height, 16, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      std::copy_n(level.gray.row(y), size.width, level.values.row(y));
      if (y >= places.height) continue;
      for (int x = 0; x < places.width; ++x)
        sum_window(level.gray, x, y, level.sums(x, y), level.scales(x, y));
    }
  });
  return level;
}

/// Scores of all places of one search; kept to reuse the memory for the next point.
struct Scores {
  Rect places;
  std::vector<float> score;
  [[nodiscard]] float* row(int y) { return score.data() + static_cast<std::ptrdiff_t>(y) * places.width; }
  /// No neighbour has a higher score.
  [[nodiscard]] bool is_peak(int x, int y) {
    const float here = row(y)[x];
    for (int j = std::max(0, y - 1); j <= std::min(places.height - 1, y + 1); ++j) {
      for (int i = std::max(0, x - 1); i <= std::min(places.width - 1, x + 1); ++i) {
        if (row(j)[i] > here) return false;
      }
    }
    return true;
  }
};

/// Σ window · image for each place of a row: integers that float represents exactly.
void correlate_row(const Level& from, Point p, const Level& in, Rect places, int y, float* sums) {
  std::fill_n(sums, places.width, 0.0F);
  for (int j = 0; j < kWindow; ++j) {
    const float* window = from.values.row(p.y + j) + p.x;
    const float* row = in.values.row(y + j) + places.x;
    for (int i = 0; i < kWindow; ++i) {
      const float weight = window[i];
      const float* shifted = row + i;
      for (int x = 0; x < places.width; ++x) sums[x] += weight * shifted[x];
    }
  }
}

void correlate(const Level& from, Point p, const Level& in, Scores& scores) {
  const Rect places = scores.places;
  scores.score.resize(static_cast<std::size_t>(places.width) * static_cast<std::size_t>(places.height));
  const float sum = from.sums(p.x, p.y);
  const float scale = from.scales(p.x, p.y);
  for (int k = 0; k < places.height; ++k) {
    const int y = places.y + k;
    float* out = scores.row(k);
    correlate_row(from, p, in, places, y, out);
    const float* sums = in.sums.row(y) + places.x;
    const float* scales = in.scales.row(y) + places.x;
    for (int x = 0; x < places.width; ++x)
      out[x] = (kWindowArea * out[x] - sum * sums[x]) * scale * scales[x];
  }
}

/// The search area for `p`.
Rect places_around(Point p, Size size) {
  const int columns = static_cast<int>(kWidestDisparity * static_cast<float>(size.width));
  const int rows = std::max(4, static_cast<int>(kMaxRowsOff * static_cast<float>(size.height)));
  const int x0 = std::max(0, p.x - columns);
  const int y0 = std::max(0, p.y - rows);
  const int x1 = std::min(size.width - kWindow, p.x + columns);
  const int y1 = std::min(size.height - kWindow, p.y + rows);
  return {x0, y0, x1 - x0 + 1, y1 - y0 + 1};
}

/// The most similar place; nullopt if the similarity is low, or a rival is nearly as similar.
std::optional<Point> most_alike(const Level& from, Point p, const Level& in, Scores& scores) {
  scores.places = places_around(p, in.gray.size());
  correlate(from, p, in, scores);
  const auto best = std::max_element(scores.score.begin(), scores.score.end());
  if (best == scores.score.end() || *best < kMinAlike) return std::nullopt;
  const auto index = static_cast<int>(best - scores.score.begin());
  const Point at{index % scores.places.width, index / scores.places.width};
  const float rival_from = 1 - kRivalRatio * (1 - *best) - kRivalMargin;
  for (int y = 0; y < scores.places.height; ++y) {
    const float* row = scores.row(y);
    for (int x = 0; x < scores.places.width; ++x) {
      if (row[x] <= rival_from) continue;
      const bool near = std::abs(x - at.x) <= kNear && std::abs(y - at.y) <= kNear;
      if (!near && scores.is_peak(x, y)) return std::nullopt;
    }
  }
  return Point{scores.places.x + at.x, scores.places.y + at.y};
}

struct Levels {
  double mean = 0;
  double deviation = 0;
};
Levels levels_of(View<const Gray> image) {
  std::int64_t sum = 0;
  std::int64_t squares = 0;
  for (int y = 0; y < image.height(); ++y) {
    const Gray* row = image.row(y);
    for (int x = 0; x < image.width(); ++x) {
      sum += row[x];
      squares += row[x] * row[x];
    }
  }
  const auto area = static_cast<double>(image.size().area());
  const double mean = static_cast<double>(sum) / area;
  return {mean, std::sqrt(std::max(0.0, static_cast<double>(squares) / area - mean * mean))};
}

/// The image with mean and contrast of the other one; empty if its contrast is not clearly weaker.
Image<Gray> stretched(View<const Gray> image, Levels own, Levels other, const Exec& exec) {
  constexpr double kUnequal = 1.5;
  if (!(own.deviation > 0) || other.deviation < kUnequal * own.deviation) return {};
  std::array<Gray, 256> to{};
  for (std::size_t level = 0; level < to.size(); ++level) {
    const double value =
        other.mean + (static_cast<double>(level) - own.mean) * other.deviation / own.deviation;
    to[level] = static_cast<Gray>(std::clamp(std::lround(value), 0L, 255L));
  }
  Image<Gray> made(image.size(), exec.pool);
  for (int y = 0; y < image.height(); ++y)
    std::transform(image.row(y), image.row(y) + image.width(), made.row(y), [&](Gray g) { return to[g]; });
  return made;
}

/// An image pyramid, from full size to the coarsest level.
class Pyramid {
 public:
  Pyramid(View<const Gray> full, const Exec& exec) : levels_{full} {
    while (levels_.back().width() > kCoarseWidth) {
      halves_.push_back(sparse::halved(levels_.back(), exec));
      levels_.emplace_back(halves_.back().view());
    }
  }
  [[nodiscard]] std::size_t levels() const { return levels_.size(); }
  [[nodiscard]] View<const Gray> at(std::size_t level) const { return levels_[level]; }

 private:
  std::vector<Image<Gray>> halves_;
  std::vector<View<const Gray>> levels_;
};

/// Tracks a match of `p` at `start` from level `from` to full resolution. Of the result, `image` is the left
/// one.
std::optional<Correspondence> follow(const Pyramid& image, const Pyramid& other, std::size_t from, Point p,
                                     Point start) {
  constexpr int kMiddle = kWindow / 2;
  Place place{static_cast<float>(start.x), static_cast<float>(start.y)};
  for (std::size_t level = from + 1; level-- > 0;) {
    const auto found = sparse::refine(image.at(level), p, other.at(level), place);
    if (!found) return std::nullopt;
    place = *found;
    if (level == 0) break;
    p = {2 * p.x + kMiddle, 2 * p.y + kMiddle};
    place = {2 * place.x + kMiddle, 2 * place.y + kMiddle};
  }
  constexpr float kCentre = 0.5F * (kWindow - 1);
  return Correspondence{static_cast<float>(p.x) + kCentre, static_cast<float>(p.y) + kCentre,
                        place.x + kCentre, place.y + kCentre};
}

bool has_border(View<const Gray> image, Point p) {
  return p.x > 0 && p.y > 0 && p.x + kWindow < image.width() && p.y + kWindow < image.height();
}

/// Tries the window of the right image if that of the left one is lost: a sharp window is found in a blurred
/// image more reliably than the reverse.
std::optional<Correspondence> follow_either(const Pyramid& left, const Pyramid& right, std::size_t from,
                                            Point p, Point start) {
  if (const auto found = follow(left, right, from, p, start)) return found;
  if (!has_border(right.at(from), start)) return std::nullopt;
  const auto found = follow(right, left, from, start, p);
  if (!found) return std::nullopt;
  return Correspondence{found->x_right, found->y_right, found->x_left, found->y_left};
}

}  // namespace

Correspondences find_correspondences(const StereoPair& pair, const Exec& exec) {
  const Levels levels_left = levels_of(pair.left());
  const Levels levels_right = levels_of(pair.right());
  const Image<Gray> brighter_left = stretched(pair.left(), levels_left, levels_right, exec);
  const Image<Gray> brighter_right = stretched(pair.right(), levels_right, levels_left, exec);
  const Pyramid left(brighter_left.empty() ? pair.left() : brighter_left.view(), exec);
  const Pyramid right(brighter_right.empty() ? pair.right() : brighter_right.view(), exec);
  std::size_t start = left.levels() - 1;
  std::vector<Point> points = sparse::textured_points(left.at(start), kMaxPoints, exec);
  if (points.size() < kEnoughPoints && start > 0 && left.at(start - 1).width() <= kFineWidth)
    points = sparse::textured_points(left.at(--start), kMaxPoints, exec);
  const Level left_level = make_level(left.at(start), exec);
  const Level right_level = make_level(right.at(start), exec);
  std::vector<std::optional<Correspondence>> found(points.size());
  parallel_for(exec, static_cast<int>(points.size()), 8, [&](int first, int last) {
    Scores scores;
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      const auto there = most_alike(left_level, points[i], right_level, scores);
      if (!there) continue;
      const auto back = most_alike(right_level, *there, left_level, scores);
      if (!back) continue;
      const bool returns =
          std::abs(back->x - points[i].x) <= kNear && std::abs(back->y - points[i].y) <= kNear;
      if (returns) found[i] = follow_either(left, right, start, points[i], *there);
    }
  });
  Correspondences all{{}, static_cast<int>(points.size()), pair.size()};
  for (const auto& one : found) {
    if (one) all.list.push_back(*one);
  }
  return all;
}

}  // namespace cairn
