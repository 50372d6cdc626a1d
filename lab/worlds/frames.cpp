// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "lab/worlds/frames.hpp"

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/image_files.hpp>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

namespace cairn::worlds {
namespace {

namespace fs = std::filesystem;

/// Like a camera that meters the whole image, without its brightest parts.
float metered(const Picture& picture) {
  double sum = 0;
  for (const Vec3& c : picture.colour)
    sum += std::min(0.3 * double{c.x} + 0.59 * double{c.y} + 0.11 * double{c.z}, 2.0);
  return static_cast<float>(sum / static_cast<double>(picture.colour.size()));
}

/// A multiple of 16 above the largest disparity, as in the data sets.
int disparities_of(const Truth& truth) {
  float most = 0;
  for (int y = 0; y < truth.disparity_px.height(); ++y) {
    const float* const row = truth.disparity_px.row(y);
    most = std::max(most, *std::max_element(row, row + truth.disparity_px.width()));
  }
  return std::clamp((static_cast<int>(most) / 16 + 1) * 16, 16, 512);
}

/// The mean of the visible points of each id, in the left camera's frame.
std::map<int, Vec3> visible_centres(const Truth& truth, const Rig& rig) {
  std::map<int, std::pair<Vec3, int>> sums;
  for (int y = 0; y < truth.ids.height(); ++y) {
    for (int x = 0; x < truth.ids.width(); ++x) {
      if (truth.ids(x, y) == 0) continue;
      const float z = rig.focal_px * rig.baseline_m / truth.disparity_px(x, y);
      auto& [sum, count] = sums[truth.ids(x, y)];
      sum = sum + z * Vec3{(static_cast<float>(x) - rig.cx_px) / rig.focal_px,
                           (static_cast<float>(y) - rig.cy_px) / rig.focal_px, 1};
      ++count;
    }
  }
  std::map<int, Vec3> centres;
  for (const auto& [id, of_id] : sums) centres[id] = 1.0F / static_cast<float>(of_id.second) * of_id.first;
  return centres;
}

nlohmann::ordered_json json_of(Vec3 v) {
  return {v.x, v.y, v.z};
}

}  // namespace

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  if (!out.flush()) throw Error(file.string() + ": cannot be written");
}

WorldFrame make_frame(World world, int samples) {
  WorldFrame frame{std::move(world), {}, {}, {}};
  Rendered rendered = render(frame.world.scene, samples);
  Sensor& sensor = frame.world.sensor;
  sensor.exposure /= std::max(metered(rendered.left), 1e-4F);
  frame.left = expose(rendered.left, sensor, false, frame.world.scene.seed);
  frame.right = expose(rendered.right, sensor, true, frame.world.scene.seed);
  frame.truth = std::move(rendered.truth);
  return frame;
}

void write_frame(const WorldFrame& frame, const fs::path& folder) {
  const fs::path unfinished = folder.string() + ".unfinished";
  fs::remove_all(unfinished);
  fs::create_directories(unfinished);
  io::save_png(unfinished / "left.png", View<const Rgb>(frame.left));
  io::save_png(unfinished / "right.png", View<const Rgb>(frame.right));
  const Truth& truth = frame.truth;
  Image<std::uint16_t> disparity(truth.ids.size());
  for (int y = 0; y < disparity.height(); ++y) {
    for (int x = 0; x < disparity.width(); ++x)
      disparity(x, y) =
          static_cast<std::uint16_t>(std::clamp(std::lround(256 * truth.disparity_px(x, y)), 0L, 65535L));
  }
  io::save_png(unfinished / "disp_left.png", View<const std::uint16_t>(disparity));
  if (frame.world.scene.has_projector) {
    const Rig& rig = frame.world.scene.rig;
    Image<std::uint16_t> depth_mm(truth.ids.size());
    for (int y = 0; y < depth_mm.height(); ++y) {
      for (int x = 0; x < depth_mm.width(); ++x) {
        const float z = rig.focal_px * rig.baseline_m / std::max(truth.disparity_px(x, y), 1e-6F);
        depth_mm(x, y) = z < 65 ? static_cast<std::uint16_t>(std::lround(1000 * z)) : std::uint16_t{0};
      }
    }
    io::save_png(unfinished / "depth.png", View<const std::uint16_t>(depth_mm));
  }
  io::save_png(unfinished / "objects.png", View<const std::uint8_t>(truth.ids));
  io::save_png(unfinished / "occlusion.png", View<const std::uint8_t>(truth.occlusion));
  io::save_png(unfinished / "ground.png", View<const std::uint8_t>(truth.ground));
  const Rig& rig = frame.world.scene.rig;
  std::ostringstream calib;
  calib << "fx=" << rig.focal_px << "\nfy=" << rig.focal_px << "\ncx=" << rig.cx_px << "\ncy=" << rig.cy_px
        << "\nbaseline=" << rig.baseline_m << "\nwidth=" << rig.size.width << "\nheight=" << rig.size.height
        << "\nndisp=" << disparities_of(truth) << "\n";
  write_text(unfinished / "calib.txt", calib.str());
  std::ostringstream pose;
  pose << "# left camera to world (x right, y down, z forward; z up), m\n";
  const std::array<Vec3, 4> columns{rig.right, rig.down, rig.forward, rig.eye};
  for (const auto axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    for (const Vec3& column : columns) pose << column.*axis << (&column == &columns.back() ? "\n" : " ");
  }
  pose << "0 0 0 1\n";
  write_text(unfinished / "pose.txt", pose.str());
  nlohmann::ordered_json scene{{"place", kPlaces.at(static_cast<std::size_t>(frame.world.place))},
                               {"objects", nlohmann::json::array()}};
  const std::map<int, Vec3> centres = visible_centres(truth, rig);
  for (const Thing& thing : frame.world.things) {
    const auto visible = centres.find(thing.id);
    scene["objects"].push_back(
        {{"id", thing.id},
         {"kind", thing.kind},
         {"placed", thing.placed},
         {"size_m", json_of(thing.size_m)},
         {"centroid_world", json_of(thing.centre)},
         {"centroid_visible_cam",
          visible != centres.end() ? json_of(visible->second) : nlohmann::ordered_json()}});
  }
  for (const Raised& part : frame.world.raised) {
    scene["raised"].push_back({{"edge", {part.edge.x, part.edge.y}},
                               {"inward", {part.inward.x, part.inward.y}},
                               {"height_m", part.height_m}});
  }
  write_text(unfinished / "scene.json",
             scene.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  fs::rename(unfinished, folder);
}

}  // namespace cairn::worlds
