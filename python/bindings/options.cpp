// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "options.hpp"

#include <cairn/core/nearest.hpp>
#include <cairn/core/target.hpp>
#include <cairn/device/device.hpp>
#include <cairn/io/config_files.hpp>

#include "bindings.hpp"
#include "value_class.hpp"

namespace cairn::python {

CAIRN_MEMBERS(OptionInfo, name, type, _value, unit, range, help, needs, active)

namespace {

PyConfig built(const std::string& preset, const std::optional<std::string>& file, const Settings& settings,
               const Elsewhere& elsewhere, std::optional<int> range) {
  PyConfig made;
  const auto from_preset = [&](std::string_view name) {
    made.preset = name;
    Config config = Config::preset(name);
    if (range) config.match.num_disparities = *range;
    return config;
  };
  made.config = from_preset(preset);
  const auto set_all = [&](Config& config) {
    for (const auto& [name, value] : settings) set(config, name, value);
  };
  if (file) io::load_config(*file, made.config, from_preset, set_all, elsewhere);
  set_all(made.config);
  for (const auto& setting : settings) require_active(made.config, setting.first);
  return made;
}

/// Throws Error for an option without effect: within these groups, for a stage called directly.
PyConfig with(PyConfig config, const Settings& settings, const std::vector<std::string>& groups) {
  for (const auto& [name, value] : settings) {
    set(config.config, name, value);
    config.range_given |= name == "match.num_disparities";
  }
  for (const auto& setting : settings) require_active(config.config, setting.first, groups);
  return config;
}

/// From any thread, without the interpreter's lock: a thread that holds it may be waiting for this one.
void warn_later(const std::string& says) {
  auto text = std::make_unique<std::string>(says);
  const auto warn = [](void* given) {
    const std::unique_ptr<std::string> says_now(static_cast<std::string*>(given));
    return PyErr_WarnEx(PyExc_RuntimeWarning, says_now->c_str(), 1);
  };
  if (Py_AddPendingCall(warn, text.get()) == 0) text.release();
}

Exec make_exec(int threads, const std::string& target, const std::string& wanted_device) {
  constexpr int kMaxThreads = 1024;
  if (threads < 0 || threads > kMaxThreads) {
    throw Error("threads: found " + std::to_string(threads) + ", expected 0 … " +
                std::to_string(kMaxThreads) + "; 0 = one for each processor");
  }
  Exec exec = Exec::with_threads(threads, wanted_target(target, "target"));
  exec.pool = Pool::make();
  exec.device = device::open(wanted_device, "device", warn_later);
  return exec;
}

std::vector<std::string> names_of(const std::vector<Target>& targets) {
  std::vector<std::string> names;
  for (const Target target : targets) names.emplace_back(name(target));
  return names;
}

PyCalibration make_calibration(const std::optional<StereoRig>& rig, std::optional<Size> image_size,
                               std::optional<int> num_disparities, std::vector<PointPair> ground_points,
                               std::optional<float> camera_height_m, float camera_pitch_deg,
                               float camera_roll_deg) {
  KnownGround ground{std::move(ground_points), camera_height_m, camera_pitch_deg, camera_roll_deg};
  validate(ground);
  return {{rig, image_size, num_disparities, std::move(ground)}, "Calibration()"};
}

}  // namespace

PyConfig make_config(const std::string& preset, const std::optional<std::string>& file,
                     const Settings& settings, const Elsewhere& elsewhere) {
  PyConfig made = built(preset, file, settings, elsewhere, std::nullopt);
  // The number of disparities counts as given if it differs from the default.
  const int other = made.config.match.num_disparities + 1;
  made.range_given = built(preset, file, settings, elsewhere, other).config.match.num_disparities != other;
  return made;
}

PyConfig PyConfig::suited(const io::Calibration& calibration) const {
  PyConfig wanted = *this;
  if (calibration.num_disparities && !range_given)
    set(wanted.config, "match.num_disparities", std::to_string(*calibration.num_disparities));
  wanted.config.ground.known = calibration.ground;
  return wanted;
}

namespace {

void bind_config_and_exec(py::module_& m) {
  auto option = value_class<OptionInfo>(m, "Option");
  shows(option, "_text", &OptionInfo::value);
  m.def("preset_names", &preset_names);
  m.def("nearest", &nearest);
  m.def("make_config", [](const std::string& preset, const std::optional<std::string>& file,
                          const Settings& settings) { return make_config(preset, file, settings); });

  value_class<PyConfig>(m, "Config")
      .def(py::init([](const std::string& preset, const std::optional<std::string>& file,
                       const Settings& settings) { return make_config(preset, file, settings); }))
      .def("_options", [](const PyConfig& self) { return options(self.config); })
      .def("_with", &with)
      .def("_suited", [](const PyConfig& self, const PyCalibration& c) { return self.suited(c.calibration); })
      .def("_yaml", [](const PyConfig& self) { return io::config_yaml(self.config); });

  py::class_<Exec> of_exec(m, "Exec");
  of_exec.def(py::init(&make_exec));
  shows(of_exec, "threads", &Exec::threads);
  shows(of_exec, "target", [](const Exec& self) { return std::string(name(active_target(self))); });
  shows(of_exec, "device",
        [](const Exec& self) { return self.device ? self.device->report().wanted : std::string("off"); });
  shows(of_exec, "heap_allocations", [](const Exec& self) { return self.pool.heap_allocations(); });
  m.def("exec_of_all_processors", [] { return Exec::with_threads(0); });
  m.def("compiled_targets", [] { return names_of(compiled_targets()); });
  m.def("supported_targets", [] { return names_of(supported_targets()); });
}

void bind_rigs_and_pictures(py::module_& m) {
  value_class<StereoRig>(m, "Rig")
      .def(py::init([](float focal_px, float baseline_m, float cx_px, float cy_px, float doffs_px) {
        const StereoRig rig{focal_px, cx_px, cy_px, baseline_m, doffs_px};
        rig.validate();
        return rig;
      }))
      .def("_point", &StereoRig::point_in_camera_m);
  value_class<KnownGround>(m, "KnownGround");
  value_class<io::Calibration>(m, "CalibrationFile");
  py::class_<PyCalibration> calibration = value_class<PyCalibration>(m, "Calibration");
  calibration.def(py::init(&make_calibration));
  constexpr auto kPart = py::return_value_policy::reference_internal;
  calibration.def(
      "_file", [](const PyCalibration& c) { return &c.calibration; }, kPart);
  calibration.def(
      "_ground", [](const PyCalibration& c) { return &c.calibration.ground; }, kPart);
  m.def("load_calibration", [](const std::filesystem::path& path, bool grey_cameras) {
    return PyCalibration{io::load_calibration(path, grey_cameras), path};
  });

  py::class_<LoadedImage>(m, "Picture")
      .def(py::init([](py::array array, bool bgr, const Exec& exec) {
        return LoadedImage(std::move(array), bgr, exec.pool);
      }))
      .def_property_readonly(
          "shape", [](const LoadedImage& p) { return py::make_tuple(p.gray().height(), p.gray().width()); })
      .def_property_readonly("address",
                             [](const LoadedImage& p) {  // of the pixels, for the test that none are copied
                               return p.rgb().empty() ? reinterpret_cast<std::size_t>(p.gray().data())
                                                      : reinterpret_cast<std::size_t>(p.rgb().data());
                             })
      .def("copy", &LoadedImage::copy)
      .def(py::pickle(
          [](const LoadedImage& self) { return py::make_tuple(self.copy()); },
          [](const py::tuple& state) { return LoadedImage(state[0].cast<py::array>(), false, {}); }));
  m.def("is_dense", &is_dense);
}

}  // namespace

void bind_options(py::module_& m) {
  bind_config_and_exec(m);
  bind_rigs_and_pictures(m);
}

}  // namespace cairn::python
