// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <bit>
#include <cairn/core/error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/calibration_forms.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/io/read_file.hpp>
#include <cairn/stereo/disparity_map.hpp>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;
constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

enum class Form : std::uint8_t { png, pfm, npy };

Form form_of(const fs::path& path, bool written) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".png") return Form::png;
  if (extension == ".pfm") return Form::pfm;
  if (extension == ".pgm" && !written) return Form::png;
  if (extension == ".npy" && !written) return Form::npy;
  throw Error(path.string() + ": has the extension '" + extension +
              (written ? "', expected .png (16 bits) or .pfm for a disparity map"
                       : "', expected .png (16 bits), .pfm or .npy for a disparity map"));
}

// ---- PNG ----

/// d · 256, rounded; 0 marks holes, so a true 0 becomes 1. nullopt beyond 16 bits.
std::optional<std::uint16_t> encoded(float disparity_px) {
  if (!std::isfinite(disparity_px)) return std::uint16_t{0};
  const double value = std::nearbyint(double{disparity_px} * 256.0);
  if (disparity_px < 0 || value > 65535) return std::nullopt;
  return static_cast<std::uint16_t>(std::max(value, 1.0));
}

/// Middlebury's 8-bit maps do not state their unit; it follows from the height of the images in each data
/// set.
struct MiddleburySet {
  int height;
  float unit;  // steps per px
};
constexpr std::array kMiddleburySets = {
    MiddleburySet{1110, 1}, MiddleburySet{555, 2}, MiddleburySet{370, 3},  // 2005, 2006
    MiddleburySet{1500, 1}, MiddleburySet{750, 2}, MiddleburySet{375, 4},  // 2003
    MiddleburySet{380, 8},  MiddleburySet{381, 8}, MiddleburySet{383, 8},  // 2001
    MiddleburySet{216, 8}};

float middlebury_unit(const fs::path& path, Size size) {
  const std::string stem = path.stem().string();
  if (!stem.starts_with("disp") || stem.size() != 5 ||
      std::isdigit(static_cast<unsigned char>(stem[4])) == 0) {
    throw Error(path.string() +
                ": has 8 bits, expected the 16 of a disparity map (disparity * 256, 0 = hole)");
  }
  const auto* set = std::find_if(kMiddleburySets.begin(), kMiddleburySets.end(),
                                 [&](const MiddleburySet& each) { return each.height == size.height; });
  if (set != kMiddleburySets.end()) return set->unit;
  throw Error(path.string() + ": has 8 bits and is " + text(size) +
              ", not the size of a Middlebury map of known scale; expected 16 bits (disparity * 256)");
}

Image<float> divided(View<const std::uint16_t> values, float unit, const Pool& pool) {
  Image<float> all(values.size(), pool);
  for (int y = 0; y < all.height(); ++y) {
    const std::uint16_t* from = values.row(y);
    std::transform(from, from + all.width(), all.row(y),
                   [&](std::uint16_t v) { return v == 0 ? kHole : static_cast<float>(v) / unit; });
  }
  return all;
}

Image<float> load_png(const fs::path& path, const Pool& pool) {
  const Labels values = load_labels(path);
  return divided(values.ids, values.bits == 16 ? 256.0F : middlebury_unit(path, values.ids.size()), pool);
}

void save_as_png(const fs::path& path, View<const float> disparity_px) {
  Image<std::uint16_t> values(disparity_px.size());
  for (int y = 0; y < values.height(); ++y) {
    for (int x = 0; x < values.width(); ++x) {
      const std::optional<std::uint16_t> value = encoded(disparity_px(x, y));
      if (!value) {
        throw Error(path.string() + ": 16-bit PNG holds disparities from 0 to 255.998, found " +
                    std::to_string(disparity_px(x, y)) + " at (" + std::to_string(x) + ", " +
                    std::to_string(y) + "): write a .pfm instead");
      }
      values(x, y) = *value;
    }
  }
  save_png(path, values.view());
}

// ---- PFM ----

struct PfmHeader {
  Size size;
  bool little_endian = true;
  std::size_t bytes = 0;  // of the header
};

/// The header has three lines: "Pf", width and height, scale. The sign of the scale is the byte order; its
/// magnitude is ignored.
class HeaderWords {
 public:
  explicit HeaderWords(std::string_view file) : file_(file) {}

  std::string_view next() {
    while (at_ < file_.size() && std::isspace(static_cast<unsigned char>(file_[at_])) != 0) ++at_;
    const std::size_t begin = at_;
    while (at_ < file_.size() && std::isspace(static_cast<unsigned char>(file_[at_])) == 0) ++at_;
    return file_.substr(begin, at_ - begin);
  }
  /// A number that takes up its whole word.
  template <class T>
  T number(const char* what) {
    const std::string_view word = next();
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) {
      throw Error(std::string("is a truncated or damaged PFM: its ") + what + " is not a number");
    }
    return value;
  }
  /// Start of the pixels: one white space after the last word.
  [[nodiscard]] std::size_t end() const { return at_ + 1; }

 private:
  std::string_view file_;
  std::size_t at_ = 0;
};

