// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "targets.hpp"

#include <unistd.h>

#include <cairn/core/error.hpp>
#include <cairn/fleet/fleet_book.hpp>
#include <cairn/input/laser_scans.hpp>
#include <cairn/input/priors.hpp>
#include <cairn/input/sequence.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/io/raw_calibration.hpp>
#include <cairn/io/rle.hpp>
#include <cairn/live/view/access.hpp>
#include <cairn/live/view/parameters.hpp>
#include <cairn/output/json_line.hpp>
#include <cairn/output/results.hpp>
#include <cairn/output/track_files.hpp>
#include <cairn/output/trajectory_files.hpp>
#include <cairn/pipeline/config.hpp>
#include <cairn/pipeline/segment.hpp>
#include <cairn/ros/from_step.hpp>
#include <cairn/ros/mcap.hpp>
#include <cairn/sequence/follower.hpp>
#include <cairn/sequence/map_file.hpp>
#include <cairn/sequence/stamps.hpp>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <support/small_pictures.hpp>

namespace cairn::fuzz {
namespace {

namespace fs = std::filesystem;

/// A temporary folder of this process, in memory if possible.
class Place {
 public:
  Place() {
    std::error_code unknown;
    const fs::path base =
        fs::is_directory("/dev/shm", unknown) ? fs::path("/dev/shm") : fs::temp_directory_path();
    std::string pattern = (base / "cairn-foreign-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr)
      throw std::runtime_error("no folder can be made in " + base.string());
    path_ = pattern;
  }
  ~Place() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

fs::path written(const char* name, std::string_view bytes) {
  static const Place place;
  fs::path file = place.path() / name;
  io::write_file(file, bytes);
  return file;
}

/// Removes and returns the text up to `end`.
std::string_view taken_until(char end, std::string_view& text) {
  const std::string_view part = text.substr(0, text.find(end));
  text.remove_prefix(std::min(part.size() + 1, text.size()));
  return part;
}

/// Checks that an Error has a message of one line.
template <class Work>
bool is_taken(Work&& work) {
  try {
    work();
    return true;
  } catch (const Error& error) {
    const std::string_view says = error.what();
    if (says.empty() || says.find('\n') != std::string_view::npos)
      throw std::logic_error("an Error is not one line: " + std::string(says));
    return false;
  }
}

template <auto read>
bool read_file_of(const char* name, std::string_view bytes) {
  const fs::path file = written(name, bytes);
  return is_taken([&] { (void)read(file); });
}

// ---- images ----

constexpr int kSeedSide = 9;

std::vector<std::uint8_t> ramp(std::size_t count) {
  std::vector<std::uint8_t> bytes(count);
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::uint8_t>(i * 37);
  return bytes;
}

std::string encoded(int channels, int bytes_each, std::string (*encode)(const io::PixelRows&)) {
  const auto row = static_cast<std::size_t>(kSeedSide * channels * bytes_each);
  const std::vector<std::uint8_t> pixels = ramp(row * kSeedSide);
  return encode(
      {{kSeedSide, kSeedSide}, channels, bytes_each, pixels.data(), static_cast<std::ptrdiff_t>(row)});
}

std::string jpeg_of(const io::PixelRows& rows) {
  return io::encode_jpeg(rows);
}

std::vector<std::string> images() {
  return {encoded(1, 1, io::encode_png), encoded(3, 1, io::encode_png), encoded(1, 2, io::encode_png),
          encoded(1, 1, jpeg_of), encoded(3, 1, jpeg_of), "P2\n# grey\n3 2\n255\n0 10 20\n30 40 255\n",
          "P3\n2 1\n255\n1 2 3 4 5 6\n", std::string("P5\n2 2\n65535\n\0\1\2\3\4\5\6\7", 20),
          std::string("P6\n1 2\n255\n\1\2\3\4\5\6", 17),
          // Formats that are read but not written.
          support::decoded(support::kPalettePng), support::decoded(support::kOneBitPng),
          support::decoded(support::kGreyAlphaPng), support::decoded(support::kColourAlpha16Png),
          support::decoded(support::kInterlacedPng), support::decoded(support::kProgressiveJpeg)};
}

bool picture(std::string_view bytes) {
  return read_file_of<[](const fs::path& file) { return io::load_picture(file); }>("picture.png", bytes);
}
bool labels(std::string_view bytes) {
  return read_file_of<[](const fs::path& file) { return io::load_labels(file); }>("labels.png", bytes);
}

std::vector<std::string> disparities() {
  const float values[] = {1.5F, 2.5F, 64.0F, 0.25F};
  std::string pfm = "Pf\n2 2\n-1.0\n";
  pfm.append(reinterpret_cast<const char*>(values), sizeof values);
  std::string npy = "\x93NUMPY\1";
  npy += std::string("\0\x46\0", 3) + "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2), }";
  npy.resize(79, ' ');
  npy += '\n';
  npy.append(reinterpret_cast<const char*>(values), sizeof values);
  return {encoded(1, 2, io::encode_png), encoded(1, 1, io::encode_png), pfm, npy};
}

/// The format follows from the name.
bool disparity(std::string_view bytes) {
  constexpr auto kRead = [](const fs::path& file) { return io::load_disparity(file); };
  bool taken = read_file_of<kRead>("disparity.pfm", bytes);
  taken |= read_file_of<kRead>("disparity.png", bytes);
  taken |= read_file_of<kRead>("disparity.npy", bytes);
  return taken;
}

// ---- calibrations and configurations ----

std::vector<std::string> calibrations() {
  return {
      "cam0=[500 0 160; 0 500 120; 0 0 1]\ncam1=[500 0 160; 0 500 120; 0 0 1]\ndoffs=0\nbaseline=100\n"
      "width=320\nheight=240\nndisp=64\n",
      "P2: 7.2e+02 0 6.1e+02 4.5e+01 0 7.2e+02 1.7e+02 2.2e-01 0 0 1 2.7e-03\n"
      "P3: 7.2e+02 0 6.1e+02 -3.4e+02 0 7.2e+02 1.7e+02 2.2e+00 0 0 1 2.7e-03\n",
      "focal_px: 500\ncx_px: 160\ncy_px: 120\nbaseline_m: 0.1\ndoffs_px: 0\ncamera_height: 0.5\n"
      "ground_points: [[1, 2, 0, 2], [9, 2, 5, 2], [1, 9, 0, 9], [9, 9, 3, 9]]\n",
      "%YAML:1.0\n---\nQ: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: d\n"
      "   data: [1, 0, 0, -160, 0, 1, 0, -120, 0, 0, 0, 500, 0, 0, 10, 0]\n",
      "<?xml version=\"1.0\"?>\n<opencv_storage>\n<Q type_id=\"opencv-matrix\">\n<rows>4</rows><cols>4</cols>"
      "<dt>d</dt>\n<data>1 0 0 -160 0 1 0 -120 0 0 0 500 0 0 10 0</data></Q>\n</opencv_storage>\n",
      "{\"Q\": {\"type_id\": \"opencv-matrix\", \"rows\": 4, \"cols\": 4, \"dt\": \"d\", \"data\": [1, 0, 0, "
      "-160, 0, "
      "1, 0, -120, 0, 0, 0, 500, 0, 0, 10, 0]}}\n",
      "image_width: 640\nimage_height: 480\ncamera_name: right\ndistortion_model: plumb_bob\n"
      "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [500, 0, 320, -50, 0, 500, 240, 0, 0, 0, 1, 0]\n",
      ","};
}

bool calibration(std::string_view bytes) {
  return read_file_of<[](const fs::path& file) { return io::load_calibration(file); }>("calib.txt", bytes);
}
bool raw_calibration(std::string_view bytes) {
  return read_file_of<[](const fs::path& file) { return io::load_raw_calibration(file); }>("calib.yaml",
                                                                                           bytes);
}
std::vector<std::string> raw_calibrations() {
  std::vector<std::string> all = calibrations();
  all.emplace_back(
      "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n"
      "K1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n"
      "D1: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [0.1, 0, 0, 0, 0]\n"
      "K2: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [500, 0, 320, 0, 500, 240, 0, 0, 1]\n"
      "D2: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [0.1, 0, 0, 0, 0]\n"
      "R: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
      "T: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [-0.1, 0, 0]\n");
  return all;
}

bool configuration(std::string_view bytes) {
  const fs::path file = written("config.yaml", bytes);
  return is_taken([&] {
    Config config;
    io::load_config(file, config);
    validate(config);
  });
}
std::vector<std::string> configurations() {
  return {io::config_yaml(Config{}), "preset: paper\nmatch:\n  window_size: 9\nleft_right.max_diff: -1\n",
          "match: {window_size: 9, method: window}\n", "preset: default\n? [a, b]\n: &x {y: *x}\n"};
}

// ---- results ----

bool objects(std::string_view bytes) {
  return read_file_of<[](const fs::path& file) { return output::load_confidences(file); }>("objects.json",
                                                                                           bytes);
}
std::vector<std::string> objects_files() {
  return {R"({"schema": "1.1", "objects": [{"id": 1, "confidence": 0.5}, {"id": 2, "confidence": 1}]})",
          R"({"objects": [{"id": 2e128, "confidence": 0.5}]})", R"([[[[[[[[[[[[]]]]]]]]]]]])"};
}

bool run_lengths(std::string_view bytes) {
  if (bytes.size() < 2) return false;
  io::Rle rle;
  rle.size = {static_cast<unsigned char>(bytes[0]) % 64 + 1, static_cast<unsigned char>(bytes[1]) % 64 + 1};
  rle.counts = bytes.substr(2);
  return is_taken([&] {
    const Image<std::uint8_t> mask = io::decode_rle(rle);
    if (mask.size() != rle.size) throw std::logic_error("a mask of another size");
  });
}
std::vector<std::string> run_length_texts() {
  const std::string size{3, 3};
  return {size + io::counts_to_text({16}), size + io::counts_to_text({3, 5, 8}),
          size + io::counts_to_text({0, 16})};
}

// ---- folders ----

/// A path inside its folder; nullopt otherwise.
std::optional<fs::path> inner_path(std::string_view text) {
  constexpr std::string_view kKnown = "abcdefghijklmnopqrstuvwxyzDEGILNT0123456789_-./";
  const fs::path path = text;
  if (text.empty() || text.size() > 60 || !path.has_filename() || path.is_absolute() ||
      text.find_first_not_of(kKnown) != std::string_view::npos)
    return std::nullopt;
  for (const fs::path& part : path) {
    if (part == ".." || part == ".") return std::nullopt;
  }
  return path;
}

/// Lines of "PATH=CONTENT": data-set layouts, of which only names are examined first.
bool dataset(std::string_view bytes) {
  const Place place;
  for (int files = 0; files < 24 && !bytes.empty(); ++files) {
    std::string_view line = taken_until('\n', bytes);
    const std::optional<fs::path> path = inner_path(taken_until('=', line));
    // A file may be in the place of a folder.
    (void)is_taken([&] {
      if (!path) return;
      io::make_folder((place.path() / *path).parent_path());
      io::write_file(place.path() / *path, line);
    });
  }
  std::vector<io::FrameFiles> frames;
  bool taken = is_taken([&] { frames = io::find_frames(place.path()); });
  taken |= is_taken([&] { (void)io::find_frames(place.path(), io::Cameras::raw); });
  taken |= is_taken([&] { (void)io::find_pairs(place.path()); });
  taken |= is_taken([&] { (void)io::find_truth(place.path()); });
  for (const io::FrameFiles& frame : frames) (void)is_taken([&] { (void)io::find_truth(frame); });
  taken |= is_taken([&] { (void)input::open_sequence(place.path().string(), {}); });
  return taken;
}
std::vector<std::string> datasets() {
  const std::string grey = "=P2 2 2 255 0 10 20 30\n";
  return {"left.pgm" + grey + "right.pgm" + grey + "calib.txt=focal_px: 500\nobjects.png=\ndisp_left.pfm=\n",
          "a/left.pgm" + grey + "a/right.pgm" + grey + "b/left.pgm" + grey + "b/right.pgm" + grey +
              "gt/calib.txt=\nstamps.txt=0.5\n",
          "left01.pgm" + grey + "right01.pgm" + grey + "left02.pgm" + grey + "right02.pgm" + grey,
          "scene/im0.png=\nscene/im1.png=\nscene/disp0GT.pfm=\nscene/mask0nocc.png=\nscene/calib.txt=\n",
          "image_2/000000_10.png=\nimage_3/000000_10.png=\ncalib/000000.txt=\ndisp_occ_0/000000_10.png=\n"
          "disp_noc_0/000000_10.png=\n",
          "image_0/000000.png" + grey + "image_1/000000.png" + grey + "times.txt=0.0\ncalib.txt=P0: 1\n",
          "mav0/cam0/data/1.png" + grey + "mav0/cam1/data/1.png" + grey +
              "mav0/cam0/sensor.yaml=resolution: [2, 2]\nmav0/cam1/sensor.yaml=\n"};
}

// ---- sequences ----

bool stamps(std::string_view bytes) {
  const fs::path file = written("stamps.txt", bytes);
  bool taken = is_taken([&] { (void)load_stamps(file); });
  taken |= is_taken([&] { (void)load_named_stamps(file); });
  taken |= is_taken([&] { (void)load_frame_stamps(file); });
  return taken;
}
std::vector<std::string> stamp_files() {
  return {"0.0\n0.1\n0.2\n", "1403715274312143104\n1403715274362142976\n",
          "2011-09-26 13:02:25.964389445\n2011-09-26 13:02:26.064389445\n",
          "#timestamp [ns],filename\n1403715274312143104,a.png\n", "frame,t_s\n0,0.0\n1,0.1\n"};
}

bool trajectory(std::string_view bytes) {
  const fs::path file = written("poses.txt", bytes);
  bool taken = is_taken([&] { (void)output::load_trajectory(file); });
  taken |= is_taken([&] { (void)output::load_pose(file); });
  return taken;
}
std::vector<std::string> trajectories() {
  return {"0.0 0 0 0 0 0 0 1\n0.1 1 0 0 0 0 0 1\n", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n",
          "#timestamp,x,y,z,qw,qx,qy,qz\n100,0,0,0,1,0,0,0\n200,1,0,0,1,0,0,0\n",
          "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"};
}

bool priors(std::string_view bytes) {
  const fs::path file = written("odometry.csv", bytes);
  bool taken = is_taken([&] {
    const auto all = input::load_odometry(file);
    (void)all->between(all->first(), all->last());
  });
  taken |= is_taken([&] {
    const auto all = input::load_imu(file);
    (void)all->between(all->first(), all->last());
  });
  return taken;
}
std::vector<std::string> prior_files() {
  return {"t_s,v_m_per_s,omega_rad_per_s\n0,0.5,0\n0.1,0.5,0.1\n0.2,0.5,0.1\n",
          "# base_link\n0.0 0 0 0 0 0 0 1\n0.1 0.1 0 0 0 0 0 1\n",
          "#timestamp,wx,wy,wz,ax,ay,az\n1000000,0,0,0.1,0,0,9.8\n2000000,0,0,0.1,0,0,9.8\n"};
}

bool scans(std::string_view bytes) {
  return read_file_of<[](const fs::path& file) { return input::load_scans(file); }>("scans.csv", bytes);
}
std::vector<std::string> scan_files() {
  return {"t_s,angle_min,angle_increment,r0,r1,r2\n0.0,-0.1,0.1,1.0,2.0,nan\n0.1,-0.1,0.1,1.0,2.0,3.0\n"};
}

bool tracks(std::string_view bytes) {
  const fs::path file = written("tracks.jsonl", bytes);
  bool taken = is_taken([&] { (void)output::load_tracks(file); });
  taken |= is_taken([&] { (void)output::load_mots(file); });
  taken |= is_taken([&] { (void)output::load_changes(file); });
  return taken;
}
std::vector<std::string> track_lines() {
  return {
      R"({"frame": 0, "stamp_ns": 0, "size": [4, 4], "tracks": [{"id": 1, "mask": {"size": [4, 4], "counts": "052"}}]})"
      "\n",
      "0 1 2 4 4 052\n1 1 2 4 4 052\n",
      R"({"frame": 3, "stamp_ns": 5, "kind": "moved", "landmark": 1, "to_m": [0, 0, 0], "from_m": [1, 0, 0]})"
      "\n"};
}

bool json(std::string_view bytes) {
  return is_taken([&] { (void)output::parsed_json(std::string(bytes)); });
}

bool frame_range(std::string_view bytes) {
  return is_taken([&] { (void)input::parse_frame_range(bytes); });
}

bool map_file(std::string_view bytes) {
  return read_file_of<[](const fs::path& file) { return MapFile::open(file, MapMode::read_only).load(); }>(
      "map.db", bytes);
}
std::vector<std::string> map_files() {
  const Place place;
  const fs::path path = place.path() / "made.db";
  {
    MapFile map = MapFile::open(path, MapMode::update);
    (void)map.begin_run("a source", Stamp{1});
    LandmarkMap none;
    map.end_run(RunState::done, none);
  }
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return {bytes.str()};
}

// ---- live inputs ----

template <class M>
bool message(std::span<const std::uint8_t> bytes) {
  return is_taken([&] { (void)ros::decode<M>(bytes); });
}

bool messages(std::string_view bytes) {
  const std::span<const std::uint8_t> all(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  bool taken = message<ros::Image>(all);
  taken |= message<ros::CompressedImage>(all);
  taken |= message<ros::CameraInfo>(all);
  taken |= message<ros::DisparityImage>(all);
  taken |= message<ros::Detection3DArray>(all);
  taken |= message<ros::PointCloud2>(all);
  taken |= message<ros::OccupancyGrid>(all);
  taken |= message<ros::TFMessage>(all);
  return taken;
}
std::vector<std::string> message_bytes() {
  const auto text = [](const ros::Bytes& bytes) { return std::string(bytes.begin(), bytes.end()); };
  const ros::Header header = ros::header_of(Stamp{1'500'000'000}, "camera");
  Image<Gray> image({3, 2});
  image.fill(7);
  const StereoRig rig{500, 1, 1, 0.1F, 0};
  return {text(ros::encode(ros::image_of(header, image))),
          text(ros::encode(ros::camera_info_of(header, rig, {3, 2}, ros::Side::right))),
          text(ros::encode(ros::Detection3DArray{})), text(ros::encode(ros::TFMessage{}))};
}

/// Rows of another robot, one after the other: a letter for the type, four bytes of length, and the bytes.
bool fleet_rows(std::string_view bytes) {
  fleet::FleetBook book;
  bool taken = false;
  const auto take = [&]<class Row>(const Row*, std::string_view row) {
    taken |= is_taken([&] {
      (void)book.add(ros::decode<Row>({reinterpret_cast<const std::uint8_t*>(row.data()), row.size()}));
    });
  };
  while (bytes.size() >= 5) {
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 1, sizeof length);
    const char type = bytes[0];
    const std::string_view row = bytes.substr(5, length);
    bytes.remove_prefix(5 + row.size());
    if (type == 'l') take(static_cast<fleet::LandmarkRow*>(nullptr), row);
    if (type == 'f') take(static_cast<fleet::FloorRow*>(nullptr), row);
    if (type == 'i') take(static_cast<fleet::IndexRow*>(nullptr), row);
    if (type == 'a')
      taken |= is_taken([&] {
        (void)ros::decode<fleet::AgentRow>({reinterpret_cast<const std::uint8_t*>(row.data()), row.size()});
      });
  }
  const fleet::SharedMap shared = fleet::share(book.maps(), book.placements(), book.ids(), LandmarksConfig{});
  book.set_ids(shared.ids);
  book.set_places(shared.robots);
  std::map<std::string, std::string> kept;
  const auto changes = book.changes();
  for (const auto& [key, value] : changes) kept[key] = value.value_or("");
  (void)fleet::FleetBook(kept);
  // Whatever was taken can be written, and read again.
  static const Place place;
  const fs::path path = place.path() / "fleet.db";
  fs::remove(path);
  MapFile file = MapFile::open(path, MapMode::update);
  file.keep(changes, shared.map);
  file.keep({}, shared.map);
  if (file.load().list.size() != shared.map.list.size()) std::abort();
  return taken;
}
std::vector<std::string> fleet_row_bytes() {
  std::string rows;
  const auto add = [&](char type, const auto& row) {
    const ros::Bytes bytes = ros::encode(row);
    const auto length = static_cast<std::uint32_t>(bytes.size());
    rows += type + std::string(reinterpret_cast<const char*>(&length), sizeof length) +
            std::string(bytes.begin(), bytes.end());
  };
  for (const std::uint8_t map : {std::uint8_t{1}, std::uint8_t{2}}) {
    const fleet::RobotKey robot{{map}, "a"};
    for (const std::int64_t id : {1, 2, 3, 4}) {
      Landmark landmark;
      landmark.id = LandmarkId{id};
      landmark.position_m = {static_cast<double>(id * id), static_cast<double>(id % 3), 0.2};
      landmark.covariance_m2 = {0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01};
      landmark.size = {0.2, 0.3, 0.4};
      landmark.looks.resize(1);
      landmark.looks[0].colours[static_cast<std::size_t>(id)] = 1;
      landmark.looks[0].colours[static_cast<std::size_t>(20 + id)] = 1;
      add('l', fleet::row_of(landmark, robot, 2));
    }
    add('f', fleet::rows_of({{1, 2, 7}, {-9, 0, 3}}, robot, 2)[0]);
    fleet::IndexRow index;
    index.map_id = robot.map_id;
    index.robot = fleet::bytes_of("a");
    index.version = 2;
    index.landmarks = {1, 2, 3, 4};
    add('i', index);
  }
  add('a', fleet::AgentRow{});
  return {rows};
}

bool recording(std::string_view bytes) {
  if (!ros::has_mcap()) return true;
  const fs::path file = written("run.mcap", bytes);
  return is_taken([&] {
    ros::McapReader reader(file);
    while (reader.next()) continue;
    (void)ros::attachment_of(reader, "config.yaml");
    (void)input::open_sequence(file.string(), {});
  });
}
std::vector<std::string> recordings() {
  if (!ros::has_mcap()) return {"-"};
  std::vector<std::string> all;
  for (const bool compress : {true, false}) {
    const Place place;
    const fs::path path = place.path() / "made.mcap";
    {
      ros::McapOptions options;
      options.compress = compress;
      ros::McapWriter writer(path, options);
      const std::uint16_t left = writer.channel("/stereo/left/image_rect", "sensor_msgs/msg/Image", "x");
      const std::uint16_t right = writer.channel("/stereo/right/image_rect", "sensor_msgs/msg/Image", "x");
      Image<Gray> image({4, 3});
      image.fill(9);
      for (int k = 0; k < 2; ++k) {
        const Stamp stamp{k * 100'000'000};
        const ros::Bytes bytes = ros::encode(ros::image_of(ros::header_of(stamp, "camera"), image));
        writer.message(left, stamp, bytes);
        writer.message(right, stamp, bytes);
      }
      writer.attachment("config.yaml", "text/yaml", "preset: default\n");
      writer.close();
    }
    std::ifstream file(path, std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    all.push_back(bytes.str());
  }
  return all;
}

/// "METHOD TARGET
/// HOST
/// ORIGIN
/// COOKIE": without the token, access must be refused.
bool request(std::string_view bytes) {
  static const live::Access access([] {
    live::ViewOptions options;
    options.token = "a-token-of-the-fuzzer";
    return options;
  }());
  std::string_view rest = bytes;
  std::string_view line = taken_until('\n', rest);
  live::ViewRequest view_request;
  view_request.method = taken_until(' ', line);
  view_request.target = line;
  view_request.host = taken_until('\n', rest);
  view_request.origin = taken_until('\n', rest);
  view_request.cookie = taken_until('\n', rest);
  view_request.is_upgrade = bytes.size() % 2 == 0;
  const live::ViewVerdict verdict = access.judge(view_request);
  if (verdict.status < 400 && bytes.find("a-token-of-the-fuzzer") == std::string_view::npos)
    throw std::logic_error("seen without the token");
  return verdict.status < 400;
}
std::vector<std::string> requests() {
  return {"GET /?token=a-token-of-the-fuzzer\n127.0.0.1:8765\n\n\n",
          "GET /status.json\nlocalhost:8765\n\ncairn_token=a-token-of-the-fuzzer\n",
          "GET /\n127.0.0.1:8765\nhttp://evil.example\n\n"};
}

/// Requests of a viewer to set options.
bool parameters(std::string_view bytes) {
  return is_taken([&] {
    const std::optional<nlohmann::json> list = output::parsed_json(std::string(bytes));
    if (!list) throw Error("no JSON");
    auto config = std::make_shared<FollowConfig>();
    live::ViewedRun run;
    run.config = [&] { return config; };
    run.set = [&](const auto& options) {
      FollowConfig changed = *config;
      for (const auto& [name, value] : options) set(changed, name, value);
      validate(changed);
      *config = changed;
    };
    live::Parameters all(run, true);
    all.set(*list);
    (void)all.values(all.take_changes()).dump();
  });
}
std::vector<std::string> parameter_lists() {
  return {
      R"([{"name": "objects.min_confidence", "value": 0.5}, {"name": "match.method", "value": "window"}])",
      R"([{"name": "tracking.min_hits"}])", R"([{"name": "match.num_disparities", "value": 1e300}])"};
}

// ---- the method ----

/// Reads numbers from bytes; zeros at the end.
class Numbers {
 public:
  explicit Numbers(std::string_view bytes) : bytes_(bytes) {}
  unsigned next() {
    if (bytes_.empty()) return 0;
    const auto value = static_cast<unsigned char>(bytes_.front());
    bytes_.remove_prefix(1);
    return value;
  }
  [[nodiscard]] std::string_view rest() const { return bytes_; }

 private:
  std::string_view bytes_;
};

/// A value for an option: one of the choices, or a number inside or outside its range.
std::string value_for(const OptionInfo& option, unsigned a, unsigned b) {
  if (option.type == "bool") return a % 2 == 0 ? "true" : "false";
  if (option.type == "choice") {
    std::vector<std::string> choices;
    std::istringstream domain(option.domain);
    for (std::string choice; std::getline(domain, choice, '|');) choices.push_back(choice);
    return choices.empty() ? option.value : choices[a % choices.size()];
  }
  const double scale[] = {1, 0.1, 0.01, 10, -1, 1e6, 1e30, 0.001};
  std::ostringstream text;
  if (option.type == "int") {
    text << static_cast<int>(a) - static_cast<int>(b % 4);
  } else {
    text << a * scale[b % 8];
  }
  return text.str();
}

/// Sets options from bytes; refused ones keep their value.
FollowConfig config_of(Numbers& numbers) {
  FollowConfig config;
  if (numbers.next() % 2 == 1) config.segmentation = Config::paper();
  config.segmentation.match.num_disparities = 16;
  for (unsigned left = numbers.next() % 8; left > 0; --left) {
    const std::vector<OptionInfo> all = options(config);
    const OptionInfo& option = all[(numbers.next() * 256 + numbers.next()) % all.size()];
    const unsigned a = numbers.next();
    const unsigned b = numbers.next();
    FollowConfig changed = config;
    if (is_taken([&] {
          set(changed, option.name, value_for(option, a, b));
          validate(changed);
        }))
      config = changed;
  }
  return config;
}

struct ImagePair {
  Image<Gray> left;
  Image<Gray> right;
  Image<Rgb> colours;
};

ImagePair image_pair_of(Numbers& numbers, Size size) {
  ImagePair all{Image<Gray>(size), Image<Gray>(size), Image<Rgb>(size)};
  const unsigned shift = numbers.next() % 8;
  const std::string_view rest = numbers.rest();
  const auto at = [&](std::size_t i) {
    return rest.empty() ? Gray{128} : static_cast<Gray>(static_cast<unsigned char>(rest[i % rest.size()]));
  };
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const auto i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) + static_cast<std::size_t>(x);
      all.left(x, y) = at(i);
      all.right(x, y) = at(i + shift);
      all.colours(x, y) = {at(i), at(i + 1), at(i + 2)};
    }
  }
  return all;
}

std::optional<StereoRig> rig_of(unsigned number) {
  if (number % 3 == 0) return std::nullopt;
  return StereoRig{static_cast<float>(number), 10, 8, 0.1F, number % 2 == 0 ? 0.0F : 3.0F};
}

bool method(std::string_view bytes) {
  Numbers numbers(bytes);
  const FollowConfig config = config_of(numbers);
  const Size size{static_cast<int>(numbers.next() % 48) + 1, static_cast<int>(numbers.next() % 48) + 1};
  const std::optional<StereoRig> rig = rig_of(numbers.next());
  const bool in_colour = numbers.next() % 2 == 0;
  const ImagePair images = image_pair_of(numbers, size);
  return is_taken([&] {
    const StereoPair pair = in_colour ? StereoPair::from(images.left, images.right, images.colours)
                                      : StereoPair::from(images.left, images.right);
    const Frame frame = segment(pair, rig, config.segmentation, {});
    if (frame.objects.labels.size() != size) throw std::logic_error("labels of another size");
    Follower follower(config, rig);
    for (int k = 0; k < 3; ++k) (void)follower.next(pair, Stamp{k * 100'000'000});
  });
}
std::vector<std::string> method_inputs() {
  std::vector<std::string> all;
  for (const char preset : {'\0', '\1'}) {
    std::string input{preset, 1, 0, 7, 9, 0, 40, 30, 100, 0, 3};
    for (int i = 0; i < 600; ++i) input += static_cast<char>((i * i * 31 + i * 7) % 251);
    all.push_back(input);
  }
  return all;
}

std::vector<std::string> ranges() {
  return {"10:60:2", "::2", "7", "1:"};
}
std::vector<std::string> json_texts() {
  return {R"({"a": [1, 2.5e3, "\u00e4", null, true]})", "[[[[]]]]"};
}

}  // namespace

const std::vector<Target>& targets() {
  static const std::vector<Target> all{
      {"picture", picture, images},
      {"labels", labels, images},
      {"disparity", disparity, disparities},
      {"calibration", calibration, calibrations},
      {"raw_calibration", raw_calibration, raw_calibrations},
      {"config", configuration, configurations},
      {"objects", objects, objects_files},
      {"rle", run_lengths, run_length_texts},
      {"dataset", dataset, datasets},
      {"json", json, json_texts},
      {"frames", frame_range, ranges},
      {"stamps", stamps, stamp_files},
      {"trajectory", trajectory, trajectories},
      {"priors", priors, prior_files},
      {"scans", scans, scan_files},
      {"tracks", tracks, track_lines},
      {"map", map_file, map_files},
      {"messages", messages, message_bytes},
      {"fleet_rows", fleet_rows, fleet_row_bytes},
      {"recording", recording, recordings},
      {"request", request, requests},
      {"parameters", parameters, parameter_lists},
      {"method", method, method_inputs},
  };
  return all;
}

}  // namespace cairn::fuzz
