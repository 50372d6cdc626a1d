// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/robust_fit.hpp>
#include <cairn/diagnosis/diagnose.hpp>
#include <cmath>
#include <cstdio>
#include <tuple>

namespace cairn {
namespace {

constexpr double kDegrees = 57.29577951308232;

template <class Is>
double share_of(View<const Reject> reject, Is is) {
  std::int64_t count = 0;
  for (int y = 0; y < reject.height(); ++y)
    count += std::count_if(reject.row(y), reject.row(y) + reject.width(), is);
  return static_cast<double>(count) / static_cast<double>(reject.size().area());
}
double known_share(const DisparityMap& map) {
  return share_of(map.reject, [](Reject r) { return r == Reject::none; });
}
double share_below_floor(const DisparityMap& map) {
  return share_of(map.reject, [](Reject r) { return has(r, Reject::below_ground); });
}

std::string text_of(const char* format, double value) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}
std::string percent_text(double share) {
  return text_of("%.0f %%", 100 * share);
}

/// The input of the checks, and their findings.
struct Case {
  const PairMeasures& measures;
  const std::optional<StereoRig>& rig;
  const MatchConfig& range;
  const DiagnosisConfig& config;
  std::vector<Finding> findings{};

  void add(FindingKind kind, Severity severity, double value, std::string says,
           Camera camera = Camera::pair) {
    findings.push_back({kind, severity, value, std::move(says), {}, camera});
  }
  /// A warning from `warn` on, broken from `broken` on.
  static std::optional<Severity> severity(double value, float warn, float broken) {
    if (value >= static_cast<double>(broken)) return Severity::broken;
    if (value >= static_cast<double>(warn)) return Severity::warning;
    return std::nullopt;
  }
  [[nodiscard]] double share_below(double disparity_px) const {
    const auto& d = measures.disparities_px;
    const auto at = std::lower_bound(d.begin(), d.end(), static_cast<float>(disparity_px));
    return d.empty() ? 0.0 : static_cast<double>(at - d.begin()) / static_cast<double>(d.size());
  }
};

/// Whether the points share an epipolar geometry, which all further checks require.
bool check_points(Case& c) {
  const RowAlignment& rows = c.measures.rows;
  const int textured = c.measures.textured_points;
  const int agreeing = rows.agreeing;
  const bool enough = agreeing >= c.config.least_points;
  if (!enough && textured < c.config.least_textured) {
    c.add(FindingKind::few_points, Severity::note, agreeing,
          "the left image has " + std::to_string(textured) + " textured points, and " +
              std::to_string(agreeing) + " of them are found in the right one");
    return false;
  }
  if (!enough || 100 * rows.agreeing_share() < static_cast<double>(c.config.least_agreeing)) {
    c.add(FindingKind::nothing_in_common, Severity::broken, 100 * rows.agreeing_share(),
          "of " + std::to_string(textured) + " textured points " + std::to_string(rows.points) +
              " are found in the right image, and " + std::to_string(agreeing) +
              " of these are consistent with one geometry");
    return false;
  }
  return true;
}

/// Whether enough points are consistent to judge their disparities: some always are by chance, as in a
/// mirrored image.
bool is_certain(const PairMeasures& measures, const DiagnosisConfig& config) {
  const RowAlignment& rows = measures.rows;
  return static_cast<int>(measures.disparities_px.size()) >= config.least_points &&
         (rows.agreeing >= config.least_certain ||
          100 * rows.agreeing_share() >= static_cast<double>(config.least_certain_share));
}

/// True if both images are the same: all pixels equal, or nearly all points at disparity 0.
bool check_same(Case& c) {
  const PairMeasures& measures = c.measures;
  constexpr double kNoDisparity = 0.25;  // px
  const double zeros = c.share_below(kNoDisparity) - c.share_below(-kNoDisparity);
  const bool is_plain = measures.left_exposure.contrast == 0;  // a black image equals any other
  if (measures.identical && !is_plain) {
    c.add(FindingKind::same_picture, Severity::broken, 100, "all pixels are equal in both");
    return true;
  }
  if (static_cast<int>(measures.disparities_px.size()) < c.config.least_points ||
      100 * zeros < static_cast<double>(c.config.break_same)) {
    return false;
  }
  c.add(FindingKind::same_picture, Severity::broken, 100 * zeros,
        percent_text(zeros) + " of " + std::to_string(measures.disparities_px.size()) +
            " points have a disparity of 0, within " + text_of("%g px", kNoDisparity) +
            " (or the whole scene is infinitely far away)");
  return true;
}

/// True if the points move along columns, as between cameras one above the other.
bool check_columns(Case& c) {
  if (!c.measures.vertical_rows || c.measures.identical) return false;
  const auto rows = static_cast<double>(*c.measures.vertical_rows);
  // Rotated counter-clockwise, a column becomes a row, its top the left end.
  c.add(
      FindingKind::one_above_other, Severity::broken, rows,
      "the points move along the columns, by " + text_of("%+.1f rows", rows) +
          " from left to right image (median), and hardly along the rows: rotate both images by 90 degrees " +
          (rows < 0 ? "counter-clockwise" : "clockwise"));
  return true;
}

/// True if nearly all disparities are negative and outside the range, but inside it after exchanging the
/// images. With doffs > 0 negative disparities are valid, but a positive range does not expect them.
bool fits_exchanged(const Case& c) {
  const double first = c.range.min_disparity;
  const double last = first + c.range.num_disparities - 1;
  const double inside = c.share_below(last + 1) - c.share_below(first - 1);
  const double inside_exchanged = c.share_below(1 - first) - c.share_below(-last - 1);
  return 100 * (1 - inside) >= static_cast<double>(c.config.break_beyond) &&
         100 * inside_exchanged >= static_cast<double>(c.config.break_swapped);
}

/// True if the cameras are not swapped. Where the calibration allows both orders (cameras that converge, with a
/// doffs), what is nearer decides: the lower part of the image is, as a rule.
bool check_order(Case& c) {
  const double doffs = c.rig ? static_cast<double>(c.rig->doffs_px) : 0.0;
  const double negative = c.share_below(-1);
  const double impossible = c.share_below(std::min(0.0, -doffs) - 1);
  const auto limit = static_cast<double>(c.config.break_swapped);
  const bool is_exchanged = 100 * negative >= limit && fits_exchanged(c) && c.measures.nearer_below < 0;
  if (100 * impossible < limit && !is_exchanged) return true;
  c.add(FindingKind::swapped, Severity::broken, 100 * negative,
        percent_text(negative) + " of " + std::to_string(c.measures.disparities_px.size()) +
            " points have a negative disparity, median " + text_of("%+.1f px", c.measures.disparity_px(0.5)));
  return false;
}

void check_rows(Case& c) {
  const RowAlignment& rows = c.measures.rows;
  const auto left_over = static_cast<double>(rows.left_over_rows);
  const auto distorted = Case::severity(left_over, c.config.warn_left_over, c.config.break_left_over);
  if (distorted) {
    c.add(FindingKind::rectification, *distorted, left_over,
          "1 point in 10 is " + text_of("%.1f rows", left_over) + " or more off even without shift and roll");
  }
  const auto slope = static_cast<double>(rows.rows_per_px);
  const double worse =
      std::abs(static_cast<double>(rows.offset_rows)) + std::abs(slope) * 0.5 * (c.measures.size.width - 1);
  if (const auto severity = Case::severity(worse, c.config.warn_rows, c.config.break_rows);
      severity && (!distorted || *severity > *distorted)) {
    c.add(FindingKind::rows, *severity, worse,
          "the right image is " + text_of("%+.2f rows", static_cast<double>(rows.offset_rows)) +
              " lower at its centre, rotated by " + text_of("%+.2f degrees", kDegrees * std::atan(slope)) +
              ": " + text_of("%.2f rows", worse) + " at its worse side");
  }
}

/// The smallest range, a multiple of 16, that includes `nearest` with a quarter to spare, as far as an image of this
/// width allows.
int suggested_range(double nearest, int width) {
  const int most = std::max(1, std::min(1024, width) / 16);
  return 16 * std::clamp(static_cast<int>(std::ceil(1.25 * nearest / 16)), 1, most);
}

void check_range(Case& c) {
  const double first = c.range.min_disparity;
  const double last = first + c.range.num_disparities - 1;
  const double nearest = c.measures.disparity_px(0.98);
  const double furthest = c.measures.disparity_px(0.02);
  const double beyond = c.share_below(first - 1) + 1 - c.share_below(last + 1);
  const double points_beyond = beyond * static_cast<double>(c.measures.disparities_px.size());
  const bool is_chance = 100 * beyond < static_cast<double>(c.config.break_beyond) &&
                         points_beyond < static_cast<double>(c.config.least_points);
  if (const auto severity = Case::severity(100 * beyond, c.config.warn_beyond, c.config.break_beyond);
      severity && !is_chance) {
    const int from =
        furthest < first - 1 ? static_cast<int>(std::floor(furthest)) - 4 : c.range.min_disparity;
    c.add(FindingKind::range_too_small, *severity, 100 * beyond,
          percent_text(beyond) + " of the points are outside " + text_of("%.0f", first) +
              text_of(" ... %.0f px", last) + "; nearly all are in " + text_of("%.0f", furthest) +
              text_of(" ... %.0f px", nearest) + ": match.min_disparity=" + std::to_string(from) +
              ", match.num_disparities=" +
              std::to_string(suggested_range(nearest - from, c.measures.size.width)));
    return;
  }
  const double use = (nearest - first) / (last - first + 1);
  constexpr int kSmallRange = 64;
  if (c.range.num_disparities <= kSmallRange || 100 * use >= static_cast<double>(c.config.least_range_use))
    return;
  c.add(FindingKind::range_too_large, Severity::note, 100 * use,
        "the nearest points have " + text_of("%.0f px", nearest) + " of a range up to " +
            text_of("%.0f px", last) + ": match.num_disparities=" +
            std::to_string(suggested_range(nearest - first, c.measures.size.width)) + " would do");
}

/// For segmented frames: disparities pile up at the end of a range that is too small.
void check_end_of_range(Case& c, const DisparityMap& map) {
  const int last = c.range.min_disparity + c.range.num_disparities - 1;
  std::int64_t known = 0;
  std::int64_t at_end = 0;
  for (int y = 0; y < map.disparity_px.height(); ++y) {
    const float* row = map.disparity_px.row(y);
    for (int x = 0; x < map.disparity_px.width(); ++x) {
      known += std::isnan(row[x]) ? 0 : 1;
      at_end += row[x] >= static_cast<float>(last - 1) ? 1 : 0;
    }
  }
  const double share = known > 0 ? static_cast<double>(at_end) / static_cast<double>(known) : 0.0;
  if (100 * share < static_cast<double>(c.config.warn_at_end)) return;
  c.add(FindingKind::range_too_small, Severity::warning, 100 * share,
        percent_text(share) + " of the disparities are in the last 2 px of " +
            std::to_string(c.range.min_disparity) + text_of(" ... %.0f px", last) +
            ", so nearer objects are lost: match.num_disparities=" +
            std::to_string(suggested_range(1.6 * c.range.num_disparities, map.disparity_px.width())));
}

/// For segmented frames.
void check_floor(Case& c, const Frame& frame) {
  if (frame.ground.refusal == Refusal::off) return;
  if (frame.ground.plane) {
    const double below = 100 * share_below_floor(frame.disparity);
    if (below < static_cast<double>(c.config.note_below_floor)) return;
    c.add(FindingKind::below_floor, Severity::note, below,
          text_of("%.0f %%", below) + " of the pixels were refused as below the floor, on which " +
              text_of("%.0f %%", 100 * static_cast<double>(frame.ground.support)) +
              " of the disparities lie");
    return;
  }
  c.add(FindingKind::no_floor, Severity::note, 100 * known_share(frame.disparity),
        choice_name(frame.ground.refusal, kRefusals));
}

void check_infinity(Case& c) {
  const double doffs = c.rig ? static_cast<double>(c.rig->doffs_px) : 0.0;
  const double behind = c.share_below(-doffs - 1);
  const auto severity = Case::severity(100 * behind, c.config.warn_behind, c.config.break_behind);
  if (!severity) return;
  c.add(FindingKind::behind_infinity, *severity, 100 * behind,
        percent_text(behind) + " of the points have d + doffs below -1 px (doffs " + text_of("%.1f", doffs) +
            ", the furthest " + text_of("%.1f px", c.measures.disparity_px(0.02)) + ")");
}

Camera camera_of(bool left, bool right) {
  if (left == right) return Camera::pair;
  return left ? Camera::left : Camera::right;
}

void check_border(Case& c) {
  const auto left = 100 * static_cast<double>(c.measures.left_exposure.border);
  const auto right = 100 * static_cast<double>(c.measures.right_exposure.border);
  if (std::max(left, right) < static_cast<double>(c.config.warn_clipped)) return;
  c.add(FindingKind::border, Severity::note, std::max(left, right),
        text_of("%.0f %%", left) + " of the left image and " + text_of("%.0f %%", right) +
            " of the right one are black borders");
}

void check_clipping(Case& c) {
  const Exposure& left = c.measures.left_exposure;
  const Exposure& right = c.measures.right_exposure;
  const auto clipped = [](const Exposure& e) { return static_cast<double>(std::max(e.white, e.black)); };
  const auto limit = static_cast<double>(c.config.warn_clipped);
  const double worse = std::max(clipped(left), clipped(right));
  const auto severity = Case::severity(100 * worse, c.config.warn_clipped, c.config.break_clipped);
  if (!severity) return;
  std::string says;
  for (const auto& [exposure, first, second] :
       {std::tuple{&left, "in the left image ", ""},
        std::tuple{&right, "in the right image ", ", in the right one "}}) {
    if (100 * clipped(*exposure) < limit) continue;
    says += (says.empty() ? first : second) + percent_text(clipped(*exposure)) + " of the pixels are " +
            (exposure->white >= exposure->black ? "white (254, 255)" : "black (0, 1)");
  }
  c.add(FindingKind::exposure, *severity, 100 * worse, says,
        camera_of(100 * clipped(left) >= limit, 100 * clipped(right) >= limit));
}

void check_contrast(Case& c) {
  const float left = c.measures.left_exposure.contrast;
  const float right = c.measures.right_exposure.contrast;
  const bool is_left = left < c.config.least_contrast;
  const bool is_right = right < c.config.least_contrast;
  if (!is_left && !is_right) return;
  const auto levels = [](float contrast) { return text_of("%.0f of 255", static_cast<double>(contrast)); };
  std::string says = "the levels of the left image span " + levels(left);
  if (is_left && is_right) says += ", those of the right one " + levels(right);
  if (!is_left) says = "the levels of the right image span " + levels(right);
  c.add(FindingKind::dark, Severity::warning, static_cast<double>(std::min(left, right)), says,
        camera_of(is_left, is_right));
}

void check_brightness(Case& c) {
  const BrightnessDifference& b = c.measures.brightness;
  if (b.median < c.config.warn_brightness) return;
  c.add(FindingKind::brightness, Severity::warning, static_cast<double>(b.median),
        "right = " + text_of("%.2f", static_cast<double>(b.gain)) + " x left " +
            text_of("%+.0f", static_cast<double>(b.offset)) + " grey levels; median difference " +
            text_of("%.0f", static_cast<double>(b.median)));
}

void check_sharpness(Case& c) {
  const auto left = static_cast<double>(c.measures.left_sharpness.edge_px);
  const auto right = static_cast<double>(c.measures.right_sharpness.edge_px);
  const auto limit = static_cast<double>(c.config.warn_edge);
  const auto ratio = static_cast<double>(c.config.warn_edge_ratio);
  if (left == 0 || right == 0) return;
  const double worse = std::max(left, right);
  const std::string numbers = text_of("left %.1f px", left) + text_of(", right %.1f px", right);
  if (std::min(left, right) >= limit) {
    c.add(FindingKind::blur, Severity::warning, worse, "edges are wide in both images: " + numbers);
    return;
  }
  // Noise makes edges narrower, so a ratio alone does not show which camera is at fault.
  const bool is_unequal =
      worse >= static_cast<double>(c.config.least_unequal_edge) && worse >= ratio * std::min(left, right);
  if (worse < limit && !is_unequal) return;
  c.add(FindingKind::blur, Severity::warning, worse,
        "edges are wide in the " + std::string(left > right ? "left" : "right") + " image: " + numbers,
        camera_of(left > right, right > left));
}

/// Checks the calibration against the size of the images.
void check_camera(Case& c) {
  if (!c.rig) return;
  const StereoRig& rig = *c.rig;
  const Size size = c.measures.size;
  const double view = 2 * kDegrees * std::atan(0.5 * size.width / static_cast<double>(rig.focal_px));
  constexpr double kNarrowest = 10;
  constexpr double kWidest = 140;
  if (view < kNarrowest || view > kWidest) {
    c.add(FindingKind::calibration, Severity::broken, static_cast<double>(rig.focal_px),
          "a focal length of " + text_of("%g px", static_cast<double>(rig.focal_px)) + " sees " +
              text_of("%.1f degrees", view) + " on " + std::to_string(size.width) +
              " columns (in millimetres, or of another size?)");
  }
  const double off_x = std::abs(static_cast<double>(rig.cx_px) / size.width - 0.5);
  const double off_y = std::abs(static_cast<double>(rig.cy_px) / size.height - 0.5);
  constexpr double kFurthest = 0.3;
  if (std::max(off_x, off_y) > kFurthest) {
    c.add(FindingKind::calibration, Severity::broken,
          static_cast<double>(off_x > off_y ? rig.cx_px : rig.cy_px),
          "the principal point (" + text_of("%.0f, ", static_cast<double>(rig.cx_px)) +
              text_of("%.0f", static_cast<double>(rig.cy_px)) + ") is far from the centre of " + text(size) +
              " images: a calibration for another size?");
  }
}

/// Checks for distances that are implausible with a stereo camera, as from a wrong unit of the baseline.
void check_distances(Case& c) {
  if (!c.rig) return;
  const double scale = static_cast<double>(c.rig->focal_px) * static_cast<double>(c.rig->baseline_m);
  const auto doffs = static_cast<double>(c.rig->doffs_px);
  const double nearest = scale / std::max(0.5, c.measures.disparity_px(0.98) + doffs);
  const double furthest = scale / std::max(0.5, c.measures.disparity_px(0.05) + doffs);
  constexpr double kNearestBeyond = 200;
  constexpr double kFurthestWithin = 0.04;
  const auto baseline = static_cast<double>(c.rig->baseline_m);
  const std::string words = "with a baseline of " + text_of("%g m", baseline);
  if (nearest > kNearestBeyond || furthest < kFurthestWithin) {
    const bool far = nearest > kNearestBeyond;
    c.add(FindingKind::calibration, Severity::broken, baseline,
          words + (far ? " the nearest points would be " : " the furthest points would be ") +
              text_of("%.3g m away", far ? nearest : furthest) + ": a wrong unit of length?");
    return;
  }
  // Centimetres given as metres: a baseline of 1 m or more is rare, and used for far scenes.
  constexpr double kLongBaseline = 1;
  const bool is_far = baseline >= kLongBaseline && nearest >= static_cast<double>(c.config.warn_nearest);
  if (baseline <= static_cast<double>(c.config.warn_baseline) && !is_far) return;
  c.add(FindingKind::calibration, Severity::warning, baseline,
        words + " the nearest points are " + text_of("%.3g m away; ", nearest) +
            text_of("%.3g m if that is in centimetres: metres are expected", nearest / 100));
}

/// The points with a disparity similar to that of one of the nearest points, by ascending disparity. False matches
/// are rarely similar to their neighbours.
std::vector<Correspondence> supported_ones(const std::vector<Correspondence>& points) {
  constexpr std::size_t kNeighbours = 4;
  constexpr float kAlike = 0.15F;
  constexpr float kAlikePx = 3;
  std::vector<Correspondence> supported;
  std::vector<std::pair<float, float>> nearest;  // squared distance, disparity
  for (const Correspondence& c : points) {
    nearest.clear();
    for (const Correspondence& other : points) {
      const float x = other.x_left - c.x_left;
      const float y = other.y_left - c.y_left;
      nearest.emplace_back(x * x + y * y, other.disparity());
    }
    const std::size_t count = std::min(nearest.size(), kNeighbours + 1);
    std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count), nearest.end());
    const float tolerance = std::max(kAlikePx, kAlike * std::abs(c.disparity()));
    int alike = 0;
    for (std::size_t i = 0; i < count; ++i)
      alike += std::abs(nearest[i].second - c.disparity()) <= tolerance ? 1 : 0;
    if (alike > 1) supported.push_back(c);  // the count includes the point itself
  }
  std::sort(supported.begin(), supported.end(),
            [](const Correspondence& a, const Correspondence& b) { return a.disparity() < b.disparity(); });
  return supported;
}

