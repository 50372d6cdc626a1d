// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/core/image.hpp>
#include <cairn/image/binning.hpp>
#include <cairn/input/sequence.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <cairn/sequence/stamp_pairing.hpp>
#include <cairn/sequence/stamps.hpp>
#include <cmath>
#include <filesystem>
#include <support/collection.hpp>
#include <support/grids.hpp>
#include <support/temporary_folder.hpp>

namespace cairn::input {
namespace {

namespace fs = std::filesystem;
using support::has;
using support::refusal;
using support::TemporaryFolder;

constexpr Size kSize{24, 16};
const std::string kCalib = "fx=20\nfy=20\ncx=12\ncy=8\nbaseline=0.1\nwidth=24\nheight=16\nndisp=16\n";

Image<Gray> picture(int seed, Size size = kSize) {
  Image<Gray> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image(x, y) = static_cast<Gray>(37 * seed + 11 * x + 5 * y);
  }
  return image;
}

fs::path save(const TemporaryFolder& folder, const std::string& name, int seed, Size size = kSize) {
  const fs::path path = folder.path() / name;
  fs::create_directories(path.parent_path());
  const Image<Gray> image = picture(seed, size);
  io::save_png(path, image.view());
  return path;
}

/// NNN/left.png, right.png and calib.txt.
void save_frame(const TemporaryFolder& folder, const std::string& name, int seed) {
  save(folder, name + "/left.png", seed);
  save(folder, name + "/right.png", seed + 100);
  (void)folder.with(name + "/calib.txt", kCalib);
}

void save_frames(const TemporaryFolder& folder, int count) {
  for (int i = 0; i < count; ++i) save_frame(folder, "00" + std::to_string(i), i);
}

std::unique_ptr<Sequence> open(const TemporaryFolder& folder, const SourceOptions& options = {}) {
  return open_sequence(folder.path().string(), options);
}

std::vector<SequenceFrame> all_of(Sequence& sequence) {
  std::vector<SequenceFrame> frames;
  while (std::optional<SequenceFrame> frame = sequence.next()) frames.push_back(std::move(*frame));
  return frames;
}

std::vector<std::int64_t> stamps_of(const std::vector<SequenceFrame>& frames) {
  std::vector<std::int64_t> stamps;
  for (const SequenceFrame& frame : frames) stamps.push_back(frame.stamp.ns);
  return stamps;
}

bool is_equal(const Image<Gray>& a, const Image<Gray>& b) {
  if (a.size() != b.size()) return false;
  for (int y = 0; y < a.height(); ++y) {
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) return false;
  }
  return true;
}

using Numbers = std::vector<std::int64_t>;

TEST(Stamps, WholeNumbersAreNsAndDecimalsSeconds) {
  EXPECT_EQ(parse_stamp("1403715274312143104")->ns, 1403715274312143104);
  EXPECT_EQ(parse_stamp("1403715274.312143104")->ns, 1403715274312143104);
  EXPECT_EQ(parse_stamp("1.036000e-01")->ns, 103600000);
  EXPECT_EQ(parse_stamp("-0.5")->ns, -500000000);
  EXPECT_EQ(parse_seconds("3")->ns, 3000000000);
  EXPECT_EQ(parse_stamp("1970-01-02 00:00:01.5")->ns, 86401500000000);
  EXPECT_EQ(parse_stamp("2011-09-26 13:02:25.964389445")->ns, 1317042145964389445);
  for (const char* text : {"", ".", "-", "1.2.3", "1,5", "nan", "inf", "1e300", "99999999999999999999",
                           "2011-13-26 13:02:25", "2011-02-30 13:02:25", "2011-09-26 13:02:25.", "12x"})
    EXPECT_FALSE(parse_stamp(text)) << text;
}

TEST(Stamps, AreReadUnderDamageOrRefused) {
  const TemporaryFolder folder;
  const std::string file = "# ns\n100\n\n2000 \r\n1.5\n2011-09-26 13:02:25.96\n";
  EXPECT_EQ(load_stamps(folder.with("a.txt", file)).size(), 4U);
  support::survives_damage(folder, "b.txt", file, [](const fs::path& path) { (void)load_stamps(path); });
  support::survives_damage(folder, "c.csv", "#timestamp [ns],filename\r\n100,100.png\r\n200,x.png\n300\n",
                           [](const fs::path& path) { (void)load_named_stamps(path); });
  support::survives_damage(folder, "d.csv", "frame,t_s,x\n0,0.5,1\n1,0.75,2\n",
                           [](const fs::path& path) { (void)load_frame_stamps(path); });
}

