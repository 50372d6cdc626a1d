// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/odometry.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include <cairn/sequence/motion_fit.hpp>
#include <cairn/sequence/twist.hpp>

namespace cairn {

struct KeyCorner {
  Point3 in_key_m;
  cv::Point2f at_px;
};

struct Keyframe {
  cv::Size size;
  int win_size = 0;              // px: the pyramid's border
  std::vector<cv::Mat> pyramid;  // with derivatives
  cv::Mat small;                 // 32-bit float, see kSmall
  std::vector<KeyCorner> corners;
};

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kKeyframeTurn_rad = 20 * kRadians;
constexpr int kFramesUntilLost = 5;
constexpr int kCoherentSteps = 2;         // in consecutive frames
constexpr double kChi2Wheels = 22.46;     // χ² with 6 degrees of freedom, 0.999
constexpr double kChi2Gyroscope = 16.27;  // χ² with 3 degrees of freedom, 0.999
constexpr int kSlippingFrames = 3;

Matrix6 matrix(const Covariance6& rows) {
  return Eigen::Map<const RowMajor6>(rows.data());
}

Covariance6 rows_of(const Matrix6& matrix) {
  Covariance6 rows{};
  Eigen::Map<RowMajor6>(rows.data()) = matrix;
  return rows;
}

Eigen::Vector3d vector(Point3 p) {
  return {p.x, p.y, p.z};
}

Eigen::Matrix3d rotation_of(const Pose& pose) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(pose.rotation.data());
}

/// Adjoint for ξ with true = exp(ξ) · pose, in the target frame of `pose`.
Matrix6 adjoint(const Pose& pose) {
  const Eigen::Matrix3d r = rotation_of(pose);
  Matrix6 a = Matrix6::Zero();
  a.topLeftCorner<3, 3>() = r;
  a.topRightCorner<3, 3>() = skew(vector(pose.translation_m)) * r;
  a.bottomRightCorner<3, 3>() = r;
  return a;
}

/// Rotates the covariance of a motion from the axes of its end to those of the map.
Matrix6 along_map(const Covariance6& moved, const Pose& map_from_now) {
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = rotation_of(map_from_now);
  turn.bottomRightCorner<3, 3>() = rotation_of(map_from_now);
  return turn * matrix(moved) * turn.transpose();
}

/// Covariance of a pose in the map after a motion with the covariance `moved`, which is in the frame of the
/// camera at its end.
Covariance6 carried_on(const Covariance6& before, const Pose& map_from_before, const Covariance6& moved,
                       const Pose& map_from_now) {
  Matrix6 lever = Matrix6::Identity();
  lever.topRightCorner<3, 3>() = -skew(vector(map_from_now.translation_m - map_from_before.translation_m));
  return rows_of(lever * matrix(before) * lever.transpose() + along_map(moved, map_from_now));
}

// ---- images ----

cv::Mat borrowed(View<const Gray> image) {
  // cv::Mat has no const view; no function called here writes to its input.
  return {image.height(), image.width(), CV_8UC1, const_cast<Gray*>(image.row(0)),
          static_cast<std::size_t>(image.stride())};
}

constexpr int kSmallWidth = 40;  // px, width of the images for guess_turn()

