// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/regions/region_features.hpp>
#include <cassert>
#include <cmath>
#include <utility>

namespace cairn {
namespace {

constexpr double kLevelling = 4e-4;       // damping of a plane's slopes: a spread in image widths²
constexpr std::int64_t kMinTextured = 6;  // textured disparities needed for a plane
constexpr std::int64_t kMinMatched = 12;

/// More than half of the region.
bool mostly(std::int64_t part, const RegionCues& region) {
  return 2 * part > region.area;
}

/// Collects the features in order, with their names.
struct Values {
  std::span<float> out;
  std::size_t n = 0;
  void operator()(std::string_view /*name*/, double value) { out[n++] = static_cast<float>(value); }
};
struct Names {
  std::vector<std::string_view> out;
  void operator()(std::string_view name, double /*value*/) { out.push_back(name); }
};

double share(double part, double whole) {
  return whole > 0 ? part / whole : double{kUnknown};
}
double share(std::int64_t part, std::int64_t whole) {
  return share(static_cast<double>(part), static_cast<double>(whole));
}
/// Mean of sums in 1/64 px.
double mean_px(std::int64_t sum, std::int64_t n) {
  return share(static_cast<double>(sum) / kDisparitySteps, static_cast<double>(n));
}
double known(bool ok, double value) {
  return ok ? value : double{kUnknown};
}
double root(double squares) {
  return std::sqrt(std::max(0.0, squares));
}

double mean(const RegionCues& r, std::size_t channel) {
  return static_cast<double>(r.colour[channel]) / static_cast<double>(r.area);
}
double spread(const RegionCues& r, std::size_t channel) {
  const double m = mean(r, channel);
  return root(static_cast<double>(r.colour_squares[channel]) / static_cast<double>(r.area) - m * m);
}
double brightness_difference(const RegionCues& p, const RegionCues& q) {
  return std::abs(mean(p, 0) - mean(q, 0));
}
double colour_difference(const RegionCues& p, const RegionCues& q) {
  const double blue = mean(p, 1) - mean(q, 1);
  const double red = mean(p, 2) - mean(q, 2);
  return std::sqrt(blue * blue + red * red);
}
/// χ² distance of two histograms.
template <class P, class Q>
double histogram_distance(const P& p, const Q& q) {
  const float of_p = 1.0F / static_cast<float>(p.area);
  const float of_q = 1.0F / static_cast<float>(q.area);
  float sum = 0;
  for (std::size_t i = 0; i < p.histogram.size(); ++i) {
    const float u = static_cast<float>(p.histogram[i]) * of_p;
    const float v = static_cast<float>(q.histogram[i]) * of_q;
    if (u + v > 0) sum += (u - v) * (u - v) / (u + v);
  }
  return sum;
}

/// Uses basic operations only: a library function may differ in the last bit between processors.
double log2_of(double value) {
  int exponent = 0;
  double mantissa = std::frexp(value, &exponent);  // 1/2 … 1
  if (mantissa < 0.70710678) {
    mantissa *= 2;
    --exponent;
  }
  const double t = (mantissa - 1) / (mantissa + 1);
  const double u = t * t;
  const double series = 1 + u * (1.0 / 3 + u * (1.0 / 5 + u * (1.0 / 7 + u * (1.0 / 9 + u / 11))));
  return exponent + 2 / 0.693147180559945309 * t * series;
}

double distance(double x, double y) {
  return std::sqrt(x * x + y * y);
}

HintVotes votes_of(const HintSums& h) {
  HintVotes v;
  if (h.weight < 64) return v;
  const auto w = static_cast<double>(h.weight);
  v.any = true;
  v.x = static_cast<double>(h.x) / w / 8;
  v.y = static_cast<double>(h.y) / w / 8;
  v.spread = root(static_cast<double>(h.xx + h.yy) / w / 64 - v.x * v.x - v.y * v.y);
  v.size = static_cast<double>(h.size) / w / 16;
  return v;
}

double box_area(const RegionCues& r) {
  return (r.right - r.left + 1.0) * (r.bottom - r.top + 1.0);
}
double common_box_area(const RegionCues& p, const RegionCues& q) {
  return (std::max(p.right, q.right) - std::min(p.left, q.left) + 1.0) *
         (std::max(p.bottom, q.bottom) - std::min(p.top, q.top) + 1.0);
}
std::int64_t at_image_border(const RegionCues& r) {
  return r.at_image_border[0] + r.at_image_border[1] + r.at_image_border[2] + r.at_image_border[3];
}

/// Position of the contact's middle, from the image's centre.
std::pair<double, double> middle(const ContactCues& c) {
  const auto twice = static_cast<double>(2 * c.length);
  return {static_cast<double>(c.x2) / twice, static_cast<double>(c.y2) / twice};
}

/// One kind of disparities of a region.
struct Surface {
  const PlaneMoments& moments;
  const FittedPlane& plane;
};

/// Depth of a smaller region relative to a larger one, for one kind of disparities.
template <class Out>
void depth_features(const std::array<std::string_view, 5>& names, const Surface& smaller,
                    const Surface& larger, std::int64_t least, const ContactCues& contact, int width,
                    Out& out) {
  const auto& [of_s, s] = smaller;
  const auto& [of_l, l] = larger;
  if (of_s.n < least || of_l.n < least) {
    for (const std::string_view name : names) out(name, kUnknown);
    return;
  }
  PlaneMoments both = of_s;
  both.add(of_l);
  const FittedPlane common = fit_plane(both, width);
  const auto [x, y] = middle(contact);
  out(names[0], s.at(x, y) - l.at(x, y));
  out(names[1], s.d - l.at(s.x, s.y));
  out(names[2],
      root((common.squares - s.squares - l.squares) / static_cast<double>(std::min(of_s.n, of_l.n))));
  out(names[3], root(common.squares / static_cast<double>(both.n)));
  out(names[4], (s.d - l.d) / std::max({1.0, s.d, l.d}));
}

constexpr std::array<std::string_view, 5> kMatchedNames{
    "step of the planes at the border, px", "distance of the smaller one from the other's plane, px",
    "residual added by a common plane, px", "distance from a common plane, px",
    "step of the means, relative"};
constexpr std::array<std::string_view, 5> kTexturedNames{
    "evidence: step of the planes at the border, px",
    "evidence: distance of the smaller one from the other's plane, px",
    "evidence: what a common plane is worse, px", "evidence: distance from a common plane, px",
    "evidence: step of the means, relative"};

template <class Out>
void list_merge_features(const RegionSide& a, const RegionSide& b, const ContactCues& contact,
                         const FrameCues& frame, Out& out) {
  const bool swapped = a.cues.area > b.cues.area;
  const RegionCues& s = swapped ? b.cues : a.cues;
  const RegionCues& l = swapped ? a.cues : b.cues;
  const RegionFits& fits_s = swapped ? b.fits : a.fits;
  const RegionFits& fits_l = swapped ? a.fits : b.fits;
  const double image = static_cast<double>(frame.width) * frame.height;
  const auto length = static_cast<double>(contact.length);
  const auto area_s = static_cast<double>(s.area);
  const auto area_l = static_cast<double>(l.area);
  out("border length over the root of the smaller one's area", length / std::sqrt(area_s));
  out("border length, share of the smaller one's outline", share(contact.length, s.perimeter));
  const double edge = static_cast<double>(contact.edge_sum) / length / 4;
  out("mean edge, grey levels", edge);
  out("mean edge over noise", edge / (frame.noise_sigma + 1));
  out("share of the border without an edge", share(contact.weak, contact.length));
  const double brightness = brightness_difference(s, l);
  out("difference of brightness, grey levels", brightness);
  out("difference of colour, grey levels", frame.has_colour ? colour_difference(s, l) : double{kUnknown});
  out("difference of brightness over its spread",
      brightness / (1 + frame.noise_sigma + 0.5 * (spread(s, 0) + spread(l, 0))));
  out("distance of the colours' histograms", histogram_distance(s, l));
  out("step right at the border, px", mean_px(contact.near_abs, contact.near_n));
  out("step 3 px away from it, with its sign, px",
      contact.far_n > 0 ? (swapped ? -1 : 1) * mean_px(contact.far_sum, contact.far_n) : double{kUnknown});
  out("step 3 px away from it, px", mean_px(contact.far_abs, contact.far_n));
  out("share of the border with disparities there", share(contact.far_n, contact.length));
  out("share of level disparities there", share(contact.level, contact.far_n));
  depth_features(kTexturedNames, {s.textured, fits_s.textured}, {l.textured, fits_l.textured}, kMinTextured,
                 contact, frame.width, out);
  depth_features(kMatchedNames, {s.matched, fits_s.matched}, {l.matched, fits_l.matched}, kMinMatched,
                 contact, frame.width, out);
  out("evidence, share of the smaller one", share(s.textured.n, s.area));
  out("evidence, share of the larger one", share(l.textured.n, l.area));
  out("disparities, share of the smaller one", share(s.matched.n, s.area));
  out("area of the smaller one, share of the image", area_s / image);
  out("area of the larger one, share of the image", area_l / image);
  out("height of the smaller one above the ground, px", mean_px(s.above_ground.sum, s.above_ground.n));
  out("height of the larger one above the ground, px", mean_px(l.above_ground.sum, l.above_ground.n));
  out("share of the smaller one on the ground", share(s.above_ground.on, s.above_ground.n));
  out("share of the larger one on the ground", share(l.above_ground.on, l.above_ground.n));
  out("smaller one in front of the background, px", mean_px(s.before_background.sum, s.before_background.n));
  out("larger one in front of the background, px", mean_px(l.before_background.sum, l.before_background.n));
  const double fill = (area_s + area_l) / common_box_area(s, l);
  out("fill of the union's box", fill);
  out("gain of fill by the union", fill - std::max(area_s / box_area(s), area_l / box_area(l)));
  const auto outline_s = static_cast<double>(s.perimeter);
  const auto outline_l = static_cast<double>(l.perimeter);
  const double outline = (outline_s + outline_l - 2 * length) / std::sqrt(area_s + area_l);
  out("outline of the union over the root of its area", outline);
  out("union's outline, longer than before",
      outline - std::max(outline_s / std::sqrt(area_s), outline_l / std::sqrt(area_l)));
  out("image's border, share of the smaller one's outline",
      share(at_image_border(s), at_image_border(s) + s.perimeter));
  out("image's border, share of the larger one's outline",
      share(at_image_border(l), at_image_border(l) + l.perimeter));
  out("difference of texture, grey levels",
      std::abs(static_cast<double>(s.texture) / area_s - static_cast<double>(l.texture) / area_l) / 4);
  out("noise, grey levels", frame.noise_sigma);
  out("disparity of the smaller one, share of the nearest",
      known(fits_s.matched.any, fits_s.matched.d / frame.nearest_px));
  out("distance of the smaller one's colours from the floor's", fits_s.to_floor);
  out("distance of the larger one's colours from the floor's", fits_l.to_floor);
  out("distance of the smaller one's colours from the background's", fits_s.to_background);
  out("distance of the larger one's colours from the background's", fits_l.to_background);
  list_merge_hints({s, fits_s}, {l, fits_l}, contact, frame, out);
}

template <class Out>
void list_merge_hints(const RegionSide& smaller, const RegionSide& larger, const ContactCues& contact,
                      const FrameCues& frame, Out& out) {
  const RegionCues& s = smaller.cues;
  const RegionCues& l = larger.cues;
  const HintVotes& vs = smaller.fits.votes;
  const HintVotes& vl = larger.fits.votes;
  const auto area_s = static_cast<double>(s.area);
  const auto area_l = static_cast<double>(l.area);
  const double cells_s = area_s * frame.cells_per_px;
  const double cells = (area_s + area_l) * frame.cells_per_px;
  HintSums both = s.hints;
  both.add(l.hints);
  const HintVotes v = votes_of(both);
  const bool any = vs.any && vl.any && frame.has_hints;
  const double apart = any ? distance(vs.x - vl.x, vs.y - vl.y) : 0;
  out("hints: outline along the border", known(frame.has_hints, share(contact.outline, contact.length) / 16));
  out("hints: object, smaller one", known(frame.has_hints, share(s.hints.object, s.area) / 16));
  out("hints: object, larger one", known(frame.has_hints, share(l.hints.object, l.area) / 16));
  out("hints: distance of the centroids, relative", known(any, apart / std::sqrt(cells_s + 1)));
  out("hints: distance of the centroids, share of the width", known(any, apart / frame.cells_across));
  out("hints: spread of the votes, relative", known(any, v.spread / std::sqrt(cells + 1)));
  out("hints: difference of the sizes", known(any, vs.size - vl.size));
  out("hints: area over the voted size", known(any, log2_of(cells + 1) - v.size));
  out("hints: outline inside the smaller one", known(frame.has_hints, share(s.hints.outline, s.area) / 16));
}

template <class Out>
void list_shape(const RegionCues& r, const FrameCues& frame, Out& out) {
  const double image = static_cast<double>(frame.width) * frame.height;
  const auto area = static_cast<double>(r.area);
  const auto outline = static_cast<double>(r.perimeter + at_image_border(r));
  out("area, share of the image", area / image);
  out("fill of its box", area / box_area(r));
  out("outline over the root of the area", outline / std::sqrt(area));
  const double x = static_cast<double>(r.x) / area;
  const double y = static_cast<double>(r.y) / area;
  const double xx = static_cast<double>(r.xx) / area - x * x;
  const double yy = static_cast<double>(r.yy) / area - y * y;
  const double xy = static_cast<double>(r.xy) / area - x * y;
  const double sum = xx + yy;
  const double difference = root((xx - yy) * (xx - yy) + 4 * xy * xy);
  out("smallest over largest extent, squared", (sum - difference) / std::max(1e-9, sum + difference));
  out("area over that of an ellipse of its extents", area / std::max(1e-9, root(xx * yy - xy * xy)));
  out("vertical offset of its middle from the image's, share of the height", y / frame.height);
  out("horizontal offset of its middle from the image's, share of the width", std::abs(x) / frame.width);
  out("width, share of the image's", (r.right - r.left + 1.0) / frame.width);
  out("height, share of the image's", (r.bottom - r.top + 1.0) / frame.height);
  out("its foot, share of the image's height", (r.bottom + 1.0) / frame.height);
  out("image's left border, share of its outline", static_cast<double>(r.at_image_border[0]) / outline);
  out("image's right border, share of its outline", static_cast<double>(r.at_image_border[1]) / outline);
  out("image's top, share of its outline", static_cast<double>(r.at_image_border[2]) / outline);
  out("image's bottom, share of its outline", static_cast<double>(r.at_image_border[3]) / outline);
  out("number of borders of the image that it touches",
      static_cast<double>(std::count_if(r.at_image_border.begin(), r.at_image_border.end(),
                                        [](std::int64_t pixels) { return pixels > 0; })));
  out("spread of brightness, grey levels", spread(r, 0));
  out("spread of colour, grey levels", frame.has_colour ? spread(r, 1) + spread(r, 2) : double{kUnknown});
  out("texture, grey levels", static_cast<double>(r.texture) / area / 4);
}

/// Sums over a region's neighbours, weighted by the length of the contact.
struct Surroundings {
  double length = 0;
  std::int64_t edge_sum = 0, weak = 0, near_n = 0, near_sum = 0, far_n = 0, far_sum = 0;
  std::int64_t nearer = 0, farther = 0, level = 0, foot_n = 0, foot_sum = 0;
  double brightness = 0, colour = 0, histogram = 0;
  double on_ground = 0, on_ground_length = 0, on_background = 0, on_background_length = 0;
  double step = 0, step_length = 0;
  double textured_step = 0, textured_length = 0, matched_step = 0, matched_length = 0, least_step = 1e9;
  std::int64_t outline = 0;
  double object = 0, most_object = -1e9, centroids = 0, centroids_length = 0, nearest_centroid = 1e9;
  double largest = 0, same_thing = 0, wants = 0, most_same_thing = -100;