TEST(Stamps, PairMutualNearestNeighbours) {
  const auto stamps = [](std::initializer_list<std::int64_t> ms) {
    std::vector<Stamp> list;
    for (const std::int64_t one : ms) list.push_back(Stamp{one * 1'000'000});
    return list;
  };
  const StampPairs pairs = pair_by_stamps(stamps({0, 100, 200, 300, 400}), stamps({2, 96, 99, 206, 401}), 5);
  ASSERT_EQ(pairs.pairs.size(), 3U);
  EXPECT_EQ(pairs.pairs[1].left, 1U);
  EXPECT_EQ(pairs.pairs[1].right, 2U);
  EXPECT_EQ(pairs.pairs[2].left, 4U);
  EXPECT_EQ(pairs.left_alone, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(pairs.right_alone, (std::vector<std::size_t>{1, 3}));
}

/// Two endless streams of numbers, and the pairs made of them.
class LivePairs {
 public:
  explicit LivePairs(double max_skew_ms) : pairing_(max_skew_ms, [this](std::size_t, auto&&) { ++alone; }) {}
  std::optional<std::pair<int, int>> push(std::size_t side, int ms, int value) {
    pairing_.push_live(side, Stamp{std::int64_t{ms} * 1'000'000}, value, 4);
    const auto pair = pairing_.next();
    if (!pair) return std::nullopt;
    return std::pair(pair->left.value, pair->right.value);
  }
  int alone = 0;

 private:
  StampPairing<int> pairing_;
};

TEST(StampPairing, PairsSimultaneousFrames) {
  LivePairs pairs(5);
  EXPECT_FALSE(pairs.push(0, 0, 1));
  EXPECT_EQ(pairs.push(1, 0, 10), (std::pair{1, 10}));
  // The nearest one available.
  EXPECT_FALSE(pairs.push(1, 30, 20));
  EXPECT_FALSE(pairs.push(1, 34, 21));
  EXPECT_EQ(pairs.push(0, 33, 2), (std::pair{2, 21}));
  EXPECT_EQ(pairs.alone, 1);
  // Too far apart, then one that fits.
  EXPECT_FALSE(pairs.push(0, 60, 3));
  EXPECT_FALSE(pairs.push(1, 70, 30));
  EXPECT_EQ(pairs.push(0, 66, 4), (std::pair{4, 30}));
  EXPECT_EQ(pairs.alone, 2);
  // One side alone buffers only a few.
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(pairs.push(0, 100 + 33 * i, i));
  EXPECT_EQ(pairs.alone, 8);
}

TEST(StampPairing, RestartsIfTheClockWasSetBack) {
  LivePairs pairs(0);
  EXPECT_FALSE(pairs.push(0, 9000, 1));
  EXPECT_FALSE(pairs.push(0, 500, 2));
  EXPECT_EQ(pairs.push(1, 500, 3), (std::pair{2, 3}));
  EXPECT_EQ(pairs.alone, 1);
  // The other side first: its images from after that stay.
  EXPECT_FALSE(pairs.push(0, 9000, 4));
  EXPECT_EQ(pairs.push(1, 9000, 5), (std::pair{4, 5}));
  EXPECT_FALSE(pairs.push(1, 0, 6));
  EXPECT_FALSE(pairs.push(1, 33, 7));
  EXPECT_EQ(pairs.push(0, 33, 8), (std::pair{8, 7}));
  EXPECT_EQ(pairs.alone, 2);
}

TEST(Stamps, PairFilesBeforeAndAfterAClockThatWasSetBack) {
  const auto stamps = [](std::initializer_list<std::int64_t> ms) {
    std::vector<Stamp> list;
    for (const std::int64_t one : ms) list.push_back(Stamp{one * 1'000'000});
    return list;
  };
  // The left image at 9100 ms and the right one at 100 ms have no partner.
  const StampPairs pairs = pair_by_stamps(stamps({9000, 9100, 0, 200}), stamps({9000, 0, 100, 200}), 5);
  ASSERT_EQ(pairs.pairs.size(), 3U);
  EXPECT_EQ(pairs.pairs[1].left, 2U);
  EXPECT_EQ(pairs.pairs[1].right, 1U);
  EXPECT_EQ(pairs.pairs[2].left, 3U);
  EXPECT_EQ(pairs.pairs[2].right, 3U);
  EXPECT_EQ(pairs.left_alone, (std::vector<std::size_t>{1}));
  EXPECT_EQ(pairs.right_alone, (std::vector<std::size_t>{2}));
}

TEST(Stamps, ClockStepsAreForwardRepeatedOrSetBack) {
  const auto step = [](double s) { return clock_step(Stamp{5'000'000'000}, Stamp{std::llround(s * 1e9)}); };
  EXPECT_EQ(step(5.000000001), ClockStep::forward);
  EXPECT_EQ(step(5), ClockStep::repeated);
  EXPECT_EQ(step(4), ClockStep::repeated);
  EXPECT_EQ(step(3.999), ClockStep::set_back);
}

TEST(FrameRanges, AreParsedOrRefused) {
  const FrameRange range = parse_frame_range("10:60:2");
  EXPECT_EQ(range.first, 10U);
  EXPECT_EQ(range.last_excluded, 60U);
  EXPECT_EQ(range.step, 2U);
  EXPECT_EQ(parse_frame_range("5").last_excluded, 5U);
  EXPECT_EQ(parse_frame_range("::3").step, 3U);
  EXPECT_FALSE(parse_frame_range("7:").last_excluded);
  for (const char* text : {"", "0", "a:b", "5:5", "6:5", "1:2:0", "1:2:3:4", "-1:4", "1 :4"})
    EXPECT_TRUE(has(refusal([&] { (void)parse_frame_range(text); }), {"--frames", "FIRST:END"})) << text;
}

TEST(FrameRanges, KnowTheirMembersTheirEndAndTheirCount) {
  const FrameRange range = parse_frame_range("3:10:4");
  std::vector<std::size_t> members;
  for (std::size_t i = 0; i < 20; ++i) {
    if (range.contains(i)) members.push_back(i);
    EXPECT_EQ(range.is_past(i), i >= 10) << i;
    EXPECT_EQ(range.count_of(i + 1), members.size()) << i;
  }
  EXPECT_EQ(members, (std::vector<std::size_t>{3, 7}));
  EXPECT_FALSE(parse_frame_range("5:").is_past(1'000'000));
}

TEST(SequenceOfFolders, DeliversItsFramesInOrderWithTheirCalibration) {
  const TemporaryFolder folder;
  // 9 comes before 10, unlike in byte order.
  for (const int i : {9, 10, 8}) save_frame(folder, std::to_string(i), i);
  const auto sequence = open(folder);
  EXPECT_EQ(sequence->size(), 3U);
  ASSERT_TRUE(sequence->rig());
  EXPECT_EQ(sequence->rig()->focal_px, 20.0F);
  EXPECT_EQ(sequence->disparities(), 16);
  EXPECT_EQ(sequence->image_size(), kSize);
  EXPECT_EQ(sequence->stamps_from(), "a rate of 10 Hz");
  const auto frames = all_of(*sequence);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].name, "8");
  EXPECT_EQ(frames[2].name, "10");
  EXPECT_TRUE(is_equal(frames[1].left.gray, picture(9)));
  EXPECT_TRUE(is_equal(frames[1].right, picture(109)));
  EXPECT_TRUE(frames[1].left.rgb.empty());
  EXPECT_EQ(stamps_of(frames), (Numbers{0, 100000000, 200000000}));
  EXPECT_TRUE(sequence->remarks().empty());
  EXPECT_EQ(sequence->ended_early(), "");
  EXPECT_FALSE(sequence->next());
}

TEST(SequenceOfFolders, ReadsStampsFromAFileATableOrTheRate) {
  const TemporaryFolder folder;
  save_frames(folder, 3);
  SourceOptions options;
  options.rate_hz = 20;
  EXPECT_EQ(stamps_of(all_of(*open(folder, options))), (Numbers{0, 50000000, 100000000}));
  (void)folder.with("odometry.csv",
                    "frame,t_s,v_m_per_s,omega_rad_per_s\n0,0.000,0,0\n1,0.200,1,0\n2,0.400,1,0\n");
  EXPECT_EQ(stamps_of(all_of(*open(folder, options))), (Numbers{0, 200000000, 400000000}));
  (void)folder.with("stamps.txt", "# s\n1.5\n1.6\n3.75\n");
  const auto frames = all_of(*open(folder, options));
  EXPECT_EQ(stamps_of(frames), (Numbers{1500000000, 1600000000, 3750000000}));
  EXPECT_FALSE(frames[1].after_gap);
  EXPECT_TRUE(frames[2].after_gap);
}

TEST(SequenceOfFolders, ReadsStampsFromFolderNames) {
  const TemporaryFolder folder;
  save_frame(folder, "1403636579763555584", 0);
  save_frame(folder, "1403636579813555456", 1);
  const auto sequence = open(folder);
  EXPECT_EQ(sequence->stamps_from(), "the frames' names");
  EXPECT_EQ(stamps_of(all_of(*sequence)), (Numbers{1403636579763555584, 1403636579813555456}));
}

TEST(SequenceOfFolders, DeliversTheFramesOfARangeOnly) {
  const TemporaryFolder folder;
  save_frames(folder, 6);
  SourceOptions options;
  options.frames = parse_frame_range("1:6:2");
  const auto frames = all_of(*open(folder, options));
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].name, "001");
  EXPECT_EQ(frames[2].index, 5U);
  EXPECT_EQ(frames[2].stamp.ns, 500000000);
  options.frames = parse_frame_range("6:");
  EXPECT_TRUE(has(refusal([&] { (void)open(folder, options); }), {"has 6 frames", "--frames"}));
}

