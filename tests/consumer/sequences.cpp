// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/sequence.hpp>
#include <cairn/output/follow_files.hpp>
#include <cairn/sequence/follower.hpp>
#include <cairn/sequence/map_file.hpp>
#include <cstdio>
#include <filesystem>

/// sequences FOLDER MAP: follows a sequence and keeps its landmarks, with every library behind it linked and
/// used.
int main(int, char** argv) {
  const std::filesystem::path map = argv[2];
  std::filesystem::remove(map);
  const auto sequence = cairn::input::open_sequence(argv[1], {});
  cairn::FollowConfig config;
  config.segmentation.match.num_disparities = sequence->disparities().value_or(64);
  config.landmarks.min_frames = 4;
  cairn::Follower follower(config, sequence->rig(), cairn::Exec::with_threads(2));
  auto file = cairn::MapFile::open(map, cairn::MapMode::update, sequence->rig());
  auto landmarks = cairn::begin_landmarks(file.load(), file.begin_run(argv[1], {}));
  std::size_t written = 0;
  while (const auto frame = sequence->next()) {
    const cairn::TrackedFrame step =
        follower.next(cairn::StereoPair::from(frame->left.gray, frame->right, frame->left.rgb), frame->stamp);
    const auto seen = cairn::landmark_frame(step, *sequence->rig(), frame->left.gray, frame->left.rgb);
    auto marked = cairn::advance_landmarks(std::move(landmarks), seen, config.landmarks);
    file.write(seen, marked);
    written += cairn::output::step_json(step, frame->name, marked).size();
    landmarks = std::move(marked.state);
  }
  file.end_run(cairn::RunState::done, landmarks.map);
  const auto kept = cairn::MapFile::open(map, cairn::MapMode::read_only).load().list.size();
  std::printf("sequences: %zu bytes of lines, %zu landmarks\n", written, kept);
  return written > 0 && kept > 0 ? 0 : 1;
}
