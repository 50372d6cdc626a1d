// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// What cairn::segment() does with the presets `paper` and `default`, one stage at a time, printing the result
// of each.
//   02_stage_by_stage data/samples/glossy_floor
#include <cairn/cairn.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cstdio>
#include <filesystem>
#include <utility>

namespace {

using namespace cairn;

int count(const Image<Reject>& verdicts, Reject bit) {
  int found = 0;
  for (int y = 0; y < verdicts.height(); ++y) {
    for (int x = 0; x < verdicts.width(); ++x) found += has(verdicts(x, y), bit) ? 1 : 0;
  }
  return found;
}

double mean_where_known(const Image<float>& values, const DisparityMap& disparity) {
  double sum = 0;
  int known = 0;
  for (int y = 0; y < values.height(); ++y) {
    for (int x = 0; x < values.width(); ++x) {
      if (disparity.reject(x, y) != Reject::none) continue;
      sum += static_cast<double>(values(x, y));
      ++known;
    }
  }
  return known > 0 ? sum / known : 0;
}

void print_holes(const DisparityMap& disparity, const Ground& ground) {
  std::printf("rejected pixels, of %lld\n", static_cast<long long>(disparity.reject.size().area()));
  for (const auto& [name, bit] : kRejects) {
    std::printf("  %-13.*s %6d\n", static_cast<int>(name.size()), name.data(), count(disparity.reject, bit));
  }
  if (ground.plane) {
    std::printf("floor: d = %.5f x + %.5f y + %.3f, support %.2f\n", ground.plane->a, ground.plane->b,
                ground.plane->c, ground.support);
  } else {
    const auto reason = kRefusals.at(static_cast<std::size_t>(ground.refusal)).name;
    std::printf("no floor: %.*s\n", static_cast<int>(reason.size()), reason.data());
  }
}

/// As in cairn/pipeline/paper.cpp.
void run_paper(const StereoPair& pair, const std::optional<StereoRig>& rig, const Config& config,
               const Exec& exec) {
  // [stages]
  // Correlation: a disparity for every pixel with a candidate.
  const Matches matches = match(pair, config.match, config.semi_global, exec);
  Image<float> refined = refine_subpixel(matches, config.subpixel, exec);

  // Independent checks of each match; each sets its own bit.
  const Image<Reject> inconsistent = reject_inconsistent(matches, config.left_right, exec);
  const Image<Reject> ambiguous = reject_ambiguous(matches, config.uniqueness, exec);
  const Image<Reject> flat = reject_flat(matches, config.flatness, exec);
  const Image<Reject> textureless = reject_textureless(pair.left(), config.texture, exec);
  DisparityMap disparity = combine(std::move(refined), {inconsistent, ambiguous, flat, textureless}, exec);

  // A check against the scene: matches below the floor are reflections.
  const Ground ground = fit_ground(disparity, rig, config.ground, exec);
  disparity = reject_below_ground(std::move(disparity), ground, rig, config.ground, exec);
  disparity = reject_speckles(std::move(disparity), config.speckle, exec);
  const Image<std::uint8_t> floor = label_floor(disparity, ground, rig, config.ground, exec);

  // Segment the left image and the disparities separately, then fuse both.
  const Segmentation by_disparity = segment_disparity(disparity, floor, config.disparity, exec);
  const Segmentation by_intensity = segment_intensity(pair.left(), config.intensity, exec);
  const Fusion fusion = fuse(by_intensity, by_disparity, exec);

  // Choose the fused regions that are objects, and measure them.
  const LeftImage left{pair.left(), pair.left_rgb(), noise_sigma(pair.left(), exec)};
  Objects objects = measure(fusion.labels, fusion.is_floor, disparity, left, config.objects, exec);
  objects = locate(std::move(objects), disparity, ground, rig, exec);
  // [/stages]

  print_holes(disparity, ground);
  std::printf("regions: %zu by intensity, %zu by disparity, %zu fused; objects: %zu\n",
              by_intensity.regions.size(), by_disparity.regions.size(), fusion.parts.size(),
              objects.list.size());
}

/// As in cairn/pipeline/region_tree.cpp.
void run_default(const StereoPair& given, const std::optional<StereoRig>& rig, const Config& config,
                 const Exec& exec) {
  // [stages_by_region_tree]
  // Undo a vertical shift of the right image, caused by vibration; then match with smoothness along paths.
  const EpipolarCorrection aligned = correct_epipolar(given, config.match, config.epipolar_correction, exec);
  const StereoPair pair =
      aligned.right.empty() ? given : StereoPair::from(given.left(), aligned.right, given.left_rgb());
  const Matches matches = match(pair, config.match, config.semi_global, exec);
  const Image<Reject> inconsistent = reject_inconsistent(matches, config.left_right, exec);
  // (The other checks are off in this preset.)
  DisparityMap disparity = combine(refine_subpixel(matches, config.subpixel, exec), {inconsistent}, exec);

  // Disparities supported by texture show the scene: its ground, reflections in it, its walls.
  const LeftImage left{pair.left(), pair.left_rgb(), noise_sigma(pair.left(), exec)};
  const Image<float> textured_px = select_textured(left, disparity, config.textured, exec);
  const Ground seen = fit_ground(textured_px, rig, config.ground, exec, pair.left());
  const Ground ground = likely_ground(seen, disparity, rig, config.ground, exec, textured_px, pair.left());
  disparity = reject_below_ground(std::move(disparity), ground, rig, config.ground, exec);
  disparity = reject_speckles(std::move(disparity), config.speckle, exec);
  const Background background = fit_background(textured_px, ground, rig, config.background, exec);
  const Image<float> surface_disparity_px = floor_under_reflections(disparity, ground, exec);

  // A network's hints, superpixels along the outlines that it expects, and a tree of regions: the most similar pair
  // merges first.
  Image<std::uint16_t> edges = superpixel_edges(left, exec);
  Cues cues{left, surface_disparity_px, textured_px, ground, background};
  const Image<ObjectHint> hints = hint_objects(edges, cues, exec);
  cues.hints = hints;
  const Superpixels superpixels = cut_superpixels(std::move(edges), hints, surface_disparity_px,
                                                  left.noise_sigma, config.superpixels, exec);
  const MergeTree tree = grow_merge_tree(superpixels, cues, merge_classifier(), exec);

  // Choose the regions that are objects, and measure them; then estimate the confidence of each disparity.
  const ChosenObjects chosen =
      choose_objects(tree, object_classifier(), limits_of(config.objects, pair.size()), exec);
  const Segmentation groups = object_regions(superpixels, chosen, disparity, exec);
  Objects objects = measure(groups.labels, chosen.scores, disparity, left, exec);
  objects =
      refine_objects(std::move(objects), disparity, pair.left(), pair.right(), disparity_bias_trees(), exec);
  objects = locate(std::move(objects), disparity, ground, rig, exec);
  const Image<float> confidence =
      estimate_confidence(matches, disparity, confidence_model(config.match.method), exec);
  // [/stages_by_region_tree]

  print_holes(disparity, ground);
  std::printf("walls: %zu; superpixels: %d, regions in their tree: %zu; objects: %zu\n",
              background.planes.size() - (background.has_floor ? 1 : 0), superpixels.count, tree.nodes.size(),
              objects.list.size());
  std::printf("confidence of the disparities: %.2f in the mean\n", mean_where_known(confidence, disparity));
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER (with left.png, right.png and calib.txt)\n", argv[0]);
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const auto images = io::load_pair(folder / "left.png", folder / "right.png");
  const auto calibration = io::load_calibration(folder / "calib.txt");
  const auto pair = StereoPair::from(images.left.gray, images.right.gray, images.left.rgb);

  for (const char* const preset : {"paper", "default"}) {
    Config config = Config::preset(preset);
    config.match.num_disparities = calibration.num_disparities.value_or(config.match.num_disparities);
    validate(config, pair.size(), calibration.rig.has_value());  // after this no stage can fail
    std::printf("%s\n", preset);
    const auto run_stages = config.pipeline.method == Method::paper ? run_paper : run_default;
    run_stages(pair, calibration.rig, config, Exec::with_threads(0));
  }
} catch (const cairn::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
