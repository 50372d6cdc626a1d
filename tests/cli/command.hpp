// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cairn/core/image.hpp>
#include <cairn/io/image_files.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/temporary_folder.hpp"

/// The command as an external process, with arguments, exit code and output.
namespace cairn::command {

namespace fs = std::filesystem;

struct Outcome {
  int code = -1;  // of exit; 128 + signal if it was killed
  std::string out;
  std::string err;
};

inline std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

/// A temporary folder in which the command runs.
class CommandTest : public testing::Test {
 protected:
  CommandTest() { fs::create_directories(root_ / "work"); }

  /// Path of the test's inputs and outputs.
  [[nodiscard]] fs::path at(const std::string& name) const { return root_ / "work" / name; }
  [[nodiscard]] std::string path(const std::string& name) const { return at(name).string(); }
  /// Every file and folder in it.
  [[nodiscard]] std::set<std::string> everything() const {
    std::set<std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(root_ / "work"))
      all.insert(entry.path().string());
    return all;
  }

  /// `folder`: working folder, inside the test's own.
  [[nodiscard]] Outcome run(const std::vector<std::string>& arguments, const std::string& out = {},
                            const std::string& folder = {}) const {
    const std::string out_path = out.empty() ? (root_ / "out").string() : out;
    const std::string err_path = (root_ / "err").string();
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0644);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0644);
    posix_spawn_file_actions_addchdir_np(&files, (root_ / "work" / folder).c_str());
    std::vector<std::string> words{CAIRN_COMMAND};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    argv.reserve(words.size() + 1);
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_t child = 0;
    const int failed = posix_spawn(&child, CAIRN_COMMAND, &files, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&files);
    Outcome outcome;
    if (failed != 0) {
      ADD_FAILURE() << "cannot run " << CAIRN_COMMAND;
      return outcome;
    }
    int status = 0;
    waitpid(child, &status, 0);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    outcome.out = out.empty() ? content(out_path) : "";
    outcome.err = content(err_path);
    return outcome;
  }

  /// The command must refuse: exit code 2, nothing on stdout, one line on stderr that contains all these
  /// words, no new file.
  void refuses(const std::vector<std::string>& arguments, const std::vector<std::string>& words) const {
    const auto before = everything();
    const Outcome outcome = run(arguments);
    std::string line = "cairn";
    for (const std::string& argument : arguments) line += " " + argument;
    EXPECT_EQ(outcome.code, 2) << line << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "") << line;
    EXPECT_TRUE(outcome.err.starts_with("cairn: ")) << line << "\n" << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << line << "\n" << outcome.err;
    for (const std::string& word : words) {
      EXPECT_NE(outcome.err.find(word), std::string::npos) << line << "\n"
                                                           << outcome.err << "does not say " << word;
    }
    EXPECT_EQ(everything(), before) << line;
  }

  /// Writes left.png and right.png (random dots, 6 px apart) into a folder and returns their paths.
  std::vector<std::string> pair_in(const std::string& folder, Size size = {96, 72}) const {
    constexpr int kDisparity = 6;
    fs::create_directories(at(folder));
    std::mt19937 random(3);
    Image<Gray> left(size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) left(x, y) = static_cast<Gray>(random() % 256);
    }
    Image<Gray> right(size);
    for (int y = 0; y < size.height; ++y) {
      for (int x = 0; x < size.width; ++x) right(x, y) = left(std::min(x + kDisparity, size.width - 1), y);
    }
    io::save_png(at(folder) / "left.png", left.view());
    io::save_png(at(folder) / "right.png", right.view());
    return {path(folder + "/left.png"), path(folder + "/right.png")};
  }

  /// Arguments of a command on that pair.
  static std::vector<std::string> with(const std::string& command, std::vector<std::string> first,
                                       const std::vector<std::string>& then = {}) {
    first.insert(first.begin(), command);
    first.insert(first.end(), then.begin(), then.end());
    return first;
  }

 private:
  support::TemporaryFolder folder_;
  fs::path root_ = folder_.path();
};

/// A PFM file of these values, rows bottom-up, little endian.
inline std::string pfm(Size size, const std::vector<float>& values) {
  std::string bytes = "Pf\n" + std::to_string(size.width) + " " + std::to_string(size.height) + "\n-1.0\n";
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  return bytes;
}

}  // namespace cairn::command
