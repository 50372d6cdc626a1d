// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <bit>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cmath>
#include <limits>

#include "support/temporary_folder.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;
using support::bytes_of;
using support::has;
using support::refusal;
using support::survives_damage;
using support::TemporaryFolder;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

Image<float> map(const std::vector<std::vector<float>>& rows) {
  Image<float> image({static_cast<int>(rows[0].size()), static_cast<int>(rows.size())});
  for (int y = 0; y < image.height(); ++y) {
    std::copy(rows[static_cast<std::size_t>(y)].begin(), rows[static_cast<std::size_t>(y)].end(),
              image.row(y));
  }
  return image;
}

void save(const fs::path& path, const std::vector<std::vector<float>>& rows) {
  const Image<float> image = map(rows);
  io::save_disparity(path, image);
}

std::vector<float> row_of(const Image<float>& image, int y) {
  return {image.row(y), image.row(y) + image.width()};
}

std::string big_endian(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(bits >> shift & 0xFFU);
  return bytes;
}
std::string little_endian(float value) {
  const std::string bytes = big_endian(value);
  return {bytes.rbegin(), bytes.rend()};
}

class DisparityFiles : public testing::Test {
 protected:
  [[nodiscard]] std::string refused(const std::string& name, std::string_view bytes) const {
    const fs::path path = folder_.with(name, bytes);
    std::string message = refusal([&] { io::load_disparity(path); });
    EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
    return message;
  }
  TemporaryFolder folder_;
};

TEST_F(DisparityFiles, PngHoldsMultiplesOfA256th) {
  const fs::path path = folder_.path() / "d.png";
  save(path, {{1.5F, 255.99609375F, 0.00390625F}, {63.25F, 100.0F, 7.125F}});
  const Image<float> read = io::load_disparity(path);
  EXPECT_EQ(row_of(read, 0), (std::vector<float>{1.5F, 255.99609375F, 0.00390625F}));
  EXPECT_EQ(row_of(read, 1), (std::vector<float>{63.25F, 100.0F, 7.125F}));
  EXPECT_EQ(io::load_labels(path).bits, 16);
  EXPECT_EQ(io::load_labels(path).ids(0, 0), 384);
}

TEST_F(DisparityFiles, PngWritesHolesAs0AndATrue0As1) {
  const fs::path path = folder_.path() / "d.PNG";
  save(path, {{0.0F, -0.0F, 0.001F, kNan, kInf, -kInf}});
  const io::Labels raw = io::load_labels(path);
  EXPECT_EQ((std::vector<int>{raw.ids(0, 0), raw.ids(1, 0), raw.ids(2, 0), raw.ids(3, 0), raw.ids(4, 0),
                              raw.ids(5, 0)}),
            (std::vector<int>{1, 1, 1, 0, 0, 0}));
  const Image<float> read = io::load_disparity(path);
  EXPECT_EQ(read(0, 0), 1.0F / 256);
  EXPECT_TRUE(std::isnan(read(3, 0)));
}

TEST_F(DisparityFiles, PngRefusesWhat16BitsCannotHoldAndSuggestsPfm) {
  const fs::path path = folder_.path() / "d.png";
  for (const float value : {-0.25F, 256.0F, 255.9999F, 1e9F, -1e-6F}) {
    const Image<float> one = map({{1.0F, value}});
    EXPECT_TRUE(has(refusal([&] { io::save_disparity(path, one); }), {"d.png", "(1, 0)", ".pfm"}));
    EXPECT_FALSE(io::png_can_hold(one));
    EXPECT_FALSE(fs::exists(path));
  }
  const Image<float> fine = map({{0.0F, 255.99F, kNan}});
  EXPECT_TRUE(io::png_can_hold(fine));
}

TEST_F(DisparityFiles, TheSearchRangeDecidesWhetherPngSuffices) {
  EXPECT_TRUE(io::png_can_hold(0, 256));
  EXPECT_FALSE(io::png_can_hold(0, 257));
  EXPECT_FALSE(io::png_can_hold(1, 256));
  EXPECT_FALSE(io::png_can_hold(-1, 16));
  EXPECT_TRUE(io::png_can_hold(192, 64));
}

TEST_F(DisparityFiles, PfmKeepsEveryBitAndWritesInfForAHole) {
  const fs::path path = folder_.path() / "d.pfm";
  save(path, {{-3.125F, 1000.5F, kNan}, {0.0F, 1e-30F, -kInf}});
  EXPECT_EQ(bytes_of(path), "Pf\n3 2\n-1.0\n" + little_endian(0.0F) + little_endian(1e-30F) +
                                little_endian(kInf) + little_endian(-3.125F) + little_endian(1000.5F) +
                                little_endian(kInf));
  const Image<float> read = io::load_disparity(path);
  EXPECT_EQ(read(0, 0), -3.125F);
  EXPECT_EQ(read(1, 0), 1000.5F);
  EXPECT_TRUE(std::isnan(read(2, 0)));
  EXPECT_EQ(read(1, 1), 1e-30F);
}

