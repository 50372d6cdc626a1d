// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/core/statistics.hpp>
#include <cairn/fitted/fitted.hpp>
#include <cairn/regions/cue_kernels.hpp>
#include <cairn/regions/object_hints.hpp>
#include <cairn/regions/refine_disparity.hpp>
#include <cairn/scene/plane_kernels.hpp>
#include <cmath>
#include <limits>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 8;             // superpixels
constexpr std::int64_t kMinMain = 6;  // disparities for a plane
constexpr std::int64_t kMinTextured = 4;
constexpr std::size_t kMaxNeighbours = 8;
constexpr std::size_t kMinGroup = 2;                  // samples; smaller groups keep their disparities
constexpr std::int64_t kEnough = 512;                 // pixels for each stride² of the samples
constexpr double kSameMiddle = 0.5, kSameCorner = 1;  // px; planes that do not differ by more are one
constexpr double kBeyondRange = 3;                    // px; planes farther beyond all disparities are refused
constexpr double kLevelling = 4e-4;                   // damping of slopes: a spread in image widths²
constexpr float kFewPixels = -2;     // log-odds of groups too small to be judged, off the main plane
constexpr float kPreferred = 0.05F;  // of keeping the disparities
// The log-odds for kept pixels: of the choice, and of the match. Fitted by lab/refined.py.
constexpr float kKeptBias = -0.32F, kKeptChoice = 0.87F, kKeptMatch = 0.27F;
constexpr float kLeast = 0.005F;  // probability, for these log-odds
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
using kernels::kNearPlane;
using kernels::kOnPlane;

using kernels::PixelGroup;
using enum kernels::PixelGroup;
constexpr std::size_t kGroups = kernels::kPixelGroups;

using Pixels = std::vector<SuperpixelPixel>;

/// The same points once more, for kernels.
struct PixelArrays {
  std::vector<float> x, y, d;
  void set(const Pixels& pixels) {
    x.clear(), y.clear(), d.clear();
    for (const SuperpixelPixel& p : pixels) {
      x.push_back(static_cast<float>(p.x));
      y.push_back(static_cast<float>(p.y));
      d.push_back(p.disparity_px);
    }
  }
  [[nodiscard]] kernels::PointArrays points() const {
    return {x.data(), y.data(), d.data(), nullptr, static_cast<int>(x.size())};
  }
};

constexpr std::array<std::string_view, kPlaneFeatures> kNames{
    "kept as it is",
    "group",
    "group: share of the superpixel",
    "group: share of the image",
    "group: textured, share",
    "group: spread of its disparities, px",
    "group: confidence of its matches",
    "distance from the group's disparities, px",
    "distance from the main plane, px",
    "in front of the background, px",
    "disparity, share of the nearest",
    "is the ground",
    "is the background",
    "superpixel: disparities, share",
    "superpixel: disparities on this plane, share",
    "superpixel: pixels on the main plane, share",
    "group: disparities on this plane, share",
    "neighbours on this plane, share of the outline",
    "neighbours on this plane, share of the outline without an edge",
    "neighbours on this plane, share of the outline without a hint",
    "objects on this plane, share of the outline",
    "hints: object, group",
    "hints: object, superpixel",
    "part of an object",
    "height in the image"};

