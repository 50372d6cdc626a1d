// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/cairn.hpp>
#include <cairn/input/sequence.hpp>
#include <cairn/sequence/follower.hpp>
#include <cstdio>

/// From a sequence to the camera's path and to objects with persistent ids: 05_follow_a_sequence FOLDER,
/// where FOLDER is any source of `cairn follow`, such as data/sequences/rolling_ball.
int main(int argc, char** argv) try {
  if (argc != 2) return std::fprintf(stderr, "usage: 05_follow_a_sequence FOLDER\n"), 2;

  // [readme]
  const auto sequence = cairn::input::open_sequence(argv[1], {});
  cairn::FollowConfig config;
  config.segmentation.match.num_disparities = sequence->disparities().value_or(64);
  cairn::Follower follower(config, sequence->rig(), cairn::Exec::with_threads(0));

  while (const auto frame = sequence->next()) {
    const auto pair = cairn::StereoPair::from(frame->left.gray, frame->right, frame->left.rgb);
    const cairn::TrackedFrame step = follower.next(pair, frame->stamp);
    const cairn::Point3 camera = step.map_from_camera.translation_m;
    std::printf("%s: camera at %.2f, %.2f m\n", frame->name.c_str(), camera.x, camera.y);
    for (const cairn::Track& track : step.tracks.list) {
      if (track.state != cairn::TrackState::confirmed || !track.has_place) continue;
      const cairn::Point3 p = track.position_m;
      std::printf("  track %lld at %5.2f, %5.2f m%s\n", static_cast<long long>(number(track.id)), p.x, p.y,
                  track.is_moving ? ", moving" : "");
    }
  }
  // [/readme]
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 2;
}
