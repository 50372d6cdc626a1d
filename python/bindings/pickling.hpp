// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <cairn/diagnosis/diagnose.hpp>
#include <cairn/diagnosis/synchrony.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cairn/grouping/choose_objects.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/regions/watershed.hpp>
#include <cairn/scene/floor_frame.hpp>
#include <filesystem>
#include <io/results.hpp>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "options.hpp"
#include "rig.hpp"

/// Conversion of values to the state stored by pickle and copy.deepcopy: tuples, numbers, text and arrays;
/// and back.
namespace cairn::python {

/// The result of tune(): the command's report, and the configuration to use.
struct PyTuning {
  std::string json;
  PyConfig config;
};

// ---- members of the library's structs ----

/// A struct's members as a tuple of references.
template <class T>
struct Parts;

// Naming too few or too many members does not compile, so new members cannot be forgotten.
#define CAIRN_PARTS(Type, ...)      \
  template <>                       \
  struct Parts<Type> {              \
    template <class Value>          \
    static auto of(Value& value) {  \
      auto& [__VA_ARGS__] = value;  \
      return std::tie(__VA_ARGS__); \
    }                               \
  };
CAIRN_PARTS(Size, width, height)
CAIRN_PARTS(Rect, x, y, width, height)
CAIRN_PARTS(Vec3, x, y, z)
CAIRN_PARTS(Rgb, r, g, b)
CAIRN_PARTS(StereoRig, focal, cx, cy, baseline, doffs)
CAIRN_PARTS(PointPair, x_left, y_left, x_right, y_right)
CAIRN_PARTS(KnownGround, points, camera_height, camera_pitch, camera_roll)
CAIRN_PARTS(io::Calibration, rig, image_size, num_disparities, ground, of_raw_cameras)
CAIRN_PARTS(PyCalibration, calibration, path)
CAIRN_PARTS(OptionInfo, name, type, value_text, unit, domain, help, needs, active)
CAIRN_PARTS(PyConfig, preset, config, range_given)
CAIRN_PARTS(EpipolarOffset, rows, rows_per_px, points, agreeing, outcome)
CAIRN_PARTS(EpipolarCorrection, offset, right)
CAIRN_PARTS(Matches, best, best_right, row_offset, cost, runner_up, mean_cost, cost_before, cost_after)
CAIRN_PARTS(DisparityMap, disparity, reject)
CAIRN_PARTS(GroundPlane, a, b, c)
CAIRN_PARTS(Ground, plane, support, residual, refusal)
CAIRN_PARTS(FloorFrame, forward, left, up, height)
CAIRN_PARTS(Background, planes, has_floor)
CAIRN_PARTS(Region, pixel_count, valid_count, box, mean, variance, is_floor, is_background)
CAIRN_PARTS(Segmentation, labels, regions)
CAIRN_PARTS(Basins, labels, count)
CAIRN_PARTS(RegionGraph::Node, pixel_count, valid_count, sum, squares, first_pixel, box, is_floor)
CAIRN_PARTS(RegionGraph, nodes, first_arc, arcs)
CAIRN_PARTS(Superpixels, labels, count, edges)
CAIRN_PARTS(Origin, same_thing, least_same_thing, larger_part)
CAIRN_PARTS(MergeNode, part_a, part_b, whole, area, origin, features)
CAIRN_PARTS(MergeTree, superpixels, nodes)
CAIRN_PARTS(ChosenObjects, object_of, scores, likeliest)
CAIRN_PARTS(Fusion, labels, parts, disparity_region, is_floor)
CAIRN_PARTS(Interval, low, high)
CAIRN_PARTS(FloorBox, centre, size, yaw, covariance)
CAIRN_PARTS(Object, id, box, pixel_count, disparity, valid_share, colour, edge_share, cut_share, confidence,
            sigma, position, interval, extent, box_on_floor)
CAIRN_PARTS(Objects, labels, list)
CAIRN_PARTS(SceneDisparity, disparity, ground, floor, epipolar, confidence)
CAIRN_PARTS(LeftOut, reason, box, pixel_count, disparity, position, confidence)
CAIRN_PARTS(ObstacleScan, angle_min, angle_increment, range_max, ranges)
CAIRN_PARTS(ObstacleGrid, cell_size, width, height, origin_x, origin_y, cells)
CAIRN_PARTS(Frame, disparity, ground, floor, by_intensity, by_disparity, fusion, superpixels, groups, objects,
            space, left_out, epipolar, confidence)
CAIRN_PARTS(io::StageTime, stage, milliseconds)
CAIRN_PARTS(io::Provenance, preset, config, rig, timings, external_disparity, stamp_ns)
CAIRN_PARTS(DisparityErrors, known, matched, bad, absolute_sum, square_sum, square_sum_within_1)
CAIRN_PARTS(TrueObjectScore, id, pixel_count, found, iou, boundary_f, over_segmented, under_segmented)
CAIRN_PARTS(FoundObjectScore, id, pixel_count, best, iou, share_on_objects, mostly_dont_care, phantom)
CAIRN_PARTS(ObjectErrors, truth, ours, boundary_tolerance)
CAIRN_PARTS(ObjectSummary, frames, true_objects, found_50, found_75, missed, over_segmented, under_segmented,
            mean_error, median_error, mean_iou, mean_f, mean_f_found, complete_frames, our_objects, right_50,
            right_75, phantoms)
CAIRN_PARTS(RowAlignment, points, offset, slope, agreeing, left_over, histogram)
CAIRN_PARTS(Exposure, black, white, contrast)
CAIRN_PARTS(BrightnessDifference, points, gain, offset, median)
CAIRN_PARTS(Sharpness, edges, edge)
CAIRN_PARTS(PairMeasures, size, identical, textured_points, rows, disparities, brightness, left_exposure,
            right_exposure, left_sharpness, right_sharpness)
CAIRN_PARTS(LagChange, from, before, after, motion)
CAIRN_PARTS(Synchrony, frames, motion, agreement, left_repeats, right_repeats, change)
CAIRN_PARTS(PyTuning, json, config)
CAIRN_PARTS(Finding, kind, severity, number, says, frames, camera)
// Those of sequences are in follow.cpp.

// ---- to Python and back ----

template <class T>
inline constexpr bool kHasParts = requires(T& value) {
  Parts<T>::of(value);
};

template <class T>
inline constexpr bool kIsImage = false;
template <class T>
inline constexpr bool kIsImage<Image<T>> = true;
template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;
template <class T>
inline constexpr bool kIsVector = false;
template <class T>
inline constexpr bool kIsVector<std::vector<T>> = true;
template <class T>
inline constexpr bool kIsArray = false;
template <class T, std::size_t N>
inline constexpr bool kIsArray<std::array<T, N>> = true;

template <class T>
py::object state_of(const T& value) {
  if constexpr (kIsImage<T>) {
    return array_from(value.clone());
  } else if constexpr (std::is_enum_v<T>) {
    return py::int_(static_cast<std::int64_t>(value));
  } else if constexpr (kIsOptional<T>) {
    return value ? state_of(*value) : py::object(py::none());
  } else if constexpr (kIsVector<T> || kIsArray<T>) {
    py::list all;
    for (const auto& entry : value) all.append(state_of(entry));
    return all;
  } else if constexpr (std::is_same_v<T, Config>) {
    py::dict all;
    for (const OptionInfo& option : options(value)) all[py::str(option.name)] = option.value;
    return all;
  } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
    return py::str(value.string());
  } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
    return py::cast(value);
  } else {
    return std::apply([](const auto&... part) -> py::object { return py::make_tuple(state_of(part)...); },
                      Parts<T>::of(value));
  }
}