TEST(SequenceOfFolders, LeavesOutRepeatedStampsAndBeginsARunWhereTheClockWasSetBack) {
  const TemporaryFolder folder;
  save_frames(folder, 6);
  (void)folder.with("stamps.txt", "# s\n8.5\n9.0\n9.0\n8.25\n1.5\n1.75\n");
  const auto sequence = open(folder);
  const auto frames = all_of(*sequence);
  EXPECT_EQ(stamps_of(frames), (Numbers{8500000000, 9000000000, 1500000000, 1750000000}));
  ASSERT_EQ(sequence->remarks().size(), 2U);
  const SourceRemark& repeated = sequence->remarks()[0];
  EXPECT_EQ(repeated.what, "frame with a stamp that is not later than the one before");
  EXPECT_EQ(repeated.count, 2U);
  EXPECT_EQ(repeated.first, "002 (9 s after 9 s)");
  EXPECT_TRUE(repeated.is_left_out);
  const SourceRemark& set_back = sequence->remarks()[1];
  EXPECT_EQ(set_back.what, "clock set back, a new run begins");
  EXPECT_EQ(set_back.count, 1U);
  EXPECT_EQ(set_back.first, "004 (1.5 s after 9 s)");
  EXPECT_FALSE(set_back.is_left_out);
}

