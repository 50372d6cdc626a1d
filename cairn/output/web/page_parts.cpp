// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cairn/io/raster.hpp>
#include <cairn/output/overlay.hpp>
#include <cairn/output/web/html_template.hpp>
#include <cairn/output/web/page_parts.hpp>
#include <cairn/stereo/reject.hpp>
#include <map>
#include <new>

namespace cairn::output {

using Json = nlohmann::ordered_json;

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

std::string for_script(const Json& json) {
  return script_text(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

std::string script_text(const std::string& json) {
  std::string text;
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

namespace {
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

}  // namespace

std::string hex(Rgb c) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text = "#";
  for (const std::uint8_t channel : {c.r, c.g, c.b}) {
    text += kDigits[channel >> 4];
    text += kDigits[channel & 15];
  }
  return text;
}

Json packed(const std::vector<std::uint32_t>& values) {
  const std::uint32_t greatest = values.empty() ? 0 : *std::max_element(values.begin(), values.end());
  const std::size_t bytes_each = std::max<std::size_t>(1, (std::bit_width(greatest) + 7U) / 8);
  std::vector<std::uint8_t> planes(values.size() * bytes_each);
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint32_t difference = values[i] - before;
    before = values[i];
    for (std::size_t k = 0; k < bytes_each; ++k) {
      planes[k * values.size() + i] = static_cast<std::uint8_t>(difference >> (8 * k) & 255);
    }
  }
  std::vector<std::uint8_t> deflated(compressBound(planes.size()));
  uLongf count = deflated.size();
  if (compress(deflated.data(), &count, planes.data(), planes.size()) != Z_OK) throw std::bad_alloc();
  return {{"bytes", bytes_each}, {"data", base64(deflated.data(), count)}};
}

std::string picture_as_uri(View<const Gray> grey, View<const Rgb> colour) {
  if (grey.empty() && colour.empty()) return {};
  io::PixelRows rows;
  if (colour.empty()) {
    rows = {grey.size(), 1, 1, grey.data(), grey.stride()};
  } else {
    rows = {colour.size(), 3, 1, reinterpret_cast<const std::uint8_t*>(colour.data()), colour.stride() * 3};
  }
  const std::string file = io::encode_jpeg(rows);
  return "data:image/jpeg;base64," + base64(reinterpret_cast<const std::uint8_t*>(file.data()), file.size());
}

std::string script_block(const std::string& id, const std::string& text) {
  return R"(<script type="application/json" id=")" + id + "\">" + text + "</script>\n";
}

Json id_colours() {
  constexpr int kColours = 1000;  // the number of different colours of object_colour()
  Json all = Json::array();
  for (int id = 0; id < kColours; ++id) all.push_back(hex(object_colour(ObjectId{id})));
  return all;
}

Json look() {
  Json ramp = Json::array();
  for (const Rgb colour : disparity_colours()) ramp.push_back(hex(colour));
  Json reasons = Json::array();
  for (const Reason& reason : kReasons) {
    reasons.push_back({{"bit", static_cast<int>(reason.bit)},
                       {"name", reason.label},
                       {"colour", hex(reason.colour)},
                       {"says", reason.says}});
  }
  return {{"ramp", ramp}, {"reasons", reasons}, {"objects", id_colours()}};
}

PageShell page_shell(std::string_view layout, std::string_view style, std::string_view script,
                     std::string_view title, std::string_view nonce) {
  const std::map<std::string_view, std::string> parts{{"title", for_html(title)},
                                                      {"nonce", for_html(nonce)},
                                                      {"style", std::string(kSharedStyle) += style},
                                                      {"script", std::string(kSharedScript) += script}};
  PageShell shell;
  std::string* page = &shell.before;
  // In a single pass, so that `{{name}}` inside a part is not replaced.
  for (std::size_t open = layout.find("{{"); open != std::string_view::npos; open = layout.find("{{")) {
    const std::size_t close = layout.find("}}", open);
    const std::string_view name = layout.substr(open + 2, close - open - 2);
    *page += layout.substr(0, open);
    if (name == "data") {
      page = &shell.after;
    } else {
      *page += parts.at(name);
    }
    layout.remove_prefix(close + 2);
  }
  *page += layout;
  return shell;
}

}  // namespace cairn::output
