// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Ten thousand pairs on a device, of two sizes in turn: the memory of the process does not grow.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cairn/device/careful_device.hpp>
#include <cairn/device/vulkan/vulkan_engine.hpp>
#include <fstream>
#include <support/random_pair.hpp>

namespace cairn::device {
namespace {

std::int64_t resident_bytes() {
  std::ifstream file("/proc/self/statm");
  std::int64_t all = 0, resident = 0;
  file >> all >> resident;
  return resident * ::sysconf(_SC_PAGESIZE);
}

TEST(DeviceSoak, TenThousandPairsLeaveNoMemoryBehind) {
  std::shared_ptr<MatchDevice> device;
  try {
    device =
        std::make_shared<CarefulDevice>([] { return vulkan_engine(vulkan_library(), 0); }, Trust{}, nullptr);
  } catch (const Unfit& none) {
    GTEST_SKIP() << none.what();
  }
  const RandomPair large{{64, 48}, 1}, small{{40, 30}, 2};
  const MatchConfig config{.method = MatchMethod::semi_global, .num_disparities = 24};
  Exec exec;
  exec.pool = Pool::make();
  exec.device = device;
  const auto match_pairs = [&](int count) {
    for (int k = 0; k < count; ++k) {
      // Buffers are made anew with each change of the size, so that is rare here, as it is in use.
      const RandomPair& images = k / 50 % 2 == 0 ? large : small;
      device->begin(images.pair(), config, {});
      static_cast<void>(match(images.pair(), config, {}, exec));
    }
  };
  match_pairs(1000);
  const std::int64_t before = resident_bytes();
  match_pairs(10'000);
  constexpr std::int64_t kSlack = 4'000'000;
  EXPECT_LT(resident_bytes() - before, kSlack);
  EXPECT_EQ(device->report().on_device, 11'000);
}

}  // namespace
}  // namespace cairn::device
