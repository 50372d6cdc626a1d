// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/stl/filesystem.h>

#include <cairn/matching/match.hpp>
#include <concepts>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "options.hpp"
#include "pickling.hpp"
#include "rig.hpp"
#include "values.hpp"

/// Definition of functions and classes for Python. A function is described once, by a C++ function and the
/// names of its arguments, from which conversion, error messages, size checks, help and stubs follow. A class
/// is described by the list of its members: attributes, repr() and stubs.
namespace cairn::python {

struct Parameter {
  std::string name;
  std::string type;       // as in the stubs
  py::object fallback;    // null: required
  bool is_named = false;  // keyword-only
};

/// The arguments common to many functions.
struct Call {
  Exec exec;
  bool bgr = false;
  Config config;  // for a stage
  // For functions with options by group:
  std::string preset = "default";
  py::object given_config;
  py::kwargs options;
  [[nodiscard]] PyConfig settings() const { return config_of(given_config, preset, options); }
};

/// Options as keywords: by their own names, for a stage; or as a dict for each group, with preset and config
/// or without.
enum class Keywords : std::uint8_t { none, of_stage, by_group, groups_alone };
struct Options {
  Keywords keywords = Keywords::none;
  Groups groups{};
  void (*settle)(Config&) = nullptr;                  // overrides what the stage always needs
  bool is_released = keywords == Keywords::of_stage;  // releases the GIL
};

/// The parameters of a function.
struct Signature {
  std::string title;  // "segment", "Rig.from_file"
  Options options;
  bool takes_call = false;
  std::vector<std::string> types;  // of the function's own parameters, as in the stubs
  std::string result;
  std::vector<Parameter> parameters{};  // its own first

  void add(const py::arg& argument, py::object fallback = {});
  void add(const py::arg_v& argument) { add(argument, argument.value); }
  void add(const py::kw_only&) { is_named_ = true; }
  void finish();  // adds the common parameters
  /// The values of the function's own parameters; the others go to `call`. Throws ArgumentError.
  std::vector<py::object> bind(const py::args& args, const py::kwargs& named, Call& call) const;
  /// The docstring: "segment(left: ImageLike, …) -> Frame", `words`, and a line for each option.
  [[nodiscard]] std::string doc(const std::string& words) const;

