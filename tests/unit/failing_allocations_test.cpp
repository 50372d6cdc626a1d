// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cairn/core/error.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/io/disparity_files.hpp>
#include <cairn/io/point_cloud.hpp>
#include <cairn/io/raster.hpp>
#include <cairn/output/results.hpp>
#include <cairn/output/web/html_page.hpp>
#include <cairn/pipeline/segment.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <fuzz/targets.hpp>
#include <new>
#include <random>
#include <set>
#include <support/failing_allocations.hpp>
#include <support/temporary_folder.hpp>

/// Fails every allocation in turn: the result is bad_alloc (or what a library throws instead), never an
/// Error, which would blame the input; nothing leaks, no partial file remains, and the next call works.
namespace cairn {

namespace fuzz {
static void PrintTo(const Target& target, std::ostream* out) {
  *out << target.name;
}
}  // namespace fuzz

namespace {

namespace fs = std::filesystem;
using support::FailingAllocations;
using Those = FailingAllocations::Those;

struct Attempt {
  enum Outcome { done, no_memory, blamed_the_input, ended } outcome = done;
  bool has_failed = false;  // an allocation
  std::int64_t living = 0;  // allocations that were not freed
  std::string says;
};

Attempt attempt(const std::function<bool()>& work, int number, Those those) {
  Attempt result;
  const FailingAllocations failing(number, those);
  try {
    if (!work()) result.outcome = Attempt::blamed_the_input;
    result.has_failed = FailingAllocations::end();
    result.living = FailingAllocations::living();
    return result;
  } catch (const Error& error) {
    result.has_failed = FailingAllocations::end();
    result.outcome = Attempt::blamed_the_input;
    result.says = error.what();
    return result;
  } catch (const std::exception&) {
    result.has_failed = FailingAllocations::end();
    result.outcome = Attempt::no_memory;
  }
  result.living = FailingAllocations::living();  // excluding the exception itself
  return result;
}

/// Shared between the trying process and the waiting one.
struct Tally {
  int number = 0;  // of the next allocation to fail
  int failed = 0;  // allocations that failed
  int ended = 0;   // processes that ended inside a destructor
};

constexpr int kEndedInDestructor = 86;

[[noreturn]] void end_quietly() {
  try {
    if (const std::exception_ptr why = std::current_exception()) std::rethrow_exception(why);
  } catch (const std::bad_alloc&) {
    ::_exit(kEndedInDestructor);
  } catch (...) {
    std::fputs("terminated by another exception\n", stderr);
    std::abort();
  }
  ::_exit(kEndedInDestructor);
}

struct Trial {
  std::function<bool()> work;                     // false: bad input
  std::function<void(const Attempt&)> look = {};  // checks the state after an attempt
  /// nlohmann's values are made in it: their destructor allocates and asserts, so that the program ends where
  /// memory does, and what their constructors hold leaks. Or libstdc++ lists a folder, which throws nothing.
  bool may_end = false;
  bool may_leak = false;  // OpenCV 4.6's filters do: an image of sepFilter2D() where memory ends in it
};

constexpr int kDense = 200;  // up to this number every allocation fails, then only some

/// In a process of its own: fails allocations from tally.number on, until `work` needs no more.
[[noreturn]] void try_from(Tally& tally, const Trial& trial, Those those) {
  std::set_terminate(end_quietly);
  for (;;) {
    const int number = tally.number;
    tally.number += 1 + (number < kDense ? 0 : number / 32);
    const Attempt first =
        attempt(trial.work, number, those);  // makes the allocations that happen once per process
    if (trial.look) trial.look(first);
    const Attempt again = attempt(trial.work, number, those);
    const std::string where = "allocation " + std::to_string(number) +
                              (those == Those::one ? "" : " and all that follow") + ": " + again.says;
    EXPECT_NE(again.outcome, Attempt::blamed_the_input) << where;
    EXPECT_FALSE(again.outcome == Attempt::no_memory && again.living != 0 && !trial.may_end &&
                 !trial.may_leak)
        << where << again.living << " allocations leak";
    if (trial.look) trial.look(again);
    if (testing::Test::HasFailure()) break;
    if (!again.has_failed) ::_exit(0);
    ++tally.failed;
  }
  std::fflush(nullptr);
  ::_exit(1);
}

/// Fails each allocation of `trial.work` alone, and together with all later ones; returns how many failed.
int fail_each(const Trial& trial) {
  EXPECT_TRUE(trial.work());
  if (trial.look) trial.look({});
  void* const shared =
      ::mmap(nullptr, sizeof(Tally), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) throw std::bad_alloc();
  Tally& tally = *new (shared) Tally;
  for (const Those those : {Those::one, Those::all_after}) {
    tally.number = 0;
    int status = -1;
    bool has_ended = false;
    do {
      std::fflush(nullptr);
      const pid_t child = ::fork();
      if (child == 0) try_from(tally, trial, those);
      ::waitpid(child, &status, 0);
      has_ended = trial.may_end && ((WIFEXITED(status) && WEXITSTATUS(status) == kEndedInDestructor) ||
                                    (WIFSIGNALED(status) && WTERMSIG(status) == SIGABRT));
      if (has_ended) {
        ++tally.ended;
        Attempt broken;
        broken.outcome = Attempt::ended;
        if (trial.look) trial.look(broken);
      }
    } while (has_ended);
    EXPECT_EQ(status, 0) << "before allocation " << tally.number;
  }
  const int failed = tally.failed;
  ::munmap(shared, sizeof(Tally));
  return failed;
}

// ---- reading, and the method ----

class ReadWithoutMemory : public testing::TestWithParam<fuzz::Target> {};

TEST_P(ReadWithoutMemory, EndsInBadAlloc) {
  const bool may_end =
      std::set<std::string>{"objects", "tracks", "json", "parameters", "dataset"}.contains(GetParam().name);
  const bool may_leak = GetParam().name == std::string_view("method");
  int accepted = 0;
  int tried = 0;
  for (const std::string& seed : GetParam().seeds()) {
    if (!GetParam().run(seed)) continue;
    ++accepted;
    tried += fail_each({[&] { return GetParam().run(seed); }, {}, may_end, may_leak});
    ASSERT_FALSE(HasFailure()) << testing::PrintToString(seed.substr(0, 200));
  }
  EXPECT_GT(accepted, 0);
  RecordProperty("allocations", tried);
}

INSTANTIATE_TEST_SUITE_P(Everything, ReadWithoutMemory, testing::ValuesIn(fuzz::targets()),
                         [](const auto& one) { return std::string(one.param.name); });

// ---- writing ----

constexpr Size kSize{64, 48};

template <class T>
Image<T> noise(Size size) {
  std::mt19937 random(5);
  Image<T> image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) image(x, y) = static_cast<T>(random() % 256);
  }
  return image;
}

