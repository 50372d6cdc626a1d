// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/pybind11.h>

#include <cairn/core/exec.hpp>
#include <cairn/pipeline/config.hpp>
#include <functional>
#include <io/calibration_files.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arrays.hpp"

/// Keywords to options and back. Names, defaults, units, ranges and words are the library's: options(Config).
namespace cairn::python {

/// A configuration and where it comes from.
struct PyConfig {
  std::string preset = "default";
  Config config;
  bool range_given = false;  // match.num_disparities was set, not left to the preset

  /// The configuration of frames that were taken with this calibration: its number of disparities is the
  /// default, and what it knows of the ground is known.
  [[nodiscard]] Config suited(const io::Calibration& calibration) const;
};

/// Preset, then a file, then keywords such as match={"num_disparities": 64}; later ones win, as in the
/// command.
/// `elsewhere` takes options of the file that are of another configuration, see io::load_config().
using Elsewhere = std::function<bool(std::string_view name, std::string_view value)>;
PyConfig make_config(const std::string& preset, const std::optional<std::string>& file,
                     const py::kwargs& groups, const Elsewhere& elsewhere = {});
/// What segment() and its like take for `config`: None, a Config (then `preset` is its own), or a file.
PyConfig config_of(const py::object& config, const std::string& preset, const py::kwargs& groups,
                   const Elsewhere& elsewhere = {});
/// A dict of options as text, by their full names. Throws Error where it is none.
std::vector<std::pair<std::string, std::string>> settings_of(const std::string& group,
                                                             const py::handle& value);

/// The value of an option by its full name. Throws Error, with the nearest name, where there is none.
pybind11::object option_of(const PyConfig& self, const std::string& name);

/// The options of one or more groups as keywords without the group's name. Throws Error where one has no
/// effect, as far as these groups say.
using Groups = std::vector<std::string>;
void set_flat(Config& config, const Groups& groups, const py::kwargs& keywords);

/// `None` = all processors; else what a cairn.Exec holds.
Exec exec_of(const py::object& exec);
/// `None` = the preset `default`; else what a cairn.Config holds.
Config stage_config(const py::object& config);

/// The names of all groups, in the order of the stages.
Groups all_groups();

/// A docstring with a line for each option of the groups, indented.
std::string with_options(const std::string& doc, const Groups& groups, bool grouped);

/// Remembers for `cairn._options_of` which groups a function's keywords come from; grouped: as dictionaries.
void note_groups(const py::module_& module, const char* function, const Groups& groups, bool grouped);

/// A stage: `stage(config, exec, arguments…)` becomes a function of its C++ name whose options are keywords.
/// `settle` sets beforehand what the stage does whatever the configuration says.
template <class R, class... A, class... Extra>
void def_stage(py::module_& module, const char* name, const Groups& groups, void (*settle)(Config&),
               const char* doc, R (*stage)(const Config&, const Exec&, A...), const Extra&... extra) {
  const std::string all = with_options(doc, groups, false);
  module.def(
      name,
      [stage, groups, settle](A... arguments, const py::object& config, const py::object& exec,
                              const py::kwargs& options) -> R {
        Config wanted = stage_config(config);
        settle(wanted);
        set_flat(wanted, groups, options);
        return stage(wanted, exec_of(exec), std::forward<A>(arguments)...);
      },
      extra..., py::arg("config") = py::none(), py::arg("exec") = py::none(), all.c_str());
  note_groups(module, name, groups, false);
}
template <class R, class... A, class... Extra>
void def_stage(py::module_& module, const char* name, const Groups& groups, const char* doc,
               R (*stage)(const Config&, const Exec&, A...), const Extra&... extra) {
  constexpr auto kNothing = +[](Config&) {};
  def_stage(module, name, groups, kNothing, doc, stage, extra...);
}

}  // namespace cairn::python