/// Sums for a least-squares plane, relative to a first pixel.
class PlaneFit {
 public:
  explicit PlaneFit(int width) : width_(width) {}
  void add(const SuperpixelPixel& p) {
    if (n_ == 0) first_ = p;
    const double x = p.x - first_.x;
    const double y = p.y - first_.y;
    const double d = double{p.disparity_px} - double{first_.disparity_px};
    ++n_;
    x_ += x, y_ += y, d_ += d;
    xx_ += x * x, xy_ += x * y, yy_ += y * y, xd_ += x * d, yd_ += y * d;
  }
  [[nodiscard]] std::int64_t count() const { return n_; }
  [[nodiscard]] DisparityPlane plane() const {
    const auto n = static_cast<double>(n_);
    const double ridge = n * kLevelling * width_ * width_;
    const double xx = xx_ - x_ * x_ / n + ridge;
    const double yy = yy_ - y_ * y_ / n + ridge;
    const double xy = xy_ - x_ * y_ / n;
    const double xd = xd_ - x_ * d_ / n;
    const double yd = yd_ - y_ * d_ / n;
    const double determinant = xx * yy - xy * xy;
    DisparityPlane plane{(xd * yy - yd * xy) / determinant, (yd * xx - xd * xy) / determinant, 0};
    plane.c =
        double{first_.disparity_px} + d_ / n - plane.a * (first_.x + x_ / n) - plane.b * (first_.y + y_ / n);
    return plane;
  }

 private:
  int width_;
  SuperpixelPixel first_;
  std::int64_t n_ = 0;
  double x_ = 0, y_ = 0, d_ = 0, xx_ = 0, xy_ = 0, yy_ = 0, xd_ = 0, yd_ = 0;
};

/// For kernels; NaN where there is none.
GroundPlane in_floats(const std::optional<DisparityPlane>& plane) {
  if (!plane) return {kNan, kNan, kNan};
  return {static_cast<float>(plane->a), static_cast<float>(plane->b), static_cast<float>(plane->c)};
}

/// The planes of a superpixel's own disparities.
struct OwnPlanes {
  std::optional<DisparityPlane> main, second, textured;
  double main_share = 0;  // of its pixels
  /// As kernels::CueKernels::take_planes has it.
  [[nodiscard]] PixelGroup group_of(const SuperpixelPixel& p) const {
    const auto before = [&p](const std::optional<DisparityPlane>& plane) {
      return p.disparity_px - in_floats(plane).disparity_px(static_cast<float>(p.x), static_cast<float>(p.y));
    };
    if (std::isnan(p.disparity_px)) return holes;
    const float before_main = before(main);
    if (std::abs(before_main) <= kNearPlane) return on_main;
    if (std::abs(before(second)) <= kNearPlane) return on_second;
    return before_main < 0 ? farther : nearer;
  }
};

bool is_near(const DisparityPlane& plane, const SuperpixelPixel& p) {
  return std::abs(double{p.disparity_px} - plane.at(p.x, p.y)) <= double{kNearPlane};
}

/// How many disparities there are of each whole number.
class Histogram1px {
 public:
  Histogram1px(float lowest, float highest)
      : lowest_(lowest), counts_(static_cast<std::size_t>(highest - lowest) + 3) {}
  void fill(const Pixels& pixels) {
    std::fill(counts_.begin(), counts_.end(), 0);
    for (const SuperpixelPixel& p : pixels)
      counts_[bin(p.disparity_px)] += std::isnan(p.disparity_px) ? 0 : 1;
  }
  /// The lowest disparity with the most others within 1 px, at least 3 px from `other`; none if there is none.
  [[nodiscard]] std::optional<double> mode(const std::optional<double>& other) const {
    std::optional<double> best;
    std::int32_t most = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      const double here = double{lowest_} + static_cast<double>(i);
      if (other && std::abs(here - *other) < 3) continue;
      const std::int32_t sum =
          counts_[i] + (i > 0 ? counts_[i - 1] : 0) + (i + 1 < counts_.size() ? counts_[i + 1] : 0);
      if (sum <= most) continue;
      most = sum;
      best = here;
    }
    return best;
  }

 private:
  [[nodiscard]] std::size_t bin(float d) const {
    return std::isnan(d) ? 0 : static_cast<std::size_t>(d - lowest_ + 0.5F);
  }
  float lowest_;
  std::vector<std::int32_t> counts_;
};

