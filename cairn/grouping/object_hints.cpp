// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/ids.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/grouping/object_hints.hpp>
#include <cairn/grouping/surfaces_behind.hpp>
#include <cmath>
#include <vector>

namespace cairn {
namespace {

#include <cairn/grouping/fitted_hints.inc>

constexpr std::size_t count_of_weights() {
  std::size_t count = 0;
  for (const HintLayer& l : kFittedLayers) count += l.weights();
  return count;
}
static_assert(kFittedLayers.size() == kHintLayers && kFittedWeights.size() == count_of_weights());

constexpr int kGrain = 4;      // rows
constexpr double kUnit = 64;   // steps of the input for each 1
constexpr int kLeastSide = 8;  // cells
constexpr double kCells = 160.0 * 120;
constexpr int kMostLogOdds = 96;  // 1/16
constexpr int kFarthest = 2000;   // 1/8 cell
constexpr int kLargest = 320;     // 1/16 of log₂

// ---- the input

/// Sums over the pixels of a cell.
struct CellSums {
  int pixels = 0, matched = 0, textured = 0, above_ground = 0;
  std::array<int, 3> colour{};
  std::int64_t edges = 0, squares = 0;  // squares: of brightness
  double disparity = 0, ground = 0, height = 0, before_background = 0;
};

struct Brightness {
  double mean = 0;
  double spread = 0;
};

Brightness brightness_in(View<const CellSums> cells) {
  std::int64_t sum = 0;
  std::int64_t squares = 0;
  std::int64_t pixels = 0;
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x) {
      sum += cells(x, y).colour[0];
      squares += cells(x, y).squares;
      pixels += cells(x, y).pixels;
    }
  }
  const auto n = static_cast<double>(pixels);
  const double mean = static_cast<double>(sum) / n;
  return {mean, std::sqrt(std::max(0.0, static_cast<double>(squares) / n - mean * mean)) + 8};
}

/// Pixels first … last − 1 along one axis: those with pixel · cells / pixels = cell; where there are fewer
/// pixels than cells, the one at the cell's place.
struct Run {
  int first = 0, last = 0;
};
Run pixels_of(int cell, int cells, int pixels) {
  const Run run{(cell * pixels + cells - 1) / cells, ((cell + 1) * pixels + cells - 1) / cells};
  const int at = cell * pixels / cells;
  return run.first < run.last ? run : Run{at, at + 1};
}

/// The pixels of row y in a run of columns.
void add_run(View<const std::uint16_t> edges_in, const Cues& cues, const SurfacesBehind& behind, Run run,
             int y, CellSums& s) {
  const float* const disparity = cues.disparity_px.row(y);
  const float* const evidence = cues.evidence_px.row(y);
  const std::uint16_t* const edges = edges_in.row(y);
  s.pixels += run.last - run.first;
  for (int x = run.first; x < run.last; ++x) {
    const std::array<int, 3> colour = colour_at(cues, x, y);
    for (std::size_t i = 0; i < colour.size(); ++i) s.colour[i] += colour[i];
    s.squares += colour[0] * colour[0];
    s.edges += edges[x];
    s.textured += std::isnan(evidence[x]) ? 0 : 1;
    const double ground = behind.ground[slot(x)];
    s.ground += ground;
    if (std::isnan(disparity[x])) continue;
    const double d = disparity[x];
    ++s.matched;
    s.disparity += d;
    s.before_background += d - behind.background[slot(x)];
    if (ground <= 0) continue;
    ++s.above_ground;
    s.height += d - ground;
  }
}

Image<CellSums> sums_of(View<const std::uint16_t> edges, const Cues& cues, Size cells, const Exec& exec) {
  const Size image = cues.gray.size();
  std::vector<Run> columns;
  columns.reserve(slot(cells.width));
  for (int c = 0; c < cells.width; ++c) columns.push_back(pixels_of(c, cells.width, image.width));
  Image<CellSums> sums(cells, exec.pool);
  parallel_for(exec, cells.height, kGrain, [&](int first, int last) {
    SurfacesBehind behind(cues, image.width, exec);
    for (int row = first; row < last; ++row) {
      std::fill_n(sums.row(row), cells.width, CellSums{});
      const Run down = pixels_of(row, cells.height, image.height);
      for (int y = down.first; y < down.last; ++y) {
        behind.note(y);
        for (int c = 0; c < cells.width; ++c) add_run(edges, cues, behind, columns[slot(c)], y, sums(c, row));
      }
    }
  });
  return sums;
}

