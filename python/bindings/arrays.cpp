// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "arrays.hpp"

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/disparity/disparity_map.hpp>
#include <cmath>
#include <io/image_files.hpp>
#include <string>
#include <type_traits>

namespace cairn::python {
namespace {

std::string type_of(const py::object& value) {
  return py::type::of(value).attr("__name__").cast<std::string>();
}

[[noreturn]] void refuse(const char* name, const std::string& found, const std::string& expected) {
  throw Error(std::string(name) + ": found " + found + ", expected " + expected);
}

/// "an array of shape (3, 4) and type float64"
std::string described(const py::array& array) {
  return "an array of shape " + py::str(array.attr("shape")).cast<std::string>() + " and type " +
         py::str(array.dtype()).cast<std::string>();
}

/// Converts an array-like object, such as a PIL image, to an ndarray.
py::array array_like(const py::object& value, const char* name, const std::string& expected) {
  if (py::isinstance<py::array>(value)) return py::reinterpret_borrow<py::array>(value);
  const bool is_like = py::hasattr(value, "__array__") || py::hasattr(value, "__array_interface__") ||
                       PyObject_CheckBuffer(value.ptr()) == 1;
  if (is_like && !py::isinstance<py::bytes>(value)) {
    if (py::array array = py::array::ensure(value)) return array;
  }
  refuse(name, value.is_none() ? "None" : "a value of type " + type_of(value), expected);
}

/// The size of an image in the library's order.
Size size_of(const py::array& array, const char* name, const std::string& expected) {
  constexpr py::ssize_t kMostPixels = py::ssize_t{1} << 28;
  const py::ssize_t height = array.shape(0);
  const py::ssize_t width = array.shape(1);
  if (height < 1 || width < 1) refuse(name, described(array), expected + " with at least one pixel");
  if (height > kMostPixels / width) refuse(name, described(array), expected + " of at most 2^28 pixels");
  return {static_cast<int>(width), static_cast<int>(height)};
}

/// Whether the pixels of a row are contiguous and the rows a whole number of pixels apart.
bool has_plain_rows(const py::array& array, py::ssize_t pixel_bytes) {
  const bool aligned = (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
  const bool dense = array.shape(1) == 1 || array.strides(1) == pixel_bytes;
  const bool stacked = array.shape(0) == 1 || (array.strides(0) >= array.shape(1) * pixel_bytes &&
                                               array.strides(0) % pixel_bytes == 0);
  const bool channels = array.ndim() == 2 || array.strides(2) == array.itemsize();
  return aligned && dense && stacked && channels;
}

py::array with_plain_rows(const py::array& array, py::ssize_t pixel_bytes) {
  return has_plain_rows(array, pixel_bytes) ? array : py::array(array.attr("copy")());
}

template <class T>
View<const T> view_over(const py::array& array, Size size) {
  const auto bytes = static_cast<py::ssize_t>(sizeof(T));
  const std::ptrdiff_t stride = size.height == 1 ? size.width : array.strides(0) / bytes;
  return {static_cast<const T*>(array.data()), size, stride};
}

bool is_kind(const py::array& array, const char* kinds) {
  return std::string(kinds).find(array.dtype().kind()) != std::string::npos;
}

/// Type kinds, in numpy's notation, that are converted.
template <class T>
constexpr const char* kConverted = "";
template <>
constexpr const char* kConverted<float> = "f";
template <>
constexpr const char* kConverted<std::int32_t> = "iu";
template <>
constexpr const char* kConverted<std::uint8_t> = "b";

}  // namespace

template <class T>
Borrowed<T>::Borrowed(const py::object& value, const char* name) {
  using Number = typename NumbersOf<T>::Type;
  const auto type = py::str(py::dtype::of<Number>()).cast<std::string>();
  const std::string expected = "an array (height, width) of " + type;
  py::array array = array_like(value, name, expected);
  if (array.ndim() != 2) refuse(name, described(array), expected);
  if (!py::isinstance<py::array_t<Number>>(array)) {
    if (!is_kind(array, kConverted<T>)) refuse(name, described(array), expected);
    array = array.attr("astype")(type);
  }
  const Size size = size_of(array, name, expected);
  keep_ = with_plain_rows(array, static_cast<py::ssize_t>(sizeof(Number)));
  view_ = view_over<T>(keep_, size);
}
template class Borrowed<std::uint8_t>;
template class Borrowed<std::uint16_t>;
template class Borrowed<std::int16_t>;
template class Borrowed<std::int32_t>;
template class Borrowed<float>;
template class Borrowed<Reject>;

Disparities::Disparities(const py::object& value, const char* name) : Floats(value, name) {
  const View<const float> px = view();
  for (int y = 0; y < px.height(); ++y) {
    const float* row = px.row(y);
    const float* bad = std::find_if(row, row + px.width(),
                                    [](float d) { return std::isfinite(d) && std::abs(d) > kMaxDisparity; });
    if (bad == row + px.width()) continue;
    throw Error(std::string(name) + ": found disparity " + std::to_string(*bad) + " px at x " +
                std::to_string(bad - row) + ", y " + std::to_string(y) + ", expected at most ±" +
                std::to_string(static_cast<int>(kMaxDisparity)) + ", or NaN for a hole");
  }
}

Mask::Mask(const py::object& value, const char* name) {
  if (!value.is_none()) mask_.emplace(value, name);
}

Picture::Picture(const py::object& value, const char* name, bool bgr, const Pool& pool) {
  const std::string expected = "an image: an array (height, width) or (height, width, 3) of uint8";
  py::array array = array_like(value, name, expected);
  if (array.ndim() == 3 && array.shape(2) == 1) array = array.attr("reshape")(array.shape(0), array.shape(1));
  const bool colour = array.ndim() == 3 && array.shape(2) == 3;
  if (!py::isinstance<py::array_t<std::uint8_t>>(array) || (array.ndim() != 2 && !colour)) {
    refuse(name, described(array), expected);
  }
  const Size size = size_of(array, name, expected);
  keep_ = with_plain_rows(array, colour ? 3 : 1);
  if (!colour) {
    gray_ = view_over<Gray>(keep_, size);
    return;
  }
  rgb_ = view_over<Rgb>(keep_, size);
  const py::gil_scoped_release release;
  if (bgr) {
    own_rgb_ = Image<Rgb>(size, pool);
    for (int y = 0; y < size.height; ++y) {
      std::transform(rgb_.row(y), rgb_.row(y) + size.width, own_rgb_.row(y), [](Rgb c) {
        return Rgb{c.b, c.g, c.r};
      });
    }
    rgb_ = own_rgb_;
  }
  own_gray_ = io::grey_of(rgb_, pool);
  gray_ = own_gray_;
}

py::object Picture::copy() const {
  return rgb_.empty() ? array_from(copied(gray_)) : array_from(copied(rgb_));
}

DisparityInput::DisparityInput(const py::object& value, const char* name, const Exec& exec) {
  if (py::isinstance<DisparityMap>(value)) {
    keep_ = value;
    borrowed_ = &value.cast<const DisparityMap&>();
    return;
  }
  const Floats in(value, name);
  own_ = released([&] { return external_disparity(in.view(), exec); });
}

DisparityMap DisparityInput::taken(const Exec& exec) {
  if (own_) return std::move(*own_);
  return {borrowed_->disparity_px.clone(exec.pool), borrowed_->reject.clone(exec.pool)};
}

void expect_size(Size found, const std::string& name, Size expected, const std::string& other) {
  if (found == expected) return;
  throw Error(name + ": is " + text(found) + ", expected " + text(expected) + " as " + other + " is");
}

}  // namespace cairn::python
