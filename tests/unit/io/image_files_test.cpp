// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/io/image_files.hpp>
#include <cairn/io/raster.hpp>

#include "support/small_pictures.hpp"
#include "support/temporary_folder.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;
using support::decoded;
using support::has;
using support::refusal;
using support::survives_damage;
using support::TemporaryFolder;

/// Pixels in raster order, as numbers that gtest prints.
template <class T>
std::vector<int> pixels(const Image<T>& image) {
  std::vector<int> all;
  for (int y = 0; y < image.height(); ++y) all.insert(all.end(), image.row(y), image.row(y) + image.width());
  return all;
}

/// For pixel i of 15 of a small image.
std::vector<int> fifteen(const std::function<int(int)>& value) {
  std::vector<int> all;
  all.reserve(15);
  for (int i = 0; i < 15; ++i) all.push_back(value(i));
  return all;
}

int grey(int r, int g, int b) {
  return (77 * r + 150 * g + 29 * b + 128) >> 8;
}

class ImageFiles : public testing::Test {
 protected:
  [[nodiscard]] fs::path file(std::string_view base64) const {
    return folder_.with("picture", decoded(base64));
  }
  [[nodiscard]] io::LoadedImage picture(std::string_view base64) const {
    return io::load_picture(file(base64));
  }
  [[nodiscard]] std::string refused(std::string_view bytes) const {
    const fs::path path = folder_.with("picture", bytes);
    std::string message = refusal([&] { io::load_picture(path); });
    EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
    return message;
  }
  [[nodiscard]] io::LoadedImage pnm(std::string_view bytes) const {
    return io::load_picture(folder_.with("picture", bytes));
  }
  TemporaryFolder folder_;
};

// ---- reading ----

TEST_F(ImageFiles, GreyIsTheLibrarysWeightedSum) {
  const io::LoadedImage read = pnm(std::string("P6 2 1 255\n") + "\x0a\x14\x1e\xff\xff\xff");
  EXPECT_EQ(read.gray(0, 0), grey(10, 20, 30));
  EXPECT_EQ(read.gray(1, 0), 255);
  EXPECT_EQ(read.rgb(0, 0), (Rgb{10, 20, 30}));
}

TEST_F(ImageFiles, AGreyFileHasNoColour) {
  const io::LoadedImage read = picture(support::kInterlacedPng);
  EXPECT_TRUE(read.rgb.empty());
  EXPECT_EQ(pixels(read.gray), fifteen([](int i) { return 17 * i; }));
}

TEST_F(ImageFiles, AlphaIsIgnored) {
  EXPECT_EQ(pixels(picture(support::kGreyAlphaPng).gray), fifteen([](int i) { return 17 * i; }));
  const io::LoadedImage deep = picture(support::kColourAlpha16Png);
  EXPECT_EQ(deep.rgb(3, 1), (Rgb{17 * 8, 255 - 17 * 8, 40}));
}

TEST_F(ImageFiles, APaletteIsColour) {
  const io::LoadedImage read = picture(support::kPalettePng);
  EXPECT_EQ(read.rgb(0, 0), (Rgb{0, 0, 0}));
  EXPECT_EQ(read.rgb(1, 0), (Rgb{255, 0, 0}));
  EXPECT_EQ(read.rgb(3, 0), (Rgb{10, 20, 30}));
}

TEST_F(ImageFiles, FewBitsFillTheScale) {
  EXPECT_EQ(pixels(picture(support::kOneBitPng).gray), fifteen([](int i) { return 255 * (i % 2); }));
  EXPECT_EQ(pixels(pnm("P2 4 1 15 0 1 14 15").gray), (std::vector<int>{0, 17, 238, 255}));
}

TEST_F(ImageFiles, ReadsEveryKindOfPnm) {
  const std::vector<int> expected{0, 128, 255, 7};
  EXPECT_EQ(pixels(pnm("P2\n# a comment\n2 2 # another\n255\n0 128\n255 7\n").gray), expected);
  EXPECT_EQ(pixels(pnm(std::string("P5 2 2 255\n\x00\x80\xff\x07", 15)).gray), expected);
  EXPECT_EQ(pnm("P3 1 1 255 1 2 3").rgb(0, 0), (Rgb{1, 2, 3}));
  EXPECT_EQ(pnm("P6 1 1 255\n\x01\x02\x03").rgb(0, 0), (Rgb{1, 2, 3}));
  EXPECT_EQ(pixels(pnm(std::string("P5 2 1 65535\n\xff\xff\x01\x02", 17)).gray), (std::vector<int>{255, 1}));
}

