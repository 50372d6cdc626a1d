// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <filesystem>
#include <io/disparity_files.hpp>
#include <io/image_files.hpp>
#include <io/overlay.hpp>

#include "bindings.hpp"
#include "define.hpp"

namespace cairn::python {
namespace {

namespace fs = std::filesystem;
using AnyImage = Typed<"NDArray[numpy.uint8]">;

void save_png(const fs::path& path, const Typed<"NumbersLike">& image) {
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

}  // namespace

py::object picture_array(io::Picture picture) {
  return picture.rgb.empty() ? array_from(std::move(picture.gray)) : array_from(std::move(picture.rgb));
}

void bind_io(py::module_& m) {
  using py::literals::operator""_a;
  define(
      m, "load_picture",
      "A PNG, JPEG, PGM or PPM file: (H, W) uint8 where it is grey, (H, W, 3) RGB where it is in "
      "colour. Of "
      "deeper images the low bits are dropped.",
      [](const fs::path& path) {
        return AnyImage(picture_array(released([&] { return io::load_picture(path); })));
      },
      "path"_a);
  define(
      m, "load_pair",
      "Both images; deeper ones are reduced by the same factor, so that a difference of exposure stays what "
      "it was.",
      [](const fs::path& left, const fs::path& right) {
        io::PicturePair pair = released([&] { return io::load_pair(left, right); });
        return std::pair<AnyImage, AnyImage>(picture_array(std::move(pair.left)),
                                             picture_array(std::move(pair.right)));
      },
      "left"_a, "right"_a);
  define(
      m, "load_disparity",
      "A disparity map from .png (16 bits, px * 256, 0 = hole), .pfm or .npy, or of Middlebury in its own 8 "
      "bits: (H, "
      "W) float32, px, NaN = hole.",
      [](const fs::path& path) { return released([&] { return io::load_disparity(path); }); }, "path"_a);
  define(
      m, "save_disparity", "Writes a map as .png or .pfm, whole or not at all.",
      [](const fs::path& path, const Floats& disparity_px) {
        released([&] { io::save_disparity(path, disparity_px.view()); });
      },
      "path"_a, "disparity_px"_a);
  define(
      m, "load_labels", "The numbers of a one-channel file as they stand: (H, W) uint16.",
      [](const fs::path& path) { return released([&] { return std::move(io::load_labels(path).ids); }); },
      "path"_a);
  define(m, "save_png", "Writes (H, W) uint8 or uint16, or (H, W, 3) uint8 RGB, as PNG, whole or not at all.",
         &save_png, "path"_a, "image"_a);
  define(
      m, "draw_disparity",
      "Disparity as colour, holes in colours that tell the reason, with a legend (with a rig in metres, "
      "too): (h, w, "
      "3) uint8, RGB.",
      [](const DisparityInput& disparity, const KnownRig& rig) {
        return released([&] { return io::draw_disparity(disparity.map(), rig.rig()); });
      },
      "disparity"_a, "rig"_a = py::none());
  define(
      m, "draw_objects", "The left image with the objects drawn in: (h, w, 3) uint8, RGB.",
      [](const Picture& left, const Objects& objects, const Mask& floor) {
        return released([&] { return io::draw_objects(left.gray(), left.rgb(), objects, floor.view()); });
      },
      "left"_a, "objects"_a, "floor"_a = py::none());
  // The address of an image's pixels, for the test that none are copied.
  define(
      m, "_address_of_pixels", "",
      [](const Picture& image) {
        return image.rgb().empty() ? reinterpret_cast<std::size_t>(image.gray().data())
                                   : reinterpret_cast<std::size_t>(image.rgb().data());
      },
      "image"_a);
}

}  // namespace cairn::python
