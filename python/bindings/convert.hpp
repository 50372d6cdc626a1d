// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cairn/core/exec.hpp>
#include <cairn/core/fields.hpp>
#include <cairn/regions/object_hints.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <memory>
#include <utility>
#include <vector>

#include "members.hpp"

/// Conversion between Python and C++: arrays, tuples, names of choices. The package (python/cairn) checks the
/// arguments first; what it passes fits.
namespace cairn::python {

namespace py = pybind11;

/// Releases the GIL during the work, or (as an argument of def()) during a call.
template <class Work>
auto released(Work&& work) {
  const py::gil_scoped_release release;
  return std::forward<Work>(work)();
}
using Released = py::call_guard<py::gil_scoped_release>;

// ---- arrays ----

/// The components of a pixel as a numpy type.
template <class T>
struct NumbersOf {
  using Type =
      typename std::conditional_t<std::is_enum_v<T>, std::underlying_type<T>, std::type_identity<T>>::type;
  static constexpr int kCount = 1;
};
template <>
struct NumbersOf<Rgb> {
  using Type = std::uint8_t;
  static constexpr int kCount = 3;
};

template <>
struct NumbersOf<ObjectHint> {
  using Type = std::int16_t;
  static constexpr int kCount = 5;
};

/// The image's pixels as an array that keeps `owner` alive; None for an empty image.
template <class T>
py::object array_over(const Image<T>& image, const py::object& owner, bool writable = false) {
  if (image.empty()) return py::none();
  using Number = typename NumbersOf<T>::Type;
  constexpr py::ssize_t kCount = NumbersOf<T>::kCount;
  constexpr auto kBytes = static_cast<py::ssize_t>(sizeof(Number));
  const py::ssize_t stride = image.view().stride() * static_cast<py::ssize_t>(sizeof(T));
  py::array::ShapeContainer shape{image.height(), image.width()};
  py::array::StridesContainer strides{stride, kCount * kBytes};
  if constexpr (kCount > 1) {
    shape->push_back(kCount);
    strides->push_back(kBytes);
  }
  py::array array(py::dtype::of<Number>(), shape, strides, image.view().data(), owner);
  if (!writable) py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

/// The value lives as long as the arrays that refer to it.
template <class T>
std::pair<const T&, py::capsule> kept_alive(T value) {
  auto owned = std::make_unique<T>(std::move(value));
  const T& kept = *owned;
  py::capsule owner(owned.get(), [](void* pointer) { delete static_cast<T*>(pointer); });
  owned.release();
  return {kept, std::move(owner)};
}

/// Moves the image into an array, without copying. None if it is empty.
template <class T>
py::object array_from(Image<T> image) {
  const auto [pixels, owner] = kept_alive(std::move(image));
  return array_over(pixels, owner, true);
}

/// Numbers that become an array of this shape; {} = one-dimensional.
template <class T>
struct Numbers {
  std::vector<T> values;
  std::vector<py::ssize_t> shape{};
};
template <class T>
py::object array_from(Numbers<T> numbers) {
  if (numbers.shape.empty()) numbers.shape = {static_cast<py::ssize_t>(numbers.values.size())};
  const std::vector<py::ssize_t> shape = numbers.shape;
  const auto [kept, owner] = kept_alive(std::move(numbers));
  return py::array(py::dtype::of<T>(), shape, kept.values.data(), owner);
}

/// A copy of a borrowed image.
template <class T>
Image<T> copied(View<const T> from, const Pool& pool = {}) {
  Image<T> image(from.size(), pool);
  for (int y = 0; y < from.height(); ++y) std::copy_n(from.row(y), from.width(), image.row(y));
  return image;
}

/// Whether the pixels of a row are contiguous and the rows a whole number of pixels apart.
bool is_dense(const py::array& array);

/// A borrowed array with dense rows.
template <class T>
View<const T> view_over(const py::array& array) {
  const Size size{static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0))};
  const auto bytes = static_cast<py::ssize_t>(sizeof(T));
  return {static_cast<const T*>(array.data()), size,
          size.height == 1 ? size.width : array.strides(0) / bytes};
}

/// An image, grey or in colour, as input of the stages. Borrows a dense array; converting colour to grey, or
/// the order B, G, R, needs an image of its own, from a pool.
class LoadedImage {
 public:
  LoadedImage(py::array array, bool bgr, const Pool& pool);
  [[nodiscard]] View<const Gray> gray() const { return gray_; }
  [[nodiscard]] View<const Rgb> rgb() const { return rgb_; }  // empty for grey images
  /// An array, grey or in colour in the order R, G, B.
  [[nodiscard]] py::object copy() const {
    return rgb_.empty() ? array_from(copied(gray_)) : array_from(copied(rgb_));
  }

