// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "frame.hpp"

#include <algorithm>
#include <cairn/objects/locate.hpp>
#include <cairn/pipeline/segmenter.hpp>
#include <io/image_files.hpp>
#include <io/overlay.hpp>
#include <io/results.hpp>
#include <limits>

#include "bindings.hpp"

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

/// The inputs of a call besides its images.
struct Recipe {
  PyConfig config;
  PyCalibration calibration;

  /// Throws Error if the calibration is for images of another size.
  [[nodiscard]] Config for_size(Size size) const {
    calibration.check(size);
    return config.suited(calibration.calibration);
  }
  /// The provenance of a frame to be computed.
  [[nodiscard]] io::Provenance provenance(Size size, bool external_disparity) const {
    return {config.preset, for_size(size), calibration.calibration.rig, {}, external_disparity};
  }
};

/// Records the times of the stages.
void time_stages(Exec& exec, std::vector<io::StageTime>& times) {
  exec.observe = [&times](std::string_view stage, const Artifact&, double milliseconds) {
    times.push_back({std::string(stage), milliseconds});
  };
}

std::unique_ptr<PyFrame> segment_pair(Picture left, const Picture& right, const Recipe& recipe, Exec exec) {
  const auto pair = StereoPair::from(left.gray(), right.gray(), left.rgb());
  io::Provenance provenance = recipe.provenance(pair.size(), false);
  time_stages(exec, provenance.timings);
  Frame frame = released([&] { return segment(pair, provenance.rig, provenance.config, exec); });
  return std::make_unique<PyFrame>(std::move(left), std::move(frame), std::move(provenance));
}

std::unique_ptr<PyFrame> segment_given(Picture left, DisparityInput disparity, const Recipe& recipe,
                                       Exec exec) {
  io::Provenance provenance = recipe.provenance(left.size(), true);
  time_stages(exec, provenance.timings);
  Frame frame = released([&] {
    return segment(left.gray(), left.rgb(), disparity.taken(exec), provenance.rig, provenance.config, exec);
  });
  return std::make_unique<PyFrame>(std::move(left), std::move(frame), std::move(provenance));
}

std::unique_ptr<PyFrame> segment_any(const Call& call, Picture& left,
                                     const Typed<"Optional[ImageLike]">& right, const KnownRig& rig,
                                     const Typed<"Optional[DisparityLike]">& disparity_map) {
  const Recipe recipe{call.settings(), rig};
  if (disparity_map.is_none())
    return segment_pair(std::move(left), Picture(right, "right", call.bgr, call.exec.pool), recipe,
                        call.exec);
  if (!right.is_none())
    throw Error("right: found an image together with disparity_map, expected one of the two");
  return segment_given(std::move(left), DisparityInput(disparity_map, "disparity_map", call.exec), recipe,
                       call.exec);
}

SceneDisparity disparity_of_pair(const Call& call, const Picture& left, const Picture& right,
                                 const KnownRig& rig) {
  const Recipe recipe{call.settings(), rig};
  const auto pair = StereoPair::from(left.gray(), right.gray(), left.rgb());
  const Config wanted = recipe.for_size(pair.size());
  return released([&] { return estimate_disparity(pair, rig.rig(), wanted, call.exec); });
}

/// segment() for video; a Segmenter has its own pool and threads.
struct PySegmenter {
  PySegmenter(Recipe made_with, Exec exec)
      : recipe(std::move(made_with)),
        segmenter(recipe.config.suited(recipe.calibration.calibration), recipe.calibration.calibration.rig,
                  std::move(exec)) {}
  Recipe recipe;
  Segmenter segmenter;
};

/// The copy has a pool of its own: buffers are not copied.
py::tuple segmenter_state(const PySegmenter& self) {
  return versioned(py::make_tuple(state_of(self.recipe.config), state_of(self.recipe.calibration),
                                  py::cast(self.segmenter.exec())));
}

std::unique_ptr<PySegmenter> segmenter_of(const py::tuple& state) {
  const auto parts = py::reinterpret_borrow<py::tuple>(of_this_version(state));
  Recipe recipe;
  restore(parts[0], recipe.config);
  restore(parts[1], recipe.calibration);
  return std::make_unique<PySegmenter>(std::move(recipe), exec_of(parts[2]));
}

