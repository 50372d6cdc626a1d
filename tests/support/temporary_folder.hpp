// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cairn/core/error.hpp>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <string_view>

namespace cairn::support {

/// A folder of the test, deleted with it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    // mkdtemp() replaces the six X.
    std::string name = (std::filesystem::temp_directory_path() / "cairn-test-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code unimportant;
    std::filesystem::remove_all(path_, unimportant);
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

  /// Writes `bytes` to `name` in this folder, creating subfolders, and returns the path.
  [[nodiscard]] std::filesystem::path with(const std::string& name, std::string_view bytes) const {
    std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::filesystem::remove(file);  // some file systems flush a file that is overwritten, which is slow
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return file;
  }

 private:
  std::filesystem::path path_;
};

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The message of the Error thrown by `work`; fails if it throws nothing or something else, or if the message
/// has two lines.
inline std::string refusal(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  } catch (const std::exception& other) {
    ADD_FAILURE() << "not an Error: " << other.what();
    return {};
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

/// Whether `text` contains each of `words`.
inline testing::AssertionResult has(const std::string& text, std::initializer_list<std::string_view> words) {
  for (const std::string_view word : words) {
    if (text.find(word) == std::string::npos)
      return testing::AssertionFailure() << "no '" << word << "' in: " << text;
  }
  return testing::AssertionSuccess();
}

/// Calls read() on every truncated and on many modified copies of `file`. Reading may succeed or throw Error,
/// nothing else, and must not print. Returns the number of truncated copies that were read.
inline int survives_damage(const TemporaryFolder& folder, const std::string& name, const std::string& file,
                           const std::function<void(const std::filesystem::path&)>& read,
                           std::size_t step = 1) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  int read_although_short = 0;
  const auto try_to_read = [&](const std::string& bytes, const std::string& how) {
    try {
      read(folder.with(name, bytes));
      return true;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    } catch (const std::exception& other) {
      ADD_FAILURE() << how << ": not an Error: " << other.what();
    }
    return false;
  };
  for (std::size_t length = 0; length < file.size(); length += step) {
    read_although_short += try_to_read(file.substr(0, length), "cut to " + std::to_string(length)) ? 1 : 0;
  }
  for (std::size_t at = 0; at < file.size(); at += step) {
    for (const int flip : {0x01, 0x80, 0xFF}) {
      std::string altered = file;
      altered[at] = static_cast<char>(altered[at] ^ flip);
      try_to_read(altered, "byte " + std::to_string(at) + " altered");
    }
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  return read_although_short;
}

}  // namespace cairn::support
