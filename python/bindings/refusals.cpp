// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "refusals.hpp"

#include <algorithm>
#include <cairn/core/nearest.hpp>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "whole.hpp"

namespace py = pybind11;

namespace cairn::python {
namespace {

// ---- signatures, as pybind11 writes them into docstrings ----

struct Parameter {
  std::string name;
  std::string type;
  bool has_default = false;
  bool keyword_only = false;
};

struct Signature {
  std::string function;
  std::vector<Parameter> parameters;
  bool any_keyword = false;  // **kwargs: options, which say themselves what they are
};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// At the commas that stand in no brackets and no quotes.
std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::string part;
  int depth = 0;
  bool quoted = false;
  for (const char c : text) {
    if (c == '\'') quoted = !quoted;
    if (c == '[' || c == '(') ++depth;
    if (c == ']' || c == ')') --depth;
    if (c != ',' || depth > 0 || quoted) {
      part += c;
      continue;
    }
    parts.push_back(trimmed(part));
    part.clear();
  }
  if (!trimmed(part).empty()) parts.push_back(trimmed(part));
  return parts;
}

Parameter parameter(const std::string& text, bool keyword_only) {
  const auto colon = text.find(": ");
  if (colon == std::string::npos) return {text, "object", false, keyword_only};
  const std::string rest = text.substr(colon + 2);
  const auto equals = rest.find(" = ");
  return {text.substr(0, colon), rest.substr(0, equals), equals != std::string::npos, keyword_only};
}

/// "name(parameters) -> type", perhaps numbered.
std::optional<Signature> signature(const std::string& line) {
  const auto open = line.find('(');
  const auto close = line.rfind(") -> ");
  if (open == std::string::npos || close == std::string::npos) return std::nullopt;
  const auto space = line.rfind(' ', open);
  const std::size_t start = space == std::string::npos ? 0 : space + 1;
  Signature found{line.substr(start, open - start), {}};
  bool keyword_only = false;
  for (const std::string& part : split(line.substr(open + 1, close - open - 1))) {
    if (part == "*") {
      keyword_only = true;
    } else if (part == "**kwargs") {
      found.any_keyword = true;
    } else if (part != "/") {
      found.parameters.push_back(parameter(part, keyword_only));
    }
  }
  return found;
}

std::vector<Signature> signatures(const py::handle& function) {
  std::vector<Signature> all;
  const auto name = function.attr("__name__").cast<std::string>();
  std::istringstream lines(py::str(function.attr("__doc__")).cast<std::string>());
  for (std::string line; std::getline(lines, line);) {
    const bool numbered = line.find(". " + name + "(") != std::string::npos;
    if (!numbered && !line.starts_with(name + "(")) continue;
    if (auto found = signature(line)) all.push_back(std::move(*found));
  }
  return all;
}

// ---- which value is of which type ----

/// Text between the brackets of "List[…]" and the like.
std::optional<std::string> inside(const std::string& type, std::string_view outer) {
  if (!type.starts_with(outer) || type.size() <= outer.size() + 1 || type[outer.size()] != '[') {
    return std::nullopt;
  }
  return type.substr(outer.size() + 1, type.size() - outer.size() - 2);
}

bool is_number(const py::handle& value) {
  if (PyNumber_Check(value.ptr()) == 0 || PyComplex_Check(value.ptr())) return false;
  const bool converts = PyFloat_AsDouble(value.ptr()) != -1.0 || PyErr_Occurred() == nullptr;
  PyErr_Clear();
  return converts;
}

bool is_path(const py::handle& value) {
  const auto path = py::reinterpret_steal<py::object>(PyOS_FSPath(value.ptr()));
  PyErr_Clear();
  return static_cast<bool>(path);
}

bool is_instance(const py::handle& value, const std::string& name) {
  const py::module_ cairn = py::module_::import("cairn");
  return !py::hasattr(cairn, name.c_str()) || py::isinstance(value, cairn.attr(name.c_str()));
}

bool fits(const py::handle& value, const std::string& type) {
  if (const auto some = inside(type, "Optional")) return value.is_none() || fits(value, *some);
  if (const auto entry = inside(type, "List")) {
    if (!py::isinstance<py::sequence>(value) || py::isinstance<py::str>(value)) return false;
    const auto entries = py::reinterpret_borrow<py::sequence>(value);
    return std::all_of(entries.begin(), entries.end(), [&](const py::handle& e) { return fits(e, *entry); });
  }
  if (type == "int") return py::detail::make_caster<Whole>().load(value, true);
  if (type == "float") return is_number(value);
  if (type == "bool")
    return py::isinstance<py::bool_>(value) || (!py::isinstance<py::str>(value) && is_number(value));
  if (type == "str") return py::isinstance<py::str>(value) || py::isinstance<py::bytes>(value);
  if (type == "dict") return py::isinstance<py::dict>(value);
  if (type == "slice") return py::isinstance<py::slice>(value);
  if (type == "sequence") return py::isinstance<py::sequence>(value);
  if (type == "os.PathLike") return is_path(value);
  if (type.starts_with("Callable")) return PyCallable_Check(value.ptr()) != 0;
  if (type.starts_with("cairn.")) return is_instance(value, type.substr(6));
  return true;
}

std::string in_words(const std::string& type) {
  if (const auto some = inside(type, "Optional")) return in_words(*some) + " or None";
  if (const auto entry = inside(type, "List")) return "a list, each entry " + in_words(*entry);
  if (type == "int") return "a whole number";
  if (type == "float") return "a number";
  if (type == "bool") return "True or False";
  if (type == "os.PathLike") return "a path, str or os.PathLike";
  if (type.starts_with("Callable")) return "a function";
  return "a " + type;
}

// ---- what is wrong with a call ----

struct Problem {
  std::size_t at = 0;    // how many arguments were right before
  std::string found;     // "preset: found 3"
  std::string expected;  // "a str"; empty: all is said
};

/// "Exec" for its constructor, "Objects.labels" for methods, "segment" for functions.
std::string title(const Signature& signature) {
  const bool is_method = !signature.parameters.empty() && signature.parameters[0].name == "self";
  if (!is_method) return signature.function;
  const std::string owner = signature.parameters[0].type.substr(signature.parameters[0].type.find('.') + 1);
  return signature.function == "__init__" ? owner : owner + "." + signature.function;
}

std::vector<std::string> names_of(const Signature& signature, bool positional) {
  std::vector<std::string> names;
  for (const Parameter& p : signature.parameters) {
    if (p.name != "self" && !(positional && p.keyword_only)) names.push_back(p.name);
  }
  return names;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "none" : text;
}

std::optional<Problem> unknown_keyword(const Signature& signature, const py::dict& keywords) {
  if (signature.any_keyword) return std::nullopt;
  const std::vector<std::string> known = names_of(signature, false);
  for (const auto& [key, value] : keywords) {
    const auto name = py::str(key).cast<std::string>();
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string close = nearest(name, known);
    return Problem{
        0,
        title(signature) + ": there is no argument '" + name + "', " +
            (close.empty() ? "expected of these: " + listed(known) : "did you mean '" + close + "'?"),
        ""};
  }
  return std::nullopt;
}

std::optional<Problem> too_many(const Signature& signature, std::size_t given) {
  const auto& all = signature.parameters;
  const auto places = static_cast<std::size_t>(
      std::count_if(all.begin(), all.end(), [](const Parameter& p) { return !p.keyword_only; }));
  if (given <= places) return std::nullopt;
  const bool is_method = !all.empty() && all[0].name == "self";
  const std::vector<std::string> names = names_of(signature, true);
  return Problem{places,
                 title(signature) + ": found " + std::to_string(given - (is_method ? 1 : 0)) +
                     " arguments without a name, expected at most " + std::to_string(names.size()) + ": " +
                     listed(names),
                 ""};
}

std::optional<Problem> problem_of(const Signature& signature, const py::tuple& args,
                                  const py::dict& keywords) {
  if (auto problem = too_many(signature, args.size())) return problem;
  if (auto problem = unknown_keyword(signature, keywords)) return problem;
  for (std::size_t i = 0; i < signature.parameters.size(); ++i) {
    const Parameter& p = signature.parameters[i];
    const bool in_place = !p.keyword_only && i < args.size();
    const bool by_name = keywords.contains(p.name.c_str());
    const std::string argument = title(signature) + ": found argument '" + p.name + "' ";
    if (in_place && by_name) return Problem{i, argument + "twice, expected it once", ""};
    if (!in_place && !by_name) {
      if (p.has_default) continue;
      return Problem{i, title(signature) + ": found no argument '" + p.name + "', expected it", ""};
    }
    const py::object value = in_place ? py::object(args[i]) : py::object(keywords[p.name.c_str()]);
    if (!fits(value, p.type)) return Problem{i, p.name + ": found " + shown(value), in_words(p.type)};
  }
  return std::nullopt;
}

/// Of several overloads those count that are wrong latest.
std::string one_line(const std::vector<Signature>& overloads, const py::tuple& args,
                     const py::dict& keywords) {
  std::optional<Problem> worst;
  for (const Signature& signature : overloads) {
    const auto problem = problem_of(signature, args, keywords);
    if (!problem) continue;
    if (!worst || problem->at > worst->at) {
      worst = problem;
    } else if (problem->at == worst->at && !problem->expected.empty() &&
               problem->expected != worst->expected) {
      worst->expected += " or " + problem->expected;
    }
  }
  if (worst) return worst->found + (worst->expected.empty() ? "" : ", expected " + worst->expected);
  return overloads.empty()
             ? "the arguments do not fit"
             : title(overloads.front()) + ": the arguments do not fit; help() tells their types";
}

/// Stands before a function of pybind11's, which is its `self`.
PyObject* call(PyObject* function, PyObject* args, PyObject* keywords) {
  PyObject* result = PyObject_Call(function, args, keywords);
  if (result != nullptr || PyErr_ExceptionMatches(PyExc_TypeError) == 0) return result;
  try {
    py::error_already_set error;
    const auto said = py::str(error.value()).cast<std::string>();
    if (said.find("(): incompatible ") == std::string::npos) {
      error.restore();
      return nullptr;
    }
    const auto named = keywords != nullptr ? py::reinterpret_borrow<py::dict>(keywords) : py::dict();
    const std::string line = one_line(signatures(function), py::reinterpret_borrow<py::tuple>(args), named);
    PyErr_SetString(py::module_::import("cairn").attr("ArgumentError").ptr(), line.c_str());
  } catch (py::error_already_set& error) {
    error.restore();
  } catch (const std::exception& error) {
    PyErr_SetString(PyExc_TypeError, error.what());
  }
  return nullptr;
}

py::object guarded(const py::handle& function) {
  auto definition =
      std::make_unique<PyMethodDef>(*reinterpret_cast<PyCFunctionObject*>(function.ptr())->m_ml);
  definition->ml_meth = reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(&call));
  const py::object module = function.attr("__module__");
  // The definition must live as long as the function, which is as long as the module: for good.
  return py::reinterpret_steal<py::object>(
      PyCFunction_NewEx(definition.release(), function.ptr(), module.ptr()));
}

