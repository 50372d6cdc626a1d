// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/output/json.hpp>

#include <array>
#include <cairn/sequence/pose.hpp>
#include <cairn/stereo/match_device.hpp>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace cairn::output {

std::string json_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Json finite(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json rounded(double value) {
  constexpr double kSteps = 1e6;
  return finite(std::round(value * kSteps) / kSteps);
}

Json rounded(const Point3& point) {
  return Json::array({rounded(point.x), rounded(point.y), rounded(point.z)});
}

Json significant(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  return std::strtod(text.data(), nullptr);
}

Json shortest(float value) {
  if (!std::isfinite(value)) return nullptr;
  std::array<char, 48> text{};
  const char* end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  double nearest = 0;
  std::from_chars(text.data(), end, nearest);
  return nearest;
}

Json json_of(const DeviceReport& report) {
  Json kernels = Json::object();
  for (const DeviceKernel& one : report.kernels)
    kernels[one.name] = {{"ms", rounded(one.ms)}, {"bytes", one.bytes}, {"dispatches", one.dispatches}};
  return {{"wanted", report.wanted},
          {"name", report.name},
          {"on_device", report.on_device},
          {"on_processor", report.on_processor},
          {"reason", report.reason},
          {"kernels", kernels},
          {"memory_bytes", report.memory_bytes}};
}

}  // namespace cairn::output
