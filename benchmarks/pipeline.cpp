// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// How long each stage takes on a pair: median and 99th percentile over many frames, frames per second, peak
// of the pool.
//   pipeline [--frames N] [--preset NAME] [--threads N] [FOLDER NUM_DISPARITIES]...
// Without FOLDER: a sample of 320x240 with 32 disparities, and the same picture doubled with 64. The doubled
// one has the work of a 640x480 picture for the matcher, but fewer regions than a real one: give a folder for
// figures to quote.
#include <algorithm>
#include <cairn/cairn.hpp>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <io/calibration_files.hpp>
#include <io/image_files.hpp>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace {

using namespace cairn;
using Clock = std::chrono::steady_clock;

struct Scene {
  std::string name;
  io::PicturePair pictures;
  std::optional<StereoRig> rig;
  int num_disparities = 64;
};

struct Settings {
  int frames = 50;
  std::string preset = "default";
  std::vector<int> threads;
  std::vector<std::pair<std::filesystem::path, int>> folders;
};

/// Milliseconds of every frame, per stage in the order of the first call.
struct Times {
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>, std::less<>> of_stage;
  std::vector<double> of_frame;
  std::int64_t pool_bytes = 0;
};

/// The smallest value that is at least as large as `share` of all.
double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  return values.at(std::min(rank, values.size() - 1));
}

template <class T>
Image<T> doubled(const Image<T>& image) {
  Image<T> twice({2 * image.width(), 2 * image.height()});
  for (int y = 0; y < twice.height(); ++y) {
    for (int x = 0; x < twice.width(); ++x) twice(x, y) = image(x / 2, y / 2);
  }
  return twice;
}

io::Picture doubled(const io::Picture& picture) {
  return {doubled(picture.gray), doubled(picture.rgb)};
}

Scene load(const std::filesystem::path& folder, int num_disparities) {
  std::optional<StereoRig> rig;
  if (exists(folder / "calib.txt")) rig = io::load_calibration(folder / "calib.txt").rig;
  return {folder.filename().string(), io::load_pair(folder / "left.png", folder / "right.png"), rig,
          num_disparities};
}

Scene doubled(const Scene& scene) {
  std::optional<StereoRig> rig = scene.rig;
  if (rig) {
    rig->focal_px *= 2;
    rig->cx_px = rig->cx_px * 2 + 0.5F;
    rig->cy_px = rig->cy_px * 2 + 0.5F;
    rig->doffs_px *= 2;
  }
  return {scene.name + ", doubled",
          {doubled(scene.pictures.left), doubled(scene.pictures.right)},
          rig,
          scene.num_disparities * 2};
}

Times measure_frames(const Scene& scene, const Settings& settings, int threads) {
  constexpr int kWarmUp = 3;  // frames that fill the pool and the caches
  Config config = Config::preset(settings.preset);
  config.match.num_disparities = scene.num_disparities;
  const auto pair =
      StereoPair::from(scene.pictures.left.gray, scene.pictures.right.gray, scene.pictures.left.rgb);

  Times times;
  bool warm = false;
  Exec exec = Exec::with_threads(threads);
  exec.observe = [&](std::string_view stage, const Artifact&, double milliseconds) {
    if (!warm) return;
    auto& values = times.of_stage[std::string(stage)];
    if (values.empty()) times.order.emplace_back(stage);
    values.push_back(milliseconds);
  };
  const Segmenter segmenter(config, scene.rig, exec);
  for (int i = 0; i < kWarmUp + settings.frames; ++i) {
    warm = i >= kWarmUp;
    const auto start = Clock::now();
    static_cast<void>(segmenter.segment(pair));
    const std::chrono::duration<double, std::milli> elapsed = Clock::now() - start;
    if (warm) times.of_frame.push_back(elapsed.count());
  }
  times.pool_bytes = segmenter.exec().pool.bytes();
  return times;
}

void print(const Scene& scene, const Settings& settings, int threads, const Times& times) {
  const double frame_ms = quantile(times.of_frame, 0.5);
  std::printf("\n%s, %s x %d disparities, preset %s, %d thread%s, %d frames\n", scene.name.c_str(),
              text(scene.pictures.left.gray.size()).c_str(), scene.num_disparities, settings.preset.c_str(),
              threads, threads == 1 ? "" : "s", settings.frames);
  std::printf("  %-22s %10s %10s %7s\n", "stage", "median ms", "p99 ms", "share");
  for (const std::string& stage : times.order) {
    const auto& values = times.of_stage.at(stage);
    const double stage_ms = quantile(values, 0.5);
    std::printf("  %-22s %10.3f %10.3f %5.1f %%\n", stage.c_str(), stage_ms, quantile(values, 0.99),
                100 * stage_ms / frame_ms);
  }
  std::printf("  %-22s %10.3f %10.3f\n", "frame", frame_ms, quantile(times.of_frame, 0.99));
  std::printf("  %.1f frames/s, %.2f MB of images at the peak\n", 1000 / frame_ms,
              static_cast<double>(times.pool_bytes) / 1e6);
}

int number_in(std::string_view word) {
  int value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || value < 1) {
    throw Error("found '" + std::string(word) + "', expected a positive number");
  }
  return value;
}

Settings parse(const std::vector<std::string>& words) {
  Settings settings;
  for (std::size_t i = 0; i < words.size(); i += 2) {
    if (i + 1 == words.size()) throw Error("'" + words[i] + "' needs a value behind it");
    if (words[i] == "--frames") {
      settings.frames = number_in(words[i + 1]);
    } else if (words[i] == "--preset") {
      settings.preset = words[i + 1];
    } else if (words[i] == "--threads") {
      settings.threads.push_back(number_in(words[i + 1]));
    } else {
      settings.folders.emplace_back(words[i], number_in(words[i + 1]));
    }
  }
  if (settings.threads.empty()) {
    settings.threads = {1};
    if (const auto all = static_cast<int>(std::thread::hardware_concurrency()); all > 1) {
      settings.threads.push_back(all);
    }
  }
  return settings;
}

std::vector<Scene> scenes_of(const Settings& settings) {
  std::vector<Scene> scenes;
  for (const auto& [folder, num_disparities] : settings.folders)
    scenes.push_back(load(folder, num_disparities));
  if (scenes.empty()) {
    scenes.push_back(load(std::filesystem::path(CAIRN_SOURCE_DIR) / "samples/four_in_a_row", 32));
    scenes.push_back(doubled(scenes.front()));
  }
  return scenes;
}

}  // namespace

int main(int argc, char** argv) try {
  const Settings settings = parse({argv + 1, argv + argc});
  for (const Scene& scene : scenes_of(settings)) {
    for (const int threads : settings.threads) {
      print(scene, settings, threads, measure_frames(scene, settings, threads));
    }
  }
} catch (const cairn::Error& error) {
  std::fprintf(stderr, "pipeline: %s\n", error.what());
  return 2;
}
