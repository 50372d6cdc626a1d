// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "options.hpp"

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/core/nearest.hpp>
#include <cairn/core/target.hpp>
#include <io/config_files.hpp>

#include "bindings.hpp"
#include "pickling.hpp"
#include "refusals.hpp"
#include "whole.hpp"

namespace cairn::python {
namespace {

/// A value as the library reads it from a command line.
std::string option_text(const py::handle& value) {
  if (py::isinstance<py::str>(value)) return value.cast<std::string>();
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::hasattr(value, "dtype") && py::hasattr(value, "tolist")) return option_text(value.attr("tolist")());
  if (py::isinstance<py::float_>(value)) {  // 64.0 stands for 64
    const auto number = value.cast<double>();
    constexpr double kMostExact = 1LL << 53;
    if (is_whole(number) && std::abs(number) <= kMostExact)
      return std::to_string(static_cast<std::int64_t>(number));
  }
  return py::str(value).cast<std::string>();
}

/// An option's text as a Python value of its type.
py::object option_value(const OptionInfo& option) {
  if (option.type == "bool") return py::bool_(option.value == "true");
  if (option.type == "int") return py::int_(py::str(option.value));
  if (option.type == "float") return py::float_(py::str(option.value));
  return py::str(option.value);
}

std::string file_name(const py::object& value, const char* name, const char* expected) {
  if (py::isinstance<py::str>(value) || py::hasattr(value, "__fspath__")) return py::str(value);
  throw ArgumentError(std::string(name) + ": found " + shown(value) + ", expected " + expected);
}

std::string group_of(const OptionInfo& option) {
  return option.name.substr(0, option.name.find('.'));
}
std::string name_in_group(const OptionInfo& option) {
  return option.name.substr(option.name.find('.') + 1);
}

bool is_group(const std::string& name) {
  const std::vector<OptionInfo> all = options(Config{});
  return std::any_of(all.begin(), all.end(), [&](const OptionInfo& o) { return group_of(o) == name; });
}

/// A keyword that is no group: perhaps an option by its name alone, or one misspelt.
[[noreturn]] void refuse_keyword(const std::string& name) {
  std::vector<std::string> known = all_groups();
  for (const OptionInfo& option : options(Config{})) {
    if (name_in_group(option) != name) continue;
    std::string text = "there is no keyword argument '";
    text.append(name).append("', did you mean ").append(group_of(option));
    throw ArgumentError(text.append("={'").append(name).append("': …}?"));
  }
  for (const char* other : {"rig", "preset", "config", "exec", "bgr"}) known.emplace_back(other);
  const std::string close = nearest(name, known);
  throw ArgumentError(
      "there is no keyword argument '" + name + "'" +
      (close.empty() ? "; cairn.options() lists the options" : ", did you mean '" + close + "'?"));
}

void set_groups(Config& config, const py::kwargs& groups) {
  for (const auto& [key, value] : groups) {
    const auto group = key.cast<std::string>();
    const bool has_options = py::isinstance<py::dict>(value) && py::len(value) > 0;
    if (!is_group(group) && !has_options) refuse_keyword(group);
    for (const auto& [name, text] : settings_of(group, value)) set(config, name, text);
  }
}

/// Only once all are set: in which order they were is of no account.
void require_effects(const Config& config, const py::kwargs& groups) {
  for (const auto& [key, value] : groups) {
    for (const auto& [name, setting] : py::reinterpret_borrow<py::dict>(value))
      require_active(config, key.cast<std::string>() + "." + py::str(name).cast<std::string>());
  }
}

PyConfig built(const std::string& preset, const std::optional<std::string>& file, const py::kwargs& groups,
               const Elsewhere& elsewhere, std::optional<int> range) {
  PyConfig made;
  const auto from_preset = [&](std::string_view name) {
    made.preset = name;
    Config config = Config::preset(name);
    if (range) config.match.num_disparities = *range;
    return config;
  };
  made.config = from_preset(preset);
  const auto keywords = [&](Config& config) { set_groups(config, groups); };
  if (file) io::load_config(*file, made.config, from_preset, keywords, elsewhere);
  keywords(made.config);
  require_effects(made.config, groups);
  return made;
}

py::dict as_dict(const PyConfig& self) {
  py::dict groups;
  for (const OptionInfo& option : active_options(self.config)) {
    const py::str group(group_of(option));
    if (!groups.contains(group)) groups[group] = py::dict();
    groups[group][py::str(name_in_group(option))] = option_value(option);
  }
  return groups;
}

/// What differs from the preset, as the constructor would take it.
std::string config_repr(const PyConfig& self) {
  const std::vector<OptionInfo> base = options(Config::preset(self.preset));
  const std::vector<OptionInfo> mine = options(self.config);
  py::dict groups;
  for (std::size_t i = 0; i < mine.size(); ++i) {
    if (!mine[i].active || mine[i].value == base[i].value) continue;
    const py::str group(group_of(mine[i]));
    if (!groups.contains(group)) groups[group] = py::dict();
    groups[group][py::str(name_in_group(mine[i]))] = option_value(mine[i]);
  }
  std::string text = "Config('" + self.preset + "'";
  for (const auto& [group, entries] : groups) {
    text += ", " + group.cast<std::string>() + "=" + py::repr(entries).cast<std::string>();
  }
  return text + ")";
}

std::string option_repr(const OptionInfo& o) {
  return "<cairn.Option " + o.name + " = " + o.value + (o.unit.empty() ? "" : " " + o.unit) + " (" +
         o.domain + (o.needs.empty() ? "" : ", read while " + o.needs) + "): " + o.help + ">";
}

std::string exec_repr(const Exec& exec) {
  return "Exec(threads=" + std::to_string(exec.threads()) + ", target='" + std::string(name(exec.target)) +
         "')";
}

Exec make_exec(Whole wanted, const std::string& target) {
  const int threads = wanted.value;
  constexpr int kMostThreads = 1024;
  if (threads < 0 || threads > kMostThreads) {
    throw Error("threads: found " + std::to_string(threads) + ", expected 0 … " +
                std::to_string(kMostThreads) + "; 0 = one for each processor");
  }
  Exec exec = Exec::with_threads(threads, wanted_target(target, "target"));
  exec.pool = Pool::make();
  return exec;
}

std::vector<std::string> names_of(const std::vector<Target>& targets) {
  std::vector<std::string> names;
  names.reserve(targets.size());
  for (const Target target : targets) names.emplace_back(name(target));
  return names;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> settings_of(const std::string& group,
                                                             const py::handle& value) {
  if (!py::isinstance<py::dict>(value)) {
    throw ArgumentError("options " + group + ": found " + shown(value) +
                        ", expected a dict such as match={\"num_disparities\": 64}");
  }
  std::vector<std::pair<std::string, std::string>> settings;
  for (const auto& [name, setting] : py::reinterpret_borrow<py::dict>(value))
    settings.emplace_back(group + "." + py::str(name).cast<std::string>(), option_text(setting));
  return settings;
}

py::object option_of(const PyConfig& self, const std::string& name) {
  for (const OptionInfo& option : options(self.config)) {
    if (option.name == name) return option_value(option);
  }
  Config copy;
  set(copy, name, "");  // throws, with the nearest name
  return py::none();
}

Config PyConfig::suited(const io::Calibration& calibration) const {
  Config wanted = config;
  if (calibration.num_disparities && !range_given)
    set(wanted, "match.num_disparities", std::to_string(*calibration.num_disparities));
  wanted.ground.known = calibration.ground;
  return wanted;
}

PyConfig make_config(const std::string& preset, const std::optional<std::string>& file,
                     const py::kwargs& groups, const Elsewhere& elsewhere) {
  PyConfig made = built(preset, file, groups, elsewhere, std::nullopt);
  // Given is what does not follow the default.
  const int other = made.config.match.num_disparities + 1;
  made.range_given = built(preset, file, groups, elsewhere, other).config.match.num_disparities != other;
  return made;
}

PyConfig config_of(const py::object& config, const std::string& preset, const py::kwargs& groups,
                   const Elsewhere& elsewhere) {
  if (config.is_none()) return make_config(preset, std::nullopt, groups);
  if (!py::isinstance<PyConfig>(config)) {
    const std::string file = file_name(config, "config", "a cairn.Config, the name of a file, or None");
    return make_config(preset, file, groups, elsewhere);
  }
  auto made = config.cast<PyConfig>();
  if (preset != "default" && preset != made.preset) {
    throw Error("preset: found '" + preset + "' beside a config of preset '" + made.preset +
                "', expected one of the two");
  }
  set_groups(made.config, groups);
  require_effects(made.config, groups);
  if (groups.contains("match") && py::dict(groups["match"]).contains("num_disparities"))
    made.range_given = true;
  return made;
}

void set_flat(Config& config, const Groups& groups, const py::kwargs& keywords) {
  const std::vector<OptionInfo> all = options(config);
  std::vector<std::string> names;
  for (const auto& [key, value] : keywords) {
    const auto name = key.cast<std::string>();
    const auto group = std::find_if(groups.begin(), groups.end(), [&](const std::string& candidate) {
      return std::any_of(all.begin(), all.end(), [&](const OptionInfo& o) {
        return group_of(o) == candidate && name_in_group(o) == name;
      });
    });
    if (group == groups.end() && groups.empty())
      throw ArgumentError("there is no keyword argument '" + name + "'");
    names.push_back((group == groups.end() ? groups.front() : *group) + "." + name);
    set(config, names.back(), option_text(value));
  }
  // A stage by itself is done, whatever the other groups say.
  for (const std::string& name : names) require_active(config, name, groups);
}

Exec exec_of(const py::object& exec) {
  if (exec.is_none()) return Exec::with_threads(0);
  if (py::isinstance<Exec>(exec)) return exec.cast<Exec>();
  throw ArgumentError("exec: found " + shown(exec) + ", expected a cairn.Exec or None");
}

Config stage_config(const py::object& config) {
  if (config.is_none()) return {};
  if (py::isinstance<PyConfig>(config)) return config.cast<const PyConfig&>().config;
  throw ArgumentError("config: found " + shown(config) + ", expected a cairn.Config or None");
}

std::string with_options(const std::string& doc, const Groups& groups, bool grouped) {
  std::string text = doc + "\n\n";
  if (grouped) {
    text += "Options, a dict for each group of cairn.options(), e.g. match={\"num_disparities\": 64}:\n";
  } else if (!groups.empty()) {
    text += "Options, as keywords (defaults: those of `config`, shown is the preset default):\n";
  }
  for (const std::string& group : groups) {
    if (grouped) text += "    " + group + "\n";
    for (const OptionInfo& o : options(Config{})) {
      if (group_of(o) != group) continue;
      text += (grouped ? "        " : "    ") + name_in_group(o) + " = " + o.value +
              (o.unit.empty() ? "" : " " + o.unit) + " (" + o.domain +
              (o.needs.empty() ? "" : ", read while " + o.needs) + "): " + o.help + "\n";
    }
  }
  return text +
         "\nconfig: a cairn.Config; None is the preset default. exec: a cairn.Exec; None is all processors.";
}

void note_groups(const py::module_& module, const char* function, const Groups& groups, bool grouped) {
  if (!py::hasattr(module, "_options_of")) module.attr("_options_of") = py::dict();
  module.attr("_options_of")[function] = py::make_tuple(grouped, groups);
}

void bind_options(py::module_& m) {
  py::class_<OptionInfo>(m, "Option",
                         "One option of the method, as the command and the reference page name it.")
      .def_readonly("name", &OptionInfo::name, "its group and name, 'match.window_size'")
      .def_property_readonly(
          "group", [](const OptionInfo& self) { return group_of(self); },
          "the stage that it belongs to, 'match'")
      .def_readonly("type", &OptionInfo::type, "'int', 'float', 'bool' or 'choice'")
      .def_property_readonly(
          "default", [](const OptionInfo& self) { return option_value(self); },
          "value in the preset asked for")
      .def_readonly("unit", &OptionInfo::unit, "may be empty")
      .def_readonly("range", &OptionInfo::domain, "'3 … 31, odd', '−1 = off, 0 … 64', 'sad|ssd|…'")
      .def_readonly("help", &OptionInfo::help, "what it does")
      .def_readonly(
          "needs", &OptionInfo::needs,
          "'match.method=window', 'ground.source!=off': it is read only while that is so; '' = always")
      .def_readonly("active", &OptionInfo::active, "whether the preset asked for reads it")
      .def("__repr__", &option_repr)
      .def(pickled<OptionInfo>());
  m.def(
      "options", [](const std::string& preset) { return options(Config::preset(preset)); },
      py::arg("preset") = "default", "Every option with its value in a preset, in the order of the stages.");
  m.def("preset_names", &preset_names, "The presets by name: 'default', 'paper'.");

  py::class_<PyConfig>(
      m, "Config",
      "What is computed: every option's value. Made from a preset, then a file (as `cairn config` "
      "prints it), then keywords; later ones win:\n"
      "    cairn.Config('paper', match={'window_size': 11})\n"
      "Raises cairn.Error for an unknown name, a value out of range, and an option that would have no "
      "effect.")
      .def(py::init([](const std::string& preset, const py::object& file, const py::kwargs& groups) {
             std::optional<std::string> path;
             if (!file.is_none()) path = file_name(file, "file", "the name of a file or None");
             return make_config(preset, path, groups);
           }),
           py::arg("preset") = "default", py::arg("file") = py::none(),
           "preset: one of preset_names(). file: a configuration file's name, or None. Then a dict for each "
           "group of options().")
      .def_readonly("preset", &PyConfig::preset, "what it started from")
      .def("__getitem__", &option_of, py::arg("name"),
           "The value of an option by its full name, 'match.window_size'.")
      .def("as_dict", &as_dict,
           "The values of all options that it reads: a dict of the groups' dicts. Config(**config.as_dict()) "
           "is its equal.")
      .def(
          "yaml", [](const PyConfig& self) { return io::config_yaml(self.config); },
          "The text of a configuration file: the options that it reads, one comment for each.")
      .def(
          "__eq__",
          [](const PyConfig& self, const PyConfig& other) {
            return io::config_yaml(self.config) == io::config_yaml(other.config);
          },
          py::is_operator())
      .def("__repr__", &config_repr)
      .def(pickled<PyConfig>());
  note_groups(m, "Config", all_groups(), true);

  py::class_<Exec>(
      m, "Exec",
      "How the work is done: threads, instruction set, a pool of image buffers. Never changes a result.")
      .def(py::init(&make_exec), py::arg("threads") = 0, py::arg("target") = "best",
           "threads: 0 = one for each processor. target: 'best' or one of supported_targets().")
      .def_property_readonly("threads", &Exec::threads, "how many work, the caller's among them; 1 or more")
      .def_property_readonly(
          "target", [](const Exec& self) { return std::string(name(active_target(self))); },
          "the instruction set that the kernels run on")
      .def_property_readonly(
          "heap_allocations", [](const Exec& self) { return self.pool.heap_allocations(); },
          "how many image buffers its pool has asked the heap for")
      .def("__repr__", &exec_repr)
      .def(py::pickle(
          [](const Exec& self) {
            return versioned(py::make_tuple(self.threads(), std::string(name(self.target))));
          },
          [](const py::tuple& state) {
            const auto parts = py::reinterpret_borrow<py::tuple>(of_this_version(state));
            return make_exec({parts[0].cast<int>()}, parts[1].cast<std::string>());
          }));
  m.def(
      "compiled_targets", [] { return names_of(compiled_targets()); },
      "The instruction sets in this build, slowest first.");
  m.def(
      "supported_targets", [] { return names_of(supported_targets()); },
      "Those of them that this processor has, slowest first.");
}

Groups all_groups() {
  Groups groups;
  for (const OptionInfo& option : options(Config{})) {
    if (groups.empty() || groups.back() != group_of(option)) groups.push_back(group_of(option));
  }
  return groups;
}

}  // namespace cairn::python
