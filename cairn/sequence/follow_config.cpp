// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/pipeline/option_walk.hpp>

#include <cairn/sequence/follow_config.hpp>

namespace cairn {

std::vector<OptionInfo> options(const FollowConfig& config) {
  return option_walk::options_of(config);
}

bool is_of_following(std::string_view option) {
  bool found = false;
  FollowConfig config;
  const std::string_view section = option.substr(0, option.find('.'));
  std::size_t of_segmentation = 0;
  for_each_section(config.segmentation, [&](std::string_view, auto&) { ++of_segmentation; });
  for_each_section(config, [&](std::string_view name, auto&) {
    if (of_segmentation > 0) {
      --of_segmentation;
    } else if (name == section) {
      found = true;
    }
  });
  return found;
}

void set(FollowConfig& config, std::string_view name, std::string_view value) {
  if (option_walk::set_known(config, name, value)) return;
  option_walk::refuse_unknown(name, options(config));
}

void require_active(const FollowConfig& config, std::string_view name) {
  option_walk::require_active_of(config, name, {});
}

void validate(const FollowConfig& config) {
  validate(config.segmentation);
  option_walk::check_ranges(config);
  const TrackingConfig& t = config.tracking;
  const LandmarksConfig& l = config.landmarks;
  const OdometryConfig& o = config.odometry;
  if (o.max_features < o.min_inliers) {
    throw Error("option odometry.max_features: " + option_walk::write(o.max_features) +
                " is less than odometry.min_inliers, " + option_walk::write(o.min_inliers));
  }
  if (l.min_frames < t.min_hits) {
    throw Error("option landmarks.min_frames: " + option_walk::write(l.min_frames) +
                " is less than tracking.min_hits, " + option_walk::write(t.min_hits));
  }
}

}  // namespace cairn
