// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "object_hints.hpp"

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
          return std::clamp<std::int64_t>(std::llrint(value), l.least, 4096);
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
    return std::min<std::int64_t>(small.at(x / 2, y / 2, c) + like.at(x, y, c), 4096);
  });
}

/// The pixels of cell c of n along an axis of w pixels.
std::vector<int> pixels_of(int c, int n, int w) {
  std::vector<int> pixels;
  for (int x = 0; x < w; ++x) {
    if (x * n / w == c) pixels.push_back(x);
  }
  if (pixels.empty()) pixels.push_back(c * w / n);
  return pixels;
}

/// The mean of the known values.
struct Mean {
  double sum = 0;
  int count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
  void add(bool value) { add(value ? 1.0 : 0.0); }
  [[nodiscard]] double value() const { return count > 0 ? sum / count : 0; }
};

struct Cell {
  Mean brightness, squares, blue, red, disparity, matched, above_ground, before_background, ground, edge,
      textured;
};

Cell cell_of(View<const std::uint16_t> edges, const Cues& cues, Size cells, int column, int row) {
  const Size size = edges.size();
  Cell cell;
  for (const int y : pixels_of(row, cells.height, size.height)) {
    for (const int x : pixels_of(column, cells.width, size.width)) {
      const auto fx = static_cast<float>(x);
      const auto fy = static_cast<float>(y);
      const auto [brightness, blue, red] = colour_at(cues, x, y);
      cell.brightness.add(double{1} * brightness);
      cell.squares.add(double{1} * brightness * brightness);
      cell.blue.add(double{1} * blue);
      cell.red.add(double{1} * red);
      cell.edge.add(double{1} * edges(x, y));
      cell.textured.add(!std::isnan(cues.textured_px(x, y)));
      const double ground =
          cues.ground.plane ? std::max(0.0F, cues.ground.plane->disparity_px(fx, fy)) : 0.0F;
      cell.ground.add(ground);
      const double d = cues.disparity_px(x, y);
      cell.matched.add(!std::isnan(d));
      if (std::isnan(d)) continue;
      cell.disparity.add(d);
      cell.before_background.add(d - cues.background.disparity_px(fx, fy));
      if (ground > 0) cell.above_ground.add(d - ground);
    }
  }
  return cell;
}

/// Channels 12 to 15 of a cell, from the others of the cells around it.
void tell_surroundings(Image<std::int16_t>& input, Size cells, int x, int y) {
  const auto at = [&](int column, int row, int channel) -> std::int16_t& {
    return input((column + 1) * kHintChannels + channel, row + 1);
  };
  std::array<Mean, 3> of_channel;
  std::array<Mean, 3> squares;
  Mean disparity;
  for (int v = std::max(0, y - 8); v <= std::min(cells.height - 1, y + 8); ++v) {
    for (int u = std::max(0, x - 8); u <= std::min(cells.width - 1, x + 8); ++u) {
      for (int c = 0; c < 3; ++c) {
        const double value = at(u, v, c);
        of_channel.at(slot(c)).add(value);
        squares.at(slot(c)).add(value * value);
      }
      if (at(u, v, 4) > 0) disparity.add(double{1} * at(u, v, 3));
    }
  }
  const auto tell = [&](int channel, double value) {
    at(x, y, channel) = static_cast<std::int16_t>(std::floor(std::clamp(value, -4.0, 4.0) * 64 + 0.5));
  };
  for (int c = 0; c < 3; ++c) {
    const Mean& mean = of_channel.at(slot(c));
    // Times the number of cells: whole numbers under the root.
    const double n = mean.count;
    const double spread = std::sqrt(n * squares.at(slot(c)).sum - mean.sum * mean.sum);
    tell(12 + c, (n * at(x, y, c) - mean.sum) / (spread + n * (c == 0 ? 5 : 10)));
  }
  const double n = disparity.count;
  tell(15, at(x, y, 4) > 0 ? (n * at(x, y, 3) - disparity.sum) / (8 * n) : 0);
}

}  // namespace

Image<std::int16_t> hint_input(View<const std::uint16_t> edges, const Cues& cues) {
  const Size size = hint_cells(edges.size());
  Image<Cell> cells(size);
  std::vector<double> disparities;
  Mean brightness;
  Mean squares;
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const Cell cell = cell_of(edges, cues, size, x, y);
      cells(x, y) = cell;
      brightness = {brightness.sum + cell.brightness.sum, brightness.count + cell.brightness.count};
      squares = {squares.sum + cell.squares.sum, squares.count + cell.squares.count};
      if (cell.disparity.count > 0) disparities.push_back(cell.disparity.value());
    }
  }
  std::sort(disparities.begin(), disparities.end());
  const double nearest = disparities.empty() ? 1 : std::max(1.0, disparities[disparities.size() * 98 / 100]);
  const double mean = brightness.value();
  const double spread = std::sqrt(std::max(0.0, squares.value() - mean * mean)) + 8;
  Image<std::int16_t> input({(size.width + 2) * kHintChannels, size.height + 2}, std::int16_t{0}, {});
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      int channel = (x + 1) * kHintChannels;
      const auto tell = [&](double value, double least, double most) {
        input(channel++, y + 1) =
            static_cast<std::int16_t>(std::floor(std::clamp(value, least, most) * 64 + 0.5));
      };
      const Cell& cell = cells(x, y);
      tell((cell.brightness.value() - mean) / spread, -4, 4);
      tell(cell.blue.value() / 32, -4, 4);
      tell(cell.red.value() / 32, -4, 4);
      tell(cell.disparity.value() / nearest, 0, 2);
      tell(cell.matched.value(), 0, 1);
      tell(cell.above_ground.value() / 4, -1, 3);
      tell(cues.background.planes.empty() ? 0 : cell.before_background.value() / 4, -1, 3);
      tell(cell.ground.value() / nearest, 0, 2);
      tell(cell.edge.value() / 4 / (2 * (double{cues.left.noise_sigma} + 2)), 0, 4);
      tell(cell.textured.value(), 0, 1);
      tell(2.0 * y / size.height - 1, -1, 1);
      tell(cues.left.rgb.empty() ? 0 : 1, 0, 1);
    }
  }
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) tell_surroundings(input, size, x, y);
  }
  return input;
}

Image<ObjectHint> hint_objects(View<const std::int16_t> input, const HintNumbers& numbers) {
  const Size cells{input.width() / kHintChannels - 2, input.height() - 2};
  Reading next(numbers);
  const Volume half = next(next(filled(
      cells, kHintChannels, [&](int x, int y, int c) { return input((x + 1) * kHintChannels + c, y + 1); })));
  const Volume quarter = next(next(half));
  const Volume eighth = next(next(next(quarter)));
  const Volume sixteenth = next(next(next(eighth)));
  Volume up = next(next(next(sixteenth)));
  up = doubled_and_added(next(up), sixteenth);
  for (const Volume* like : {&eighth, &quarter, &half}) up = next(doubled_and_added(next(up), *like));
  const Volume outputs = next(up);
  Image<ObjectHint> hints(cells);
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x) {
      const auto say = [&](int what, int least, int most) {
        const std::int64_t value = outputs.at(x / 2, y / 2, 4 * what + 2 * (y % 2) + x % 2);
        return static_cast<std::int16_t>(std::clamp<std::int64_t>(value, least, most));
      };
      hints(x, y) = {say(0, -96, 96), say(1, -96, 96), say(2, -2000, 2000), say(3, -2000, 2000),
                     say(4, 0, 320)};
    }
  }
  return hints;
}

}  // namespace cairn::reference
