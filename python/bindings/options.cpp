// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "options.hpp"

#include <algorithm>
#include <cairn/core/nearest.hpp>
#include <cairn/core/target.hpp>
#include <cmath>
#include <io/config_files.hpp>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

/// A value in the syntax of the command line.
std::string option_text(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (py::hasattr(value, "dtype") && py::hasattr(value, "tolist")) return option_text(value.attr("tolist")());
  // 64.0 is accepted as 64.
  if (py::isinstance<py::float_>(value) && value.attr("is_integer")().cast<bool>() &&
      std::abs(value.cast<double>()) <= double(1LL << 53))
    return py::str(py::int_(py::reinterpret_borrow<py::object>(value)));
  return py::str(value);
}

/// An option's text as a Python value of its type.
py::object option_value(const OptionInfo& option) {
  if (option.type == "bool") return py::bool_(option.value == "true");
  if (option.type == "int") return py::int_(py::str(option.value));
  if (option.type == "float") return py::float_(py::str(option.value));
  return py::str(option.value);
}

std::string group_of(const OptionInfo& option) {
  return option.name.substr(0, option.name.find('.'));
}
std::string name_in_group(const OptionInfo& option) {
  return option.name.substr(option.name.find('.') + 1);
}

bool is_file_name(const py::object& value) {
  return py::isinstance<py::str>(value) || py::hasattr(value, "__fspath__");
}

/// Handles a keyword that is no group: an option without its group, or a misspelling.
[[noreturn]] void refuse_keyword(const std::string& name) {
  std::string text = "there is no keyword argument '" + name + "'";
  for (const OptionInfo& option : options(Config{})) {
    if (name_in_group(option) == name)
      throw ArgumentError(text + ", did you mean " + group_of(option) + "={'" + name + "': …}?");
  }
  std::vector<std::string> known = all_groups();
  for (const char* other : {"rig", "preset", "config", "exec", "bgr"}) known.emplace_back(other);
  const std::string close = nearest(name, known);
  throw ArgumentError(
      text + (close.empty() ? "; cairn.options() lists the options" : ", did you mean '" + close + "'?"));
}

void set_groups(Config& config, const py::dict& groups) {
  const Groups known = all_groups();
  for (const auto& [key, value] : groups) {
    const auto group = key.cast<std::string>();
    const bool has_options = py::isinstance<py::dict>(value) && py::len(value) > 0;
    if (!has_options && std::find(known.begin(), known.end(), group) == known.end()) refuse_keyword(group);
    for (const auto& [name, text] : settings_of(group, value)) set(config, name, text);
  }
}

/// Checked after all are set, since their order does not matter.
void require_effects(const Config& config, const py::dict& groups) {
  for (const auto& [key, value] : groups) {
    for (const auto& [name, text] : settings_of(key.cast<std::string>(), value)) require_active(config, name);
  }
}