/// Pearson's correlation of row and disparity; 0 if one of them does not vary.
float nearer_below(const std::vector<Correspondence>& points) {
  double n = 0;
  double y = 0;
  double d = 0;
  double yy = 0;
  double yd = 0;
  double dd = 0;
  for (const Correspondence& c : points) {
    const auto row = static_cast<double>(c.y_left);
    const auto disparity = static_cast<double>(c.disparity());
    n += 1;
    y += row;
    d += disparity;
    yy += row * row;
    yd += row * disparity;
    dd += disparity * disparity;
  }
  const double spread = (n * yy - y * y) * (n * dd - d * d);
  return spread > 0 ? static_cast<float>((n * yd - y * d) / std::sqrt(spread)) : 0.0F;
}

/// PairMeasures::vertical_rows: all points move by much along the columns and by nothing along the rows, or by far
/// more different amounts.
std::optional<float> rows_of_vertical(const std::vector<Correspondence>& points) {
  constexpr std::size_t kMinPoints = 30;
  constexpr float kStill = 1;      // px along the rows
  constexpr float kMoved = 4.5F;   // rows; beyond what the epipolar correction undoes
  constexpr float kRatio = 4;      // of the spreads
  constexpr float kMinSpread = 2;  // rows
  if (points.size() < kMinPoints) return std::nullopt;
  std::vector<float> along;
  std::vector<float> down;
  for (const Correspondence& c : points) {
    along.push_back(c.disparity());
    down.push_back(c.rows());
  }
  std::sort(along.begin(), along.end());
  std::sort(down.begin(), down.end());
  const auto tenths = [&](const std::vector<float>& sorted, std::size_t k) {
    return sorted[k * (sorted.size() - 1) / 10];
  };
  const float spread_along = tenths(along, 8) - tenths(along, 2);
  const float spread_down = tenths(down, 8) - tenths(down, 2);
  const float rows = tenths(down, 5);
  const bool is_still = spread_along <= kStill && std::abs(tenths(along, 5)) <= kStill;
  const bool is_of_one_sign = tenths(down, 1) * tenths(down, 9) > 0;
  const bool is_deep = spread_down >= std::max(kMinSpread, kRatio * spread_along) && is_of_one_sign;
  if (!(is_still && std::abs(rows) >= kMoved) && !is_deep) return std::nullopt;
  return rows;
}

