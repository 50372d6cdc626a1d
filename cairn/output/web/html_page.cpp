// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/output/json.hpp>
#include <cairn/output/overlay.hpp>
#include <cairn/output/web/html_page.hpp>
#include <cairn/output/web/html_template.hpp>
#include <cairn/output/web/page_parts.hpp>
#include <cmath>
#include <cstdint>
#include <map>

namespace cairn::output {
namespace {

// ---- maps ----

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

// ---- facts ----

/// The bounding box of each id above none.
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

/// The part of objects.json that the page needs: all but the masks, which it has as maps.
Json without_masks(Json result) {
  if (result.is_null()) return result;
  for (Json& object : result.at("objects")) object.erase("segmentation");
  return result;
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

Json facts(const PageFrame& frame, Json result) {
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
          {"result", without_masks(std::move(result))}};
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
          {"space", packed(frame.space, [](ObstacleLabel s) { return static_cast<std::uint8_t>(s); })},
          // Ids are shifted by one: 0 is don't care.
          {"true_objects", packed(frame.true_objects, [](TruthId t) { return number(t) + 1; })},
          {"true_disparity", packed_disparity(frame.true_disparity_px)}};
}

}  // namespace

EncodedFrame encode_frame(const PageFrame& frame, Json result) {
  return {for_script(facts(frame, std::move(result))), for_script(maps(frame))};
}

EncodedFrame encode_frame(const PageFrame& frame) {
  return encode_frame(frame, frame.objects_json.empty() ? Json(nullptr) : Json::parse(frame.objects_json));
}

std::string html_page(const PageHead& head, const std::vector<EncodedFrame>& frames) {
  std::string run = for_script({{"command", head.command},
                                {"title", head.title},
                                {"cairn", CAIRN_VERSION},
                                {"frames", frames.size()},
                                {"look", look()}});
  run.back() = ',';
  run += "\"evaluation\":" + (head.evaluation.empty() ? "null" : script_text(head.evaluation)) + "}";
  const PageShell shell =
      page_shell(kPageLayout, kPageStyle, kPageScript, "cairn " + head.command + ": " + head.title);
  std::string page = shell.before + script_block("run", run);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    page += script_block("facts-" + std::to_string(i), frames[i].facts);
    page += script_block("maps-" + std::to_string(i), frames[i].maps);
  }
  return page += shell.after;
}

}  // namespace cairn::output
