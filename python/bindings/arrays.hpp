// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cairn/disparity/disparity_map.hpp>
#include <cairn/objects/space.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

/// Conversion between numpy arrays and images. An array is borrowed if its memory layout allows; a result is
/// the library's own memory, kept alive by its array.
namespace cairn::python {

namespace py = pybind11;

// ---- inputs; kType is their name in the stubs ----

/// A two-dimensional array of numbers, borrowed if each row is contiguous, else copied. Other shapes and
/// types throw an Error that starts with `name`. uint8 accepts bool, float other floating-point types, int32
/// other integers.
template <class T>
class Borrowed {
 public:
  static constexpr const char* kType = "NumbersLike";
  Borrowed(const py::object& value, const char* name);
  [[nodiscard]] View<const T> view() const { return view_; }
  [[nodiscard]] Size size() const { return view_.size(); }

 private:
  py::array keep_;
  View<const T> view_;
};
extern template class Borrowed<std::uint8_t>;
extern template class Borrowed<std::uint16_t>;
extern template class Borrowed<std::int16_t>;
extern template class Borrowed<std::int32_t>;
extern template class Borrowed<float>;
extern template class Borrowed<Reject>;

class Floats : public Borrowed<float> {
 public:
  static constexpr const char* kType = "FloatsLike";
  using Borrowed<float>::Borrowed;
};

/// Disparities given by the user: floats, each a hole (NaN, ±inf) or within ±kMaxDisparity. Throws Error.
class Disparities : public Floats {
 public:
  Disparities(const py::object& value, const char* name);
};

class Labels : public Borrowed<std::int32_t> {
 public:
  static constexpr const char* kType = "LabelsLike";
  using Borrowed<std::int32_t>::Borrowed;
  /// Ids of regions or objects, in the same way.
  template <class Id>
  [[nodiscard]] View<const Id> as() const {
    return {reinterpret_cast<const Id*>(view().data()), size(), view().stride()};
  }
};

/// None gives an empty view.
class Mask {
 public:
  static constexpr const char* kType = "MaskLike";
  Mask(const py::object& value, const char* name);
  [[nodiscard]] View<const std::uint8_t> view() const {
    return mask_ ? mask_->view() : View<const std::uint8_t>();
  }
  [[nodiscard]] Size size() const { return view().size(); }

 private:
  std::optional<Borrowed<std::uint8_t>> mask_;
};

/// An image, grey or in colour, as input of the stages. Borrows grey rows, and colour in the order R, G, B;
/// converting colour to grey, or the order B, G, R, needs an image of its own, from `pool`.
class Picture {
 public:
  static constexpr const char* kType = "ImageLike";
  Picture(const py::object& value, const char* name, bool bgr, const Pool& pool);
  [[nodiscard]] View<const Gray> gray() const { return gray_; }
  [[nodiscard]] View<const Rgb> rgb() const { return rgb_; }  // empty for grey images
  [[nodiscard]] Size size() const { return gray_.size(); }
  /// An array, grey or in colour in the order R, G, B.
  [[nodiscard]] py::object copy() const;

 private:
  py::array keep_;
  Image<Gray> own_gray_;
  Image<Rgb> own_rgb_;
  View<const Gray> gray_;
  View<const Rgb> rgb_;
};

/// A DisparityMap as input of a stage: one of ours, or made from floats.
class DisparityInput {
 public:
  static constexpr const char* kType = "DisparityLike";
  DisparityInput(const py::object& value, const char* name, const Exec& exec);
  [[nodiscard]] const DisparityMap& map() const { return own_ ? *own_ : *borrowed_; }
  [[nodiscard]] Size size() const { return map().disparity_px.size(); }
  /// A map that a stage may move from.
  [[nodiscard]] DisparityMap taken(const Exec& exec);

 private:
  py::object keep_;
  std::optional<DisparityMap> own_;
  const DisparityMap* borrowed_ = nullptr;
};

/// Throws Error unless both have the same size.
void expect_size(Size found, const std::string& name, Size expected, const std::string& other);

// ---- results ----

/// A copy of a borrowed image.
template <class T>
Image<T> copied(View<const T> from, const Pool& pool = {}) {
  Image<T> image(from.size(), pool);
  for (int y = 0; y < from.height(); ++y) std::copy_n(from.row(y), from.width(), image.row(y));
  return image;
}

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

/// Moves numbers into an array of this shape; {} = one-dimensional.
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

/// Releases the GIL during the work.
template <class Work>
auto released(Work&& work) {
  const py::gil_scoped_release release;
  return std::forward<Work>(work)();
}

}  // namespace cairn::python

namespace pybind11::detail {

/// Converts a function's result to an array.
template <class T>
struct as_array {
  static handle cast(T made, return_value_policy, handle) {
    return cairn::python::array_from(std::move(made)).release();
  }
  static constexpr auto name = const_name("NDArray");
};
template <class T>
struct type_caster<cairn::Image<T>> : as_array<cairn::Image<T>> {};
template <class T>
struct type_caster<cairn::python::Numbers<T>> : as_array<cairn::python::Numbers<T>> {};

}  // namespace pybind11::detail