TEST(SequenceOfFolders, RefusesStampsInAnotherUnit) {
  const TemporaryFolder folder;
  save_frames(folder, 3);
  (void)folder.with("stamps.txt", "1403715274\n1403715275\n1403715276\n");  // s
  EXPECT_TRUE(has(refusal([&] { (void)open(folder); }), {"stamps.txt", "less than 1 us", "expected ns"}));
  (void)folder.with("stamps.txt", "0\n33\n66\n");  // ms
  EXPECT_TRUE(has(refusal([&] { (void)open(folder); }), {"less than 1 us"}));
}

TEST(SequenceOfFolders, RefusesMissingAndInvalidStamps) {
  const TemporaryFolder folder;
  save_frames(folder, 3);
  (void)folder.with("stamps.txt", "0\n100000000\n");
  EXPECT_TRUE(has(refusal([&] { (void)open(folder); }), {"stamps.txt", "has 2 stamps", "3 frames"}));
  (void)folder.with("stamps.txt", "0\nsoon\n200000000\n");
  EXPECT_TRUE(has(refusal([&] { (void)open(folder); }), {"stamps.txt:2", "'soon'"}));
}

TEST(SequenceOfFolders, BinsItsFramesAndTheirCalibration) {
  const TemporaryFolder folder;
  save_frames(folder, 2);
  SourceOptions options;
  const std::vector<SequenceFrame> whole = all_of(*open(folder, options));
  options.binning = 3;
  const std::unique_ptr<Sequence> sequence = open(folder, options);
  EXPECT_EQ(sequence->image_size(), (Size{8, 5}));
  EXPECT_FLOAT_EQ(sequence->rig()->focal_px, 20.0F / 3);
  EXPECT_FLOAT_EQ(sequence->rig()->cx_px, 12.5F / 3 - 0.5F);
  EXPECT_FLOAT_EQ(sequence->rig()->cy_px, 8.5F / 3 - 0.5F);
  EXPECT_FLOAT_EQ(sequence->rig()->baseline_m, 0.1F);
  EXPECT_EQ(sequence->disparities(), 6);
  const std::vector<SequenceFrame> frames = all_of(*sequence);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(stamps_of(frames), stamps_of(whole));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].name, whole[i].name);
    EXPECT_TRUE(frames[i].left.rgb.empty());
    const Image<Gray> left = cairn::binned(whole[i].left.gray, 3);
    const Image<Gray> right = cairn::binned(whole[i].right, 3);
    EXPECT_EQ(grids::numbers(frames[i].left.gray), grids::numbers(left));
    EXPECT_EQ(grids::numbers(frames[i].right), grids::numbers(right));
  }
  for (const int factor : {0, -1, 9}) {
    options.binning = factor;
    EXPECT_NE(
        refusal([&] { (void)open(folder, options); }).find("--binning: found " + std::to_string(factor)),
        std::string::npos);
  }
}