/// The least and the greatest disparity; {0, 0} without any.
std::array<float, 2> range_of(View<const float> disparity_px) {
  float low = std::numeric_limits<float>::infinity();
  float high = -low;
  for (int y = 0; y < disparity_px.height(); ++y) {
    const float* const row = disparity_px.row(y);
    for (int x = 0; x < disparity_px.width(); ++x) {
      const float d = row[x];
      low = d < low ? d : low;
      high = d > high ? d : high;
    }
  }
  return low <= high ? std::array{low, high} : std::array{0.0F, 0.0F};
}

/// The likelihood of log-odds in steps of 1/16, and the log-odds of a confidence in steps of 1/256.
struct Tables {
  static constexpr int kSteps = 16, kMost = 8;  // of log-odds
  std::array<float, 2 * kSteps * kMost + 1> likely{};
  std::array<float, 257> log_odds{};
  Tables() {
    for (std::size_t i = 0; i < likely.size(); ++i)
      likely[i] = likelihood(static_cast<float>(i) / kSteps - static_cast<float>(kMost));
    for (std::size_t i = 0; i < log_odds.size(); ++i) {
      const float p = std::clamp(static_cast<float>(i) / 256, kLeast, 1 - kLeast);
      log_odds[i] = std::log(p / (1 - p));
    }
  }
  [[nodiscard]] float likelihood_of(float odds) const {
    const float at = std::clamp(odds, -float{kMost}, float{kMost}) * kSteps + kSteps * kMost + 0.5F;
    return likely[static_cast<std::size_t>(at)];
  }
  [[nodiscard]] float odds_of(float confidence) const {
    return log_odds[static_cast<std::size_t>(std::clamp(confidence, 0.0F, 1.0F) * 256 + 0.5F)];
  }
};
const Tables& tables() {
  static const Tables all;
  return all;
}

