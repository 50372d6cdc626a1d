// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/regions/refine_disparity.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include <cairn/core/target.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/pipeline/segment.hpp>

#include "support/noise.hpp"
#include "support/region_scene.hpp"
#include "support/samples.hpp"

namespace cairn {
namespace {

using support::RegionScene;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr Size kSize{40, 20};

/// Log-odds `high` where a feature is at least `least`, else `low`.
FittedTrees by(std::string_view feature, float least, float low, float high) {
  const auto names = plane_feature_names();
  const auto at = std::find(names.begin(), names.end(), feature);
  EXPECT_NE(at, names.end()) << feature;
  const std::vector<FittedTrees::Node> nodes{
      {static_cast<std::int16_t>(at - names.begin()), 1, least}, {-1, 0, low}, {-1, 0, high}};
  return {0, std::vector<std::int16_t>{0}, nodes};
}
FittedTrees keeping() {
  return by("kept as it is", 0.5F, -5, 5);
}
FittedTrees by_neighbours() {
  return by("neighbours on this plane, share of the outline", 0.9F, -3, 3);
}

/// Two superpixels side by side, each with a plane of its own.
struct Halves {
  RegionScene scene{halves()};
  Image<float> confidence{kSize, 0.9F, {}};

  Halves() {
    scene.place([](int x, int y, std::size_t region) { return on(region, x, y); });
  }
  static Image<RegionId> halves() {
    Image<RegionId> labels(kSize);
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) labels(x, y) = RegionId{x < kSize.width / 2 ? 0 : 1};
    }
    return labels;
  }
  static float on(std::size_t region, int x, int y) {
    return region == 0 ? 10 + 0.05F * static_cast<float>(y) : 20 - 0.1F * static_cast<float>(x - 20);
  }
  void see(const Rect& box, float d) {
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = box.x; x < box.x + box.width; ++x) scene.disparity_px(x, y) = scene.textured_px(x, y) = d;
    }
  }
  [[nodiscard]] RefinedDisparity refined(const FittedTrees& trees, const Exec& exec = {},
                                         const std::function<void(const JudgedPlane&)>& judged = {}) const {
    const MergeTree tree = grow_merge_tree(scene.superpixels, scene.cues(), {}, exec);
    const ChosenObjects none{std::vector<std::int32_t>(slot(scene.superpixels.count)), {0}, {}};
    return refine_disparity({scene.superpixels, tree, none, scene.cues(), confidence}, trees, exec, judged);
  }
};

TEST(RefineDisparity, KeepsWhatIsMostLikelyRight) {
  Halves seen;
  seen.see({5, 5, 6, 6}, kNan);
  seen.see({25, 5, 4, 4}, 31);
  const RefinedDisparity refined = seen.refined(keeping());
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      if (std::isnan(seen.scene.disparity_px(x, y))) continue;
      EXPECT_EQ(refined.disparity_px(x, y), seen.scene.disparity_px(x, y));
      EXPECT_GT(refined.confidence(x, y), 0.9F);
    }
  }
}

TEST(RefineDisparity, FillsHolesWithTheirPlane) {
  Halves seen;
  seen.see({5, 5, 6, 6}, kNan);
  const RefinedDisparity refined =
      seen.refined(by("superpixel: disparities on this plane, share", 0.9F, -3, 3));
  for (int y = 5; y < 11; ++y) {
    for (int x = 5; x < 11; ++x) {
      EXPECT_NEAR(refined.disparity_px(x, y), Halves::on(0, x, y), 0.01F);
      EXPECT_FLOAT_EQ(refined.confidence(x, y), 3902.0F / 4096) << "the likelihood of log-odds 3";
    }
  }
}

TEST(RefineDisparity, CorrectsWhatLiesOffThePlane) {
  Halves seen;
  seen.see({25, 5, 6, 6}, 31);  // the fringe of something nearer
  seen.see({25, 12, 1, 1}, Halves::on(1, 25, 12) + 0.7F);
  const RefinedDisparity refined =
      seen.refined(by("superpixel: disparities on this plane, share", 0.8F, -3, 3));
  for (int y = 5; y < 11; ++y) {
    for (int x = 25; x < 31; ++x) EXPECT_NEAR(refined.disparity_px(x, y), Halves::on(1, x, y), 0.1F);
  }
  EXPECT_EQ(refined.disparity_px(25, 12), seen.scene.disparity_px(25, 12))
      << "within 1 px, its own is better";
}

TEST(RefineDisparity, TakesThePlaneOfANeighbour) {
  Halves seen;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < 20; ++x) seen.scene.disparity_px(x, y) = seen.scene.textured_px(x, y) = kNan;
  }
  const float most = seen.scene.disparity_px(20, 0);
  EXPECT_EQ(seen.refined(by_neighbours()).disparity_px(10, 10), most) << "not beyond all disparities";
  seen.see({0, 0, 1, 1}, 30);
  const RefinedDisparity refined = seen.refined(by_neighbours());
  EXPECT_NEAR(refined.disparity_px(10, 10), Halves::on(1, 10, 10), 0.05F);
}