TEST(SequenceOfFolders, RefusesAChangeOfSize) {
  const TemporaryFolder folder;
  save_frames(folder, 3);
  save(folder, "001/left.png", 1, {20, 16});
  save(folder, "001/right.png", 1, {20, 16});
  const auto sequence = open(folder);
  EXPECT_TRUE(sequence->next());
  EXPECT_TRUE(has(refusal([&] { (void)sequence->next(); }), {"001/left.png", "20x16", "24x16"}));
}

TEST(SequenceOfFolders, RefusesAPairOfTwoSizes) {
  const TemporaryFolder folder;
  save_frames(folder, 2);
  save(folder, "001/right.png", 1, {20, 16});
  const auto sequence = open(folder);
  EXPECT_TRUE(sequence->next());
  EXPECT_TRUE(has(refusal([&] { (void)sequence->next(); }), {"001/right.png", "20x16", "24x16"}));
}

TEST(SequenceOfFolders, RefusesAChangeOfCalibration) {
  const TemporaryFolder folder;
  save_frames(folder, 3);
  (void)folder.with("001/calib.txt", "# the same\n" + kCalib);
  (void)folder.with("002/calib.txt", "fx=21\nfy=21\ncx=12\ncy=8\nbaseline=0.1\n");
  const auto sequence = open(folder);
  EXPECT_TRUE(sequence->next());
  EXPECT_TRUE(sequence->next());
  EXPECT_TRUE(has(refusal([&] { (void)sequence->next(); }), {"002/calib.txt", "000/calib.txt", "one rig"}));
  // A calibration given explicitly applies to all frames.
  SourceOptions options;
  options.calib = (folder.path() / "002/calib.txt").string();
  EXPECT_EQ(all_of(*open(folder, options)).size(), 3U);
}

TEST(SequenceOfFolders, UsesTheFoldersCalibrationIfFramesHaveNone) {
  const TemporaryFolder folder;
  save_frames(folder, 2);
  for (const char* name : {"000/calib.txt", "001/calib.txt"}) fs::remove(folder.path() / name);
  EXPECT_FALSE(open(folder)->rig());
  (void)folder.with("calib.txt", kCalib);
  EXPECT_TRUE(open(folder)->rig());
  (void)folder.with("calib.txt", "fx=20\nfy=20\ncx=12\ncy=8\nbaseline=0.1\nwidth=640\nheight=480\n");
  EXPECT_TRUE(has(refusal([&] { (void)open(folder); }), {"calib.txt", "640x480", "24x16"}));
}

TEST(SequenceOfFolders, SkipsAndCountsIncompleteAndDamagedFrames) {
  const TemporaryFolder folder;
  save_frames(folder, 6);
  fs::remove(folder.path() / "001/right.png");
  fs::remove(folder.path() / "002/right.png");
  (void)folder.with("004/left.png", support::bytes_of(folder.path() / "004/left.png").substr(0, 60));
  const auto sequence = open(folder);
  const auto frames = all_of(*sequence);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(stamps_of(frames), (Numbers{0, 300000000, 500000000}));
  ASSERT_EQ(sequence->remarks().size(), 2U);
  EXPECT_EQ(sequence->remarks()[0].count, 2U);
  EXPECT_EQ(sequence->remarks()[0].first, "001");
  EXPECT_FALSE(sequence->remarks()[0].is_unusable);
  EXPECT_TRUE(sequence->remarks()[1].is_unusable);
  EXPECT_TRUE(has(sequence->remarks()[1].first, {"004", "left.png"}));
}

TEST(SequenceOfFolders, ReportsAFrozenCamera) {
  const TemporaryFolder folder;
  save_frames(folder, 4);
  for (const char* name : {"002", "003"}) {
    fs::copy_file(folder.path() / "001/right.png", folder.path() / name / "right.png",
                  fs::copy_options::overwrite_existing);
  }
  const auto sequence = open(folder);
  EXPECT_EQ(all_of(*sequence).size(), 4U);
  ASSERT_EQ(sequence->remarks().size(), 1U);
  EXPECT_EQ(sequence->remarks()[0].count, 2U);
  EXPECT_EQ(sequence->remarks()[0].first, "002");
  EXPECT_FALSE(sequence->remarks()[0].is_left_out);
  EXPECT_TRUE(has(sequence->remarks()[0].what, {"right image repeated from the frame before"}));
}

