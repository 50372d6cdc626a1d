// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/image/gradient.hpp>
#include <cairn/image/noise.hpp>
#include <cairn/objects/floor_probability.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/objects/refine_objects.hpp>
#include <cairn/objects/sky.hpp>
#include <cairn/regions/choose_objects.hpp>
#include <cairn/regions/grow_near_to_far.hpp>
#include <cairn/regions/grow_statistical.hpp>
#include <cairn/regions/object_hints.hpp>
#include <cairn/stereo/confidence.hpp>
#include <variant>

#include "bindings.hpp"
#include "values.hpp"

namespace cairn::python {
namespace {

// ---- a stage's parameters, by their types ----

/// What a stage is called with.
struct CallArguments {
  const Config& config;
  const Exec& exec;
  const py::args& values;
  std::size_t next = 0;

  py::object value() { return values[next++]; }
};

/// The next of the caller's arguments.
template <class P>
struct ArgumentOf {
  py::detail::make_caster<P> made;
  void take(CallArguments& given) {
    if (!made.load(given.value(), true))
      throw py::cast_error("argument " + std::to_string(given.next) + " does not fit");
  }
  decltype(auto) get() { return py::detail::cast_op<P&>(made); }
};
/// A section of the configuration.
template <class P>
concept Section = requires(P& section) {
  fields(section, [](auto&&...) {});
};
template <Section P>
struct ArgumentOf<P> {
  const P* section = nullptr;
  void take(const CallArguments& given) {
    for_each_section(given.config, [&]<class Other>(const char*, const Other& other) {
      if constexpr (std::is_same_v<Other, P>) section = &other;
    });
  }
  const P& get() const { return *section; }
};
template <>
struct ArgumentOf<Exec> {
  const Exec* exec = nullptr;
  void take(const CallArguments& given) { exec = &given.exec; }
  [[nodiscard]] const Exec& get() const { return *exec; }
};
/// The colours of the image before.
template <>
struct ArgumentOf<View<const Rgb>> {
  View<const Rgb> rgb;
  void take(const CallArguments& given) {
    rgb = py::object(given.values[given.next - 1]).cast<const LoadedImage&>().rgb();
  }
  [[nodiscard]] View<const Rgb> get() const { return rgb; }
};
/// An image, and its noise: the last number of the caller's arguments.
template <>
struct ArgumentOf<LeftImage> {
  LeftImage left;
  void take(CallArguments& given) {
    const auto& picture = given.value().cast<const LoadedImage&>();
    std::size_t last = given.values.size() - 1;
    while (!py::isinstance<py::float_>(given.values[last])) --last;
    left = {picture.gray(), picture.rgb(), py::object(given.values[last]).cast<float>()};
  }
  [[nodiscard]] const LeftImage& get() const { return left; }
};
template <>
struct ArgumentOf<ObstacleCues> {
  std::optional<ObstacleCues> cues;
  void take(CallArguments& given) {
    const auto& objects = given.value().cast<const Objects&>();
    const auto& disparity = given.value().cast<const DisparityMap&>();
    const auto confidence = given.value().cast<View<const float>>();
    const auto& ground = given.value().cast<const Ground&>();
    const auto& background = given.value().cast<const Background&>();
    const auto surface_disparity_px = given.value().cast<View<const float>>();
    cues.emplace(
        ObstacleCues{disparity, surface_disparity_px, confidence, ground, background, {}, objects.labels});
  }
  [[nodiscard]] const ObstacleCues& get() const { return *cues; }
};
template <>
struct ArgumentOf<SkyCues> {
  std::optional<SkyCues> cues;
  void take(CallArguments& given) {
    const auto& left = given.value().cast<const LoadedImage&>();
    const auto confidence = given.value().cast<View<const float>>();
    const auto& ground = given.value().cast<const Ground&>();
    const auto& superpixels = given.value().cast<const Superpixels&>();
    cues.emplace(SkyCues{left.gray(), confidence, ground, superpixels.labels,
                         given.value().cast<const Objects&>().labels});
  }
  [[nodiscard]] const SkyCues& get() const { return *cues; }
};
/// Two images of the same size, valid for the configuration. The source of the ground is irrelevant here.
template <>
struct ArgumentOf<StereoPair> {
  std::optional<StereoPair> pair;
  void take(CallArguments& given) {
    const auto& left = given.value().cast<const LoadedImage&>();
    const auto& right = given.value().cast<const LoadedImage&>();
    pair = StereoPair::from(left.gray(), right.gray(), left.rgb());
    Config any_ground = given.config;
    any_ground.ground = {};
    validate(any_ground, pair->size(), true);
  }
  [[nodiscard]] const StereoPair& get() const { return *pair; }
};

DisparityMap cloned(const DisparityMap& map, const Pool& pool) {
  return {map.disparity_px.clone(pool), map.reject.clone(pool)};
}
Objects cloned(const Objects& objects, const Pool& pool) {
  return {objects.labels.clone(pool), objects.list};
}
RefinedDisparity cloned(const RefinedDisparity& refined, const Pool& pool) {
  return {refined.disparity_px.clone(pool), refined.confidence.clone(pool)};
}
template <class P, class V>
decltype(auto) argument(V&& value, const Exec& exec) {
  if constexpr (std::is_reference_v<P> || std::is_copy_constructible_v<P>) {
    return std::forward<V>(value);
  } else {
    return cloned(value, exec.pool);
  }
}

template <class P>
void note_group(py::list& groups) {
  if constexpr (Section<P>) {
    const Config all;
    for_each_section(all, [&]<class Other>(const char* name, const Other&) {
      if constexpr (std::is_same_v<Other, P>) groups.append(name);
    });
  }
}

/// A stage as `name(config, exec, arguments…)`; its sections are the groups of its keywords.
template <class R, class... P>
void stage(py::module_& m, const char* name, R (*function)(P...)) {
  m.def(name, [function](const PyConfig& config, const Exec& exec, const py::args& values) {
    CallArguments given{config.config, exec, values};
    std::tuple<ArgumentOf<std::remove_cvref_t<P>>...> passed;
    return std::apply(
        [&](auto&... p) {
          (p.take(given), ...);
          return released([&] { return function(argument<P>(p.get(), exec)...); });
        },
        passed);
  });
  py::list groups;
  (note_group<std::remove_cvref_t<P>>(groups), ...);
  m.attr("stage_groups")[name] = groups;
}

// ---- stages whose C++ functions take more, or other types ----

using GreyOrSixteenths = std::variant<View<const std::int16_t>, View<const Gray>>;

/// One row with as many pixels as the tree's superpixels have: only the image's area matters.
Size size_of(const MergeTree& tree) {
  std::int64_t area = 0;
  for (int i = 0; i < tree.superpixels; ++i) area += tree.nodes[slot(i)].area;
  return {static_cast<int>(area), 1};
}

template <Merges (*grow)(const RegionGraph&, const GrowCriteria&, const Exec&)>
Numbers<std::int32_t> grown(const RegionGraph& graph, double mean_difference_max, double deviation_max,
                            double sigma_min, int min_region_area, const Exec& exec) {
  return {grow(graph, {mean_difference_max, deviation_max, sigma_min, min_region_area}, exec)};
}

Image<ObjectHint> hints(const LeftImage& left, const DisparityMap& disparity, View<const float> textured_px,
                        const Ground& ground, const Background& background, const Exec& exec) {
  const Image<std::uint16_t> edges = superpixel_edges(left, exec);
  return hint_objects(edges, {left, disparity.disparity_px, textured_px, ground, background}, exec);
}

Superpixels superpixels(const LeftImage& left, View<const float> disparity_px, float /*of left*/,
                        View<const ObjectHint> hints, const SuperpixelsConfig& config, const Exec& exec) {
  return cut_superpixels(superpixel_edges(left, exec), hints, disparity_px, left.noise_sigma, config, exec);
}

MergeTree merge_tree(const Superpixels& superpixels, const LeftImage& left, const DisparityMap& disparity,
                     View<const float> textured_px, const Ground& ground, const Background& background,
                     const Exec& exec) {
  Cues cues{left, disparity.disparity_px, textured_px, ground, background};
  const Image<ObjectHint> found = hint_objects(superpixels.edges, cues, exec);
  cues.hints = found;
  return grow_merge_tree(superpixels, cues, merge_classifier(), exec);
}

RefinedDisparity refined(const Superpixels& superpixels, const MergeTree& tree, const ChosenObjects& chosen,
                         const LeftImage& left, const DisparityMap& disparity, View<const float> textured_px,
                         const Ground& ground, const Background& background, View<const float> confidence,
                         View<const ObjectHint> hints, const Exec& exec) {
  std::vector<std::int64_t> areas(slot(superpixels.count));
  for (int y = 0; y < superpixels.labels.height(); ++y) {
    for (int x = 0; x < superpixels.labels.width(); ++x) ++areas[index(superpixels.labels(x, y))];
  }
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const RegionCues& region = tree.superpixel_cues.regions[i];
    if (region.area != areas[i] || region.right >= superpixels.labels.width() ||
        region.bottom >= superpixels.labels.height())
      throw Error("tree: was grown from other superpixels");
  }
  const Cues cues{left, disparity.disparity_px, textured_px, ground, background, hints};
  return refine_disparity({superpixels, tree, chosen, cues, confidence}, plane_classifier(), exec);
}

Image<float> likely_floor(const ObstacleCues& cues, const Superpixels& superpixels,
                          const RefinedDisparity& refined, View<const ObjectHint> hints,
                          const std::optional<StereoRig>& rig, const GroundConfig& config, const Exec& exec) {
  ObstacleCues all = cues;
  all.superpixels = superpixels.labels;
  all.refined_px = refined.disparity_px;
  all.refined_confidence = refined.confidence;
  return floor_probability(group_by_floor(all, hints, rig, config, exec), superpixels.labels,
                           floor_classifier(), exec);
}

Image<ObstacleLabel> labelled(const ObstacleCues& cues, const std::optional<StereoRig>& rig,
                              const RefinedDisparity* refined, View<const float> floor_probability,
                              const GroundConfig& config, const Exec& exec) {
  ObstacleCues all = cues;
  if (refined != nullptr) {
    all.refined_px = refined->disparity_px;
    all.refined_confidence = refined->confidence;
  }
  all.floor_probability = floor_probability;
  return label_obstacles(all, rig, config, exec);
}

DisparityMap combined(View<const float> refined_px, const std::vector<View<const Reject>>& verdicts,
                      const Exec& exec) {
  return combine(copied(refined_px, exec.pool), verdicts, exec);
}

Ground ground_of(const std::variant<const DisparityMap*, View<const float>>& disparity,
                 const std::optional<StereoRig>& rig, View<const Gray> left, const GroundConfig& config,
                 const Exec& exec) {
  validate(config, rig.has_value());
  if (const auto* map = std::get_if<const DisparityMap*>(&disparity))
    return fit_ground(**map, rig, config, exec);
  return fit_ground(std::get<View<const float>>(disparity), rig, config, exec, left);
}

Ground likely(const Ground& ground, const DisparityMap& disparity, const std::optional<StereoRig>& rig,
              View<const float> textured_px, View<const Gray> left, const GroundConfig& config,
              const Exec& exec) {
  validate(config, rig.has_value());
  return likely_ground(ground, disparity, rig, config, exec, textured_px, left);
}

// ---- the stages ----

/// The checks: name of the stage, name of the reason, and whether they judge the image, not its matches.
py::list bind_checks(py::module_& m) {
  py::list checks;
  for_each_check(
      Config(), [&]<class Input, class Section>(const char* name, Reject reason,
                                                Image<Reject> (*check)(Input, const Section&, const Exec&),
                                                const Section&, bool) {
        stage(m, name, check);
        checks.append(
            py::make_tuple(name, choice_name(reason, kRejects), std::is_same_v<Input, View<const Gray>>));
      });
  return checks;
}

void bind_disparities(py::module_& m) {
  stage(m, "find_epipolar_offset", &find_epipolar_offset);
  stage(m, "shift_rows", &shift_rows);
  stage(m, "correct_epipolar", &correct_epipolar);
  stage(m, "match", &match);
  stage(m, "match_windows", &match_windows);
  stage(m, "match_semi_global", &match_semi_global);
  stage(m, "refine_subpixel", &refine_subpixel);
  m.attr("CHECKS") = bind_checks(m);
  stage(m, "combine", &combined);
  stage(m, "external_disparity", &external_disparity);
  stage(m, "noise_sigma", &noise_sigma);
  stage(
      m, "select_textured", +[](const LeftImage& left, const DisparityMap& map, const Exec& exec) {
        return select_textured(left, map, {}, exec);
      });
  stage(m, "reject_speckles", &reject_speckles);
  stage(
      m, "estimate_confidence",
      +[](const Matches& matches, const DisparityMap& map, const MatchConfig& config, const Exec& exec) {
        return estimate_confidence(matches, map, confidence_model(config.method), exec);
      });
}

void bind_floor_and_walls(py::module_& m) {
  stage(m, "fit_ground", &ground_of);
  stage(m, "reject_below_ground", &reject_below_ground);
  stage(m, "label_floor", &label_floor);
  stage(m, "likely_ground", &likely);
  stage(m, "floor_under_reflections", &floor_under_reflections);
  stage(m, "fit_background", &fit_background);
}

void bind_regions(py::module_& m) {
  stage(
      m, "gradient", +[](const GreyOrSixteenths& image, float smoothing_sigma, const Exec& exec) {
        return std::visit([&](auto view) { return gradient(view, smoothing_sigma, exec); }, image);
      });
  stage(m, "edge_strength", &edge_strength);
  stage(m, "quantised", &quantised);
  stage(m, "watershed", &watershed);
  stage(
      m, "build_graph",
      +[](View<const RegionId> labels, int count, const GreyOrSixteenths& values,
          View<const std::uint8_t> floor, const Exec& exec) {
        if (const auto* grey = std::get_if<View<const Gray>>(&values))
          return build_graph(labels, count, *grey, exec);
        return build_graph(labels, count, std::get<View<const std::int16_t>>(values), floor, exec);
      });
  stage(m, "grow_statistical", &grown<&grow_statistical>);
  stage(m, "grow_near_to_far", &grown<&grow_near_to_far>);
  stage(m, "apply_merges", &apply_merges);
  stage(m, "segment_intensity", &segment_intensity);
  stage(m, "segment_disparity", &segment_disparity);
  stage(m, "fuse", &fuse);
}

void bind_region_tree(py::module_& m) {
  stage(m, "cut_superpixels", &superpixels);
  stage(m, "superpixel_regions", &superpixel_regions);
  stage(m, "hint_objects", &hints);
  stage(m, "grow_merge_tree", &merge_tree);
  stage(
      m, "choose_objects", +[](const MergeTree& tree, const ObjectsConfig& config, const Exec& exec) {
        return choose_objects(tree, object_classifier(), limits_of(config, size_of(tree)), exec);
      });
  stage(m, "object_regions", &object_regions);
  stage(m, "refine_disparity", &refined);
  stage(m, "without_sky", &without_sky);
  stage(m, "likely_disparities", &likely_disparities);
}

void bind_objects(py::module_& m) {
  stage(m, "measure",
        py::overload_cast<View<const RegionId>, const std::vector<bool>&, const DisparityMap&,
                          const LeftImage&, const ObjectsConfig&, const Exec&>(&measure));
  stage(m, "measure_chosen",
        py::overload_cast<View<const RegionId>, const std::vector<float>&, const DisparityMap&,
                          const LeftImage&, const Exec&>(&measure));
  stage(
      m, "refine_objects",
      +[](Objects objects, const DisparityMap& disparity, View<const Gray> left, View<const Gray> right,
          const Exec& exec) {
        return refine_objects(std::move(objects), disparity, left, right, disparity_bias_trees(), exec);
      });
  stage(m, "locate", &locate);
  stage(m, "reject_sky", &reject_sky);
  stage(m, "floor_probability", &likely_floor);
  stage(m, "label_obstacles", &labelled);
}

}  // namespace

void bind_stages(py::module_& m) {
  m.attr("stage_groups") = py::dict();
  bind_disparities(m);
  bind_floor_and_walls(m);
  bind_regions(m);
  bind_region_tree(m);
  bind_objects(m);
}

}  // namespace cairn::python