/// The disparity that 2 % of the cells exceed, at least 1 px.
double nearest_px(View<const CellSums> cells) {
  std::vector<double> means;
  means.reserve(slot(cells.width() * cells.height()));
  for (int y = 0; y < cells.height(); ++y) {
    for (int x = 0; x < cells.width(); ++x) {
      const CellSums& s = cells(x, y);
      if (s.matched > 0) means.push_back(s.disparity / s.matched);
    }
  }
  if (means.empty()) return 1;
  const auto at = means.begin() + static_cast<std::ptrdiff_t>(means.size() * 98 / 100);
  std::nth_element(means.begin(), at, means.end());
  return std::max(1.0, *at);
}

/// Writes the channels of a cell.
void describe(const CellSums& s, double height_in_image, const Brightness& brightness, double nearest,
              const Cues& cues, std::int16_t* out) {
  const double area = s.pixels;
  const auto put = [&out](double value, double least, double most) {
    // Rounded, halves up. Truncating what is positive is quicker than floor(), and as exact.
    constexpr int kPositive = 1024;
    *out++ = static_cast<std::int16_t>(
        static_cast<int>(std::clamp(value, least, most) * kUnit + (0.5 + kPositive)) - kPositive);
  };
  put((s.colour[0] / area - brightness.mean) / brightness.spread, -4, 4);
  put(s.colour[1] / area / 32, -4, 4);
  put(s.colour[2] / area / 32, -4, 4);
  put(s.matched > 0 ? s.disparity / s.matched / nearest : 0, 0, 2);
  put(s.matched / area, 0, 1);
  put(s.above_ground > 0 ? s.height / s.above_ground / 4 : 0, -1, 3);
  put(s.matched > 0 && !cues.background.planes.empty() ? s.before_background / s.matched / 4 : 0, -1, 3);
  put(s.ground / area / nearest, 0, 2);
  put(static_cast<double>(s.edges) / area / 8 / (double{cues.noise_sigma} + 2), 0, 4);
  put(s.textured / area, 0, 1);
  put(2 * height_in_image - 1, -1, 1);
  put(cues.rgb.empty() ? 0 : 1, 0, 1);
}

// ---- the network

/// The output of a layer: channels side by side in each pixel, with a frame of zeros.
struct Activations {
  Image<std::int16_t> framed;
  Size size;
  int channels = 0;
  [[nodiscard]] const std::int16_t* row(int y) const { return framed.row(y + 1) + channels; }
  [[nodiscard]] std::int16_t* row(int y) { return framed.row(y + 1) + channels; }
};

Image<std::int16_t> framed_image(Size size, int channels, const Pool& pool) {
  Image<std::int16_t> framed({(size.width + 2) * channels, size.height + 2}, pool);
  std::fill_n(framed.row(0), framed.width(), std::int16_t{0});
  std::fill_n(framed.row(size.height + 1), framed.width(), std::int16_t{0});
  for (int y = 1; y <= size.height; ++y) {
    std::fill_n(framed.row(y), channels, std::int16_t{0});
    std::fill_n(framed.row(y) + (size.width + 1) * channels, channels, std::int16_t{0});
  }
  return framed;
}

Activations framed_activations(Size size, int channels, const Pool& pool) {
  return {framed_image(size, channels, pool), size, channels};
}

Activations convolved(const Activations& in, const kernels::Convolution& by, const Exec& exec) {
  const Size size{(in.size.width + by.stride - 1) / by.stride, (in.size.height + by.stride - 1) / by.stride};
  Activations out = framed_activations(size, by.outputs, exec.pool);
  const kernels::ConvolutionKernels& run = kernels::convolution_kernels(exec);
  if (by.transformed_weights != nullptr) {
    parallel_for(exec, (size.height + 1) / 2, kGrain / 2, [&](int first, int last) {
      for (int y = 2 * first; y < 2 * last; y += 2) {
        // Of an odd number of rows, the last has no partner.
        const bool both = y + 1 < size.height;
        std::array<const std::int16_t*, 4> rows{};
        for (int r = 0; r < 4; ++r)
          rows.at(static_cast<std::size_t>(r)) = in.row(std::min(y + r - 1, size.height)) - in.channels;
        const std::array outs{out.row(y), both ? out.row(y + 1) : nullptr};
        run.convolve_two(rows.data(), by, size.width, outs.data());
      }
    });
    return out;
  }
  const int reach = by.side / 2;
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      std::array<const std::int16_t*, 3> rows{};
      for (int r = 0; r < by.side; ++r)
        rows.at(static_cast<std::size_t>(r)) = in.row(y * by.stride + r - reach) - reach * in.channels;
      run.convolve(rows.data(), by, size.width, out.row(y));
    }
  });
  return out;
}

