// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// How far a device is trusted, with an engine whose faults the tests choose.
#include <gtest/gtest.h>

#include <atomic>
#include <cairn/device/careful_device.hpp>
#include <deque>
#include <functional>
#include <new>
#include <support/first_difference.hpp>
#include <support/random_pair.hpp>
#include <thread>
#include <utility>
#include <vector>

namespace cairn::device {
namespace {

using namespace std::chrono_literals;

enum class Fault : std::uint8_t { none, unfit, lost, lost_at_finish, hangs, wrong, slow, no_memory };

/// Computes on the processor; each pair meets the next fault.
class FakeEngine final : public Engine {
 public:
  FakeEngine(std::deque<Fault>& faults, std::atomic<int>& submitted)
      : faults_(faults), submitted_(submitted) {}
  [[nodiscard]] std::string name() const override { return "fake"; }
  [[nodiscard]] std::string full_name() const override { return "fake (driver 1)"; }
  [[nodiscard]] std::string variant(int num_disparities) const override {
    return num_disparities < 32 ? "narrow" : "wide";
  }
  void submit(const StereoPair& pair, const MatchConfig& config, const SemiGlobalConfig& penalties) override {
    EXPECT_TRUE(!is_at_work_ || fault_ == Fault::no_memory) << "one pair at a time";
    ++submitted_;
    fault_ = faults_.empty() ? Fault::none : faults_.front();
    if (!faults_.empty()) faults_.pop_front();
    if (fault_ == Fault::unfit) throw Unfit("too large for fake");
    if (fault_ == Fault::lost) throw Lost("fake has failed");
    is_at_work_ = true;
    found_ = match_semi_global(pair, config, penalties, {});
    if (fault_ == Fault::wrong) found_.best(3, 3) = 77;
  }
  Matches finish(const Exec& /*exec*/) override {
    EXPECT_TRUE(is_at_work_);
    if (fault_ == Fault::no_memory) throw std::bad_alloc();
    is_at_work_ = false;
    if (fault_ == Fault::slow) std::this_thread::sleep_for(20ms);
    if (fault_ == Fault::lost_at_finish) throw Lost("fake has failed");
    if (fault_ == Fault::hangs) throw Lost("fake has not answered", true);
    return std::move(found_);
  }
  [[nodiscard]] std::vector<DeviceKernel> work() const override { return {{"all", 2, 100, 1}}; }
  [[nodiscard]] std::int64_t memory_bytes() const override { return 9; }

 private:
  std::deque<Fault>& faults_;
  std::atomic<int>& submitted_;
  Fault fault_ = Fault::none;
  bool is_at_work_ = false;
  Matches found_{};
};

class CarefulDeviceTest : public testing::Test {
 protected:
  std::deque<Fault> faults;  // of the pairs to come, the self-test's included
  std::atomic<int> submitted = 0;
  std::atomic<int> opened = 0;
  std::vector<std::string> notices;
  const RandomPair a{{40, 20}, 1}, b{{40, 20}, 2}, c{{40, 20}, 3};
  const MatchConfig config{.method = MatchMethod::semi_global, .num_disparities = 40};