void guard_methods(const py::handle& owner) {
  const auto members = py::dict(owner.attr("__dict__"));
  for (const auto& [key, member] : members) {
    const auto name = py::str(key).cast<std::string>();
    if (name.starts_with("_") && name != "__init__" && name != "__getitem__") continue;
    if (PyInstanceMethod_Check(member.ptr())) {
      const py::object method = guarded(PyInstanceMethod_GET_FUNCTION(member.ptr()));
      owner.attr(key) = py::reinterpret_steal<py::object>(PyInstanceMethod_New(method.ptr()));
    } else if (py::isinstance<py::staticmethod>(member)) {
      owner.attr(key) = py::staticmethod(guarded(member.attr("__func__")));
    }
  }
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

void refuse_plainly(const py::module_& module) {
  const auto members = py::dict(module.attr("__dict__"));
  for (const auto& [key, member] : members) {
    if (py::str(key).cast<std::string>().starts_with("_")) continue;
    if (PyCFunction_Check(member.ptr())) {
      module.attr(key) = guarded(member);
    } else if (PyType_Check(member.ptr()) && py::hasattr(member, "__module__") &&
               py::str(member.attr("__module__")).cast<std::string>() == "cairn") {
      guard_methods(member);
    }
  }
}

}  // namespace cairn::python
