// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <io/disparity_files.hpp>
#include <io/image_files.hpp>
#include <io/overlay.hpp>
#include <utility>

#include "bindings.hpp"
#include "disparity.hpp"
#include "options.hpp"
#include "rig.hpp"

namespace cairn::python {
namespace {

namespace fs = std::filesystem;

/// Colour where the file has it, else grey.
Array<std::uint8_t> picture_array(io::Picture picture) {
  if (picture.rgb.empty()) return array_from(std::move(picture.gray));
  return array_from(std::move(picture.rgb));
}

Array<std::uint8_t> load_picture(const fs::path& path) {
  return picture_array(released([&] { return io::load_picture(path); }));
}

std::pair<Array<std::uint8_t>, Array<std::uint8_t>> load_pair(const fs::path& left, const fs::path& right) {
  io::PicturePair pair = released([&] { return io::load_pair(left, right); });
  return {picture_array(std::move(pair.left)), picture_array(std::move(pair.right))};
}

Array<float> load_disparity(const fs::path& path) {
  return array_from(released([&] { return io::load_disparity(path); }));
}

Array<std::uint16_t> load_labels(const fs::path& path) {
  return array_from(released([&] { return std::move(io::load_labels(path).ids); }));
}

void save_disparity(const fs::path& path, const FloatsArgument& disparity_px) {
  const Borrowed<float> in(disparity_px, "disparity_px");
  released([&] { io::save_disparity(path, in.view()); });
}

void save_png(const fs::path& path, const NumbersArgument& image) {
  if (py::isinstance<py::array_t<std::uint16_t>>(image)) {
    const Borrowed<std::uint16_t> in(image, "image");
    return released([&] { io::save_png(path, in.view()); });
  }
  const Picture in(image, "image", false, {});
  released([&] {
    if (in.rgb().empty()) return io::save_png(path, in.gray());
    io::save_png(path, in.rgb());
  });
}

Array<std::uint8_t> draw_disparity(const DisparityArgument& disparity, const RigArgument& rig) {
  const DisparityInput map(disparity, "disparity", {});
  const auto known = rig_of(rig);
  return array_from(released([&] { return io::draw_disparity(map.map(), known); }));
}

Array<std::uint8_t> draw_objects(const ImageArgument& left, const Objects& objects, const MaskArgument& floor,
                                 bool bgr) {
  const Picture in(left, "left", bgr, {});
  const BorrowedMask mask(floor, "floor");
  expect_size(objects.labels.size(), "objects", in.size(), "left");
  if (!mask.view().empty()) expect_size(mask.view().size(), "floor", in.size(), "left");
  return array_from(released([&] { return io::draw_objects(in.gray(), in.rgb(), objects, mask.view()); }));
}

/// Where a picture's pixels, grey or colours, are read from: for the test that none are copied.
std::size_t address_of_pixels(const ImageArgument& image, bool bgr) {
  const Picture in(image, "image", bgr, {});
  if (in.rgb().empty()) return reinterpret_cast<std::size_t>(in.gray().data());
  return reinterpret_cast<std::size_t>(in.rgb().data());
}

}  // namespace

void bind_io(py::module_& m) {
  using py::literals::operator""_a;
  m.def("load_picture", &load_picture, "path"_a,
        "A PNG, JPEG, PGM, PPM or TIFF file: (H, W) uint8 where it is grey, (H, W, 3) RGB where it is in "
        "colour. Of deeper "
        "pictures the low bits are dropped.");
  m.def("load_pair", &load_pair, "left"_a, "right"_a,
        "Both pictures; deeper ones are reduced by the same factor, so that a difference of exposure stays "
        "what it was.");
  m.def("load_disparity", &load_disparity, "path"_a,
        "A disparity map from .png (16 bits, px * 256, 0 = hole), .pfm or .npy, or of Middlebury in its own "
        "8 bits: (H, W) float32, px, NaN = hole.");
  m.def("save_disparity", &save_disparity, "path"_a, "disparity_px"_a,
        "Writes a map as .png or .pfm, whole or not at all.");
  m.def("load_labels", &load_labels, "path"_a,
        "The numbers of a one-channel file as they stand: (H, W) uint16.");
  m.def("save_png", &save_png, "path"_a, "image"_a,
        "Writes (H, W) uint8 or uint16, or (H, W, 3) uint8 RGB, as PNG, whole or not at all.");
  m.def("draw_disparity", &draw_disparity, "disparity"_a, "rig"_a = py::none(),
        "Disparity as colour, holes in colours that tell the reason, with a legend (with a rig in metres, "
        "too): (h, w, 3) "
        "uint8, RGB.");
  m.def("draw_objects", &draw_objects, "left"_a, "objects"_a, "floor"_a = py::none(), py::kw_only(),
        "bgr"_a = false, "The left picture with the objects drawn in: (h, w, 3) uint8, RGB.");
  m.def("_address_of_pixels", &address_of_pixels, "image"_a, "bgr"_a = false);
}

}  // namespace cairn::python
