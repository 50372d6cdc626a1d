// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/core/nearest.hpp>
#include <cairn/pipeline/config.hpp>
#include <cairn/pipeline/option_walk.hpp>

namespace cairn {

std::vector<OptionInfo> options(const Config& config) {
  return option_walk::options_of(config);
}

std::vector<OptionInfo> active_options(const Config& config) {
  std::vector<OptionInfo> all = options(config);
  std::erase_if(all, [](const OptionInfo& option) { return !option.active; });
  return all;
}

void require_active(const Config& config, std::string_view name, const std::vector<std::string>& sections) {
  option_walk::require_active_of(config, name, sections);
}

void set(Config& config, std::string_view name, std::string_view value) {
  if (option_walk::set_known(config, name, value)) return;
  option_walk::refuse_unknown(name, options(config));
}

Reject reasons_in_force(const Config& config, bool external_disparity) {
  Reject all = external_disparity ? Reject::no_data : Reject::border;
  const auto add = [&](bool is_on, Reject reason) { all |= is_on ? reason : Reject::none; };
  for_each_check(config, [&](const char*, Reject reason, const auto&, const auto&, bool is_on) {
    add(!external_disparity && is_on, reason);
  });
  add(config.ground.source != GroundSource::off, Reject::below_ground);
  add(config.speckle.size > 0, Reject::speckle);
  add(config.pipeline.method == Method::region_tree && config.ground.source != GroundSource::off,
      Reject::sky);
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

// Fitted by lab/search_paper.cpp.
Config Config::paper() {
  Config c;
  c.pipeline.method = Method::paper;
  c.epipolar_correction = {};
  c.match = {};
  c.subpixel = {};
  c.left_right = {};
  c.uniqueness = {.ratio = 10.0F};
  c.flatness = {};
  c.texture = {.threshold = 2.0F};
  c.ground.margin = 0.75F;
  c.speckle.size = -1;
  c.intensity.gradient_threshold = 4.0F;
  c.disparity.gradient_threshold = 0.25F;
  c.disparity.mean_difference_max = 1.5F;
  c.disparity.deviation_max = 1.5F;
  c.objects = {.min_area = 0.5F};
  return c;
}

void validate(const Config& config) {
  option_walk::check_ranges(config);
  if (config.match.maps != MatchMaps::full)
    throw Error("match.maps: found less than full, expected full (only match() by itself accepts less)");
  validate(config.ground, true);
}

void validate(const Config& config, Size image, bool has_rig) {
  validate(config);
  const int window = config.match.window_size;
  const bool has_window = config.match.method == MatchMethod::window;
  if (has_window && (window > image.width || window > image.height)) {
    throw Error("option match.window_size: a window of " + option_walk::write(window) +
                " px does not fit into an image of " + text(image));
  }
  constexpr int kMin = 3;  // px
  if (!has_window && (image.width < kMin || image.height < kMin)) {
    throw Error("option match.method: semi_global needs an image of at least 3x3, found one of " +
                text(image));
  }
  const int first = config.match.min_disparity;
  const int last = first + config.match.num_disparities - 1;
  if (config.match.num_disparities > image.width) {
    throw Error("option match.num_disparities: " + option_walk::write(config.match.num_disparities) +
                " disparities exceed the image width (" + option_walk::write(image.width) + " px)");
  }
  if (first >= image.width || last <= -image.width) {
    throw Error("option match.min_disparity: disparities " + option_walk::write(first) + " … " +
                option_walk::write(last) + " are outside of an image " + option_walk::write(image.width) +
                " px wide");
  }
  validate(config.ground, has_rig);
}

}  // namespace cairn