  bool is_named_ = false;
};
/// Records the options of a function for the stubs.
void note_options(py::module_& m, const Signature& signature);

/// "preset: found 3, expected a str". Throws ArgumentError.
[[noreturn]] void refuse(const std::string& name, const py::handle& value, const std::string& type);
std::optional<int> whole(const py::handle& value);

// ---- arguments ----

template <class T>
concept Input = requires {
  T::kType;
};  // constructible from the caller's argument

/// An argument during a call: the converted value and what keeps it alive.
template <class T>
struct Taken {
  py::detail::make_caster<T> made;
  void take(const py::object& value, const Parameter& p, const Call&) {
    const bool is_none = value.is_none() && !std::is_base_of_v<py::object, T>;
    if (is_none || !made.load(value, true)) refuse(p.name, value, p.type);
  }
  decltype(auto) get() { return py::detail::cast_op<T&>(made); }
};
template <>
struct Taken<int> {
  int made = 0;
  void take(const py::object& value, const Parameter& p, const Call&) {
    const auto number = whole(value);
    if (!number) refuse(p.name, value, p.type);
    made = *number;
  }
  int& get() { return made; }
};
template <Input T>
struct Taken<T> {
  std::optional<T> made;
  void take(const py::object& value, const Parameter& p, const Call& call) {
    const char* const name = p.name.c_str();
    if constexpr (std::is_constructible_v<T, py::object, const char*, bool, const Pool&>) {
      made.emplace(value, name, call.bgr, call.exec.pool);
    } else if constexpr (std::is_constructible_v<T, py::object, const char*, const Exec&>) {
      made.emplace(value, name, call.exec);
    } else {
      made.emplace(value, name);
    }
  }
  T& get() { return *made; }
};
template <class T>
struct Taken<std::optional<T>> {
  std::optional<T> made;
  void take(const py::object& value, const Parameter& p, const Call& call) {
    if (value.is_none()) return;
    Taken<T> one;
    one.take(value, p, call);
    if constexpr (Input<T>) {
      made.emplace(std::move(one.get()));
    } else {
      made.emplace(one.get());
    }
  }
  std::optional<T>& get() { return made; }
};

/// The standard deviation of an image's noise, in grey levels.
struct NoiseSigma {
  static constexpr const char* kType = "float";
  float value = 0;
  NoiseSigma(const py::object& given, const char* name);  // throws Error for invalid values
};

/// The size of a value with one entry per pixel; empty for other values.
template <class T>
Size size_over_pixels(const T& value) {
  if constexpr (requires {
                  { value->size() } -> std::same_as<Size>;
                }) {
    return value ? value->size() : Size{};
  } else if constexpr (requires {
                         { value.size() } -> std::same_as<Size>;
                       }) {
    return value.size();
  } else if constexpr (requires {
                         { value.labels.size() } -> std::same_as<Size>;
                       }) {
    return value.labels.size();
  } else if constexpr (std::is_same_v<T, Matches>) {
    return value.best.size();
  } else {
    return {};
  }
}

/// Throws Error unless all have the size of the first. Two images are checked by StereoPair::from().
template <class... T>
void expect_one_size(const Signature& signature, const T&... values) {
  std::optional<std::pair<Size, const Parameter*>> first;
  [[maybe_unused]] auto parameter = signature.parameters.begin();
  [[maybe_unused]] const auto expect = [&](Size size, const Parameter& p) {
    if (size.area() == 0) return;
    if (!first) {
      first.emplace(size, &p);
    } else if (p.type != Picture::kType || first->second->type != Picture::kType) {
      expect_size(size, p.name, first->first, first->second->name);
    }
  };
  (expect(size_over_pixels(values), *parameter++), ...);
}

// ---- calls ----

/// A value as a Python object. A reference is part of `owner`; images become read-only arrays.
template <class T>
py::object object_of(T&& value, const py::object& owner) {
  using Value = std::remove_cvref_t<T>;
  if constexpr (std::is_base_of_v<py::object, Value>) {
    return value;
  } else if constexpr (kIsImage<Value> && std::is_lvalue_reference_v<T>) {
    return array_over(value, owner);
  } else {
    return py::cast(std::forward<T>(value), py::return_value_policy::reference_internal, owner);
  }
}

/// A function's result as a Python object; a reference is part of the first argument.
struct ToPython {
  using Result = py::object;
  template <class R>
  py::object operator()(R&& made, const std::vector<py::object>& values) const {
    return object_of(std::forward<R>(made), std::is_lvalue_reference_v<R> ? values.at(0) : py::object());
  }
  py::object operator()() const { return py::none(); }
};
/// Tags the result of a constructor.
template <class T>
struct ToNew {
  using Result = T*;
  T* operator()(T made, const std::vector<py::object>&) const { return new T(std::move(made)); }
  T* operator()(std::unique_ptr<T> made, const std::vector<py::object>&) const { return made.release(); }
};

template <class To, bool kTakesCall, class R, class... P, class F>
typename To::Result invoke(const F& function, const Signature& signature, const py::args& args,
                           const py::kwargs& named) {
  Call call;
  const std::vector<py::object> values = signature.bind(args, named, call);
  std::tuple<Taken<std::remove_cvref_t<P>>...> taken;
  const auto take = [&](auto&... argument) {
    std::size_t i = 0;
    [[maybe_unused]] const auto one = [&](auto& a) {
      a.take(values[i], signature.parameters[i], call);
      ++i;
    };
    (one(argument), ...);
    expect_one_size(signature, argument.get()...);
  };
  std::apply(take, taken);
  const auto run = [&](auto&... argument) -> R {
    if constexpr (kTakesCall) {
      return function(std::as_const(call), argument.get()...);
    } else {
      return function(argument.get()...);
    }
  };
  std::optional<py::gil_scoped_release> release;
  if (signature.options.is_released) release.emplace();
  if constexpr (std::is_void_v<R>) {
    std::apply(run, taken);
    release.reset();
    return To()();
  } else {
    decltype(auto) made = std::apply(run, taken);
    release.reset();
    return To()(std::forward<decltype(made)>(made), values);
  }
}

/// A function for Python: its signature, and the call.
template <class Result>
struct Callable {
  Signature signature;
  std::function<Result(const py::args&, const py::kwargs&)> call;
};

template <class R, class... P>
std::pair<std::true_type, std::type_identity<R(P...)>> kind_of(std::function<R(const Call&, P...)>);
template <class R, class... P>
std::pair<std::false_type, std::type_identity<R(P...)>> kind_of(std::function<R(P...)>);

template <class To, bool kTakesCall, class R, class... P, class F, class... A>
Callable<typename To::Result> callable_as(std::type_identity<R(P...)>, std::string title, Options options,
                                          F function, const A&... arguments) {
  Signature signature{std::move(title), std::move(options), kTakesCall, {spelt<P>()...}, spelt<R>()};
  (signature.add(arguments), ...);
  signature.finish();
  return {signature,
          [function = std::move(function), signature](const py::args& args, const py::kwargs& named) {
            return invoke<To, kTakesCall, R, P...>(function, signature, args, named);
          }};
}
/// For `function(const Call&, arguments…)` or `function(arguments…)`, with the arguments' names and defaults.
template <class To = ToPython, class F, class... A>
auto callable(std::string title, Options options, F function, const A&... arguments) {
  using Kind = decltype(kind_of(std::function{function}));
  return callable_as<To, Kind::first_type::value>(typename Kind::second_type{}, std::move(title),
                                                  std::move(options), std::move(function), arguments...);
}

template <class F, class... A>
void define(py::module_& m, const char* name, Options options, const std::string& words, F function,
            const A&... arguments) {
  auto made = callable(name, std::move(options), std::move(function), arguments...);
  m.def(name, std::move(made.call), made.signature.doc(words).c_str());
  note_options(m, made.signature);
}
template <class F, class... A>
void define(py::module_& m, const char* name, const char* words, F function, const A&... arguments) {
  define(m, name, Options{}, words, std::move(function), arguments...);
}
/// Defines a stage: `function(call, arguments…)` uses call.config, whose groups are its keywords.
template <class F, class... A>
void stage(py::module_& m, const char* name, Groups groups, const char* words, F function,
           const A&... arguments) {
  define(m, name, Options{Keywords::of_stage, std::move(groups)}, words, std::move(function), arguments...);
}

// ---- classes ----

/// Parses JSON text.
py::object parsed(const std::string& json);
/// repr() with the members of a class: "Region(pixel_count=12, …)".
std::string repr_of(const py::object& self);

template <class T>
class Class {
 public:
  Class(py::module_& m, const char* name, const char* words)
      : class_(m, name, words), module_(m), name_(name) {
    class_.attr("_shown") = py::list();
    class_.def("__repr__", &repr_of);
    if constexpr (kHasParts<T>) class_.def(pickled<T>());
  }