TEST(SequenceOfFolders, ReadsImagesThatHoldBoth) {
  const TemporaryFolder folder;
  (void)folder.with("calib.txt", "fx=20\nfy=20\ncx=3\ncy=3\nbaseline=0.1\n");
  for (const int i : {9, 10}) {
    const Image<Gray> left = picture(i);
    const Image<Gray> right = picture(100 + i);
    Image<Gray> both({2 * kSize.width, kSize.height});
    for (int y = 0; y < kSize.height; ++y) {
      std::copy_n(left.row(y), kSize.width, both.row(y));
      std::copy_n(right.row(y), kSize.width, both.row(y) + kSize.width);
    }
    io::save_png(folder.path() / (std::to_string(i) + ".png"), both.view());
  }
  SourceOptions options;
  options.layout = "side_by_side";
  const auto sequence = open(folder, options);
  EXPECT_EQ(sequence->image_size(), kSize);
  EXPECT_TRUE(sequence->rig());
  const auto frames = all_of(*sequence);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].name, "9");
  EXPECT_TRUE(is_equal(frames[1].left.gray, picture(10)));
  EXPECT_TRUE(is_equal(frames[1].right, picture(110)));
}

TEST(SequenceOfFolders, KeepsOneScaleForDeepImages) {
  const TemporaryFolder folder;
  for (const auto& [name, value] : {std::pair{"0", 4000}, std::pair{"1", 1000}}) {
    Image<std::uint16_t> deep(kSize);
    for (int y = 0; y < kSize.height; ++y)
      std::fill_n(deep.row(y), kSize.width, static_cast<std::uint16_t>(value));
    fs::create_directories(folder.path() / name);
    io::save_png(folder.path() / name / "left.png", deep.view());
    io::save_png(folder.path() / name / "right.png", deep.view());
  }
  const auto frames = all_of(*open(folder));
  EXPECT_EQ(int{frames[0].left.gray(0, 0)}, 4000 >> 4);
  EXPECT_EQ(int{frames[1].left.gray(0, 0)}, 1000 >> 4);
}

TEST(SequenceOfFolders, ADeepImageAmongThoseOfEightBitsHasItsOwnScale) {
  const TemporaryFolder folder;
  save_frames(folder, 3);
  const Gray before = all_of(*open(folder))[2].left.gray(0, 0);
  Image<std::uint16_t> deep(kSize);
  for (int y = 0; y < kSize.height; ++y) std::fill_n(deep.row(y), kSize.width, std::uint16_t{4000});
  io::save_png(folder.path() / "001/left.png", deep.view());
  io::save_png(folder.path() / "001/right.png", deep.view());
  const auto frames = all_of(*open(folder));
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(int{frames[1].left.gray(0, 0)}, 4000 >> 4);
  EXPECT_EQ(frames[2].left.gray(0, 0), before);
}

TEST(SequenceOfFolders, OfOneFrameIsASequence) {
  const TemporaryFolder folder;
  save_frames(folder, 1);
  EXPECT_EQ(all_of(*open(folder)).size(), 1U);
}

TEST(Sources, RefuseInvalidOnes) {
  const TemporaryFolder folder;
  const std::string at = folder.path().string();
  const auto refused = [](const std::string& source, const SourceOptions& options = {}) {
    return refusal([&] { (void)open_sequence(source, options); });
  };
  EXPECT_TRUE(has(refused(""), {"SOURCE", "empty"}));
  EXPECT_TRUE(has(refused(at), {at, "contains no left.png"}));
  EXPECT_TRUE(has(refused(at + "/nowhere"), {"nowhere: not found"}));
  EXPECT_TRUE(has(refused(at + "/l_%d.png"), {"one pattern", "expected two"}));
  EXPECT_TRUE(has(refused(at + "/l_%d.png," + at + "/r_%d.png"), {"l_%d.png: no file"}));
  EXPECT_TRUE(has(refused(at + "/l_%d.png," + at), {"one pattern, expected two"}));
  EXPECT_TRUE(has(refused(at + "/a," + at + "/b"), {"/a: not found"}));
  EXPECT_TRUE(has(refused(at + ","), {"expected a left part"}));
  EXPECT_TRUE(has(refused("v4l2:/dev/video99"), {"v4l2:/dev/video99", "no such device"}));
  save(folder, "000/left.png", 1);
  EXPECT_TRUE(has(refused(at), {"000/left.png", "no right image", "right.png"}));
  SourceOptions options;
  options.layout = "diagonal";
  EXPECT_TRUE(has(refused(at, options), {"--layout", "diagonal", "side_by_side"}));
  options.layout = "top_bottom";
  EXPECT_TRUE(has(refused(at, options), {"contains no images", "--layout"}));
  options = {};
  options.topics = "/a,/b";
  EXPECT_TRUE(has(refused(at, options), {"--topics /a,/b", "is none"}));
  options = {};
  options.rate_hz = -3;
  EXPECT_TRUE(has(refused(at, options), {"--rate", "-3"}));
  save(folder, "000/right.png", 2);
  options = {};
  options.rectify = true;
  EXPECT_TRUE(has(refused(at, options), {"--rectify", "--calib"}));
}

