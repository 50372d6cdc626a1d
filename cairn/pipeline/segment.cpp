// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/core/observed.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/disparity/confidence.hpp>
#include <cairn/pipeline/segment.hpp>
#include <utility>

namespace cairn {
namespace {

/// What can be said of the disparities only once they are seen together: the ground, and what is reflected in
/// it …
SceneDisparity check_against_ground(DisparityMap disparity, View<const float> trusted_px,
                                    const std::optional<StereoRig>& rig, const Config& config,
                                    const Exec& exec, Observed& stage) {
  Ground ground = stage("fit_ground", fit_ground(trusted_px, rig, config.ground, exec));
  disparity = stage("reject_below_ground",
                    reject_below_ground(std::move(disparity), ground, rig, config.ground, exec));
  return {std::move(disparity), ground, {}};
}

/// … then the islands, and what is floor.
SceneDisparity clean_up(SceneDisparity scene, const std::optional<StereoRig>& rig, const Config& config,
                        const Exec& exec, Observed& stage) {
  scene.disparity =
      stage("reject_speckles", reject_speckles(std::move(scene.disparity), config.speckle, exec));
  scene.floor = stage("label_floor", label_floor(scene.disparity, scene.ground, rig, config.ground, exec));
  return scene;
}

EpipolarCorrection align(const StereoPair& pair, const Config& config, const Exec& exec, Observed& stage) {
  if (config.epipolar_correction.max_rows < 0) return {};
  EpipolarCorrection correction = correct_epipolar(pair, config.match, config.epipolar_correction, exec);
  correction.right = stage("correct_epipolar", std::move(correction.right));
  return correction;
}

/// The disparities that the per-pixel checks have passed, and what they were judged by.
struct Matched {
  Matches matches;
  DisparityMap disparity;
};

Matched match_and_check(const StereoPair& given, View<const Gray> aligned_right, const Config& config,
                        const Exec& exec, Observed& stage) {
  const auto pair =
      StereoPair::from(given.left(), aligned_right.empty() ? given.right() : aligned_right, given.left_rgb());
  Matches matches = stage("match", match(pair, config.match, config.semi_global, exec));
  auto refined = stage("refine_subpixel", refine_subpixel(matches, config.subpixel, exec));

  const auto inconsistent =
      stage("reject_inconsistent", reject_inconsistent(matches, config.left_right, exec));
  const auto ambiguous = stage("reject_ambiguous", reject_ambiguous(matches, config.uniqueness, exec));
  const auto flat = stage("reject_flat", reject_flat(matches, config.flatness, exec));
  const auto textureless = stage("reject_textureless", reject_textureless(pair.left(), config.texture, exec));
  DisparityMap disparity =
      stage("combine", combine(std::move(refined), {inconsistent, ambiguous, flat, textureless}, exec));
  return {std::move(matches), std::move(disparity)};
}

Image<float> confidence_of(const DisparityMap& disparity, const Matches& matches, const Config& config,
                           const Exec& exec, Observed& stage) {
  return stage("estimate_confidence",
               estimate_confidence(matches, disparity, confidence_model(config.match.method), exec));
}

/// The same beside the caller's own work: while disparities grow to regions a thread may have nothing to do.
/// What it is given must stay as it is meanwhile.
class ConfidenceBeside {
 public:
  ConfidenceBeside(const DisparityMap& disparity, const Matches& matches, const Config& config,
                   const Exec& exec)
      // The first store beside is that of the left image's regions.
      : work_(exec, [this, &disparity, &matches, &config, beside = exec.beside().beside()] {
          Observed unobserved(beside);
          confidence_ = confidence_of(disparity, matches, config, beside, unobserved);
        }) {}
  /// Once.
  Image<float> get() {
    work_.wait();
    return std::move(confidence_);
  }

