// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// The minimum: a rectified pair in, objects out.
//   01_objects_from_a_pair data/samples/four_in_a_row
#include <cairn/cairn.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cstdio>
#include <filesystem>

namespace {

void print_objects(const std::filesystem::path& folder) {
  // [readme]
  const auto images = cairn::io::load_pair(folder / "left.png", folder / "right.png");
  const auto calibration = cairn::io::load_calibration(folder / "calib.txt");

  cairn::Config config;  // every option and its default: docs/options.md
  config.match.num_disparities = calibration.num_disparities.value_or(64);

  const auto pair = cairn::StereoPair::from(images.left.gray, images.right.gray, images.left.rgb);
  const auto frame = cairn::segment(pair, calibration.rig, config, cairn::Exec::with_threads(0));

  for (const cairn::Object& object : frame.objects.list) {
    const auto at = object.position_in_camera_m.value_or(cairn::Vec3{});
    std::printf("object %d  %5d px  %5.2f m right  %5.2f m down  %5.2f m away\n", number(object.id),
                object.pixel_count, at.x, at.y, at.z);
  }
  // [/readme]
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: %s FOLDER (with left.png, right.png and calib.txt)\n", argv[0]);
    return 2;
  }
  print_objects(argv[1]);
} catch (const cairn::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
