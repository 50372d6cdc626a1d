// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <bit>
#include <cairn/cairn.hpp>
#include <cairn/core/target.hpp>
#include <cairn/stereo/match_device.hpp>
#include <cstdint>
#include <functional>
#include <latch>
#include <string>
#include <support/samples.hpp>
#include <thread>
#include <utility>
#include <vector>

#if CAIRN_WITH_VULKAN
#include <cairn/device/careful_device.hpp>
#include <cairn/device/vulkan/vulkan_engine.hpp>
#endif

namespace cairn {
namespace {

/// The number of pixels of two images that differ in any bit. Different sizes count as one whole image.
template <class T>
std::int64_t differing(const Image<T>& a, const Image<T>& b) {
  if (a.size() != b.size()) return std::max(a.size().area(), b.size().area());
  std::int64_t count = 0;
  for (int y = 0; y < a.height(); ++y) {
    for (int x = 0; x < a.width(); ++x) {
      // Bitwise: a NaN equals itself, and 0 differs from −0.
      if constexpr (std::is_same_v<T, float>) {
        count += std::bit_cast<std::uint32_t>(a(x, y)) != std::bit_cast<std::uint32_t>(b(x, y)) ? 1 : 0;
      } else {
        count += a(x, y) != b(x, y) ? 1 : 0;
      }
    }
  }
  return count;
}

void expect_same_regions(const Segmentation& a, const Segmentation& b) {
  EXPECT_EQ(differing(a.labels, b.labels), 0);
  ASSERT_EQ(a.regions.size(), b.regions.size());
  for (std::size_t i = 0; i < a.regions.size(); ++i) {
    EXPECT_EQ(a.regions[i].pixel_count, b.regions[i].pixel_count);
    EXPECT_EQ(a.regions[i].valid_count, b.regions[i].valid_count);
    EXPECT_EQ(a.regions[i].box, b.regions[i].box);
    EXPECT_EQ(a.regions[i].mean, b.regions[i].mean);
    EXPECT_EQ(a.regions[i].variance, b.regions[i].variance);
    EXPECT_EQ(a.regions[i].is_floor, b.regions[i].is_floor);
    EXPECT_EQ(a.regions[i].is_background, b.regions[i].is_background);
  }
}

void expect_same_ground(const Ground& a, const Ground& b) {
  EXPECT_EQ(a.refusal, b.refusal);
  EXPECT_EQ(a.support, b.support);
  EXPECT_EQ(a.residual_px, b.residual_px);
  ASSERT_EQ(a.plane.has_value(), b.plane.has_value());
  if (!a.plane) return;
  EXPECT_EQ(a.plane->a, b.plane->a);
  EXPECT_EQ(a.plane->b, b.plane->b);
  EXPECT_EQ(a.plane->c, b.plane->c);
}

void expect_same_objects(const Objects& a, const Objects& b) {
  EXPECT_EQ(differing(a.labels, b.labels), 0);
  ASSERT_EQ(a.list.size(), b.list.size());
  for (std::size_t i = 0; i < a.list.size(); ++i) {
    EXPECT_EQ(a.list[i].id, b.list[i].id);
    EXPECT_EQ(a.list[i].box_px, b.list[i].box_px);
    EXPECT_EQ(a.list[i].pixel_count, b.list[i].pixel_count);
    EXPECT_EQ(a.list[i].disparity_px, b.list[i].disparity_px);
    EXPECT_EQ(a.list[i].valid_share, b.list[i].valid_share);
    EXPECT_EQ(a.list[i].confidence, b.list[i].confidence);
    EXPECT_EQ(a.list[i].mean_colour, b.list[i].mean_colour);
    EXPECT_EQ(a.list[i].position_in_camera_m, b.list[i].position_in_camera_m);
    EXPECT_EQ(a.list[i].extent_in_camera_m, b.list[i].extent_in_camera_m);
    EXPECT_EQ(a.list[i].disparity_sigma_px, b.list[i].disparity_sigma_px);
    ASSERT_EQ(a.list[i].box_on_floor.has_value(), b.list[i].box_on_floor.has_value());
    if (!a.list[i].box_on_floor) continue;
    EXPECT_EQ(a.list[i].box_on_floor->centre_in_floor_m, b.list[i].box_on_floor->centre_in_floor_m);
    EXPECT_EQ(a.list[i].box_on_floor->size_m, b.list[i].box_on_floor->size_m);
    EXPECT_EQ(a.list[i].box_on_floor->yaw_rad, b.list[i].box_on_floor->yaw_rad);
    EXPECT_EQ(a.list[i].box_on_floor->centre_covariance_m2, b.list[i].box_on_floor->centre_covariance_m2);
  }
}

void expect_same(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.epipolar.rows, b.epipolar.rows);
  EXPECT_EQ(a.epipolar.agreeing, b.epipolar.agreeing);
  EXPECT_EQ(differing(a.disparity.disparity_px, b.disparity.disparity_px), 0);
  EXPECT_EQ(differing(a.disparity.reject, b.disparity.reject), 0);
  EXPECT_EQ(differing(a.confidence, b.confidence), 0);
  EXPECT_EQ(differing(a.refined.disparity_px, b.refined.disparity_px), 0);
  EXPECT_EQ(differing(a.refined.confidence, b.refined.confidence), 0);
  EXPECT_EQ(differing(a.space, b.space), 0);
  expect_same_ground(a.ground, b.ground);
  EXPECT_EQ(differing(a.floor, b.floor), 0);
  expect_same_regions(a.by_intensity, b.by_intensity);
  expect_same_regions(a.by_disparity, b.by_disparity);
  EXPECT_EQ(differing(a.fusion.labels, b.fusion.labels), 0);
  EXPECT_EQ(a.fusion.parts, b.fusion.parts);
  EXPECT_EQ(a.fusion.disparity_region, b.fusion.disparity_region);
  EXPECT_EQ(a.fusion.is_floor, b.fusion.is_floor);
  expect_same_regions(a.superpixels, b.superpixels);
  expect_same_regions(a.groups, b.groups);
  expect_same_objects(a.objects, b.objects);
}

/// Segments a sample with every target of this machine and 1 to 16 threads, including more than there are
/// processors and a number that divides no image height, and compares all results with those of one scalar
/// thread.
void expect_exec_changes_nothing(const std::string& name, const Config& preset) {
  const samples::Sample sample = samples::load(name);
  const Config config = sample.suited(preset);
  const auto run = [&](int threads, Target target) {
    return segment(sample.pair(), sample.calibration.rig, config, Exec::with_threads(threads, target));
  };
  const Frame expected = run(1, Target::scalar);
  EXPECT_FALSE(expected.objects.list.empty()) << "there is little to compare";
  for (const Target target : supported_targets()) {
    for (const int threads : {1, 2, 3, 8, 16}) {
      SCOPED_TRACE(name + ", " + std::to_string(threads) + " threads, target " +
                   std::string(cairn::name(target)));
      expect_same(run(threads, target), expected);
    }
  }
}

TEST(ExecLaw, ThreadsAndTargetsChangeNoBitOfTheDefaultPreset) {
  expect_exec_changes_nothing("overlap", Config());
}

TEST(ExecLaw, ThreadsAndTargetsChangeNoBitOfThePaperPreset) {
  expect_exec_changes_nothing("glossy_floor", Config::paper());
}

TEST(ExecLaw, ATargetThatThisMachineLacksChangesNoBit) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const Frame expected = segment(sample.pair(), sample.calibration.rig, sample.suited(), {});
  for (const Target target : {Target::sse4, Target::avx2, Target::avx512, Target::neon}) {
    const Exec exec = Exec::with_threads(2, target);
    if (active_target(exec) == target) continue;
    SCOPED_TRACE(name(target));
    expect_same(segment(sample.pair(), sample.calibration.rig, sample.suited(), exec), expected);
  }
}