/// A sample of a few thousand disparities, ascending.
std::vector<float> some_disparities(View<const float> disparity_px) {
  constexpr std::int64_t kMax = 4096;
  const std::int64_t area = disparity_px.size().area();
  const std::int64_t step = std::max<std::int64_t>(1, area / kMax) | 1;  // odd, to sample all columns
  std::vector<float> some;
  for (std::int64_t i = 0; i < area; i += step) {
    const float d =
        disparity_px(static_cast<int>(i % disparity_px.width()), static_cast<int>(i / disparity_px.width()));
    if (!std::isnan(d)) some.push_back(d);
  }
  std::sort(some.begin(), some.end());
  return some;
}

bool are_equal(View<const Gray> left, View<const Gray> right) {
  for (int y = 0; y < left.height(); ++y) {
    if (!std::equal(left.row(y), left.row(y) + left.width(), right.row(y))) return false;
  }
  return true;
}

}  // namespace

double PairMeasures::disparity_px(double share) const {
  if (disparities_px.empty()) return std::nan("");
  const auto last = static_cast<double>(disparities_px.size() - 1);
  return static_cast<double>(disparities_px[static_cast<std::size_t>(std::lround(share * last))]);
}

PairMeasures measure_pair(const StereoPair& pair, const Exec& exec) {
  const Correspondences found = find_correspondences(pair, exec);
  const Correspondences agreeing = agreeing_ones(found);
  PairMeasures measures;
  measures.size = pair.size();
  measures.identical = are_equal(pair.left(), pair.right());
  measures.textured_points = found.points;
  measures.rows = measure_row_alignment(found);
  const std::vector<Correspondence> supported = supported_ones(agreeing.list);
  for (const Correspondence& c : supported) measures.disparities_px.push_back(c.disparity());
  measures.nearer_below = nearer_below(supported);
  measures.vertical_rows = rows_of_vertical(found.list);
  measures.brightness = measure_brightness_difference(pair, agreeing);
  measures.left_exposure = measure_exposure(pair.left());
  measures.right_exposure = measure_exposure(pair.right());
  measures.left_sharpness = measure_sharpness(pair.left(), measures.left_exposure.contrast);
  measures.right_sharpness = measure_sharpness(pair.right(), measures.right_exposure.contrast);
  return measures;
}

