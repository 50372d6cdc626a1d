// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cairn/disparity/reject.hpp>
#include <cairn/objects/space.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

/// numpy arrays and the library's images. What comes in is borrowed wherever its rows lie in memory as the
/// library wants them; what goes out is the library's own memory, kept alive by the array.
namespace cairn::python {

namespace py = pybind11;

/// Labels as the library has them.
inline View<const RegionId> as_regions(View<const std::int32_t> labels) {
  return {reinterpret_cast<const RegionId*>(labels.data()), labels.size(), labels.stride()};
}

// ---- what the signatures call the arguments ----

inline bool is_anything(PyObject*) {
  return true;
}
#define CAIRN_PYTHON_ARGUMENT(Name)                        \
  class Name : public py::object {                         \
   public:                                                 \
    PYBIND11_OBJECT_DEFAULT(Name, py::object, is_anything) \
  };
CAIRN_PYTHON_ARGUMENT(ImageArgument)      // (H, W) or (H, W, 3) uint8
CAIRN_PYTHON_ARGUMENT(FloatsArgument)     // (H, W) float32
CAIRN_PYTHON_ARGUMENT(DisparityArgument)  // a DisparityMap, or floats
CAIRN_PYTHON_ARGUMENT(MaskArgument)       // (H, W) uint8 or bool, or None
CAIRN_PYTHON_ARGUMENT(LabelsArgument)     // (H, W) integers
CAIRN_PYTHON_ARGUMENT(NumbersArgument)    // (H, W) of the types that the words of the function name
CAIRN_PYTHON_ARGUMENT(RigArgument)        // a Rig, a Calibration, or None
CAIRN_PYTHON_ARGUMENT(PairsArgument)      // of images (left, right)
CAIRN_PYTHON_ARGUMENT(FramesArgument)     // of TuningFrame, or (left, right)
#undef CAIRN_PYTHON_ARGUMENT

/// An array of T, as the signatures show it.
template <class T>
class Array : public py::array {
 public:
  explicit Array(py::array numbers) : py::array(std::move(numbers)) {}
};

// ---- in ----

/// A two-dimensional array of numbers, borrowed where each row's numbers lie side by side, else copied.
/// Throws Error that begins with `name` for another shape or type. The array must outlive the view.
template <class T>
class Borrowed {
 public:
  Borrowed(const py::object& value, const char* name);
  [[nodiscard]] View<const T> view() const { return view_; }
  [[nodiscard]] Size size() const { return view_.size(); }

 private:
  py::array keep_;
  View<const T> view_;
};
// uint8: bool counts, too. float: other floating types are converted. int32: other integers are.
extern template class Borrowed<std::uint8_t>;
extern template class Borrowed<std::uint16_t>;
extern template class Borrowed<std::int16_t>;
extern template class Borrowed<std::int32_t>;
extern template class Borrowed<float>;
extern template class Borrowed<Reject>;

/// Disparities from outside: floats, each a hole (NaN, ±inf) or within ±kMaxDisparity. Throws Error.
class BorrowedDisparities : public Borrowed<float> {
 public:
  BorrowedDisparities(const py::object& value, const char* name);
};

/// None: an empty view.
class BorrowedMask {
 public:
  BorrowedMask(const py::object& value, const char* name);
  [[nodiscard]] View<const std::uint8_t> view() const {
    return mask_ ? mask_->view() : View<const std::uint8_t>();
  }

 private:
  std::optional<Borrowed<std::uint8_t>> mask_;
};

/// A picture, grey or in colour, as the stages take it. Borrows grey rows, and colour in the order R, G, B;
/// the grey of colours and the order B, G, R need an image of their own, from `pool`.
class Picture {
 public:
  Picture(const py::object& value, const char* name, bool bgr, const Pool& pool);
  [[nodiscard]] View<const Gray> gray() const { return gray_; }
  [[nodiscard]] View<const Rgb> rgb() const { return rgb_; }  // empty where it is grey
  [[nodiscard]] Size size() const { return gray_.size(); }
  /// Grey, or colour in the order R, G, B, as an array of its own.
  [[nodiscard]] Array<std::uint8_t> copy() const;

