// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "reference/object_hints.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cairn/core/ids.hpp>
#include <cairn/core/target.hpp>
#include <cairn/regions/convolution_kernels.hpp>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "support/grids.hpp"
#include "support/region_scene.hpp"

namespace cairn {
namespace {

using grids::random_image;
using reference::HintNumbers;

/// Numbers of outputs that exercise all vector paths. Few weights are large, so that outputs neither vanish
/// nor all saturate.
HintNumbers random_numbers(std::uint32_t seed, int least_channels = 8, int most_channels = 48) {
  std::mt19937 random(seed);
  const auto from = [&random](int least, int most) {
    return least + static_cast<int>(random() % static_cast<unsigned>(most - least + 1));
  };
  const auto channels = [&] { return 8 * from(least_channels / 8, most_channels / 8); };
  const int half = channels();
  const int quarter = channels();
  const int eighth = channels();
  const int sixteenth = channels();
  const int a = channels();
  const int b = channels();
  HintNumbers numbers;
  numbers.layers = {{kHintChannels, a, 3, 2, 0},
                    {a, half, 3, 1, 0},
                    {half, b, 3, 2, 0},
                    {b, quarter, 3, 1, 0},
                    {quarter, a, 3, 2, 0},
                    {a, b, 3, 1, 0},
                    {b, eighth, 3, 1, 0},
                    {eighth, a, 3, 2, 0},
                    {a, b, 3, 1, 0},
                    {b, sixteenth, 3, 1, 0},
                    {sixteenth, b, 3, 2, 0},
                    {b, a, 3, 1, 0},
                    {a, b, 3, 1, 0},
                    {b, sixteenth, 1, 1, 0},
                    {sixteenth, eighth, 1, 1, 0},
                    {eighth, b, 3, 1, 0},
                    {b, quarter, 1, 1, 0},
                    {quarter, a, 3, 1, 0},
                    {a, half, 1, 1, 0},
                    {half, b, 3, 1, 0},
                    {b, 24, 1, 1, -4096}};
  for (const HintLayer& l : numbers.layers) {
    const int inputs = l.side * l.side * l.inputs;
    for (int i = 0; i < inputs * l.outputs; ++i)
      numbers.weights.push_back(static_cast<std::int8_t>(from(0, 9) == 0 ? from(-127, 127) : from(-20, 20)));
    for (int o = 0; o < l.outputs; ++o) {
      numbers.bias.push_back(from(-100000, 100000));
      const float likely = 0.03F / std::sqrt(static_cast<float>(inputs));  // keeps the variance
      numbers.scale.push_back(static_cast<float>(from(50, 150)) * 0.01F * likely *
                              (l.least < 0 ? 0.2F : 1.0F));
    }
  }
  return numbers;
}

/// Padded with zeros.
Image<std::int16_t> random_input(Size cells, std::uint32_t seed) {
  Image<std::int16_t> input =
      random_image<std::int16_t>({(cells.width + 2) * kHintChannels, cells.height + 2}, -256, 256, seed);
  for (int y = 0; y < input.height(); ++y) {
    for (int x = 0; x < input.width(); ++x) {
      const int column = x / kHintChannels;
      const bool inside = column > 0 && column <= cells.width && y > 0 && y <= cells.height;
      if (!inside) input(x, y) = 0;
    }
  }
  return input;
}

Exec on(Target target) {
  Exec exec;
  exec.target = target;
  return exec;
}

int count_of_values(View<const ObjectHint> hints) {
  std::vector<int> seen;
  for (int y = 0; y < hints.height(); ++y) {
    for (int x = 0; x < hints.width(); ++x) seen.push_back(hints(x, y).object);
  }
  std::sort(seen.begin(), seen.end());
  return static_cast<int>(std::unique(seen.begin(), seen.end()) - seen.begin());
}

void expect_equal(const Image<ObjectHint>& found, const Image<ObjectHint>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (int y = 0; y < found.height(); ++y) {
    for (int x = 0; x < found.width(); ++x) ASSERT_EQ(found(x, y), expected(x, y)) << x << ", " << y;
  }
}

/// Noise everywhere, with holes. Disparities and planes are such that no sum of theirs is rounded.
support::RegionScene random_scene(Size size, std::uint32_t seed) {
  std::mt19937 random(seed);
  support::RegionScene scene(Image<RegionId>(size, RegionId{0}, {}));
  scene.gray = random_image<Gray>(size, 0, 255, seed);
  scene.superpixels.edges = random_image<std::uint16_t>(size, 0, 400, seed + 1);
  const bool has_colour = seed % 2 == 0;
  if (has_colour) scene.rgb = Image<Rgb>(size, Rgb{}, {});
  const Image<std::uint8_t> known = random_image<std::uint8_t>(size, 0, 9, seed + 2);
  const Image<int> nearness = random_image<int>(size, -80, 900, seed + 3);  // of blocks, so that cells differ
  scene.for_each_pixel([&](int x, int y, std::size_t) {
    const auto byte = [&] { return static_cast<std::uint8_t>(random() % 256); };
    if (has_colour) scene.rgb(x, y) = {byte(), byte(), byte()};
    const bool in_hole = known(x / 7, y / 5) == 0 || known(x, y) == 0;
    if (in_hole) return;
    const auto steps = static_cast<float>(nearness(x / 9, y / 6) + static_cast<int>(random() % 40));
    scene.disparity_px(x, y) = steps / 16;
    if (known(x, y) % 3 == 0) scene.textured_px(x, y) = steps / 16;
  });
  if (seed % 3 != 0) scene.ground.plane = GroundPlane{0.03125F, 0.25F, -7.5F};
  if (seed % 3 != 1) scene.background.planes = {{-0.0625F, 0, 9}, {0.03125F, 0.125F, -2.25F}};
  return scene;
}

TEST(HintInput, EqualsItsDefinitionOnEveryTarget) {
  std::uint32_t seed = 1;
  for (const Size size :
       {Size{320, 240}, {97, 61}, {200, 31}, {643, 120}, {40, 300}, {3, 200}, {200, 3}, {1, 1}}) {
    for (int i = 0; i < 3; ++i, ++seed) {
      SCOPED_TRACE(seed);
      const support::RegionScene scene = random_scene(size, seed);
      const Cues cues = scene.cues();
      const Image<std::int16_t> expected = reference::hint_input(scene.superpixels.edges, cues);
      for (const Target target : supported_targets()) {
        SCOPED_TRACE(name(target));
        EXPECT_EQ(grids::numbers(hint_input(scene.superpixels.edges, cues, on(target))),
                  grids::numbers(expected));
      }
      for (const int threads : {2, 3}) {
        EXPECT_EQ(grids::numbers(hint_input(scene.superpixels.edges, cues, Exec::with_threads(threads))),
                  grids::numbers(expected));
      }
    }
  }
}

TEST(HintObjects, EqualTheirDefinitionOnEveryTarget) {
  for (const Size cells : {Size{8, 8}, {16, 8}, {24, 40}, {56, 24}}) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
      const HintNumbers numbers = random_numbers(seed);
      const Image<std::int16_t> input = random_input(cells, seed);
      const Image<ObjectHint> expected = reference::hint_objects(input, numbers);
      EXPECT_GT(count_of_values(expected), 5) << "says something";
      const HintNetwork network = numbers.network();
      for (const Target target : supported_targets()) {
        SCOPED_TRACE(name(target));
        expect_equal(hint_objects(input.clone(), network, on(target)), expected);
      }
      for (const int threads : {2, 3})
        expect_equal(hint_objects(input.clone(), network, Exec::with_threads(threads)), expected);
    }
  }
}

