// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/regions/surfaces_behind.hpp>
#include <optional>

namespace cairn {

SurfacesBehind::SurfacesBehind(const Cues& cues, int width, const Exec& exec)
    : ground(slot(width)), background(slot(width)), cues_(cues), run_(kernels::cue_kernels(exec)) {}

void SurfacesBehind::note(int y) {
  const auto width = static_cast<int>(ground.size());
  const std::optional<GroundPlane>& floor = cues_.ground.plane;
  if (floor) run_.nearest_plane({&*floor, 1}, y, width, ground.data());
  run_.nearest_plane(cues_.background.planes, y, width, background.data());
}

}  // namespace cairn
