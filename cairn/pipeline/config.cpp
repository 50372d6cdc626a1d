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

template <class E, std::size_t N>
std::string write(E value, const std::array<Choice<E>, N>& choices) {
  return choice_name(value, choices);
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
template <class E>
requires std::is_enum_v<E> std::string type_name(E) {
  return "choice";
}

std::string describe_any(bool) {
  return "true|false";
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

// ---- walking the options ----

/// Calls visit(full name, value, unit, help, domain, condition) for every option.
template <class C, class F>
void for_each_option(C& config, F&& visit) {
  for_each_section(config, [&](std::string_view section, auto& stage) {
    fields(stage, [&](std::string_view name, auto& value, std::string_view unit, std::string_view help,
                      const auto& domain, const Condition& condition = {}) {
      visit(std::string(section) + '.' + std::string(name), value, unit, help, domain, condition);
    });
  });
}

// ---- which options are read ----

/// What decides it: an option's value, and under which condition it is read itself.
struct Read {
  std::string option;
  std::string value;
  Condition condition;
};

std::vector<Read> reads_of(const Config& config) {
  std::vector<Read> all;
  Config copy = config;  // fields() takes its struct by reference to non-const
  for_each_option(copy, [&](std::string name, const auto& value, std::string_view, std::string_view,
                            const auto& domain, const Condition& condition) {
    all.push_back({std::move(name), write(value, domain), condition});
  });
  return all;
}

const Read& find(const std::vector<Read>& all, std::string_view option) {
  return *std::find_if(all.begin(), all.end(), [&](const Read& read) { return read.option == option; });
}

std::string_view section_of(std::string_view option) {
  return option.substr(0, option.find('.'));
}

/// The condition that keeps the option from being read, the one to be met first; nullptr where none does.
/// Conditions upon options outside of `sections` are passed over (none: no section is outside).
const Condition* unmet(const std::vector<Read>& all, const Read& option,
                       const std::vector<std::string>& sections) {
  const Condition& condition = option.condition;
  if (condition.option.empty()) return nullptr;
  if (!sections.empty() &&
      std::find(sections.begin(), sections.end(), section_of(condition.option)) == sections.end())
    return nullptr;
  const Read& asked = find(all, condition.option);
  if (const Condition* before = unmet(all, asked, sections)) return before;
  return (asked.value == condition.value) == condition.equal ? nullptr : &condition;
}

std::string describe(const Condition& condition) {
  if (condition.option.empty()) return {};
  return std::string(condition.option) + (condition.equal ? "=" : "!=") + std::string(condition.value);
}

// ---- options of earlier versions ----

struct Gone {
  std::string_view option;
  std::string_view where;
};

constexpr std::array kGone{
    Gone{"match.evidence", "what the checks and the confidence need is kept"},
    Gone{"confidence.enabled", "whatever was matched has a confidence"},
    Gone{"ground.points", "it is a fact of the rig, ground_points in its calibration file (docs/formats.md)"},
    Gone{"ground.height", "it is a fact of the rig, camera_height in its calibration file (docs/formats.md)"},
    Gone{"ground.pitch", "it is a fact of the rig, camera_pitch in its calibration file (docs/formats.md)"},
    Gone{"ground.roll", "it is a fact of the rig, camera_roll in its calibration file (docs/formats.md)"}};

constexpr std::array<std::string_view, 6> kConstants{"evidence.noise_factor",       "evidence.agreement",
                                                     "background.tolerance",        "background.min_share",
                                                     "background.min_share_square", "background.max_behind"};
/// Sections of stages that there are no more.
constexpr std::array<std::string_view, 3> kGoneSections{"facets.", "figure.", "group."};

void refuse_what_is_gone(std::string_view name) {
  for (const auto& [option, where] : kGone) {
    if (option == name) throw Error("option " + std::string(name) + " is gone: " + std::string(where));
  }
  if (std::find(kConstants.begin(), kConstants.end(), name) != kConstants.end())
    throw Error("option " + std::string(name) + " is gone: it is a constant of its stage");
  for (const std::string_view section : kGoneSections) {
    if (name.starts_with(section))
      throw Error("option " + std::string(name) + " is gone: fitted scores have replaced its stage");
  }
}

}  // namespace

std::vector<OptionInfo> options(const Config& config) {
  std::vector<OptionInfo> all;
  const std::vector<Read> reads = reads_of(config);
  Config copy = config;  // fields() takes its struct by reference to non-const
  for_each_option(copy, [&](std::string name, const auto& value, std::string_view unit, std::string_view help,
                            const auto& domain, const Condition& condition) {
    const bool active = unmet(reads, reads[all.size()], {}) == nullptr;
    all.push_back({std::move(name), type_name(value), write(value, domain), std::string(unit),
                   domain_of(value, domain), std::string(help), describe(condition), active});
  });
  return all;
}

std::vector<OptionInfo> active_options(const Config& config) {
  std::vector<OptionInfo> all = options(config);
  std::erase_if(all, [](const OptionInfo& option) { return !option.active; });
  return all;
}

void require_active(const Config& config, std::string_view name, const std::vector<std::string>& sections) {
  const std::vector<Read> reads = reads_of(config);
  const Condition* const condition = unmet(reads, find(reads, name), sections);
  if (condition == nullptr) return;
  const std::string option(condition->option);
  const std::string wanted = condition->equal ? option + "=" + std::string(condition->value) : option;
  throw Error(std::string(name) + " has no effect with " + option + "=" +
              find(reads, condition->option).value + "; set " + wanted + " first");
}

void set(Config& config, std::string_view name, std::string_view value) {
  bool found = false;
  for_each_option(config, [&](const std::string& option, auto& current, std::string_view, std::string_view,
                              const auto& domain, const Condition&) {
    if (option != name) return;
    found = true;
    read(option, value, current, domain);
  });
  if (found) return;
  refuse_what_is_gone(name);
  std::vector<std::string> names;
  for (const OptionInfo& option : options(config)) names.push_back(option.name);
  const std::string close = nearest(name, names);
  throw Error("unknown option '" + std::string(name.substr(0, 80)) + "'" +
              (close.empty() ? "; cairn config lists them" : ", did you mean '" + close + "'?"));
}

Reject reasons_in_force(const Config& config, bool external_disparity) {
  Reject all = external_disparity ? Reject::no_data : Reject::border;
  const auto add = [&](bool is_on, Reject reason) { all |= is_on ? reason : Reject::none; };
  add(!external_disparity && config.left_right.max_diff >= 0, Reject::left_right);
  add(!external_disparity && config.uniqueness.ratio >= 0, Reject::not_unique);
  add(!external_disparity && config.flatness.threshold >= 0, Reject::flat);
  add(!external_disparity && config.texture.threshold >= 0, Reject::no_texture);
  add(config.ground.source != GroundSource::off, Reject::below_ground);
  add(config.speckle.size >= 0, Reject::speckle);
  return all;
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

// Fitted by fitting/search_paper.cpp.
Config Config::paper() {
  Config c;
  c.epipolar_correction = {};
  c.match = {};
  c.subpixel = {};
  c.left_right = {};
  c.uniqueness = {.ratio = 10.0F};
  c.flatness = {};
  c.texture = {.threshold = 2.0F};
  c.ground.margin = 0.75F;
  c.speckle.size = -1;
  c.intensity.smoothing_sigma = 1.5F;
  c.intensity.gradient_threshold = 4.0F;
  c.disparity.gradient_threshold = 0.25F;
  c.disparity.mean_difference_max = 1.5F;
  c.disparity.deviation_max = 1.5F;
  c.disparity.min_region_area = 1.0F;
  c.fusion = {};
  c.objects = {.min_area = 0.5F};
  return c;
}

void validate(const Config& config) {
  Config copy = config;
  for_each_option(copy, [](const std::string& name, const auto& value, std::string_view, std::string_view,
                           const auto& domain, const Condition&) { check(name, value, domain); });
  if (config.match.maps != MatchMaps::full)
    throw Error("match.maps: less than full is for match() alone, the method needs full");
  validate(config.ground, true);
}

void validate(const Config& config, Size image, bool has_rig) {
  validate(config);
  const int window = config.match.window_size;
  const bool has_window = config.match.method == MatchMethod::window;
  if (has_window && (window > image.width || window > image.height)) {
    throw Error("option match.window_size: a window of " + write(window) + " px does not fit an image of " +
                text(image));
  }
  constexpr int kLeast = 3;  // px
  if (!has_window && (image.width < kLeast || image.height < kLeast)) {
    throw Error("option match.method: semi_global needs an image of at least 3x3, found one of " +
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
  validate(config.ground, has_rig);
}

}  // namespace cairn
