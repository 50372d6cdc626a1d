// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/cairn.hpp>
#include <cstdint>
#include <support/samples.hpp>
#include <vector>

namespace cairn {
namespace {

/// Heap allocations of the segmenter's pool after each of `frames` calls, with each frame released before the
/// next one.
std::vector<std::int64_t> allocations_by_frame(const Segmenter& segmenter, const StereoPair& pair,
                                               int frames) {
  std::vector<std::int64_t> counts;
  for (int i = 0; i < frames; ++i) {
    static_cast<void>(segmenter.segment(pair));
    counts.push_back(segmenter.exec().pool.heap_allocations());
  }
  return counts;
}

TEST(Segmenter, AllocatesNoImageFromTheSecondFrameOn) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const Segmenter segmenter(sample.suited(), sample.calibration.rig);
  const auto counts = allocations_by_frame(segmenter, sample.pair(), 3);
  EXPECT_GT(counts[0], 0) << "the first frame did not use the pool at all";
  EXPECT_EQ(counts[1], counts[0]);
  EXPECT_EQ(counts[2], counts[0]);
}

TEST(Segmenter, AllocatesNoImageFromTheSecondFrameOnWithTheWholePaper) {
  const samples::Sample sample = samples::load("glossy_floor");
  const Segmenter segmenter(sample.suited(Config::paper()), sample.calibration.rig);
  const auto counts = allocations_by_frame(segmenter, sample.pair(), 3);
  EXPECT_GT(counts[0], 0) << "the first frame did not use the pool at all";
  EXPECT_EQ(counts[2], counts[0]);
}

TEST(Segmenter, AllocatesNoImageFromTheSecondFrameOnWithSeveralThreads) {
  const samples::Sample sample = samples::load("glossy_floor");
  for (const Config& config : {sample.suited(), sample.suited(Config::paper())}) {
    const Segmenter segmenter(config, sample.calibration.rig, Exec::with_threads(3));
    const auto counts = allocations_by_frame(segmenter, sample.pair(), 6);
    EXPECT_EQ(counts[5], counts[1]);
  }
}

TEST(Segmenter, AllocatesNoImageWithFramesThatOverlap) {
  const samples::Sample sample = samples::load("glossy_floor");
  for (const int threads : {2, 4}) {
    for (const Config& config : {sample.suited(), sample.suited(Config::paper())}) {
      const Segmenter segmenter(config, sample.calibration.rig, Exec::with_threads(threads));
      std::vector<std::int64_t> counts;
      for (int frame = 0; frame < 8; ++frame) {
        segmenter.prefetch(sample.pair());
        static_cast<void>(segmenter.segment(sample.pair()));
        counts.push_back(segmenter.exec().pool.heap_allocations());
      }
      EXPECT_EQ(counts[7], counts[3]);
    }
  }
}

TEST(Segmenter, EqualsSegment) {
  const samples::Sample sample = samples::load("overlap");
  const Segmenter segmenter(sample.suited(), sample.calibration.rig);
  const Frame expected = segment(sample.pair(), sample.calibration.rig, sample.suited(), {});
  for (int i = 0; i < 2; ++i) {
    const Frame frame = segmenter.segment(sample.pair());
    ASSERT_EQ(frame.objects.list.size(), expected.objects.list.size());
    for (std::size_t k = 0; k < expected.objects.list.size(); ++k) {
      EXPECT_EQ(frame.objects.list[k].box_px, expected.objects.list[k].box_px);
      EXPECT_EQ(frame.objects.list[k].position_in_camera_m, expected.objects.list[k].position_in_camera_m);
    }
  }
}

TEST(Segmenter, RefusesABadConfigurationAtConstruction) {
  Config config;
  config.match.window_size = 4;
  EXPECT_THROW(Segmenter{config}, Error);
}

TEST(Segmenter, RefusesABadCalibrationAtConstruction) {
  const StereoRig flat{.focal_px = 0, .baseline_m = 0.1F};
  EXPECT_THROW(Segmenter(Config(), flat), Error);
  const Image<Gray> grey(Size{64, 48}, Gray{0}, {});
  EXPECT_THROW((void)segment(StereoPair::from(grey, grey), flat, Config(), {}), Error);
}

}  // namespace
}  // namespace cairn