PfmHeader read_header(std::string_view file) {
  HeaderWords words(file.substr(0, 256));
  const std::string_view kind = words.next();
  if (kind == "PF") throw Error("is a PFM in colour, expected one channel ('Pf')");
  if (kind != "Pf") throw Error("is not a PFM: it does not begin with 'Pf'");
  const int width = words.number<int>("width");
  const int height = words.number<int>("height");
  check_sides(width, height);
  const auto scale = words.number<double>("scale");
  if (!std::isfinite(scale) || scale == 0) {
    throw Error("is a damaged PFM: its scale is 0 or not finite, expected the sign of the byte order");
  }
  return {{width, height}, scale < 0, words.end()};
}

Image<float> decode_pfm(std::string_view file, const Pool& pool) {
  if (file.empty()) throw Error("is empty, expected a PFM");
  const PfmHeader header = read_header(file);
  const auto row_bytes = static_cast<std::size_t>(header.size.width) * sizeof(float);
  const std::size_t expected = row_bytes * static_cast<std::size_t>(header.size.height);
  const std::size_t found = file.size() > header.bytes ? file.size() - header.bytes : 0;
  if (found != expected) {
    throw Error("has " + std::to_string(found) + " bytes of pixels, expected " + std::to_string(expected) +
                " for " + text(header.size) + (found < expected ? ": it is truncated" : ""));
  }
  const bool swapped = header.little_endian != (std::endian::native == std::endian::little);
  Image<float> disparity(header.size, pool);
  const char* from = file.data() + header.bytes;
  for (int y = header.size.height - 1; y >= 0; --y, from += row_bytes) {
    for (int x = 0; x < header.size.width; ++x) {
      std::uint32_t bits = 0;
      std::memcpy(&bits, from + static_cast<std::size_t>(x) * sizeof bits, sizeof bits);
      const auto value = std::bit_cast<float>(swapped ? __builtin_bswap32(bits) : bits);
      disparity(x, y) = std::isfinite(value) ? value : kHole;
    }
  }
  return disparity;
}

// ---- NPY ----

/// NumPy's header is a Python literal: {'descr': '<f4', 'fortran_order': False, 'shape': (480, 640), }.
std::string_view after(std::string_view header, std::string_view key) {
  const std::size_t at = header.find(key);
  if (at == std::string_view::npos) throw Error("is a damaged .npy: its header has no " + std::string(key));
  header.remove_prefix(at + key.size());
  header.remove_prefix(std::min(header.find_first_not_of(" :"), header.size()));
  return header;
}

Size shape_in(std::string_view header) {
  std::string_view shape = after(header, "'shape'");
  shape = shape.substr(0, std::min(shape.find(')'), shape.size() - 1) + 1);
  std::array<int, 2> sides{};
  std::string_view rest = shape;
  for (const auto& [begin, index] : {std::pair{"(", 0U}, std::pair{", ", 1U}}) {
    if (!rest.starts_with(begin)) break;
    rest.remove_prefix(std::string_view(begin).size());
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), sides[index]);
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
  }
  if (rest != ")") throw Error("has the shape " + excerpt(shape) + ", expected (height, width)");
  check_sides(sides[1], sides[0]);
  return {sides[1], sides[0]};
}

template <class T>
Image<float> values_of(std::string_view bytes, Size size, const Pool& pool) {
  const std::size_t expected = static_cast<std::size_t>(size.area()) * sizeof(T);
  if (bytes.size() != expected) {
    throw Error("has " + std::to_string(bytes.size()) + " bytes of pixels, expected " +
                std::to_string(expected) + " for " + text(size));
  }
  Image<float> disparity(size, pool);
  const char* from = bytes.data();
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x, from += sizeof(T)) {
      T value{};
      std::memcpy(&value, from, sizeof value);
      disparity(x, y) = std::isfinite(static_cast<double>(value)) ? static_cast<float>(value) : kHole;
    }
  }
  return disparity;
}

/// `integer_unit`: of values of 16 bits, for depth.
Image<float> decode_npy(std::string_view file, const Pool& pool, std::optional<float> integer_unit = {}) {
  constexpr std::string_view kMagic = "\x93NUMPY";
  const auto byte = [&](std::size_t at) {
    return static_cast<std::size_t>(static_cast<unsigned char>(file[at]));
  };
  if (!file.starts_with(kMagic) || file.size() < 12)
    throw Error("is not a .npy: it does not begin with \\x93NUMPY");
  const bool is_first_version = byte(6) == 1;
  const std::size_t begin = is_first_version ? 10 : 12;
  const std::size_t length =
      byte(8) + (byte(9) << 8) + (is_first_version ? 0 : (byte(10) << 16) + (byte(11) << 24));
  if (file.size() - begin < length) throw Error("is a truncated .npy: its header is cut off");
  const std::string_view header = file.substr(begin, length);
  const std::string_view pixels = file.substr(begin + length);
  if (!after(header, "'fortran_order'").starts_with("False"))
    throw Error("is in Fortran order, expected row-major order (numpy.ascontiguousarray)");
  const Size size = shape_in(header);
  const std::string_view type = after(header, "'descr'").substr(0, 5);
  if (type == "'<f4'") return values_of<float>(pixels, size, pool);
  if (type == "'<f8'") return values_of<double>(pixels, size, pool);
  if (integer_unit && type == "'<u2'") {
    Image<float> values = values_of<std::uint16_t>(pixels, size, pool);
    for (int y = 0; y < size.height; ++y)
      std::for_each(values.row(y), values.row(y) + size.width, [&](float& v) { v /= *integer_unit; });
    return values;
  }
  throw Error("contains values of type " + excerpt(type) + ", expected '<f4' or '<f8' (float32, float64)" +
              (integer_unit ? ", or '<u2' (uint16)" : ""));
}

