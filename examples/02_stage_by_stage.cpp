// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// What cairn::segment() does with the preset `paper`, one stage at a time, with a look at what each one made.
//   02_stage_by_stage samples/glossy_floor
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

void run_stages(const StereoPair& pair, const std::optional<StereoRig>& rig, const Config& config,
                const Exec& exec) {
  // [stages]
  // Correlation, and a disparity for every pixel that has a candidate.
  const Matches matches = match(pair, config.match, exec);
  Image<float> refined = refine_subpixel(matches, config.subpixel, exec);

  // What speaks against each match. The checks know nothing of each other; each leaves its own bit.
  const Image<Reject> inconsistent = reject_inconsistent(matches, config.left_right, exec);
  const Image<Reject> ambiguous = reject_ambiguous(matches, config.uniqueness, exec);
  const Image<Reject> flat = reject_flat(matches, config.flatness, exec);
  const Image<Reject> textureless = reject_textureless(pair.left(), config.texture, exec);
  DisparityMap disparity = combine(std::move(refined), {inconsistent, ambiguous, flat, textureless}, exec);

  // What contradicts the scene: matches under the floor are reflections.
  const Ground ground = fit_ground(disparity, rig, config.ground, exec);
  disparity = reject_below_ground(std::move(disparity), ground, rig, config.ground, exec);
  disparity = reject_speckles(std::move(disparity), config.speckle, exec);
  const Image<std::uint8_t> floor = label_floor(disparity, ground, rig, config.ground, exec);

  // The left picture and the disparities are segmented apart, and then united.
  const Segmentation by_intensity = segment_intensity(pair.left(), config.intensity, exec);
  const Segmentation by_disparity = segment_disparity(disparity, floor, config.disparity, exec);
  const Fusion fusion = fuse(by_intensity, by_disparity, exec);
  const Objects objects =
      measure(fusion, by_disparity, disparity, pair.left(), pair.left_rgb(), rig, config.objects, exec);
  // [/stages]

  std::printf("rejected pixels, of %lld\n", static_cast<long long>(pair.size().area()));
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
  std::printf("regions: %zu by intensity, %zu by disparity, %zu fused; objects: %zu\n",
              by_intensity.regions.size(), by_disparity.regions.size(), fusion.parts.size(),
              objects.list.size());
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER (with left.png, right.png and calib.txt)\n", argv[0]);
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const auto pictures = io::load_pair(folder / "left.png", folder / "right.png");
  const auto calibration = io::load_calibration(folder / "calib.txt");
  const auto pair = StereoPair::from(pictures.left.gray, pictures.right.gray, pictures.left.rgb);

  Config config = Config::paper();
  config.match.num_disparities = calibration.num_disparities.value_or(config.match.num_disparities);
  validate(config, pair.size(), calibration.rig.has_value());  // past this no stage can fail
  run_stages(pair, calibration.rig, config, Exec::with_threads(0));
} catch (const cairn::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