  /// By way of match(), which asks the processor where the device does not answer: always the same bits.
  void expect_right(const std::shared_ptr<MatchDevice>& device, const RandomPair& images) {
    Exec exec;
    exec.device = device;
    EXPECT_EQ(first_difference(match_semi_global(images.pair(), config, {}, {}),
                               match(images.pair(), config, {}, exec)),
              "");
  }
  std::shared_ptr<CarefulDevice> shared(Trust trust = {}) {
    return std::shared_ptr<CarefulDevice>(new CarefulDevice(
        [this] {
          ++opened;
          return std::make_unique<FakeEngine>(faults, submitted);
        },
        trust, [this](const std::string& says) { notices.push_back(says); }));
  }
};

TEST_F(CarefulDeviceTest, MatchesOnTheDevice) {
  const auto device = shared();
  for (const RandomPair* one : {&a, &b, &a}) expect_right(device, *one);
  const DeviceReport report = device->report();
  EXPECT_EQ(report.name, "fake");
  EXPECT_EQ(report.on_device, 3);
  EXPECT_EQ(report.on_processor, 0);
  EXPECT_EQ(report.kernels, (std::vector<DeviceKernel>{{"all", 6, 300, 3}}));
  EXPECT_EQ(report.memory_bytes, 9);
  EXPECT_EQ(submitted, 4) << "the self-test, and once each";
  EXPECT_TRUE(notices.empty());
}

TEST_F(CarefulDeviceTest, ADeviceThatComputesSomethingElseIsNotOpened) {
  faults = {Fault::wrong};
  try {
    shared();
    FAIL();
  } catch (const Unfit& refused) {
    EXPECT_NE(std::string(refused.what()).find("fake (driver 1)"), std::string::npos) << refused.what();
  }
}

TEST_F(CarefulDeviceTest, WhatWasBegunIsTakenAndTheNextOneSubmittedAtOnce) {
  const auto device = shared();
  device->begin(a.pair(), config, {});
  EXPECT_EQ(submitted, 2);
  device->begin(b.pair(), config, {});
  device->begin(c.pair(), config, {});  // a third has no place
  EXPECT_EQ(submitted, 2);
  expect_right(device, a);
  EXPECT_EQ(submitted, 3) << "b works while the caller goes on";
  expect_right(device, b);
  EXPECT_EQ(submitted, 3);
  expect_right(device, c);
  EXPECT_EQ(submitted, 4);
  EXPECT_EQ(device->report().on_device, 3);
}

TEST_F(CarefulDeviceTest, WhatWasBegunWithOtherImagesOrOptionsIsDropped) {
  const auto device = shared();
  device->begin(a.pair(), config, {});
  device->begin(b.pair(), config, {});
  expect_right(device, c);
  expect_right(device, b);
  MatchConfig other = config;
  other.num_disparities = 8;
  device->begin(a.pair(), other, {});
  expect_right(device, a);
  device->begin(a.pair(), config, {.penalty_small = 1});
  expect_right(device, a);
  device->begin(a.pair(), other, {});
  device->begin(b.pair(), config, {});
  expect_right(device, b);
  EXPECT_EQ(device->report().on_processor, 0);
}

TEST_F(CarefulDeviceTest, ALoopThatBeginsTheNextPairFirstComputesEachOnce) {
  const auto device = shared();
  device->begin(b.pair(), config, {});
  expect_right(device, a);
  EXPECT_EQ(submitted, 3);
  device->begin(c.pair(), config, {});
  EXPECT_EQ(submitted, 4);
  expect_right(device, b);
  device->begin(a.pair(), config, {});
  expect_right(device, c);
  EXPECT_EQ(submitted, 5) << "a works while the caller goes on with c";
  expect_right(device, a);
  EXPECT_EQ(submitted, 5);
}

TEST_F(CarefulDeviceTest, WhatDoesNotFitIsLeftToTheProcessorWithOneNotice) {
  faults = {Fault::none, Fault::unfit};
  const auto device = shared();
  for (int k = 0; k < 3; ++k) expect_right(device, a);
  EXPECT_EQ(submitted, 2) << "it is not asked again";
  EXPECT_EQ(device->report().on_processor, 3);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_EQ(notices[0], "too large for fake: the processor matches instead");
  expect_right(device, RandomPair({30, 20}, 4));
  EXPECT_EQ(device->report().on_device, 1);
  EXPECT_EQ(opened, 1);
}

/// Until it holds; a device is opened on a thread of its own.
void wait_for(const std::function<bool()>& holds) {
  for (int k = 0; k < 3000 && !holds(); ++k) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(holds());
}

TEST_F(CarefulDeviceTest, ALostDeviceIsOpenedAgainSomeTimes) {
  for (const Fault fault : {Fault::lost, Fault::lost_at_finish, Fault::hangs}) {
    faults = {Fault::none, fault, Fault::none, fault, Fault::none, fault};  // after each self-test
    opened = 0;
    notices.clear();
    const auto device = shared({.reopen_after = 0s, .most_reopenings = 2});
    wait_for([&] {
      expect_right(device, a);
      return notices.size() == 2;
    });
    for (int k = 0; k < 5; ++k) expect_right(device, a);
    EXPECT_EQ(opened, 3);
    EXPECT_EQ(device->report().on_device, 0);
    EXPECT_EQ(notices.size(), 2U) << "that it is opened again, twice the same line; that it is not";
  }
}

TEST_F(CarefulDeviceTest, ALossWhileItIsOpenedAgainIsOneMore) {
  faults = {Fault::none, Fault::lost, Fault::lost, Fault::none};
  const auto device = shared({.reopen_after = 0s});
  wait_for([&] {
    expect_right(device, a);
    return device->report().on_device > 0;
  });
  EXPECT_EQ(opened, 3);
}

TEST_F(CarefulDeviceTest, ALostDeviceIsNotOpenedAgainAtOnce) {
  faults = {Fault::none, Fault::lost};
  const auto device = shared();
  for (int k = 0; k < 3; ++k) expect_right(device, a);
  EXPECT_EQ(opened, 1);
  EXPECT_EQ(device->report().on_processor, 3);
}

TEST_F(CarefulDeviceTest, ADeviceThatHangsInItsTestIsNotOpened) {
  faults = {Fault::hangs};
  EXPECT_THROW(shared(), Lost);
}

TEST_F(CarefulDeviceTest, OtherKernelsAreComparedBeforeTheirFirstPair) {
  faults = {Fault::none, Fault::none, Fault::wrong};
  const auto device = shared();
  expect_right(device, a);
  Exec exec;
  exec.device = device;
  const MatchConfig narrow{.method = MatchMethod::semi_global, .num_disparities = 16};
  EXPECT_EQ(first_difference(match_semi_global(a.pair(), narrow, {}, {}), match(a.pair(), narrow, {}, exec)),
            "");
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("(narrow)"), std::string::npos) << notices[0];
  expect_right(device, a);
  EXPECT_EQ(device->report().on_device, 1) << "a device that is wrong once is not used any more";
}

TEST_F(CarefulDeviceTest, AFailedAllocationLeavesItUsable) {
  faults = {Fault::none, Fault::no_memory};
  const auto device = shared();
  Exec exec;
  exec.device = device;
  EXPECT_THROW(match(a.pair(), config, {}, exec), std::bad_alloc);
  for (const RandomPair* one : {&a, &b}) expect_right(device, *one);
  EXPECT_EQ(device->report().on_device, 2);
}

TEST_F(CarefulDeviceTest, ItMayBeDestroyedWhileItIsOpenedOrAtWork) {
  for (const bool must_be_faster : {true, false}) {
    const auto device = shared({.must_be_faster = must_be_faster});
    device->begin(a.pair(), config, {});
    device->begin(b.pair(), config, {});
  }
  EXPECT_EQ(opened, 2);
}

TEST_F(CarefulDeviceTest, FaultsOfWhatWasBegunAreThoseOfThePair) {
  for (const Fault fault : {Fault::unfit, Fault::lost, Fault::lost_at_finish, Fault::hangs}) {
    faults = {Fault::none, fault};
    const auto device = shared();
    device->begin(a.pair(), config, {});
    device->begin(b.pair(), config, {});
    for (const RandomPair* one : {&a, &b, &c}) expect_right(device, *one);
  }
}

TEST_F(CarefulDeviceTest, ByItselfASlowDeviceIsGivenUpAfterTenPairs) {
  faults = {Fault::none};
  faults.resize(40, Fault::slow);
  const auto device = shared({.must_be_faster = true});
  wait_for([&] {
    expect_right(device, a);
    return device->report().on_device > 0;
  });
  for (int k = 0; k < 20; ++k) expect_right(device, a);
  EXPECT_EQ(device->report().on_device, 5);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices[0].find("fake needs 2"), std::string::npos) << notices[0];
}

TEST_F(CarefulDeviceTest, ByItselfADeviceThatFailsIsGivenUp) {
  faults = {Fault::wrong};
  const auto device = shared({.must_be_faster = true});
  wait_for([&] {
    expect_right(device, a);
    return !notices.empty();
  });
  EXPECT_EQ(notices.size(), 1U);
  EXPECT_EQ(device->report().on_device, 0);
}

TEST_F(CarefulDeviceTest, SeveralThreadsMayUseIt) {
  const auto device = shared();
  std::vector<std::jthread> threads;
  for (const RandomPair* one : {&a, &b, &c}) {
    threads.emplace_back([&, one] {
      for (int k = 0; k < 10; ++k) {
        device->begin(one->pair(), config, {});
        expect_right(device, *one);
      }
    });
  }
  threads.clear();
  EXPECT_EQ(device->report().on_device, 30);
}

}  // namespace
}  // namespace cairn::device
