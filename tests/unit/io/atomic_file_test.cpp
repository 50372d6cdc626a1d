// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <cairn/io/atomic_file.hpp>
#include <cairn/io/read_file.hpp>
#include <thread>

#include "support/temporary_folder.hpp"

namespace cairn {
namespace {

namespace fs = std::filesystem;
using support::bytes_of;
using support::has;
using support::refusal;
using support::TemporaryFolder;

std::ptrdiff_t entries(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), {});
}

TEST(AtomicFile, WritesAllBytesAndLeavesNoOtherFile) {
  const TemporaryFolder folder;
  const std::string bytes("a\0b\n\xff", 5);
  io::write_file(folder.path() / "out.bin", bytes);
  EXPECT_EQ(bytes_of(folder.path() / "out.bin"), bytes);
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(AtomicFile, ReplacesAnOldFile) {
  const TemporaryFolder folder;
  const fs::path path = folder.with("out.txt", "old and longer");
  io::write_file(path, "new");
  EXPECT_EQ(bytes_of(path), "new");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(AtomicFile, CreatesFilesWithThePermissionsOfTheUmask) {
  const TemporaryFolder folder;
  io::write_file(folder.path() / "ours", "");
  const fs::path usual = folder.with("usual", "");
  EXPECT_EQ(fs::status(folder.path() / "ours").permissions(), fs::status(usual).permissions());
}

TEST(AtomicFile, RefusesAMissingFolder) {
  const TemporaryFolder folder;
  const std::string message = refusal([&] { io::write_file(folder.path() / "none" / "out.txt", "x"); });
  EXPECT_TRUE(has(message, {"out.txt", "No such file"}));
  EXPECT_EQ(entries(folder.path()), 0);
}

TEST(AtomicFile, RefusesAFolderAsTarget) {
  const TemporaryFolder folder;
  fs::create_directory(folder.path() / "out");
  EXPECT_TRUE(has(refusal([&] { io::write_file(folder.path() / "out", "x"); }), {"out", "directory"}));
  EXPECT_TRUE(has(refusal([&] { io::write_file(folder.path() / "out/", "x"); }), {"out", "directory"}));
  refusal([&] { io::write_file("", "x"); });
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(AtomicFile, RefusesAFileInPlaceOfTheFolder) {
  const TemporaryFolder folder;
  const fs::path file = folder.with("file", "");
  refusal([&] { io::write_file(file / "out.txt", "x"); });
  EXPECT_TRUE(has(refusal([&] { io::make_folder(file / "deep"); }), {"file"}));
  EXPECT_TRUE(has(refusal([&] { io::make_folder(file); }), {"file"}));
}

TEST(AtomicFile, FollowsASymbolicLink) {
  const TemporaryFolder folder;
  const fs::path target = folder.with("target", "old");
  fs::create_symlink(target, folder.path() / "link");
  io::write_file(folder.path() / "link", "new");
  EXPECT_EQ(bytes_of(target), "new");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "link"));
}

TEST(AtomicFile, WritesToADeviceWithoutReplacingIt) {
  io::write_file("/dev/null", "x");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  if (fs::exists("/dev/full")) {
    EXPECT_TRUE(has(refusal([] { io::write_file("/dev/full", "x"); }), {"/dev/full", "No space"}));
  }
}

TEST(AtomicFile, AGrowingFileGetsItsNameWhenComplete) {
  const TemporaryFolder folder;
  const fs::path path = folder.with("out.txt", "old");
  {
    io::GrowingFile file(path);
    file.append("new ");
    EXPECT_EQ(bytes_of(path), "old");
    file.append("and whole");
    EXPECT_EQ(bytes_of(path), "old");
    file.finish();
    EXPECT_EQ(bytes_of(path), "new and whole");
  }
  EXPECT_EQ(bytes_of(path), "new and whole");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(AtomicFile, AnUnfinishedFileLeavesNoTrace) {
  const TemporaryFolder folder;
  const fs::path path = folder.with("out.txt", "old");
  {
    io::GrowingFile file(path);
    file.append("half");
    io::GrowingFile moved = std::move(file);
    moved.append(" of it");
  }
  EXPECT_EQ(bytes_of(path), "old");
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(AtomicFile, ManyWritersOfOneFileLeaveOneCompleteFile) {
  const TemporaryFolder folder;
  std::vector<std::thread> writers;
  writers.reserve(4);
  for (int i = 0; i < 4; ++i) {
    writers.emplace_back([&, i] {
      for (int k = 0; k < 20; ++k)
        io::write_file(folder.path() / "out", std::string(10000, static_cast<char>('a' + i)));
    });
  }
  for (std::thread& writer : writers) writer.join();
  const std::string bytes = bytes_of(folder.path() / "out");
  EXPECT_EQ(bytes, std::string(10000, bytes.at(0)));
  EXPECT_EQ(entries(folder.path()), 1);
}

TEST(AtomicFile, CreatesFoldersWithParentsAndAcceptsExistingOnes) {
  const TemporaryFolder folder;
  io::make_folder(folder.path() / "a" / "b" / "c");
  io::make_folder(folder.path() / "a" / "b" / "c");
  EXPECT_TRUE(fs::is_directory(folder.path() / "a" / "b" / "c"));
}

TEST(ReadFile, ReadsAFile) {
  const TemporaryFolder folder;
  const std::string bytes = std::string(100000, 'x') + '\0' + "end";
  EXPECT_EQ(io::read_file(folder.with("in", bytes), 1 << 20), bytes);
  EXPECT_EQ(io::read_file(folder.with("empty", ""), 10), "");
  EXPECT_FALSE(io::read_file("/proc/self/status", 1 << 20).empty()) << "a file that tells no length";
}

TEST(ReadFile, RefusesMissingFilesFoldersAndTooLongFiles) {
  const TemporaryFolder folder;
  EXPECT_TRUE(has(refusal([&] { io::read_file(folder.path() / "none", 10); }), {"none", "No such file"}));
  EXPECT_TRUE(has(refusal([&] { io::read_file(folder.path(), 10); }), {"is a folder"}));
  EXPECT_EQ(io::read_file(folder.with("in", "0123456789"), 10).size(), 10U);
  EXPECT_TRUE(
      has(refusal([&] { io::read_file(folder.with("in", "0123456789a"), 10); }), {"more than 10 bytes"}));
  EXPECT_TRUE(has(refusal([] { io::read_file("/dev/zero", 1000); }), {"/dev/zero", "more than 1000"}));
}

}  // namespace
}  // namespace cairn
