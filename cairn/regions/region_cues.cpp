// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/regions/contacts.hpp>
#include <cairn/regions/cue_kernels.hpp>
#include <cairn/regions/object_hints.hpp>
#include <cairn/regions/region_cues.hpp>
#include <cairn/regions/surfaces_behind.hpp>
#include <limits>
#include <utility>

namespace cairn {
namespace {

constexpr int kFar = 3;       // px to either side of a contact
constexpr int kMinRows = 16;  // of a band
using kernels::kNoDisparity;
using kernels::RunHeights;
using kernels::RunMoments;

/// Histogram bin of a colour difference, −255 … 255.
constexpr auto kBins = [] {
  std::array<std::uint8_t, 511> bins{};
  for (int i = 0; i < 511; ++i)
    bins.at(slot(i)) = static_cast<std::uint8_t>(std::clamp((i - 255 + 96) / 12, 0, int{kColourBins} - 1));
  return bins;
}();

/// The smallest gradient that counts as an edge, in 1/4 grey level.
float weakest_edge(float noise_sigma) {
  return 4.0F * (1.5F + 0.8F * noise_sigma);
}

constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
static_assert(kLargest / RunHeights::kMax / clamped_height(kLargest) >= clamped_height(kLargest));

/// Accumulates some rows, for gather_cues().
class CueCollector {
 public:
  /// `steps`: the disparities of the whole image, shared by all bands.
  CueCollector(const Superpixels& superpixels, const Cues& cues, Image<std::int32_t>& steps, const Exec& exec)
      : cues_(cues),
        run_(kernels::cue_kernels(exec)),
        labels_(superpixels.labels),
        edges_(superpixels.edges),
        width_(labels_.width()),
        height_(labels_.height()),
        weak_(weakest_edge(cues.left.noise_sigma)),
        steps_(steps),
        textured_(slot(width_)),
        ground_(slot(width_)),
        background_(slot(width_)),
        behind_(cues, width_, exec),
        contacts_of_(slot(superpixels.count)) {
    result_.regions.resize(slot(superpixels.count));
    if (cues.hints.empty()) return;
    for (int x = 0; x < width_; ++x) cell_column_.push_back(x * cues.hints.width() / width_);
    for (int y = 0; y < height_; ++y) cell_row_.push_back(y * cues.hints.height() / height_);
  }

  /// First the pixels of rows first … last − 1 …
  void add_pixels(int first_row, int last_row) {
    for (int y = first_row; y < last_row; ++y) {
      note_steps(y);
      const RegionId* const row = labels_.row(y);
      for (int first = 0; first < width_;) {
        int last = first + 1;
        while (last < width_ && row[last] == row[first]) ++last;
        add_run(result_.regions[index(row[first])], y, first, last);
        first = last;
      }
    }
  }

  /// … then, after all bands, their contacts.
  void add_contacts(int first_row, int last_row) {
    for_each_contact(labels_, first_row, last_row, [&](int x, int y, int dx, int dy) { meet(x, y, dx, dy); });
  }

  /// Adds the sums of the following rows.
  void add(const CueCollector& next) {
    for (std::size_t i = 0; i < result_.regions.size(); ++i) {
      // Only contacts add to the perimeter.
      const RegionCues& region = next.result_.regions[i];
      if (region.area > 0 || region.perimeter > 0) result_.regions[i].add(region, 0);
    }
    for (const ContactCues& c : next.result_.contacts) contact(c.a, c.b).add(c, false);
  }

  RegionGraphCues take() { return std::move(result_); }

 private:
  /// Converts the disparities of a row, and those of the surfaces behind it, to steps.
  void note_steps(int y) {
    constexpr float kAny = -std::numeric_limits<float>::infinity();
    behind_.note(y);
    run_.in_steps(cues_.disparity_px.row(y), kAny, width_, steps_.row(y));
    run_.in_steps(cues_.textured_px.row(y), kAny, width_, textured_.data());
    run_.in_steps(behind_.ground.data(), 0, width_, ground_.data());  // none above the horizon
    run_.in_steps(behind_.background.data(), kAny, width_, background_.data());
  }