std::vector<Finding> diagnose(const PairMeasures& measures, const std::optional<StereoRig>& rig,
                              const MatchConfig& range, const DiagnosisConfig& config) {
  Case c{measures, rig, range, config};
  check_camera(c);
  if (!check_columns(c) && !check_same(c) && check_points(c)) {
    if (is_certain(measures, config) && check_order(c)) {
      check_distances(c);
      check_range(c);
      check_infinity(c);
    }
    check_rows(c);
    check_brightness(c);
  }
  check_border(c);
  check_clipping(c);
  check_contrast(c);
  check_sharpness(c);
  return united({c.findings});
}

std::vector<SkippedCheck> not_checked(const PairMeasures& measures, const std::optional<StereoRig>& rig,
                                      const DiagnosisConfig& config) {
  std::vector<SkippedCheck> all;
  const RowAlignment& rows = measures.rows;
  if (!rig) all.push_back({"calibration and distances", "no calibration with a baseline was given", false});
  const std::string found = std::to_string(rows.agreeing) + " of " + std::to_string(rows.points) +
                            " points are consistent with one geometry";
  const auto too_few = [&](std::string_view check, int least) {
    if (rows.agreeing < least) all.push_back({check, found + ", expected " + std::to_string(least)});
  };
  if (!is_certain(measures, config)) {
    const std::size_t supported = measures.disparities_px.size();
    all.push_back({"order of the cameras and disparity range",
                   static_cast<int>(supported) < config.least_points
                       ? std::to_string(supported) +
                             " points have a disparity similar to their neighbours, expected " +
                             std::to_string(config.least_points)
                       : found + ", expected " + std::to_string(config.least_certain) +
                             text_of(", or %g %% of them", static_cast<double>(config.least_certain_share))});
  }
  too_few("shift of the rows", config.least_points);
  too_few("rotation of the right image", RowAlignment::kMinForRoll);
  too_few("rectification", RowAlignment::kMinForField);
  if (!measures.brightness.is_measured()) {
    all.push_back({"equal brightness", std::to_string(measures.brightness.points) +
                                           " windows could be compared, expected " +
                                           std::to_string(BrightnessDifference::kMinPoints)});
  }
  const int edges = std::min(measures.left_sharpness.edges, measures.right_sharpness.edges);
  if (edges < Sharpness::kMinEdges) {
    all.push_back({"focus", std::to_string(edges) + " edges in the poorer image, expected " +
                                std::to_string(Sharpness::kMinEdges)});
  }
  return all;
}

