// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "reference/object_hints.hpp"

#include <algorithm>
#include <cmath>

namespace cairn::reference {
namespace {

/// Channels at positions; 0 outside.
struct Volume {
  Size size;
  int channels = 0;
  std::vector<std::int64_t> values;

  Volume(Size of, int deep) : size(of), channels(deep), values(slot(of.width * of.height * deep)) {}
  [[nodiscard]] std::size_t place(int x, int y, int c) const {
    return slot((c * size.height + y) * size.width + x);
  }
  [[nodiscard]] std::int64_t at(int x, int y, int c) const {
    const bool inside = x >= 0 && y >= 0 && x < size.width && y < size.height;
    return inside ? values[place(x, y, c)] : 0;
  }
};

template <class Value>
Volume filled(Size size, int channels, Value value) {
  Volume volume(size, channels);
  for (int c = 0; c < channels; ++c) {
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) volume.values[volume.place(x, y, c)] = value(x, y, c);
    }
  }
  return volume;
}

class Reading {
 public:
  explicit Reading(const HintNumbers& numbers) : numbers_(numbers) {}

  /// Applies the next layer to `in`.
  Volume operator()(const Volume& in) {
    const HintLayer l = numbers_.layers.at(layer_++);
    const int reach = l.side / 2;
    const Volume out = filled(
        {(in.size.width - 1) / l.stride + 1, (in.size.height - 1) / l.stride + 1}, l.outputs,
        [&](int x, int y, int o) {
          std::int64_t sum = numbers_.bias.at(outputs_ + slot(o));
          for (int v = 0; v < l.side; ++v) {
            for (int u = 0; u < l.side; ++u) {
              for (int i = 0; i < l.inputs; ++i) {
                const std::int64_t weight =
                    numbers_.weights.at(weights_ + slot(((v * l.side + u) * l.inputs + i) * l.outputs + o));
                sum += weight * in.at(x * l.stride + u - reach, y * l.stride + v - reach, i);
              }
            }
          }
          const float value = static_cast<float>(sum) * numbers_.scale.at(outputs_ + slot(o));
          return std::clamp<std::int64_t>(std::llrint(value), l.least, 8191);
        });
    weights_ += l.weights();
    outputs_ += slot(l.outputs);
    return out;
  }

 private:
  const HintNumbers& numbers_;
  std::size_t layer_ = 0;
  std::size_t weights_ = 0;
  std::size_t outputs_ = 0;
};

/// Upsamples `small` by two (nearest) and adds `like`.
Volume doubled_and_added(const Volume& small, const Volume& like) {
  return filled(like.size, like.channels, [&](int x, int y, int c) {
    return std::min<std::int64_t>(small.at(x / 2, y / 2, c) + like.at(x, y, c), 8191);
  });
}

}  // namespace

Image<ObjectHint> hint_objects(View<const std::int16_t> input, const HintNumbers& numbers) {
  const Size cells{input.width() / kHintChannels - 2, input.height() - 2};
  Reading next(numbers);
  const Volume half = next(next(filled(
      cells, kHintChannels, [&](int x, int y, int c) { return input((x + 1) * kHintChannels + c, y + 1); })));
  const Volume quarter = next(next(half));
  const Volume eighth = next(next(next(quarter)));
  Volume up = next(next(next(eighth)));
  for (const Volume* like : {&eighth, &quarter, &half}) up = next(doubled_and_added(next(up), *like));
  const Volume told = next(up);
  Image<ObjectHint> hints(cells);
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x) {
      const auto say = [&](int what, int least, int most) {
        const std::int64_t value = told.at(x / 2, y / 2, 4 * what + 2 * (y % 2) + x % 2);
        return static_cast<std::int16_t>(std::clamp<std::int64_t>(value, least, most));
      };
      hints(x, y) = {say(0, -96, 96), say(1, -96, 96), say(2, -2000, 2000), say(3, -2000, 2000),
                     say(4, 0, 320)};
    }
  }
  return hints;
}

}  // namespace cairn::reference
