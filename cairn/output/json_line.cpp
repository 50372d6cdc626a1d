// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/output/json_line.hpp>

namespace cairn::output {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxShown = 40;
constexpr int kDeepest = 64;

bool is_too_deep(const std::string& text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
      continue;
    }
    in_string = c == '"';
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kDeepest) return true;
  }
  return false;
}

}  // namespace

std::optional<Json> parsed_json(const std::string& text) {
  if (is_too_deep(text)) throw Error("nests deeper than " + std::to_string(kDeepest) + " brackets");
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) return std::nullopt;
  return json;
}

std::string shown(const Json& value) {
  std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (text.size() > kMaxShown) text = text.substr(0, kMaxShown) + "…";
  return text;
}

JsonLine::JsonLine(const Json& object) : object_(object) {
  if (!object.is_object()) throw Error("found " + shown(object) + ", expected an object {…}");
}

const Json& JsonLine::at(const char* key) const {
  static const Json none;
  const auto found = object_.find(key);
  return found == object_.end() ? none : *found;
}

void JsonLine::refuse(const char* key, const std::string& expected) const {
  throw Error(std::string("`") + key + "` is " + (object_.contains(key) ? shown(at(key)) : "missing") +
              ", expected " + expected);
}

std::optional<std::int64_t> JsonLine::maybe_integer(const char* key, std::int64_t least,
                                                    std::int64_t most) const {
  const Json& value = at(key);
  if (value.is_null()) return std::nullopt;
  const std::string expected = "a whole number from " + std::to_string(least) +
                               (most == kMaxNumber ? " on" : " to " + std::to_string(most));
  if (!value.is_number_integer()) refuse(key, expected);
  if (value.is_number_unsigned() && value.get<std::uint64_t>() > static_cast<std::uint64_t>(kMaxNumber))
    refuse(key, expected);
  const auto number = value.get<std::int64_t>();
  if (number < least || number > most) refuse(key, expected);
  return number;
}

std::int64_t JsonLine::integer(const char* key, std::int64_t least, std::int64_t most) const {
  const auto number = maybe_integer(key, least, most);
  if (!number) refuse(key, "a whole number");
  return *number;
}

std::string JsonLine::text(const char* key) const {
  const Json& value = at(key);
  if (!value.is_string()) refuse(key, "a text");
  return value.get<std::string>();
}

bool JsonLine::flag(const char* key) const {
  const Json& value = at(key);
  if (value.is_null()) return false;
  if (!value.is_boolean()) refuse(key, "true or false");
  return value.get<bool>();
}

bool JsonLine::fill(const char* key, double* numbers, std::size_t count) const {
  const Json& value = at(key);
  if (value.is_null()) return false;
  const std::string expected = std::to_string(count) + " numbers within ±1e9";
  if (!value.is_array() || value.size() != count) refuse(key, expected);
  bool is_known = true;
  for (std::size_t i = 0; i < count; ++i) {
    if (value[i].is_null()) {
      is_known = false;
      continue;
    }
    if (!value[i].is_number()) refuse(key, expected);
    numbers[i] = value[i].get<double>();
    if (!(std::abs(numbers[i]) <= kMaxDistance)) refuse(key, expected);
  }
  return is_known;
}

std::optional<Point3> JsonLine::maybe_point(const char* key) const {
  const auto numbers = maybe_numbers<3>(key);
  if (!numbers) return std::nullopt;
  return Point3{(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

}  // namespace cairn::output