/// `small` at twice its resolution, plus `like`.
Activations doubled_and_added(const Activations& small, const Activations& like, const Pool& pool) {
  Activations out = framed_activations(like.size, like.channels, pool);
  for (int y = 0; y < like.size.height; ++y) {
    const std::int16_t* const a = small.row(y / 2);
    const std::int16_t* const b = like.row(y);
    std::int16_t* const to = out.row(y);
    for (int x = 0; x < like.size.width; ++x) {
      for (int c = 0; c < like.channels; ++c) {
        const int at = x * like.channels + c;
        to[at] = static_cast<std::int16_t>(
            std::min(a[x / 2 * like.channels + c] + b[at], kernels::kGreatestActivation));
      }
    }
  }
  return out;
}

// ---- its layers, in the order of the weights

enum Layer : std::size_t {
  kEncode2a,
  kEncode2b,
  kEncode4a,
  kEncode4b,
  kEncode8a,
  kEncode8b,
  kEncode8c,
  kEncode16a,
  kEncode16b,
  kEncode16c,
  kDecode8a,
  kDecode8b,
  kDecode4a,
  kDecode4b,
  kDecode2a,
  kDecode2b,
  kTell
};

/// Whether convolve_two() computes the layer.
bool is_transformed(const HintLayer& l) {
  return l.side == 3 && l.stride == 1 && l.inputs % 8 == 0 && l.inputs <= kernels::kMostOutputs;
}

std::size_t count_of_transformed(std::span<const HintLayer> layers) {
  std::size_t count = 0;
  for (const HintLayer& l : layers)
    count += is_transformed(l) ? slot(kernels::kPlaces * l.inputs * l.outputs) : 0;
  return count;
}

/// The weights of a layer, times four, transformed as convolve_two() expects.
void transform_weights(const HintLayer& l, std::span<const std::int8_t> weights, std::int16_t* to) {
  const auto transformed = [](int a, int b, int c) { return std::array{2 * a, a + b + c, a - b + c, 2 * c}; };
  for (int i = 0; i < l.inputs; ++i) {
    for (int o = 0; o < l.outputs; ++o) {
      std::array<std::array<int, 4>, 3> across{};
      for (int r = 0; r < 3; ++r) {
        const auto at = [&](int c) {
          return int{weights[slot(((r * 3 + c) * l.inputs + i) * l.outputs + o)]};
        };
        across.at(slot(r)) = transformed(at(0), at(1), at(2));
      }
      for (int c = 0; c < 4; ++c) {
        const std::array down =
            transformed(across[0].at(slot(c)), across[1].at(slot(c)), across[2].at(slot(c)));
        for (int r = 0; r < 4; ++r) {
          to[slot((((r * 4 + c) * l.inputs + i) / 2 * l.outputs + o) * 2 + i % 2)] =
              static_cast<std::int16_t>(down.at(slot(r)));
        }
      }
    }
  }
}

std::int16_t limited(int value, int least, int most) {
  return static_cast<std::int16_t>(std::clamp(value, least, most));
}

}  // namespace

Size hint_cells(Size image) {
  const double ratio = static_cast<double>(image.width) / image.height;
  const double width = std::sqrt(kCells * ratio);
  const auto rounded = [](double cells) {
    constexpr double kMost = 1024;  // cells of a very long image
    return std::max(1, static_cast<int>(std::lround(std::min(cells, kMost) / kLeastSide))) * kLeastSide;
  };
  return {rounded(width), rounded(width / ratio)};
}