 private:
  Image<float> confidence_;
  SideWork work_;  // the last, so that it is over before what it writes to is gone
};

/// The disparities that ground and background are found from: with fusion.method=evidence those that texture
/// vouches for.
class Trusted {
 public:
  Trusted(View<const Gray> left, std::optional<float> noise, const DisparityMap& disparity,
          const Config& config, const Exec& exec, Observed& stage) {
    if (config.fusion.method == FusionMethod::overlap) {
      px_ = disparity.disparity_px;
    } else {
      evidence_px_ = stage("find_evidence", find_evidence(left, disparity, config.evidence, exec, noise));
      px_ = evidence_px_;
    }
  }
  /// Valid as long as this, and as the disparities stay as they were given.
  [[nodiscard]] View<const float> px() const { return px_; }

 private:
  Image<float> evidence_px_;
  View<const float> px_;
};

/// What the left image tells without a disparity. It takes longer than anything else but matching, and much
/// of it can be done by one thread only: so it is done beside the caller's own.
class LeftRegions {
 public:
  LeftRegions(View<const Gray> left, View<const Rgb> left_rgb, const Config& config, const Exec& exec)
      : noise_(config.fusion.method == FusionMethod::evidence ? noise_sigma(left, exec) : 0),
        work_(exec, [=, this, &config, beside = exec.beside()] {
          if (config.fusion.method == FusionMethod::overlap) {
            by_intensity_ = segment_intensity(left, config.intensity, beside);
          } else {
            facets_ = segment_facets(left, left_rgb, config.facets, beside, noise_);
          }
        }) {}
  /// noise_sigma() of the image, with fusion.method=evidence.
  [[nodiscard]] float noise() const { return noise_; }
  /// With fusion.method=overlap; once.
  Segmentation by_intensity() {
    work_.wait();
    return std::move(by_intensity_);
  }
  /// With fusion.method=evidence; once.
  Facets facets() {
    work_.wait();
    return std::move(facets_);
  }

