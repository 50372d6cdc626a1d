// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "confidence_study.hpp"

#include <algorithm>
#include <array>
#include <cairn/cairn.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <io/calibration_files.hpp>
#include <io/dataset.hpp>
#include <io/disparity_files.hpp>
#include <io/image_files.hpp>
#include <string>
#include <vector>

#include "reference/confidence.hpp"

namespace {

using namespace cairn;
namespace fs = std::filesystem;

constexpr float kRightPx = 1.0F;

// ---- frames ----

struct TruthFrame {
  fs::path folder;
  fs::path truth;  // folder with disp_left.png and calib.txt
};

struct DataSet {
  std::string name;
  std::vector<TruthFrame> frames;
};

std::vector<fs::path> folders_in(const fs::path& folder) {
  std::vector<fs::path> all;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (fs::exists(entry.path() / "left.png")) all.push_back(entry.path());
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// Every frame in `folders` whose name starts with `prefix`; of a sequence, every `step`-th.
DataSet data_set(std::string name, const std::vector<fs::path>& folders, const std::string& prefix = "",
                 std::size_t step = 1) {
  DataSet set{std::move(name), {}};
  for (const fs::path& folder : folders) {
    const std::vector<fs::path> frames = folders_in(folder);
    for (std::size_t i = 0; i < frames.size(); i += step) {
      if (!frames[i].filename().string().starts_with(prefix)) continue;
      const bool own = fs::exists(frames[i] / "disp_left.png");
      set.frames.push_back({frames[i], own ? frames[i] : folder / "gt"});
    }
  }
  return set;
}

std::vector<DataSet> data_sets(const fs::path& data) {
  const fs::path rendered = data / "rendered";
  const fs::path real = data / "real";
  const std::vector<fs::path> stress{rendered / "stress/base0", rendered / "stress/base1",
                                     rendered / "stress/base2"};
  return {data_set("rendered 320x240 (fitted)", {rendered / "dev/320x240"}),
          data_set("rendered 640x480 (fitted)", {rendered / "dev/640x480"}),
          data_set("rendered sequences",
                   {rendered / "dev/sequences/dev_seqA", rendered / "dev/sequences/dev_seqB"}, "", 8),
          data_set("stress: gloss", stress, "floor_"),
          data_set("stress: gain and offset", stress, "gain_"),
          data_set("stress: noise", stress, "noise_"),
          data_set("stress: vertical shift", stress, "vshift_"),
          data_set("stress: dim light", stress, "dim_"),
          data_set("stress: low texture", stress, "lowtexture"),
          data_set("stress: repetitive texture", stress, "repetitive"),
          data_set("Middlebury 2001", {real / "middlebury2001"}),
          data_set("Middlebury 2003", {real / "middlebury2003"}),
          data_set("Middlebury 2005", {real / "middlebury2005"}),
          data_set("Middlebury 2006", {real / "middlebury2006"}),
          data_set("Middlebury 2014", {real / "middlebury2014"})};
}

/// Calls visit(matches, scene, truth) for each frame, as processed by the preset's pipeline.
using Visit = std::function<void(const Matches&, const SceneDisparity&, View<const float>)>;
void visit_frame(const TruthFrame& frame, const Config& preset, const Exec& given, const Visit& visit) {
  const io::PicturePair pair = io::load_pair(frame.folder / "left.png", frame.folder / "right.png");
  const io::Calibration calibration = io::load_calibration(frame.truth / "calib.txt");
  Config config = preset;
  config.match.num_disparities = calibration.num_disparities.value_or(64);
  Matches matches;
  Exec exec = given;
  exec.observe = [&](std::string_view stage, const Artifact& artifact, double) {
    if (stage != "match") return;
    const Matches* made = std::get<const Matches*>(artifact);
    matches.cost = made->cost.clone();
    matches.runner_up = made->runner_up.clone();
    matches.mean_cost = made->mean_cost.clone();
  };
  const SceneDisparity scene = estimate_disparity(
      StereoPair::from(pair.left.gray, pair.right.gray, pair.left.rgb), calibration.rig, config, exec);
  const Image<float> truth_px = io::load_disparity(frame.truth / "disp_left.png");
  visit(matches, scene, truth_px);
}

// ---- fitting ----

constexpr std::size_t kNumbers = 5;  // parameters of a ConfidenceModel
using Numbers = std::array<double, kNumbers>;

struct Sample {
  Numbers signs{};  // 1, margin, cost, jumps, holes
  bool right = false;
  double weight = 0;
};

/// A sample of the pixels of each frame, without preferred columns or rows. Data sets have equal weight.
std::vector<Sample> samples_of(const std::vector<DataSet>& sets, const Config& preset, const Exec& exec) {
  constexpr std::uint32_t kOneOf = 11;
  std::vector<Sample> all;
  for (const DataSet& set : sets) {
    const std::size_t first = all.size();
    std::uint32_t random = 1;
    for (const TruthFrame& frame : set.frames) {
      visit_frame(frame, preset, exec,
                  [&](const Matches& matches, const SceneDisparity& scene, View<const float> truth_px) {
                    const View<const float> disparity_px = scene.disparity.disparity_px;
                    for (int y = 0; y < truth_px.height(); ++y) {
                      for (int x = 0; x < truth_px.width(); ++x) {
                        const float off = std::abs(disparity_px(x, y) - truth_px(x, y));
                        random = random * 1664525U + 1013904223U;
                        if (std::isnan(off) || (random >> 16U) % kOneOf != 0) continue;
                        const auto [margin, cost, jumps, holes] =
                            reference::confidence_signs(matches, disparity_px, x, y);
                        all.push_back({{1, margin, cost, jumps, holes}, off <= kRightPx, 0});
                      }
                    }
                  });
    }
    const auto count = static_cast<double>(all.size() - first);
    for (std::size_t i = first; i < all.size(); ++i) all[i].weight = 1 / count;
  }
  return all;
}

/// Solves h·x = g by Gaussian elimination; h is symmetric and positive definite.
Numbers solve(std::array<Numbers, kNumbers> h, Numbers g) {
  for (std::size_t i = 0; i < kNumbers; ++i) {
    for (std::size_t j = i + 1; j < kNumbers; ++j) {
      const double share = h[j][i] / h[i][i];
      for (std::size_t k = i; k < kNumbers; ++k) h[j][k] -= share * h[i][k];
      g[j] -= share * g[i];
    }
  }
  for (std::size_t i = kNumbers; i-- > 0;) {
    for (std::size_t k = i + 1; k < kNumbers; ++k) g[i] -= h[i][k] * g[k];
    g[i] /= h[i][i];
  }
  return g;
}

/// The maximum-likelihood parameters, by Newton's method.
Numbers fit(const std::vector<Sample>& samples) {
  constexpr int kSteps = 12;
  Numbers numbers{};
  for (int step = 0; step < kSteps; ++step) {
    std::array<Numbers, kNumbers> h{};
    Numbers g{};
    for (const Sample& s : samples) {
      double log_odds = 0;
      for (std::size_t i = 0; i < kNumbers; ++i) log_odds += numbers[i] * s.signs[i];
      const double p = 1 / (1 + std::exp(-log_odds));
      for (std::size_t i = 0; i < kNumbers; ++i) {
        g[i] += s.weight * s.signs[i] * ((s.right ? 1 : 0) - p);
        for (std::size_t j = 0; j < kNumbers; ++j)
          h[i][j] += s.weight * p * (1 - p) * s.signs[i] * s.signs[j];
      }
    }
    const Numbers by = solve(h, g);
    for (std::size_t i = 0; i < kNumbers; ++i) numbers[i] += by[i];
  }
  return numbers;
}

// ---- comparing ----

constexpr std::size_t kBins = 10;
constexpr double kConfident = 0.8;

struct Reliability {
  std::array<double, kBins> count{};
  std::array<double, kBins> stated{};  // sums
  std::array<double, kBins> right{};
  double confident = 0;
  double confident_right = 0;

  void add(float confidence, bool is_right) {
    const auto bin = std::min(static_cast<std::size_t>(confidence * kBins), kBins - 1);
    count[bin] += 1;
    stated[bin] += double{confidence};
    right[bin] += is_right ? 1 : 0;
    if (confidence < kConfident) return;
    confident += 1;
    confident_right += is_right ? 1 : 0;
  }
};

double sum(const std::array<double, kBins>& of) {
  double all = 0;
  for (const double v : of) all += v;
  return all;
}

/// Expected calibration error: mean |stated − measured| over the bins, weighted by their pixels.
double expected_calibration_error(const Reliability& r) {
  double all = 0;
  for (std::size_t i = 0; i < kBins; ++i) all += std::abs(r.stated[i] - r.right[i]);
  return all / sum(r.count);
}

Reliability reliability_of(const DataSet& set, const Config& preset, const Exec& exec) {
  Reliability r;
  for (const TruthFrame& frame : set.frames) {
    visit_frame(frame, preset, exec,
                [&](const Matches&, const SceneDisparity& scene, View<const float> truth_px) {
                  for (int y = 0; y < truth_px.height(); ++y) {
                    for (int x = 0; x < truth_px.width(); ++x) {
                      const float off = std::abs(scene.disparity.disparity_px(x, y) - truth_px(x, y));
                      if (!std::isnan(off)) r.add(scene.confidence(x, y), off <= kRightPx);
                    }
                  }
                });
  }
  return r;
}

/// Smaller bins are too noisy to report.
constexpr double kFewPixels = 200;

void print_row(const DataSet& set, const Reliability& r) {
  const double all = sum(r.count);
  std::printf("| %s | %.1f | %.1f | %.1f | %.0f: %.1f |", set.name.c_str(), 100 * sum(r.stated) / all,
              100 * sum(r.right) / all, 100 * expected_calibration_error(r), 100 * r.confident / all,
              100 * r.confident_right / r.confident);
  for (std::size_t i = 0; i < kBins; ++i) {
    if (r.count[i] < kFewPixels) {
      std::printf(" |");
    } else {
      std::printf(" %.0f |", 100 * r.right[i] / r.count[i]);
    }
  }
  std::printf("\n");
  std::fflush(stdout);
}

void print_numbers(const char* title, const Numbers& n) {
  std::printf("%s: bias %.2f, margin %.2f, cost %.2f, jumps %.2f, holes %.2f\n", title, n[0], n[1], n[2],
              n[3], n[4]);
}

void study(const char* name, const Config& preset, const std::vector<DataSet>& sets, const Exec& exec) {
  const ConfidenceModel m = confidence_model(preset.match.method);
  std::printf("Preset %s\n\n", name);
  print_numbers("fitted now", fit(samples_of({sets[0], sets[1]}, preset, exec)));
  print_numbers("in the library", {m.bias, m.margin, m.cost, m.jumps, m.holes});
  std::printf("\n| data | stated | right | ECE | >= 0.8: right |");
  for (std::size_t i = 0; i < kBins; ++i) std::printf(" .%zu |", i);
  std::printf("\n|---|---:|---:|---:|---:|");
  for (std::size_t i = 0; i < kBins; ++i) std::printf("---:|");
  std::printf("\n");
  for (const DataSet& set : sets) print_row(set, reliability_of(set, preset, exec));
  std::printf("\n");
}

}  // namespace

void confidence_study(const fs::path& data, const Exec& exec) {
  std::printf(
      "All in %%, over the pixels with a disparity and a truth, occluded ones too; right = within 1 px.\n"
      "stated: mean confidence; ECE: expected calibration error; >= 0.8: share of pixels with such a "
      "confidence, and "
      "how many of them are right;\n"
      ".0 to .9: right ones among those stated 0 to 0.1 ... 0.9 to 1 (empty: fewer than %.0f pixels)\n\n",
      kFewPixels);
  const std::vector<DataSet> sets = data_sets(data);
  study("default", Config(), sets, exec);
  study("paper", Config::paper(), sets, exec);
}