io::PixelRows rows_of(const Image<Gray>& image) {
  return {image.size(), 1, 1, image.row(0), static_cast<std::ptrdiff_t>(image.view().stride())};
}

TEST(EncodeWithoutMemory, PngEndsInBadAlloc) {
  const Image<Gray> image = noise<Gray>({300, 200});
  EXPECT_GT(
      fail_each({[&] { return io::decode_png(io::encode_png(rows_of(image)), {}).size == image.size(); }}),
      10);
}

/// Large enough for several buffers.
TEST(EncodeWithoutMemory, JpegEndsInBadAlloc) {
  const Image<Gray> image = noise<Gray>({900, 700});
  EXPECT_GT(
      fail_each({[&] { return io::decode_jpeg(io::encode_jpeg(rows_of(image))).size == image.size(); }}), 10);
}

struct Made {
  Image<Gray> left = noise<Gray>(kSize);
  output::Provenance provenance;
  Frame frame;
};

const Made& made() {
  static const Made kMade = [] {
    Made all;
    all.provenance.preset = "default";
    all.provenance.config.match.num_disparities = 16;
    all.provenance.rig = StereoRig{100, 32, 24, 0.1F, 0};
    all.frame = segment(StereoPair::from(all.left, all.left), all.provenance.rig, all.provenance.config, {});
    return all;
  }();
  return kMade;
}

/// `write` must create the given file or folder completely or not at all, and leave nothing next to it.
int fail_each_write(const char* name, const std::function<void(const fs::path&)>& write) {
  const support::TemporaryFolder folder;
  const fs::path path = folder.path() / name;
  const auto found = [&] {
    std::set<std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path()))
      all.insert(entry.path().string());
    return all;
  };
  write(path);
  const std::set<std::string> whole = found();
  return fail_each({[&] {
                      write(path);
                      return true;
                    },
                    [&](const Attempt& result) {
                      const std::set<std::string> now = found();
                      // Without memory a folder cannot be emptied: a hidden one may remain.
                      std::set<std::string> seen = now;
                      std::erase_if(seen, [](const std::string& one) {
                        return one.find("/.cairn-") != std::string::npos;
                      });
                      EXPECT_TRUE(seen == whole || (seen.empty() && result.outcome == Attempt::no_memory) ||
                                  result.outcome == Attempt::ended)
                          << testing::PrintToString(now);
                      for (const std::string& left : now) fs::remove_all(left);
                    },
                    true});
}

TEST(WriteWithoutMemory, AFolderOfResultsIsCompleteOrAbsent) {
  EXPECT_GT(fail_each_write("result",
                            [](const fs::path& path) {
                              output::write_result(path, made().left, {}, made().frame, made().provenance,
                                                   {true, true, true, true});
                            }),
            100);
}

TEST(WriteWithoutMemory, DisparitiesCloudsAndPagesAreCompleteOrAbsent) {
  EXPECT_GT(fail_each_write(
                "d.pfm",
                [](const fs::path& path) { io::save_disparity(path, made().frame.disparity.disparity_px); }),
            3);
  EXPECT_GT(fail_each_write("cloud.ply",
                            [](const fs::path& path) {
                              io::save_ply(path, made().left, {}, made().frame.disparity.disparity_px, {},
                                           *made().provenance.rig);
                            }),
            3);
  EXPECT_GT(
      fail_each(
          {[] {
             output::PageFrame page;
             page.left = made().left;
             page.disparity_px = made().frame.disparity.disparity_px;
             page.reject = made().frame.disparity.reject;
             page.objects = made().frame.objects.labels;
             page.objects_json = output::objects_json(made().frame, made().provenance);
             return !output::html_page({"segment", "a title", {}}, {output::encode_frame(page)}).empty();
           },
           {},
           true}),
      20);
  EXPECT_GT(fail_each({[] { return !io::config_yaml(Config{}).empty(); }}), 20);
}

}  // namespace
}  // namespace cairn
