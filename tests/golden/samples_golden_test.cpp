// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Detects changes of the results on the samples: each true object's IoU and position, and the disparity's
// density and errors, against golden/samples.json. After an intended change, ./dev test --update (which sets
// CAIRN_UPDATE_GOLDEN=1) regenerates the file; review its diff.
#include <gtest/gtest.h>

#include <cairn/cairn.hpp>
#include <cairn/evaluation/disparity_error.hpp>
#include <cairn/evaluation/object_error.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <support/samples.hpp>

namespace cairn {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kIouTolerance = 0.03;
constexpr double kPositionToleranceMetres = 0.05;
constexpr double kShareTolerance = 0.01;  // of density and of bad pixels
constexpr int kCountTolerance = 1;        // objects found

const std::filesystem::path kStored = std::filesystem::path(CAIRN_SOURCE_DIR) / "tests/golden/samples.json";

Image<TruthId> true_objects(const std::string& name) {
  const io::Labels labels = io::load_labels(samples::folder(name) / "objects.png");
  Image<TruthId> truth(labels.ids.size());
  for (int y = 0; y < truth.height(); ++y) {
    for (int x = 0; x < truth.width(); ++x) truth(x, y) = TruthId{labels.ids(x, y)};
  }
  return truth;
}

/// Three decimals are enough for a review, and hide the rounding differences of compilers and libraries.
double rounded(double value) {
  return std::round(value * 1000) / 1000;
}

Json describe(const TrueObjectScore& score, const Objects& objects) {
  Json out{{"true_id", number(score.id)}, {"iou", rounded(score.iou)}};
  if (score.found == ObjectId::none) return out;
  const Object& found = objects.list.at(static_cast<std::size_t>(number(score.found)) - 1);
  if (found.position_in_camera_m) {
    const Vec3 at = *found.position_in_camera_m;
    out["position_m"] = {rounded(at.x), rounded(at.y), rounded(at.z)};
  }
  return out;
}

/// The stored values of a sample's result.
Json summary(const std::string& name, const Config& preset) {
  const samples::Sample sample = samples::load(name);
  const Frame frame = segment(sample.pair(), sample.calibration.rig, sample.suited(preset), {});

  const auto truth_px = io::load_disparity(samples::folder(name) / "disp_left.png");
  const io::Labels occlusion = io::load_labels(samples::folder(name) / "occlusion.png");
  Image<std::uint8_t> hidden(truth_px.size());
  for (int y = 0; y < hidden.height(); ++y) {
    for (int x = 0; x < hidden.width(); ++x) hidden(x, y) = occlusion.ids(x, y) != 0 ? 255 : 0;
  }
  const DisparityErrors disparity = disparity_errors(frame.disparity.disparity_px, truth_px, hidden, 0);

  Json out;
  out["density"] = rounded(disparity.density());
  out["bad_1_of_matched"] = rounded(disparity.bad_of_matched(1));
  out["objects"] = frame.objects.list.size();
  out["true_objects"] = Json::array();
  const Image<TruthId> truth = true_objects(name);
  const ObjectErrors errors = object_errors(frame.objects.labels, truth, {});
  for (const TrueObjectScore& score : errors.truth) {
    out["true_objects"].push_back(describe(score, frame.objects));
  }
  return out;
}

Json all_summaries() {
  Json out;
  for (const char* const name : samples::kNames) {
    out[name]["default"] = summary(name, Config());
    out[name]["paper"] = summary(name, Config::paper());
  }
  return out;
}

void expect_near(const Json& now, const Json& then) {
  EXPECT_NEAR(now.at("density").get<double>(), then.at("density").get<double>(), kShareTolerance);
  EXPECT_NEAR(now.at("bad_1_of_matched").get<double>(), then.at("bad_1_of_matched").get<double>(),
              kShareTolerance);
  EXPECT_NEAR(now.at("objects").get<int>(), then.at("objects").get<int>(), kCountTolerance);
  ASSERT_EQ(now.at("true_objects").size(), then.at("true_objects").size());
  for (std::size_t i = 0; i < now.at("true_objects").size(); ++i) {
    const Json& a = now.at("true_objects").at(i);
    const Json& b = then.at("true_objects").at(i);
    SCOPED_TRACE("true object " + b.at("true_id").dump() + ", now " + a.dump() + ", stored " + b.dump());
    EXPECT_EQ(a.at("true_id"), b.at("true_id"));
    EXPECT_NEAR(a.at("iou").get<double>(), b.at("iou").get<double>(), kIouTolerance);
    // The position is meaningless for an object that was hardly found.
    if (b.at("iou").get<double>() < 0.5 || !b.contains("position_m")) continue;
    ASSERT_TRUE(a.contains("position_m"));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(a.at("position_m").at(axis).get<double>(), b.at("position_m").at(axis).get<double>(),
                  kPositionToleranceMetres);
    }
  }
}

TEST(Samples, AreSegmentedAsStored) {
  const Json now = all_summaries();
  if (std::getenv("CAIRN_UPDATE_GOLDEN") != nullptr) {
    std::ofstream(kStored) << now.dump(1) << '\n';
    GTEST_SKIP() << "wrote " << kStored << " anew";
  }
  std::ifstream file(kStored);
  ASSERT_TRUE(file) << kStored << " is missing; ./dev test --update writes it";
  const Json then = Json::parse(file);
  for (const char* const name : samples::kNames) {
    for (const char* const preset : {"default", "paper"}) {
      SCOPED_TRACE(std::string(name) + ", preset " + preset);
      expect_near(now.at(name).at(preset), then.at(name).at(preset));
    }
  }
}

}  // namespace
}  // namespace cairn
