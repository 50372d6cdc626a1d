// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <cairn/core/fields.hpp>
#include <cairn/objects/measure.hpp>
#include <cairn/objects/obstacles.hpp>
#include <cairn/regions/segment_disparity.hpp>
#include <cairn/regions/segment_intensity.hpp>
#include <cairn/regions/superpixels.hpp>
#include <cairn/regions/textured.hpp>
#include <cairn/scene/background.hpp>
#include <cairn/scene/ground_plane.hpp>
#include <cairn/stereo/epipolar_correction.hpp>
#include <cairn/stereo/flatness.hpp>
#include <cairn/stereo/left_right.hpp>
#include <cairn/stereo/match.hpp>
#include <cairn/stereo/semi_global.hpp>
#include <cairn/stereo/speckle.hpp>
#include <cairn/stereo/subpixel.hpp>
#include <cairn/stereo/texture.hpp>
#include <cairn/stereo/uniqueness.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace cairn {

/// The method that finds objects. paper: regions of the image and of the disparities, joined where they overlap
/// most. region_tree: superpixels are merged into a tree of regions, and the likeliest objects in it are chosen.
enum class Method : std::uint8_t { paper, region_tree };
inline constexpr std::array kMethods{Choice{"paper", Method::paper},
                                     Choice{"region_tree", Method::region_tree}};

struct PipelineConfig {
  Method method = Method::region_tree;
};
template <class V>
void fields(PipelineConfig& c, V&& v) {
  v("method", c.method, "", "paper: the paper's method; region_tree: likeliest objects of a region tree",
    kMethods);
}

/// The configuration of the method, one section per stage. A default-constructed Config is the preset
/// `default`.
struct Config {
  PipelineConfig pipeline;
  EpipolarCorrectionConfig epipolar_correction{.max_rows = 4.0F};
  MatchConfig match{.method = MatchMethod::semi_global};
  SemiGlobalConfig semi_global;
  SubpixelConfig subpixel{.method = SubpixelMethod::equiangular};
  LeftRightConfig left_right{.max_diff = 2.0F};
  // The next three checks are for windows: semi-global costs are smooth, and textured disparities are selected
  // by texture anyway.
  UniquenessConfig uniqueness{.ratio = -1.0F};
  FlatnessConfig flatness{.threshold = -1.0F};
  TextureConfig texture{.threshold = -1.0F};
  GroundConfig ground;
  SpeckleConfig speckle;
  TexturedConfig textured;
  BackgroundConfig background;
  IntensityConfig intensity;
  DisparityConfig disparity;
  SuperpixelsConfig superpixels;
  ObjectsConfig objects{.min_confidence = 0.35F};
  ObstaclesConfig obstacles;

  /// The method of the paper; the thresholds are ours, fitted by lab/search_paper.cpp.
  static Config paper();
  /// A preset by name: "default", "paper". Throws Error naming the known ones.
  static Config preset(std::string_view name);
};

/// Calls visit("match", c.match), … for every section, in data-flow order.
template <class C, class F>
void for_each_section(C& c, F&& visit) {
  visit("pipeline", c.pipeline);
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
  visit("background", c.background);
  visit("intensity", c.intensity);
  visit("disparity", c.disparity);
  visit("superpixels", c.superpixels);
  visit("objects", c.objects);
  visit("obstacles", c.obstacles);
}

/// Calls visit(name of the stage, its bit, function, section, whether it is on) for every check of a match, in
/// data-flow order. The pipeline, the reasons in force and Python take the checks from here.
template <class F>
void for_each_check(const Config& c, F&& visit) {
  visit("reject_inconsistent", Reject::left_right, reject_inconsistent, c.left_right,
        c.left_right.max_diff >= 0);
  visit("reject_ambiguous", Reject::not_unique, reject_ambiguous, c.uniqueness, c.uniqueness.ratio >= 0);
  visit("reject_flat", Reject::flat, reject_flat, c.flatness, c.flatness.threshold >= 0);
  visit("reject_textureless", Reject::no_texture, reject_textureless, c.texture, c.texture.threshold >= 0);
}

/// One option, for the reference page, the command line and bindings.
struct OptionInfo {
  std::string name;    // "match.window_size"
  std::string type;    // "int", "float", "bool", "choice"
  std::string value;   // as accepted by set()
  std::string unit;    // may be empty
  std::string domain;  // "3 … 31, odd", "−1 = off, 0 … 64", "sad|ssd|…"
  std::string help;
  std::string needs;   // "match.method=window", "speckle.size!=-1": its condition; empty: always read
  bool active = true;  // whether `config` reads it: `needs` holds, and its option is itself read
};

/// Every option of `config`, in order.
std::vector<OptionInfo> options(const Config& config);
/// The options that `config` reads.
std::vector<OptionInfo> active_options(const Config& config);
/// Sets one option from its text. Throws Error: unknown name (suggests the nearest known one), wrong type,
/// out of range (states the range). Also sets options that are not read,
/// since their condition may be set later: call require_active() after the last set().
void set(Config& config, std::string_view name, std::string_view value);
/// Throws Error if `config` does not read the option, stating what to set first. With `sections`, only
/// conditions on options of these sections count: for a single stage.
void require_active(const Config& config, std::string_view name,
                    const std::vector<std::string>& sections = {});
/// The reasons for which this configuration can reject a pixel, of a pair or of an external disparity map.
Reject reasons_in_force(const Config& config, bool external_disparity = false);
/// The names of the presets.
std::vector<std::string> preset_names();
/// Throws Error if a value is out of range, match.maps omits a map that the method needs, or the source of
/// the ground is not available (fewer than four points, collinear points, no camera height).
void validate(const Config& config);
/// The same, and for an image size: the window, or 3x3 pixels, must fit, some disparity must be possible, a
/// pose needs a rig.
void validate(const Config& config, Size image, bool has_rig);

}  // namespace cairn