TEST(HintObjects, OfAWideNetworkEqualTheirDefinitionOnEveryTarget) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const HintNumbers numbers = random_numbers(seed, 40, kernels::kMaxOutputs);
    const Image<std::int16_t> input = random_input({24, 16}, seed);
    const Image<ObjectHint> expected = reference::hint_objects(input, numbers);
    EXPECT_GT(count_of_values(expected), 5) << "says something";
    for (const Target target : supported_targets()) {
      SCOPED_TRACE(name(target));
      expect_equal(hint_objects(input.clone(), numbers.network(), on(target)), expected);
    }
  }
}

/// What all kernels make of rows of `width` pixels with numbers from `least` to kMaxActivation.
std::vector<std::int16_t> outputs_of(const kernels::ConvolutionKernels& run, const kernels::Convolution& by,
                                     int width, int least) {
  const auto random = [&](int pixels, int channels, int rows) {
    return random_image<std::int16_t>({pixels * channels, rows}, least, kernels::kMaxActivation, 7);
  };
  const Image<std::int16_t> in = random(by.stride * width + 2, by.inputs, 4);
  const std::array rows{in.row(0), in.row(1), in.row(2), in.row(3)};
  const std::size_t count = slot(width * by.outputs);
  std::vector<std::int16_t> out(5 * count);
  run.convolve(rows.data(), by, width, out.data());
  if (by.transformed_weights != nullptr) {
    const std::array both{out.data() + count, out.data() + 2 * count};
    run.convolve_two(rows.data(), by, width, both.data());
    const std::array<std::int16_t*, 2> one{out.data() + 3 * count, nullptr};
    run.convolve_two(rows.data(), by, width, one.data());
  }
  if (least >= 0) {
    const Image<std::int16_t> small = random((width + 1) / 2, by.outputs, 1);
    const Image<std::int16_t> like = random(width, by.outputs, 2);
    run.add_doubled(small.row(0), like.row(1), by.outputs, width, out.data() + 4 * count);
  }
  return out;
}