std::string frame_repr(const PyFrame& self) {
  const Size size = self.frame.disparity.disparity_px.size();
  return "<cairn.Frame " + text(size) + (self.frame.ground.plane ? ", ground found, " : ", no ground, ") +
         py::repr(py::cast(self.frame.objects, py::return_value_policy::reference)).cast<std::string>() + ">";
}

Image<Rgb> overlay(const PyFrame& self) {
  return released([&] {
    return io::draw_objects(self.left.gray(), self.left.rgb(), self.frame.objects, self.frame.floor);
  });
}

// ---- metric results ----

const StereoRig& rig_of_frame(const PyFrame& self) {
  if (!self.provenance.rig) throw Error("rig: found none, expected one: a frame without a rig has no metres");
  return *self.provenance.rig;
}

std::optional<FloorFrame> floor_frame_of(const PyFrame& self) {
  return floor_frame(self.frame.ground, self.provenance.rig);
}

/// A scan or grid of what is seen from the floor.
template <auto make>
auto from_floor(const PyFrame& self) {
  const auto floor = floor_frame_of(self);
  const auto made = [&] {
    return make(self.frame.space, self.frame.disparity.disparity_px, *floor, *self.provenance.rig,
                self.provenance.config.space);
  };
  return floor ? std::optional(made()) : std::nullopt;
}

/// NaN if there is none.
Numbers<float> points_of_pixels(const PyFrame& self) {
  const StereoRig& rig = rig_of_frame(self);
  const View<const float> d = self.frame.disparity.disparity_px;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Numbers<float> points{{}, {d.height(), d.width(), 3}};
  for (int y = 0; y < d.height(); ++y) {
    for (int x = 0; x < d.width(); ++x) {
      const auto point = rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), d(x, y));
      const Vec3 at = point.value_or(Vec3{kNan, kNan, kNan});
      points.values.insert(points.values.end(), {at.x, at.y, at.z});
    }
  }
  return points;
}

Numbers<float> points_of(const PyFrame& self, const Typed<"Union[Object, int, None]">& object) {
  if (object.is_none()) return points_of_pixels(self);
  const auto id =
      whole(PyIndex_Check(object.ptr()) != 0 ? py::object(object) : py::object(object.attr("id")));
  const std::vector<Vec3> all = object_points(self.frame.objects, ObjectId{id.value_or(0)},
                                              self.frame.disparity.disparity_px, rig_of_frame(self));
  Numbers<float> points{{}, {static_cast<py::ssize_t>(all.size()), 3}};
  for (const Vec3& at : all) points.values.insert(points.values.end(), {at.x, at.y, at.z});
  return points;
}

Numbers<float> depth_of(const PyFrame& self) {
  const Numbers<float> points = points_of_pixels(self);
  Numbers<float> depth{{}, {points.shape[0], points.shape[1]}};
  for (std::size_t i = 2; i < points.values.size(); i += 3) depth.values.push_back(points.values[i]);
  return depth;
}

// ---- classes ----

/// An attribute from the frame.
template <auto member>
const auto& part(const PyFrame& self) {
  return self.frame.*member;
}
/// An attribute of frames of one method; None in frames of the other.
template <auto member>
auto part_of_some(const PyFrame& self) {
  const auto& part = self.frame.*member;
  return part.labels.empty() ? nullptr : &part;
}