 private:
  py::array keep_;
  Image<Gray> own_gray_;
  Image<Rgb> own_rgb_;
  View<const Gray> gray_;
  View<const Rgb> rgb_;
};

/// Throws Error unless both have the same size.
void expect_size(Size found, const char* name, Size expected, const char* other);

// ---- out ----

/// An image of its own of what is borrowed.
template <class T>
Image<T> copied(View<const T> from, const Pool& pool = {}) {
  Image<T> image(from.size(), pool);
  for (int y = 0; y < from.height(); ++y) std::copy_n(from.row(y), from.width(), image.row(y));
  return image;
}

/// The numbers that a pixel is made of, as numpy knows them.
template <class T>
struct NumbersOf {
  using Type = T;
  static constexpr int kCount = 1;
};
template <>
struct NumbersOf<Reject> {
  using Type = std::uint16_t;
  static constexpr int kCount = 1;
};
template <>
struct NumbersOf<RegionId> {
  using Type = std::int32_t;
  static constexpr int kCount = 1;
};
template <>
struct NumbersOf<Space> {
  using Type = std::uint8_t;
  static constexpr int kCount = 1;
};
template <>
struct NumbersOf<ObjectId> {
  using Type = std::int32_t;
  static constexpr int kCount = 1;
};
template <>
struct NumbersOf<Rgb> {
  using Type = std::uint8_t;
  static constexpr int kCount = 3;
};

template <class T>
using ArrayOf = Array<typename NumbersOf<T>::Type>;

/// The image's pixels as an array that keeps `owner` alive.
template <class T>
ArrayOf<T> array_over(const Image<T>& image, const py::object& owner, bool writable) {
  using Number = typename NumbersOf<T>::Type;
  constexpr py::ssize_t kCount = NumbersOf<T>::kCount;
  constexpr auto kBytes = static_cast<py::ssize_t>(sizeof(Number));
  const py::ssize_t height = image.height();
  const py::ssize_t width = image.width();
  const py::ssize_t stride = image.view().stride() * static_cast<py::ssize_t>(sizeof(T));
  py::array::ShapeContainer shape{height, width};
  py::array::StridesContainer strides{stride, kCount * kBytes};
  if constexpr (kCount > 1) {
    shape->push_back(kCount);
    strides->push_back(kBytes);
  }
  py::array array(py::dtype::of<Number>(), shape, strides, image.view().data(), owner);
  if (!writable) py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return ArrayOf<T>(std::move(array));
}

/// The image itself becomes the array: moved, not copied.
template <class T>
ArrayOf<T> array_from(Image<T> image) {
  auto owned = std::make_unique<Image<T>>(std::move(image));
  const Image<T>& pixels = *owned;
  const py::capsule owner(owned.get(), [](void* pointer) { delete static_cast<Image<T>*>(pointer); });
  owned.release();
  return array_over(pixels, owner, true);
}

/// The numbers themselves become a flat array: moved, not copied.
template <class T>
Array<T> array_from(std::vector<T> numbers) {
  auto owned = std::make_unique<std::vector<T>>(std::move(numbers));
  const std::vector<T>& kept = *owned;
  const py::capsule owner(owned.get(), [](void* pointer) { delete static_cast<std::vector<T>*>(pointer); });
  owned.release();
  return Array<T>(py::array(py::dtype::of<T>(), static_cast<py::ssize_t>(kept.size()), kept.data(), owner));
}

/// An image as an array; None where it is empty.
template <class T>
std::optional<ArrayOf<T>> array_or_none(Image<T> image) {
  if (image.empty()) return std::nullopt;
  return array_from(std::move(image));
}

/// A property that shows an image of its object, read-only: what a stage relies on cannot be changed under
/// it. None where the image is empty.
template <class C, class T>
auto shown(Image<T> C::*member) {
  return [member](const py::object& self) -> std::optional<ArrayOf<T>> {
    const Image<T>& image = self.cast<const C&>().*member;
    if (image.empty()) return std::nullopt;
    return array_over(image, self, false);
  };
}
/// The same of an image that is always there.
template <class C, class T>
auto always_shown(Image<T> C::*member) {
  return [member](const py::object& self) -> ArrayOf<T> {
    return array_over(self.cast<const C&>().*member, self, false);
  };
}

/// Runs the work while other Python threads run theirs.
template <class Work>
auto released(Work&& work) {
  const py::gil_scoped_release release;
  return std::forward<Work>(work)();
}

}  // namespace cairn::python

namespace pybind11::detail {

#define CAIRN_PYTHON_NAME(Type, Text)              \
  template <>                                      \
  struct handle_type_name<cairn::python::Type> {   \
    static constexpr auto name = const_name(Text); \
  };
CAIRN_PYTHON_NAME(ImageArgument, "ImageLike")
CAIRN_PYTHON_NAME(FloatsArgument, "FloatsLike")
CAIRN_PYTHON_NAME(DisparityArgument, "DisparityLike")
CAIRN_PYTHON_NAME(MaskArgument, "MaskLike")
CAIRN_PYTHON_NAME(LabelsArgument, "LabelsLike")
CAIRN_PYTHON_NAME(NumbersArgument, "NumbersLike")
CAIRN_PYTHON_NAME(RigArgument, "RigLike")
CAIRN_PYTHON_NAME(PairsArgument, "PairsLike")
CAIRN_PYTHON_NAME(FramesArgument, "FramesLike")
#undef CAIRN_PYTHON_NAME

template <class T>
struct handle_type_name<cairn::python::Array<T>> {
  static constexpr auto name = const_name("NDArray[") + npy_format_descriptor<T>::name + const_name("]");
};

}  // namespace pybind11::detail