  /// Adds the pixels first … last − 1 of row y, all of one region.
  void add_run(RegionCues& region, int y, int first, int last) const {
    const int count = last - first;
    const int v = y - height_ / 2;
    const std::int64_t u = first - width_ / 2;
    const std::int64_t steps = std::int64_t{count} * (count - 1) / 2;  // 0 + 1 + … + count − 1
    const std::int64_t x = count * u + steps;
    region.area += count;
    region.x += x;
    region.y += std::int64_t{count} * v;
    region.xx += count * u * u + 2 * u * steps + steps * (2 * count - 1) / 3;
    region.xy += x * v;
    region.yy += std::int64_t{count} * v * v;
    region.left = std::min(region.left, first);
    region.right = std::max(region.right, last - 1);
    region.top = std::min(region.top, y);
    region.bottom = y;
    region.at_image_border[0] += first == 0 ? 1 : 0;
    region.at_image_border[1] += last == width_ ? 1 : 0;
    region.at_image_border[2] += y == 0 ? count : 0;
    region.at_image_border[3] += y == height_ - 1 ? count : 0;
    std::int64_t texture = 0;
    for (int i = first; i < last; ++i) texture += edges_(i, y);
    region.texture += texture;
    if (cues_.left.rgb.empty()) {
      add_colour(region, cues_.left.gray.row(y), first, last);
    } else {
      add_colour(region, cues_.left.rgb.row(y), first, last);
    }
    if (!cues_.hints.empty()) add_hints(region, y, first, last);
    add_depth(region, y, first, last);
  }

  void add_hints(RegionCues& region, int y, int first, int last) const {
    const int row = cell_row_[slot(y)];
    const ObjectHint* const hints = cues_.hints.row(row);
    for (int x = first; x < last;) {
      const int column = cell_column_[slot(x)];
      const int begin = x;
      while (x < last && cell_column_[slot(x)] == column) ++x;
      region.hints.add(hints[column], column - cues_.hints.width() / 2, row - cues_.hints.height() / 2,
                       x - begin);
    }
  }
  [[nodiscard]] int outline_at(int x, int y) const {
    return cues_.hints(cell_column_[slot(x)], cell_row_[slot(y)]).outline;
  }

