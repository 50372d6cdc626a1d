// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/pipeline/segmenter.hpp>
#include <functional>
#include <io/image_files.hpp>
#include <io/overlay.hpp>
#include <io/results.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "disparity.hpp"
#include "frame.hpp"
#include "objects.hpp"
#include "options.hpp"
#include "pickling.hpp"
#include "rig.hpp"

namespace cairn::python {
namespace {

py::tuple frame_state(const PyFrame& self) {
  return versioned(py::make_tuple(self.left.copy(), state_of(self.frame), state_of(self.provenance)));
}

std::unique_ptr<PyFrame> frame_of(const py::tuple& state) {
  const auto parts = py::reinterpret_borrow<py::tuple>(of_this_version(state));
  auto frame = std::make_unique<PyFrame>(Picture(parts[0], "left", false, {}), Frame{}, io::Provenance{});
  restore(parts[1], frame->frame);
  restore(parts[2], frame->provenance);
  return frame;
}

/// Everything that a call needs to know besides its pictures.
struct Recipe {
  PyConfig config;
  PyCalibration calibration;

  /// Throws Error where the calibration is for other pictures.
  [[nodiscard]] Config for_size(Size size) const {
    io::check_size(calibration.calibration, size, calibration.path);
    io::check_search_range(calibration.calibration, calibration.path);
    return config.suited(calibration.calibration);
  }
};

/// Keeps the times of the stages.
void time_stages(Exec& exec, std::vector<io::StageTime>& times) {
  exec.observe = [&times](std::string_view stage, const Artifact&, double milliseconds) {
    times.push_back({std::string(stage), milliseconds});
  };
}

std::unique_ptr<PyFrame> segment_pair(const ImageArgument& left, const ImageArgument& right, bool bgr,
                                      const Recipe& recipe, Exec exec) {
  Picture l(left, "left", bgr, exec.pool);
  const Picture r(right, "right", bgr, exec.pool);
  const auto pair = StereoPair::from(l.gray(), r.gray(), l.rgb());
  io::Provenance provenance{
      recipe.config.preset, recipe.for_size(pair.size()), recipe.calibration.calibration.rig, {}};
  time_stages(exec, provenance.timings);
  Frame frame = released([&] { return segment(pair, provenance.rig, provenance.config, exec); });
  return std::make_unique<PyFrame>(std::move(l), std::move(frame), std::move(provenance));
}

std::unique_ptr<PyFrame> segment_given(const ImageArgument& left, const DisparityArgument& map, bool bgr,
                                       const Recipe& recipe, Exec exec) {
  Picture l(left, "left", bgr, exec.pool);
  DisparityInput disparity(map, "disparity_map", exec);
  io::Provenance provenance{
      recipe.config.preset, recipe.for_size(l.size()), recipe.calibration.calibration.rig, {}, true};
  time_stages(exec, provenance.timings);
  Frame frame = released([&] {
    return segment(l.gray(), l.rgb(), disparity.taken(exec), provenance.rig, provenance.config, exec);
  });
  return std::make_unique<PyFrame>(std::move(l), std::move(frame), std::move(provenance));
}

std::unique_ptr<PyFrame> segment_any(const ImageArgument& left, const ImageArgument& right,
                                     const RigArgument& rig, const std::string& preset,
                                     const py::object& config, const py::object& exec, bool bgr,
                                     const DisparityArgument& disparity_map, const py::kwargs& options) {
  const Recipe recipe{config_of(config, preset, options), calibration_of(rig)};
  if (disparity_map.is_none()) return segment_pair(left, right, bgr, recipe, exec_of(exec));
  if (!right.is_none()) throw Error("right: found a picture beside disparity_map, expected one of the two");
  return segment_given(left, disparity_map, bgr, recipe, exec_of(exec));
}

std::unique_ptr<SceneDisparity> disparity_of_pair(const ImageArgument& left, const ImageArgument& right,
                                                  const RigArgument& rig, const std::string& preset,
                                                  const py::object& config, const py::object& exec, bool bgr,
                                                  const py::kwargs& options) {
  const Recipe recipe{config_of(config, preset, options), calibration_of(rig)};
  const Exec how = exec_of(exec);
  const Picture l(left, "left", bgr, how.pool);
  const Picture r(right, "right", bgr, how.pool);
  const auto pair = StereoPair::from(l.gray(), r.gray(), l.rgb());
  const Config wanted = recipe.for_size(pair.size());
  return std::make_unique<SceneDisparity>(
      released([&] { return estimate_disparity(pair, recipe.calibration.calibration.rig, wanted, how); }));
}

/// segment() for video; the pool and the threads are a Segmenter's own.
class PySegmenter {
 public:
  PySegmenter(const RigArgument& rig, const std::string& preset, const py::object& config,
              const py::object& exec, const py::kwargs& options)
      : recipe_{config_of(config, preset, options), calibration_of(rig)},
        segmenter_(recipe_.config.suited(recipe_.calibration.calibration),
                   recipe_.calibration.calibration.rig, exec_of(exec)) {}

