// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cairn/core/error.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/pipeline/config.hpp>
#include <random>
#include <string>
#include <support/temporary_folder.hpp>
#include <vector>

namespace cairn::io {
namespace {

/// Reads `text` as a calibration and as a configuration in a process limited to 2 s and little memory.
/// Returns whether that ended with a result or an Error.
bool ends_well(const std::filesystem::path& path) {
  const pid_t child = ::fork();
  if (child == 0) {
    // The memory in use, plus 256 MB.
    rlimit memory{};
    long pages = 0;
    if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
      if (std::fscanf(file, "%ld", &pages) != 1) pages = 0;
      std::fclose(file);
    }
    memory.rlim_cur = memory.rlim_max =
        static_cast<rlim_t>(pages * ::sysconf(_SC_PAGESIZE)) + (rlim_t{256} << 20);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    ::setrlimit(RLIMIT_AS, &memory);
#endif
    const rlimit time{2, 2};
    ::setrlimit(RLIMIT_CPU, &time);
    int code = 0;
    try {
      (void)load_calibration(path);
    } catch (const Error&) {
    } catch (...) {
      code = 1;
    }
    try {
      Config config;
      load_config(path, config);
    } catch (const Error&) {
    } catch (...) {
      code = 1;
    }
    ::_exit(code);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(YamlText, AMisplacedCommaIsRefusedAtOnce) {
  const support::TemporaryFolder folder;
  for (const std::string text :
       {",",    ",,",     "\n,",   " ,",     "!,",         "&a ,",        "[],", "{},",
        "'a',", "\"a\",", "--- ,", "...\n,", "a: [1, 2],", "- a\n,",      "[,",  "{,",
        "[,]",  "{,}",    "? ,",   "*a,",    "|\n,",       "%YAML:1.0\n,"}) {
    const auto path = folder.with("f.yaml", text);
    EXPECT_TRUE(ends_well(path)) << text;
    EXPECT_TRUE(ends_well(folder.with("f", text))) << text;
  }
  EXPECT_TRUE(support::has(support::refusal([&] {
                             Config config;
                             load_config(folder.with("f.yaml", "# options\n,"), config);
                           }),
                           {"f.yaml: line 2: is not YAML: nothing is allowed here"}));
}

TEST(YamlText, ShortTextsOfSpecialCharactersTerminate) {
  const support::TemporaryFolder folder;
  const std::string signs = ",[]{}:-?&*!|>'\"%@\n a#.<";
  std::mt19937 random(11);
  for (int i = 0; i < 400; ++i) {
    std::string text;
    for (std::size_t length = 1 + random() % 12; text.size() < length;)
      text += signs[random() % signs.size()];
    EXPECT_TRUE(ends_well(folder.with("f.yaml", text))) << text;
  }
}

TEST(YamlText, LongTextsTerminate) {
  const support::TemporaryFolder folder;
  for (const char* part : {"[", "{", "- ", "? ", "{a: ", "[a, ", "a: &b [*b, ", "- a\n", "a\n\n", "--- a\n",
                           "!a ", "&a ", "'a' ", "\"", "|\n ", "# a\n", ": ", "a: 1\n"}) {
    std::string text;
    while (text.size() < 100'000) text += part;
    EXPECT_TRUE(ends_well(folder.with("f.yaml", text))) << part;
  }
}

}  // namespace
}  // namespace cairn::io
