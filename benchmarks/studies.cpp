// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Three studies on pairs with measured or exact truth, suggested by the claims of the paper:
//   studies operators DATA     robustness of each correlation operator to noise, gain and offset (Middlebury)
//   studies reflections DATA   effect and cost of the ground check on floors of increasing gloss
//   studies confidence DATA    agreement of stated and measured confidence of disparities
// DATA is the folder with real/ and rendered/.
#include <algorithm>
#include <array>
#include <cairn/cairn.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <io/calibration_files.hpp>
#include <io/dataset.hpp>
#include <io/disparity_files.hpp>
#include <io/image_files.hpp>
#include <random>
#include <sstream>
#include <string>
#include <string_view>

#include "confidence_study.hpp"

namespace {

using namespace cairn;
namespace fs = std::filesystem;

Gray clipped(double value) {
  return static_cast<Gray>(std::clamp(std::lround(value), 0L, 255L));
}

Image<Gray> with_gain(View<const Gray> image, double gain, double offset) {
  Image<Gray> result(image.size());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) result(x, y) = clipped(gain * image(x, y) + offset);
  }
  return result;
}

Image<Gray> with_noise(View<const Gray> image, double sigma, unsigned seed) {
  std::mt19937 bits(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  Image<Gray> result(image.size());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) result(x, y) = clipped(image(x, y) + sigma * noise(bits));
  }
  return result;
}

/// Pixels to exclude: hidden from the right camera.
Image<std::uint8_t> hidden(const fs::path& occlusion, Size size) {
  Image<std::uint8_t> result(size, 0, {});
  if (occlusion.empty() || !fs::exists(occlusion)) return result;
  const io::Labels labels = io::load_labels(occlusion);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) result(x, y) = labels.ids(x, y) == 255 ? 255 : 0;
  }
  return result;
}

struct Scene {
  std::string name;
  io::PicturePair pair;
  Image<float> truth_px;
  Image<std::uint8_t> hidden;
  int num_disparities;
};

Scene load_scene(const fs::path& folder) {
  Scene scene{folder.filename().string(),
              io::load_pair(folder / "left.png", folder / "right.png"),
              io::load_disparity(folder / "disp_left.png"),
              {},
              64};
  scene.hidden = hidden(folder / "occlusion.png", scene.truth_px.size());
  scene.num_disparities = io::load_calibration(folder / "calib.txt").num_disparities.value_or(64);
  return scene;
}

struct Condition {
  const char* name;
  double gain;
  double offset;
  double sigma;
};

void print_errors(const Scene& scene, const Condition& condition, const Exec& exec) {
  const Image<Gray> lit = with_gain(scene.pair.right.gray, condition.gain, condition.offset);
  const Image<Gray> left = with_noise(scene.pair.left.gray, condition.sigma, 1);
  const Image<Gray> right = with_noise(lit, condition.sigma, 2);
  std::printf("| %s | %s |", scene.name.c_str(), condition.name);
  for (const auto& cost : kCosts) {
    Config config = Config::paper();
    config.match.cost = cost.value;
    config.match.num_disparities = scene.num_disparities;
    config.ground.source = GroundSource::off;  // the scenes have no floor
    const auto found = estimate_disparity(StereoPair::from(left, right), std::nullopt, config, exec);
    const DisparityErrors errors =
        disparity_errors(found.disparity.disparity_px, scene.truth_px, scene.hidden, 0);
    std::printf(" %.1f / %.1f / %.0f |", 100 * errors.bad_of_matched(1), 100 * errors.bad_of_matched(2),
                100 * errors.density());
  }
  std::printf("\n");
  std::fflush(stdout);
}

void operators(const fs::path& data, const Exec& exec) {
  std::printf(
      "bad-1 of matched / bad-2 of matched / density, %%; preset paper, ground off, pixels that both cameras "
      "see\n\n");
  std::printf("| pair | right image |");
  for (const auto& cost : kCosts) std::printf(" %s |", std::string(cost.name).c_str());
  std::printf("\n|---|---|");
  for (std::size_t i = 0; i < kCosts.size(); ++i) std::printf("---:|");
  std::printf("\n");
  constexpr std::array kConditions{Condition{"unchanged", 1, 0, 0},
                                   Condition{"gain 1.25, offset 12", 1.25, 12, 0},
                                   Condition{"both: noise 4", 1, 0, 4}, Condition{"both: noise 8", 1, 0, 8}};
  for (const char* name : {"middlebury2003/cones", "middlebury2003/teddy", "middlebury2001/tsukuba"}) {
    const Scene scene = load_scene(data / "real" / name);
    for (const Condition& condition : kConditions) print_errors(scene, condition, exec);
  }
}