TEST_F(ImageFiles, ReadsJpegGreyAndProgressiveColour) {
  const io::LoadedImage flat = picture(support::kGreyJpeg);
  EXPECT_EQ(flat.gray.size(), (Size{9, 7}));
  EXPECT_TRUE(flat.rgb.empty());
  EXPECT_NEAR(flat.gray(8, 6), 90, 2);
  const io::LoadedImage colour = picture(support::kProgressiveJpeg);
  EXPECT_NEAR(colour.rgb(8, 6).r, 200, 4);
  EXPECT_NEAR(colour.rgb(8, 6).g, 100, 4);
  EXPECT_NEAR(colour.rgb(8, 6).b, 50, 4);
}

TEST_F(ImageFiles, TheFormatIsDetectedFromTheContent) {
  EXPECT_EQ(io::load_picture(folder_.with("really_a.jpg", decoded(support::kInterlacedPng))).gray.width(), 5);
}

TEST_F(ImageFiles, ADecodersWarningIsNotPrinted) {
  testing::internal::CaptureStderr();
  EXPECT_EQ(picture(support::kWarningPng).gray(1, 0), 17);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

// ---- deep images ----

/// A PNG of 16 bits with these values in one row.
fs::path deep(const TemporaryFolder& folder, const std::string& name, const std::vector<int>& values) {
  Image<std::uint16_t> image({static_cast<int>(values.size()), 1});
  for (int x = 0; x < image.width(); ++x)
    image(x, 0) = static_cast<std::uint16_t>(values[static_cast<std::size_t>(x)]);
  io::save_png(folder.path() / name, image.view());
  return folder.path() / name;
}

TEST_F(ImageFiles, SixteenBitsLoseTheUnusedLowBits) {
  const auto read = [&](const std::vector<int>& values) {
    return pixels(io::load_picture(deep(folder_, "p", values)).gray);
  };
  EXPECT_EQ(read({0, 257, 65535}), (std::vector<int>{0, 1, 255})) << "full scale";
  EXPECT_EQ(read({0, 16, 4095}), (std::vector<int>{0, 1, 255})) << "12 bits at the low end";
  EXPECT_EQ(read({0, 256, 65520}), (std::vector<int>{0, 1, 255})) << "12 bits at the high end";
  EXPECT_EQ(read({0, 1, 255}), (std::vector<int>{0, 1, 255})) << "8 bits in a 16-bit file";
  EXPECT_EQ(read({0, 0, 0}), (std::vector<int>{0, 0, 0}));
}

TEST_F(ImageFiles, APairHasOneScaleSoThatADifferenceOfExposureStays) {
  const fs::path bright = deep(folder_, "bright", {0, 4095});
  const fs::path dim = deep(folder_, "dim", {0, 1000});
  const auto left_and_right = [](const fs::path& one, const fs::path& other) {
    return io::load_pair(one, other);
  };
  EXPECT_EQ(pixels(left_and_right(bright, dim).right.gray), (std::vector<int>{0, 1000 >> 4}));
  EXPECT_EQ(pixels(left_and_right(dim, bright).left.gray), (std::vector<int>{0, 1000 >> 4}));
}

TEST_F(ImageFiles, ADeepPnmDeclaresItsScale) {
  EXPECT_EQ(pixels(pnm("P2 2 1 4095 16 100").gray), (std::vector<int>{1, 6}));
}

TEST_F(ImageFiles, APairOfUnequalSizesOrDepthsIsRefusedWithBothNames) {
  const fs::path left = folder_.with("left.pgm", "P2 2 1 255 0 1");
  const fs::path narrow = folder_.with("right.pgm", "P2 1 1 255 0");
  EXPECT_TRUE(has(refusal([&] { io::load_pair(left, narrow); }), {"left.pgm", "right.pgm", "2x1", "1x1"}));
  const fs::path wide = deep(folder_, "deep.png", {0, 4000});
  EXPECT_TRUE(has(refusal([&] { io::load_pair(left, wide); }), {"left.pgm", "deep.png", "16 bits", "8"}));
}

// ---- labels ----

TEST_F(ImageFiles, LabelsAreNeverScaled) {
  const auto labels = [&](std::string_view base64) { return io::load_labels(file(base64)); };
  EXPECT_EQ(pixels(labels(support::kOneBitPng).ids), fifteen([](int i) { return i % 2; }));
  EXPECT_EQ(pixels(labels(support::kPalettePng).ids), fifteen([](int i) { return i % 4; }));
  EXPECT_EQ(labels(support::kOneBitPng).bits, 8);
}

TEST_F(ImageFiles, LabelsInColourAreRefused) {
  const fs::path path = file(support::kProgressiveJpeg);
  EXPECT_TRUE(has(refusal([&] { io::load_labels(path); }), {"colour", "one channel"}));
}

// ---- writing ----

TEST_F(ImageFiles, WrittenFilesAreReadBack) {
  const fs::path path = folder_.path() / "out.png";
  Image<std::uint8_t> narrow({3, 2});
  Image<std::uint16_t> wide({3, 2});
  Image<Rgb> colour({3, 2});
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) {
      narrow(x, y) = static_cast<std::uint8_t>(100 * y + x);
      wide(x, y) = static_cast<std::uint16_t>(30000 * y + 257 * x);
      colour(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 200};
    }
  }
  io::save_png(path, narrow.view());
  EXPECT_EQ(pixels(io::load_labels(path).ids), pixels(narrow));
  EXPECT_EQ(io::load_labels(path).bits, 8);
  io::save_png(path, wide.view());
  EXPECT_EQ(pixels(io::load_labels(path).ids), pixels(wide));
  EXPECT_EQ(io::load_labels(path).bits, 16);
  io::save_png(path, colour.view());
  EXPECT_EQ(io::load_picture(path).rgb(2, 1), (Rgb{2, 1, 200}));
  io::save_png(path, View<const std::uint8_t>(narrow.view()).sub({1, 0, 2, 2}));
  EXPECT_EQ(pixels(io::load_labels(path).ids), (std::vector<int>{1, 2, 101, 102}));
}