  PySegmenter(Recipe recipe, Exec exec)
      : recipe_(std::move(recipe)),
        segmenter_(recipe_.config.suited(recipe_.calibration.calibration),
                   recipe_.calibration.calibration.rig, std::move(exec)) {}

  [[nodiscard]] std::unique_ptr<PyFrame> segment(const ImageArgument& left, const ImageArgument& right,
                                                 bool bgr) const {
    return segment_pair(left, right, bgr, recipe_, segmenter_.exec());
  }
  [[nodiscard]] const PyConfig& config() const { return recipe_.config; }
  [[nodiscard]] const PyCalibration& calibration() const { return recipe_.calibration; }
  [[nodiscard]] const std::optional<StereoRig>& rig() const { return segmenter_.rig(); }
  [[nodiscard]] const Exec& exec() const { return segmenter_.exec(); }

 private:
  Recipe recipe_;
  Segmenter segmenter_;
};

/// Its buffers stay behind: the copy has a pool of its own.
py::tuple segmenter_state(const PySegmenter& self) {
  return versioned(py::make_tuple(state_of(self.config()), state_of(self.calibration()), self.exec()));
}

std::unique_ptr<PySegmenter> segmenter_of(const py::tuple& state) {
  const auto parts = py::reinterpret_borrow<py::tuple>(of_this_version(state));
  Recipe recipe;
  restore(parts[0], recipe.config);
  restore(parts[1], recipe.calibration);
  return std::make_unique<PySegmenter>(std::move(recipe), exec_of(parts[2]));
}

// ---- what the classes show ----

/// A property that shows an image of the frame, read-only; `image_of_some` where it may be missing.
template <class T, class Find>
auto image_of(Find find) {
  return [find](const py::object& self) -> ArrayOf<T> {
    return array_over(find(self.cast<const PyFrame&>()), self, false);
  };
}
template <class T, class Find>
auto image_of_some(Find find) {
  return [find](const py::object& self) -> std::optional<ArrayOf<T>> {
    const Image<T>& image = find(self.cast<const PyFrame&>());
    if (image.empty()) return std::nullopt;
    return array_over(image, self, false);
  };
}

Size size_of(const PyFrame& self) {
  return self.frame.disparity.disparity_px.size();
}

std::string frame_repr(const PyFrame& self) {
  const Objects& objects = self.frame.objects;
  const std::size_t count = objects.list.size();
  std::string text = "<cairn.Frame " + cairn::text(size_of(self)) + ", " + std::to_string(count) +
                     (count == 1 ? " object" : " objects") +
                     (self.frame.ground.plane ? ", ground found" : ", no ground");
  for (const Object& object : objects.list) text += "\n  " + object_repr(object);
  return text + ">";
}

Image<Rgb> overlay(const PyFrame& self) {
  return io::draw_objects(self.left.gray(), self.left.rgb(), self.frame.objects, self.frame.floor);
}

py::bytes overlay_png(const PyFrame& self) {
  const std::string png = released([&] {
    const Image<Rgb> picture = overlay(self);
    return io::png_bytes(picture);
  });
  return py::bytes(png);
}

py::dict timings(const PyFrame& self) {
  py::dict times;
  for (const io::StageTime& time : self.provenance.timings) times[py::str(time.stage)] = time.milliseconds;
  return times;
}

void save(const PyFrame& self, const std::filesystem::path& folder) {
  released([&] { io::write_result(folder, self.left.gray(), self.left.rgb(), self.frame, self.provenance); });
}

// ---- in metres ----

const StereoRig& rig_of_frame(const PyFrame& self) {
  if (!self.provenance.rig) throw Error("rig: found none, expected one: a frame without a rig has no metres");
  return *self.provenance.rig;
}

std::optional<FloorFrame> floor_frame_of(const PyFrame& self) {
  return floor_frame(self.frame.ground, self.provenance.rig);
}

std::optional<ObstacleScan> scan_of(const PyFrame& self) {
  const auto floor = floor_frame_of(self);
  if (!floor) return std::nullopt;
  return scan_obstacles(self.frame.space, self.frame.disparity.disparity_px, *floor, *self.provenance.rig,
                        self.provenance.config.space);
}

std::optional<ObstacleGrid> grid_of(const PyFrame& self) {
  const auto floor = floor_frame_of(self);
  if (!floor) return std::nullopt;
  return map_obstacles(self.frame.space, self.frame.disparity.disparity_px, *floor, *self.provenance.rig,
                       self.provenance.config.space);
}

py::array_t<float> depth_of(const PyFrame& self) {
  const StereoRig& rig = rig_of_frame(self);
  const View<const float> d = self.frame.disparity.disparity_px;
  py::array_t<float> depth({d.height(), d.width()});
  auto out = depth.mutable_unchecked<2>();
  for (int y = 0; y < d.height(); ++y) {
    for (int x = 0; x < d.width(); ++x) {
      const auto point = rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), d(x, y));
      out(y, x) = point ? point->z : std::numeric_limits<float>::quiet_NaN();
    }
  }
  return depth;
}

