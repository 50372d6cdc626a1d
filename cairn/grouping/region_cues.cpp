// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/grouping/region_cues.hpp>
#include <cmath>
#include <utility>

namespace cairn {
namespace {

constexpr int kFar = 3;  // px to either side of a contact
constexpr int kNoDisparity = std::numeric_limits<int>::min();
constexpr int kLeastHeight = -8 * kDisparitySteps;
constexpr int kMostHeight = 24 * kDisparitySteps;

int in_steps(float px) {
  if (std::isnan(px)) return kNoDisparity;
  return static_cast<int>(std::floor(px * kDisparitySteps + 0.5F));
}

/// What a picture's gradient must reach to be an edge, in 1/4 grey level.
float weakest_edge(float noise_sigma) {
  return 4.0F * (1.5F + 0.8F * noise_sigma);
}

class Gathering {
 public:
  Gathering(const Superpixels& superpixels, const Cues& cues)
      : cues_(cues),
        labels_(superpixels.labels),
        edges_(superpixels.edges),
        width_(labels_.width()),
        height_(labels_.height()),
        weak_(weakest_edge(cues.noise_sigma)),
        contacts_of_(slot(superpixels.count)) {
    result_.regions.resize(slot(superpixels.count));
  }

  RegionGraphCues run() {
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        add_pixel(x, y);
        if (x + 1 < width_) meet(x, y, 1, 0);
        if (y + 1 < height_) meet(x, y, 0, 1);
      }
    }
    return std::move(result_);
  }

 private:
  void add_pixel(int x, int y) {
    RegionCues& region = result_.regions[index(labels_(x, y))];
    const int u = x - width_ / 2;
    const int v = y - height_ / 2;
    ++region.area;
    region.x += u;
    region.y += v;
    region.xx += std::int64_t{u} * u;
    region.xy += std::int64_t{u} * v;
    region.yy += std::int64_t{v} * v;
    region.left = std::min(region.left, x);
    region.right = std::max(region.right, x);
    region.top = std::min(region.top, y);
    region.bottom = y;
    region.at_image_border[0] += x == 0 ? 1 : 0;
    region.at_image_border[1] += x == width_ - 1 ? 1 : 0;
    region.at_image_border[2] += y == 0 ? 1 : 0;
    region.at_image_border[3] += y == height_ - 1 ? 1 : 0;
    region.texture += edges_(x, y);
    add_colour(region, x, y);
    add_depth(region, x, y, u, v);
  }

  void add_colour(RegionCues& region, int x, int y) const {
    std::array<int, 3> colour{cues_.gray(x, y), 0, 0};
    if (!cues_.rgb.empty()) {
      const Rgb p = cues_.rgb(x, y);
      colour = {(p.r + 2 * p.g + p.b) / 4, p.b - p.g, p.r - p.g};
    }
    for (std::size_t i = 0; i < 3; ++i) {
      region.colour[i] += colour[i];
      region.colour_squares[i] += colour[i] * colour[i];
      const int bin = i == 0 ? colour[i] / 16 : std::clamp((colour[i] + 96) / 12, 0, int{kColourBins} - 1);
      ++region.histogram[i * kColourBins + slot(bin)];
    }
  }

  void add_depth(RegionCues& region, int x, int y, int u, int v) const {
    const int d = in_steps(cues_.disparity_px(x, y));
    const int e = in_steps(cues_.evidence_px(x, y));
    if (d == kNoDisparity && e == kNoDisparity) return;
    if (d != kNoDisparity) region.matched.add(u, v, d);
    if (e != kNoDisparity) region.textured.add(u, v, e);
    const auto fx = static_cast<float>(x);
    const auto fy = static_cast<float>(y);
    if (cues_.ground.plane) {
      const float ground = cues_.ground.plane->disparity_px(fx, fy);
      if (ground > 0) {  // below the horizon
        if (d != kNoDisparity) region.above_ground.add(d - in_steps(ground));
        if (e != kNoDisparity) region.textured_above_ground.add(e - in_steps(ground));
      }
    }
    if (!cues_.background.planes.empty()) {
      const int behind = in_steps(cues_.background.disparity_px(fx, fy));
      if (d != kNoDisparity) region.before_background.add(d - behind);
      if (e != kNoDisparity) region.textured_before_background.add(e - behind);
    }
  }

