// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/objects/obstacle_kernels.hpp>
#include <optional>
#include <vector>

/// Rows of what obstacles are labelled by. Private to the library.
namespace cairn {

/// The disparities of floor and walls behind the pixels of a row.
class BackgroundRow {
 public:
  BackgroundRow(const ObstacleCues& cues, const std::optional<StereoRig>& rig, const Exec& exec)
      : run_(kernels::obstacle_kernels(exec)),
        backdrop_(backdrop_of(cues, rig)),
        free_floor_(slot(cues.objects.width())),
        wall_(free_floor_.size()),
        barrier_(free_floor_.size()) {}

  /// See kernels::BackdropRow for the disparities.
  void look_at(int y) {
    run_.look_behind(backdrop_, y, static_cast<int>(wall_.size()),
                     {free_floor_.data(), wall_.data(), barrier_.data()});
  }
  [[nodiscard]] const float* free_floor_px() const { return free_floor_.data(); }
  [[nodiscard]] const float* wall_px() const { return wall_.data(); }
  [[nodiscard]] const float* barrier_px() const { return barrier_.data(); }

 private:
  static kernels::Backdrop backdrop_of(const ObstacleCues& cues, const std::optional<StereoRig>& rig) {
    const auto& planes = cues.background.planes;
    return {cues.ground.plane,
            {planes.begin() + (cues.background.has_floor ? 1 : 0), planes.end()},
            rig ? rig->doffs_px : 0.0F};
  }

  const kernels::ObstacleKernels& run_;
  kernels::Backdrop backdrop_;
  std::vector<float> free_floor_;
  std::vector<float> wall_;
  std::vector<float> barrier_;
};

/// The disparities of a row, with the likely ones of the refined in their place.
class SeenRow {
 public:
  SeenRow(const ObstacleCues& cues, const Exec& exec)
      : cues_(cues),
        run_(kernels::obstacle_kernels(exec)),
        surfaces_(cues.surface_disparity_px.empty() ? cues.disparity.disparity_px.view()
                                                    : cues.surface_disparity_px),
        all_trusted_(cues.confidence.empty() ? slot(surfaces_.width()) : 0, 1.0F) {
    if (cues.refined_px.empty()) return;
    for (std::vector<float>* const buffer : {&own_disparity_, &own_surface_, &own_confidence_})
      buffer->resize(slot(surfaces_.width()));
  }
  void look_at(int y) {
    disparity_ = cues_.disparity.disparity_px.row(y);
    surface_ = surfaces_.row(y);
    confidence_ = cues_.confidence.empty() ? all_trusted_.data() : cues_.confidence.row(y);
    if (cues_.refined_px.empty()) return;
    run_.prefer_refined({disparity_, surface_, confidence_}, cues_.refined_px.row(y),
                        cues_.refined_confidence.row(y), kLikelyRefined, surfaces_.width(),
                        {own_disparity_.data(), own_surface_.data(), own_confidence_.data()});
    disparity_ = own_disparity_.data();
    surface_ = own_surface_.data();
    confidence_ = own_confidence_.data();
  }
  [[nodiscard]] const float* disparity_px() const { return disparity_; }
  [[nodiscard]] const float* surface_px() const { return surface_; }
  [[nodiscard]] const float* confidence() const { return confidence_; }

 private:
  const ObstacleCues& cues_;
  const kernels::ObstacleKernels& run_;
  View<const float> surfaces_;
  std::vector<float> all_trusted_;
  std::vector<float> own_disparity_, own_surface_, own_confidence_;
  const float* disparity_ = nullptr;
  const float* surface_ = nullptr;
  const float* confidence_ = nullptr;
};

}  // namespace cairn