py::array_t<float> all_points(const PyFrame& self) {
  const StereoRig& rig = rig_of_frame(self);
  const View<const float> d = self.frame.disparity.disparity_px;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  py::array_t<float> points({d.height(), d.width(), 3});
  auto out = points.mutable_unchecked<3>();
  for (int y = 0; y < d.height(); ++y) {
    for (int x = 0; x < d.width(); ++x) {
      const Vec3 point = rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), d(x, y))
                             .value_or(Vec3{kNan, kNan, kNan});
      out(y, x, 0) = point.x;
      out(y, x, 1) = point.y;
      out(y, x, 2) = point.z;
    }
  }
  return points;
}

py::array_t<float> points_of(const PyFrame& self, const py::object& object) {
  if (object.is_none()) return all_points(self);
  const auto id = ObjectId{PyIndex_Check(object.ptr()) != 0 ? py::int_(object).cast<std::int32_t>()
                                                            : object.attr("id").cast<std::int32_t>()};
  const auto count = static_cast<std::int32_t>(self.frame.objects.list.size());
  if (number(id) < 1 || number(id) > count) {
    throw Error("object: found id " + std::to_string(number(id)) + ", expected 1 … " + std::to_string(count));
  }
  const StereoRig& rig = rig_of_frame(self);
  const View<const float> d = self.frame.disparity.disparity_px;
  std::vector<float> all;
  for (int y = 0; y < d.height(); ++y) {
    for (int x = 0; x < d.width(); ++x) {
      if (self.frame.objects.labels(x, y) != id) continue;
      const auto point = rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), d(x, y));
      if (point) all.insert(all.end(), {point->x, point->y, point->z});
    }
  }
  py::array_t<float> points({static_cast<py::ssize_t>(all.size() / 3), py::ssize_t{3}});
  std::copy(all.begin(), all.end(), points.mutable_data());
  return points;
}