void bind_frame_class(py::module_& m) {
  using py::literals::operator""_a;
  Class<PyFrame>(
      m, "Frame",
      "All that is known of one pair. Arrays (H, W) are read-only and the frame's own memory, without a "
      "copy; "
      "rows may be padded, so ask array.copy() for one that may be written to. Keeps the left image that it "
      "was made of, for overlay(): the array itself, not a copy of it. In a notebook it shows itself as "
      "overlay().")
      .shows(
          "disparity", [](const PyFrame& f) -> const auto& { return f.frame.disparity.disparity_px; },
          "float32, px; NaN = hole, see `reject`")
      .shows(
          "reject", [](const PyFrame& f) -> const auto& { return f.frame.disparity.reject; },
          "uint16, why there is no disparity: bits of cairn.Reject; 0 = there is one")
      .may_show("confidence", &part<&Frame::confidence>,
                "float32, 0 to 1: how likely the disparity is within 1 px of the truth; 0 in holes. None "
                "where nothing "
                "was matched")
      .may_show("floor", &part<&Frame::floor>, "uint8, 255 = floor, else 0; None where no floor was labelled")
      .shows(
          "objects_map", [](const PyFrame& f) -> const auto& { return f.frame.objects.labels; },
          "int32, the object that each pixel belongs to; 0 = none. `frame.objects_map == object.id` is a "
          "mask")
      .shows("objects", &part<&Frame::objects>, "the Objects, nearest first")
      .shows("space", &part<&Frame::space>,
             "uint8, what each pixel shows: 255 = obstacle, object or not; 128 = floor; 0 = unknown")
      .shows("left_out", &part<&Frame::left_out>,
             "a list of LeftOut: obstacles that are no objects, nearest first, and why")
      .shows("floor_frame", &floor_frame_of,
             "the FloorFrame: where the floor is, in metres; None without a rig or a ground")
      .method("scan",
              "The nearest obstacle in each direction: an ObstacleScan. None without a rig or a ground.",
              &from_floor<&scan_obstacles>)
      .method("grid", "The obstacles on the floor: an ObstacleGrid. None without a rig or a ground.",
              &from_floor<&map_obstacles>)
      .method("depth_m", "(H, W) float32, m: how far each pixel is along the view; NaN = hole.", &depth_of)
      .method("points",
              "Points in the camera's frame, m, x right, y down, z forward: (H, W, 3) float32, NaN = hole; "
              "of an Object "
              "or of its id alone (N, 3), without holes.",
              &points_of, "object"_a = py::none())
      .shows("disparity_map", &part<&Frame::disparity>,
             "disparity and reject as the DisparityMap that stages take")
      .shows("ground", &part<&Frame::ground>, "the floor as a plane, or why there is none")
      .shows("by_intensity", &part_of_some<&Frame::by_intensity>,
             "Segmentation of the image by intensity; None with fusion.method=hierarchy")
      .shows("by_disparity", &part_of_some<&Frame::by_disparity>,
             "Segmentation by disparity; None with fusion.method=hierarchy")
      .shows("fusion", &part_of_some<&Frame::fusion>, "both fused; None with fusion.method=hierarchy")
      .shows("superpixels", &part_of_some<&Frame::superpixels>,
             "the image's superpixels as a Segmentation; None with fusion.method=overlap")
      .shows("groups", &part_of_some<&Frame::groups>,
             "Segmentation: region 0 is the background, the others were chosen to be objects; None with "
             "fusion.method=overlap")
      .shows("epipolar", &part<&Frame::epipolar>, "how far the right image's rows were off")
      .shows(
          "rig", [](const PyFrame& self) { return self.provenance.rig; },
          "the Rig that it was made with, or None")
      .shows(
          "config",
          [](const PyFrame& self) {
            return PyConfig{self.provenance.preset, self.provenance.config, true};
          },
          "the Config that it was made with")
      .shows(
          "timings",
          [](const PyFrame& self) {
            Typed<"Dict[str, float]"> times = py::dict();
            for (const io::StageTime& time : self.provenance.timings)
              times[py::str(time.stage)] = time.milliseconds;
            return times;
          },
          "milliseconds by stage")
      .shows(
          "shape",
          [](const PyFrame& self) {
            const Size size = self.frame.disparity.disparity_px.size();
            return std::pair{size.height, size.width};
          },
          "(H, W)")
      .method("overlay",
              "The left image with the objects drawn in, each with its id and distance: (h, w, 3) uint8, "
              "RGB; small frames "
              "are enlarged.",
              &overlay)
      .method(
          "disparity_view",
          "Disparity as colour, holes in colours that tell the reason, with a legend: (h, w, 3) uint8, RGB.",
          [](const PyFrame& self) {
            const io::Provenance& how = self.provenance;
            return released([&] {
              return io::draw_disparity(self.frame.disparity, how.rig,
                                        reasons_in_force(how.config, how.external_disparity));
            });
          })
      .method(
          "to_json",
          "The text of objects.json: objects with masks, ground, configuration, timings (docs/formats.md).",
          [](const PyFrame& self) { return io::objects_json(self.frame, self.provenance); })
      .method(
          "save",
          "Writes the files that `cairn segment -o FOLDER` does (docs/formats.md); whole or not at all.",
          [](const PyFrame& self, const std::filesystem::path& folder) {
            released([&] {
              io::write_result(folder, self.left.gray(), self.left.rgb(), self.frame, self.provenance);
            });
          },
          "folder"_a)
      .method("_repr_png_", "",
              [](const PyFrame& self) {
                const Image<Rgb> drawn = overlay(self);
                return py::bytes(released([&] { return io::png_bytes(drawn); }));
              })
      .def(py::pickle(&frame_state, &frame_of))
      .says(&frame_repr);

  Class<SceneDisparity>(m, "SceneDisparity",
                        "Disparity with everything that speaks against it, ground and speckle included.")
      .shows("disparity_map", &SceneDisparity::disparity,
             "disparity and reject as the DisparityMap that stages take")
      .shows(
          "disparity", [](const SceneDisparity& self) -> const auto& { return self.disparity.disparity_px; },
          "(H, W) float32, px, read-only; NaN = hole")
      .shows(
          "reject", [](const SceneDisparity& self) -> const auto& { return self.disparity.reject; },
          "(H, W) uint16, bits of cairn.Reject")
      .shows("ground", &SceneDisparity::ground, "the floor as a plane, or why there is none")
      .may_show("floor", &SceneDisparity::floor, "(H, W) uint8, 255 = floor; None where there is none")
      .shows("epipolar", &SceneDisparity::epipolar,
             "an EpipolarOffset: how far the right image's rows were off, rows")
      .may_show("confidence", &SceneDisparity::confidence, "(H, W) float32, 0 to 1; or None");
}

}  // namespace