 private:
  float noise_;
  Segmentation by_intensity_;
  Facets facets_;
  SideWork work_;  // the last, so that it is over before what it writes to is gone
};

/// A frame's two segmentations, which fuse() unites.
struct Regions {
  Segmentation by_intensity;
  Segmentation by_disparity;
};

/// The paper's way: united where they overlap.
Regions regions_by_overlap(LeftRegions& of_left, const SceneDisparity& scene, const Config& config,
                           const Exec& exec, Observed& stage) {
  // In this order, as the one by intensity may not be done yet.
  auto by_disparity =
      stage("segment_disparity", segment_disparity(scene.disparity, scene.floor, config.disparity, exec));
  auto by_intensity = stage("segment_intensity", of_left.by_intensity());
  return {std::move(by_intensity), std::move(by_disparity)};
}

/// What texture proves decides which facets stand before the background, and which of those belong together.
Regions regions_by_evidence(LeftRegions& of_left, View<const Gray> left, View<const Rgb> left_rgb,
                            View<const float> evidence_px, const SceneDisparity& scene,
                            const std::optional<StereoRig>& rig, const Config& config, const Exec& exec,
                            Observed& stage) {
  const Background background = fit_background(evidence_px, scene.ground, rig, config.background, exec);
  const Facets facets = of_left.facets();
  auto by_intensity = stage("segment_facets", as_segmentation(facets, left, exec));
  const auto figure =
      separate_figure(facets, left, left_rgb, evidence_px, background, config.figure, exec, of_left.noise());
  auto by_disparity = stage("group_facets", group_facets(facets, figure, scene.disparity, evidence_px,
                                                         background, rig, config.figure, config.group, exec));
  return {std::move(by_intensity), std::move(by_disparity)};
}

/// From disparities that the per-pixel checks have passed to objects. Disparities that no matching has made
/// have no confidence: `matches` is nullptr.
Frame find_objects(LeftRegions& of_left, View<const Gray> left, View<const Rgb> left_rgb,
                   DisparityMap disparity, const Matches* matches, const std::optional<StereoRig>& rig,
                   const Config& config, const Exec& exec, Observed& stage) {
  const bool by_evidence = config.fusion.method == FusionMethod::evidence;
  const Trusted trusted(left, of_left.noise(), disparity, config, exec, stage);
  SceneDisparity scene = check_against_ground(std::move(disparity), trusted.px(), rig, config, exec, stage);
  Regions regions;
  // Facets weigh small islands for themselves: thin legs and leaves are islands, too.
  if (by_evidence)
    regions = regions_by_evidence(of_left, left, left_rgb, trusted.px(), scene, rig, config, exec, stage);
  scene = clean_up(std::move(scene), rig, config, exec, stage);
  std::optional<ConfidenceBeside> confidence;
  if (matches != nullptr) confidence.emplace(scene.disparity, *matches, config, exec);
  if (!by_evidence) regions = regions_by_overlap(of_left, scene, config, exec, stage);

  Fusion fusion = stage("fuse", fuse(regions.by_intensity, regions.by_disparity, exec));
  Objects objects = stage("measure", measure(fusion, regions.by_disparity, scene.disparity, left, left_rgb,
                                             rig, config.objects, exec));
  if (confidence) scene.confidence = stage("estimate_confidence", confidence->get());
  return {std::move(scene.disparity),
          scene.ground,
          std::move(scene.floor),
          std::move(regions.by_intensity),
          std::move(regions.by_disparity),
          std::move(fusion),
          std::move(objects),
          {},
          std::move(scene.confidence)};
}

}  // namespace

SceneDisparity estimate_disparity(const StereoPair& pair, const std::optional<StereoRig>& rig,
                                  const Config& config, const Exec& exec) {
  validate(config, pair.size(), rig.has_value());
  Observed stage(exec);
  const EpipolarCorrection aligned = align(pair, config, exec, stage);
  Matched matched = match_and_check(pair, aligned.right, config, exec, stage);
  const Trusted trusted(pair.left(), std::nullopt, matched.disparity, config, exec, stage);
  SceneDisparity scene =
      clean_up(check_against_ground(std::move(matched.disparity), trusted.px(), rig, config, exec, stage),
               rig, config, exec, stage);
  scene.confidence = confidence_of(scene.disparity, matched.matches, config, exec, stage);
  scene.epipolar = aligned.offset;
  return scene;
}

Frame segment(const StereoPair& pair, const std::optional<StereoRig>& rig, const Config& config,
              const Exec& exec) {
  validate(config, pair.size(), rig.has_value());
  Observed stage(exec);
  std::optional<LeftRegions> of_left;
  const auto begin_beside = [&] { of_left.emplace(pair.left(), pair.left_rgb(), config, exec); };
  // Facets are needed soon after the matching. By overlap growing by disparity takes one thread about as long
  // as all that the left image asks for, and the matching itself takes all threads.
  const bool by_evidence = config.fusion.method == FusionMethod::evidence;
  if (by_evidence) begin_beside();
  const EpipolarCorrection aligned = align(pair, config, exec, stage);
  Matched matched = match_and_check(pair, aligned.right, config, exec, stage);
  if (!by_evidence) begin_beside();
  Frame frame = find_objects(*of_left, pair.left(), pair.left_rgb(), std::move(matched.disparity),
                             &matched.matches, rig, config, exec, stage);
  frame.epipolar = aligned.offset;
  return frame;
}

Frame segment(View<const Gray> left, View<const Rgb> left_rgb, DisparityMap disparity,
              const std::optional<StereoRig>& rig, const Config& config, const Exec& exec) {
  if (left.size() != disparity.disparity_px.size()) {
    throw Error("external disparity: the map is " + text(disparity.disparity_px.size()) +
                ", the left image " + text(left.size()));
  }
  validate(config);
  Observed stage(exec);
  LeftRegions of_left(left, left_rgb, config, exec);
  return find_objects(of_left, left, left_rgb, std::move(disparity), nullptr, rig, config, exec, stage);
}

}  // namespace cairn