TEST(RefineDisparity, KnowsNothingWithoutDisparities) {
  Halves seen;
  seen.see({0, 0, kSize.width, kSize.height}, kNan);
  const RefinedDisparity refined = seen.refined(keeping());
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      EXPECT_TRUE(std::isnan(refined.disparity_px(x, y)));
      EXPECT_EQ(refined.confidence(x, y), 0);
    }
  }
}

TEST(RefineDisparity, TrustsKeptMatchesByTheirConfidenceToo) {
  Halves seen;
  seen.confidence(3, 3) = 0.1F;
  const RefinedDisparity refined = seen.refined(keeping());
  EXPECT_LT(refined.confidence(3, 3), refined.confidence(4, 3) - 0.02F);
  seen.confidence = {};
  EXPECT_FLOAT_EQ(seen.refined(keeping()).confidence(3, 3), 4069.0F / 4096) << "the likelihood of log-odds 5";
}

TEST(RefineDisparity, TellsEachChoiceWithItsPixels) {
  Halves seen;
  seen.see({25, 5, 6, 6}, 31);
  int groups = 0;
  std::size_t pixels = 0;
  const auto judged = [&](const JudgedPlane& choice) {
    EXPECT_EQ(choice.features[0], choice.plane ? 0.0F : 1.0F);
    if (choice.plane) return;
    ++groups;
    pixels += choice.pixels.size();
    for (const SuperpixelPixel& pixel : choice.pixels) {
      EXPECT_EQ(index(seen.scene.superpixels.labels(pixel.x, pixel.y)), slot(choice.superpixel));
      EXPECT_EQ(disparity_on({}, pixel), pixel.disparity_px);
    }
  };
  (void)seen.refined(keeping(), {}, judged);
  EXPECT_EQ(groups, 3) << "two main planes and what lies in front of the second";
  EXPECT_EQ(pixels, static_cast<std::size_t>(kSize.area() / 2)) << "every second one";
}

TEST(RefineDisparity, LooksAtFewerPixelsOfLargeSuperpixels) {
  Image<RegionId> labels({128, 64});
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 128; ++x) labels(x, y) = RegionId{x < 31 ? 0 : x < 63 ? 1 : 2};
  }
  RegionScene scene(std::move(labels));
  scene.place([](int, int y, std::size_t region) {
    return static_cast<float>(region) * 10 + 0.1F * static_cast<float>(y);
  });
  const MergeTree tree = grow_merge_tree(scene.superpixels, scene.cues(), {}, {});
  const ChosenObjects none{std::vector<std::int32_t>(3), {0}, {}};
  std::map<std::int32_t, std::vector<std::pair<int, int>>> seen;
  (void)refine_disparity(
      {scene.superpixels, tree, none, scene.cues(), {}}, keeping(), {}, [&](const JudgedPlane& choice) {
        if (choice.plane) return;
        EXPECT_FLOAT_EQ(choice.features[2], 1) << "all of the superpixel";
        const double area = static_cast<double>(choice.pixels.size()) * choice.pixels_per_sample;
        EXPECT_NEAR(static_cast<double>(choice.features[3]), area / (128 * 64), 1e-6);
        for (const SuperpixelPixel& pixel : choice.pixels)
          seen[choice.superpixel].emplace_back(pixel.x, pixel.y);
      });
  for (const int region : {0, 1}) {
    const int n = region + 1;  // of 31 · 64 and of 32 · 64 px
    std::vector<std::pair<int, int>> expected;
    for (int y = 0; y < 64; ++y) {
      for (int x = region == 0 ? 0 : 31; x < (region == 0 ? 31 : 63); ++x) {
        if (x % n == 0 && y % n == 0 && (x / n + y / n) % 2 == 0) expected.emplace_back(x, y);
      }
    }
    EXPECT_EQ(seen[region], expected) << region;
  }
}

/// Of two pixels that differ from their superpixel's plane, one sample each way.
TEST(RefineDisparity, KeepsAGroupOfOneSampleAndJudgesOneOfTwo) {
  for (const int samples : {1, 2}) {
    Halves seen;
    seen.see({4, 4, 1, 1}, 31);
    if (samples == 2) seen.see({6, 4, 1, 1}, 31);
    int judged = 0;
    const RefinedDisparity refined = seen.refined(by_neighbours(), {}, [&](const JudgedPlane& choice) {
      judged += choice.superpixel == 0 && choice.pixels.size() == slot(samples) ? 1 : 0;
    });
    EXPECT_EQ(judged > 0, samples == 2);
    if (samples == 1) {
      EXPECT_EQ(refined.disparity_px(4, 4), 31);
    }
  }
}

