// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/parallel.hpp>
#include <cairn/image/sparse_points.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace cairn::sparse {

std::array<float, 4> cubic(float t) {
  constexpr float kSlope = -0.75F;
  const float s = 1 - t;
  const float before = kSlope * t * s * s;
  const float after = ((kSlope + 2) * s - (kSlope + 3)) * s * s + 1;
  const float last = kSlope * t * t * s;
  return {before, 1 - before - after - last, after, last};
}

namespace {

constexpr int kPatch = 3;  // blocks; the best point of each kPatch × kPatch blocks is kept
constexpr float kMinTexture = 24.0F * kWindowArea;  // squared differences over 2 px, least direction
constexpr float kMaxResidual = 0.5F;                // squared residual of a match, relative to the texture
constexpr int kRefinements = 2;
constexpr float kFurthest = 1.5F;  // px; total move of a refinement in each direction

/// Column sums of four rows with the weights 1 3 3 1, with the first and last column replicated.
void sum_columns(const std::array<const Gray*, 4>& rows, int width, std::int16_t* sums) {
  const Gray* r0 = rows[0];
  const Gray* r1 = rows[1];
  const Gray* r2 = rows[2];
  const Gray* r3 = rows[3];
  for (int x = 0; x < width; ++x) {
    sums[x + 1] = static_cast<std::int16_t>(r0[x] + r3[x] + 3 * (r1[x] + r2[x]));
  }
  sums[0] = sums[1];
  sums[width + 1] = sums[width];
}

void sum_pairs(const std::int16_t* sums, int width, Gray* out) {
  for (int x = 0; x < width; ++x) {
    const int sum = sums[2 * x] + sums[2 * x + 3] + 3 * (sums[2 * x + 1] + sums[2 * x + 2]);
    out[x] = static_cast<Gray>((sum + 32) >> 6);
  }
}

}  // namespace

Image<Gray> halved(View<const Gray> image, const Exec& exec) {
  const Size size{image.width() / 2, image.height() / 2};
  Image<Gray> half(size, exec.pool);
  parallel_for(exec, size.height, 32, [&](int first, int last) {
    std::vector<std::int16_t> columns(static_cast<std::size_t>(2 * size.width + 2));
    for (int y = first; y < last; ++y) {
      std::array<const Gray*, 4> rows{};
      for (int k = 0; k < 4; ++k) {
        rows[static_cast<std::size_t>(k)] = image.row(std::clamp(2 * y + k - 1, 0, image.height() - 1));
      }
      sum_columns(rows, 2 * size.width, columns.data());
      sum_pairs(columns.data(), size.width, half.row(y));
    }
  });
  return half;
}

namespace {

/// The structure tensor of a block.
struct Tensor {
  int xx = 0;
  int xy = 0;
  int yy = 0;
  Tensor& operator+=(const Tensor& other) {
    xx += other.xx;
    xy += other.xy;
    yy += other.yy;
    return *this;
  }
  /// The lesser eigenvalue: texture in the weakest direction.
  [[nodiscard]] float least() const {
    const float mean = 0.5F * (static_cast<float>(xx) + static_cast<float>(yy));
    const float half_difference = 0.5F * (static_cast<float>(xx) - static_cast<float>(yy));
    const auto mixed = static_cast<float>(xy);
    return mean - std::sqrt(half_difference * half_difference + mixed * mixed);
  }
};

/// The tensor of each block. The outermost pixels have no gradient and belong to no block.
Image<Tensor> block_tensors(View<const Gray> image, const Exec& exec) {
  const Size blocks{std::max(0, (image.width() - 2) / kBlock), std::max(0, (image.height() - 2) / kBlock)};
  Image<Tensor> tensors(blocks, Tensor{}, exec.pool);
  parallel_for(exec, blocks.height, 8, [&](int first, int last) {
    for (int y = first * kBlock; y < last * kBlock; ++y) {
      const Gray* above = image.row(y);
      const Gray* here = image.row(y + 1);
      const Gray* below = image.row(y + 2);
      Tensor* out = tensors.row(y / kBlock);
      for (int x = 0; x < blocks.width * kBlock; ++x) {
        const int along = here[x + 2] - here[x];
        const int down = below[x + 1] - above[x + 1];
        out[x / kBlock] += Tensor{along * along, along * down, down * down};
      }
    }
  });
  return tensors;
}

/// At most `most` points, spread evenly over the list.
std::vector<Point> thinned(const std::vector<Point>& points, std::size_t most) {
  if (points.size() <= most) return points;
  std::vector<Point> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(points[i * points.size() / most]);
  return some;
}

}  // namespace

std::vector<Point> textured_points(View<const Gray> image, std::size_t most, const Exec& exec) {
  const Image<Tensor> tensors = block_tensors(image, exec);
  std::vector<Point> points;
  const auto best_of_patch = [&](int i0, int j0) {
    std::optional<Point> best;
    float best_texture = kMinTexture;
    for (int j = j0; j < std::min(j0 + kPatch, tensors.height() - 1); ++j) {
      for (int i = i0; i < std::min(i0 + kPatch, tensors.width() - 1); ++i) {
        Tensor window = tensors(i, j);
        window += tensors(i + 1, j);
        window += tensors(i, j + 1);
        window += tensors(i + 1, j + 1);
        if (const float texture = window.least(); texture > best_texture) {
          best_texture = texture;
          best = Point{1 + i * kBlock, 1 + j * kBlock};
        }
      }
    }
    return best;
  };
  for (int j = 0; j < tensors.height() - 1; j += kPatch) {
    for (int i = 0; i < tensors.width() - 1; i += kPatch) {
      if (const auto best = best_of_patch(i, j)) points.push_back(*best);
    }
  }
  return thinned(points, most);
}