GroundPlane true_ground(const fs::path& file) {
  std::ifstream in(file);
  GroundPlane plane;
  for (std::string line; std::getline(in, line);) {  // the last line with only three numbers
    std::istringstream numbers(line);
    GroundPlane read;
    std::string more;
    if (numbers >> read.a >> read.b >> read.c && !(numbers >> more)) plane = read;
  }
  return plane;
}

struct Reflections {
  std::int64_t wrong_below = 0;    // wrong matches below the true floor
  std::int64_t wrong_removed = 0;  // of these, removed by the check
  std::int64_t right = 0;          // right matches in the whole image
  std::int64_t right_removed = 0;
  bool ground = false;
};

Reflections count(const SceneDisparity& unchecked, const SceneDisparity& checked, View<const float> truth_px,
                  const GroundPlane& floor, float margin) {
  Reflections sum;
  sum.ground = checked.ground.plane.has_value();
  for (int y = 0; y < truth_px.height(); ++y) {
    for (int x = 0; x < truth_px.width(); ++x) {
      const float d = unchecked.disparity.disparity_px(x, y);
      if (std::isnan(d) || std::isnan(truth_px(x, y))) continue;
      const bool removed = has(checked.disparity.reject(x, y), Reject::below_ground);
      const float on_floor = floor.disparity_px(static_cast<float>(x), static_cast<float>(y));
      if (std::abs(d - truth_px(x, y)) <= 1) {
        ++sum.right;
        sum.right_removed += removed ? 1 : 0;
      } else if (on_floor > 0 && d < on_floor - margin) {
        ++sum.wrong_below;
        sum.wrong_removed += removed ? 1 : 0;
      }
    }
  }
  return sum;
}

void reflections(const fs::path& data, const Exec& exec) {
  std::printf(
      "preset paper; wrong = more than 1 px off, below = under the true floor by more than "
      "ground.margin\n\n");
  std::printf(
      "| scene | floor reflectivity | wrong matches below the floor | removed | right matches | lost | "
      "ground |\n");
  std::printf("|---|---:|---:|---:|---:|---:|---|\n");
  for (const char* scene : {"base0", "base1", "base2"}) {
    const fs::path folder = data / "rendered" / "stress" / scene;
    const Image<float> truth_px = io::load_disparity(folder / "gt" / "disp_left.png");
    const GroundPlane floor = true_ground(folder / "gt" / "ground.txt");
    const io::Calibration calibration = io::load_calibration(folder / "gt" / "calib.txt");
    for (const char* gloss : {"0.0", "0.3", "0.6"}) {
      const fs::path frame = folder / (std::string("floor_") + gloss);
      const io::PicturePair pair = io::load_pair(frame / "left.png", frame / "right.png");
      Config config = Config::paper();
      config.match.num_disparities = calibration.num_disparities.value_or(64);
      const StereoPair views = StereoPair::from(pair.left.gray, pair.right.gray);
      const auto checked = estimate_disparity(views, calibration.rig, config, exec);
      config.ground.source = GroundSource::off;
      const auto unchecked = estimate_disparity(views, calibration.rig, config, exec);
      const Reflections sum = count(unchecked, checked, truth_px, floor, config.ground.margin);
      std::printf("| %s | %s | %lld | %lld (%.0f %%) | %lld | %lld (%.2f %%) | %s |\n", scene, gloss,
                  static_cast<long long>(sum.wrong_below), static_cast<long long>(sum.wrong_removed),
                  100.0 * static_cast<double>(sum.wrong_removed) /
                      static_cast<double>(std::max<std::int64_t>(1, sum.wrong_below)),
                  static_cast<long long>(sum.right), static_cast<long long>(sum.right_removed),
                  100.0 * static_cast<double>(sum.right_removed) /
                      static_cast<double>(std::max<std::int64_t>(1, sum.right)),
                  sum.ground ? "found" : "refused");
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string_view study = argc == 3 ? argv[1] : "";
    const Exec exec = Exec::with_threads(0);
    if (study == "operators") {
      operators(argv[2], exec);
    } else if (study == "reflections") {
      reflections(argv[2], exec);
    } else if (study == "confidence") {
      confidence_study(argv[2], exec);
    } else {
      std::fprintf(stderr, "usage: studies operators|reflections|confidence DATA\n");
      return 2;
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "studies: %s\n", error.what());
    return 1;
  }
}