  /// An attribute: a member, or a function of the object. Images become read-only arrays.
  template <class Get>
  Class& shows(const char* name, Get get, const char* words) {
    using Value = std::invoke_result_t<Get, const T&>;
    return property(name, get, words, spelt<Value>());
  }
  /// The same for an image that may be empty: then None.
  template <class Get>
  Class& may_show(const char* name, Get get, const char* words) {
    using Value = std::invoke_result_t<Get, const T&>;
    return property(name, get, words, "Optional[" + spelt<Value>() + "]");
  }
  /// A method: `function(self, arguments…)`.
  template <class F, class... A>
  Class& method(const char* name, const std::string& words, F function, const A&... arguments) {
    auto made = callable(name_ + "." + name, Options{}, std::move(function), py::arg("self"), arguments...);
    class_.def(name, std::move(made.call), made.signature.doc(words).c_str());
    return *this;
  }
  template <class F, class... A>
  Class& static_method(const char* name, const std::string& words, F function, const A&... arguments) {
    auto made = callable(name_ + "." + name, Options{}, std::move(function), arguments...);
    class_.def_static(name, std::move(made.call), made.signature.doc(words).c_str());
    return *this;
  }
  /// The constructor: `function(arguments…)` returns an object or a std::unique_ptr to one.
  template <class F, class... A>
  Class& made_by(Options options, const std::string& words, F function, const A&... arguments) {
    auto made = callable<ToNew<T>>(name_, std::move(options), std::move(function), arguments...);
    const auto construct = [call = std::move(made.call)](py::detail::value_and_holder& place,
                                                         const py::args& args, const py::kwargs& named) {
      place.value_ptr() = call(args, named);
    };
    made.signature.result = "None";
    class_.def("__init__", construct, py::detail::is_new_style_constructor(),
               made.signature.doc(words).c_str());
    note_options(module_, made.signature);
    return *this;
  }
  /// Exposes the JSON object returned by `json` as items, as attributes and as a dict.
  Class& shows_json(std::string (*json)(const T&)) {
    const auto as_dict = [json](const T& self) { return parsed(json(self)).template cast<py::dict>(); };
    method("as_dict", "All of it, as the command writes it.", as_dict);
    method(
        "__getitem__", "One entry of it.",
        [as_dict](const T& self, const std::string& name) { return py::object(as_dict(self)[name.c_str()]); },
        py::arg("name"));
    return method(
        "__getattr__", "One entry of it.",
        [as_dict, type = name_](const T& self, const std::string& name) {
          const py::dict all = as_dict(self);
          if (!all.contains(name.c_str())) throw py::attribute_error(type + " has no '" + name + "'");
          return py::object(all[name.c_str()]);
        },
        py::arg("name"));
  }
  /// Replaces the repr().
  Class& says(std::string (*words)(const T&)) {
    class_.attr("__repr__") = py::cpp_function(words, py::name("__repr__"), py::is_method(class_));
    return *this;
  }
  /// As in pybind11.
  template <class... X>
  Class& def(X&&... x) {
    class_.def(std::forward<X>(x)...);
    return *this;
  }

 private:
  template <class Get>
  Class& property(const char* name, Get get, const char* words, const std::string& type) {
    const auto getter = [get](const py::object& self) -> py::object {
      return object_of(std::invoke(get, self.cast<const T&>()), self);
    };
    class_.def_property_readonly(name, py::cpp_function(getter, type.c_str()), words);
    class_.attr("_shown").attr("append")(name);
    return *this;
  }

  py::class_<T> class_;
  py::module_ module_;
  std::string name_;
};

}  // namespace cairn::python
