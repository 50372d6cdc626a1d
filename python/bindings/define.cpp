// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "define.hpp"

#include <algorithm>
#include <cairn/core/nearest.hpp>
#include <cmath>
#include <limits>

namespace cairn::python {
namespace {

/// The text between the brackets of "List[…]" and similar; nullopt for another type.
std::optional<std::string> inside(const std::string& type, std::string_view outer) {
  if (!type.starts_with(outer) || type.size() <= outer.size() || type[outer.size()] != '[')
    return std::nullopt;
  return type.substr(outer.size() + 1, type.size() - outer.size() - 2);
}

std::string in_words(const std::string& type) {
  if (const auto some = inside(type, "Optional")) return in_words(*some) + " or None";
  if (const auto entry = inside(type, "Sequence")) return "a list, each entry " + in_words(*entry);
  if (type.starts_with("Dict")) return "a dict";
  if (type.starts_with("Tuple")) return "a tuple";
  if (type == "int") return "a whole number";
  if (type == "float") return "a number";
  if (type == "bool") return "True or False";
  if (type == "PathLike") return "a path, str or os.PathLike";
  return (std::islower(static_cast<unsigned char>(type[0])) != 0 ? "a " : "a cairn.") + type;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

/// A value in a repr(): arrays as type and shape, numbers with seven digits, long lists as their length.
std::string brief(const py::handle& value) {
  constexpr std::size_t kMostEntries = 8;
  const auto as_text = [](const py::handle& any) { return py::str(any).cast<std::string>(); };
  if (py::isinstance<py::array>(value))
    return "<" + as_text(value.attr("dtype")) + as_text(value.attr("shape")) + ">";
  if (py::isinstance<py::float_>(value)) return as_text(py::str("{:.7g}").format(value));
  const bool is_tuple = py::isinstance<py::tuple>(value);
  if (!is_tuple && !py::isinstance<py::list>(value)) return py::repr(value);
  if (py::len(value) > kMostEntries) return "<" + std::to_string(py::len(value)) + " entries>";
  std::vector<std::string> entries;
  for (const py::handle entry : value) entries.push_back(brief(entry));
  const std::string text = entries.empty() ? "" : listed(entries);
  return is_tuple ? "(" + text + ")" : "[" + text + "]";
}

}  // namespace

std::string shown(const py::handle& value) {
  constexpr std::size_t kLongest = 60;
  const bool is_plain = value.is_none() || py::isinstance<py::str>(value) ||
                        py::isinstance<py::int_>(value) || py::isinstance<py::float_>(value);
  std::string text = is_plain ? py::repr(value).cast<std::string>() : "";
  if (is_plain && text.size() <= kLongest) return text;
  return "a value of type " + py::type::of(value).attr("__name__").cast<std::string>();
}

void refuse(const std::string& name, const py::handle& value, const std::string& type) {
  throw ArgumentError(name + ": found " + shown(value) + ", expected " + in_words(type));
}

std::optional<int> whole(const py::handle& value) {
  if (PyNumber_Check(value.ptr()) == 0) return std::nullopt;
  const double number = PyFloat_AsDouble(value.ptr());
  const bool is_number = PyErr_Occurred() == nullptr;  // neither complex nor an array
  PyErr_Clear();
  if (!is_number || number != std::floor(number) || std::abs(number) > std::numeric_limits<int>::max())
    return std::nullopt;
  return static_cast<int>(number);
}

NoiseSigma::NoiseSigma(const py::object& given, const char* name) {
  Taken<float> number;
  number.take(given, {name, kType, {}}, {});
  value = number.get();
  if (!(value >= 0 && std::isfinite(value)))
    throw Error(std::string(name) + ": found " + std::to_string(value) + ", expected 0 or more grey levels");
}

py::object parsed(const std::string& json) {
  return py::module_::import("json").attr("loads")(json);
}

std::string repr_of(const py::object& self) {
  const py::object type = py::type::of(self);
  std::string text;
  const auto add = [&](const std::string& name, const py::handle& value) {
    text += (text.empty() ? "" : ", ") + name + "=" + brief(value);
  };
  for (const py::handle name : type.attr("_shown")) add(name.cast<std::string>(), self.attr(name));
  if (py::hasattr(type, "as_dict")) {
    for (const auto& [name, value] : self.attr("as_dict")().cast<py::dict>())
      add(name.cast<std::string>(), value);
  }
  return type.attr("__name__").cast<std::string>() + "(" + text + ")";
}

void Signature::add(const py::arg& argument, py::object fallback) {
  std::string type = types.at(parameters.size());
  const bool takes_none = type.starts_with("Optional") || type == "MaskLike" || type == "RigLike";
  if (fallback && fallback.is_none() && !takes_none) type = "Optional[" + type + "]";
  if (type.starts_with("List")) type.replace(0, 4, "Sequence");
  parameters.push_back({argument.name, std::move(type), std::move(fallback), is_named_});
}

void Signature::finish() {
  const bool has_images = std::find(types.begin(), types.end(), Picture::kType) != types.end();
  const auto add_named = [&](const char* name, const char* type, py::object fallback) {
    parameters.push_back({name, type, std::move(fallback), true});
  };
  if (options.keywords == Keywords::by_group) {
    add_named("preset", "str", py::str("default"));
    add_named("config", "Union[Config, PathLike, None]", py::none());
  } else if (options.keywords == Keywords::of_stage) {
    add_named("config", "Optional[Config]", py::none());
  }
  if (takes_call && options.keywords != Keywords::groups_alone)
    add_named("exec", "Optional[Exec]", py::none());
  const bool has_order =
      std::any_of(parameters.begin(), parameters.end(), [](const auto& p) { return p.name == "bgr"; });
  if (has_images && !has_order) add_named("bgr", "bool", py::bool_(false));
}

std::vector<py::object> Signature::bind(const py::args& args, const py::kwargs& named, Call& call) const {
  const bool is_method = !parameters.empty() && parameters[0].name == "self";
  std::vector<std::string> names;
  std::vector<std::string> unnamed;
  for (const Parameter& p : parameters) {
    if (p.name == "self") continue;
    names.push_back(p.name);
    if (!p.is_named) unnamed.push_back(p.name);
  }
  if (args.size() > unnamed.size() + (is_method ? 1 : 0)) {
    throw ArgumentError(title + ": found " + std::to_string(args.size() - (is_method ? 1 : 0)) +
                        " arguments without a name, expected at most " + std::to_string(unnamed.size()) +
                        ": " + listed(unnamed));
  }
  for (const auto& [key, value] : named) {
    const auto name = key.cast<std::string>();
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    call.options[key] = value;
    if (options.keywords != Keywords::none) continue;
    const std::string close = nearest(name, names);
    throw ArgumentError(
        title + ": there is no argument '" + name + "', " +
        (close.empty() ? "expected of these: " + listed(names) : "did you mean '" + close + "'?"));
  }
  std::vector<py::object> values;
  for (const Parameter& p : parameters) {
    const bool is_in_place = !p.is_named && values.size() < args.size();
    const bool is_by_name = named.contains(p.name.c_str());
    if (is_in_place && is_by_name)
      throw ArgumentError(title + ": found argument '" + p.name + "' twice, expected it once");
    if (!is_in_place && !is_by_name && !p.fallback)
      throw ArgumentError(title + ": found no argument '" + p.name + "', expected it");
    const py::object value = is_in_place  ? py::object(args[values.size()])
                             : is_by_name ? py::object(named[p.name.c_str()])
                                          : p.fallback;
    values.push_back(value);
    if (values.size() <= types.size()) continue;
    if (p.name == "bgr" && !py::isinstance<py::bool_>(value)) refuse(p.name, value, p.type);
    if (p.name == "bgr") call.bgr = value.cast<bool>();
    if (p.name == "preset" && !py::isinstance<py::str>(value)) refuse(p.name, value, p.type);
    if (p.name == "preset") call.preset = value.cast<std::string>();
    if (p.name == "config") call.given_config = value;
    if (p.name == "exec") call.exec = exec_of(value);
  }
  if (options.keywords == Keywords::of_stage) {
    call.config = stage_config(call.given_config);
    if (options.settle != nullptr) options.settle(call.config);
    set_flat(call.config, options.groups, call.options);
  }
  return values;
}

std::string Signature::doc(const std::string& words) const {
  std::string text = title.substr(title.find('.') + 1) + "(";
  const char* between = "";
  bool is_named = false;
  const auto add = [&](const std::string& part) {
    text += between + part;
    between = ", ";
  };
  for (const Parameter& p : parameters) {
    if (p.is_named && !is_named) add("*");
    is_named = p.is_named;
    add(p.name == "self" ? p.name : p.name + ": " + p.type);
    if (p.fallback) text += " = " + py::repr(p.fallback).cast<std::string>();
  }
  if (options.keywords != Keywords::none) add("**options");
  text += ") -> " + result + "\n\n" + words;
  if (options.keywords == Keywords::none) return text;
  return text + options_text(options.groups, options.keywords != Keywords::of_stage);
}

void note_options(py::module_& m, const Signature& signature) {
  if (signature.options.keywords == Keywords::none) return;
  if (!py::hasattr(m, "_options_of")) m.attr("_options_of") = py::dict();
  m.attr("_options_of")[signature.title.c_str()] =
      py::make_tuple(signature.options.keywords != Keywords::of_stage, signature.options.groups);
}

}  // namespace cairn::python