class Refiner {
 public:
  Refiner(const RefinementCues& in, const FittedTrees& right_plane, const Exec& exec,
          const std::function<void(const JudgedPlane&)>& on_judged)
      : in_(in),
        right_plane_(right_plane),
        exec_(exec),
        count_on_(kernels::plane_kernels(exec).count_on),
        take_planes_(kernels::cue_kernels(exec).take_planes),
        on_judged_(on_judged),
        regions_(in.tree.superpixel_cues.regions),
        contacts_(in.tree.superpixel_cues.contacts),
        size_(in.cues.disparity_px.size()),
        centre_x_(size_.width / 2),
        centre_y_(size_.height / 2),
        range_(range_of(in.cues.disparity_px)),
        own_(regions_.size()),
        contacts_of_(regions_.size()),
        out_{Image<float>(size_, exec.pool), Image<float>(size_, exec.pool)} {
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      contacts_of_[slot(contacts_[i].a)].push_back(i);
      contacts_of_[slot(contacts_[i].b)].push_back(i);
    }
    const auto longest_first = [this](std::size_t i, std::size_t j) {
      return contacts_[i].length > contacts_[j].length;
    };
    for (std::vector<std::size_t>& of : contacts_of_) std::stable_sort(of.begin(), of.end(), longest_first);
  }

  RefinedDisparity run() {
    const int count = static_cast<int>(regions_.size());
    parallel_for(exec_, count, kGrain, [&](int first, int last) {
      Pixels pixels;
      Histogram1px histogram(std::floor(range_[0]), std::ceil(range_[1]));
      for (auto i = slot(first); i < slot(last); ++i) {
        collect(i, pixels);
        own_[i] = planes_of(pixels, histogram);
      }
    });
    // A callback is called in order.
    parallel_for(exec_, count, on_judged_ ? std::max(1, count) : kGrain, [&](int first, int last) {
      Work work;
      for (auto i = slot(first); i < slot(last); ++i) judge(i, work);
      choose(work);
      for (auto i = slot(first); i < slot(last); ++i)
        write(i, work.chosen.data() + (i - slot(first)) * kGroups, work);
    });
    return std::move(out_);
  }

 private:
  struct Candidate {
    DisparityPlane plane;
    bool is_ground = false, is_background = false;
    double matched_on = 0;  // share of the superpixel's disparities within kOnPlane
    double agree = 0, agree_smooth = 0, agree_unhinted = 0, agree_objects = 0;  // shares of the outline
    std::array<std::size_t, kGroups> on{};  // disparities of each group within kOnPlane
  };
  /// What a group of pixels takes.
  struct Chosen {
    std::optional<DisparityPlane> plane;  // none: it is kept
    float log_odds = 0;
  };
  /// The choices of some superpixels, judged together.
  struct Work {
    std::vector<PlaneFeatures> features;
    std::vector<std::optional<DisparityPlane>> planes;
    std::vector<std::size_t> ends;  // of each group's choices
    std::vector<Chosen> chosen;     // of each group
    // Of one row:
    std::vector<float> refined_px;
    std::vector<std::int32_t> group_of;
    // Of one superpixel:
    Pixels pixels;
    std::array<Pixels, kGroups> groups;
    std::array<PixelArrays, holes> points;  // of the groups
    std::vector<Candidate> candidates;
  };

  /// The distance of samples, px: a large superpixel needs no more of them than a small one.
  [[nodiscard]] int stride_of(std::size_t i) const {
    int stride = 1;
    while (regions_[i].area >= (stride + 1) * (stride + 1) * kEnough) ++stride;
    return stride;
  }

  /// Every second pixel of a grid, as on a chequerboard.
  void collect(std::size_t i, Pixels& pixels) const {
    pixels.clear();
    const RegionCues& region = regions_[i];
    const int stride = stride_of(i);
    for (int v = (region.top + stride - 1) / stride; v * stride <= region.bottom; ++v) {
      const int y = v * stride;
      const RegionId* const label = in_.superpixels.labels.row(y);
      const float* const d = in_.cues.disparity_px.row(y);
      const float* const textured = in_.cues.textured_px.row(y);
      const float* const confidence = in_.confidence.empty() ? nullptr : in_.confidence.row(y);
      const int u = (region.left + stride - 1) / stride;
      for (int x = (u + (u + v) % 2) * stride; x <= region.right; x += 2 * stride) {
        if (index(label[x]) == i)
          pixels.push_back({x, y, d[x], confidence ? confidence[x] : 0.0F, !std::isnan(textured[x])});
      }
    }
  }

  std::optional<DisparityPlane> fitted(const Pixels& pixels, const DisparityPlane& start, int rounds) const {
    DisparityPlane plane = start;
    for (int round = 0; round < rounds; ++round) {
      PlaneFit fit(size_.width);
      for (const SuperpixelPixel& p : pixels) {
        if (is_near(plane, p)) fit.add(p);
      }
      if (fit.count() < kMinMain) return {};
      plane = fit.plane();
    }
    return plane;
  }

  OwnPlanes planes_of(const Pixels& pixels, Histogram1px& histogram) const {
    OwnPlanes own;
    histogram.fill(pixels);
    const std::optional<double> mode = histogram.mode({});
    if (!mode) return own;
    own.main = fitted(pixels, {0, 0, *mode}, 2);
    if (!own.main) return own;
    if (const std::optional<double> other = histogram.mode(mode))
      own.second = fitted(pixels, {0, 0, *other}, 1);
    PlaneFit textured(size_.width);
    std::size_t on = 0;
    for (const SuperpixelPixel& p : pixels) {
      if (p.is_textured && !std::isnan(p.disparity_px)) textured.add(p);
      on += is_near(*own.main, p) ? 1U : 0U;
    }
    if (textured.count() >= kMinTextured) own.textured = textured.plane();
    own.main_share = static_cast<double>(on) / static_cast<double>(pixels.size());
    return own;
  }

  [[nodiscard]] std::array<double, 2> middle(const RegionCues& region) const {
    const auto area = static_cast<double>(region.area);
    return {centre_x_ + static_cast<double>(region.x) / area,
            centre_y_ + static_cast<double>(region.y) / area};
  }

  /// Adds a plane, unless it is one of those already there or leaves the range of all disparities. Returns it, or
  /// null.
  Candidate* add(std::vector<Candidate>& to, const RegionCues& region, const DisparityPlane& plane) const {
    const auto [x, y] = middle(region);
    const std::array corners{plane.at(region.left, region.top), plane.at(region.right, region.top),
                             plane.at(region.left, region.bottom), plane.at(region.right, region.bottom)};
    const auto [low, high] = std::minmax_element(corners.begin(), corners.end());
    if (*low < double{range_[0]} - kBeyondRange || *high > double{range_[1]} + kBeyondRange) return nullptr;
    for (Candidate& other : to) {
      if (std::abs(other.plane.at(x, y) - plane.at(x, y)) < kSameMiddle &&
          std::abs(other.plane.at(region.left, region.top) - corners[0]) < kSameCorner &&
          std::abs(other.plane.at(region.right, region.top) - corners[1]) < kSameCorner &&
          std::abs(other.plane.at(region.left, region.bottom) - corners[2]) < kSameCorner)
        return &other;
    }
    to.push_back({plane});
    return &to.back();
  }

  static std::size_t other_of(const ContactCues& contact, std::size_t i) {
    return slot(slot(contact.a) == i ? contact.b : contact.a);
  }

  /// Returns the disparity of the background at the superpixel's middle.
  double list_candidates(std::size_t i, std::vector<Candidate>& found) const {
    const RegionCues& region = regions_[i];
    const OwnPlanes& own = own_[i];
    found.clear();
    if (own.main) found.push_back({*own.main});
    if (own.second) add(found, region, *own.second);
    if (own.textured) add(found, region, *own.textured);
    const auto plane_of = [](const GroundPlane& p) {
      return DisparityPlane{double{p.a}, double{p.b}, double{p.c}};
    };
    if (const auto& ground = in_.cues.ground.plane) {
      if (Candidate* const at = add(found, region, plane_of(*ground))) at->is_ground = true;
    }
    const auto [x, y] = middle(region);
    double background_px = 0;
    const GroundPlane* behind = nullptr;
    for (const GroundPlane& plane : in_.cues.background.planes) {
      const double d = plane_of(plane).at(x, y);
      if (d <= background_px) continue;
      background_px = d;
      behind = &plane;
    }
    if (behind != nullptr) {
      if (Candidate* const at = add(found, region, plane_of(*behind))) at->is_background = true;
    }
    std::size_t used = 0;
    for (const std::size_t contact : contacts_of_[i]) {
      const OwnPlanes& neighbour = own_[other_of(contacts_[contact], i)];
      if (!neighbour.main) continue;
      if (++used > kMaxNeighbours) break;
      add(found, region, *neighbour.main);
    }
    return background_px;
  }

  /// The share of the outline where the neighbours' main planes continue a plane.
  void compare_with_neighbours(std::size_t i, Candidate& candidate) const {
    double all = 0, smooth = 0, unhinted = 0;
    double on = 0, on_smooth = 0, on_unhinted = 0, on_objects = 0;
    for (const std::size_t number : contacts_of_[i]) {
      const ContactCues& contact = contacts_[number];
      const std::size_t other = other_of(contact, i);
      if (!own_[other].main) continue;
      const auto length = static_cast<double>(contact.length);
      const double x = centre_x_ + static_cast<double>(contact.x2) / (2 * length);
      const double y = centre_y_ + static_cast<double>(contact.y2) / (2 * length);
      const double edge = static_cast<double>(contact.edge_sum) / length / 4;
      const double weight = length / (1 + edge * edge / 64);
      const double outline = std::clamp(static_cast<double>(contact.outline) / length / 16, -6.0, 6.0);
      const double clear = length * (6 - outline) / 12;
      all += length, smooth += weight, unhinted += clear;
      if (std::abs(own_[other].main->at(x, y) - candidate.plane.at(x, y)) > kNearPlane) continue;
      on += length, on_smooth += weight, on_unhinted += clear;
      if (in_.chosen.object_of[other] != 0) on_objects += length;
    }
    const auto part = [](double sum, double of) { return of > 0 ? sum / of : double{kUnknown}; };
    candidate.agree = part(on, all);
    candidate.agree_smooth = part(on_smooth, smooth);
    candidate.agree_unhinted = part(on_unhinted, unhinted);
    candidate.agree_objects = part(on_objects, all);
  }

  /// Means over a group.
  struct GroupCues {
    double n = 0, x = 0, y = 0, d = 0, spread = 0, textured = 0, confidence = 0, object = 0;
  };
  [[nodiscard]] GroupCues cues_of(const Pixels& group) const {
    GroupCues of;
    double squares = 0;
    const View<const ObjectHint> hints = in_.cues.hints;
    for (const SuperpixelPixel& p : group) {
      of.x += p.x, of.y += p.y;
      of.d += double{p.disparity_px};
      squares += double{p.disparity_px} * double{p.disparity_px};
      of.textured += p.is_textured ? 1 : 0;
      of.confidence += double{p.confidence};
      if (hints.empty()) continue;
      const int column = p.x * hints.width() / size_.width;
      const int row = p.y * hints.height() / size_.height;
      of.object += hints(column, row).object / 16.0;
    }
    of.n = static_cast<double>(group.size());
    for (double* const sum : {&of.x, &of.y, &of.d, &of.textured, &of.confidence, &of.object}) *sum /= of.n;
    of.spread = std::sqrt(std::max(0.0, squares / of.n - of.d * of.d));
    return of;
  }

  /// A superpixel's numbers that its choices share.
  struct Judging {
    std::size_t superpixel;
    double pixels, known;  // samples, and those of them with a disparity
    double per_sample;     // pixels
    double background_px;
  };

  [[nodiscard]] PlaneFeatures features_of(const Judging& of, PixelGroup group, const GroupCues& seen,
                                          const Candidate& on, bool kept, double on_plane) const {
    const RegionCues& region = regions_[of.superpixel];
    const OwnPlanes& own = own_[of.superpixel];
    const auto unknown = double{kUnknown};
    const double d = kept && group != on_main ? seen.d : on.plane.at(seen.x, seen.y);
    const bool has_disparity = group != holes;
    const double hint = static_cast<double>(region.hints.object) / static_cast<double>(region.area) / 16;
    const std::array values{kept ? 1.0 : 0.0,
                            static_cast<double>(group),
                            seen.n / of.pixels,
                            of.per_sample * seen.n / static_cast<double>(size_.area()),
                            has_disparity ? seen.textured : unknown,
                            has_disparity ? seen.spread : unknown,
                            has_disparity && !in_.confidence.empty() ? seen.confidence : unknown,
                            has_disparity ? d - seen.d : unknown,
                            own.main ? d - own.main->at(seen.x, seen.y) : unknown,
                            d - of.background_px,
                            d / std::max(1.0, double{range_[1]}),
                            !kept && on.is_ground ? 1.0 : 0.0,
                            !kept && on.is_background ? 1.0 : 0.0,
                            of.known / of.pixels,
                            on.matched_on,
                            own.main_share,
                            on_plane,
                            on.agree,
                            on.agree_smooth,
                            on.agree_unhinted,
                            on.agree_objects,
                            in_.cues.hints.empty() ? unknown : seen.object,
                            in_.cues.hints.empty() ? unknown : hint,
                            in_.chosen.object_of[of.superpixel] != 0 ? 1.0 : 0.0,
                            seen.y / size_.height};
    PlaneFeatures features{};
    std::transform(values.begin(), values.end(), features.begin(),
                   [](double v) { return static_cast<float>(v); });
    return features;
  }

  /// Appends the choices of each group.
  void judge(std::size_t i, Work& work) {
    collect(i, work.pixels);
    for (Pixels& group : work.groups) group.clear();
    for (const SuperpixelPixel& p : work.pixels) work.groups[own_[i].group_of(p)].push_back(p);
    for (std::size_t g = 0; g < holes; ++g) work.points[g].set(work.groups[g]);
    const auto pixels = static_cast<double>(work.pixels.size());
    const double known = pixels - static_cast<double>(work.groups[holes].size());
    const double per_sample = 2.0 * stride_of(i) * stride_of(i);
    const Judging judging{i, pixels, known, per_sample, list_candidates(i, work.candidates)};
    for (Candidate& candidate : work.candidates) {
      count_pixels_on(work.points, known, candidate);
      compare_with_neighbours(i, candidate);
    }
    for (std::size_t g = 0; g < kGroups; ++g) judge_group(judging, static_cast<PixelGroup>(g), work);
  }

  void count_pixels_on(const std::array<PixelArrays, holes>& groups, double known,
                       Candidate& candidate) const {
    const GroundPlane plane = in_floats(candidate.plane);
    const float within = std::nextafter(kOnPlane, 2.0F);  // count_on() counts what is closer
    std::size_t sum = 0;
    for (std::size_t g = 0; g < holes; ++g)
      sum += candidate.on[g] = slot(count_on_(groups[g].points(), plane, within));
    candidate.matched_on = static_cast<double>(sum) / std::max(1.0, known);
  }

  void judge_group(const Judging& of, PixelGroup group, Work& work) {
    const Pixels& pixels = work.groups[group];
    if (pixels.size() >= kMinGroup && !work.candidates.empty()) {
      const std::size_t first = work.features.size();
      const GroupCues seen = cues_of(pixels);
      if (group != holes) {
        Candidate as_it_is = group == on_main ? work.candidates.front() : Candidate{{0, 0, seen.d}};
        if (group != on_main) {
          count_pixels_on(work.points, of.known, as_it_is);
          compare_with_neighbours(of.superpixel, as_it_is);
        }
        work.planes.emplace_back();
        work.features.push_back(features_of(of, group, seen, as_it_is, true, 1));
      }
      for (const Candidate& candidate : work.candidates) {
        work.planes.emplace_back(candidate.plane);
        const double on = static_cast<double>(candidate.on[group]) / seen.n;
        work.features.push_back(features_of(of, group, seen, candidate, false, on));
      }
      const auto superpixel = static_cast<std::int32_t>(of.superpixel);
      for (std::size_t k = first; k < work.features.size() && on_judged_; ++k)
        on_judged_({superpixel, group, pixels, of.per_sample, work.planes[k], work.features[k]});
    }
    work.ends.push_back(work.features.size());
  }

  void choose(Work& work) const {
    const std::vector<std::span<const float>> samples(work.features.begin(), work.features.end());
    const std::vector<float> log_odds = right_plane_(samples, exec_);
    std::size_t k = 0;
    for (std::size_t group = 0; group < work.ends.size(); ++group) {
      Chosen best{{}, group % kGroups == on_main ? 0.0F : kFewPixels};
      float most = -1;
      for (; k < work.ends[group]; ++k) {
        const float likely = likelihood(log_odds[k]) + (work.planes[k] ? 0 : kPreferred);
        if (likely <= most) continue;
        most = likely;
        best = {work.planes[k], log_odds[k]};
      }
      work.chosen.push_back(best);
    }
  }

  /// All pixels of a superpixel. `chosen`: of its groups.
  void write(std::size_t i, const Chosen* chosen, Work& work) {
    const RegionCues& region = regions_[i];
    kernels::SuperpixelPlanes planes{in_floats(own_[i].main), in_floats(own_[i].second), {}};
    std::array<float, kGroups> kept{};  // log-odds, without those of the match
    for (std::size_t g = 0; g < kGroups; ++g) {
      planes.chosen[g] = in_floats(chosen[g].plane);
      kept[g] = kKeptBias + kKeptChoice * chosen[g].log_odds;
    }
    work.refined_px.resize(slot(size_.width));
    work.group_of.resize(slot(size_.width));
    for (int y = region.top; y <= region.bottom; ++y) {
      const RegionId* const label = in_.superpixels.labels.row(y);
      const float* const matched = in_.cues.disparity_px.row(y);
      const float* const sure = in_.confidence.empty() ? nullptr : in_.confidence.row(y);
      float* const refined = out_.disparity_px.row(y);
      float* const confidence = out_.confidence.row(y);
      take_planes_(matched, y, region.left, region.right + 1, planes, range_[0], range_[1],
                   work.refined_px.data(), work.group_of.data());
      for (int x = region.left; x <= region.right; ++x) {
        // By runs and without branches, because what is kept is unpredictable.
        for (; x <= region.right && index(label[x]) == i; ++x) {
          const float d = work.refined_px[slot(x - region.left)];
          const auto group = slot(work.group_of[slot(x - region.left)]);
          const float of_match = sure ? sure[x] : 0.0F;
          const bool is_own = (d == matched[x]) & (of_match > 0);  // a match's own
          const float odds =
              is_own ? kept[group] + kKeptMatch * tables_.odds_of(of_match) : chosen[group].log_odds;
          const float likely = tables_.likelihood_of(odds);
          refined[x] = d;
          confidence[x] = d == d ? likely : 0;
        }
      }
    }
  }

  const RefinementCues& in_;
  const FittedTrees& right_plane_;
  const Exec& exec_;
  decltype(kernels::PlaneKernels::count_on) count_on_;
  decltype(kernels::CueKernels::take_planes) take_planes_;
  const std::function<void(const JudgedPlane&)>& on_judged_;
  const std::vector<RegionCues>& regions_;
  const std::vector<ContactCues>& contacts_;
  const Tables& tables_ = tables();
  Size size_;
  int centre_x_, centre_y_;     // of the image, as the statistics have it
  std::array<float, 2> range_;  // of all disparities
  std::vector<OwnPlanes> own_;
  std::vector<std::vector<std::size_t>> contacts_of_;  // of each superpixel, the longest first
  RefinedDisparity out_;
};

}  // namespace