/// Starts `users` threads at the same moment, each with its number.
void all_at_once(int users, const std::function<void(int)>& use) {
  std::latch begin(users);
  std::vector<std::jthread> threads;
  for (int user = 0; user < users; ++user) {
    threads.emplace_back([&, user] {
      begin.arrive_and_wait();
      use(user);
    });
  }
}

TEST(ExecLaw, ConcurrentSegmentersChangeNoBitOfEachOther) {
  const samples::Sample sample = samples::load("overlap");
  const std::vector<Config> configs = {sample.suited(), sample.suited(Config::paper())};
  std::vector<Frame> expected;
  for (const Config& config : configs)
    expected.push_back(segment(sample.pair(), sample.calibration.rig, config, {}));
  std::vector<std::vector<Frame>> found(4);
  all_at_once(4, [&](int user) {
    // Both presets, with one thread and with several.
    const Segmenter segmenter(configs.at(static_cast<std::size_t>(user % 2)), sample.calibration.rig,
                              Exec::with_threads(1 + user / 2 * 2));
    for (int i = 0; i < 3; ++i)
      found.at(static_cast<std::size_t>(user)).push_back(segmenter.segment(sample.pair()));
  });
  for (std::size_t user = 0; user < found.size(); ++user) {
    SCOPED_TRACE(user);
    for (const Frame& frame : found[user]) expect_same(frame, expected[user % 2]);
  }
}

