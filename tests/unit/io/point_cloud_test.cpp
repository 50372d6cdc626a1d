// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cairn/core/error.hpp>
#include <cairn/io/point_cloud.hpp>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

namespace cairn::io {
namespace {

constexpr Size kSize{5, 3};
constexpr StereoRig kRig{100, 2, 1, 0.5F, 1};

struct Vertex {
  Vec3 at;
  Rgb colour;
  std::int32_t object = -1;  // −1: the file has none
};

template <class T>
T take(const std::string& bytes, std::size_t& from) {
  static_assert(std::endian::native == std::endian::little);
  T value;
  std::memcpy(&value, bytes.data() + from, sizeof value);
  from += sizeof value;
  return value;
}

struct Ply {
  std::vector<std::string> properties;
  std::vector<Vertex> vertices;
};

/// Like any PLY reader: the header defines the layout.
Ply read_ply(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  const std::string last = "end_header\n";
  const std::size_t end = bytes.find(last);
  EXPECT_NE(end, std::string::npos);
  std::istringstream header(bytes.substr(0, end));
  std::string line;
  std::getline(header, line);
  EXPECT_EQ(line, "ply");
  std::getline(header, line);
  EXPECT_EQ(line, "format binary_little_endian 1.0");
  Ply ply;
  std::size_t count = 0;
  while (std::getline(header, line)) {
    if (line.starts_with("element vertex ")) count = std::stoul(line.substr(15));
    if (line.starts_with("property ")) ply.properties.push_back(line.substr(9));
  }
  std::size_t from = end + last.size();
  const bool with_objects = ply.properties.size() == 7;
  EXPECT_EQ(bytes.size() - from, count * (with_objects ? 19 : 15));
  for (std::size_t i = 0; i < count; ++i) {
    Vertex v;
    v.at.x = take<float>(bytes, from);
    v.at.y = take<float>(bytes, from);
    v.at.z = take<float>(bytes, from);
    v.colour.r = take<std::uint8_t>(bytes, from);
    v.colour.g = take<std::uint8_t>(bytes, from);
    v.colour.b = take<std::uint8_t>(bytes, from);
    if (with_objects) v.object = take<std::int32_t>(bytes, from);
    ply.vertices.push_back(v);
  }
  return ply;
}

class PointCloud : public testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::temp_directory_path() /
            (std::string("cairn_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".ply");
    for (int y = 0; y < kSize.height; ++y) {
      for (int x = 0; x < kSize.width; ++x) {
        disparity_(x, y) = static_cast<float>(4 + x + y);
        left_(x, y) = static_cast<Gray>(10 * x + y);
        rgb_(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 200};
        objects_(x, y) = x < 2 ? ObjectId{70'000} : ObjectId::none;
      }
    }
  }
  void TearDown() override { std::filesystem::remove(path_); }

  std::filesystem::path path_;
  Image<float> disparity_{kSize};
  Image<Gray> left_{kSize};
  Image<Rgb> rgb_{kSize};
  Image<ObjectId> objects_{kSize};
};

TEST_F(PointCloud, HasEachPixelInMetresWithColourAndObject) {
  save_ply(path_, left_, rgb_, disparity_, objects_, kRig);
  const Ply ply = read_ply(path_);
  EXPECT_EQ(ply.properties, (std::vector<std::string>{"float x", "float y", "float z", "uchar red",
                                                      "uchar green", "uchar blue", "int object"}));
  ASSERT_EQ(ply.vertices.size(), static_cast<std::size_t>(kSize.area()));
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const Vertex& v = ply.vertices[static_cast<std::size_t>(y * kSize.width + x)];
      const float z = 100 * 0.5F / (static_cast<float>(4 + x + y) + 1);
      EXPECT_FLOAT_EQ(v.at.z, z);
      EXPECT_FLOAT_EQ(v.at.x, static_cast<float>(x - 2) * z / 100);
      EXPECT_FLOAT_EQ(v.at.y, static_cast<float>(y - 1) * z / 100);
      EXPECT_EQ(v.colour, rgb_(x, y));
      EXPECT_EQ(v.object, number(objects_(x, y)));
    }
  }
}

TEST_F(PointCloud, LeavesOutRefusedPixelsAndThoseAtInfinity) {
  disparity_(0, 0) = std::numeric_limits<float>::quiet_NaN();
  disparity_(3, 1) = -1;  // d + doffs = 0
  disparity_(4, 2) = -5;
  save_ply(path_, left_, rgb_, disparity_, objects_, kRig);
  const Ply ply = read_ply(path_);
  ASSERT_EQ(ply.vertices.size(), static_cast<std::size_t>(kSize.area()) - 3);
  EXPECT_EQ(ply.vertices.front().colour, rgb_(1, 0));
  for (const Vertex& v : ply.vertices) {
    EXPECT_TRUE(std::isfinite(v.at.z));
    EXPECT_GT(v.at.z, 0);
  }
}

TEST_F(PointCloud, OfEachObjectEqualsItsPartOfTheWhole) {
  disparity_(0, 0) = std::numeric_limits<float>::quiet_NaN();
  Objects objects;
  objects.labels = Image<ObjectId>(kSize);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) objects.labels(x, y) = x < 4 ? ObjectId{1 + x / 2} : ObjectId::none;
  }
  objects.list.resize(3);
  for (int id = 1; id <= 3; ++id) objects.list[static_cast<std::size_t>(id - 1)].id = ObjectId{id};
  const std::filesystem::path folder = path_.string() + ".d";
  save_ply(path_, left_, rgb_, disparity_, objects.labels, kRig);
  save_object_plys(folder, left_, rgb_, disparity_, objects, kRig);
  const std::vector<Vertex> all = read_ply(path_).vertices;
  for (int id = 1; id <= 3; ++id) {
    const Ply own = read_ply(folder / (std::to_string(id) + ".ply"));
    EXPECT_EQ(own.properties.size(), 6U);
    std::vector<Vertex> expected;
    std::copy_if(all.begin(), all.end(), std::back_inserter(expected),
                 [&](const Vertex& v) { return v.object == id; });
    ASSERT_EQ(own.vertices.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(own.vertices[i].at, expected[i].at);
      EXPECT_EQ(own.vertices[i].colour, expected[i].colour);
    }
    EXPECT_EQ(own.vertices.size(), id == 1 ? 5U : id == 2 ? 6U : 0U);
  }
  std::filesystem::remove_all(folder);
}

TEST_F(PointCloud, IsGreyWithoutColourAndHasNoObjectsWithoutLabels) {
  save_ply(path_, left_, {}, disparity_, {}, kRig);
  const Ply ply = read_ply(path_);
  EXPECT_EQ(ply.properties.size(), 6U);
  EXPECT_EQ(ply.vertices.at(1).colour, (Rgb{10, 10, 10}));
}

TEST_F(PointCloud, MayBeEmpty) {
  const Image<float> holes(kSize, std::numeric_limits<float>::quiet_NaN(), {});
  save_ply(path_, left_, {}, holes, {}, kRig);
  EXPECT_TRUE(read_ply(path_).vertices.empty());
}

TEST_F(PointCloud, NamesAFileThatCannotBeWritten) {
  try {
    save_ply("/no/such/folder/cloud.ply", left_, {}, disparity_, {}, kRig);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("/no/such/folder/cloud.ply"), std::string::npos);
  }
}

}  // namespace
}  // namespace cairn::io
