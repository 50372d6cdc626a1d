// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "follow_options.hpp"

#include <set>

namespace cairn::cli {

FollowConfig resolve_follow(const ConfigOptions& options, std::optional<int> calibrated_disparities,
                            KnownGround ground) {
  FollowConfig config;
  std::set<std::string> own;
  const auto elsewhere = [&](std::string_view name, std::string_view value) {
    if (!is_of_following(name)) return false;
    set(config, name, value);
    own.emplace(name);
    return true;
  };
  config.segmentation = resolve(options, calibrated_disparities, elsewhere).config;
  config.segmentation.ground.known = std::move(ground);
  validate(config);
  for (const std::string& name : own) require_active(config, name);
  return config;
}

std::string preset_of(const ConfigOptions& options) {
  return resolve(options, std::nullopt,
                 [](std::string_view name, std::string_view /*value*/) { return is_of_following(name); })
      .preset;
}

std::vector<OptionInfo> sequence_options(const ConfigOptions& config) {
  std::vector<OptionInfo> own;
  for (const OptionInfo& option : options(resolve_follow(config))) {
    if (is_of_following(option.name)) own.push_back(option);
  }
  return own;
}

std::string control_line(const ControlEvent& event) {
  return "steadier setting: " + event.arm.option + "=" + event.arm.value +
         (event.is_set ? ", set (was " : " (now ") + event.before + "), by " + percent(event.lead);
}

}  // namespace cairn::cli
