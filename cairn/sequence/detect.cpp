// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/scene/floor_frame.hpp>
#include <cmath>

#include <cairn/sequence/tracks.hpp>

namespace cairn {
namespace {

constexpr int kLightness = 8;  // bins, 12.5 wide
constexpr int kChroma = 8;     // bins of a* and of b*, 16 wide; neutral grey at the centre of one
constexpr int kNeutral = 4 * kChroma + 4;

// Change of the centre of the visible part from frame to frame, as given by a mask: an edge in pixels, an outline
// relative to its size.
constexpr double kEdgeSigma = 0.5;     // px
constexpr double kExtentShare = 0.05;  // of the extent
constexpr double kDepthShare = 0.1;    // of the depth extent
// The centre of a mask that covers an object incompletely is off by up to a quarter of its extent; up to half
// if the image border clips it. A uniform distribution has σ = width / √12.
constexpr double kDoubtShare = 0.144;
constexpr double kCutShare = 0.289;

/// Standard deviations of the error that persists, fitted to objects of single frames (./dev bench geometry
/// --fit); the two of disparity and depth before there were the trees of refine_objects().
namespace steady {
constexpr double kEdgeSigma = 0.32;       // px, of an edge
constexpr double kWidthShare = 0.044;     // of the extent, at a confidence of 0.5
constexpr double kHeightShare = 0.105;    // legs and leaves are lost below and above
constexpr double kDisparityShare = 0.56;  // of the disparity's standard deviation
constexpr double kDepthShare = 0.052;     // of the depth extent
constexpr double kDoubtPower = 0.516;     // of the odds against the mask
// A few masks miss half of an object. Chosen for the tracks of the fit set: docs/stages/tracking.md
constexpr double kWidened = 1.5;
}  // namespace steady

struct Bins {
  std::uint8_t lightness = 0;
  std::uint8_t chroma = 0;
};

double linear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}
double cube_root(double t) {
  return t > 216.0 / 24389.0 ? std::cbrt(t) : (24389.0 / 27.0 * t + 16) / 116;
}
int chroma_bin(double value) {
  return std::clamp(static_cast<int>(std::floor((value + 8) / 16)) + 4, 0, kChroma - 1);
}

Bins bins_of_colour(double red, double green, double blue) {
  const double r = linear(red);
  const double g = linear(green);
  const double b = linear(blue);
  // CIE 15:2018, for sRGB under D65.
  const double x = cube_root((0.4124564 * r + 0.3575761 * g + 0.1804375 * b) / 0.95047);
  const double y = cube_root(0.2126729 * r + 0.7151522 * g + 0.0721750 * b);
  const double z = cube_root((0.0193339 * r + 0.1191920 * g + 0.9503041 * b) / 1.08883);
  const double lightness = 116 * y - 16;
  return {static_cast<std::uint8_t>(std::clamp(static_cast<int>(lightness / 12.5), 0, kLightness - 1)),
          static_cast<std::uint8_t>(chroma_bin(500 * (x - y)) * kChroma + chroma_bin(200 * (y - z)))};
}

/// Index of the colour with 5 bits per channel: an image needs 10⁵ look-ups of few different colours.
std::size_t entry(Rgb c) {
  return (std::size_t{c.r} >> 3U) << 10U | (std::size_t{c.g} >> 3U) << 5U | std::size_t{c.b} >> 3U;
}
const std::vector<Bins>& table() {
  static const std::vector<Bins> bins = [] {
    std::vector<Bins> made;
    made.reserve(32768);
    const auto middle = [](int five_bits) { return (five_bits * 8 + 3.5) / 255; };
    for (int r = 0; r < 32; ++r) {
      for (int g = 0; g < 32; ++g)
        for (int b = 0; b < 32; ++b) made.push_back(bins_of_colour(middle(r), middle(g), middle(b)));
    }
    return made;
  }();
  return bins;
}

struct Counts {
  std::array<int, kLightness + kChroma * kChroma> of_bin{};
  int pixels = 0;
};

ColourHistogram histogram(const Counts& counts) {
  ColourHistogram look{};
  for (std::size_t i = 0; i < look.size(); ++i)
    look.at(i) = static_cast<float>(counts.of_bin.at(i)) / static_cast<float>(std::max(counts.pixels, 1));
  return look;
}

/// Whether the mask extends 2 px to each side: colours are mixed at its border.
bool is_inside(View<const ObjectId> labels, int x, int y) {
  const ObjectId id = labels(x, y);
  return x >= 2 && y >= 2 && x < labels.width() - 2 && y < labels.height() - 2 && labels(x - 2, y) == id &&
         labels(x + 2, y) == id && labels(x, y - 2) == id && labels(x, y + 2) == id;
}

std::vector<ColourHistogram> looks_of(const Objects& objects, View<const Gray> left,
                                      View<const Rgb> left_rgb) {
  const std::vector<Bins>& bins = table();
  std::vector<Counts> inside(objects.list.size());
  std::vector<Counts> all(objects.list.size());
  const View<const ObjectId> labels = objects.labels;
  for (int y = 0; y < labels.height(); ++y) {
    const ObjectId* const row = labels.row(y);
    for (int x = 0; x < labels.width(); ++x) {
      if (row[x] == ObjectId::none) continue;
      const std::size_t i = slot(number(row[x])) - 1;
      const Gray grey = left(x, y);
      Bins bin = bins[entry(left_rgb.empty() ? Rgb{grey, grey, grey} : left_rgb(x, y))];
      if (left_rgb.empty()) bin.chroma = kNeutral;
      const auto count = [&](Counts& counts) {
        ++counts.pixels;
        ++counts.of_bin.at(bin.lightness);
        ++counts.of_bin.at(std::size_t{kLightness} + bin.chroma);
      };
      count(all[i]);
      if (is_inside(labels, x, y)) count(inside[i]);
    }
  }
  // A thin object has no interior pixels.
  constexpr int kEnough = 30;  // px
  std::vector<ColourHistogram> looks;
  looks.reserve(all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    looks.push_back(histogram(inside[i].pixels >= kEnough ? inside[i] : all[i]));
  return looks;
}

struct Cut {
  bool x = false;  // clipped by the left or right image border
  bool y = false;
};

/// x and y across the ray, z along it.
Covariance3 around_ray(Point3 p, double x, double y, double z) {
  const Point3 ray{p.x / p.z, p.y / p.z, 1};
  const double zz = z * z;
  return {x * x + zz * ray.x * ray.x,
          zz * ray.x * ray.y,
          zz * ray.x,  //
          zz * ray.x * ray.y,
          y * y + zz * ray.y * ray.y,
          zz * ray.y,  //
          zz * ray.x,
          zz * ray.y,
          zz};
}

/// The standard deviation of the depth that follows from that of the disparity, m.
double depth_sigma_m(Point3 p, const Object& object, const StereoRig& rig) {
  return p.z * p.z * double{object.disparity_sigma_px} / (double{rig.focal_px} * double{rig.baseline_m});
}

/// Across the ray from the mask's outline, along it from the disparity.
Covariance3 covariance_of(Point3 p, Vec3 extent_m, const Object& object, Cut cut, const StereoRig& rig) {
  const double focal = rig.focal_px;
  const double doubt = std::sqrt(1 - std::clamp(double{object.confidence}, 0.0, 1.0));
  const auto across = [&](float extent, bool is_cut) {
    const double part = is_cut ? kCutShare : doubt * kDoubtShare;
    return std::hypot(p.z * kEdgeSigma / focal, kExtentShare * double{extent}, part * double{extent});
  };
  const double z = std::hypot(depth_sigma_m(p, object, rig), kDepthShare * double{extent_m.z},
                              doubt * kDoubtShare * double{extent_m.z});
  return around_ray(p, across(extent_m.x, cut.x), across(extent_m.y, cut.y), z);
}

/// The centre is that of the visible part, so the image border makes it no less certain.
Covariance3 steady_covariance_of(Point3 p, Vec3 extent_m, const Object& object, const StereoRig& rig) {
  const double c = std::clamp(double{object.confidence}, 0.02, 0.99);
  const double doubt = std::pow((1 - c) / c, steady::kDoubtPower);
  const double edge = p.z * steady::kEdgeSigma / double{rig.focal_px};
  const auto across = [&](double share, float extent) {
    return steady::kWidened * std::hypot(edge, doubt * share * double{extent});
  };
  const double z = steady::kWidened * std::hypot(steady::kDisparityShare * depth_sigma_m(p, object, rig),
                                                 steady::kDepthShare * double{extent_m.z});
  return around_ray(p, across(steady::kWidthShare, extent_m.x), across(steady::kHeightShare, extent_m.y), z);
}

}  // namespace

float likeness(const ColourHistogram& a, const ColourHistogram& b) {
  float sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::sqrt(a.at(i) * b.at(i));
  return std::min(sum / 2, 1.0F);
}

std::vector<Detection> detect(const Frame& frame, const LeftImage& left, const std::optional<StereoRig>& rig,
                              const TrackingConfig& config) {
  const std::vector<ColourHistogram> looks = looks_of(frame.objects, left.gray, left.rgb);
  const auto floor = floor_frame(frame.ground, rig);
  std::vector<Detection> detections;
  for (const Object& object : frame.objects.list) {
    if (object.confidence < config.low_confidence) continue;
    Detection seen;
    seen.object = object.id;
    seen.look = looks[slot(number(object.id)) - 1];
    seen.confidence = object.confidence;
    seen.pixel_count = object.pixel_count;
    seen.box_px = object.box_px;
    const Rect& box = object.box_px;
    const Cut cut{box.x == 0 || box.x + box.width == left.gray.width(),
                  box.y == 0 || box.y + box.height == left.gray.height()};
    seen.is_cut = cut.x || cut.y;
    if (rig && object.position_in_camera_m && object.position_in_camera_m->z > 0) {
      const Vec3& p = *object.position_in_camera_m;
      seen.has_place = true;
      seen.position_in_camera_m = {p.x, p.y, p.z};
      seen.extent_m = object.extent_in_camera_m.value_or(Vec3{});
      seen.covariance_in_camera_m2 =
          covariance_of(seen.position_in_camera_m, seen.extent_m, object, cut, *rig);
      seen.steady_in_camera_m2 = steady_covariance_of(seen.position_in_camera_m, seen.extent_m, object, *rig);
      if (floor) seen.height_over_floor_m = floor->to_floor(p).z;
    }
    detections.push_back(seen);
  }
  return detections;
}

}  // namespace cairn