std::array<std::string_view, kPlaneFeatures> plane_feature_names() {
  return kNames;
}

float disparity_on(const std::optional<DisparityPlane>& plane, const SuperpixelPixel& pixel) {
  if (!plane) return pixel.disparity_px;
  const float on = in_floats(plane).disparity_px(static_cast<float>(pixel.x), static_cast<float>(pixel.y));
  return std::abs(pixel.disparity_px - on) <= kOnPlane ? pixel.disparity_px : on;
}

RefinedDisparity refine_disparity(const RefinementCues& cues, const FittedTrees& right_plane,
                                  const Exec& exec,
                                  const std::function<void(const JudgedPlane&)>& on_judged) {
  return Refiner(cues, right_plane, exec, on_judged).run();
}

const FittedTrees& plane_classifier() {
  static const FittedTrees trees = load_trees(fitted::right_plane());
  return trees;
}

RefinedDisparity without_sky(RefinedDisparity refined, View<const Reject> reject) {
  for (int y = 0; y < reject.height(); ++y) {
    const Reject* const reasons = reject.row(y);
    for (int x = 0; x < reject.width(); ++x) {
      if (!has(reasons[x], Reject::sky)) continue;
      refined.disparity_px(x, y) = kNan;
      refined.confidence(x, y) = 0;
    }
  }
  return refined;
}

DisparityMap likely_disparities(const RefinedDisparity& refined, View<const Reject> reject,
                                float min_confidence, const Exec& exec) {
  const Size size = refined.disparity_px.size();
  DisparityMap map{Image<float>(size, exec.pool), Image<Reject>(size, exec.pool)};
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const float d = refined.disparity_px(x, y);
      const bool likely = !std::isnan(d) && refined.confidence(x, y) >= min_confidence;
      map.disparity_px(x, y) = likely ? d : kNan;
      map.reject(x, y) = likely ? Reject::none : reject(x, y) | Reject::unlikely;
    }
  }
  return map;
}

}  // namespace cairn
