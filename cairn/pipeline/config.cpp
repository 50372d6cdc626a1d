// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/core/nearest.hpp>
#include <cairn/pipeline/config.hpp>
#include <charconv>
#include <cmath>
#include <type_traits>

namespace cairn {
namespace {

// ---- text of values and domains ----

std::string write(bool value) {
  return value ? "true" : "false";
}

template <class Number>
requires std::is_arithmetic_v<Number> std::string write(Number value) {
  std::array<char, 64> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string write(const std::vector<PointPair>& points) {
  std::string text;
  for (const PointPair& p : points) {
    if (!text.empty()) text += ';';
    text += write(p.x_left) + ',' + write(p.y_left) + ',' + write(p.x_right) + ',' + write(p.y_right);
  }
  return text;
}

template <class E, std::size_t N>
std::string write(E value, const std::array<Choice<E>, N>& choices) {
  const auto found =
      std::find_if(choices.begin(), choices.end(), [&](const auto& c) { return c.value == value; });
  return std::string(found == choices.end() ? "?" : found->name);
}

template <class T, class Domain>
std::string write(const T& value, const Domain&) {
  return write(value);
}

template <class T>
std::string describe(const Range<T>& range) {
  std::string text = range.minus_one_is_off ? "−1 = off, " : "";
  text += write(range.lowest) + " … " + write(range.highest);
  if (range.odd_only) text += ", odd";
  return text;
}

template <class E, std::size_t N>
std::string describe(const std::array<Choice<E>, N>& choices) {
  std::string text;
  for (const auto& choice : choices) text += (text.empty() ? "" : "|") + std::string(choice.name);
  return text;
}

std::string type_name(bool) {
  return "bool";
}
std::string type_name(int) {
  return "int";
}
std::string type_name(float) {
  return "float";
}
std::string type_name(const std::vector<PointPair>&) {
  return "points";
}
template <class E>
requires std::is_enum_v<E> std::string type_name(E) {
  return "choice";
}

std::string describe_any(bool) {
  return "true|false";
}
std::string describe_any(const std::vector<PointPair>&) {
  return "x_left,y_left,x_right,y_right;…";
}

template <class T, class Domain>
std::string domain_of(const T& value, const Domain& domain) {
  if constexpr (std::is_same_v<Domain, Any>) {
    return describe_any(value);
  } else {
    return describe(domain);
  }
}

// ---- reading values ----

[[noreturn]] void refuse(const std::string& option, std::string_view found, const std::string& expected) {
  throw Error("option " + option + ": found '" + std::string(found.substr(0, 80)) + "', expected " +
              expected);
}

template <class Number>
bool parse_number(std::string_view text, Number& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() &&
         std::isfinite(static_cast<double>(value));
}

template <class T>
void check(const std::string& option, T value, const Range<T>& range) {
  const bool off = range.minus_one_is_off && value == T{-1};
  const bool inside = value >= range.lowest && value <= range.highest;  // NaN is not
  bool parity = true;
  if constexpr (std::is_integral_v<T>) parity = !range.odd_only || value % 2 == 1;
  if (!off && !(inside && parity)) refuse(option, write(value), describe(range));
}
void check(const std::string&, bool, Any) {}
void check(const std::string& option, const std::vector<PointPair>& points, Any) {
  for (const PointPair& p : points) {
    if (!std::isfinite(p.x_left + p.y_left + p.x_right + p.y_right)) {
      refuse(option, write(points), "finite coordinates");
    }
  }
}
template <class E, std::size_t N>
void check(const std::string& option, E value, const std::array<Choice<E>, N>& choices) {
  const bool known =
      std::any_of(choices.begin(), choices.end(), [&](const auto& c) { return c.value == value; });
  if (!known) refuse(option, std::to_string(static_cast<int>(value)), describe(choices));
}

void read(const std::string& option, std::string_view text, bool& value, Any) {
  if (text == "true" || text == "on" || text == "yes" || text == "1") {
    value = true;
  } else if (text == "false" || text == "off" || text == "no" || text == "0") {
    value = false;
  } else {
    refuse(option, text, "true or false");
  }
}

template <class T>
void read(const std::string& option, std::string_view text, T& value, const Range<T>& range) {
  T parsed{};
  if (!parse_number(text, parsed)) {
    refuse(option, text, (std::is_integral_v<T> ? "a whole number, " : "a number, ") + describe(range));
  }
  check(option, parsed, range);
  value = parsed;
}

template <class E, std::size_t N>
void read(const std::string& option, std::string_view text, E& value,
          const std::array<Choice<E>, N>& choices) {
  const auto found =
      std::find_if(choices.begin(), choices.end(), [&](const auto& c) { return c.name == text; });
  if (found == choices.end()) refuse(option, text, "one of " + describe(choices));
  value = found->value;
}

PointPair read_pair(const std::string& option, std::string_view text) {
  std::array<float, 4> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::size_t comma = i + 1 < numbers.size() ? text.find(',') : text.size();
    if (comma == std::string_view::npos || !parse_number(text.substr(0, comma), numbers[i])) {
      refuse(option, text, "x_left,y_left,x_right,y_right");
    }
    text.remove_prefix(std::min(text.size(), comma + 1));
  }
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

void read(const std::string& option, std::string_view text, std::vector<PointPair>& value, Any) {
  std::vector<PointPair> points;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(';'), text.size());
    points.push_back(read_pair(option, text.substr(0, end)));
    text.remove_prefix(std::min(text.size(), end + 1));
  }
  value = std::move(points);
}

// ---- walking the options ----

/// Calls visit(full name, value, unit, help, domain) for every option.
template <class C, class F>
void for_each_option(C& config, F&& visit) {
  for_each_section(config, [&](std::string_view section, auto& stage) {
    fields(stage, [&](std::string_view name, auto& value, std::string_view unit, std::string_view help,
                      const auto& domain) {
      visit(std::string(section) + '.' + std::string(name), value, unit, help, domain);
    });
  });
}

void require_evidence(const Config& c) {
  const auto refuse_if = [&](bool needed, Evidence least, const char* option) {
    if (!needed || c.match.evidence >= least) return;
    throw Error("option match.evidence: " + write(c.match.evidence, kEvidences) + " keeps too little for " +
                option + "; set match.evidence=" + write(least, kEvidences) + ", or " + option + "=-1");
  };
  refuse_if(c.uniqueness.ratio >= 0, Evidence::minimum, "uniqueness.ratio");
  refuse_if(c.flatness.threshold >= 0, Evidence::full, "flatness.threshold");
  if (c.match.evidence < Evidence::full && c.left_right.max_diff >= 0 &&
      c.left_right.method == LeftRightMethod::true_) {
    throw Error("option match.evidence: " + write(c.match.evidence, kEvidences) +
                " keeps no right image's winners for left_right.method=true; set match.evidence=full, "
                "left_right.method=vote, or left_right.max_diff=-1");
  }
}

}  // namespace

