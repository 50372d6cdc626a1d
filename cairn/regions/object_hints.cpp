// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/ids.hpp>
#include <cairn/core/parallel.hpp>
#include <cairn/core/scratch.hpp>
#include <cairn/fitted/fitted.hpp>
#include <cairn/regions/convolution_kernels.hpp>
#include <cairn/regions/framed_image.hpp>
#include <cairn/regions/object_hints.hpp>
#include <string>
#include <vector>

namespace cairn {
namespace {

constexpr int kGrain = 4;           // rows
constexpr int kMaxLogOdds = 96;     // 1/16
constexpr int kMaxDistance = 2000;  // 1/8 cell
constexpr int kLargest = 320;       // 1/16 of log₂

// ---- the network

/// The output of a layer: interleaved channels, with a frame of zeros.
struct Activations {
  Image<std::int16_t> framed;
  Size size;
  int channels = 0;
  [[nodiscard]] const std::int16_t* row(int y) const { return framed.row(y + 1) + channels; }
  [[nodiscard]] std::int16_t* row(int y) { return framed.row(y + 1) + channels; }
};

Activations framed_activations(Size size, int channels, const Pool& pool) {
  return {framed_image(size, channels, pool), size, channels};
}

Activations convolved(const Activations& in, const kernels::Convolution& by,
                      const kernels::ConvolutionKernels& run, const Exec& exec) {
  const Size size{(in.size.width + by.stride - 1) / by.stride, (in.size.height + by.stride - 1) / by.stride};
  Activations out = framed_activations(size, by.outputs, exec.pool);
  if (by.transformed_weights != nullptr) {
    parallel_for(exec, (size.height + 1) / 2, kGrain / 2, [&](int first, int last) {
      for (int y = 2 * first; y < 2 * last; y += 2) {
        // With an odd number of rows, the last has no partner.
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
Activations doubled_and_added(const Activations& small, const Activations& like,
                              const kernels::ConvolutionKernels& run, const Exec& exec) {
  Activations out = framed_activations(like.size, like.channels, exec.pool);
  parallel_for(exec, like.size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y)
      run.add_doubled(small.row(y / 2), like.row(y), like.channels, like.size.width, out.row(y));
  });
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
  kEncode32a,
  kEncode32b,
  kEncode32c,
  kDecode16,
  kDecode8a,
  kDecode8b,
  kDecode4a,
  kDecode4b,
  kDecode2a,
  kDecode2b,
  kOutput
};

/// Whether convolve_two() computes the layer.
bool is_transformed(const HintLayer& l) {
  return l.side == 3 && l.stride == 1 && l.inputs % 8 == 0 && l.inputs <= kernels::kMaxTiledInputs;
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

struct HintNetwork::Numbers {
  Scratch<std::int16_t> weights;  // interleaved pairs of inputs
  Scratch<std::int16_t> transformed_weights;
  std::vector<std::int32_t> bias;
  std::vector<float> scale;
  std::array<kernels::Convolution, kHintLayers> layers{};
};

HintNetwork::HintNetwork(std::span<const HintLayer> layers, std::span<const std::int8_t> weights,
                         std::span<const std::int32_t> bias, std::span<const float> scale)
    : numbers_(new Numbers{.weights{weights.size(), Pool()},
                           .transformed_weights{count_of_transformed(layers), Pool()},
                           .bias{bias.begin(), bias.end()},
                           .scale{scale.begin(), scale.end()}}) {
  for (const HintLayer& l : layers) {
    if (l.outputs > kernels::kMaxOutputs) {
      throw Error("a layer of the network has " + std::to_string(l.outputs) + " outputs, at most " +
                  std::to_string(kernels::kMaxOutputs) + " are computed");
    }
  }
  Numbers& own = *numbers_;
  std::size_t weight = 0;
  std::size_t output = 0;
  std::size_t transformed = 0;
  for (std::size_t i = 0; i < own.layers.size(); ++i) {
    const HintLayer& l = layers[i];
    for (int k = 0; k < l.side * l.side * l.inputs; ++k) {
      for (int o = 0; o < l.outputs; ++o) {
        // NOLINTNEXTLINE(bugprone-signed-char-misuse): a number, not a character
        const auto number = static_cast<std::int16_t>(weights[weight + slot(k * l.outputs + o)]);
        own.weights.data()[weight + slot((k / 2 * l.outputs + o) * 2 + k % 2)] = number;
      }
    }
    own.layers[i] = {l.inputs,          l.outputs,         l.side,
                     l.stride,          l.least,           own.weights.data() + weight,
                     &own.bias[output], &own.scale[output]};
    if (is_transformed(l)) {
      own.layers[i].transformed_weights = own.transformed_weights.data() + transformed;
      transform_weights(l, weights.subspan(weight), own.transformed_weights.data() + transformed);
      transformed += slot(kernels::kPlaces * l.inputs * l.outputs);
    }
    weight += l.weights();
    output += slot(l.outputs);
  }
}

HintNetwork::HintNetwork(HintNetwork&&) noexcept = default;
HintNetwork& HintNetwork::operator=(HintNetwork&&) noexcept = default;
HintNetwork::~HintNetwork() = default;

const kernels::Convolution& HintNetwork::layer(std::size_t i) const {
  return numbers_->layers.at(i);
}

HintNetwork load_network(std::span<const std::byte> file) {
  fitted::Reader reader(file, "net ");
  const auto numbers = reader.next<std::int32_t>();
  std::vector<HintLayer> layers;
  std::size_t count = 0;
  std::size_t outputs = 0;
  for (std::size_t i = 0; i + 5 <= numbers.size(); i += 5) {
    layers.push_back({numbers[i], numbers[i + 1], numbers[i + 2], numbers[i + 3], numbers[i + 4]});
    count += layers.back().weights();
    outputs += slot(layers.back().outputs);
  }
  const auto weights = reader.next<std::int8_t>();
  const auto bias = reader.next<std::int32_t>();
  const auto scale = reader.next<float>();
  if (layers.size() != kHintLayers || weights.size() != count || bias.size() != outputs ||
      scale.size() != outputs)
    throw Error("the fitted network has other layers than the library");
  return {layers, weights, bias, scale};
}

const HintNetwork& hint_network() {
  static const HintNetwork network = load_network(fitted::hints());
  return network;
}

Image<ObjectHint> hint_objects(Image<std::int16_t> input, const HintNetwork& network, const Exec& exec) {
  const kernels::ConvolutionKernels& run = kernels::convolution_kernels(exec);
  const auto layer = [&](Layer which, const Activations& in) {
    return convolved(in, network.layer(which), run, exec);
  };
  const auto joined = [&](Layer which, const Activations& small, const Activations& like) {
    return doubled_and_added(layer(which, small), like, run, exec);
  };
  const Size cells{input.width() / kHintChannels - 2, input.height() - 2};
  const Activations in{std::move(input), cells, kHintChannels};
  const Activations half = layer(kEncode2b, layer(kEncode2a, in));
  const Activations quarter = layer(kEncode4b, layer(kEncode4a, half));
  const Activations eighth = layer(kEncode8c, layer(kEncode8b, layer(kEncode8a, quarter)));
  const Activations sixteenth = layer(kEncode16c, layer(kEncode16b, layer(kEncode16a, eighth)));
  Activations up = layer(kEncode32c, layer(kEncode32b, layer(kEncode32a, sixteenth)));
  up = joined(kDecode16, up, sixteenth);
  up = layer(kDecode8b, joined(kDecode8a, up, eighth));
  up = layer(kDecode4b, joined(kDecode4a, up, quarter));
  up = layer(kDecode2b, joined(kDecode2a, up, half));
  const Activations output = layer(kOutput, up);
  // Each output pixel holds four neighbouring cells.
  Image<ObjectHint> hints(cells, exec.pool);
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x) {
      const std::int16_t* const t = output.row(y / 2) + x / 2 * output.channels + y % 2 * 2 + x % 2;
      hints(x, y) = {limited(t[0], -kMaxLogOdds, kMaxLogOdds), limited(t[4], -kMaxLogOdds, kMaxLogOdds),
                     limited(t[8], -kMaxDistance, kMaxDistance), limited(t[12], -kMaxDistance, kMaxDistance),
                     limited(t[16], 0, kLargest)};
    }
  }
  return hints;
}

Image<ObjectHint> hint_objects(View<const std::uint16_t> edges, const Cues& cues, const Exec& exec) {
  return hint_objects(hint_input(edges, cues, exec), hint_network(), exec);
}

}  // namespace cairn
