// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <io/overlay.hpp>
#include <io/raster.hpp>
#include <map>
#include <nlohmann/json.hpp>
#include <page/html_page.hpp>
#include <page/html_template.hpp>
#include <string_view>

namespace cairn::io {
namespace {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<std::uint8_t>;

// ---- text ----

std::string base64(const std::uint8_t* bytes, std::size_t count) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((count + 2) / 3 * 4);
  for (std::size_t i = 0; i < count; i += 3) {
    const std::size_t here = std::min<std::size_t>(3, count - i);
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) three = three << 8 | (k < here ? bytes[i + k] : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= here ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

/// JSON inside of <script>, where "</script" and "<!--" would end it. A name may be no UTF-8, which is no
/// reason to fail.
std::string for_script(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

std::string for_html(std::string_view words) {
  std::string text;
  for (const char c : words) {
    switch (c) {
      case '<':
        text += "&lt;";
        break;
      case '>':
        text += "&gt;";
        break;
      case '&':
        text += "&amp;";
        break;
      case '"':
        text += "&quot;";
        break;
      default:
        text += c;
    }
  }
  return text;
}

std::string hex(Rgb c) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text = "#";
  for (const std::uint8_t channel : {c.r, c.g, c.b}) {
    text += kDigits[channel >> 4];
    text += kDigits[channel & 15];
  }
  return text;
}

// ---- maps ----

/// A map of whole numbers: each one's difference to the one before, modulo 2^32, in as many bytes as the
/// greatest number needs, the lowest bytes of all first, deflated. Smooth maps become almost nothing.
Json packed(const std::vector<std::uint32_t>& values) {
  const std::uint32_t greatest = values.empty() ? 0 : *std::max_element(values.begin(), values.end());
  const std::size_t bytes_each = std::max<std::size_t>(1, (std::bit_width(greatest) + 7U) / 8);
  Bytes planes(values.size() * bytes_each);
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint32_t difference = values[i] - before;
    before = values[i];
    for (std::size_t k = 0; k < bytes_each; ++k) {
      planes[k * values.size() + i] = static_cast<std::uint8_t>(difference >> (8 * k) & 255);
    }
  }
  Bytes deflated(compressBound(planes.size()));
  uLongf count = deflated.size();
  if (compress(deflated.data(), &count, planes.data(), planes.size()) != Z_OK) throw std::bad_alloc();
  return {{"bytes", bytes_each}, {"data", base64(deflated.data(), count)}};
}

/// Null where the map is empty.
template <class T, class Number>
Json packed(View<const T> map, const Number& number_of) {
  if (map.empty()) return nullptr;
  std::vector<std::uint32_t> values;
  values.reserve(static_cast<std::size_t>(map.size().area()));
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) values.push_back(static_cast<std::uint32_t>(number_of(map(x, y))));
  }
  return packed(values);
}

/// 0 = hole, else low + (n − 1) / 64.
Json packed_disparity(View<const float> map) {
  constexpr float kSteps = 64;
  if (map.empty()) return nullptr;
  float low = 0;
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) low = map(x, y) < low ? map(x, y) : low;
  }
  low = std::floor(low);
  Json j = packed(map, [&](float d) { return std::isfinite(d) ? 1 + std::lround((d - low) * kSteps) : 0L; });
  j["low"] = low;
  j["steps"] = kSteps;
  return j;
}

std::string picture_as_uri(View<const Gray> grey, View<const Rgb> colour) {
  if (grey.empty() && colour.empty()) return {};
  PixelRows rows;
  if (colour.empty()) {
    rows = {grey.size(), 1, 1, grey.data(), grey.stride()};
  } else {
    rows = {colour.size(), 3, 1, reinterpret_cast<const std::uint8_t*>(colour.data()), colour.stride() * 3};
  }
  const std::string file = encode_jpeg(rows);
  return "data:image/jpeg;base64," + base64(reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
}

// ---- facts ----

/// Every id above none with the smallest box around it.
template <class Id>
std::map<Id, Rect> boxes(View<const Id> labels) {
  std::map<Id, Rect> all;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const Id id = labels(x, y);
      if (number(id) <= 0) continue;
      const auto [place, is_new] = all.try_emplace(id, Rect{x, y, 1, 1});
      if (!is_new) place->second = united(place->second, Rect{x, y, 1, 1});
    }
  }
  return all;
}

template <class Id>
Json label_places(View<const Id> labels) {
  Json all = Json::array();
  for (const auto& [id, box] : boxes(labels)) {
    const Image<std::uint8_t> mask = mask_of(labels, id, box);
    const LabelPlace place = label_place(mask);
    all.push_back({{"id", number(id)}, {"x", box.x + place.x}, {"y", box.y + place.y}});
  }
  return all;
}

