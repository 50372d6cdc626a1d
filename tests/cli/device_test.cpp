// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// --device, on Mesa's device in software where it is installed.
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "command.hpp"

namespace cairn::command {
namespace {

using Json = nlohmann::json;

class Device : public CommandTest {
 protected:
  const std::string sample = std::string(CAIRN_SOURCE_DIR) + "/data/samples/overlap";

  void SetUp() override {
    const std::string info = run({"info"}).out;
    ASSERT_NE(info.find("devices\n"), std::string::npos) << info;
    if (info.find("  0  ") == std::string::npos) GTEST_SKIP() << info.substr(info.find("devices\n"));
  }
  /// The files of a folder.
  [[nodiscard]] std::map<std::string, std::string> files_of(const std::string& folder) const {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(at(folder))) {
      if (entry.is_regular_file())
        all[fs::relative(entry.path(), at(folder)).string()] = content(entry.path());
    }
    return all;
  }
  /// But for the times.
  void expect_equal_files(const std::string& folder, const std::string& other) const {
    const auto expected = files_of(folder), found = files_of(other);
    EXPECT_EQ(expected.size(), found.size());
    for (const auto& [name, bytes] : expected) {
      ASSERT_TRUE(found.contains(name)) << name;
      if (name.ends_with("objects.json")) {
        EXPECT_EQ(without_times(bytes), without_times(found.at(name)));
      } else {
        EXPECT_TRUE(bytes == found.at(name)) << name;
      }
    }
  }
  static Json without_times(const std::string& text) {
    Json all = Json::parse(text);
    EXPECT_EQ(all.erase("timings_ms"), 1U);
    return all;
  }
  /// With an environment variable.
  [[nodiscard]] Outcome run_with(const char* name, const char* value,
                                 const std::vector<std::string>& arguments) const {
    setenv(name, value, 1);
    Outcome outcome = run(arguments);
    unsetenv(name);
    return outcome;
  }
};

TEST_F(Device, ChangesNoByteOfAFrame) {
  for (const std::string device : {"off", "0"}) {
    const Outcome outcome = run({"segment", sample, "-o", path("segment_" + device), "--ply", "--depth",
                                 "--grid", "--device", device});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    ASSERT_EQ(run({"disparity", sample, "-o", path("disparity_" + device + ".pfm"), "--device", device}).code,
              0);
  }
  expect_equal_files("segment_off", "segment_0");
  EXPECT_TRUE(content(at("disparity_off.pfm")) == content(at("disparity_0.pfm")));
}

TEST_F(Device, ChangesNoByteOfASequenceAndIsInItsSummary) {
  if (run({"info"}).out.find("sequences: follow, odometry, map, record  yes") == std::string::npos)
    GTEST_SKIP() << "sequences are not built in";
  const std::string sequence = std::string(CAIRN_SOURCE_DIR) + "/data/sequences/rolling_ball";
  for (const std::string device : {"off", "0"}) {
    for (const std::string threads : {"1", "2"}) {
      const std::string out = device + threads;
      const Outcome outcome =
          run({"follow", sequence, "-o", path(out), "--device", device, "--threads", threads});
      ASSERT_EQ(outcome.code, 0) << outcome.err;
    }
  }
  for (const std::string out : {"off2", "01", "02"}) {
    EXPECT_EQ(content(at("off1") / "poses.tum"), content(at(out) / "poses.tum"));
    EXPECT_EQ(content(at("off1") / "tracks.mots.txt"), content(at(out) / "tracks.mots.txt"));
  }
  const Json summary = Json::parse(content(at("01") / "summary.json"));
  EXPECT_EQ(summary["device"]["on_device"], summary["frames"]) << summary["device"];
  EXPECT_EQ(summary["device"]["on_processor"], 0);
  EXPECT_FALSE(Json::parse(content(at("off1") / "summary.json")).contains("device"));
}

TEST_F(Device, ByItselfNoneInSoftwareIsTakenAndNothingSaid) {
  const Outcome outcome = run({"segment", sample, "--device", "auto"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err, "");
}

TEST_F(Device, WithoutADriverIsRefusedByNameOnly) {
  const Outcome named = run_with("VK_DRIVER_FILES", "/nonexistent", {"segment", sample, "--device", "0"});
  EXPECT_EQ(named.code, 2);
  EXPECT_NE(named.err.find("--device 0"), std::string::npos) << named.err;
  EXPECT_EQ(std::ranges::count(named.err, '\n'), 1) << named.err;
  const Outcome by_itself =
      run_with("VK_DRIVER_FILES", "/nonexistent", {"segment", sample, "--device", "auto"});
  EXPECT_EQ(by_itself.code, 0);
  EXPECT_EQ(by_itself.err, "");
}

TEST_F(Device, IsTakenFromTheEnvironmentToo) {
  const Outcome outcome = run_with("CAIRN_DEVICE", "nonsense", {"segment", sample});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_NE(outcome.err.find("CAIRN_DEVICE nonsense"), std::string::npos) << outcome.err;
  EXPECT_EQ(run_with("CAIRN_DEVICE", "nonsense", {"segment", sample, "--device", "off"}).code, 0);
}

TEST_F(Device, WindowsAreMatchedByTheProcessorWhichSaysSo) {
  const Outcome outcome = run({"segment", sample, "--preset", "paper", "--device", "0"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.err.find("match.method=window"), std::string::npos) << outcome.err;
  EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
}

TEST_F(Device, IsMeasuredKernelByKernel) {
  const Outcome outcome = run({"bench", "--size", "64x48", "--frames", "3", "--no-opencv", "--device", "0",
                               "--json", path("bench.json"), "--set", "match.num_disparities=24"});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* const kernel : {"describe", "down", "up", "left", "right"})
    EXPECT_NE(outcome.out.find(kernel), std::string::npos) << outcome.out;
  EXPECT_GT(Json::parse(content(at("bench.json")))["device"]["memory_bytes"], 0);
}

TEST_F(Device, ThatIsNotThereIsRefused) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"segment", sample}, {"disparity", sample}, {"bench", "--frames", "3"}}) {
    for (const std::string name : {"nonsense", "99"}) {
      std::vector<std::string> all = arguments;
      all.insert(all.end(), {"--device", name});
      const Outcome outcome = run(all);
      EXPECT_EQ(outcome.code, 2) << outcome.err;
      EXPECT_NE(outcome.err.find("--device " + name), std::string::npos) << outcome.err;
      EXPECT_NE(outcome.err.find("0 "), std::string::npos) << "names those that are there: " << outcome.err;
      EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
    }
  }
}

}  // namespace
}  // namespace cairn::command
