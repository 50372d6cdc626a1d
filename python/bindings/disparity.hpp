// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/disparity/disparity_map.hpp>
#include <optional>

#include "arrays.hpp"

namespace cairn::python {

/// A DisparityMap as a stage takes it: one of ours, or a map from outside made into one.
class DisparityInput {
 public:
  DisparityInput(const DisparityArgument& argument, const char* name, const Exec& exec);
  [[nodiscard]] const DisparityMap& map() const { return own_ ? *own_ : *borrowed_; }
  [[nodiscard]] Size size() const { return map().disparity_px.size(); }
  /// A map that a stage may take over.
  [[nodiscard]] DisparityMap taken(const Exec& exec);

 private:
  std::optional<DisparityMap> own_;
  const DisparityMap* borrowed_ = nullptr;
};

/// Throws Error unless it can be the noise of a picture.
void expect_noise(float noise_sigma);

}  // namespace cairn::python
