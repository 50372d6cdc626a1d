// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/core/future.hpp>
#include <cairn/core/nearest.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/core/pool_memory.hpp>
#include <cairn/core/stage_clock.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory_resource>
#include <random>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

namespace cairn {
namespace {

TEST(Rect, GapsAreCountedAlongEachAxis) {
  const Rect box{10, 20, 5, 6};
  EXPECT_EQ(gap_between(box, {15, 28, 1, 1}), (Size{0, 2}));  // they touch along x
  EXPECT_EQ(gap_between({3, 0, 4, 18}, box), (Size{3, 2}));
  EXPECT_EQ(gap_between(box, {12, 21, 40, 40}), (Size{0, 0}));
}

TEST(Image, StartsEveryRowAtACacheLine) {
  for (const int width : {1, 3, 16, 63, 64, 65, 320}) {
    Image<Rgb> rgb(Size{width, 3});
    Image<float> numbers(Size{width, 3});
    for (int y = 0; y < 3; ++y) {
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(rgb.row(y)) % 64, 0U);
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(numbers.row(y)) % 64, 0U);
    }
  }
}

TEST(Image, IsMovedNotCopied) {
  static_assert(!std::is_copy_constructible_v<Image<float>>);
  Image<int> a(Size{2, 2}, 7, {});
  const int* pixels = a.row(0);
  const Image<int> b = std::move(a);
  EXPECT_EQ(b.row(0), pixels);
  EXPECT_EQ(b(1, 1), 7);
}

TEST(Image, OfATemporaryGivesNoView) {
  static_assert(!std::is_convertible_v<Image<float>&&, View<const float>>);
  static_assert(std::is_convertible_v<Image<float>&, View<const float>>);
}

TEST(View, ShowsASubWindowOfItsOwner) {
  Image<int> image(Size{4, 3}, 0, {});
  image(2, 1) = 5;
  const View<const int> part = View<const int>(image.view()).sub({1, 1, 3, 2});
  EXPECT_EQ(part(1, 0), 5);
  EXPECT_EQ(part.stride(), image.view().stride());
}

TEST(Pool, ReusesTheBufferOfAFreedImage) {
  const Pool pool = Pool::make();
  for (int frame = 0; frame < 5; ++frame) {
    const Image<float> a(Size{100, 50}, pool);
    const Image<std::uint8_t> b(Size{100, 50}, pool);
  }
  EXPECT_EQ(pool.heap_allocations(), 2);
  EXPECT_GE(pool.bytes(), 100 * 50 * 5);
}

TEST(Pool, OutlivesItsHandleAsLongAsAnImageDoes) {
  Image<int> survivor;
  {
    const Pool pool = Pool::make();
    survivor = Image<int>(Size{8, 8}, 3, pool);
  }
  EXPECT_EQ(survivor(7, 7), 3);
}

TEST(PoolMemory, ReusesTheBufferOfAFreedVector) {
  const Pool pool = Pool::make();
  PoolMemory memory(pool);
  const void* first = nullptr;
  {
    const std::pmr::vector<double> numbers(10000, 3.0, &memory);
    first = numbers.data();
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(first) % 64, 0U);
  }
  const std::pmr::vector<int> others(20000, 7, &memory);  // no larger
  EXPECT_EQ(others.data(), first);
  EXPECT_EQ(pool.heap_allocations(), 1);
}

TEST(PoolMemory, AllocatesSmallVectorsOnTheHeap) {
  const Pool pool = Pool::make();
  PoolMemory memory(pool);
  const std::pmr::vector<int> few(100, 7, &memory);
  EXPECT_EQ(pool.heap_allocations(), 0);
}

TEST(Pool, WhatIsDoneAgainAllocatesNothing) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const Pool pool = Pool::make();
    std::vector<std::int64_t> allocations;
    for (int frame = 0; frame < 3; ++frame) {
      std::mt19937 random(seed);
      std::vector<Image<std::uint8_t>> held;
      for (int k = 0; k < 200; ++k) {
        const auto at = static_cast<std::ptrdiff_t>(random() % 8);
        const int width = static_cast<int>(random() % 200) + 1;
        if (at < std::ssize(held)) {
          held.erase(held.begin() + at);
        } else {
          held.emplace_back(Size{width, 20}, pool);
        }
      }
      held.clear();
      allocations.push_back(pool.heap_allocations());
    }
    EXPECT_GT(allocations.front(), 0);
    EXPECT_EQ(allocations.front(), allocations.back()) << "seed " << seed;
  }
}

TEST(Pool, DoesNotUseALargeBufferForASmallImage) {
  const Pool pool = Pool::make();
  { const Image<float> large(Size{640, 480}, pool); }
  { const Image<float> small(Size{8, 8}, pool); }
  EXPECT_EQ(pool.heap_allocations(), 2);
}

TEST(ParallelFor, VisitsEachElementOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    const Exec exec = Exec::with_threads(threads);
    EXPECT_EQ(exec.threads(), threads);
    for (const int count : {0, 1, 7, 100, 1000}) {
      std::vector<std::atomic<int>> visits(static_cast<std::size_t>(count));
      parallel_for(exec, count, 3, [&](int first, int last) {
        for (int i = first; i < last; ++i) ++visits[static_cast<std::size_t>(i)];
      });
      for (const auto& v : visits) EXPECT_EQ(v, 1);
    }
  }
}