void bind_frame(py::module_& m) {
  using py::literals::operator""_a;
  bind_frame_class(m);

  const Options options{Keywords::by_group, all_groups()};
  const std::string about =
      "left, right: a rectified pair of one size, (H, W) or (H, W, 3) uint8, RGB (bgr=True: OpenCV's order): "
      "what is at "
      "(x, y) on the left is at (x - d, y) on the right. Arrays whose rows are dense are used where they "
      "lie, without "
      "a copy, grey ones and RGB; do not write to them meanwhile. Matching works on grey, which is computed "
      "from "
      "colours; bgr=True and other layouts cost a copy. rig: a Rig, a Calibration, or None: no metres then. "
      "preset, "
      "then config (a Config or a file's name), then the options; later ones win. Other Python threads run "
      "meanwhile. "
      "Raises cairn.Error for what cannot be used.";
  define(m, "segment", options,
         "Objects from a stereo pair: the whole method. Returns a Frame.\n" + about +
             " disparity_map instead of right: a map from elsewhere, (H, W) float32 in px, NaN = hole, or a "
             "DisparityMap.",
         &segment_any, "left"_a, "right"_a = py::none(), "rig"_a = py::none(), py::kw_only(),
         "disparity_map"_a = py::none());
  define(m, "estimate_disparity", options,
         "The method's first half: matching and every check, ground and speckle included. Returns a "
         "SceneDisparity.\n" +
             about,
         &disparity_of_pair, "left"_a, "right"_a, "rig"_a = py::none());

  Class<PySegmenter>(
      m, "Segmenter",
      "segment() for video: keeps threads and image buffers from frame to frame, so that from the second "
      "frame on no image is allocated (as long as earlier frames, and arrays of them, have died). Every "
      "frame is what segment() would give. Several threads may use one.")
      .made_by(
          options, "The arguments are those of segment().",
          [](const Call& call, const KnownRig& rig) {
            return std::make_unique<PySegmenter>(Recipe{call.settings(), rig}, call.exec);
          },
          "rig"_a = py::none())
      .method(
          "segment", "One frame.",
          [](const PySegmenter& self, const Typed<"ImageLike">& left, const Typed<"ImageLike">& right,
             bool bgr) {
            const Exec& exec = self.segmenter.exec();
            return segment_pair(Picture(left, "left", bgr, exec.pool),
                                Picture(right, "right", bgr, exec.pool), self.recipe, exec);
          },
          "left"_a, "right"_a, py::kw_only(), "bgr"_a = false)
      .shows(
          "config", [](const PySegmenter& self) { return self.recipe.config; },
          "the Config that it works with")
      .shows(
          "rig", [](const PySegmenter& self) { return self.segmenter.rig(); },
          "the Rig that it measures with, or None")
      .shows(
          "exec", [](const PySegmenter& self) { return self.segmenter.exec(); },
          "the Exec that it works with: its own threads and pool of images")
      .def(py::pickle(&segmenter_state, &segmenter_of));
}

}  // namespace cairn::python
