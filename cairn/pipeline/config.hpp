// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/disparity/flatness.hpp>
#include <cairn/disparity/left_right.hpp>
#include <cairn/disparity/speckle.hpp>
#include <cairn/disparity/texture.hpp>
#include <cairn/disparity/uniqueness.hpp>
#include <cairn/grouping/evidence.hpp>
#include <cairn/grouping/superpixels.hpp>
#include <cairn/matching/epipolar_correction.hpp>
#include <cairn/matching/match.hpp>
#include <cairn/matching/semi_global.hpp>
#include <cairn/matching/subpixel.hpp>
#include <cairn/objects/fuse.hpp>
#include <cairn/objects/measure.hpp>
#include <cairn/objects/space.hpp>
#include <cairn/regions/segment_disparity.hpp>
#include <cairn/regions/segment_intensity.hpp>
#include <cairn/scene/background.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace cairn {

/// What is computed: one section per stage. A default-constructed Config is the preset `default`.
struct Config {
  EpipolarCorrectionConfig epipolar_correction{.max_rows = 4.0F};
  MatchConfig match{.method = MatchMethod::semi_global};
  SemiGlobalConfig semi_global;
  SubpixelConfig subpixel{.method = SubpixelMethod::equiangular};
  LeftRightConfig left_right{.max_diff = 2.0F};
  UniquenessConfig uniqueness{.ratio =
                                  -1.0F};  // the three are the window's checks: semi-global sums are smooth,
  FlatnessConfig flatness{.threshold = -1.0F};  // and evidence asks for texture itself
  TextureConfig texture{.threshold = -1.0F};
  GroundConfig ground;
  SpeckleConfig speckle;
  EvidenceConfig evidence;
  BackgroundConfig background;
  IntensityConfig intensity;
  DisparityConfig disparity;
  FusionConfig fusion{.method = FusionMethod::hierarchy};
  SuperpixelsConfig superpixels;
  ObjectsConfig objects{.min_area = 0.25F, .min_confidence = 0.3F};
  SpaceConfig space;

  /// Only what the paper describes; the thresholds are ours, fitted by fitting/search_paper.cpp.
  static Config paper();
  /// The presets by name: "default", "paper". Throws Error naming the known ones.
  static Config preset(std::string_view name);
};

/// Calls visit("match", c.match), … for every section, in data-flow order.
template <class C, class F>
void for_each_section(C& c, F&& visit) {
  visit("epipolar_correction", c.epipolar_correction);
  visit("match", c.match);
  visit("semi_global", c.semi_global);
  visit("subpixel", c.subpixel);
  visit("left_right", c.left_right);
  visit("uniqueness", c.uniqueness);
  visit("flatness", c.flatness);
  visit("texture", c.texture);
  visit("ground", c.ground);
  visit("speckle", c.speckle);
  visit("evidence", c.evidence);
  visit("background", c.background);
  visit("intensity", c.intensity);
  visit("disparity", c.disparity);
  visit("fusion", c.fusion);
  visit("superpixels", c.superpixels);
  visit("objects", c.objects);
  visit("space", c.space);
}

/// One option as the reference page, the command line and bindings present it.
struct OptionInfo {
  std::string name;    // "match.window_size"
  std::string type;    // "int", "float", "bool", "choice"
  std::string value;   // as set() would read it
  std::string unit;    // may be empty
  std::string domain;  // "3 … 31, odd", "−1 = off, 0 … 64", "sad|ssd|…"
  std::string help;
  std::string needs;   // "match.method=window", "speckle.size!=-1": read only while so; empty: always
  bool active = true;  // whether `config` reads it: what it needs is so, and is itself read
};

/// Every option of `config`, in order.
std::vector<OptionInfo> options(const Config& config);
/// Those of them that it reads.
std::vector<OptionInfo> active_options(const Config& config);
/// Sets one option from its text. Throws Error: unknown name (names the nearest known one), one that is gone
/// (says where it went), not of its type, out of range (names the range). Sets an option that is not read as
/// well, since what it needs may be set later: who has set all asks require_active().
void set(Config& config, std::string_view name, std::string_view value);
/// Throws Error where `config` does not read the option, in one line that says what to set first. With
/// `sections` only what options of these sections ask for counts: for a stage by itself.
void require_active(const Config& config, std::string_view name,
                    const std::vector<std::string>& sections = {});
/// The reasons for which this configuration can refuse a pixel, or one of a map from elsewhere.
Reject reasons_in_force(const Config& config, bool external_disparity = false);
/// The names of the presets.
std::vector<std::string> preset_names();
/// Throws Error where a value lies outside its range, where match.maps leaves out what the method needs, or
/// where the ground's source is something that is not known (fewer than four points, points on a line, no
/// height of the camera).
void validate(const Config& config);
/// The same, and against an image: the window, or 3x3 pixels, must fit, a disparity must be possible, a pose
/// needs a rig.
void validate(const Config& config, Size image, bool has_rig);

}  // namespace cairn