TEST_F(ImageFiles, ReasonsAreWrittenAsTheirBits) {
  Image<Reject> reasons({3, 1}, Reject::left_right, {});
  reasons(1, 0) = Reject::none;
  reasons(2, 0) = static_cast<Reject>(0x8001);
  io::save_png(folder_.path() / "reject.png", View<const Reject>(reasons.view()));
  EXPECT_EQ(pixels(io::load_labels(folder_.path() / "reject.png").ids),
            (std::vector<int>{static_cast<int>(Reject::left_right), 0, 0x8001}));
}

TEST_F(ImageFiles, AnEmptyImageIsNotWritten) {
  EXPECT_TRUE(has(refusal([&] { io::save_png(folder_.path() / "out.png", View<const std::uint8_t>()); }),
                  {"out.png", "empty"}));
  EXPECT_TRUE(has(refusal([&] { io::save_png(folder_.path() / "out.png", View<const Rgb>()); }),
                  {"out.png", "empty"}));
  EXPECT_FALSE(fs::exists(folder_.path() / "out.png"));
}

// ---- refusals ----

TEST_F(ImageFiles, RefusesFilesThatAreNotImages) {
  EXPECT_TRUE(
      has(refusal([&] { io::load_picture(folder_.path() / "none.png"); }), {"none.png", "No such file"}));
  EXPECT_TRUE(has(refusal([&] { io::load_picture(folder_.path()); }), {"is a folder"}));
  EXPECT_TRUE(has(refused(""), {"is empty"}));
  EXPECT_TRUE(has(refused("hello, this is text"), {"not a readable image"}));
  EXPECT_TRUE(has(refused("P4 1 1\n\x80"), {"P4", "expected P2"}));
  EXPECT_TRUE(has(refused("GIF89a"), {"not a readable image"}));
}

TEST_F(ImageFiles, RefusesAbsurdSizesBeforeTheyCostMemory) {
  EXPECT_TRUE(has(refused(decoded(support::kHugePng)), {"60000x60000"}));
  EXPECT_TRUE(has(refused(decoded(support::kBombPng)), {"16000x16000", "68 bytes"}));
  EXPECT_TRUE(has(refused("P5 2000000000 2 255\n"), {"2000000000x2"}));
  EXPECT_TRUE(has(refused("P5 99999999999 2 255\n"), {"width"}));
  EXPECT_TRUE(has(refused("P5 32768 32768 255\n"), {"32768x32768"}));
  EXPECT_TRUE(has(refused("P5 0 2 255\n"), {"0x2"}));
  EXPECT_TRUE(has(refused("P5 -3 2 255\nabcdef"), {"-3x2"}));
  EXPECT_TRUE(has(refused("P2 16000 16000 255 0 0"), {"truncated"}));
  EXPECT_TRUE(has(refused("P5 16000 16000 255 0 0"), {"truncated"}));
}