/// From the definition: the choice for each group is the likeliest of those that were judged.
TEST(RefineDisparity, MakesTheLikeliestChoiceOfAnyScene) {
  support::Noise noise(7);
  Halves seen;
  seen.scene.for_each_pixel([&](int x, int y, std::size_t) {
    float& d = seen.scene.disparity_px(x, y);
    if (noise.uniform() < 0.3) d = kNan;
    if (noise.uniform() < 0.2) d = static_cast<float>(5 + 25 * noise.uniform());
    seen.scene.textured_px(x, y) = noise.uniform() < 0.3 ? d : kNan;
  });
  const FittedTrees& trees = plane_classifier();
  struct Best {
    float likely = -1;
    float log_odds = 0;
    std::optional<DisparityPlane> plane;
    std::vector<SuperpixelPixel> pixels;
  };
  std::map<std::pair<std::int32_t, int>, Best> best;
  const RefinedDisparity refined = seen.refined(trees, {}, [&](const JudgedPlane& choice) {
    Best& of = best[{choice.superpixel, choice.group}];
    const float log_odds = trees(choice.features);
    const auto likely = static_cast<float>(1 / (1 + std::exp(-double{log_odds})) + (choice.plane ? 0 : 0.05));
    if (likely <= of.likely + 1e-6F) return;
    of = {likely, log_odds, choice.plane, {choice.pixels.begin(), choice.pixels.end()}};
  });
  std::size_t pixels = 0;
  for (const auto& [group, of] : best) {
    for (const SuperpixelPixel& pixel : of.pixels) {
      const float expected = disparity_on(of.plane, pixel);
      const float found = refined.disparity_px(pixel.x, pixel.y);
      EXPECT_TRUE(found == expected || (std::isnan(expected) && std::isnan(found)));
      if (of.plane) {
        EXPECT_NEAR(refined.confidence(pixel.x, pixel.y), of.likely, 0.01F) << "in steps";
      }
    }
    pixels += of.pixels.size();
  }
  EXPECT_GE(pixels, 380U);
  for (const int threads : {2, 3}) {
    for (const Target target : supported_targets()) {
      const RefinedDisparity other = seen.refined(trees, Exec::with_threads(threads, target));
      EXPECT_EQ(grids::numbers(other.confidence), grids::numbers(refined.confidence));
      EXPECT_EQ(grids::numbers(other.disparity_px), grids::numbers(refined.disparity_px));
    }
  }
}

TEST(LikelyDisparities, AreHolesWithTheirReasonsBelowTheLimit) {
  RefinedDisparity refined{Image<float>({3, 1}, 7.0F, {}), Image<float>({3, 1}, 0.5F, {})};
  refined.confidence(1, 0) = 0.2F;
  refined.disparity_px(2, 0) = kNan;
  Image<Reject> reject({3, 1}, Reject::left_right, {});
  reject(1, 0) = Reject::none;
  const DisparityMap map = likely_disparities(refined, reject, 0.3F, {});
  EXPECT_EQ(map.disparity_px(0, 0), 7);
  EXPECT_EQ(map.reject(0, 0), Reject::none);
  EXPECT_TRUE(std::isnan(map.disparity_px(1, 0)));
  EXPECT_EQ(map.reject(1, 0), Reject::unlikely);
  EXPECT_EQ(map.reject(2, 0), Reject::unlikely | Reject::left_right);
  reject(0, 0) = Reject::sky;
  refined = without_sky(std::move(refined), reject);
  EXPECT_TRUE(std::isnan(refined.disparity_px(0, 0)));
  EXPECT_EQ(refined.confidence(0, 0), 0);
}

/// More pixels have a disparity, and a smaller share of all is wrong or without one.
TEST(RefineDisparity, HelpsOnTheSamples) {
  DisparityErrors matched, refined;
  for (const char* const name : samples::kNames) {
    const samples::Sample sample = samples::load(name);
    const Config config = sample.suited();
    const Image<float> truth_px = io::load_disparity(samples::folder(name) / "disp_left.png");
    const Frame frame = segment(sample.pair(), sample.calibration.rig, config, {});
    const DisparityMap likely = likely_disparities(frame.refined, frame.disparity.reject, kMinRefined, {});
    matched += disparity_errors(frame.disparity.disparity_px, truth_px, {}, 0);
    refined += disparity_errors(likely.disparity_px, truth_px, {}, 0);
  }
  EXPECT_GT(refined.density(), matched.density() + 0.02);
  EXPECT_LT(refined.bad_of_known(2), matched.bad_of_known(2) - 0.02);
}

}  // namespace
}  // namespace cairn
