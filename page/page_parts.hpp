// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

/// What pages are made of: data as JSON blocks, images packed into them, and the layout that holds all.
/// Internal to those who write pages.
namespace cairn::io {

/// JSON inside of <script>, where "</script" and "<!--" would end it. A name may be no UTF-8, which is no
/// reason to fail.
std::string for_script(const nlohmann::ordered_json& json);
/// A block of data, which the page's script reads by its id. `text`: from for_script().
std::string script_block(const std::string& id, const std::string& text);

std::string base64(const std::uint8_t* bytes, std::size_t count);

/// A map of whole numbers: each one's difference to the one before, modulo 2^32, in as many bytes as the
/// greatest number needs, the lowest bytes of all first, deflated. Smooth maps become almost nothing.
nlohmann::ordered_json packed(const std::vector<std::uint32_t>& values);

/// Null where the map is empty.
template <class T, class Number>
nlohmann::ordered_json packed(View<const T> map, const Number& number_of) {
  if (map.empty()) return nullptr;
  std::vector<std::uint32_t> values;
  values.reserve(static_cast<std::size_t>(map.size().area()));
  for (int y = 0; y < map.height(); ++y) {
    for (int x = 0; x < map.width(); ++x) values.push_back(static_cast<std::uint32_t>(number_of(map(x, y))));
  }
  return packed(values);
}

/// A JPEG in a data URI; the colours where there are any. Empty where there is no picture.
std::string picture_as_uri(View<const Gray> grey, View<const Rgb> colour);

std::string hex(Rgb colour);
/// What ids are drawn with, as overlay.png does: id modulo the length.
nlohmann::ordered_json id_colours();
/// The colours and names that the image files have, too: `ramp` of disparities, `reasons` of holes,
/// `objects`.
nlohmann::ordered_json look();

/// A page without its data: what comes before them, and what behind.
struct PageShell {
  std::string before;
  std::string after;
};
/// `layout` has the places {{title}}, {{style}}, {{data}} and {{script}}, and {{nonce}} where a server sends
/// the page. The style and script that all pages share come before the page's own.
PageShell page_shell(std::string_view layout, std::string_view style, std::string_view script,
                     std::string_view title, std::string_view nonce = {});

}  // namespace cairn::io