std::vector<Finding> diagnose(const Frame& frame, View<const Gray> left, View<const Gray> right,
                              const std::optional<StereoRig>& rig, const Config& config,
                              const DiagnosisConfig& limits) {
  PairMeasures measures;
  measures.size = left.size();
  measures.identical = !right.empty() && are_equal(left, right);
  measures.left_exposure = measure_exposure(left);
  measures.right_exposure = right.empty() ? measures.left_exposure : measure_exposure(right);
  measures.disparities_px = some_disparities(frame.disparity.disparity_px);
  if (frame.epipolar.outcome == EpipolarOutcome::corrected) {
    measures.rows.offset_rows = frame.epipolar.rows;
    measures.rows.rows_per_px = frame.epipolar.rows_per_px;
  }
  Case c{measures, rig, config.match, limits};
  check_camera(c);
  // A plain wall has disparities of 0, too.
  const bool has_points = frame.epipolar.outcome == EpipolarOutcome::aligned ||
                          frame.epipolar.outcome == EpipolarOutcome::corrected ||
                          (measures.identical && measures.left_exposure.contrast > 0);
  if (!has_points || !check_same(c)) {
    if (!measures.disparities_px.empty()) check_distances(c);
    check_rows(c);
    if (!right.empty()) check_end_of_range(c, frame.disparity);
  }
  check_border(c);
  check_clipping(c);
  check_contrast(c);
  check_floor(c, frame);
  return united({c.findings});
}