TEST_F(ImageFiles, RefusesDamagedPnm) {
  EXPECT_TRUE(has(refused("P5 2 2 255\nabc"), {"truncated", "3 bytes", "expected 4"}));
  EXPECT_TRUE(has(refused("P5 2 2 0\nabcd"), {"greatest value 0"}));
  EXPECT_TRUE(has(refused("P5 2 2 70000\nabcd"), {"70000"}));
  EXPECT_TRUE(has(refused("P5 two 2 255\nabcd"), {"width"}));
  EXPECT_TRUE(has(refused("P5 2 2 255abcd"), {"white space"}));
  EXPECT_TRUE(has(refused("P2 2 2 15\n0 1 2 16"), {"16", "at most 15"}));
  EXPECT_TRUE(has(refused("P2 2 2 255\n0 1 2 x"), {"not a number"}));
  EXPECT_TRUE(has(refused("P2 2 2 255\n100 101 200"), {"truncated"}));
}

TEST_F(ImageFiles, RefusesDamagedPngWithRightChecksums) {
  testing::internal::CaptureStderr();
  EXPECT_TRUE(has(refused(decoded(support::kShortDataPng)), {"PNG"}));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(ImageFiles, RefusesOtherKindsOfSamples) {
  EXPECT_TRUE(has(refused(decoded(support::kCmykJpeg)), {"4 channels"}));
  EXPECT_TRUE(has(refused(std::string("II*\0\x08", 5)), {"is a TIFF, expected PNG", "convert"}));
  EXPECT_TRUE(has(refused(std::string("MM\0*", 4)), {"is a TIFF, expected PNG", "convert"}));
}

TEST_F(ImageFiles, NoTruncatedOrAlteredFileIsReadInPart) {
  const auto read = [](const fs::path& path) { io::load_picture(path); };
  const auto cut = [&](std::string_view base64) {
    return survives_damage(folder_, "picture", decoded(base64), read);
  };
  EXPECT_EQ(cut(support::kPalettePng), 0);
  EXPECT_EQ(cut(support::kColourAlpha16Png), 0);
  EXPECT_EQ(cut(support::kInterlacedPng), 0);
  EXPECT_EQ(cut(support::kWarningPng), 0);
  EXPECT_EQ(cut(support::kGreyJpeg), 0);
  EXPECT_EQ(cut(support::kProgressiveJpeg), 0);
  EXPECT_EQ(survives_damage(folder_, "picture", "P5 2 3 255\nabcdef", read), 0);
  EXPECT_EQ(survives_damage(folder_, "picture", "P6 1 2 4000\naabbccddeeff", read), 0);
}

TEST_F(ImageFiles, EveryAlteredPngByteIsDetected) {
  const std::string whole = decoded(support::kInterlacedPng);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string altered = whole;
    altered[at] = static_cast<char>(altered[at] ^ 0x10);
    const fs::path path = folder_.with("picture", altered);
    EXPECT_THROW(io::load_picture(path), Error) << "byte " << at;
  }
}

TEST(BinnedImage, HasTheGreyOfItsColours) {
  io::LoadedImage image{Image<Gray>({4, 2}, Gray{0}, {}), Image<Rgb>({4, 2}, Rgb{}, {})};
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 2; ++y)
      image.rgb(x, y) = {static_cast<Gray>(60 * x), 7, static_cast<Gray>(90 * y + x)};
  }
  image.gray = io::grey_of(image.rgb);
  const io::LoadedImage small = io::binned(image, 2);
  ASSERT_EQ(small.rgb.size(), (Size{2, 1}));
  const Image<Gray> expected = io::grey_of(small.rgb);
  EXPECT_EQ(small.gray(0, 0), expected(0, 0));
  EXPECT_EQ(small.gray(1, 0), expected(1, 0));
  EXPECT_EQ(small.rgb(1, 0).r, 150);
  const io::LoadedImage grey = io::binned({image.gray.clone(), {}}, 2);
  EXPECT_TRUE(grey.rgb.empty());
  EXPECT_EQ(grey.gray.size(), (Size{2, 1}));
}

}  // namespace
}  // namespace cairn