namespace {

using Window = std::array<float, kWindowArea>;

/// Adds column by column, so the order of additions is that of vector code.
float sum_of_products(const Window& a, const Window& b) {
  std::array<float, kWindow> columns{};
  for (std::size_t k = 0; k < kWindowArea; k += kWindow) {
    for (std::size_t i = 0; i < kWindow; ++i) columns[i] += a[k + i] * b[k + i];
  }
  float sum = 0;
  for (const float column : columns) sum += column;
  return sum;
}

void remove_mean(Window& values) {
  std::array<float, kWindow> columns{};
  for (std::size_t k = 0; k < kWindowArea; k += kWindow) {
    for (std::size_t i = 0; i < kWindow; ++i) columns[i] += values[k + i];
  }
  float sum = 0;
  for (const float column : columns) sum += column;
  const float mean = sum / kWindowArea;
  for (float& v : values) v -= mean;
}

/// The window of a left point, with its gradients and their products.
struct Template {
  Window grey{};
  Window along{};
  Window down{};
  float xx = 0;
  float xy = 0;
  float yy = 0;
  float energy = 0;  // of the window without its mean
};

Template template_at(View<const Gray> image, Point p) {
  Template t;
  for (int y = 0; y < kWindow; ++y) {
    const Gray* above = image.row(p.y + y - 1) + p.x;
    const Gray* here = image.row(p.y + y) + p.x;
    const Gray* below = image.row(p.y + y + 1) + p.x;
    for (int x = 0; x < kWindow; ++x) {
      const auto k = static_cast<std::size_t>(y * kWindow + x);
      t.grey[k] = here[x];
      t.along[k] = 0.5F * static_cast<float>(here[x + 1] - here[x - 1]);
      t.down[k] = 0.5F * static_cast<float>(below[x] - above[x]);
    }
  }
  remove_mean(t.grey);
  remove_mean(t.along);  // makes the step independent of brightness
  remove_mean(t.down);
  t.xx = sum_of_products(t.along, t.along);
  t.xy = sum_of_products(t.along, t.down);
  t.yy = sum_of_products(t.down, t.down);
  t.energy = sum_of_products(t.grey, t.grey);
  return t;
}

/// The window at a subpixel place; nullopt outside the image. Vertically by cubic interpolation: linear
/// interpolation is biased towards half rows.
std::optional<Window> window_at(View<const Gray> image, Place place) {
  const int x = static_cast<int>(std::floor(place.x));
  const int y = static_cast<int>(std::floor(place.y));
  if (x < 0 || y < 1 || x + kWindow >= image.width() || y + kWindow + 1 >= image.height())
    return std::nullopt;
  const float u = place.x - static_cast<float>(x);
  const std::array<float, 4> w = cubic(place.y - static_cast<float>(y));
  Window values{};
  for (int j = 0; j < kWindow; ++j) {
    const Gray* r0 = image.row(y + j - 1) + x;
    const Gray* r1 = image.row(y + j) + x;
    const Gray* r2 = image.row(y + j + 1) + x;
    const Gray* r3 = image.row(y + j + 2) + x;
    std::array<float, kWindow + 1> row{};
    for (std::size_t i = 0; i < row.size(); ++i) {
      row[i] = w[0] * static_cast<float>(r0[i]) + w[1] * static_cast<float>(r1[i]) +
               w[2] * static_cast<float>(r2[i]) + w[3] * static_cast<float>(r3[i]);
    }
    float* out = values.data() + j * kWindow;
    for (std::size_t i = 0; i < kWindow; ++i) out[i] = row[i] + u * (row[i + 1] - row[i]);
  }
  remove_mean(values);
  return values;
}

}  // namespace

std::optional<Place> refine(View<const Gray> left, Point p, View<const Gray> right, Place start) {
  const Template t = template_at(left, p);
  const float determinant = t.xx * t.yy - t.xy * t.xy;
  Place place = start;
  float residual = 0;
  for (int i = 0; i < kRefinements; ++i) {
    auto error = window_at(right, place);
    if (!error || !(determinant > 0)) return std::nullopt;
    for (std::size_t k = 0; k < kWindowArea; ++k) (*error)[k] -= t.grey[k];
    const float along = sum_of_products(t.along, *error);
    const float down = sum_of_products(t.down, *error);
    residual = sum_of_products(*error, *error);
    place.x -= (t.yy * along - t.xy * down) / determinant;
    place.y -= (t.xx * down - t.xy * along) / determinant;
    const bool near = std::abs(place.x - start.x) <= kFurthest && std::abs(place.y - start.y) <= kFurthest;
    if (!near) return std::nullopt;
  }
  if (residual > kMaxResidual * t.energy) return std::nullopt;
  return place;
}

}  // namespace cairn::sparse