TEST(SequenceOfKitti, IsReadWithItsTimesAndItsGreyCameras) {
  const TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) {
    save(folder, "image_0/00000" + std::to_string(i) + ".png", i);
    save(folder, "image_1/00000" + std::to_string(i) + ".png", i + 50);
  }
  (void)folder.with("times.txt", "0.000000e+00\n1.036000e-01\n2.072000e-01\n");
  (void)folder.with("calib.txt", "P0: 20 0 12 0 0 20 8 0 0 0 1 0\nP1: 20 0 12 -2 0 20 8 0 0 0 1 0\n");
  const auto sequence = open(folder);
  ASSERT_TRUE(sequence->rig());
  EXPECT_FLOAT_EQ(sequence->rig()->baseline_m, 0.1F);
  EXPECT_EQ(stamps_of(all_of(*sequence)), (Numbers{0, 103600000, 207200000}));
  // An excerpt: the number in the name is the line.
  fs::remove(folder.path() / "image_0/000000.png");
  const auto excerpt = open(folder);
  EXPECT_EQ(stamps_of(all_of(*excerpt)), (Numbers{103600000, 207200000}));
  ASSERT_EQ(excerpt->remarks().size(), 1U);
  EXPECT_EQ(excerpt->remarks()[0].what, "right image without a left one");
}

TEST(SequenceOfKitti, RawRecordingsArePairedByTheirStamps) {
  const TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) {
    save(folder, "image_00/data/000000000" + std::to_string(i) + ".png", i);
    save(folder, "image_01/data/000000000" + std::to_string(i) + ".png", i + 50);
  }
  (void)folder.with(
      "image_00/timestamps.txt",
      "2011-09-26 13:02:25.000000000\n2011-09-26 13:02:25.100000000\n2011-09-26 13:02:25.200000000\n");
  (void)folder.with(
      "image_01/timestamps.txt",
      "2011-09-26 13:02:25.000100000\n2011-09-26 13:02:25.150000000\n2011-09-26 13:02:25.200100000\n");
  const auto sequence = open(folder);
  const auto frames = all_of(*sequence);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[1].stamp.ns, 1317042145200000000);
  EXPECT_EQ(sequence->remarks().size(), 2U);
}

/// An EuRoC camera without distortion.
std::string sensor(double x_m) {
  return "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, " +
         std::to_string(x_m) +
         ", 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nresolution: [24, 16]\ncamera_model: pinhole\n"
         "intrinsics: [20, 20, 12, 8]\ndistortion_model: radial-tangential\ndistortion_coefficients: [0, 0, "
         "0, 0]\n";
}

bool has_rectifier() {
  try {
    (void)io::Rectifier(io::RawCalibration{});
  } catch (const Error& error) {
    return std::string(error.what()).find("not built in") == std::string::npos;
  }
  return true;
}

TEST(SequenceOfEuroc, IsPairedByStampsAndRectified) {
  if (!has_rectifier()) GTEST_SKIP() << "built without OpenCV's calib3d";
  const TemporaryFolder folder;
  std::string left = "#timestamp [ns],filename\n";
  std::string right = left;
  for (int i = 0; i < 3; ++i) {
    const std::string name = std::to_string(1403715274000000000 + 50000000 * i);
    save(folder, "mav0/cam0/data/" + name + ".png", i);
    left += name + "," + name + ".png\n";
    const std::string other = std::to_string(1403715274000000000 + 50000000 * i + (i == 1 ? 20000000 : 1000));
    save(folder, "mav0/cam1/data/" + other + ".png", i + 50);
    right += other + "," + other + ".png\r\n";
  }
  (void)folder.with("mav0/cam0/data.csv", left);
  (void)folder.with("mav0/cam1/data.csv", right);
  (void)folder.with("mav0/cam0/sensor.yaml", sensor(0));
  (void)folder.with("mav0/cam1/sensor.yaml", sensor(0.1));
  const auto sequence = open(folder);
  ASSERT_TRUE(sequence->rig());
  EXPECT_NEAR(double{sequence->rig()->baseline_m}, 0.1, 1e-6);
  ASSERT_NE(sequence->rectifier(), nullptr);
  EXPECT_TRUE(sequence->disparities());
  const auto frames = all_of(*sequence);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[1].stamp.ns, 1403715274100000000);
  EXPECT_EQ(sequence->remarks().size(), 2U);
  // The folder mav0 itself, and a wider skew.
  SourceOptions options;
  options.max_skew_ms = 25;
  EXPECT_EQ(all_of(*open_sequence((folder.path() / "mav0").string(), options)).size(), 3U);

  (void)folder.with("mav0/cam0/data.csv", "1403715274.00,a.png\n");
  EXPECT_TRUE(has(refusal([&] { (void)open(folder); }), {"data.csv:1", "ns", "these are s"}));
  fs::remove(folder.path() / "mav0/cam0/sensor.yaml");
  (void)folder.with("mav0/cam0/data.csv", left);
  EXPECT_TRUE(has(refusal([&] { (void)open(folder); }), {"sensor.yaml"}));
}

