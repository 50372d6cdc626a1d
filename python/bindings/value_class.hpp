// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/error.hpp>
#include <filesystem>
#include <string>
#include <type_traits>

#include "convert.hpp"
#include "options.hpp"

/// Classes of the library's structs for Python: attributes, pickle and copy.deepcopy, from Members.
namespace cairn::python {

// ---- the state that pickle stores: tuples, numbers, text and arrays ----

template <class T>
py::object state_of(const T& value) {
  if constexpr (kIsImage<T>) {
    return array_from(value.clone());
  } else if constexpr (std::is_enum_v<T>) {
    return py::int_(static_cast<std::int64_t>(value));
  } else if constexpr (kIsOptional<T>) {
    return value ? state_of(*value) : py::object(py::none());
  } else if constexpr (kIsList<T>) {
    py::list all;
    for (const auto& entry : value) all.append(state_of(entry));
    return all;
  } else if constexpr (std::is_same_v<T, Config>) {
    py::dict all;
    for (const OptionInfo& option : options(value)) all[py::str(option.name)] = option.value;
    return all;
  } else if constexpr (requires { Members<T>::kNames; }) {
    return std::apply([](const auto&... part) -> py::object { return py::make_tuple(state_of(part)...); },
                      Members<T>::of(value));
  } else {
    return py::cast(value);
  }
}

[[noreturn]] inline void refuse_state(const std::string& found) {
  throw Error("unpickling: found " + found + ", expected what this version of cairn pickled");
}

template <class T>
void restore(const py::handle& state, Image<T>& image) {
  if (state.is_none()) return;
  using Number = typename NumbersOf<T>::Type;
  const auto array = py::array_t<Number, py::array::c_style>::ensure(state);
  if (!array || array.ndim() != (NumbersOf<T>::kCount > 1 ? 3 : 2)) refuse_state("no array for an image");
  image = copied(view_over<T>(array));
}

template <class T>
void restore(const py::handle& state, T& value) {
  if constexpr (std::is_enum_v<T>) {
    value = static_cast<T>(state.cast<std::int64_t>());
  } else if constexpr (kIsOptional<T>) {
    if (!state.is_none()) restore(state, value.emplace());
  } else if constexpr (kIsList<T> && !std::is_same_v<T, std::vector<bool>>) {
    const auto all = py::reinterpret_borrow<py::list>(state);
    if constexpr (requires { value.resize(all.size()); }) value.resize(all.size());
    if (value.size() != all.size()) refuse_state(std::to_string(all.size()) + " numbers");
    for (std::size_t i = 0; i < all.size(); ++i) restore(all[i], value[i]);
  } else if constexpr (std::is_same_v<T, Config>) {
    for (const auto& [name, text] : py::reinterpret_borrow<py::dict>(state))
      set(value, py::str(name).template cast<std::string>(), py::str(text).template cast<std::string>());
  } else if constexpr (requires { Members<T>::kNames; }) {
    const auto parts = py::reinterpret_borrow<py::tuple>(state);
    std::size_t i = 0;
    std::apply([&](auto&... part) { (restore(parts[i++], part), ...); }, Members<T>::of(value));
  } else {
    value = state.cast<T>();
  }
}

/// For class_::def: pickle, copy.copy and copy.deepcopy of a class by its members. A state belongs to one
/// version; long-term storage is for files.
template <class T>
auto pickled() {
  return py::pickle([](const T& self) { return py::make_tuple(CAIRN_VERSION, state_of(self)); },
                    [](const py::tuple& state) {
                      if (state.size() != 2) refuse_state(std::to_string(state.size()) + " entries");
                      const auto version = py::str(state[0]).template cast<std::string>();
                      if (version != CAIRN_VERSION)
                        refuse_state("a value of version " + version.substr(0, 20));
                      T value;
                      restore(state[1], value);
                      return value;
                    });
}

// ---- classes ----

/// A read-only attribute: a function of the object, or a member. python/cairn describes it.
template <class T, class Get>
void shows(py::class_<T>& type, const std::string& name, Get get) {
  const auto getter = [get](const py::object& self) -> py::object {
    decltype(auto) value = std::invoke(get, self.cast<const T&>());
    if constexpr (std::is_reference_v<decltype(value)>) {
      return attribute(value, self);
    } else if constexpr (std::is_base_of_v<py::object, decltype(value)>) {
      return value;
    } else {
      return py::cast(std::move(value));
    }
  };
  type.def_property_readonly(name.c_str(), py::cpp_function(getter));
}

/// A class with its members as attributes, which can be pickled.
template <class T>
py::class_<T> value_class(py::module_& m, const char* name) {
  py::class_<T> type(m, name);
  std::string_view names = Members<T>::kNames;
  const auto show = [&]<std::size_t i>(std::integral_constant<std::size_t, i>) {
    const std::string_view one = names.substr(0, names.find(','));
    names.remove_prefix(std::min(names.size(), one.size() + 2));
    const auto get = [](const T& self) -> const auto& {
      return std::get<i>(Members<T>::of(self));
    };
    if (one[0] != '_') shows(type, std::string(one), get);
  };
  constexpr std::size_t kCount = std::tuple_size_v<decltype(Members<T>::of(std::declval<T&>()))>;
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    (show(std::integral_constant<std::size_t, i>()), ...);
  }
  (std::make_index_sequence<kCount>());
  type.def(pickled<T>());
  return type;
}

}  // namespace cairn::python