TEST(ExecLaw, OneSegmenterGivesTheSameToSeveralThreads) {
  const std::array different{samples::load("overlap"), samples::load("four_in_a_row")};
  for (const Config& preset : {Config(), Config::paper()}) {
    const Segmenter segmenter(different[0].suited(preset), different[0].calibration.rig,
                              Exec::with_threads(2));
    std::vector<Frame> expected;
    expected.reserve(different.size());
    for (const samples::Sample& sample : different) expected.push_back(segmenter.segment(sample.pair()));
    std::vector<std::vector<Frame>> found(4);
    all_at_once(4, [&](int user) {
      for (int i = 0; i < 3; ++i) {
        found.at(static_cast<std::size_t>(user))
            .push_back(segmenter.segment(different.at(static_cast<std::size_t>(user + i) % 2).pair()));
      }
    });
    for (std::size_t user = 0; user < found.size(); ++user) {
      ASSERT_EQ(found[user].size(), 3U);
      for (std::size_t i = 0; i < 3; ++i) expect_same(found[user][i], expected[(user + i) % 2]);
    }
  }
}

/// Calls prefetch() for these pairs, then segment() for those.
struct Asked {
  std::vector<int> early;
  std::vector<int> segmented;
};

/// Matches like a device that is there for two pairs of three.
class SometimesDevice final : public MatchDevice {
 public:
  [[nodiscard]] bool takes_early(const MatchConfig& config) const override {
    return config.method == MatchMethod::semi_global;
  }
  void begin(const StereoPair& /*pair*/, const MatchConfig& /*config*/,
             const SemiGlobalConfig& /*penalties*/) override {
    ++begun;
  }
  std::optional<Matches> match(const StereoPair& pair, const MatchConfig& config,
                               const SemiGlobalConfig& penalties, const Exec& exec) override {
    if (config.method == MatchMethod::window || ++asked % 3 == 0) return std::nullopt;
    return match_semi_global(pair, config, penalties, exec);
  }
  [[nodiscard]] DeviceReport report() const override { return {}; }

  std::atomic<int> begun = 0;
  std::atomic<int> asked = 0;
};