Image<std::int16_t> hint_input(View<const std::uint16_t> edges, const Cues& cues, const Exec& exec) {
  const Size cells = hint_cells(cues.gray.size());
  const Image<CellSums> sums = sums_of(edges, cues, cells, exec);
  const Brightness brightness = brightness_in(sums);
  const double nearest = nearest_px(sums);
  Image<std::int16_t> input = framed_image(cells, kHintChannels, exec.pool);
  for (int y = 0; y < cells.height; ++y) {
    std::int16_t* out = input.row(y + 1) + kHintChannels;
    for (int x = 0; x < cells.width; ++x, out += kHintChannels)
      describe(sums(x, y), static_cast<double>(y) / cells.height, brightness, nearest, cues, out);
  }
  return input;
}

HintNetwork::HintNetwork(std::span<const HintLayer> layers, std::span<const std::int8_t> weights,
                         std::span<const std::int32_t> bias, std::span<const float> scale)
    : weights_(weights.size(), Pool()),
      transformed_weights_(count_of_transformed(layers), Pool()),
      bias_(bias.begin(), bias.end()),
      scale_(scale.begin(), scale.end()) {
  std::size_t weight = 0;
  std::size_t output = 0;
  std::size_t transformed = 0;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const HintLayer& l = layers[i];
    for (int k = 0; k < l.side * l.side * l.inputs; ++k) {
      for (int o = 0; o < l.outputs; ++o) {
        // NOLINTNEXTLINE(bugprone-signed-char-misuse): a number, not a character
        const auto number = static_cast<std::int16_t>(weights[weight + slot(k * l.outputs + o)]);
        weights_.data()[weight + slot((k / 2 * l.outputs + o) * 2 + k % 2)] = number;
      }
    }
    layers_[i] = {l.inputs,       l.outputs,      l.side, l.stride, l.least, weights_.data() + weight,
                  &bias_[output], &scale_[output]};
    if (is_transformed(l)) {
      layers_[i].transformed_weights = transformed_weights_.data() + transformed;
      transform_weights(l, weights.subspan(weight), transformed_weights_.data() + transformed);
      transformed += slot(kernels::kPlaces * l.inputs * l.outputs);
    }
    weight += l.weights();
    output += slot(l.outputs);
  }
}

const HintNetwork& hint_network() {
  static const HintNetwork network(kFittedLayers, kFittedWeights, kFittedBias, kFittedScale);
  return network;
}

Image<ObjectHint> hint_objects(Image<std::int16_t> input, const HintNetwork& network, const Exec& exec) {
  const auto layer = [&](Layer which, const Activations& in) {
    return convolved(in, network.layer(which), exec);
  };
  const Size cells{input.width() / kHintChannels - 2, input.height() - 2};
  const Activations in{std::move(input), cells, kHintChannels};
  const Activations half = layer(kEncode2b, layer(kEncode2a, in));
  const Activations quarter = layer(kEncode4b, layer(kEncode4a, half));
  const Activations eighth = layer(kEncode8c, layer(kEncode8b, layer(kEncode8a, quarter)));
  Activations up = layer(kEncode16c, layer(kEncode16b, layer(kEncode16a, eighth)));
  up = layer(kDecode8b, doubled_and_added(layer(kDecode8a, up), eighth, exec.pool));
  up = layer(kDecode4b, doubled_and_added(layer(kDecode4a, up), quarter, exec.pool));
  up = layer(kDecode2b, doubled_and_added(layer(kDecode2a, up), half, exec.pool));
  const Activations told = layer(kTell, up);
  // Each output pixel holds four neighbouring cells.
  Image<ObjectHint> hints(cells, exec.pool);
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x) {
      const std::int16_t* const t = told.row(y / 2) + x / 2 * told.channels + y % 2 * 2 + x % 2;
      hints(x, y) = {limited(t[0], -kMostLogOdds, kMostLogOdds), limited(t[4], -kMostLogOdds, kMostLogOdds),
                     limited(t[8], -kFarthest, kFarthest), limited(t[12], -kFarthest, kFarthest),
                     limited(t[16], 0, kLargest)};
    }
  }
  return hints;
}

Image<ObjectHint> hint_objects(View<const std::uint16_t> edges, const Cues& cues, const Exec& exec) {
  return hint_objects(hint_input(edges, cues, exec), hint_network(), exec);
}

}  // namespace cairn