  void add(const RegionSide& region, const Neighbour& n) {
    const RegionCues& r = region.cues;
    const RegionCues& o = n.side.cues;
    const ContactCues& c = n.contact;
    const auto weight = static_cast<double>(c.length);
    const std::int64_t sign = n.turned ? -1 : 1;
    length += weight;
    edge_sum += c.edge_sum;
    weak += c.weak;
    outline += c.outline;
    const double its = share(o.hints.object, o.area) / 16;
    object += weight * its;
    most_object = std::max(most_object, its);
    const HintVotes& v = region.fits.votes;
    const HintVotes& w = n.side.fits.votes;
    if (v.any && w.any) {
      const double apart = distance(v.x - w.x, v.y - w.y);
      centroids += weight * apart;
      centroids_length += weight;
      nearest_centroid = std::min(nearest_centroid, apart);
    }
    near_n += c.near_n;
    near_sum += sign * c.near_sum;
    far_n += c.far_n;
    far_sum += sign * c.far_sum;
    nearer += n.turned ? c.farther : c.nearer;
    farther += n.turned ? c.nearer : c.farther;
    level += c.level;
    const auto [x, y] = middle(c);
    if (y > static_cast<double>(r.y) / static_cast<double>(r.area)) {
      foot_n += c.far_n;
      foot_sum += sign * c.far_sum;
    }
    brightness += weight * brightness_difference(r, o);
    colour += weight * colour_difference(r, o);
    histogram += weight * histogram_distance(r, o);
    if (o.above_ground.n > 0) {
      on_ground += weight * share(o.above_ground.on, o.above_ground.n);
      on_ground_length += weight;
    }
    if (o.before_background.n > 0) {
      on_background +=
          weight * share(o.before_background.on + o.before_background.behind, o.before_background.n);
      on_background_length += weight;
    }
    if (region.fits.matched.any && n.side.fits.matched.any) {
      step += weight * (region.fits.matched.d - n.side.fits.matched.d);
      step_length += weight;
    }
    if (r.textured.n >= kMinTextured && o.textured.n >= kMinTextured) {
      textured_step += weight * (region.fits.textured.at(x, y) - n.side.fits.textured.at(x, y));
      textured_length += weight;
    }
    if (r.matched.n >= kMinMatched && o.matched.n >= kMinMatched) {
      const double to = region.fits.matched.at(x, y) - n.side.fits.matched.at(x, y);
      matched_step += weight * to;
      matched_length += weight;
      least_step = std::min(least_step, to);
    }
    largest = std::max(largest, static_cast<double>(o.area) / static_cast<double>(r.area));
    same_thing += weight * std::clamp(n.same_thing, -4.0F, 4.0F);
    wants += n.same_thing > 0 ? weight : 0;
    most_same_thing = std::max(most_same_thing, double{n.same_thing});
  }
};

template <class Out>
void list_surroundings(const Surroundings& s, std::size_t neighbours, double own_px, const FrameCues& frame,
                       Out& out) {
  const auto edges = static_cast<double>(s.edge_sum) / 4;
  out("mean edge around it, grey levels", share(edges, s.length));
  out("mean edge around it over noise", share(edges, s.length * (frame.noise_sigma + 1)));
  out("share of the outline without an edge", share(static_cast<double>(s.weak), s.length));
  out("step down around it, 3 px away, px", mean_px(s.far_sum, s.far_n));
  out("step down right at the outline, px", mean_px(s.near_sum, s.near_n));
  out("share of the outline with disparities", share(static_cast<double>(s.far_n), s.length));
  out("share of disparities there where it is nearer", share(s.nearer, s.far_n));
  out("share of disparities there where it is farther", share(s.farther, s.far_n));
  out("share of level disparities there", share(s.level, s.far_n));
  out("difference of brightness to the neighbours, grey levels", share(s.brightness, s.length));
  out("difference of colour to the neighbours, grey levels",
      known(frame.has_colour, share(s.colour, s.length)));
  out("distance of the colours' histograms to the neighbours", share(s.histogram, s.length));
  out("neighbours on the ground, share", share(s.on_ground, s.on_ground_length));
  out("neighbours in the background, share", share(s.on_background, s.on_background_length));
  out("step of the means to the neighbours, relative",
      s.step_length > 0 ? s.step / s.step_length / std::max(1.0, own_px) : double{kUnknown});
  out("step at its foot, px", mean_px(s.foot_sum, s.foot_n));
  out("the largest neighbour over its own area", std::min(s.largest, 1000.0));
  out("neighbours", static_cast<double>(neighbours));
}

template <class Out>
void list_plane(const std::array<std::string_view, 4>& names, const PlaneMoments& moments,
                const FittedPlane& plane, int width, Out& out) {
  if (moments.n < kMinMatched) {
    for (const std::string_view name : names) out(name, kUnknown);
    return;
  }
  const auto n = static_cast<double>(moments.n);
  const double nearness = std::max(1.0, plane.d);
  out(names[0], root(plane.squares / n));
  out(names[1], plane.a * width / nearness);
  out(names[2], plane.b * width / nearness);
  const double squares = static_cast<double>(moments.dd) / (kDisparitySteps * kDisparitySteps);
  out(names[3], root(squares / n - plane.d * plane.d) / nearness);
}

constexpr std::array<std::string_view, 4> kTexturedPlane{
    "evidence: distance from its plane, px", "evidence: slope across, relative",
    "evidence: slope down, relative", "evidence: spread, relative"};
constexpr std::array<std::string_view, 4> kMatchedPlane{"distance from its plane, px",
                                                        "slope across, relative", "slope down, relative",
                                                        "spread of disparity, relative"};

/// The mean height over what its error may be.
double how_clear(const Heights& heights) {
  if (heights.n < 3) return kUnknown;
  const auto n = static_cast<double>(heights.n);
  const double m = static_cast<double>(heights.sum) / kDisparitySteps / n;
  const double squares = static_cast<double>(heights.squares) / (kDisparitySteps * kDisparitySteps) / n;
  return m / std::sqrt((std::max(0.0, squares - m * m) + 0.05) / n);
}

template <class Out>
void list_object_features(const RegionSide& region, std::span<const Neighbour> neighbours,
                          const Origin& origin, const FrameCues& frame, Out& out) {
  const RegionCues& r = region.cues;
  list_shape(r, frame, out);
  Surroundings around;
  for (const Neighbour& neighbour : neighbours) around.add(region, neighbour);
  const double own_px = region.fits.matched.any ? region.fits.matched.d : 0;
  list_surroundings(around, neighbours.size(), own_px, frame, out);
  out("evidence, share", share(r.textured.n, r.area));
  out("disparities, share", share(r.matched.n, r.area));
  out("disparity, share of the nearest", own_px / frame.nearest_px);
  list_plane(kTexturedPlane, r.textured, region.fits.textured, frame.width, out);
  list_plane(kMatchedPlane, r.matched, region.fits.matched, frame.width, out);
  const Heights& ground = r.above_ground;
  out("height above the ground, px", mean_px(ground.sum, ground.n));
  out("height above the ground, relative",
      ground.n > 0 ? mean_px(ground.sum, ground.n) / std::max(1.0, own_px) : double{kUnknown});
  out("share on the ground", share(ground.on, ground.n));
  out("share below the ground", share(ground.behind, ground.n));
  out("share above the ground", share(ground.n - ground.on - ground.behind, ground.n));
  const Heights& background = r.before_background;
  out("in front of the background, px", mean_px(background.sum, background.n));
  out("share in the background", share(background.on + background.behind, background.n));
  out("ground known", frame.has_ground ? 1 : 0);
  out("floor and walls known", frame.walls_and_floor);
  out("noise, grey levels", frame.noise_sigma);
  out("same-object score of its parts", origin.same_thing);
  out("its larger part, share", origin.larger_part);
  out("evidence: step of the planes around, px", share(around.textured_step, around.textured_length));
  out("step of the planes around, px", share(around.matched_step, around.matched_length));
  out("least step of the planes around, px", known(around.matched_length > 0, around.least_step));
  out("evidence: height above the ground, px",
      mean_px(r.textured_above_ground.sum, r.textured_above_ground.n));
  out("evidence: height above the ground over its error", how_clear(r.textured_above_ground));
  out("evidence: in front of the background, px",
      mean_px(r.textured_before_background.sum, r.textured_before_background.n));
  out("evidence: in front of the background over its error", how_clear(r.textured_before_background));
  const bool alone = neighbours.empty();
  out("same-object score, highest of the neighbours", alone ? double{kUnknown} : around.most_same_thing);
  out("same-object score, mean over the outline", share(around.same_thing, around.length));
  out("share of the outline with the same object likely", share(around.wants, around.length));
  out("same-object score, lowest inside", origin.least_same_thing);
  out("disparities in the image, share", frame.matched_share);
  out("evidence in the image, share", frame.evidence_share);
  out("distance of its colours from the floor's", region.fits.to_floor);
  out("distance of its colours from the background's", region.fits.to_background);
  const HintVotes& votes = region.fits.votes;
  const double cells = static_cast<double>(r.area) * frame.cells_per_px;
  const auto area = static_cast<double>(r.area);
  out("hints: object", known(frame.has_hints, share(r.hints.object, r.area) / 16));
  out("hints: weight of its votes", known(frame.has_hints, share(r.hints.weight, r.area) / 64));
  out("hints: outline inside", known(frame.has_hints, share(r.hints.outline, r.area) / 16));
  out("hints: outline around it",
      known(frame.has_hints && !alone, share(static_cast<double>(around.outline), around.length) / 16));
  out("hints: object, around it", known(frame.has_hints && !alone, share(around.object, around.length)));
  out("hints: object, largest of the neighbours", known(frame.has_hints && !alone, around.most_object));
  out("hints: spread of the votes, relative", known(votes.any, votes.spread / std::sqrt(cells + 1)));
  out("hints: its centroid from that of its votes, relative",
      known(votes.any, distance(static_cast<double>(r.x) / area * frame.cells_across / frame.width - votes.x,
                                static_cast<double>(r.y) / area * frame.cells_down / frame.height - votes.y) /
                           std::sqrt(cells + 1)));
  out("hints: area over the voted size", known(votes.any, log2_of(cells + 1) - votes.size));
  out("hints: centroids around it, relative",
      known(around.centroids_length > 0, around.centroids / around.centroids_length / std::sqrt(cells + 1)));
  out("hints: nearest centroid around it, relative",
      known(around.centroids_length > 0, around.nearest_centroid / std::sqrt(cells + 1)));
  out("its share of its parent", kUnknown);
  out("same-object score, rest of its parent", kUnknown);
}

}  // namespace

FittedPlane fit_plane(const PlaneMoments& m, int width) {
  FittedPlane plane;
  if (m.n < 1) return plane;
  const auto n = static_cast<double>(m.n);
  const double steps = kDisparitySteps;
  plane.any = true;
  plane.x = static_cast<double>(m.x) / n;
  plane.y = static_cast<double>(m.y) / n;
  const double mean_steps = static_cast<double>(m.d) / n;
  const double ridge = n * kLevelling * width * width;
  const double xx = static_cast<double>(m.xx) - static_cast<double>(m.x) * plane.x + ridge;
  const double yy = static_cast<double>(m.yy) - static_cast<double>(m.y) * plane.y + ridge;
  const double xy = static_cast<double>(m.xy) - static_cast<double>(m.x) * plane.y;
  const double xd = (static_cast<double>(m.xd) - static_cast<double>(m.x) * mean_steps) / steps;
  const double yd = (static_cast<double>(m.yd) - static_cast<double>(m.y) * mean_steps) / steps;
  const double dd = (static_cast<double>(m.dd) - static_cast<double>(m.d) * mean_steps) / (steps * steps);
  const double determinant = xx * yy - xy * xy;
  plane.d = mean_steps / steps;
  plane.a = (xd * yy - yd * xy) / determinant;
  plane.b = (yd * xx - xd * xy) / determinant;
  plane.squares = std::max(0.0, dd - plane.a * xd - plane.b * yd);
  return plane;
}

FrameCues frame_cues(const RegionGraphCues& graph, const Cues& cues) {
  FrameCues frame;
  frame.width = cues.left.gray.width();
  frame.height = cues.left.gray.height();
  frame.has_colour = !cues.left.rgb.empty();
  frame.has_ground = cues.ground.plane.has_value();
  frame.walls_and_floor = static_cast<int>(cues.background.planes.size());
  frame.noise_sigma = cues.left.noise_sigma;
  frame.has_hints = !cues.hints.empty();
  frame.cells_per_px =
      static_cast<double>(cues.hints.size().area()) / static_cast<double>(cues.left.gray.size().area());
  frame.cells_across = cues.hints.width();
  frame.cells_down = cues.hints.height();
  std::int64_t matched = 0;
  std::int64_t textured = 0;
  for (const RegionCues& region : graph.regions) {
    matched += region.matched.n;
    textured += region.textured.n;
    if (mostly(region.above_ground.on, region)) frame.floor.add(region);
    if (mostly(region.before_background.on + region.before_background.behind, region))
      frame.background.add(region);
    if (region.matched.n == 0) continue;
    frame.nearest_px =
        std::max(frame.nearest_px, static_cast<double>(region.matched.d) /
                                       static_cast<double>(region.matched.n) / kDisparitySteps);
  }
  const auto area = static_cast<float>(cues.left.gray.size().area());
  frame.matched_share = static_cast<float>(matched) / area;
  frame.evidence_share = static_cast<float>(textured) / area;
  return frame;
}

void SceneColours::add(const RegionCues& region) {
  area += region.area;
  for (std::size_t i = 0; i < histogram.size(); ++i) histogram[i] += region.histogram[i];
}

RegionFits fit_region(const RegionCues& region, const FrameCues& frame) {
  RegionFits fits{fit_plane(region.matched, frame.width), fit_plane(region.textured, frame.width),
                  votes_of(region.hints)};
  if (frame.floor.area > 0) fits.to_floor = histogram_distance(region, frame.floor);
  if (frame.background.area > 0) fits.to_background = histogram_distance(region, frame.background);
  return fits;
}

MergeFeatures merge_features(const RegionSide& a, const RegionSide& b, const ContactCues& contact,
                             const FrameCues& frame) {
  MergeFeatures features{};
  Values values{features};
  list_merge_features(a, b, contact, frame, values);
  assert(values.n == features.size());
  return features;
}

ObjectFeatures object_features(const RegionSide& region, std::span<const Neighbour> neighbours,
                               const Origin& origin, const FrameCues& frame) {
  ObjectFeatures features{};
  Values values{features};
  list_object_features(region, neighbours, origin, frame, values);
  assert(values.n == features.size());
  return features;
}

void report_end(ObjectFeatures& features, float share_of_it, float same_thing) {
  features[kObjectFeatures - 2] = share_of_it;
  features[kObjectFeatures - 1] = same_thing;
}

std::vector<std::string_view> merge_feature_names() {
  RegionCues region;
  region.area = 1;
  const RegionFits fits;
  ContactCues contact;
  contact.length = 1;
  Names names;
  list_merge_features({region, fits}, {region, fits}, contact, {}, names);
  return names.out;
}

std::vector<std::string_view> object_feature_names() {
  RegionCues region;
  region.area = 1;
  const RegionFits fits;
  Names names;
  list_object_features({region, fits}, {}, {}, {}, names);
  return names.out;
}

}  // namespace cairn