TEST(ExecLaw, WithOneThreadADeviceBeginsTheNextMatches) {
  const auto device = std::make_shared<SometimesDevice>();
  const samples::Sample sample = samples::load("overlap");
  Exec exec;
  exec.device = device;
  const Segmenter segmenter(sample.suited(), sample.calibration.rig, exec);
  const Frame expected = segment(sample.pair(), sample.calibration.rig, sample.suited(), {});
  for (int k = 0; k < 4; ++k) {
    segmenter.prefetch(sample.pair());
    expect_same(segmenter.segment(sample.pair()), expected);
  }
  EXPECT_EQ(device->begun, 4);
  EXPECT_EQ(device->asked, 4);
}

/// Without a device, and with each of these.
std::vector<std::shared_ptr<MatchDevice>> devices_to_try() {
  std::vector<std::shared_ptr<MatchDevice>> all{nullptr, std::make_shared<SometimesDevice>()};
#if CAIRN_WITH_VULKAN
  try {
    all.push_back(std::make_shared<device::CarefulDevice>(
        [] { return device::vulkan_engine(device::vulkan_library(), 0); }, device::Trust{}, nullptr));
  } catch (const device::Unfit&) {
    // No driver, not even in software.
  }
#endif
  return all;
}

TEST(ExecLaw, DevicesChangeNoBit) {
  for (const char* const name : {"overlap", "glossy_floor", "dim_light"}) {
    const samples::Sample sample = samples::load(name);
    for (const Config& preset : {Config(), Config::paper()}) {
      const Config config = sample.suited(preset);
      const Frame expected = segment(sample.pair(), sample.calibration.rig, config, {});
      for (const auto& device : devices_to_try()) {
        Exec exec = Exec::with_threads(2);
        exec.device = device;
        SCOPED_TRACE(std::string(name) + (device ? " on " + device->report().name : ""));
        expect_same(segment(sample.pair(), sample.calibration.rig, config, exec), expected);
      }
    }
  }
}

TEST(ExecLaw, FramesBegunEarlyChangeNoBitOnADevice) {
  const std::array different{samples::load("overlap"), samples::load("four_in_a_row")};
  for (const auto& device : devices_to_try()) {
    Exec exec;
    exec.device = device;
    const Segmenter segmenter(different[0].suited(), different[0].calibration.rig, exec);
    std::vector<Frame> expected;
    for (const samples::Sample& sample : different)
      expected.push_back(segment(sample.pair(), different[0].calibration.rig, different[0].suited(), {}));
    for (const std::size_t k : {0U, 1U, 0U, 0U}) {
      segmenter.prefetch(different.at(1 - k).pair());
      expect_same(segmenter.segment(different.at(k).pair()), expected.at(k));
    }
  }
}

TEST(ExecLaw, FramesBegunEarlyChangeNoBit) {
  const std::array<samples::Sample, 3> different{samples::load("overlap"), samples::load("four_in_a_row"),
                                                 samples::load("dim_light")};
  // As a loop over frames does; pairs that are never asked for; more than may be begun; none; the same one twice.
  const std::vector<Asked> loop = {
      {{1}, {0}},          {{2}, {1}},   {{0}, {2}},       {{1, 2}, {0}}, {{0}, {1}},
      {{1, 2, 0, 1}, {2}}, {{}, {0, 1}}, {{2, 2}, {2, 2}}, {{0}, {1}},    {{}, {2}}};
  for (const Config& preset : {Config(), Config::paper()}) {
    for (const int threads : {1, 2, 5}) {
      SCOPED_TRACE(std::to_string(threads) + " threads");
      const Config config = different[0].suited(preset);
      const auto& rig = different[0].calibration.rig;
      int stages = 0;
      Exec exec = Exec::with_threads(threads);
      exec.observe = [&](std::string_view, const StageResult&, double) { ++stages; };
      const Segmenter segmenter(config, rig, exec);
      std::vector<Frame> expected;
      int expected_stages = 0;
      for (const samples::Sample& sample : different) {
        expected.push_back(segmenter.segment(sample.pair()));
        expected_stages = std::exchange(stages, 0);
      }
      for (const Asked& asked : loop) {
        for (const int i : asked.early) segmenter.prefetch(different.at(static_cast<std::size_t>(i)).pair());
        for (const int i : asked.segmented) {
          const auto at = static_cast<std::size_t>(i);
          expect_same(segmenter.segment(different.at(at).pair()), expected[at]);
          EXPECT_EQ(std::exchange(stages, 0), expected_stages);
        }
      }
    }
  }
}