TEST(SequenceOfTwo, PatternsArePairedByTheirNumbers) {
  const TemporaryFolder folder;
  for (const int i : {7, 8, 9, 10}) save(folder, "l_" + std::to_string(i) + ".png", i);
  for (const int i : {8, 10, 11}) save(folder, "r_" + std::to_string(i) + ".png", i + 50);
  save(folder, "l_08.png", 99);  // %d has no zeros before it
  const std::string at = folder.path().string();
  const auto sequence = open_sequence(at + "/l_%d.png," + at + "/r_%d.png", {});
  const auto frames = all_of(*sequence);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].name, "l_8");
  EXPECT_TRUE(is_equal(frames[1].left.gray, picture(10)));
  EXPECT_TRUE(is_equal(frames[1].right, picture(60)));
  ASSERT_EQ(sequence->remarks().size(), 2U);
  EXPECT_EQ(sequence->remarks()[0].count, 2U);
}

TEST(SequenceOfTwo, FoldersArePairedByStampsNamesOrOrder) {
  const TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) {
    save(folder, "l/a" + std::to_string(i) + ".png", i);
    save(folder, "r/b" + std::to_string(i) + ".png", i + 50);
  }
  const std::string source = (folder.path() / "l").string() + "," + (folder.path() / "r").string();
  EXPECT_EQ(all_of(*open_sequence(source, {})).size(), 3U);
  (void)folder.with("l/stamps.txt", "0.0\n0.1\n0.2\n");
  (void)folder.with("r/stamps.txt", "0.101\n0.202\n0.3\n");
  const auto frames = all_of(*open_sequence(source, {}));
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_TRUE(is_equal(frames[0].right, picture(50)));
  EXPECT_EQ(frames[0].stamp.ns, 100000000);
  (void)folder.with("r/stamps.txt", "10.1\n10.2\n10.3\n");
  EXPECT_TRUE(has(refusal([&] { (void)open_sequence(source, {}); }), {"within 5 ms", "0 s", "10.1 s"}));
  fs::remove(folder.path() / "r/stamps.txt");
  fs::remove(folder.path() / "r/b2.png");
  EXPECT_TRUE(has(refusal([&] { (void)open_sequence(source, {}); }), {"2 images", "3", "cannot be paired"}));
}

TEST(SequencesOfTheCollection, AreOpened) {
  const fs::path data = collection();
  if (!fs::exists(data / "real/sequences")) GTEST_SKIP() << "no data collection in " << data;
  const auto check = [&](const char* source, std::size_t frames, double length_s, double baseline_m) {
    const auto sequence = open_sequence((data / source).string(), {});
    ASSERT_TRUE(sequence->rig()) << source;
    EXPECT_NEAR(double{sequence->rig()->baseline_m}, baseline_m, 1e-3) << source;
    std::optional<Stamp> first;
    Stamp last;
    std::size_t count = 0;
    while (const std::optional<SequenceFrame> frame = sequence->next()) {
      if (!first) first = frame->stamp;
      last = frame->stamp;
      ++count;
    }
    EXPECT_EQ(count, frames) << source;
    EXPECT_NEAR(seconds_between(*first, last), length_s, 1e-3) << source;
    EXPECT_TRUE(sequence->remarks().empty()) << source << ": " << sequence->remarks().front().what;
  };
  check("rendered/tour_train", 100, 19.8, 0.12);
  check("rendered/dev/sequences/dev_seqA", 40, 3.9, 0.118);
  check("real/sequences/kitti_odometry_04", 30, 3.0044, 0.537);
  check("real/sequences/euroc_V1_01_standstill", 20, 1.9, 0.110);
  check("real/sequences/conveyor_box", 24, 2.3, 0.12);
}

}  // namespace
}  // namespace cairn::input
