// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/image.hpp>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

/// The parts of pages: data as JSON blocks, packed images, and the layout around them. Internal to the
/// writers of pages.
namespace cairn::output {

/// JSON for use inside of a script element of HTML, with "</script" and "<!--" escaped. Invalid UTF-8 in names is replaced.
std::string for_script(const nlohmann::ordered_json& json);
/// The same for a text of JSON.
std::string script_text(const std::string& json);
/// A block of data that the script of the page reads by its id. `text`: from for_script().
std::string script_block(const std::string& id, const std::string& text);

std::string base64(const std::uint8_t* bytes, std::size_t count);

/// A map of integers: differences to the previous one modulo 2^32, in as many bytes as the largest needs, the
/// lowest bytes of all first, deflated. Smooth maps shrink to almost nothing.
nlohmann::ordered_json packed(const std::vector<std::uint32_t>& values);

/// Null if the map is empty.
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

/// A JPEG as data URI, in colour if available. Empty without an image.
std::string picture_as_uri(View<const Gray> grey, View<const Rgb> colour);

std::string hex(Rgb colour);
/// The colours of ids, as in overlay.png: id modulo the length.
nlohmann::ordered_json id_colours();
/// The colours and names shared with the image files: `ramp` of disparities, `reasons` of holes, `objects`.
nlohmann::ordered_json look();

/// A page without its data: the parts before and after them.
struct PageShell {
  std::string before;
  std::string after;
};
/// `layout` has the places {{title}}, {{style}}, {{data}} and {{script}}, and {{nonce}} for pages sent by a
/// server. The style and script common to all pages come before those of the page.
PageShell page_shell(std::string_view layout, std::string_view style, std::string_view script,
                     std::string_view title, std::string_view nonce = {});

}  // namespace cairn::output