/// hint_objects() takes the kernels with VNNI where there are any, so the test of each target does not see the others.
class ConvolutionKernels : public ::testing::TestWithParam<std::pair<Target, bool>> {
 protected:
  void SetUp() override {
    const auto [target, with_vnni] = GetParam();
    run_ = with_vnni ? kernels::vnni_convolution_kernels(target) : kernels::convolution_kernels(target);
    if (run_ == nullptr) GTEST_SKIP() << "this processor has no VNNI with such vectors";
  }
  const kernels::ConvolutionKernels* run_ = nullptr;
};

TEST_P(ConvolutionKernels, EqualThoseWithoutVectors) {
  const kernels::ConvolutionKernels& plain = *kernels::convolution_kernels(Target::scalar);
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const HintNetwork network = random_numbers(seed, 8, kernels::kMaxOutputs).network();
    for (std::size_t i = 0; i < kHintLayers; ++i) {
      for (const int width : {1, 2, 9, 10, 11, 37}) {
        for (const int least : {-256, 0}) {
          EXPECT_EQ(outputs_of(*run_, network.layer(i), width, least),
                    outputs_of(plain, network.layer(i), width, least));
        }
      }
    }
  }
}

TEST_P(ConvolutionKernels, DoNotOverflowWithTheLargestSums) {
  HintNumbers numbers = random_numbers(6, kernels::kMaxOutputs, kernels::kMaxOutputs);
  std::fill(numbers.weights.begin(), numbers.weights.end(), std::int8_t{127});
  std::fill(numbers.scale.begin(), numbers.scale.end(), 5e-6F);  // outputs below the limit
  const HintNetwork network = numbers.network();
  for (std::size_t i = 0; i < kHintLayers; ++i) {
    const auto expected = outputs_of(*kernels::convolution_kernels(Target::scalar), network.layer(i), 11,
                                     kernels::kMaxActivation);
    EXPECT_LT(*std::max_element(expected.begin(), expected.begin() + 11), kernels::kMaxActivation);
    EXPECT_EQ(outputs_of(*run_, network.layer(i), 11, kernels::kMaxActivation), expected);
  }
}

std::vector<std::pair<Target, bool>> all_convolution_kernels() {
  std::vector<std::pair<Target, bool>> all;
  for (const Target target : supported_targets()) {
    all.emplace_back(target, false);
    if (target == Target::avx2 || target == Target::avx512) all.emplace_back(target, true);
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Targets, ConvolutionKernels, ::testing::ValuesIn(all_convolution_kernels()),
                         [](const auto& of) {
                           return std::string(name(of.param.first)) + (of.param.second ? "_vnni" : "");
                         });

TEST(VnniKernels, AreTakenWhereTheProcessorHasThem) {
  // Older kernels of Linux do not list avx_vnni, so what is not listed may be there.
  std::ifstream file("/proc/cpuinfo");
  const std::string features{std::istreambuf_iterator<char>(file), {}};
  for (const Target target : supported_targets()) {
    SCOPED_TRACE(name(target));
    const auto has = [&](const char* feature) { return features.find(feature) != std::string::npos; };
    const kernels::ConvolutionKernels* const vnni = kernels::vnni_convolution_kernels(target);
    if ((target == Target::avx2 && has(" avx_vnni")) || (target == Target::avx512 && has(" avx512_vnni"))) {
      EXPECT_NE(vnni, nullptr);
    }
    EXPECT_EQ(&kernels::convolution_kernels(on(target)),
              vnni != nullptr ? vnni : kernels::convolution_kernels(target));
  }
}

TEST(HintObjects, DoNotOverflowWithTheLargestInputs) {
  HintNumbers numbers = random_numbers(5);
  for (std::int8_t& weight : numbers.weights) weight = weight < 0 ? -127 : 127;
  for (float& scale : numbers.scale) scale = 1;
  const Image<std::int16_t> input = random_input({24, 16}, 5);
  const Image<ObjectHint> expected = reference::hint_objects(input, numbers);
  for (const Target target : supported_targets())
    expect_equal(hint_objects(input.clone(), numbers.network(), on(target)), expected);
}

TEST(HintObjects, DoNotOverflowWithTheLargestSums) {
  for (const int channels : {48, kernels::kMaxOutputs}) {
    SCOPED_TRACE(channels);
    HintNumbers numbers = random_numbers(6, channels, channels);
    std::fill(numbers.weights.begin(), numbers.weights.end(), std::int8_t{127});
    std::fill(numbers.scale.begin(), numbers.scale.end(), 1.0F);
    std::fill(numbers.scale.end() - 24, numbers.scale.end(), 1e-6F);  // estimates that are not all limited
    const Image<std::int16_t> input = random_input({32, 32}, 6);
    const Image<ObjectHint> expected = reference::hint_objects(input, numbers);
    for (const Target target : supported_targets())
      expect_equal(hint_objects(input.clone(), numbers.network(), on(target)), expected);
  }
}

}  // namespace
}  // namespace cairn