  template <class Pixel>
  static void add_colour(RegionCues& region, const Pixel* row, int first, int last) {
    std::array<std::int64_t, 3> sums{};
    std::array<std::int64_t, 3> squares{};
    for (int x = first; x < last; ++x) {
      const std::array<int, 3> colour = colour_of(row[x]);
      const std::array<std::size_t, 3> bins{slot(colour[0] / 16), kBins[slot(colour[1] + 255)],
                                            kBins[slot(colour[2] + 255)]};
      for (std::size_t i = 0; i < 3; ++i) {
        sums[i] += colour[i];
        squares[i] += colour[i] * colour[i];
        ++region.histogram[i * kColourBins + bins[i]];
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      region.colour[i] += sums[i];
      region.colour_squares[i] += squares[i];
    }
  }

  void add_depth(RegionCues& region, int y, int first, int last) const {
    const std::int32_t* const d = steps_.row(y);
    add_moments(d, y, first, last, region.matched);
    add_moments(textured_.data(), y, first, last, region.textured);
    if (cues_.ground.plane)
      add_heights(ground_, d, first, last, region.above_ground, region.textured_above_ground);
    if (!cues_.background.planes.empty())
      add_heights(background_, d, first, last, region.before_background, region.textured_before_background);
  }

  void add_moments(const std::int32_t* steps, int row, int first, int last, PlaneMoments& to) const {
    RunMoments of;
    run_.sum_moments(steps + first, first - width_ / 2, last - first, of);
    const std::int64_t y = row - height_ / 2;
    to.add({of.n, of.x, of.n * y, of.xx, of.x * y, of.n * y * y, of.d, of.xd, of.d * y, of.dd});
  }

  /// Adds the heights of a run's disparities, and of the textured ones, above the surface behind.
  void add_heights(const std::vector<std::int32_t>& behind, const std::int32_t* d, int first, int last,
                   Heights& all, Heights& textured) const {
    const auto heights = [](const RunHeights& of) {
      return Heights{of.n, of.sum, of.squares, of.behind, of.on};
    };
    for (int begin = first; begin < last; begin += RunHeights::kMax) {
      RunHeights of_all;
      RunHeights of_textured;
      run_.sum_heights(d + begin, textured_.data() + begin, behind.data() + begin,
                       std::min(RunHeights::kMax, last - begin), of_all, of_textured);
      all.add(heights(of_all));
      textured.add(heights(of_textured));
    }
  }

  ContactCues& contact(std::int32_t a, std::int32_t b) {
    std::vector<std::pair<std::int32_t, std::int32_t>>& known = contacts_of_[slot(a)];
    // From the end: the contact met last is the likeliest to be met again.
    const auto at =
        std::find_if(known.rbegin(), known.rend(), [&](const auto& met) { return met.first == b; });
    if (at != known.rend()) return result_.contacts[slot(at->second)];
    known.emplace_back(b, static_cast<std::int32_t>(result_.contacts.size()));
    result_.contacts.emplace_back();
    result_.contacts.back().a = a;
    result_.contacts.back().b = b;
    return result_.contacts.back();
  }

  /// The pixel up to kFar px from (x, y) in direction (dx, dy), within the same region.
  Point away(int x, int y, int dx, int dy) const {
    const RegionId here = labels_(x, y);
    for (int i = 0; i < kFar; ++i) {
      if (!labels_.contains(x + dx, y + dy) || labels_(x + dx, y + dy) != here) break;
      x += dx;
      y += dy;
    }
    return {x, y};
  }

  /// Adds the contact of a pixel with its right or lower neighbour of another region.
  void meet(int x, int y, int dx, int dy) {
    const std::int32_t here = number(labels_(x, y));
    const std::int32_t there = number(labels_(x + dx, y + dy));
    ContactCues& c = contact(std::min(here, there), std::max(here, there));
    const int sign = here < there ? 1 : -1;
    const int edge = std::max(edges_(x, y), edges_(x + dx, y + dy));
    ++c.length;
    if (!cues_.hints.empty()) c.outline += std::max(outline_at(x, y), outline_at(x + dx, y + dy));
    c.edge_sum += edge;
    c.weak += static_cast<float>(edge) < weak_ ? 1 : 0;
    c.x2 += 2 * (x - width_ / 2) + dx;
    c.y2 += 2 * (y - height_ / 2) + dy;
    ++result_.regions[slot(here)].perimeter;
    ++result_.regions[slot(there)].perimeter;
    const int near_here = steps_(x, y);
    const int near_there = steps_(x + dx, y + dy);
    if (near_here != kNoDisparity && near_there != kNoDisparity) {
      ++c.near_n;
      c.near_sum += sign * (near_here - near_there);
      c.near_abs += std::abs(near_here - near_there);
    }
    const Point p = away(x, y, -dx, -dy);
    const Point q = away(x + dx, y + dy, dx, dy);
    const int far_here = steps_(p.x, p.y);
    const int far_there = steps_(q.x, q.y);
    if (far_here == kNoDisparity || far_there == kNoDisparity) return;
    const int step = sign * (far_here - far_there);
    ++c.far_n;
    c.far_sum += step;
    c.far_abs += std::abs(step);
    c.nearer += step > kDisparitySteps ? 1 : 0;
    c.farther += step < -kDisparitySteps ? 1 : 0;
    c.level += std::abs(step) <= kDisparitySteps ? 1 : 0;
  }

  const Cues& cues_;
  const kernels::CueKernels& run_;
  View<const RegionId> labels_;
  View<const std::uint16_t> edges_;
  int width_;
  int height_;
  float weak_;
  Image<std::int32_t>& steps_;          // the disparities; kNoDisparity = hole
  std::vector<std::int32_t> textured_;  // the textured disparities of a row
  std::vector<std::int32_t> ground_;    // of the surfaces behind it; kNoDisparity above the horizon
  std::vector<std::int32_t> background_;
  SurfacesBehind behind_;
  std::vector<int> cell_column_;  // the column of hints for each image column
  std::vector<int> cell_row_;     // the row of hints for each image row
  // For each region a: pairs of (region b, index of the contact).
  std::vector<std::vector<std::pair<std::int32_t, std::int32_t>>> contacts_of_;
  RegionGraphCues result_;
};

}  // namespace

void PlaneMoments::add(const PlaneMoments& other) {
  n += other.n;
  x += other.x;
  y += other.y;
  xx += other.xx;
  xy += other.xy;
  yy += other.yy;
  d += other.d;
  xd += other.xd;
  yd += other.yd;
  dd += other.dd;
}

void Heights::add(const Heights& other) {
  n += other.n;
  sum += other.sum;
  squares += other.squares;
  behind += other.behind;
  on += other.on;
}

void HintSums::add(const ObjectHint& hint, int column, int row, int pixels) {
  const std::int64_t vote = std::int64_t{pixels} * std::clamp(hint.object + 32, 0, 64);
  const std::int64_t to_x = column * 8 + hint.to_x;
  const std::int64_t to_y = row * 8 + hint.to_y;
  object += std::int64_t{pixels} * hint.object;
  outline += std::int64_t{pixels} * hint.outline;
  weight += vote;
  x += vote * to_x;
  y += vote * to_y;
  xx += vote * to_x * to_x;
  yy += vote * to_y * to_y;
  size += vote * hint.size;
}

void HintSums::add(const HintSums& other) {
  object += other.object;
  outline += other.outline;
  weight += other.weight;
  x += other.x;
  y += other.y;
  xx += other.xx;
  yy += other.yy;
  size += other.size;
}

void RegionCues::add(const RegionCues& other, std::int64_t common) {
  area += other.area;
  x += other.x;
  y += other.y;
  xx += other.xx;
  xy += other.xy;
  yy += other.yy;
  left = std::min(left, other.left);
  right = std::max(right, other.right);
  top = std::min(top, other.top);
  bottom = std::max(bottom, other.bottom);
  for (std::size_t i = 0; i < at_image_border.size(); ++i) at_image_border[i] += other.at_image_border[i];
  for (std::size_t i = 0; i < colour.size(); ++i) {
    colour[i] += other.colour[i];
    colour_squares[i] += other.colour_squares[i];
  }
  for (std::size_t i = 0; i < histogram.size(); ++i) histogram[i] += other.histogram[i];
  texture += other.texture;
  hints.add(other.hints);
  perimeter += other.perimeter - 2 * common;
  matched.add(other.matched);
  textured.add(other.textured);
  above_ground.add(other.above_ground);
  textured_above_ground.add(other.textured_above_ground);
  before_background.add(other.before_background);
  textured_before_background.add(other.textured_before_background);
}

void ContactCues::add(const ContactCues& other, bool turned) {
  const int sign = turned ? -1 : 1;
  length += other.length;
  outline += other.outline;
  edge_sum += other.edge_sum;
  weak += other.weak;
  x2 += other.x2;
  y2 += other.y2;
  near_n += other.near_n;
  near_sum += sign * other.near_sum;
  near_abs += other.near_abs;
  far_n += other.far_n;
  far_sum += sign * other.far_sum;
  far_abs += other.far_abs;
  nearer += turned ? other.farther : other.nearer;
  farther += turned ? other.nearer : other.farther;
  level += other.level;
}

RegionGraphCues gather_cues(const Superpixels& superpixels, const Cues& cues, const Exec& exec) {
  const int height = superpixels.labels.height();
  const int bands = std::clamp(height / kMinRows, 1, exec.threads());
  Image<std::int32_t> steps(superpixels.labels.size(), exec.pool);
  std::vector<CueCollector> gathered;
  gathered.reserve(slot(bands));
  for (int i = 0; i < bands; ++i) gathered.emplace_back(superpixels, cues, steps, exec);
  const auto for_each_band = [&](void (CueCollector::*work)(int, int)) {
    parallel_for(exec, bands, 1, [&](int first, int last) {
      for (int i = first; i < last; ++i)
        (gathered[slot(i)].*work)(i * height / bands, (i + 1) * height / bands);
    });
  };
  for_each_band(&CueCollector::add_pixels);
  for_each_band(&CueCollector::add_contacts);
  for (std::size_t i = 1; i < gathered.size(); ++i) gathered.front().add(gathered[i]);
  return gathered.front().take();
}

}  // namespace cairn
