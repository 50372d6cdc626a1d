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

/// Conversion between keywords and options. Names, defaults, units, ranges and descriptions come from
/// options(Config).
namespace cairn::python {

namespace py = pybind11;

/// cairn.ArgumentError, an Error and a TypeError: an argument has the wrong type, is missing or unexpected.
class ArgumentError : public Error {
 public:
  using Error::Error;
};

/// A value in an error message: '3', "'x'", or its type if it is not a plain number or text.
std::string shown(const py::handle& value);

/// A configuration and its origin.
struct PyConfig {
  std::string preset = "default";
  Config config;
  bool range_given = false;  // match.num_disparities was set explicitly

  /// The configuration for frames with this calibration: uses its number of disparities as the default, and
  /// its ground.
  [[nodiscard]] Config suited(const io::Calibration& calibration) const;
};

/// Applies the options of a file that belong to another configuration, see io::load_config().
using Elsewhere = std::function<bool(std::string_view name, std::string_view value)>;
/// Preset, then file, then keywords such as match={"num_disparities": 64}; later ones win, as in the command.
/// `config`: None, a Config (which has its own `preset`), or a file name. Throws Error.
PyConfig config_of(const py::object& config, const std::string& preset, const py::dict& groups,
                   const Elsewhere& elsewhere = {});
/// A dict of options as text, by full name. Throws Error for other types.
std::vector<std::pair<std::string, std::string>> settings_of(const std::string& group,
                                                             const py::handle& value);

/// The options of one or more groups as keywords without the group's name. Throws Error for an option without
/// effect within these groups.
using Groups = std::vector<std::string>;
void set_flat(Config& config, const Groups& groups, const py::dict& keywords);

/// `None` = all processors; else the value of a cairn.Exec.
Exec exec_of(const py::object& exec);
/// `None` = the preset `default`; else the value of a cairn.Config.
Config stage_config(const py::object& config);

/// The names of all groups, in the order of the stages.
Groups all_groups();
/// A line for each option of the groups, and for config and exec.
std::string options_text(const Groups& groups, bool by_group);

}  // namespace cairn::python
