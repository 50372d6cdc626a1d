// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/cairn.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/output/results.hpp>
#include <cairn/output/web/html_page.hpp>
#include <cstdio>
#include <filesystem>

/// files SAMPLE RESULT: from images to results through cairn::io, with every library behind it linked and
/// used.
int main(int, char** argv) {
  const std::filesystem::path folder = argv[1];
  const std::filesystem::path result = argv[2];
  const auto images = cairn::io::load_pair(folder / "left.png", folder / "right.png");
  const auto calibration = cairn::io::load_calibration(folder / "calib.txt");
  cairn::Config config;
  config.match.num_disparities = calibration.num_disparities.value_or(64);
  const auto pair = cairn::StereoPair::from(images.left.gray, images.right.gray, images.left.rgb);
  const auto frame = cairn::segment(pair, calibration.rig, config, cairn::Exec::with_threads(0));
  cairn::output::write_result(result, images.left.gray, images.left.rgb, frame,
                              {"default", config, calibration.rig, {}, false});
  std::printf("files: %zu objects, %zu bytes of options, %zu of an empty page\n", frame.objects.list.size(),
              cairn::io::config_yaml(config).size(),
              cairn::output::html_page({"segment", "none", {}}, {}).size());
  return frame.objects.list.empty() || !std::filesystem::exists(result / "overlay.png") ? 1 : 0;
}
