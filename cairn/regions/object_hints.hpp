// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/core/exec.hpp>
#include <cairn/core/ids.hpp>
#include <cairn/core/image.hpp>
#include <cairn/regions/region_cues.hpp>
#include <cstdint>
#include <memory>
#include <span>

/// Estimates of a small convolutional network for the cells of the image, used as cues for grouping
/// (docs/stages/object_hints.md, beyond the paper).
namespace cairn {

namespace kernels {
struct Convolution;
}

/// The estimates for one cell, a block of pixels.
struct ObjectHint {
  std::int16_t object = 0;   // log-odds that the cell shows an object, in 1/16, −96 … 96
  std::int16_t outline = 0;  // log-odds that the outline of an object passes, likewise
  std::int16_t to_x = 0;     // from the cell to the centroid of its object's visible part, in 1/8 cell
  std::int16_t to_y = 0;
  std::int16_t size = 0;  // log₂ of the number of cells of that part, in 1/16
  friend bool operator==(const ObjectHint&, const ObjectHint&) = default;
};

/// Cells of four pixels, but about 160×120 of them at least and 240×180 at most, in the image's proportions, multiples of
/// 8 in both directions.
Size hint_cells(Size image);

/// The number of input channels of a cell: brightness, colour, disparity, distance from ground and background,
/// edges … and how some of them differ from the cells around (docs/stages/object_hints.md lists them).
inline constexpr int kHintChannels = 16;
/// The input of the network: hint_cells() with a frame of zeros, interleaved channels in 1/64. `edges`:
/// superpixel_edges(). `cues.hints` is not used.
Image<std::int16_t> hint_input(View<const std::uint16_t> edges, const Cues& cues, const Exec& exec);

/// The shape of one layer.
struct HintLayer {
  int inputs = 0, outputs = 0;
  int side = 3, stride = 1;  // of the window; pixels from one output to the next
  int least = 0;             // output: 0 for a rectifier
  [[nodiscard]] constexpr std::size_t weights() const { return slot(side * side * inputs * outputs); }
};
inline constexpr std::size_t kHintLayers = 21;

/// The fitted weights, in the order in which the kernels read them.
class HintNetwork {
 public:
  /// `weights`: per layer [row][column][input][output]; `bias` and `scale`: per layer [output]. Copied.
  /// Throws Error for a layer with more outputs than the kernels compute. Precondition: `layers` has kHintLayers
  /// entries, which the sizes match; only the last one has a negative `least`.
  HintNetwork(std::span<const HintLayer> layers, std::span<const std::int8_t> weights,
              std::span<const std::int32_t> bias, std::span<const float> scale);
  HintNetwork(HintNetwork&&) noexcept;
  HintNetwork& operator=(HintNetwork&&) noexcept;
  HintNetwork(const HintNetwork&) = delete;
  HintNetwork& operator=(const HintNetwork&) = delete;
  ~HintNetwork();
  /// Private to the library.
  [[nodiscard]] const kernels::Convolution& layer(std::size_t i) const;

 private:
  struct Numbers;
  std::unique_ptr<Numbers> numbers_;
};

/// The network of a file of lab/fitted_files.py, see cairn/fitted. Throws Error for another kind of file, or if its layers
/// are not those of the library.
HintNetwork load_network(std::span<const std::byte> file);
/// The network of the library, fitted by lab/fit_hints.py.
const HintNetwork& hint_network();

/// One hint for each of hint_cells(), from hint_input(). An encoder halves the resolution five times; a decoder
/// doubles it again and adds the encoder's activations of the same resolution (Ronneberger et al. 2015,
/// "U-Net"). All sums are integers.
Image<ObjectHint> hint_objects(Image<std::int16_t> input, const HintNetwork& network, const Exec& exec);
/// The same with the library's network.
Image<ObjectHint> hint_objects(View<const std::uint16_t> edges, const Cues& cues, const Exec& exec);

}  // namespace cairn
