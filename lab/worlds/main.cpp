// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// worlds frames FIRST LAST -o DIR: writes frames of worlds; worlds sheet FIRST LAST -o FILE.png: a contact sheet;
// worlds tours FIRST LAST -o DIR: sequences in which a thing is carried elsewhere; worlds yardstick -o DIR: the frames that choices are measured by (docs/worlds.md); worlds laboratory -o DIR: the paper's
// experiment made again (docs/paper.md).
#include <CLI/CLI.hpp>
#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/io/image_files.hpp>
#include <cstdio>
#include <exception>
#include <iostream>
#include <mutex>
#include <thread>

#include "lab/worlds/frames.hpp"
#include "lab/worlds/models.hpp"
#include "lab/worlds/tours.hpp"

namespace cairn::worlds {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  WorldOptions world;
  int first = 0;
  int last = 0;
  int samples = 4;
  int threads = 0;
  std::string size = "320x240";
  std::string use = "fit";
  std::string out;
  bool has_projector = false;
};

/// Calls `work` for each number from first to last, on all threads.
template <class Work>
void for_each_world(const Arguments& arguments, const Work& work) {
  std::atomic<int> next = arguments.first;
  std::mutex mutex;
  std::exception_ptr trouble;
  std::vector<std::jthread> threads;
  const int count = arguments.threads > 0
                        ? arguments.threads
                        : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  for (int t = 0; t < count; ++t) {
    threads.emplace_back([&] {
      try {
        for (int i = next++; i <= arguments.last; i = next++) work(i);
      } catch (...) {
        const std::lock_guard lock(mutex);
        trouble = std::current_exception();
        next = arguments.last + 1;
      }
    });
  }
  threads.clear();
  if (trouble) std::rethrow_exception(trouble);
}

std::string numbered(const char* format, int number) {
  std::array<char, 24> name{};
  std::snprintf(name.data(), name.size(), format, number);
  return name.data();
}

void write_frames(const Arguments& arguments) {
  fs::create_directories(arguments.out);
  for_each_world(arguments, [&](int i) {
    const fs::path folder = fs::path(arguments.out) / numbered("world_%05d", i);
    if (fs::exists(folder)) return;
    World world = make_world(arguments.world, i);
    world.scene.has_projector = arguments.has_projector;
    world.sensor.is_grey = world.sensor.is_grey || arguments.has_projector;
    write_frame(make_frame(std::move(world), arguments.samples), folder);
  });
}

void write_tours(const Arguments& arguments) {
  for (int index = arguments.first; index <= arguments.last; ++index) {
    const fs::path folder = fs::path(arguments.out) / numbered("tour_%03d", index);
    if (fs::exists(folder / "events.json")) continue;
    fs::create_directories(folder);
    const Tour tour = make_tour(arguments.world, index);
    Arguments of_frames = arguments;
    of_frames.first = 0;
    of_frames.last = static_cast<int>(tour.path.size()) - 1;
    for_each_world(of_frames, [&](int i) {
      const fs::path frame = folder / numbered("%03d", i);
      if (!fs::exists(frame)) write_frame(make_frame(world_of(tour, i), arguments.samples), frame);
    });
    write_tour_files(tour, folder);  // last: a folder with events.json is whole
  }
}

/// Never changes: its scores are compared over the years.
void write_yardstick(Arguments arguments) {
  const fs::path folder = arguments.out;
  const auto write = [&](const char* part, int count, std::uint64_t seed, Size size, double outdoor_share) {
    arguments.world = {.seed = seed, .use = Use::yardstick, .size = size, .outdoor_share = outdoor_share};
    arguments.out = folder / part;
    arguments.last = count - 1;
    write_frames(arguments);
  };
  write("indoors", 150, 4100, {320, 240}, 0);
  write("outdoors", 80, 4200, {320, 240}, 1);
  write("large", 60, 4300, {640, 480}, 0.35);
}

void write_laboratory(Arguments arguments) {
  for (int s = 0; s < kLaboratorySequences; ++s) {
    const fs::path folder = fs::path(arguments.out) / std::to_string(s);
    fs::create_directories(folder);
    arguments.last = kLaboratoryFrames - 1;
    for_each_world(arguments, [&](int i) {
      const fs::path frame = folder / numbered("%03d", i);
      if (!fs::exists(frame)) write_frame(make_frame(make_laboratory(s, i), arguments.samples), frame);
    });
  }
}

