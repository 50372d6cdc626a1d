// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <bit>
#include <cairn/core/error.hpp>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstring>
#include <io/atomic_file.hpp>
#include <io/disparity_files.hpp>
#include <io/image_files.hpp>
#include <io/raster.hpp>
#include <io/read_file.hpp>
#include <limits>
#include <optional>
#include <string>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;
constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

enum class Form : std::uint8_t { png, pfm };

Form form_of(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".png") return Form::png;
  if (extension == ".pfm") return Form::pfm;
  throw Error(path.string() + ": has the extension '" + extension +
              "', expected .png (16 bits) or .pfm for a disparity map");
}

// ---- PNG ----

/// d · 256 to the nearest; 0 is the hole, so that a true 0 becomes 1. Nothing where 16 bits do not hold it.
std::optional<std::uint16_t> encoded(float disparity_px) {
  if (!std::isfinite(disparity_px)) return std::uint16_t{0};
  const double value = std::nearbyint(double{disparity_px} * 256.0);
  if (disparity_px < 0 || value > 65535) return std::nullopt;
  return static_cast<std::uint16_t>(std::max(value, 1.0));
}

Image<float> load_png(const fs::path& path, const Pool& pool) {
  const Labels values = load_labels(path);
  if (values.bits != 16) {
    throw Error(path.string() +
                ": has 8 bits, expected the 16 of a disparity map (disparity * 256, 0 = hole)");
  }
  Image<float> disparity(values.ids.size(), pool);
  for (int y = 0; y < disparity.height(); ++y) {
    const std::uint16_t* from = values.ids.row(y);
    std::transform(from, from + disparity.width(), disparity.row(y),
                   [](std::uint16_t v) { return v == 0 ? kHole : static_cast<float>(v) / 256.0F; });
  }
  return disparity;
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
  std::size_t bytes = 0;  // of the header itself
};

/// The header is three lines: "Pf", width and height, scale; its sign tells the byte order, its amount means
/// nothing here.
class HeaderWords {
 public:
  explicit HeaderWords(std::string_view file) : file_(file) {}

  std::string_view next() {
    while (at_ < file_.size() && std::isspace(static_cast<unsigned char>(file_[at_])) != 0) ++at_;
    const std::size_t begin = at_;
    while (at_ < file_.size() && std::isspace(static_cast<unsigned char>(file_[at_])) == 0) ++at_;
    return file_.substr(begin, at_ - begin);
  }
  /// A number, whole: nothing may follow it in its word.
  template <class T>
  T number(const char* what) {
    const std::string_view word = next();
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size()) {
      throw Error(std::string("is a truncated or damaged PFM: its ") + what + " is no number");
    }
    return value;
  }
  /// Where the pixels begin: one white space after the last word.
  [[nodiscard]] std::size_t end() const { return at_ + 1; }

 private:
  std::string_view file_;
  std::size_t at_ = 0;
};

PfmHeader read_header(std::string_view file) {
  HeaderWords words(file.substr(0, 256));
  const std::string_view kind = words.next();
  if (kind == "PF") throw Error("is a PFM in colour, expected one channel ('Pf')");
  if (kind != "Pf") throw Error("is no PFM: it does not begin with 'Pf'");
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

Image<float> load_pfm(const fs::path& path, const Pool& pool) {
  const std::string file = read_file(path, static_cast<std::size_t>(kMostPixels) * sizeof(float) + 256);
  try {
    return decode_pfm(file, pool);
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
  return form_of(path) == Form::png ? load_png(path, pool) : load_pfm(path, pool);
}

void save_disparity(const fs::path& path, View<const float> disparity_px) {
  if (disparity_px.empty()) throw Error(path.string() + ": cannot be written: the disparity map is empty");
  if (form_of(path) == Form::png) return save_as_png(path, disparity_px);
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