[[noreturn]] inline void refuse_state(const std::string& found) {
  throw Error("unpickling: found " + found + ", expected what this version of cairn pickled");
}

template <class T>
void restore(const py::handle& state, Image<T>& image) {
  if (state.is_none()) return;
  using Number = typename NumbersOf<T>::Type;
  constexpr py::ssize_t kCount = NumbersOf<T>::kCount;
  const auto array = py::array_t<Number, py::array::c_style>::ensure(state);
  if (!array || array.ndim() != (kCount > 1 ? 3 : 2)) refuse_state("no array where an image should be");
  const Size size{static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0))};
  image = copied(View<const T>(reinterpret_cast<const T*>(array.data()), size, size.width));
}

template <class T>
void restore(const py::handle& state, T& value) {
  if constexpr (std::is_enum_v<T>) {
    value = static_cast<T>(state.cast<std::int64_t>());
  } else if constexpr (kIsOptional<T>) {
    if (!state.is_none()) restore(state, value.emplace());
  } else if constexpr (std::is_same_v<T, std::vector<bool>>) {
    value = state.cast<T>();  // its entries are not nested state
  } else if constexpr (kIsVector<T> || kIsArray<T>) {
    const auto all = py::reinterpret_borrow<py::list>(state);
    if constexpr (kIsVector<T>) value.resize(all.size());
    if (value.size() != all.size()) refuse_state(std::to_string(all.size()) + " numbers");
    for (std::size_t i = 0; i < all.size(); ++i) restore(all[i], value[i]);
  } else if constexpr (std::is_same_v<T, Config>) {
    for (const auto& [name, text] : py::reinterpret_borrow<py::dict>(state)) {
      set(value, py::str(name).template cast<std::string>(), py::str(text).template cast<std::string>());
    }
  } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
    value = state.cast<std::string>();
  } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
    value = state.cast<T>();
  } else {
    const auto parts = py::reinterpret_borrow<py::tuple>(state);
    std::size_t i = 0;
    std::apply([&](auto&... part) { (restore(parts[i++], part), ...); }, Parts<T>::of(value));
  }
}

/// A state belongs to one version; long-term storage is for files.
inline py::tuple versioned(py::object state) {
  return py::make_tuple(CAIRN_VERSION, std::move(state));
}
inline py::object of_this_version(const py::tuple& state) {
  if (state.size() != 2) refuse_state(std::to_string(state.size()) + " entries");
  const auto version = py::str(state[0]).cast<std::string>();
  if (version != CAIRN_VERSION) refuse_state("a value of version " + version.substr(0, 20));
  return state[1];
}

/// For class_::def: pickle, copy.copy and copy.deepcopy of a class by its members.
template <class T>
auto pickled() {
  return py::pickle([](const T& self) { return versioned(state_of(self)); },
                    [](const py::tuple& state) {
                      T value;
                      restore(of_this_version(state), value);
                      return value;
                    });
}

}  // namespace cairn::python