 private:
  py::array keep_;
  Image<Gray> own_gray_;
  Image<Rgb> own_rgb_;
  View<const Gray> gray_;
  View<const Rgb> rgb_;
};

// ---- small values ----

/// Enums whose values have names.
template <class E>
struct Names;
#define CAIRN_NAMES(Enum, choices)         \
  template <>                              \
  struct Names<Enum> {                     \
    static constexpr auto& kAll = choices; \
  };

/// An attribute: images become read-only arrays over the owner's memory, other values refer to it.
template <class T>
py::object attribute(const T& value, const py::object& owner) {
  if constexpr (kIsImage<T>) {
    return array_over(value, owner);
  } else {
    return py::cast(value, py::return_value_policy::reference_internal, owner);
  }
}

}  // namespace cairn::python

namespace pybind11::detail {

template <class T>
struct as_array {
  static handle cast(T made, return_value_policy, handle) {
    return cairn::python::array_from(std::move(made)).release();
  }
  static constexpr auto name = const_name("array");
};
template <class T>
struct type_caster<cairn::Image<T>> : as_array<cairn::Image<T>> {};
template <class T>
struct type_caster<cairn::python::Numbers<T>> : as_array<cairn::python::Numbers<T>> {};

/// Borrows an array of exactly this type, a Picture, or the disparities of a DisparityMap. None: empty.
template <class T>
struct type_caster<cairn::View<const T>> {
  static constexpr auto name = const_name("array");
  template <class>
  using cast_op_type = cairn::View<const T>;
  operator cairn::View<const T>() const { return value; }  // NOLINT: as casters do

  bool load(handle from, bool) {
    using Number = typename cairn::python::NumbersOf<T>::Type;
    if (from.is_none()) return true;
    if constexpr (std::is_same_v<T, cairn::Gray> || std::is_same_v<T, cairn::Rgb>) {
      if (isinstance<cairn::python::LoadedImage>(from)) {
        const auto& picture = from.cast<const cairn::python::LoadedImage&>();
        if constexpr (std::is_same_v<T, cairn::Gray>) value = picture.gray();
        if constexpr (std::is_same_v<T, cairn::Rgb>) value = picture.rgb();
        return true;
      }
    }
    if constexpr (std::is_same_v<T, float>) {
      if (isinstance<cairn::DisparityMap>(from)) {
        value = from.cast<const cairn::DisparityMap&>().disparity_px;
        return true;
      }
    }
    if (!isinstance<array_t<Number>>(from)) return false;
    const auto array = reinterpret_borrow<pybind11::array>(from);
    if (array.ndim() != (cairn::python::NumbersOf<T>::kCount > 1 ? 3 : 2)) return false;
    if (!cairn::python::is_dense(array)) return false;
    value = cairn::python::view_over<T>(array);
    return true;
  }
  cairn::View<const T> value;
};

/// Ids are numbers, choices their names.
template <class E>
struct type_caster<E, enable_if_t<std::is_enum_v<E>>> {
  static constexpr auto name = const_name("int");
  static handle cast(E value, return_value_policy, handle) {
    if constexpr (requires { cairn::python::Names<E>::kAll; }) {
      return pybind11::str(cairn::choice_name(value, cairn::python::Names<E>::kAll)).release();
    } else {
      return pybind11::int_(static_cast<std::int64_t>(value)).release();
    }
  }
};

/// Vectors, boxes, colours and the like are tuples.
template <class T>
struct type_caster<T, enable_if_t<cairn::python::kIsTuple<T>>> {
  PYBIND11_TYPE_CASTER(T, const_name("tuple"));
  static handle cast(const T& from, return_value_policy, handle) {
    return std::apply([](const auto&... part) { return make_tuple(part...); },
                      cairn::python::Members<T>::of(from))
        .release();
  }
  bool load(handle from, bool) {
    const auto parts = reinterpret_borrow<sequence>(from);
    std::size_t i = 0;
    const auto set = [&]<class N>(N& part) { part = object(parts[i++]).cast<N>(); };
    std::apply([&](auto&... part) { (set(part), ...); }, cairn::python::Members<T>::of(value));
    return true;
  }
};

}  // namespace pybind11::detail
