// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <cairn/core/ids.hpp>
#include <cairn/core/stereo_pair.hpp>
#include <cairn/objects/measure.hpp>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"

/// Python equivalents of the library's small values, and their names in the stubs.
namespace cairn::python {

/// Tuples of numbers, and ids as numbers.
template <class T>
struct Plain;
template <>
struct Plain<Vec3> {
  static std::tuple<float, float, float> of(Vec3 v) { return {v.x, v.y, v.z}; }
};
template <>
struct Plain<Rect> {
  static std::tuple<int, int, int, int> of(Rect r) { return {r.x, r.y, r.width, r.height}; }
};
template <>
struct Plain<Rgb> {
  static std::tuple<int, int, int> of(Rgb c) { return {c.r, c.g, c.b}; }
};
template <>
struct Plain<Size> {
  static std::tuple<int, int> of(Size size) { return {size.width, size.height}; }
};
template <>
struct Plain<Interval> {
  static std::tuple<float, float> of(Interval i) { return {i.low, i.high}; }
};
template <class T>
requires std::is_enum_v<T> && requires(T id) {
  number(id);
}
struct Plain<T> {
  static auto of(T id) { return number(id); }
};
template <class T>
using PlainOf = decltype(Plain<T>::of(std::declval<T>()));

/// A Python object whose type in the stubs is `kType`.
template <std::size_t N>
struct Text {
  char text[N]{};
  consteval Text(const char (&from)[N]) { std::copy_n(from, N, text); }  // NOLINT: a literal is one
};
template <Text kType>
class Typed : public py::object {
 public:
  using py::object::object;
  Typed() : py::object(py::none()) {}
  Typed(py::object any) : py::object(std::move(any)) {}  // NOLINT: any object is one
  static bool check_(py::handle) { return true; }
  static constexpr const char* kName = kType.text;
};

template <class T>
std::string spelt_number() {
  using Number = typename NumbersOf<T>::Type;
  return "NDArray[numpy." + py::str(py::dtype::of<Number>()).template cast<std::string>() + "]";
}

template <class T>
struct Spelling {
  static std::string of() {
    if constexpr (requires { PlainOf<T>(); }) {
      return Spelling<PlainOf<T>>::of();
    } else if constexpr (requires { T::kType; }) {
      return T::kType;
    } else if constexpr (requires { T::kName; }) {
      return T::kName;
    } else if constexpr (std::is_same_v<T, bool>) {
      return "bool";
    } else if constexpr (std::is_integral_v<T>) {
      return "int";
    } else if constexpr (std::is_floating_point_v<T>) {
      return "float";
    } else if constexpr (std::is_void_v<T>) {
      return "None";
    } else if constexpr (std::is_convertible_v<T, std::string_view>) {
      return "str";
    } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
      return "PathLike";
    } else if constexpr (std::is_same_v<T, py::dict>) {
      return "Dict[str, Any]";
    } else if constexpr (std::is_same_v<T, py::bytes>) {
      return "bytes";
    } else if constexpr (std::is_base_of_v<py::object, T>) {
      return "Any";
    } else {
      return py::type::of<T>().attr("__name__").template cast<std::string>();
    }
  }
};
template <class T>
std::string spelt() {
  return Spelling<std::remove_cvref_t<T>>::of();
}
template <class T>
struct Spelling<T*> : Spelling<std::optional<std::remove_const_t<T>>> {};
template <class T>
struct Spelling<std::unique_ptr<T>> : Spelling<T> {};
template <class T>
struct Spelling<std::optional<T>> {
  static std::string of() { return "Optional[" + spelt<T>() + "]"; }
};
template <class T>
struct Spelling<std::vector<T>> {
  static std::string of() { return "List[" + spelt<T>() + "]"; }
};
template <class K, class V>
struct Spelling<std::map<K, V>> {
  static std::string of() { return "Dict[" + spelt<K>() + ", " + spelt<V>() + "]"; }
};
template <class A, class B>
struct Spelling<std::pair<A, B>> : Spelling<std::tuple<A, B>> {};
template <class A, class... More>
struct Spelling<std::tuple<A, More...>> {
  static std::string of() { return "Tuple[" + (spelt<A>() + ... + (", " + spelt<More>())) + "]"; }
};
template <class T>
struct Spelling<Image<T>> {
  static std::string of() { return spelt_number<T>(); }
};
template <class T>
struct Spelling<Numbers<T>> {
  static std::string of() { return spelt_number<T>(); }
};

}  // namespace cairn::python

namespace pybind11::detail {

template <class T>
struct type_caster<T, enable_if_t<(sizeof(cairn::python::PlainOf<T>) > 0)>> {
  using Plain = cairn::python::PlainOf<T>;
  static handle cast(T value, return_value_policy policy, handle parent) {
    return make_caster<Plain>::cast(cairn::python::Plain<T>::of(value), policy, parent);
  }
  static constexpr auto name = make_caster<Plain>::name;
};
template <cairn::python::Text kType>
struct handle_type_name<cairn::python::Typed<kType>> {
  static constexpr auto name = const_name("object");
};

}  // namespace pybind11::detail
