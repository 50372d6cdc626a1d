// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "frame.hpp"

#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <cairn/io/stereo_calibration.hpp>
#include <cairn/objects/locate.hpp>
#include <cairn/output/overlay.hpp>
#include <cairn/pipeline/segmenter.hpp>
#include <limits>

#include "bindings.hpp"

namespace cairn::python {
namespace {

// ---- the whole method ----

/// The frame, and how it was made. `work` gets the rig, the configuration and an Exec that records times.
template <class Work>
std::pair<Frame, output::Provenance> timed(Size size, bool is_external, const PyCalibration& calibration,
                                           const PyConfig& config, Exec exec, Work work) {
  calibration.check(size);
  output::Provenance how{
      config.preset, config.suited(calibration.calibration).config, calibration.rig(), {}, is_external};
  exec.observe = [&](std::string_view stage, const StageResult&, double milliseconds) {
    how.timings.push_back({std::string(stage), milliseconds});
  };
  Frame frame = work(how.rig, how.config, exec);
  return {std::move(frame), std::move(how)};
}

auto segment_pair(const LoadedImage& left, const LoadedImage& right, const PyCalibration& calibration,
                  const PyConfig& config, const Exec& exec) {
  const auto pair = StereoPair::from(left.gray(), right.gray(), left.rgb());
  return timed(pair.size(), false, calibration, config, exec,
               [&](const auto& rig, const Config& c, const Exec& e) { return segment(pair, rig, c, e); });
}

auto segment_given(const LoadedImage& left, const DisparityMap& map, const PyCalibration& calibration,
                   const PyConfig& config, const Exec& exec) {
  return timed(left.gray().size(), true, calibration, config, exec,
               [&](const auto& rig, const Config& c, const Exec& e) {
                 DisparityMap own{map.disparity_px.clone(e.pool), map.reject.clone(e.pool)};
                 return segment({{left.gray(), left.rgb()}, {}, std::move(own)}, {rig, c, e});
               });
}

StereoResult disparity_of_pair(const LoadedImage& left, const LoadedImage& right,
                               const PyCalibration& calibration, const PyConfig& config, const Exec& exec) {
  const auto pair = StereoPair::from(left.gray(), right.gray(), left.rgb());
  calibration.check(pair.size());
  return estimate_disparity(pair, calibration.rig(), config.suited(calibration.calibration).config, exec);
}

/// cairn::Segmenter; each frame with its provenance.
class PySegmenter {
 public:
  PySegmenter(const PyConfig& config, PyCalibration calibration, const Exec& exec)
      : preset_(config.preset),
        calibration_(std::move(calibration)),
        segmenter_(config.suited(calibration_.calibration).config, calibration_.rig(), noting_times(exec)) {}

  auto segment(const LoadedImage& left, const LoadedImage& right) const {
    const auto pair = StereoPair::from(left.gray(), right.gray(), left.rgb());
    calibration_.check(pair.size());
    output::Provenance how{preset_, segmenter_.config(), calibration_.rig(), {}, false};
    times_ = &how.timings;
    Frame frame = segmenter_.segment(pair);
    return std::pair{std::move(frame), std::move(how)};
  }
  void prefetch(const LoadedImage& left, const LoadedImage& right) const {
    const auto pair = StereoPair::from(left.gray(), right.gray(), left.rgb());
    calibration_.check(pair.size());
    segmenter_.prefetch(pair);
  }
  [[nodiscard]] Exec exec() const {
    Exec own = segmenter_.exec();
    own.observe = nullptr;
    return own;
  }

 private:
  static Exec noting_times(Exec exec) {
    exec.observe = [](std::string_view stage, const StageResult&, double ms) {
      times_->push_back({std::string(stage), ms});
    };
    return exec;
  }

  // Of the frame of this thread: the stages are reported to the thread that asked for it.
  static thread_local std::vector<output::StageTime>* times_;