  ContactCues& contact(std::int32_t a, std::int32_t b) {
    std::vector<std::pair<std::int32_t, std::int32_t>>& known = contacts_of_[slot(a)];
    for (const auto& [other, i] : known) {
      if (other == b) return result_.contacts[slot(i)];
    }
    known.emplace_back(b, static_cast<std::int32_t>(result_.contacts.size()));
    result_.contacts.emplace_back();
    result_.contacts.back().a = a;
    result_.contacts.back().b = b;
    return result_.contacts.back();
  }

  /// From (x, y) as far as its region goes, kFar px at most.
  Point away(int x, int y, int dx, int dy) const {
    const RegionId here = labels_(x, y);
    for (int i = 0; i < kFar; ++i) {
      if (!labels_.contains(x + dx, y + dy) || labels_(x + dx, y + dy) != here) break;
      x += dx;
      y += dy;
    }
    return {x, y};
  }

  /// The pixel with its neighbour to the right or below.
  void meet(int x, int y, int dx, int dy) {
    const std::int32_t here = number(labels_(x, y));
    const std::int32_t there = number(labels_(x + dx, y + dy));
    if (here == there) return;
    ContactCues& c = contact(std::min(here, there), std::max(here, there));
    const int sign = here < there ? 1 : -1;
    const int edge = std::max(edges_(x, y), edges_(x + dx, y + dy));
    ++c.length;
    c.edge_sum += edge;
    c.weak += static_cast<float>(edge) < weak_ ? 1 : 0;
    c.x2 += 2 * (x - width_ / 2) + dx;
    c.y2 += 2 * (y - height_ / 2) + dy;
    ++result_.regions[slot(here)].perimeter;
    ++result_.regions[slot(there)].perimeter;
    const int near_here = in_steps(cues_.disparity_px(x, y));
    const int near_there = in_steps(cues_.disparity_px(x + dx, y + dy));
    if (near_here != kNoDisparity && near_there != kNoDisparity) {
      ++c.near_n;
      c.near_sum += sign * (near_here - near_there);
      c.near_abs += std::abs(near_here - near_there);
    }
    const Point p = away(x, y, -dx, -dy);
    const Point q = away(x + dx, y + dy, dx, dy);
    const int far_here = in_steps(cues_.disparity_px(p.x, p.y));
    const int far_there = in_steps(cues_.disparity_px(q.x, q.y));
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
  View<const RegionId> labels_;
  View<const std::uint16_t> edges_;
  int width_;
  int height_;
  float weak_;
  std::vector<std::vector<std::pair<std::int32_t, std::int32_t>>> contacts_of_;  // of a: b, and which
  RegionGraphCues result_;
};

}  // namespace

void PlaneMoments::add(int at_x, int at_y, int disparity) {
  const std::int64_t px = at_x;
  const std::int64_t py = at_y;
  const std::int64_t pd = disparity;
  ++n;
  x += px;
  y += py;
  xx += px * px;
  xy += px * py;
  yy += py * py;
  d += pd;
  xd += px * pd;
  yd += py * pd;
  dd += pd * pd;
}

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

void Heights::add(int height) {
  const std::int64_t h = std::clamp(height, kLeastHeight, kMostHeight);
  ++n;
  sum += h;
  squares += h * h;
  behind += h < -kDisparitySteps ? 1 : 0;
  on += std::abs(h) <= kDisparitySteps ? 1 : 0;
}

void Heights::add(const Heights& other) {
  n += other.n;
  sum += other.sum;
  squares += other.squares;
  behind += other.behind;
  on += other.on;
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

RegionGraphCues gather_cues(const Superpixels& superpixels, const Cues& cues) {
  return Gathering(superpixels, cues).run();
}

}  // namespace cairn