std::vector<OptionInfo> options(const Config& config) {
  std::vector<OptionInfo> all;
  Config copy = config;  // fields() takes its struct by reference to non-const
  for_each_option(copy, [&](std::string name, const auto& value, std::string_view unit, std::string_view help,
                            const auto& domain) {
    all.push_back({std::move(name), type_name(value), write(value, domain), std::string(unit),
                   domain_of(value, domain), std::string(help)});
  });
  return all;
}

void set(Config& config, std::string_view name, std::string_view value) {
  bool found = false;
  for_each_option(config, [&](const std::string& option, auto& current, std::string_view, std::string_view,
                              const auto& domain) {
    if (option != name) return;
    found = true;
    read(option, value, current, domain);
  });
  if (found) return;
  std::vector<std::string> names;
  for (const OptionInfo& option : options(config)) names.push_back(option.name);
  const std::string close = nearest(name, names);
  throw Error("unknown option '" + std::string(name.substr(0, 80)) + "'" +
              (close.empty() ? "; cairn config lists them" : ", did you mean '" + close + "'?"));
}

std::vector<std::string> preset_names() {
  return {"default", "paper"};
}

Config Config::preset(std::string_view name) {
  if (name == "default") return {};
  if (name == "paper") return paper();
  const std::string close = nearest(name, preset_names());
  throw Error("unknown preset '" + std::string(name.substr(0, 80)) + "', expected default or paper" +
              (close.empty() ? "" : "; did you mean '" + close + "'?"));
}

Config Config::paper() {
  Config c;
  c.epipolar_correction = {};
  c.match = {};
  c.subpixel = {};
  c.left_right = {};
  c.uniqueness = {.ratio = 5.0F};
  c.flatness = {};
  c.texture = {.threshold = 1.0F};
  c.ground.label_floor = false;
  c.speckle.size = -1;
  c.disparity.mean_difference_max = 0.75F;
  c.fusion = {};
  c.objects = {};
  return c;
}

void validate(const Config& config) {
  Config copy = config;
  for_each_option(copy, [](const std::string& name, const auto& value, std::string_view, std::string_view,
                           const auto& domain) { check(name, value, domain); });
  require_evidence(config);
  if (config.ground.source == GroundSource::points) (void)ground_from_points(config.ground.points);
}

void validate(const Config& config, Size image, bool has_rig) {
  validate(config);
  const int window = config.match.window_size;
  if (window > image.width || window > image.height) {
    throw Error("option match.window_size: a window of " + write(window) + " px does not fit an image of " +
                text(image));
  }
  const int first = config.match.min_disparity;
  const int last = first + config.match.num_disparities - 1;
  if (config.match.num_disparities > image.width) {
    throw Error("option match.num_disparities: " + write(config.match.num_disparities) +
                " disparities are more than the image is wide (" + write(image.width) + " px)");
  }
  if (first >= image.width || last <= -image.width) {
    throw Error("option match.min_disparity: disparities " + write(first) + " … " + write(last) +
                " lie outside an image " + write(image.width) + " px wide");
  }
  if (config.ground.source == GroundSource::pose && !has_rig) {
    throw Error(
        "option ground.source: a ground from the camera's pose needs a calibration; give one (--calib)");
  }
}

}  // namespace cairn