TEST_F(DisparityFiles, PfmIsReadInEitherByteOrderRowsBottomUp) {
  const auto read = [&](const std::string& bytes) {
    return io::load_disparity(folder_.with("d.pfm", bytes));
  };
  const Image<float> big = read("Pf\n1 2\n1.0\n" + big_endian(7.5F) + big_endian(2.0F));
  EXPECT_EQ(big(0, 0), 2.0F);
  EXPECT_EQ(big(0, 1), 7.5F);
  const Image<float> little = read("Pf 1 2 -0.003922\n" + little_endian(7.5F) + little_endian(2.0F));
  EXPECT_EQ(little(0, 1), 7.5F);
}

TEST_F(DisparityFiles, PfmHolesAreReadFromNanAndBothInfinities) {
  const Image<float> read = io::load_disparity(folder_.with(
      "d.pfm", "Pf\n3 1\n-1\n" + little_endian(kNan) + little_endian(kInf) + little_endian(-kInf)));
  for (int x = 0; x < 3; ++x) EXPECT_TRUE(std::isnan(read(x, 0)));
}

TEST_F(DisparityFiles, RefusesATruncatedPfm) {
  const std::string four(16, 'x');
  EXPECT_TRUE(has(refused("d.pfm", ""), {"empty"}));
  EXPECT_TRUE(
      has(refused("d.pfm", "Pf\n2 2\n-1\n" + four.substr(1)), {"15 bytes", "expected 16", "truncated"}));
  EXPECT_TRUE(has(refused("d.pfm", "Pf\n2 2\n-1\n" + four + "x"), {"17 bytes", "expected 16"}));
  EXPECT_TRUE(has(refused("d.pfm", "Pf\n2 2"), {"scale"}));
  EXPECT_TRUE(has(refused("d.pfm", "PF\n2 2\n-1\n" + four), {"colour"}));
  EXPECT_TRUE(has(refused("d.pfm", "P5\n2 2\n255\n" + four), {"not a PFM"}));
  EXPECT_TRUE(has(refused("d.pfm", "Pf\n2 2\n0\n" + four), {"scale"}));
  EXPECT_TRUE(has(refused("d.pfm", "Pf\n2 2\nnan\n" + four), {"scale"}));
  EXPECT_TRUE(has(refused("d.pfm", "Pf\n2 2\n-1x\n" + four), {"scale"}));
  EXPECT_TRUE(has(refused("d.pfm", "Pf\n2.5 2\n-1\n" + four), {"width"}));
  EXPECT_TRUE(has(refused("d.pfm", "Pf\n-2 2\n-1\n" + four), {"-2x2"}));
  EXPECT_TRUE(has(refused("d.pfm", "Pf\n30000 30000\n-1\n" + four), {"30000x30000"}));
  EXPECT_TRUE(has(refused("d.pfm", "Pf\n16000 16000\n-1\n" + four), {"16 bytes", "truncated"}));
}

TEST_F(DisparityFiles, RefusesPngOfOtherKinds) {
  const fs::path path = folder_.path() / "d.png";
  Image<std::uint8_t> narrow({2, 1}, 7, {});
  io::save_png(path, narrow.view());
  EXPECT_TRUE(has(refusal([&] { io::load_disparity(path); }), {"d.png", "8 bits"}));
  Image<Rgb> colour({2, 1}, Rgb{}, {});
  io::save_png(path, colour.view());
  EXPECT_TRUE(has(refusal([&] { io::load_disparity(path); }), {"d.png", "colour"}));
}

TEST_F(DisparityFiles, RefusesOtherExtensionsAndEmptyMaps) {
  const Image<float> one = map({{1.0F}});
  for (const char* name : {"d.jpg", "d", "d.tiff", "d.pfm.gz"}) {
    EXPECT_TRUE(
        has(refusal([&] { io::save_disparity(folder_.path() / name, one); }), {name, ".png", ".pfm"}));
    EXPECT_TRUE(has(refusal([&] { io::load_disparity(folder_.path() / name); }), {name, ".png", ".pfm"}));
  }
  EXPECT_TRUE(has(refusal([&] { io::save_disparity(folder_.path() / "d.pfm", {}); }), {"empty"}));
  EXPECT_TRUE(
      has(refusal([&] { io::load_disparity(folder_.path() / "none.pfm"); }), {"none.pfm", "No such file"}));
}

TEST_F(DisparityFiles, AMapOfHolesIsRead) {
  save(folder_.path() / "d.png", {{kNan, kNan}});
  EXPECT_TRUE(std::isnan(io::load_disparity(folder_.path() / "d.png")(1, 0)));
}