// ---- what the classes show, continued ----

template <class Member>
auto part(Member Frame::*member) {
  return [member](const PyFrame& self) -> const Member& { return self.frame.*member; };
}

/// What only one of the methods makes; None in a frame of the other.
template <class Part>
auto part_of_some(Part Frame::*member) {
  return [member](const PyFrame& self) -> std::optional<std::reference_wrapper<const Part>> {
    const Part& part = self.frame.*member;
    if (part.labels.empty()) return std::nullopt;
    return std::cref(part);
  };
}

void bind_frame_class(py::module_& m) {
  constexpr auto kInside = py::return_value_policy::reference_internal;
  py::class_<PyFrame>(
      m, "Frame",
      "All that is known of one pair. Arrays (H, W) are read-only and the frame's own memory, without a "
      "copy; rows may "
      "be padded, so ask array.copy() for one that may be written to. Keeps the left picture that it was "
      "made of, for "
      "overlay(): the array itself, not a copy of it. In a notebook it shows itself as overlay().")
      .def_property_readonly("disparity", image_of<float>([](const PyFrame& f) -> auto& {
                               return f.frame.disparity.disparity_px;
                             }),
                             "float32, px; NaN = hole, see `reject`")
      .def_property_readonly(
          "reject", image_of<Reject>([](const PyFrame& f) -> auto& { return f.frame.disparity.reject; }),
          "uint16, why there is no disparity: bits of cairn.Reject; 0 = there is one")
      .def_property_readonly(
          "confidence", image_of_some<float>([](const PyFrame& f) -> auto& { return f.frame.confidence; }),
          "float32, 0 to 1: how likely the disparity is within 1 px of the truth; 0 in holes. None where "
          "nothing was matched")
      .def_property_readonly(
          "floor", image_of_some<std::uint8_t>([](const PyFrame& f) -> auto& { return f.frame.floor; }),
          "uint8, 255 = floor, else 0; None where no floor was labelled")
      .def_property_readonly(
          "objects_map", image_of<ObjectId>([](const PyFrame& f) -> auto& { return f.frame.objects.labels; }),
          "int32, the object that each pixel belongs to; 0 = none. `frame.objects_map == object.id` is a "
          "mask")
      .def_property_readonly("objects", part(&Frame::objects), kInside, "the Objects, nearest first")
      .def_property_readonly(
          "space", image_of<Space>([](const PyFrame& f) -> auto& { return f.frame.space; }),
          "uint8, what each pixel shows: 255 = obstacle, object or not; 128 = floor; 0 = unknown")
      .def_property_readonly("left_out", part(&Frame::left_out), kInside,
                             "a list of LeftOut: obstacles that are no objects, nearest first, and why")
      .def_property_readonly("floor_frame", &floor_frame_of,
                             "the FloorFrame: where the floor is, in metres; None without a rig or a ground")
      .def("scan", &scan_of,
           "The nearest obstacle in each direction: an ObstacleScan. None without a rig or a ground.")
      .def("grid", &grid_of,
           "What stands where on the floor: an ObstacleGrid. None without a rig or a ground.")
      .def("depth_m", &depth_of, "(H, W) float32, m: how far each pixel is along the view; NaN = hole.")
      .def(
          "points", &points_of, py::arg("object") = py::none(),
          "Points in the camera's frame, m, x right, y down, z forward: (H, W, 3) float32, NaN = hole; of an "
          "Object or of its id alone (N, 3), without holes.")
      .def_property_readonly("disparity_map", part(&Frame::disparity), kInside,
                             "disparity and reject as the DisparityMap that stages take")
      .def_property_readonly("ground", part(&Frame::ground), kInside,
                             "the floor as a plane, or why there is none")
      .def_property_readonly("by_intensity", part_of_some(&Frame::by_intensity), kInside,
                             "Segmentation of the picture by intensity; None with fusion.method=hierarchy")
      .def_property_readonly("by_disparity", part_of_some(&Frame::by_disparity), kInside,
                             "Segmentation by disparity; None with fusion.method=hierarchy")
      .def_property_readonly("fusion", part_of_some(&Frame::fusion), kInside,
                             "both fused; None with fusion.method=hierarchy")
      .def_property_readonly("superpixels", part_of_some(&Frame::superpixels), kInside,
                             "the picture's superpixels as a Segmentation; None with fusion.method=overlap")
      .def_property_readonly(
          "groups", part_of_some(&Frame::groups), kInside,
          "Segmentation: region 0 is the background, the others were chosen to be objects; None with "
          "fusion.method=overlap")
      .def_property_readonly("epipolar", part(&Frame::epipolar), kInside,
                             "how far the right picture's rows were off")
      .def_property_readonly(
          "rig", [](const PyFrame& self) { return self.provenance.rig; },
          "the Rig that it was made with, or None")
      .def_property_readonly(
          "config",
          [](const PyFrame& self) {
            return PyConfig{self.provenance.preset, self.provenance.config, true};
          },
          "the Config that it was made with")
      .def_property_readonly("timings", &timings, "milliseconds by stage")
      .def_property_readonly(
          "shape",
          [](const PyFrame& self) {
            return std::pair{size_of(self).height, size_of(self).width};
          },
          "(H, W)")
      .def(
          "overlay", [](const PyFrame& self) { return array_from(released([&] { return overlay(self); })); },
          "The left picture with the objects drawn in, each with its id and distance: (h, w, 3) uint8, RGB; "
          "small "
          "frames are enlarged.")
      .def(
          "disparity_view",
          [](const PyFrame& self) {
            return array_from(released([&] {
              return io::draw_disparity(
                  self.frame.disparity, self.provenance.rig,
                  reasons_in_force(self.provenance.config, self.provenance.external_disparity));
            }));
          },
          "Disparity as colour, holes in colours that tell the reason, with a legend: (h, w, 3) uint8, RGB.")
      .def(
          "to_json", [](const PyFrame& self) { return io::objects_json(self.frame, self.provenance); },
          "The text of objects.json: objects with masks, ground, configuration, timings (docs/formats.md).")
      .def("save", &save, py::arg("folder"),
           "Writes the files that `cairn segment -o FOLDER` does (docs/formats.md); whole or not at all.")
      .def("_repr_png_", &overlay_png)
      .def(py::pickle(&frame_state, &frame_of))
      .def("__repr__", &frame_repr);

  py::class_<SceneDisparity>(m, "SceneDisparity",
                             "Disparity with everything that speaks against it, ground and speckle included.")
      .def(pickled<SceneDisparity>())
      .def_readonly("disparity_map", &SceneDisparity::disparity,
                    "disparity and reject as the DisparityMap that stages take")
      .def_property_readonly(
          "disparity",
          [](const py::object& self) {
            return array_over(self.cast<const SceneDisparity&>().disparity.disparity_px, self, false);
          },
          "(H, W) float32, px, read-only; NaN = hole")
      .def_property_readonly(
          "reject",
          [](const py::object& self) {
            return array_over(self.cast<const SceneDisparity&>().disparity.reject, self, false);
          },
          "(H, W) uint16, bits of cairn.Reject")
      .def_readonly("ground", &SceneDisparity::ground, "the floor as a plane, or why there is none")
      .def_property_readonly("floor", shown(&SceneDisparity::floor),
                             "(H, W) uint8, 255 = floor; None where there is none")
      .def_readonly("epipolar", &SceneDisparity::epipolar,
                    "an EpipolarOffset: how far the right picture's rows were off, rows")
      .def_property_readonly("confidence", shown(&SceneDisparity::confidence),
                             "(H, W) float32, 0 to 1; or None")
      .def("__repr__", [](const SceneDisparity& self) {
        return "<cairn.SceneDisparity " + text(self.disparity.disparity_px.size()) +
               (self.ground.plane ? ", ground found>" : ", no ground>");
      });
}

}  // namespace