bool is_doubtful(const Frame& frame) {
  switch (frame.epipolar.outcome) {
    case EpipolarOutcome::few_points:
    case EpipolarOutcome::no_agreement:
      return true;
    case EpipolarOutcome::aligned:
    case EpipolarOutcome::corrected:
      return false;
    case EpipolarOutcome::off:
      break;
  }
  constexpr double kFew = 0.25;  // of what is no sky
  const double sky = share_of(frame.disparity.reject, [](Reject r) { return has(r, Reject::sky); });
  return known_share(frame.disparity) < kFew * (1 - sky);
}

std::vector<Finding> united(const std::vector<std::vector<Finding>>& of_pairs) {
  std::vector<Finding> all;
  for (const FindingInfo& kind : kFindings) {
    std::optional<Finding> worst;
    std::vector<std::size_t> frames;
    bool is_one_camera = true;
    for (std::size_t i = 0; i < of_pairs.size(); ++i) {
      for (const Finding& one : of_pairs[i]) {
        if (one.kind != kind.kind) continue;
        if (frames.empty() || frames.back() != i) frames.push_back(i);
        is_one_camera = is_one_camera && (!worst || one.camera == worst->camera);
        if (!worst || one.severity > worst->severity) worst = one;
      }
    }
    if (!worst) continue;
    if (kind.kind == FindingKind::range_too_large && frames.size() < of_pairs.size()) continue;
    worst->frames = std::move(frames);
    if (!is_one_camera && worst->camera != Camera::pair) {
      worst->says += std::string("; the ") + (worst->camera == Camera::left ? "right" : "left") +
                     " one's in other pairs";
      worst->camera = Camera::pair;
    }
    all.push_back(std::move(*worst));
  }
  return all;
}

}  // namespace cairn
