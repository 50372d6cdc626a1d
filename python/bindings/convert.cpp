// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "convert.hpp"

#include <cairn/io/image_files.hpp>

namespace cairn::python {

bool is_dense(const py::array& array) {
  const py::ssize_t pixel_bytes = array.itemsize() * (array.ndim() == 3 ? array.shape(2) : 1);
  const bool aligned = (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
  const bool dense = array.shape(1) == 1 || array.strides(1) == pixel_bytes;
  const bool stacked = array.shape(0) == 1 || (array.strides(0) >= array.shape(1) * pixel_bytes &&
                                               array.strides(0) % pixel_bytes == 0);
  const bool channels = array.ndim() == 2 || array.strides(2) == array.itemsize();
  return aligned && dense && stacked && channels;
}

LoadedImage::LoadedImage(py::array array, bool bgr, const Pool& pool) : keep_(std::move(array)) {
  if (keep_.ndim() == 2) {
    gray_ = view_over<Gray>(keep_);
    return;
  }
  rgb_ = view_over<Rgb>(keep_);
  const py::gil_scoped_release release;
  if (bgr) {
    own_rgb_ = copied(rgb_, pool);
    for (int y = 0; y < rgb_.height(); ++y)
      std::for_each_n(own_rgb_.row(y), rgb_.width(), [](Rgb& c) { std::swap(c.r, c.b); });
    rgb_ = own_rgb_;
  }
  own_gray_ = io::grey_of(rgb_, pool);
  gray_ = own_gray_;
}

}  // namespace cairn::python