TEST_F(DisparityFiles, NoTruncatedFileIsReadInPart) {
  save(folder_.path() / "whole.png", {{1.5F, 2.5F, 3.5F}, {4, 5, 6}});
  save(folder_.path() / "whole.pfm", {{1.5F, 2.5F, 3.5F}, {4, 5, 6}});
  const auto read = [](const fs::path& path) { io::load_disparity(path); };
  EXPECT_EQ(survives_damage(folder_, "d.png", bytes_of(folder_.path() / "whole.png"), read), 0);
  EXPECT_EQ(survives_damage(folder_, "d.pfm", bytes_of(folder_.path() / "whole.pfm"), read), 0);
}

TEST_F(DisparityFiles, MiddleburysMapsHaveTheScaleOfTheirDataSet) {
  const auto read = [&](const char* name, int height) {
    Image<std::uint8_t> steps({4, height}, 60, {});
    steps(1, 0) = 0;
    io::save_png(folder_.path() / name, steps.view());
    return io::load_disparity(folder_.path() / name);
  };
  EXPECT_EQ(read("disp1.png", 1110)(0, 0), 60);   // 2005 and 2006, full size
  EXPECT_EQ(read("disp1.png", 555)(0, 0), 30);    // half
  EXPECT_EQ(read("disp5.png", 370)(0, 0), 20);    // a third
  EXPECT_EQ(read("disp2.png", 375)(0, 0), 15);    // 2003, a quarter
  EXPECT_EQ(read("disp2.png", 383)(0, 0), 7.5F);  // 2001
  EXPECT_TRUE(std::isnan(read("disp2.png", 383)(1, 0)));
  EXPECT_TRUE(has(refusal([&] { (void)read("disp1.png", 480); }), {"disp1.png", "4x480", "scale"}));
  EXPECT_TRUE(has(refusal([&] { (void)read("disparity.png", 370); }), {"8 bits", "256"}));
  std::string pgm = "P5\n2 375\n255\n";
  pgm.append(2 * 375, '\x08');
  EXPECT_EQ(io::load_disparity(folder_.with("disp2.pgm", pgm))(1, 374), 2);
}

/// The output of numpy.save().
std::string npy(const std::string& type, const std::string& shape, const std::string& pixels,
                const std::string& fortran = "False") {
  std::string header =
      "{'descr': '" + type + "', 'fortran_order': " + fortran + ", 'shape': " + shape + ", }";
  header.resize(117, ' ');
  header += '\n';
  return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(header.size()) + '\0' + header + pixels;
}

TEST_F(DisparityFiles, NumpysArraysAreRead) {
  std::string pixels;
  for (const float value : {1.5F, kNan, -2.0F, kInf, 4.25F, 0.0F}) pixels += little_endian(value);
  const Image<float> floats = io::load_disparity(folder_.with("d.npy", npy("<f4", "(2, 3)", pixels)));
  ASSERT_EQ(floats.size(), (Size{3, 2}));
  EXPECT_EQ(floats(0, 0), 1.5F);
  EXPECT_TRUE(std::isnan(floats(1, 0)) && std::isnan(floats(0, 1)));
  EXPECT_EQ(floats(2, 0), -2.0F);
  EXPECT_EQ(floats(1, 1), 4.25F);
  const double wide = 7.125;
  const std::string bytes(reinterpret_cast<const char*>(&wide), sizeof wide);
  EXPECT_EQ(io::load_disparity(folder_.with("w.npy", npy("<f8", "(1, 1)", bytes)))(0, 0), 7.125F);
}

TEST_F(DisparityFiles, NumpysArraysOfOtherKindsAreRefused) {
  const std::string four = little_endian(1) + little_endian(2) + little_endian(3) + little_endian(4);
  EXPECT_TRUE(has(refused("d.npy", npy("<f4", "(2, 3)", four)), {"16 bytes", "24"}));
  EXPECT_TRUE(has(refused("d.npy", npy("<i4", "(2, 2)", four)), {"'<i4'", "'<f4'"}));
  EXPECT_TRUE(has(refused("d.npy", npy(">f4", "(2, 2)", four)), {"'>f4'"}));
  EXPECT_TRUE(has(refused("d.npy", npy("<f4", "(4,)", four)), {"'(4,)'", "(height, width)"}));
  EXPECT_TRUE(has(refused("d.npy", npy("<f4", "(1, 2, 2)", four)), {"(1, 2, 2)"}));
  EXPECT_TRUE(has(refused("d.npy", npy("<f4", "(2, 2)", four, "True")), {"Fortran"}));
  EXPECT_TRUE(has(refused("d.npy", npy("<f4", "(0, 4)", "")), {"0"}));
  EXPECT_TRUE(has(refused("d.npy", "PK"), {"NUMPY"}));
  EXPECT_TRUE(has(refusal([&] { save(folder_.path() / "d.npy", {{1.0F}}); }), {".npy", ".pfm"}));
  const std::string good = npy("<f4", "(2, 2)", four);
  EXPECT_EQ(
      survives_damage(folder_, "d.npy", good, [](const fs::path& path) { (void)io::load_disparity(path); }),
      0);
}

}  // namespace
}  // namespace cairn
