// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The content of the page's data blocks, parsed as by the page's script. Behaviour is tested in a browser:
// cli/page_in_browser.py.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cairn/io/raster.hpp>
#include <cairn/output/web/html_page.hpp>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>

#include "support/packed_map.hpp"

namespace cairn::output {
namespace {

using Json = nlohmann::json;

constexpr Size kSize{37, 23};
constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

template <class T, class Expected>
void expect_map(const Json& map, const Image<T>& image, const Expected& expected) {
  const auto values = support::unpacked(map, static_cast<std::size_t>(kSize.area()));
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      ASSERT_EQ(values[static_cast<std::size_t>(y * kSize.width + x)], expected(image(x, y)))
          << x << ", " << y;
    }
  }
}

/// A map with distinct values in most pixels.
template <class T, class Value>
Image<T> filled(const Value& value) {
  Image<T> image(kSize);
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) image(x, y) = value(x, y);
  }
  return image;
}

int first_channel(Gray grey) {
  return grey;
}
int first_channel(Rgb colour) {
  return colour.r;
}

template <class T>
void expect_picture(const std::string& uri, int channels, const Image<T>& expected) {
  const std::string head = "data:image/jpeg;base64,";
  ASSERT_TRUE(uri.starts_with(head));
  const io::Raster raster = io::decode_jpeg(support::bytes_of_base64(uri.substr(head.size())));
  ASSERT_EQ(raster.size, kSize);
  ASSERT_EQ(raster.channels, channels);
  int worst = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const int shown = raster.row<std::uint8_t>(y)[x * raster.channels];
      worst = std::max(worst, std::abs(shown - first_channel(expected(x, y))));
    }
  }
  EXPECT_LE(worst, 20);
}