TEST(ExecLaw, ImagesMayChangeAfterTheyAreBegun) {
  const samples::Sample sample = samples::load("overlap");
  const samples::Sample other = samples::load("four_in_a_row");
  const Segmenter segmenter(sample.suited(), sample.calibration.rig, Exec::with_threads(2));
  const Frame expected = segmenter.segment(other.pair());
  Image<Gray> left = samples::load("overlap").images.left.gray.clone();
  const auto pair = [&] { return StereoPair::from(left, other.pair().right(), other.pair().left_rgb()); };
  ASSERT_EQ(left.size(), other.pair().size());
  segmenter.prefetch(pair());
  const View<const Gray> fresh = other.pair().left();
  for (int y = 0; y < left.height(); ++y) std::copy_n(fresh.row(y), left.width(), left.row(y));
  expect_same(segmenter.segment(pair()), expected);
}

TEST(ExecLaw, SeveralThreadsMayBeginFramesOfOneSegmenter) {
  const std::array different{samples::load("overlap"), samples::load("four_in_a_row")};
  const Segmenter segmenter(different[0].suited(), different[0].calibration.rig, Exec::with_threads(2));
  std::vector<Frame> expected;
  expected.reserve(different.size());
  for (const samples::Sample& sample : different) expected.push_back(segmenter.segment(sample.pair()));
  std::vector<std::vector<Frame>> found(3);
  all_at_once(3, [&](int user) {
    for (int i = 0; i < 4; ++i) {
      segmenter.prefetch(different.at(static_cast<std::size_t>(user + i + 1) % 2).pair());
      found.at(static_cast<std::size_t>(user))
          .push_back(segmenter.segment(different.at(static_cast<std::size_t>(user + i) % 2).pair()));
    }
  });
  for (std::size_t user = 0; user < found.size(); ++user) {
    ASSERT_EQ(found[user].size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) expect_same(found[user][i], expected[(user + i) % 2]);
  }
}

TEST(ExecLaw, APoolAndAnObserverChangeNoBit) {
  const samples::Sample sample = samples::load("four_in_a_row");
  const Config config = sample.suited();
  const Frame expected = segment(sample.pair(), sample.calibration.rig, config, {});
  int stages = 0;
  Exec exec = Exec::with_threads(2);
  exec.pool = Pool::make();
  exec.observe = [&stages](std::string_view, const StageResult&, double) { ++stages; };
  for (int i = 0; i < 2; ++i)
    expect_same(segment(sample.pair(), sample.calibration.rig, config, exec), expected);
  EXPECT_GT(stages, 0);
}

TEST(ExecLaw, AnObserverMayEndAFrameAtAnyStage) {
  const samples::Sample sample = samples::load("overlap");
  for (const Config& config : {sample.suited(), sample.suited(Config::paper())}) {
    Exec exec = Exec::with_threads(2);
    exec.pool = Pool::make();
    const Frame expected = segment(sample.pair(), sample.calibration.rig, config, exec);
    int stages = 0;
    exec.observe = [&stages](std::string_view, const StageResult&, double) { ++stages; };
    static_cast<void>(segment(sample.pair(), sample.calibration.rig, config, exec));
    for (int last = 1; last <= stages; ++last) {
      int stage = 0;
      exec.observe = [&](std::string_view, const StageResult&, double) {
        if (++stage == last) throw Error("enough");
      };
      EXPECT_THROW(static_cast<void>(segment(sample.pair(), sample.calibration.rig, config, exec)), Error);
    }
    exec.observe = {};
    expect_same(segment(sample.pair(), sample.calibration.rig, config, exec), expected);
  }
}

}  // namespace
}  // namespace cairn