  std::string preset_;
  PyCalibration calibration_;
  Segmenter segmenter_;
};
thread_local std::vector<output::StageTime>* PySegmenter::times_ = nullptr;

// ---- metric results ----

/// A scan, grid or steps of what is seen from the floor.
template <class T>
using FromFloor = T (*)(const Frame&, const FloorFrame&, const StereoRig&, const ObstaclesConfig&);
template <class T>
auto from_floor(FromFloor<T> make) {
  return [make](const Frame& frame, const FloorFrame& floor, const output::Provenance& how) {
    return make(frame, floor, *how.rig, how.config.obstacles);
  };
}

Numbers<float> numbers_of(const std::vector<Vec3>& points, std::vector<py::ssize_t> shape) {
  Numbers<float> numbers{{}, std::move(shape)};
  for (const Vec3& at : points) numbers.values.insert(numbers.values.end(), {at.x, at.y, at.z});
  return numbers;
}

/// NaN if there is none.
Numbers<float> points_of_pixels(const Frame& frame, const StereoRig& rig) {
  const View<const float> d = frame.disparity.disparity_px;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Vec3> points;
  for (int y = 0; y < d.height(); ++y) {
    for (int x = 0; x < d.width(); ++x) {
      const auto point = rig.point_in_camera_m(static_cast<float>(x), static_cast<float>(y), d(x, y));
      points.push_back(point.value_or(Vec3{kNan, kNan, kNan}));
    }
  }
  return numbers_of(points, {d.height(), d.width(), 3});
}

Numbers<float> points_of_object(const Frame& frame, const StereoRig& rig, int id) {
  const std::vector<Vec3> points =
      object_points(frame.objects, ObjectId{id}, frame.disparity.disparity_px, rig);
  return numbers_of(points, {static_cast<py::ssize_t>(points.size()), 3});
}

void save_png(const std::filesystem::path& path, const py::object& image) {
  if (!py::isinstance<LoadedImage>(image)) {
    const auto deep = image.cast<View<const std::uint16_t>>();
    return released([&] { io::save_png(path, deep); });
  }
  const auto& picture = image.cast<const LoadedImage&>();
  released([&] {
    if (picture.rgb().empty()) return io::save_png(path, picture.gray());
    io::save_png(path, picture.rgb());
  });
}

void bind_method(py::module_& m) {
  value_class<Frame>(m, "FrameData");
  auto provenance = value_class<output::Provenance>(m, "Provenance");
  shows(provenance, "config", [](const output::Provenance& p) { return PyConfig{p.preset, p.config, true}; });
  shows(provenance, "timings", [](const output::Provenance& p) {
    py::dict times;
    for (const output::StageTime& time : p.timings) times[py::str(time.stage)] = time.milliseconds;
    return times;
  });
  m.def("segment_pair", &segment_pair, Released());
  m.def("segment_given", &segment_given, Released());
  m.def("estimate_disparity", &disparity_of_pair, Released());
  py::class_<PySegmenter>(m, "SegmenterData")
      .def(py::init<const PyConfig&, const PyCalibration&, const Exec&>())
      .def("segment", &PySegmenter::segment, Released())
      .def("prefetch", &PySegmenter::prefetch, Released())
      .def_property_readonly("exec", &PySegmenter::exec);

  m.def("floor_of", [](const Frame& f, const output::Provenance& p) { return floor_frame(f.ground, p.rig); });
  m.def("scan", from_floor<ObstacleScan>(&scan_obstacles));
  m.def("grid", from_floor<ObstacleGrid>(&map_obstacles));
  m.def("ground_steps", from_floor<std::vector<GroundStep>>(&find_steps));
  m.def("points_of_pixels", &points_of_pixels, Released());
  m.def("points_of_object", &points_of_object, Released());
  m.def("to_json", &output::objects_json, Released());
  m.def(
      "save",
      [](const std::filesystem::path& folder, const LoadedImage& left, const Frame& frame,
         const output::Provenance& how) {
        output::write_result(folder, left.gray(), left.rgb(), frame, how);
      },
      Released());
}

/// io::Rectifier with the calibration of its results, that of the calib.txt of `cairn rectify`.
class PyRectifier {
 public:
  PyRectifier(const std::filesystem::path& path, const std::optional<std::pair<int, int>>& size,
              double nearest_m)
      : path_(path), raw_(io::load_raw_calibration(path, size_of(size))), rectify_(raw_) {
    calibration_.calibration.rig = rectify_.rig();
    calibration_.calibration.image_size = raw_.image_size;
    calibration_.calibration.num_disparities =
        io::disparities_down_to(nearest_m, rectify_.rig(), raw_.image_size.width);
  }