cv::Mat small_image(const cv::Mat& image) {
  const double scale = double(kSmallWidth) / image.cols;
  const int rows = std::max(1, static_cast<int>(std::lround(image.rows * scale)));
  cv::Mat small;
  cv::resize(image, small, {kSmallWidth, rows}, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(small, small, {3, 3}, 0);
  small.convertTo(small, CV_32F);
  return small;
}

std::shared_ptr<Keyframe> look_at(View<const Gray> left, const OdometryConfig& config) {
  auto frame = std::make_shared<Keyframe>();
  const cv::Mat image = borrowed(left);
  frame->size = image.size();
  frame->win_size = config.win_size;
  cv::buildOpticalFlowPyramid(image, frame->pyramid, {config.win_size, config.win_size}, config.max_level,
                              true, cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, false);
  frame->small = small_image(image);
  return frame;
}

/// The frame with the mean and the deviation of the keyframe's brightness, if they differ: corners are compared by
/// brightness, which a jump of the exposure changes. nullptr if they are alike, or if one of the two is flat.
std::shared_ptr<Keyframe> in_light_of(const Keyframe& key, View<const Gray> left,
                                      const OdometryConfig& config) {
  constexpr double kFlat = 4;   // grey levels
  constexpr double kAlike = 4;  // grey levels
  constexpr double kAlikeGain = 1.1;
  const cv::Mat now = borrowed(left);
  cv::Scalar mean_then, deviation_then, mean_now, deviation_now;
  cv::meanStdDev(key.pyramid.front(), mean_then, deviation_then);
  cv::meanStdDev(now, mean_now, deviation_now);
  if (deviation_then[0] < kFlat || deviation_now[0] < kFlat) return nullptr;
  const double gain = deviation_then[0] / deviation_now[0];
  if (std::max(gain, 1 / gain) < kAlikeGain && std::abs(mean_then[0] - mean_now[0]) < kAlike) return nullptr;
  cv::Mat relit;
  now.convertTo(relit, CV_8U, gain, mean_then[0] - gain * mean_now[0]);
  return look_at({relit.data, Size{relit.cols, relit.rows}, static_cast<std::ptrdiff_t>(relit.step)}, config);
}

/// Median disparity of the 3×3 pixels around (x, y); NaN if fewer than five are valid.
double disparity_at(View<const float> disparity_px, int x, int y) {
  std::array<float, 9> found{};
  std::size_t count = 0;
  for (int v = std::max(0, y - 1); v <= std::min(disparity_px.height() - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(disparity_px.width() - 1, x + 1); ++u) {
      const float d = disparity_px(u, v);
      if (!std::isnan(d)) found[count++] = d;
    }
  }
  constexpr std::size_t kMin = 5;
  if (count < kMin) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = found.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(found.begin(), middle, found.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

/// Mask of pixels where corners may be: 255.
cv::Mat allowed(const DisparityMap& disparity, View<const float> confidence, View<const std::uint8_t> moving,
                const OdometryConfig& config) {
  const Size size = disparity.disparity_px.size();
  cv::Mat mask(size.height, size.width, CV_8UC1);
  for (int y = 0; y < size.height; ++y) {
    const float* d = disparity.disparity_px.row(y);
    auto* out = mask.ptr<std::uint8_t>(y);
    for (int x = 0; x < size.width; ++x) {
      const bool sure = confidence.empty() || confidence(x, y) >= config.min_confidence;
      out[x] = !std::isnan(d[x]) && sure ? 255 : 0;
    }
  }
  if (!moving.empty()) {
    constexpr int kMargin_px = 3;
    constexpr int kWidth_px = 2 * kMargin_px + 1;
    cv::Mat wide;
    cv::dilate(borrowed(moving), wide, cv::Mat::ones(kWidth_px, kWidth_px, CV_8UC1));
    mask.setTo(0, wide);
  }
  return mask;
}

void find_corners(Keyframe& frame, View<const Gray> left, const DisparityMap& disparity,
                  View<const float> confidence, View<const std::uint8_t> moving, const StereoRig& rig,
                  const OdometryConfig& config) {
  std::vector<cv::Point2f> found;
  // In a large image the strongest corners would be close together, and constrain the motion less.
  const double grid_px = std::sqrt(double(left.width()) * double(left.height()) / config.max_features);
  const double distance_px = std::max(double(config.min_distance), double(config.min_spacing) * grid_px);
  cv::goodFeaturesToTrack(borrowed(left), found, config.max_features, double(config.quality_level),
                          distance_px, allowed(disparity, confidence, moving, config));
  const double fb = double(rig.focal_px) * double(rig.baseline_m);
  for (const cv::Point2f& at : found) {
    const double d = disparity_at(disparity.disparity_px, static_cast<int>(at.x), static_cast<int>(at.y)) +
                     double(rig.doffs_px);
    constexpr double kMin_px = 0.1;
    if (!(d >= kMin_px)) continue;
    const double z = fb / d;
    frame.corners.push_back({{(double(at.x) - double(rig.cx_px)) * z / double(rig.focal_px),
                              (double(at.y) - double(rig.cy_px)) * z / double(rig.focal_px), z},
                             at});
  }
}

/// Tracks the corners of `key` into the current image, starting where `now_from_key` predicts them.
std::vector<FollowedCorner> follow(const Keyframe& key, const Keyframe& now, const Pose& now_from_key,
                                   const DisparityMap& disparity, const StereoRig& rig,
                                   const OdometryConfig& config) {
  std::vector<cv::Point2f> before;
  std::vector<cv::Point2f> after;
  std::vector<std::size_t> index;
  // The option may have changed since the keyframe, and a window must not exceed a pyramid's border.
  const int win_size = std::min(key.win_size, now.win_size);
  const auto width = static_cast<float>(now.size.width);
  const auto height = static_cast<float>(now.size.height);
  for (std::size_t k = 0; k < key.corners.size(); ++k) {
    const Point3 p = now_from_key(key.corners[k].in_key_m);
    constexpr double kNearest_m = 0.01;
    if (p.z < kNearest_m) continue;
    const cv::Point2f at(static_cast<float>(double(rig.focal_px) * p.x / p.z + double(rig.cx_px)),
                         static_cast<float>(double(rig.focal_px) * p.y / p.z + double(rig.cy_px)));
    // Farther than half a window outside the image, tracking cannot succeed.
    const auto margin = static_cast<float>(win_size) / 2;
    if (!(at.x > -margin && at.y > -margin && at.x < width + margin && at.y < height + margin)) continue;
    before.push_back(key.corners[k].at_px);
    after.push_back(at);
    index.push_back(k);
  }
  std::vector<FollowedCorner> followed;
  if (before.empty()) return followed;
  std::vector<cv::Point2f> back(before.size());
  for (std::size_t k = 0; k < before.size(); ++k) back[k] = before[k];
  const cv::Size window(win_size, win_size);
  const cv::TermCriteria until(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.02);
  std::vector<std::uint8_t> found;
  std::vector<float> error;
  const std::vector<cv::Point2f> predicted = after;
  cv::calcOpticalFlowPyrLK(key.pyramid, now.pyramid, before, after, found, error, window, config.max_level,
                           until, cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  std::vector<std::uint8_t> found_back(found.size(), 1);
  if (config.fb_max_error > 0) {
    // Starts the backward search from the prediction, so that a lost corner does not find its way back
    // trivially.
    for (std::size_t k = 0; k < back.size(); ++k) back[k] = after[k] - (predicted[k] - before[k]);
    cv::calcOpticalFlowPyrLK(now.pyramid, key.pyramid, after, back, found_back, error, window,
                             config.max_level, until, cv::OPTFLOW_USE_INITIAL_FLOW, 1e-4);
  }
  for (std::size_t k = 0; k < before.size(); ++k) {
    if (found[k] == 0 || found_back[k] == 0) continue;
    const cv::Point2f off = back[k] - before[k];
    if (config.fb_max_error > 0 &&
        !(off.x * off.x + off.y * off.y <= config.fb_max_error * config.fb_max_error))
      continue;
    const cv::Point2f at = after[k];
    if (!(at.x >= 0 && at.y >= 0 && at.x <= width - 1 && at.y <= height - 1)) continue;
    const double d = disparity_at(disparity.disparity_px, static_cast<int>(std::lround(at.x)),
                                  static_cast<int>(std::lround(at.y)));
    followed.push_back({key.corners[index[k]].in_key_m, double(at.x), double(at.y), d});
  }
  return followed;
}

/// The rotation that best aligns the small images, whatever their brightness: the shift with the least mean
/// absolute difference (small blurry images, Klein and Murray, ECCV 2008; here all shifts are tried).
Pose guess_turn(const cv::Mat& before, const cv::Mat& now, cv::Size full, const StereoRig& rig) {
  constexpr int kMax_x = 24;
  constexpr int kMax_y = 8;
  double least = std::numeric_limits<double>::infinity();
  int best_x = 0;
  int best_y = 0;
  for (int dy = -kMax_y; dy <= kMax_y; ++dy) {
    for (int dx = -kMax_x; dx <= kMax_x; ++dx) {
      const cv::Rect in_now = cv::Rect(dx, dy, before.cols, before.rows) & cv::Rect(0, 0, now.cols, now.rows);
      if (in_now.width < before.cols / 3 || in_now.height < before.rows / 2) continue;
      double sum_a = 0;
      double sum_b = 0;
      double sum_aa = 0;
      double sum_bb = 0;
      double sum_ab = 0;
      for (int y = in_now.y; y < in_now.y + in_now.height; ++y) {
        const auto* a = before.ptr<float>(y - dy) - dx;
        const auto* b = now.ptr<float>(y);
        for (int x = in_now.x; x < in_now.x + in_now.width; ++x) {
          const double p = a[x];
          const double q = b[x];
          sum_a += p;
          sum_b += q;
          sum_aa += p * p;
          sum_bb += q * q;
          sum_ab += p * q;
        }
      }
      const double n = in_now.area();
      const double variance = (sum_aa - sum_a * sum_a / n) * (sum_bb - sum_b * sum_b / n);
      if (!(variance > 0)) continue;
      const double unlike = 1 - (sum_ab - sum_a * sum_b / n) / std::sqrt(variance);
      if (unlike >= least) continue;
      least = unlike;
      best_x = dx;
      best_y = dy;
    }
  }
  const double scale = double(full.width) / kSmallWidth / double(rig.focal_px);
  // A point on the optical axis moved to the right by the shift.
  return rotation_about({-std::atan(best_y * scale), std::atan(best_x * scale), 0});
}

// ---- priors ----

/// The prior for the motion since the keyframe.
struct PriorTerm {
  MotionTerm term;
  Matrix6 covariance = Matrix6::Zero();
};

PriorTerm expected_from(const MotionPrior& prior, const Pose& before_from_key,
                        const Covariance6& covariance_to_key) {
  PriorTerm out;
  out.term.now_from_key = prior.now_from_before * before_from_key;
  const Matrix6 a = adjoint(prior.now_from_before);
  out.covariance = matrix(prior.covariance) + a * matrix(covariance_to_key) * a.transpose();
  Matrix6 information = Matrix6::Zero();
  if (prior.kind == PriorKind::gyroscope) {
    information.bottomRightCorner<3, 3>() = out.covariance.bottomRightCorner<3, 3>().inverse();
  } else {
    information = out.covariance.inverse();
  }
  out.term.information = rows_of(information);
  return out;
}

/// The prior, of a gyroscope its rotation alone; nullopt unless it has finite numbers and a covariance.
std::optional<MotionPrior> usable(std::optional<MotionPrior> prior) {
  if (!prior) return std::nullopt;
  Matrix6 p = matrix(prior->covariance);
  if (prior->kind == PriorKind::gyroscope) {
    const Eigen::Matrix3d of_turn = p.bottomRightCorner<3, 3>();
    p.setIdentity();
    p.bottomRightCorner<3, 3>() = of_turn;
    prior->covariance = rows_of(p);
    prior->now_from_before.translation_m = {};
  }
  for (const double value : prior->now_from_before.rotation)
    if (!std::isfinite(value)) return std::nullopt;
  const Point3 t = prior->now_from_before.translation_m;
  if (!std::isfinite(dot(t, t)) || !p.allFinite() || Eigen::LLT<Matrix6>(p).info() != Eigen::Success)
    return std::nullopt;
  return prior;
}

/// Whether measured motion and prior differ by more than their covariances allow.
bool disagree(const MotionFit& seen, const PriorTerm& expected, PriorKind kind) {
  const Vector6 off = difference(seen.now_from_key, expected.term.now_from_key);
  const Matrix6 sum = matrix(seen.covariance) + expected.covariance;
  if (kind == PriorKind::gyroscope) {
    const Eigen::Vector3d turn = off.tail<3>();
    return turn.dot(sum.bottomRightCorner<3, 3>().ldlt().solve(turn)) > kChi2Gyroscope;
  }
  return off.dot(sum.ldlt().solve(off)) > kChi2Wheels;
}

/// Whether a motion is zero within its uncertainty.
bool stands_still(const Pose& motion, const Covariance6& covariance) {
  const Matrix6 p = matrix(covariance);
  constexpr double kStill_m = 0.002;
  constexpr double kStill_rad = 0.1 * kRadians;
  const double sigma_m = std::sqrt(p.topLeftCorner<3, 3>().trace());
  const double sigma_rad = std::sqrt(p.bottomRightCorner<3, 3>().trace());
  return length(motion.translation_m) <= std::max(kStill_m, 3 * sigma_m) &&
         angle_of(motion) <= std::max(kStill_rad, 3 * sigma_rad);
}

/// Uncertainty of a motion extrapolated from the last step.
Covariance6 covariance_of_guess(const Pose& step) {
  constexpr double kRest_m = 0.05;
  constexpr double kRest_rad = 3 * kRadians;
  const double sigma_m = 0.5 * length(step.translation_m) + kRest_m;
  const double sigma_rad = 0.5 * angle_of(step) + kRest_rad;
  Vector6 variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return rows_of(variances.asDiagonal());
}

constexpr double kPlace_m = 1;
constexpr double kPlace_rad = 30 * kRadians;

/// For a position known only roughly: what is seen from here on shares nothing with what was seen before.
Covariance6 covariance_of_new_place() {
  Vector6 variances;
  variances << Eigen::Vector3d::Constant(kPlace_m * kPlace_m),
      Eigen::Vector3d::Constant(kPlace_rad * kPlace_rad);
  return rows_of(variances.asDiagonal());
}

/// Raises the variances to those of a new place.
Covariance6 as_of_new_place(Covariance6 covariance) {
  const Covariance6 least = covariance_of_new_place();
  for (std::size_t k = 0; k < 6; ++k) covariance[7 * k] = std::max(covariance[7 * k], least[7 * k]);
  return covariance;
}

// ---- one frame ----

/// The current frame with the inputs of odometry.
struct PresentFrame {
  View<const Gray> left;
  const DisparityMap& disparity;
  View<const float> confidence;
  View<const std::uint8_t> moving;
  const StereoRig& rig;
  const OdometryConfig& config;
};

struct Attempt {
  std::vector<FollowedCorner> corners;
  MotionFit fit;
  bool is_relit = false;  // the exposure differs from the keyframe's
};

Attempt attempt(const Keyframe& key, const Keyframe& now, const Pose& start, const PresentFrame& present) {
  Attempt made;
  made.corners = follow(key, now, start, present.disparity, present.rig, present.config);
  made.fit = fit_motion(made.corners, present.rig, start, {}, present.config);
  return made;
}

/// Prefers an attempt that is not refused, then more inliers.
bool is_better(const Attempt& a, const Attempt& b) {
  const bool a_refused = a.fit.refusal != MotionRefusal::none;
  const bool b_refused = b.fit.refusal != MotionRefusal::none;
  if (a_refused != b_refused) return b_refused;
  return a.fit.inliers > b.fit.inliers;
}

/// Starts from the expected motion, then, if that has few inliers, from the rotation between the small
/// images.
Attempt motion_from(const PlacedKeyframe& key, const OdometryState& state, const Keyframe& now,
                    const Pose& expected_step, const PresentFrame& present) {
  const Pose before_from_key = inverse(state.map_from_camera) * key.map_from_key;
  Attempt best = attempt(*key.frame, now, expected_step * before_from_key, present);
  constexpr double kFine = 0.5;
  const int least = std::max(present.config.min_inliers,
                             static_cast<int>(kFine * static_cast<double>(key.frame->corners.size()) / 2));
  if (best.fit.refusal == MotionRefusal::none && best.fit.inliers >= least) return best;
  if (state.seen && state.seen->size == now.size) {
    const Pose turn = guess_turn(state.seen->small, now.small, now.size, present.rig);
    Attempt again = attempt(*key.frame, now, turn * before_from_key, present);
    if (is_better(again, best)) best = std::move(again);
  }
  if (best.fit.refusal == MotionRefusal::none) return best;
  if (const auto relit = in_light_of(*key.frame, present.left, present.config)) {
    Attempt again = attempt(*key.frame, *relit, expected_step * before_from_key, present);
    again.is_relit = true;
    if (is_better(again, best)) best = std::move(again);
  }
  return best;
}

bool is_usable(const StereoRig& rig) {
  return std::isfinite(rig.focal_px) && rig.focal_px > 0 && std::isfinite(rig.baseline_m) &&
         rig.baseline_m > 0 && std::isfinite(rig.cx_px) && std::isfinite(rig.cy_px) &&
         std::isfinite(rig.doffs_px);
}

bool is_usable(const PresentFrame& present) {
  constexpr int kMin_px = 16;
  const Size size = present.left.size();
  return size.width >= kMin_px && size.height >= kMin_px && present.disparity.disparity_px.size() == size &&
         (present.confidence.empty() || present.confidence.size() == size) &&
         (present.moving.empty() || present.moving.size() == size);
}

/// The frame as a keyframe if it has enough corners, else nullptr.
std::shared_ptr<const Keyframe> as_keyframe(std::shared_ptr<Keyframe> frame, const PresentFrame& present) {
  find_corners(*frame, present.left, present.disparity, present.confidence, present.moving, present.rig,
               present.config);
  if (static_cast<int>(frame->corners.size()) < present.config.min_inliers) return nullptr;
  return frame;
}

/// The best attempt at the motion from the keyframe or, failing that, from the spare one, which then replaces
/// it in `state`.
struct BestAttempt {
  Attempt attempt;
  bool by_spare = false;
};
BestAttempt measure(const OdometryState& before, OdometryState& state, const Keyframe* now,
                    const Pose& expected_step, const PresentFrame& present) {
  const auto can_follow = [&](const PlacedKeyframe& key) {
    return now != nullptr && key.frame && key.frame->size == now->size;
  };
  BestAttempt best;
  best.attempt.fit.refusal = MotionRefusal::few_points;
  if (can_follow(before.key)) best.attempt = motion_from(before.key, before, *now, expected_step, present);
  if (best.attempt.fit.refusal == MotionRefusal::none || !can_follow(before.spare)) return best;
  Attempt again = motion_from(before.spare, before, *now, expected_step, present);
  const bool is_coherent = again.fit.refusal == MotionRefusal::none;
  state.coherent_in_a_row = before.lost && is_coherent ? before.coherent_in_a_row + 1 : 0;
  // A single match may be chance or noise, so relocalisation requires consecutive ones.
  if (!is_coherent || (before.lost && state.coherent_in_a_row < kCoherentSteps)) return best;
  state.key = before.spare;
  state.key_covariance = before.is_guessed ? covariance_of_new_place() : covariance_since_key(before);
  if (before.is_guessed) state.key.covariance = as_of_new_place(state.key.covariance);
  state.covariance_to_key = {};
  return {std::move(again), true};
}

/// Refines the motion by a prior that agrees with it; refuses it if they disagree, unless the wheels slip.
MotionRefusal combine(Attempt& measured, const MotionPrior& prior, const OdometryState& before,
                      OdometryState& state, const PresentFrame& present) {
  MotionFit& fit = measured.fit;
  const Pose before_from_key = inverse(before.map_from_camera) * state.key.map_from_key;
  const PriorTerm expected = expected_from(prior, before_from_key, state.covariance_to_key);
  if (disagree(fit, expected, prior.kind)) {
    const Pose seen_step = fit.now_from_key * inverse(before_from_key);
    const bool slips = prior.kind == PriorKind::wheels && stands_still(seen_step, fit.covariance) &&
                       !stands_still(prior.now_from_before, prior.covariance);
    state.slipping = slips ? before.slipping + 1 : 0;
    return state.slipping < kSlippingFrames ? MotionRefusal::disagrees_with_prior : MotionRefusal::none;
  }
  state.slipping = 0;
  MotionFit again =
      fit_motion(measured.corners, present.rig, fit.now_from_key, expected.term, present.config);
  if (again.refusal == MotionRefusal::none) fit = std::move(again);
  return MotionRefusal::none;
}

/// The pose by the measured motion.
void move_by(const MotionFit& fit, bool by_spare, const OdometryState& before, OdometryState& state,
             Motion& motion) {
  state.map_from_camera = state.key.map_from_key * inverse(fit.now_from_key);
  state.covariance =
      carried_on(state.key.covariance, state.key.map_from_key, fit.covariance, state.map_from_camera);
  state.covariance_to_key = fit.covariance;
  motion.covariance = fit.covariance;
  motion.now_from_before = inverse(state.map_from_camera) * before.map_from_camera;
  state.last_step = before.lost ? Pose{} : motion.now_from_before;
  motion.is_new_segment = by_spare && before.is_guessed;
  state.refused_in_a_row = 0;
  state.is_guessed = false;
  state.lost = false;
  state.coherent_in_a_row = 0;
  state.spare = {};
}

/// The pose by the wheels or, without them, by the last step again, as long as the camera is not lost.
void move_by_guess(const Pose& expected_step, const std::optional<MotionPrior>& prior,
                   const OdometryState& before, OdometryState& state, Motion& motion) {
  ++state.refused_in_a_row;
  const bool by_wheels = prior && prior->kind == PriorKind::wheels;
  if (by_wheels) state.refused_in_a_row = 0;
  state.is_guessed = before.is_guessed || !prior || (before.is_after_gap && !by_wheels);
  if (state.refused_in_a_row > kFramesUntilLost) state.lost = true;
  motion.now_from_before = state.lost && !by_wheels ? Pose{} : expected_step;
  if (by_wheels) {
    motion.covariance = prior->covariance;
  } else {
    motion.covariance =
        before.is_after_gap ? covariance_of_new_place() : covariance_of_guess(motion.now_from_before);
  }
  state.last_step = motion.now_from_before;
  state.map_from_camera = before.map_from_camera * inverse(motion.now_from_before);
  state.covariance =
      carried_on(before.covariance, before.map_from_camera, motion.covariance, state.map_from_camera);
  const Matrix6 a = adjoint(motion.now_from_before);
  state.covariance_to_key =
      rows_of(a * matrix(state.covariance_to_key) * a.transpose() + matrix(motion.covariance));
  motion.covariance = state.covariance_to_key;
}

/// Makes the present frame the keyframe if the motion since the last one is large or poorly supported, or, after
/// a refusal, the spare one.
void choose_keyframe(const std::shared_ptr<Keyframe>& now, const BestAttempt& measured,
                     const PresentFrame& present, OdometryState& state, Motion& motion) {
  const MotionFit& fit = measured.attempt.fit;
  const OdometryConfig& config = present.config;
  const bool seen = motion.refusal == MotionRefusal::none;
  bool wants_key = !state.key.frame;
  if (seen) {
    if (state.key.inliers == 0) state.key.inliers = fit.inliers;
    wants_key =
        config.method == OdometryMethod::frame ||
        fit.inliers < static_cast<int>(config.keyframe_inliers * static_cast<float>(state.key.inliers)) ||
        angle_of(fit.now_from_key) > kKeyframeTurn_rad || measured.by_spare || measured.attempt.is_relit;
  }
  if (!now || (seen && !wants_key)) return;
  PlacedKeyframe fresh{as_keyframe(now, present), state.map_from_camera, state.covariance, 0};
  if (fresh.frame && (seen || motion.refusal == MotionRefusal::disagrees_with_prior || !state.key.frame)) {
    state.key = std::move(fresh);
    state.key_covariance = rows_of(matrix(state.key_covariance) + matrix(covariance_since_key(state)));
    state.covariance_to_key = {};
    state.spare = {};
    motion.is_new_keyframe = true;
  } else if (!seen) {
    state.spare = std::move(fresh);
  }
}

}  // namespace

OdometryState begin_odometry(const Pose& map_from_camera) {
  OdometryState state;
  state.map_from_camera = map_from_camera;
  return state;
}

OdometryState stood_on_floor(OdometryState state, const Pose& level) {
  // Difference of the floor planes of two frames: √2 of the error of one, measured on the rendered sequences
  // as 6 mm and 0.19° per axis (RMS of 17 frames).
  constexpr double kHeight_m = 0.01;
  constexpr double kTilt_rad = 0.3 * kRadians;
  state.key.map_from_key = level * inverse(state.map_from_camera) * state.key.map_from_key;
  state.map_from_camera = level;
  Matrix6 left = matrix(state.covariance);
  for (const auto& [axis, sigma] :
       {std::pair<Eigen::Index, double>{2, kHeight_m}, {3, kTilt_rad}, {4, kTilt_rad}}) {
    left.row(axis).setZero();
    left.col(axis).setZero();
    left(axis, axis) = sigma * sigma;
  }
  state.covariance = rows_of(left);
  state.key.covariance = state.covariance;
  return state;
}

Covariance6 covariance_since_key(const OdometryState& state) {
  return rows_of(along_map(state.covariance_to_key, state.map_from_camera));
}

OdometryState after_gap(OdometryState state) {
  state.last_step = {};
  state.is_after_gap = true;
  return state;
}

OdometryStep advance_odometry(const OdometryState& before, const OdometryFrame& frame, const StereoRig& rig,
                              const std::optional<MotionPrior>& given, const OdometryConfig& config) {
  const auto& [left, disparity, confidence, moving] = frame;
  const PresentFrame present{left, disparity, confidence, moving, rig, config};
  const std::optional<MotionPrior> prior = usable(given);
  OdometryStep step{before, {}};
  OdometryState& state = step.state;
  Motion& motion = step.motion;
  state.key_covariance = {};
  if (config.method == OdometryMethod::off || !is_usable(rig)) {
    motion.refusal = config.method == OdometryMethod::off ? MotionRefusal::off : MotionRefusal::no_rig;
    return step;
  }

  std::shared_ptr<Keyframe> now;
  if (is_usable(present)) now = look_at(left, config);
  state.seen = now;
  state.is_after_gap = false;

  if (!before.has_begun) {
    state.has_begun = true;
    if (now) state.key.frame = as_keyframe(now, present);
    state.key.map_from_key = state.map_from_camera;
    motion.is_new_keyframe = state.key.frame != nullptr;
    if (!motion.is_new_keyframe) motion.refusal = MotionRefusal::few_points;
    return step;
  }

  Pose expected_step = before.lost ? Pose{} : before.last_step;
  if (prior && prior->kind == PriorKind::wheels) expected_step = prior->now_from_before;
  if (prior && prior->kind == PriorKind::gyroscope) expected_step.rotation = prior->now_from_before.rotation;

  state.coherent_in_a_row = 0;
  BestAttempt measured = measure(before, state, now.get(), expected_step, present);
  const MotionFit& fit = measured.attempt.fit;
  motion.followed = static_cast<int>(measured.attempt.corners.size());
  motion.inliers = fit.inliers;
  motion.inlier_share =
      motion.followed > 0 ? static_cast<float>(fit.inliers) / static_cast<float>(motion.followed) : 0.0F;
  motion.chi2_per_dof = static_cast<float>(fit.chi2_per_dof);
  motion.refusal = fit.refusal;
  if (prior && motion.refusal == MotionRefusal::none)
    motion.refusal = combine(measured.attempt, *prior, before, state, present);

  if (motion.refusal == MotionRefusal::none) {
    move_by(fit, measured.by_spare, before, state, motion);
  } else {
    move_by_guess(expected_step, prior, before, state, motion);
  }
  choose_keyframe(now, measured, present, state, motion);
  return step;
}

}  // namespace cairn
