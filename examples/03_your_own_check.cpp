// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Adds a check of your own to the library's: over-exposed pixels carry no information, so their matches are
// rejected.
//   03_your_own_check data/samples/dim_light
#include <cairn/cairn.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cstdio>
#include <filesystem>
#include <utility>

namespace {

using namespace cairn;

// [check]
/// Marks pixels at the upper end of the sensor's range.
Image<Reject> reject_saturated(View<const Gray> image, const Exec& exec) {
  constexpr Gray kSaturated = 250;
  Image<Reject> verdicts(image.size(), exec.pool);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      verdicts(x, y) = image(x, y) >= kSaturated ? Reject::no_data : Reject::none;
    }
  }
  return verdicts;
}

/// The pair's disparities with one more reason to reject; ground, segmentation and objects follow as usual.
Frame segment_without_saturated(const StereoPair& pair, const std::optional<StereoRig>& rig,
                                const Config& config, const Exec& exec) {
  const Matches matches = match(pair, config.match, config.semi_global, exec);
  const Image<Reject> inconsistent = reject_inconsistent(matches, config.left_right, exec);
  const Image<Reject> ambiguous = reject_ambiguous(matches, config.uniqueness, exec);
  const Image<Reject> saturated = reject_saturated(pair.left(), exec);
  DisparityMap disparity =
      combine(refine_subpixel(matches, config.subpixel, exec), {inconsistent, ambiguous, saturated}, exec);
  return segment({{pair.left(), pair.left_rgb()}, {}, std::move(disparity)}, {rig, config, exec});
}
// [/check]

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

  Config config;
  config.match.num_disparities = calibration.num_disparities.value_or(config.match.num_disparities);
  validate(config, pair.size(), calibration.rig.has_value());
  const Frame frame = segment_without_saturated(pair, calibration.rig, config, Exec::with_threads(0));

  // An invariant of every disparity map, also with your own check: a pixel with a reason has no disparity.
  int refused = 0;
  for (int y = 0; y < pair.size().height; ++y) {
    for (int x = 0; x < pair.size().width; ++x) {
      if (!has(frame.disparity.reject(x, y), Reject::no_data)) continue;
      ++refused;
      if (frame.disparity.disparity_px(x, y) == frame.disparity.disparity_px(x, y)) return 1;
    }
  }
  std::printf("%d saturated pixels refused, %zu objects\n", refused, frame.objects.list.size());
} catch (const cairn::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