void draw_sheet(const Arguments& arguments) {
  constexpr int kColumns = 6, kGap = 4;
  constexpr std::array kColours{Rgb{80, 120, 230}, Rgb{230, 110, 70}, Rgb{70, 190, 90},  Rgb{220, 190, 60},
                                Rgb{170, 90, 200}, Rgb{60, 190, 200}, Rgb{220, 90, 140}, Rgb{140, 140, 90}};
  const Size size = arguments.world.size;
  const int count = arguments.last - arguments.first + 1, rows = (count + kColumns - 1) / kColumns;
  Image<Rgb> sheet({(size.width + kGap) * kColumns, (size.height + kGap) * 2 * rows}, Rgb{255, 255, 255}, {});
  for_each_world(arguments, [&](int i) {
    const WorldFrame frame = make_frame(make_world(arguments.world, i), arguments.samples);
    const int k = i - arguments.first, left = k % kColumns * (size.width + kGap),
              top = k / kColumns * 2 * (size.height + kGap);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) {
        sheet(left + x, top + y) = frame.left(x, y);
        const int id = frame.truth.ids(x, y);
        const std::uint8_t behind = frame.truth.ground(x, y) != 0 ? 60 : 25;
        sheet(left + x, top + size.height + y) =
            id > 0 ? kColours.at(static_cast<std::size_t>(id) % kColours.size())
                   : Rgb{behind, behind, behind};
      }
    }
  });
  io::save_png(arguments.out, View<const Rgb>(sheet));
}

int run(int argc, char** argv) {
  CLI::App app("Worlds for the fit: rendered stereo pairs with truth");
  app.require_subcommand(1);
  Arguments arguments;
  const auto declare = [&](const char* name, const char* help) {
    CLI::App* const command = app.add_subcommand(name, help);
    command->add_option("-o", arguments.out, "folder of frames, or PNG file of the sheet")->required();
    command->add_option("--threads", arguments.threads, "0: one per processor")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
    return command;
  };
  const auto declare_drawn = [&](const char* name, const char* help) {
    CLI::App* const command = declare(name, help);
    command->add_option("FIRST", arguments.first, "number of the first world")
        ->required()
        ->check(CLI::NonNegativeNumber);
    command->add_option("LAST", arguments.last, "number of the last one")
        ->required()
        ->check(CLI::NonNegativeNumber);
    command->add_option("--seed", arguments.world.seed, "another seed draws other worlds")
        ->capture_default_str();
    command->add_option("--use", arguments.use, "families and models: fit or yardstick")
        ->check(CLI::IsMember({"fit", "yardstick"}));
    command->add_option("--outdoor", arguments.world.outdoor_share, "share of worlds outdoors")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command->add_option("--size", arguments.size, "WIDTHxHEIGHT")->capture_default_str();
    command->add_option("--samples", arguments.samples, "rays per pixel, a square number")
        ->check(CLI::Range(1, 256))
        ->capture_default_str();
    return command;
  };
  CLI::App* const frames =
      declare_drawn("frames", "writes one folder per world; folders that exist are left as they are");
  frames->add_flag("--projector", arguments.has_projector,
                   "grey cameras and a projector of spots, with depth.png (mm) as of a depth camera");
  CLI::App* const yardstick = declare("yardstick", "writes the frames that choices are measured by");
  const CLI::App* const laboratory = declare("laboratory", "writes the four sequences of docs/paper.md");
  declare_drawn("sheet", "draws left images and ids");
  const CLI::App* const tours = declare_drawn(
      "tours",
      "writes one folder per tour: a robot looks at things twice, and one was carried elsewhere meanwhile");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "worlds: " << error.what() << "\n";
    return 2;
  }
  if (laboratory->parsed()) {
    write_laboratory(arguments);
    return 0;
  }
  if (yardstick->parsed()) {
    if (models_for(Use::yardstick).empty()) throw Error("the yardstick needs sweethome3d-furniture");
    write_yardstick(arguments);
    return 0;
  }
  Size& size = arguments.world.size;
  if (std::sscanf(arguments.size.c_str(), "%dx%d", &size.width, &size.height) != 2 ||
      std::min(size.width, size.height) < 16 || std::max(size.width, size.height) > 4096) {
    throw Error("--size " + arguments.size + ": expected WIDTHxHEIGHT, each side from 16 to 4096");
  }
  if (arguments.last < arguments.first) throw Error("LAST is less than FIRST");
  arguments.world.use = arguments.use == "fit" ? Use::fit : Use::yardstick;
  if (models_for(arguments.world.use).empty())
    std::cerr << "worlds: sweethome3d-furniture is not installed: families of shapes alone, no models\n";
  if (arguments.world.use == Use::fit && !tours->parsed() && !has_photographs())
    std::cerr << "worlds: lomiri-wallpapers-16.04 is not installed: no photographs\n";
  frames->parsed()  ? write_frames(arguments)
  : tours->parsed() ? write_tours(arguments)
                    : draw_sheet(arguments);
  return 0;
}

}  // namespace
}  // namespace cairn::worlds

int main(int argc, char** argv) {
  try {
    return cairn::worlds::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "worlds: " << error.what() << "\n";
    return 2;
  }
}