void bind_frame(py::module_& m) {
  using py::literals::operator""_a;
  bind_frame_class(m);

  const std::string about =
      "left, right: a rectified pair of one size, (H, W) or (H, W, 3) uint8, RGB (bgr=True: OpenCV's order): "
      "what stands at "
      "(x, y) on the left stands at (x - d, y) on the right. Arrays whose rows are dense are used where they "
      "lie, without a copy, grey ones and RGB; do not write to them meanwhile. Matching works on grey, which "
      "is computed from colours; bgr=True and other layouts cost a copy. rig: a Rig, a Calibration, or None: "
      "no metres then. "
      "preset, then "
      "config (a Config or a file's name), then the options; later ones win. Other Python threads run "
      "meanwhile. "
      "Raises cairn.Error for what cannot be used.";
  const std::string segment_doc =
      with_options("Objects from a stereo pair: the whole method. Returns a Frame.\n" + about +
                       " disparity_map instead of right: a map from elsewhere, (H, W) float32 in px, NaN = "
                       "hole, or a DisparityMap.",
                   all_groups(), true);
  m.def("segment", &segment_any, "left"_a, "right"_a = py::none(), "rig"_a = py::none(), py::kw_only(),
        "preset"_a = "default", "config"_a = py::none(), "exec"_a = py::none(), "bgr"_a = false,
        "disparity_map"_a = py::none(), segment_doc.c_str());
  note_groups(m, "segment", all_groups(), true);

  const std::string disparity_doc = with_options(
      "The method's first half: matching and every check, ground and speckle included. Returns a "
      "SceneDisparity.\n" +
          about,
      all_groups(), true);
  m.def("estimate_disparity", &disparity_of_pair, "left"_a, "right"_a, "rig"_a = py::none(), py::kw_only(),
        "preset"_a = "default", "config"_a = py::none(), "exec"_a = py::none(), "bgr"_a = false,
        disparity_doc.c_str());
  note_groups(m, "estimate_disparity", all_groups(), true);

  py::class_<PySegmenter>(
      m, "Segmenter",
      "segment() for video: keeps threads and image buffers from frame to frame, so that from the "
      "second frame on no image is allocated (as long as earlier frames, and arrays of them, have "
      "died). Every frame is what segment() would give. Several threads may use one.")
      .def(py::init<const RigArgument&, const std::string&, const py::object&, const py::object&,
                    const py::kwargs&>(),
           "rig"_a = py::none(), py::kw_only(), "preset"_a = "default", "config"_a = py::none(),
           "exec"_a = py::none(), "The arguments are those of segment().")
      .def("segment", &PySegmenter::segment, "left"_a, "right"_a, py::kw_only(), "bgr"_a = false,
           "One frame.")
      .def_property_readonly("config", &PySegmenter::config, "the Config that it works with")
      .def_property_readonly("rig", &PySegmenter::rig, "the Rig that it measures with, or None")
      .def_property_readonly("exec", &PySegmenter::exec,
                             "the Exec that it works with: its own threads and pool of images")
      .def(py::pickle(&segmenter_state, &segmenter_of))
      .def("__repr__", [](const PySegmenter& self) {
        return "<cairn.Segmenter " + py::repr(py::cast(self.config())).cast<std::string>() + ", " +
               (self.rig() ? py::repr(py::cast(*self.rig())).cast<std::string>() : "no rig") + ">";
      });
  note_groups(m, "Segmenter", all_groups(), true);
}

}  // namespace cairn::python