  [[nodiscard]] std::pair<io::LoadedImage, io::LoadedImage> rectified(const LoadedImage& left,
                                                                      const LoadedImage& right) const {
    try {
      io::LoadedPair pair = rectify_({own(left), own(right), 8});
      return {std::move(pair.left), std::move(pair.right)};
    } catch (const Error& error) {
      throw Error(path_.string() + ": " + error.what());
    }
  }
  [[nodiscard]] const PyCalibration& calibration() const { return calibration_; }

 private:
  static std::function<Size()> size_of(const std::optional<std::pair<int, int>>& size) {
    if (!size) return {};
    return [size] { return Size{size->first, size->second}; };
  }
  static io::LoadedImage own(const LoadedImage& image) {
    io::LoadedImage copy{copied(image.gray()), {}};
    if (!image.rgb().empty()) copy.rgb = copied(image.rgb());
    return copy;
  }

  std::filesystem::path path_;
  io::RawCalibration raw_;
  io::Rectifier rectify_;
  PyCalibration calibration_;
};

void bind_files_and_images(py::module_& m) {
  py::class_<PyRectifier>(m, "RectifierData")
      .def(py::init<const std::filesystem::path&, const std::optional<std::pair<int, int>>&, double>())
      .def("rectify", &PyRectifier::rectified, Released())
      .def_property_readonly("calibration", [](const PyRectifier& self) { return self.calibration(); });
  m.def(
      "load_picture", [](const std::filesystem::path& path) { return io::load_picture(path); }, Released());
  m.def(
      "load_pair",
      [](const std::filesystem::path& left, const std::filesystem::path& right) {
        io::LoadedPair pair = io::load_pair(left, right);
        return std::pair{std::move(pair.left), std::move(pair.right)};
      },
      Released());
  m.def(
      "load_disparity", [](const std::filesystem::path& path) { return io::load_disparity(path); },
      Released());
  m.def("save_disparity", &io::save_disparity, Released());
  m.def(
      "load_labels", [](const std::filesystem::path& path) { return io::load_labels(path).ids; }, Released());
  m.def("save_png", &save_png);
  m.def("png_bytes",
        [](View<const Rgb> image) { return py::bytes(released([&] { return io::png_bytes(image); })); });
  m.def(
      "draw_disparity",
      [](const DisparityMap& map, const PyCalibration& calibration) {
        return output::draw_disparity(map, calibration.rig());
      },
      Released());
  m.def(
      "draw_frame_disparity",
      [](const Frame& frame, const output::Provenance& how) {
        return output::draw_disparity(frame.disparity, how.rig,
                                      reasons_in_force(how.config, how.external_disparity));
      },
      Released());
  m.def(
      "draw_frame",
      [](const LoadedImage& left, const Frame& frame, const output::Provenance& how) {
        return output::draw_frame(left.gray(), left.rgb(), frame, how);
      },
      Released());
  m.def(
      "draw_objects",
      [](const LoadedImage& left, const Objects& objects, View<const std::uint8_t> floor) {
        return output::draw_objects(left.gray(), left.rgb(), objects, floor);
      },
      Released());
}

}  // namespace

void bind_frame(py::module_& m) {
  bind_method(m);
  bind_files_and_images(m);
}

}  // namespace cairn::python