TEST(SideWork, IsDoneAfterWait) {
  for (const int threads : {1, 2, 4}) {
    const Exec exec = Exec::with_threads(threads);
    std::atomic<int> sum = 0;
    SideWork work(exec,
                  [&] { parallel_for(exec, 1000, 7, [&](int first, int last) { sum += last - first; }); });
    std::atomic<int> own = 0;
    parallel_for(exec, 1000, 7, [&](int first, int last) { own += last - first; });
    EXPECT_EQ(own, 1000);
    work.wait();
    EXPECT_EQ(sum, 1000) << threads;
  }
}

TEST(SideWork, PropagatesExceptions) {
  for (const int threads : {1, 2}) {
    SideWork work(Exec::with_threads(threads), [] { throw Error("no"); });
    EXPECT_THROW(work.wait(), Error) << threads;
  }
}

TEST(SideWork, FinishesBeforeItsDestructorReturns) {
  for (const int threads : {1, 2}) {
    std::atomic<bool> gone = false;
    std::atomic<bool> late = false;
    {
      const SideWork work(Exec::with_threads(threads), [&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        late = gone.load();
        throw Error("nobody hears this");
      });
    }
    gone = true;
    EXPECT_FALSE(late) << threads;
  }
}

TEST(Future, IsComputedConcurrentlyWithItsOwnPool) {
  for (const int threads : {1, 2}) {
    Exec exec = Exec::with_threads(threads);
    exec.observe = [](std::string_view, const StageResult&, double) {};
    Future<std::string> later(
        exec, [](const Exec& beside) { return std::string(beside.observe ? "seen" : "unseen"); });
    EXPECT_EQ(later.get(), "unseen") << threads;
    Future<int> fails(exec, [](const Exec&) -> int { throw Error("no"); });
    EXPECT_THROW((void)fails.get(), Error) << threads;
  }
}

TEST(Pool, HasASecondPoolThatCountsAsPartOfIt) {
  const Pool pool = Pool::make();
  { const Image<float> image(Size{100, 50}, pool); }
  {
    const Image<float> image(Size{100, 50}, pool.beside());
    EXPECT_EQ(pool.heap_allocations(), 2) << "the free buffer of the other pool was taken";
  }
  { const Image<float> image(Size{100, 50}, pool.beside()); }
  EXPECT_EQ(pool.heap_allocations(), 2);
  EXPECT_GE(pool.bytes(), 2 * 100 * 50 * 4);
  EXPECT_EQ(Pool().beside().heap_allocations(), 0);
}

TEST(StageClock, ReportsEachStageAndReturnsItsResult) {
  std::vector<std::string> stages;
  Exec exec;
  exec.observe = [&](std::string_view stage, const StageResult& result, double ms) {
    stages.emplace_back(stage);
    EXPECT_EQ((*result.as<Image<float>>())(0, 0), 4.0F);
    EXPECT_GE(ms, 0);
  };
  StageClock stage(exec);
  const Image<float> result = stage("refine", Image<float>(Size{1, 1}, 4.0F, {}));
  EXPECT_EQ(result(0, 0), 4.0F);
  EXPECT_EQ(stages, std::vector<std::string>{"refine"});
}

TEST(StereoPair, RefusesImagesOfDifferentSize) {
  const Image<Gray> a(Size{4, 3}, 0, {});
  const Image<Gray> b(Size{5, 3}, 0, {});
  EXPECT_NO_THROW((void)StereoPair::from(a, a));
  EXPECT_THROW((void)StereoPair::from(a, b), Error);
  EXPECT_THROW((void)StereoPair::from({}, {}), Error);
  const Image<Rgb> colour(Size{5, 3}, Rgb{}, {});
  EXPECT_THROW((void)StereoPair::from(a, a, colour), Error);
}

TEST(StereoRig, TurnsDisparityIntoMetres) {
  const StereoRig rig{.focal_px = 500, .cx_px = 320, .cy_px = 240, .baseline_m = 0.1F, .doffs_px = 10};
  const auto point = rig.point_in_camera_m(420, 190, 15);
  ASSERT_TRUE(point);
  EXPECT_FLOAT_EQ(point->z, 2.0F);  // 500 · 0.1 / (15 + 10)
  EXPECT_FLOAT_EQ(point->x, 0.4F);
  EXPECT_FLOAT_EQ(point->y, -0.2F);
  EXPECT_FALSE(rig.point_in_camera_m(0, 0, -10));
  EXPECT_FALSE((StereoRig{.focal_px = 1e30F, .baseline_m = 1e20F}.point_in_camera_m(0, 0, 10)));
}

TEST(StereoRig, RefusesImpossibleCameras) {
  const StereoRig good{.focal_px = 500, .cx_px = 320, .cy_px = 240, .baseline_m = 0.1F, .doffs_px = 0};
  EXPECT_NO_THROW(good.validate());
  for (const float bad : {0.0F, -1.0F, std::nanf(""), std::numeric_limits<float>::infinity()}) {
    StereoRig rig = good;
    rig.focal_px = bad;
    EXPECT_THROW(rig.validate(), Error) << bad;
    rig = good;
    rig.baseline_m = bad;
    EXPECT_THROW(rig.validate(), Error) << bad;
  }
}

TEST(Nearest, FindsTheIntendedName) {
  const std::vector<std::string> names{"match.window_size", "match.row_band", "speckle.size"};
  EXPECT_EQ(nearest("match.windowsize", names), "match.window_size");
  EXPECT_EQ(nearest("spekle.size", names), "speckle.size");
  EXPECT_EQ(nearest("zzzzzzzz", names), "");
  EXPECT_EQ(nearest("match.win", names), "match.window_size");
  EXPECT_EQ(nearest("window_size", names), "match.window_size");
  EXPECT_EQ(nearest("nope", {"live", "help"}), "");
}

}  // namespace
}  // namespace cairn
