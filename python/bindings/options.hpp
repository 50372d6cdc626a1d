// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/pybind11.h>

#include <cairn/core/error.hpp>
#include <cairn/core/exec.hpp>
#include <cairn/pipeline/config.hpp>
#include <functional>
#include <io/calibration_files.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Keywords to options and back. Names, defaults, units, ranges and words are the library's: options(Config).
namespace cairn::python {

namespace py = pybind11;

/// cairn.ArgumentError, an Error and a TypeError: an argument of a wrong type, one too many, none.
class ArgumentError : public Error {
 public:
  using Error::Error;
};

/// What an error message shows of a value: '3', "'x'", or its type where it is no plain number or text.
std::string shown(const py::handle& value);

/// A configuration and where it comes from.
struct PyConfig {
  std::string preset = "default";
  Config config;
  bool range_given = false;  // match.num_disparities was set, not left to the preset

  /// The configuration of frames that were taken with this calibration: its number of disparities is the
  /// default, and what it knows of the ground is known.
  [[nodiscard]] Config suited(const io::Calibration& calibration) const;
};

/// Takes options of a file that are of another configuration, see io::load_config().
using Elsewhere = std::function<bool(std::string_view name, std::string_view value)>;
/// Preset, then a file, then keywords such as match={"num_disparities": 64}; later ones win, as in the
/// command. `config`: None, a Config (then `preset` is its own), or a file's name. Throws Error.
PyConfig config_of(const py::object& config, const std::string& preset, const py::dict& groups,
                   const Elsewhere& elsewhere = {});
/// A dict of options as text, by their full names. Throws Error where it is none.
std::vector<std::pair<std::string, std::string>> settings_of(const std::string& group,
                                                             const py::handle& value);

/// The options of one or more groups as keywords without the group's name. Throws Error where one has no
/// effect, as far as these groups say.
using Groups = std::vector<std::string>;
void set_flat(Config& config, const Groups& groups, const py::dict& keywords);

/// `None` = all processors; else what a cairn.Exec holds.
Exec exec_of(const py::object& exec);
/// `None` = the preset `default`; else what a cairn.Config holds.
Config stage_config(const py::object& config);

/// The names of all groups, in the order of the stages.
Groups all_groups();
/// A line for each option of the groups, and what config and exec are.
std::string options_text(const Groups& groups, bool by_group);

}  // namespace cairn::python