PyConfig built(const std::string& preset, const std::optional<std::string>& file, const py::dict& groups,
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

PyConfig make_config(const std::string& preset, const std::optional<std::string>& file,
                     const py::dict& groups, const Elsewhere& elsewhere = {}) {
  PyConfig made = built(preset, file, groups, elsewhere, std::nullopt);
  // The number of disparities counts as given if it differs from the default.
  const int other = made.config.match.num_disparities + 1;
  made.range_given = built(preset, file, groups, elsewhere, other).config.match.num_disparities != other;
  return made;
}

/// The values of the options by group: all active ones, or only those that differ from the preset.
py::dict by_group(const PyConfig& self, bool only_changes) {
  const std::vector<OptionInfo> base = options(Config::preset(self.preset));
  py::dict groups;
  std::size_t i = 0;
  for (const OptionInfo& option : options(self.config)) {
    const bool is_changed = option.value != base[i++].value;
    if (!option.active || (only_changes && !is_changed)) continue;
    const py::str group(group_of(option));
    if (!groups.contains(group)) groups[group] = py::dict();
    groups[group][py::str(name_in_group(option))] = option_value(option);
  }
  return groups;
}

/// In the syntax of the constructor.
std::string config_repr(const PyConfig& self) {
  std::string text = "Config('" + self.preset + "'";
  for (const auto& [group, entries] : by_group(self, true))
    text += ", " + group.cast<std::string>() + "=" + py::repr(entries).cast<std::string>();
  return text + ")";
}

py::object option_of(const PyConfig& self, const std::string& name) {
  for (const OptionInfo& option : options(self.config)) {
    if (option.name == name) return option_value(option);
  }
  Config copy;
  set(copy, name, "");  // throws and suggests the nearest name
  return py::none();
}

Exec make_exec(int threads, const std::string& target) {
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
  for (const Target target : targets) names.emplace_back(name(target));
  return names;
}

/// "9 px (3 … 31, odd, read while match.method=window): side of the window"
std::string option_text(const OptionInfo& o) {
  return o.value + (o.unit.empty() ? "" : " " + o.unit) + " (" + o.domain +
         (o.needs.empty() ? "" : ", read while " + o.needs) + "): " + o.help;
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

Config PyConfig::suited(const io::Calibration& calibration) const {
  Config wanted = config;
  if (calibration.num_disparities && !range_given)
    set(wanted, "match.num_disparities", std::to_string(*calibration.num_disparities));
  wanted.ground.known = calibration.ground;
  return wanted;
}

PyConfig config_of(const py::object& config, const std::string& preset, const py::dict& groups,
                   const Elsewhere& elsewhere) {
  if (config.is_none()) return make_config(preset, std::nullopt, groups);
  if (is_file_name(config)) return make_config(preset, py::str(config), groups, elsewhere);
  if (!py::isinstance<PyConfig>(config))
    throw ArgumentError("config: found " + shown(config) +
                        ", expected a cairn.Config, the name of a file, or None");
  auto made = config.cast<PyConfig>();
  if (preset != "default" && preset != made.preset) {
    throw Error("preset: found '" + preset + "' together with a config of preset '" + made.preset +
                "', expected one of the two");
  }
  set_groups(made.config, groups);
  require_effects(made.config, groups);
  made.range_given |= groups.contains("match") && py::dict(groups["match"]).contains("num_disparities");
  return made;
}

void set_flat(Config& config, const Groups& groups, const py::dict& keywords) {
  std::vector<std::string> names;
  for (const auto& [key, value] : keywords) {
    const auto wanted = key.cast<std::string>();
    if (groups.empty()) throw ArgumentError("there is no keyword argument '" + wanted + "'");
    std::string name = groups.front() + "." + wanted;
    for (const OptionInfo& option : options(config)) {
      if (name_in_group(option) == wanted &&
          std::find(groups.begin(), groups.end(), group_of(option)) != groups.end())
        name = option.name;
    }
    set(config, name, option_text(value));
    names.push_back(std::move(name));
  }
  // A stage called directly runs, whatever the options of other groups say.
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

Groups all_groups() {
  Groups groups;
  for (const OptionInfo& option : options(Config{})) {
    if (groups.empty() || groups.back() != group_of(option)) groups.push_back(group_of(option));
  }
  return groups;
}

std::string options_text(const Groups& groups, bool is_by_group) {
  std::string text;
  if (is_by_group) {
    text = "\n\nOptions, a dict for each group of cairn.options(), e.g. match={\"num_disparities\": 64}:\n";
  } else if (!groups.empty()) {
    text = "\n\nOptions, as keywords (defaults: those of `config`, shown is the preset default):\n";
  }
  for (const std::string& group : groups) {
    if (is_by_group) text += "    " + group + "\n";
    for (const OptionInfo& o : options(Config{})) {
      if (group_of(o) == group)
        text += (is_by_group ? "        " : "    ") + name_in_group(o) + " = " + option_text(o) + "\n";
    }
  }
  return text +
         "\n\nconfig: a cairn.Config; None is the preset default. exec: a cairn.Exec; None is all "
         "processors.";
}

void bind_options(py::module_& m) {
  using py::literals::operator""_a;
  Class<OptionInfo>(m, "Option", "One option of the method, as the command and the reference page name it.")
      .shows("name", &OptionInfo::name, "its group and name, 'match.window_size'")
      .shows("group", &group_of, "the stage that it belongs to, 'match'")
      .shows("type", &OptionInfo::type, "'int', 'float', 'bool' or 'choice'")
      .shows("default", &option_value, "value in the preset asked for")
      .shows("unit", &OptionInfo::unit, "may be empty")
      .shows("range", &OptionInfo::domain, "'3 … 31, odd', '−1 = off, 0 … 64', 'sad|ssd|…'")
      .shows("help", &OptionInfo::help, "what it does")
      .shows("needs", &OptionInfo::needs,
             "'match.method=window', 'ground.source!=off': it is read only while that is so; '' = always")
      .shows("active", &OptionInfo::active, "whether the preset asked for reads it");
  define(
      m, "options", "Every option with its value in a preset, in the order of the stages.",
      [](const std::string& preset) { return options(Config::preset(preset)); }, "preset"_a = "default");
  define(m, "preset_names", "The presets by name: 'default', 'paper'.", &preset_names);

  Class<PyConfig>(
      m, "Config",
      "What is computed: every option's value. Made from a preset, then a file (as `cairn config` prints "
      "it), then keywords; later ones win:\n"
      "    cairn.Config('paper', match={'window_size': 11})\n"
      "Raises cairn.Error for an unknown name, a value out of range, and an option without effect.")
      .made_by(
          {Keywords::groups_alone, all_groups()},
          "preset: one of preset_names(). file: a configuration file's name, or None. Then a dict for each "
          "group of "
          "options().",
          [](const Call& call, const std::string& preset, const Typed<"Optional[PathLike]">& file) {
            std::optional<std::string> path;
            if (!file.is_none()) {
              if (!is_file_name(file))
                throw ArgumentError("file: found " + shown(file) + ", expected the name of a file or None");
              path = py::str(py::object(file));
            }
            return make_config(preset, path, call.options);
          },
          "preset"_a = "default", "file"_a = py::none())
      .shows("preset", &PyConfig::preset, "what it started from")
      .method("__getitem__", "The value of an option by its full name, 'match.window_size'.", &option_of,
              "name"_a)
      .method("as_dict",
              "The values of all options that it reads: a dict of the groups' dicts. "
              "Config(**config.as_dict()) is its "
              "equal.",
              [](const PyConfig& self) { return by_group(self, false); })
      .method("yaml", "The text of a configuration file: the options that it reads, one comment for each.",
              [](const PyConfig& self) { return io::config_yaml(self.config); })
      .def(
          "__eq__",
          [](const PyConfig& self, const PyConfig& other) {
            return io::config_yaml(self.config) == io::config_yaml(other.config);
          },
          py::is_operator())
      .says(&config_repr);

  Class<Exec>(
      m, "Exec",
      "How the work is done: threads, instruction set, a pool of image buffers. Never changes a result.")
      .made_by({}, "threads: 0 = one for each processor. target: 'best' or one of supported_targets().",
               &make_exec, "threads"_a = 0, "target"_a = "best")
      .shows("threads", &Exec::threads, "how many work, the caller's among them; 1 or more")
      .shows(
          "target", [](const Exec& self) { return std::string(name(active_target(self))); },
          "the instruction set that the kernels run on")
      .shows(
          "heap_allocations", [](const Exec& self) { return self.pool.heap_allocations(); },
          "how many image buffers its pool has asked the heap for")
      .def(py::pickle(
          [](const Exec& self) {
            return versioned(py::make_tuple(self.threads(), std::string(name(self.target))));
          },
          [](const py::tuple& state) {
            const auto parts = py::reinterpret_borrow<py::tuple>(of_this_version(state));
            return make_exec(parts[0].cast<int>(), parts[1].cast<std::string>());
          }));
  define(m, "compiled_targets", "The instruction sets in this build, slowest first.",
         [] { return names_of(compiled_targets()); });
  define(m, "supported_targets", "Those of them that this processor has, slowest first.",
         [] { return names_of(supported_targets()); });
}

}  // namespace cairn::python
