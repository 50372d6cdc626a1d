// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/output/diagnosis_json.hpp>

#include <array>
#include <cairn/output/json.hpp>
#include <cmath>

namespace cairn::output {
namespace {

constexpr double kDegrees = 57.29577951308232;

/// NaN if not measured, as for all numbers.
double of_brightness(const PairMeasures& measures, float number) {
  return measures.brightness.is_measured() ? static_cast<double>(number) : std::nan("");
}
double width_of(const Sharpness& sharpness) {
  return sharpness.edge_px > 0 ? static_cast<double>(sharpness.edge_px) : std::nan("");
}

constexpr std::array kNumbers{
    PairNumber{"textured_points", "textured points", "%.0f",
               [](const PairMeasures& m) { return double(m.textured_points); }},
    PairNumber{"found_points", "found in both images", "%.0f",
               [](const PairMeasures& m) { return double(m.rows.points); }},
    PairNumber{"agreeing_percent", "agree on one geometry, %", "%.0f",
               [](const PairMeasures& m) { return 100 * m.rows.agreeing_share(); }},
    PairNumber{"offset_rows", "right image lower, rows", "%+.2f",
               [](const PairMeasures& m) { return double(m.rows.offset_rows); }},
    PairNumber{"roll_degrees", "right image rotated, degrees", "%+.3f",
               [](const PairMeasures& m) { return kDegrees * std::atan(double(m.rows.rows_per_px)); }},
    PairNumber{"left_over_rows", "remaining, rows", "%.2f",
               [](const PairMeasures& m) { return double(m.rows.left_over_rows); }},
    PairNumber{"furthest_px", "disparity, 1 % below, px", "%.1f",
               [](const PairMeasures& m) { return m.disparity_px(0.01); }},
    PairNumber{"median_px", "disparity, median, px", "%.1f",
               [](const PairMeasures& m) { return m.disparity_px(0.5); }},
    PairNumber{"nearest_px", "disparity, 1 % above, px", "%.1f",
               [](const PairMeasures& m) { return m.disparity_px(0.99); }},
    PairNumber{"gain", "gain, right to left", "%.3f",
               [](const PairMeasures& m) { return of_brightness(m, m.brightness.gain); }},
    PairNumber{"offset", "offset, grey levels", "%+.1f",
               [](const PairMeasures& m) { return of_brightness(m, m.brightness.offset); }},
    PairNumber{"brightness_difference", "brightness apart, grey levels", "%.1f",
               [](const PairMeasures& m) { return of_brightness(m, m.brightness.median); }},
    PairNumber{"left_contrast", "contrast left, grey levels", "%.0f",
               [](const PairMeasures& m) { return double(m.left_exposure.contrast); }},
    PairNumber{"right_contrast", "contrast right, grey levels", "%.0f",
               [](const PairMeasures& m) { return double(m.right_exposure.contrast); }},
    PairNumber{"left_white_percent", "white left, %", "%.1f",
               [](const PairMeasures& m) { return 100 * double(m.left_exposure.white); }},
    PairNumber{"right_white_percent", "white right, %", "%.1f",
               [](const PairMeasures& m) { return 100 * double(m.right_exposure.white); }},
    PairNumber{"left_black_percent", "black left, %", "%.1f",
               [](const PairMeasures& m) { return 100 * double(m.left_exposure.black); }},
    PairNumber{"right_black_percent", "black right, %", "%.1f",
               [](const PairMeasures& m) { return 100 * double(m.right_exposure.black); }},
    PairNumber{"left_edge_px", "edges left, px", "%.2f",
               [](const PairMeasures& m) { return width_of(m.left_sharpness); }},
    PairNumber{"right_edge_px", "edges right, px", "%.2f",
               [](const PairMeasures& m) { return width_of(m.right_sharpness); }}};

}  // namespace

std::vector<PairNumber> pair_numbers() {
  return {kNumbers.begin(), kNumbers.end()};
}

Json json_of(const PairMeasures& measures) {
  Json j;
  for (const PairNumber& number : kNumbers) j[number.key] = finite(number.of(measures));
  j["rows_histogram"] = measures.rows.histogram;
  return j;
}

Json json_of(const Finding& finding, const std::vector<std::string>& names) {
  const FindingInfo& known = info(finding.kind);
  Json pairs = Json::array();
  for (const std::size_t i : finding.frames) pairs.push_back(i < names.size() ? Json(names[i]) : Json(i));
  return {{"finding", known.name},
          {"severity", choice_name(finding.severity, kSeverities)},
          {"value", finite(finding.value)},
          {"number", known.number},
          {"unit", known.unit},
          {"says", finding.says},
          {"remedy", known.remedy},
          {"pairs", pairs}};
}

Json json_of(const Synchrony& s, const std::vector<std::string>& names) {
  const auto name = [&](std::size_t i) { return i < names.size() ? Json(names[i]) : Json(i); };
  Json change = nullptr;
  if (s.change) {
    change = {{"from", name(static_cast<std::size_t>(s.change->from))},
              {"before", s.change->before},
              {"after", s.change->after},
              {"motion", s.change->motion}};
  }
  return {{"first", name(0)},
          {"frames", s.frames},
          {"lag", s.lag()},
          {"motion", s.motion},
          {"agreement", s.agreement},
          {"change", change},
          {"left_repeats", s.left_repeats},
          {"right_repeats", s.right_repeats}};
}

Json json_of(const std::vector<Finding>& findings) {
  Json all = Json::array();
  for (const Finding& finding : findings) {
    Json one = json_of(finding, {});
    one.erase("pairs");
    all.push_back(std::move(one));
  }
  return all;
}

std::string measures_json(const PairMeasures& measures) {
  return json_text(json_of(measures));
}
std::string finding_json(const Finding& finding, const std::vector<std::string>& names) {
  return json_text(json_of(finding, names));
}
std::string synchrony_json(const Synchrony& synchrony, const std::vector<std::string>& names) {
  return json_text(json_of(synchrony, names));
}

}  // namespace cairn::output