TEST(HtmlPage, PacksIdsOfAnySizeWithoutLoss) {
  for (const std::int32_t factor : {0, 1, 300, 70'000, 20'000'000}) {
    const auto labels =
        filled<RegionId>([&](int x, int y) { return RegionId{(x * 7 + y * 3) % 101 * factor}; });
    PageFrame frame;
    frame.by_intensity = labels;
    const Json maps = Json::parse(encode_frame(frame).maps);
    expect_map(maps.at("by_intensity"), labels, [](RegionId id) { return static_cast<std::uint32_t>(id); });
    EXPECT_TRUE(maps.at("by_disparity").is_null());
  }
}

TEST(HtmlPage, PacksEveryReasonAndTheDontCare) {
  const auto reject =
      filled<Reject>([](int x, int y) { return static_cast<Reject>((x * 3100 + y * 17) % 65536); });
  const auto truth = filled<TruthId>([](int x, int y) { return TruthId{(x + y) % 5 - 1}; });
  PageFrame frame;
  frame.reject = reject;
  frame.true_objects = truth;
  const Json maps = Json::parse(encode_frame(frame).maps);
  expect_map(maps.at("reject"), reject, [](Reject r) { return static_cast<std::uint32_t>(r); });
  expect_map(maps.at("true_objects"), truth,
             [](TruthId t) { return static_cast<std::uint32_t>(static_cast<std::int32_t>(t) + 1); });
}

TEST(HtmlPage, PacksTheSpaceWithTheValuesOfItsFile) {
  constexpr std::array kAll{ObstacleLabel::unknown, ObstacleLabel::sky, ObstacleLabel::floor,
                            ObstacleLabel::obstacle};
  const auto space =
      filled<ObstacleLabel>([&](int x, int y) { return kAll[static_cast<std::size_t>(x * y % 4)]; });
  PageFrame frame;
  frame.space = space;
  const Json maps = Json::parse(encode_frame(frame).maps);
  expect_map(maps.at("space"), space, [](ObstacleLabel s) { return static_cast<std::uint32_t>(s); });
  EXPECT_TRUE(Json::parse(encode_frame({}).maps).at("space").is_null());
}

TEST(HtmlPage, KeepsDisparitiesToHalfOf64thOfAPixelAndHolesAsHoles) {
  const auto disparity = filled<float>([](int x, int y) {
    if ((x + y) % 4 == 0) return kHole;
    return -37.3F + 2.171F * static_cast<float>(x) + 11.9F * static_cast<float>(y);
  });
  PageFrame frame;
  frame.disparity_px = disparity;
  const EncodedFrame encoded = encode_frame(frame);
  const Json map = Json::parse(encoded.maps).at("disparity");
  const auto values = support::unpacked(map, static_cast<std::size_t>(kSize.area()));
  int holes = 0;
  for (int y = 0; y < kSize.height; ++y) {
    for (int x = 0; x < kSize.width; ++x) {
      const std::uint32_t value = values[static_cast<std::size_t>(y * kSize.width + x)];
      ASSERT_EQ(value == 0, std::isnan(disparity(x, y)));
      if (value == 0) {
        ++holes;
        continue;
      }
      const double back = map.at("low").get<double>() + (value - 1.0) / map.at("steps").get<double>();
      ASSERT_NEAR(back, static_cast<double>(disparity(x, y)), 0.5 / 64 + 1e-4);
    }
  }
  EXPECT_GT(holes, 0);
  EXPECT_NEAR(Json::parse(encoded.facts).at("valid_share").get<double>(),
              1 - holes / static_cast<double>(kSize.area()), 1e-9);
}

TEST(HtmlPage, ShowsTheImagesWithSmallCodingErrors) {
  const auto grey = filled<Gray>([](int x, int y) { return static_cast<Gray>(4 * x + 3 * y); });
  const auto colour = filled<Rgb>([](int x, int y) {
    return Rgb{static_cast<std::uint8_t>(5 * x), static_cast<std::uint8_t>(6 * y), 128};
  });
  for (const bool coloured : {false, true}) {
    PageFrame frame;
    frame.left = grey;
    frame.right = grey;
    if (coloured) frame.left_rgb = colour;
    const Json maps = Json::parse(encode_frame(frame).maps);
    expect_picture(maps.at("right"), 1, grey);
    if (coloured) {
      expect_picture(maps.at("left"), 3, colour);
    } else {
      expect_picture(maps.at("left"), 1, grey);
    }
  }
}

TEST(HtmlPage, HasNoRightImageIfThereIsNone) {
  const Image<Gray> grey(kSize, Gray{80}, {});
  PageFrame frame;
  frame.left = grey;
  EXPECT_EQ(Json::parse(encode_frame(frame).maps).at("right"), "");
}

TEST(HtmlPage, PutsALabelInsideEachObject) {
  Image<ObjectId> objects(kSize, ObjectId::none, {});
  // A ring, the middle of whose box is outside of it, and a column at the border.
  for (int y = 2; y < 20; ++y) {
    for (int x = 3; x < 24; ++x) {
      if (x < 7 || x > 19 || y < 6 || y > 15) objects(x, y) = ObjectId{1};
    }
  }
  for (int y = 0; y < kSize.height; ++y) objects(kSize.width - 1, y) = ObjectId{300};
  PageFrame frame;
  frame.objects = objects;
  const Json places = Json::parse(encode_frame(frame).facts).at("objects");
  ASSERT_EQ(places.size(), 2U);
  for (const Json& place : places) {
    EXPECT_EQ(number(objects(place.at("x").get<int>(), place.at("y").get<int>())), place.at("id").get<int>());
  }
}

TEST(HtmlPage, OmitsTheMasksOfObjectsJson) {
  PageFrame frame;
  frame.objects_json = R"({"objects": [{"id": 1, "segmentation": {"counts": "many"}, "confidence": 0.5}]})";
  const Json facts = Json::parse(encode_frame(frame).facts);
  EXPECT_EQ(facts.at("result").at("objects").at(0), (Json{{"id", 1}, {"confidence", 0.5}}));
}

TEST(HtmlPage, IsASelfContainedPage) {
  const Image<Gray> grey(kSize, Gray{80}, {});
  PageFrame frame;
  frame.name = "one";
  frame.left = grey;
  const std::string page = html_page({"segment", "frames", {}}, {encode_frame(frame), encode_frame(frame)});
  EXPECT_TRUE(page.starts_with("<!doctype html>"));
  EXPECT_TRUE(page.ends_with("</html>\n"));
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(page.find("{{"), std::string::npos);
  // The only URL is the SVG namespace.
  EXPECT_EQ(page.find("https:"), std::string::npos);
  EXPECT_EQ(page.find("http:"), page.find("http://www.w3.org/2000/svg"));
  EXPECT_EQ(page.find("http:"), page.rfind("http:"));
  EXPECT_EQ(page.find(" src=\""), std::string::npos);
  EXPECT_EQ(page.find("<link"), std::string::npos);
  EXPECT_EQ(Json::parse(support::block(page, "run")).at("frames"), 2);
  EXPECT_EQ(Json::parse(support::block(page, "facts-1")).at("name"), "one");
  EXPECT_TRUE(Json::parse(support::block(page, "maps-1")).at("left").is_string());
}

TEST(HtmlPage, EscapesAnyName) {
  PageFrame frame;
  for (const std::string& name :
       {std::string("</script><script>alert(1)</script>"), std::string("<!--<script>"),
        std::string("{{style}}"), std::string("\"&'\\"), std::string("\xff\xfe not UTF-8")}) {
    frame.name = name;
    const std::string page = html_page({"segment", name, {}}, {encode_frame(frame)});
    const Json facts = Json::parse(support::block(page, "facts-0"));
    const bool is_utf8 = name.find('\xff') == std::string::npos;
    EXPECT_TRUE(!is_utf8 || facts.at("name") == name) << name;
    EXPECT_EQ(page.find("<script>alert"), std::string::npos);
    EXPECT_EQ(page.find("<!--<"), std::string::npos);
  }
}

TEST(HtmlPage, AcceptsAnEmptyFrameAndASinglePixel) {
  EXPECT_EQ(Json::parse(encode_frame({}).facts).at("width"), 0);
  const Image<Gray> left({1, 1}, Gray{7}, {});
  const Image<float> disparity({1, 1}, kHole, {});
  PageFrame frame;
  frame.left = left;
  frame.disparity_px = disparity;
  const EncodedFrame encoded = encode_frame(frame);
  EXPECT_EQ(Json::parse(encoded.facts).at("valid_share"), 0.0);
  EXPECT_EQ(Json::parse(encoded.facts).at("width"), 1);
}

}  // namespace
}  // namespace cairn::output