/// What the page needs of an objects.json: all but the masks, which it has as maps.
Json without_masks(const std::string& objects_json) {
  if (objects_json.empty()) return nullptr;
  Json whole = Json::parse(objects_json);
  for (Json& object : whole.at("objects")) object.erase("segmentation");
  return whole;
}

Size size_of(const PageFrame& frame) {
  for (const Size size : {frame.left.size(), frame.disparity_px.size(), frame.objects.size(),
                          frame.true_objects.size(), frame.true_disparity_px.size()}) {
    if (size.area() > 0) return size;
  }
  return {};
}

Json valid_share(View<const float> disparity_px) {
  if (disparity_px.empty()) return nullptr;
  std::int64_t valid = 0;
  for (int y = 0; y < disparity_px.height(); ++y) {
    valid += std::count_if(disparity_px.row(y), disparity_px.row(y) + disparity_px.width(),
                           [](float d) { return std::isfinite(d); });
  }
  return static_cast<double>(valid) / static_cast<double>(disparity_px.size().area());
}

Json facts(const PageFrame& frame) {
  const Size size = size_of(frame);
  const DisparitySpan span =
      disparity_span(frame.disparity_px.empty() ? frame.true_disparity_px : frame.disparity_px);
  return {{"name", frame.name},
          {"width", size.width},
          {"height", size.height},
          {"valid_share", valid_share(frame.disparity_px)},
          {"span", {span.low, span.high}},
          {"objects", label_places(frame.objects)},
          {"true_objects", label_places(frame.true_objects)},
          {"result", without_masks(frame.objects_json)}};
}

Json maps(const PageFrame& frame) {
  const auto id = [](auto label) { return number(label); };
  return {{"left", picture_as_uri(frame.left, frame.left_rgb)},
          {"right", picture_as_uri(frame.right, {})},
          {"disparity", packed_disparity(frame.disparity_px)},
          {"reject", packed(frame.reject, [](Reject r) { return static_cast<std::uint16_t>(r); })},
          {"confidence", packed(frame.confidence, [](float c) { return std::lround(255 * c); })},
          {"by_intensity", packed(frame.by_intensity, id)},
          {"by_disparity", packed(frame.by_disparity, id)},
          {"superpixels", packed(frame.superpixels, id)},
          {"groups", packed(frame.groups, id)},
          {"objects", packed(frame.objects, id)},
          {"space", packed(frame.space, [](Space s) { return static_cast<std::uint8_t>(s); })},
          // One more than the id: don't care is 0.
          {"true_objects", packed(frame.true_objects, [](TruthId t) { return number(t) + 1; })},
          {"true_disparity", packed_disparity(frame.true_disparity_px)}};
}

/// The colours and names that the pictures beside the page have, too.
Json look() {
  Json ramp = Json::array();
  for (const Rgb colour : disparity_colours()) ramp.push_back(hex(colour));
  Json reasons = Json::array();
  for (const Reason& reason : kReasons) {
    reasons.push_back(
        {{"bit", static_cast<int>(reason.bit)}, {"name", reason.label}, {"colour", hex(reason.colour)}});
  }
  constexpr int kObjectColours = 1000;  // object_colour() begins anew after as many
  Json objects = Json::array();
  for (int id = 0; id < kObjectColours; ++id) objects.push_back(hex(object_colour(ObjectId{id})));
  return {{"ramp", ramp}, {"reasons", reasons}, {"objects", objects}};
}

std::string script_block(const std::string& id, const std::string& json) {
  return R"(<script type="application/json" id=")" + id + "\">" + json + "</script>\n";
}

}  // namespace

EncodedFrame encode_frame(const PageFrame& frame) {
  return {for_script(facts(frame)), for_script(maps(frame))};
}

std::string html_page(const PageHead& head, const std::vector<EncodedFrame>& frames) {
  Json run{{"command", head.command},
           {"title", head.title},
           {"cairn", CAIRN_VERSION},
           {"frames", frames.size()},
           {"look", look()}};
  run["evaluation"] = head.evaluation.empty() ? Json(nullptr) : Json::parse(head.evaluation);
  std::string data = script_block("run", for_script(run));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    data += script_block("facts-" + std::to_string(i), frames[i].facts);
    data += script_block("maps-" + std::to_string(i), frames[i].maps);
  }
  const std::string title = for_html("cairn " + head.command + ": " + head.title);
  const std::map<std::string_view, std::string_view> parts{
      {"title", title}, {"style", kPageStyle}, {"data", data}, {"script", kPageScript}};
  // One pass, so that nothing inside of a part is taken for a place of another: `{{name}}`.
  std::string page;
  std::string_view rest = kPageLayout;
  for (std::size_t open = rest.find("{{"); open != std::string_view::npos; open = rest.find("{{")) {
    const std::size_t close = rest.find("}}", open);
    page += rest.substr(0, open);
    page += parts.at(rest.substr(open + 2, close - open - 2));
    rest.remove_prefix(close + 2);
  }
  return page += rest;
}

}  // namespace cairn::io