template <class Decode>
Image<float> load_floats(const fs::path& path, const Pool& pool, std::size_t pixel_bytes,
                         const Decode& decode) {
  constexpr std::size_t kMaxHeader = std::size_t{1} << 16;
  const std::string file = read_file(path, static_cast<std::size_t>(kMaxPixels) * pixel_bytes + kMaxHeader);
  try {
    return decode(file, pool);
  } catch (const Error& error) {
    throw Error(path.string() + ": " + error.what());
  }
}

std::string encode_pfm(View<const float> disparity_px) {
  std::string file = "Pf\n" + std::to_string(disparity_px.width()) + " " +
                     std::to_string(disparity_px.height()) + "\n-1.0\n";
  file.reserve(file.size() + static_cast<std::size_t>(disparity_px.size().area()) * sizeof(float));
  for (int y = disparity_px.height() - 1; y >= 0; --y) {
    for (int x = 0; x < disparity_px.width(); ++x) {
      const float value = disparity_px(x, y);
      auto bits =
          std::bit_cast<std::uint32_t>(std::isfinite(value) ? value : std::numeric_limits<float>::infinity());
      for (int byte = 0; byte < 4; ++byte, bits >>= 8) file += static_cast<char>(bits & 0xFFU);
    }
  }
  return file;
}

}  // namespace

Image<float> load_disparity(const fs::path& path, const Pool& pool) {
  const Form form = form_of(path, false);
  if (form == Form::png) return load_png(path, pool);
  if (form == Form::npy) {
    return load_floats(path, pool, sizeof(double),
                       [](std::string_view file, const Pool& of) { return decode_npy(file, of); });
  }
  return load_floats(path, pool, sizeof(float), decode_pfm);
}

Image<float> load_depth(const fs::path& path, double units_per_m, const Pool& pool) {
  const auto unit = static_cast<float>(units_per_m);
  Image<float> depth_m;
  switch (form_of(path, false)) {
    case Form::png: {
      const Labels values = load_labels(path);
      if (values.bits != 16) throw Error(path.string() + ": has 8 bits, expected the 16 of a depth image");
      depth_m = divided(values.ids, unit, pool);
      break;
    }
    case Form::pfm:
      depth_m = load_floats(path, pool, sizeof(float), decode_pfm);
      break;
    case Form::npy:
      depth_m = load_floats(path, pool, sizeof(double), [&](std::string_view file, const Pool& of) {
        return decode_npy(file, of, unit);
      });
  }
  for (int y = 0; y < depth_m.height(); ++y) {
    std::replace_if(
        depth_m.row(y), depth_m.row(y) + depth_m.width(), [](float z) { return !(z > 0); }, kHole);
  }
  return depth_m;
}

Image<float> load_values(const GivenMap& map, const Pool& pool) {
  return map.depth_units_per_m ? load_depth(map.path, *map.depth_units_per_m, pool)
                               : load_disparity(map.path, pool);
}

Image<float> load_given(const GivenMap& map, Size image, const std::optional<StereoRig>& rig,
                        const Pool& pool) {
  if (map.depth_units_per_m && !rig) {
    throw Error(
        map.path.string() +
        ": is a depth image, which needs the focal length: expected a calibration with fx, cx and cy");
  }
  Image<float> values = load_values(map, pool);
  if (values.size() != image) {
    throw Error(map.path.string() + ": the " + (map.depth_units_per_m ? "depth image" : "disparity map") +
                " is " + text(values.size()) + ", the left image is " + text(image));
  }
  return map.depth_units_per_m ? disparity_of_depth(values, *rig, pool) : std::move(values);
}

void save_disparity(const fs::path& path, View<const float> disparity_px) {
  if (disparity_px.empty()) throw Error(path.string() + ": cannot be written: the disparity map is empty");
  if (form_of(path, true) == Form::png) return save_as_png(path, disparity_px);
  write_file(path, encode_pfm(disparity_px));
}

bool png_can_hold(View<const float> disparity_px) {
  for (int y = 0; y < disparity_px.height(); ++y) {
    const float* row = disparity_px.row(y);
    if (!std::all_of(row, row + disparity_px.width(), [](float d) { return encoded(d).has_value(); }))
      return false;
  }
  return true;
}

}  // namespace cairn::io
