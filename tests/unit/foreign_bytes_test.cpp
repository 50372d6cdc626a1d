// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <fuzz/targets.hpp>
#include <iostream>
#include <random>
#include <sstream>

/// Any file content gives a result or a one-line Error: the seeds of every fuzzer, earlier findings of
/// fuzzing, and random changes of both.
namespace cairn::fuzz {

namespace fs = std::filesystem;

/// Names for the parameterised tests.
static void PrintTo(const Target& target, std::ostream* out) {
  *out << target.name;
}

namespace {

class ForeignBytes : public testing::TestWithParam<Target> {};

std::vector<std::string> found_once(const char* target) {
  std::vector<std::string> all;
  const fs::path folder = fs::path(CAIRN_SOURCE_DIR) / "tests/fuzz/found" / target;
  if (!fs::is_directory(folder)) return all;
  for (const auto& entry : fs::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    all.push_back(bytes.str());
  }
  return all;
}

TEST_P(ForeignBytes, SeedsAreAcceptedAndFormerFindingsAreHarmless) {
  int taken = 0;
  for (const std::string& seed : GetParam().seeds()) taken += GetParam().run(seed) ? 1 : 0;
  EXPECT_GT(taken, 0);
  for (const std::string& bytes : found_once(GetParam().name)) EXPECT_NO_THROW((void)GetParam().run(bytes));
}

/// One mutation: a byte flipped, set, removed or doubled, the end cut off, or a piece of another input
/// inserted.
std::string changed(std::string bytes, const std::vector<std::string>& others, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return std::size_t{random()} % std::max<std::size_t>(1, end); };
  if (bytes.empty()) return others[below(others.size())];
  const std::size_t at = below(bytes.size());
  constexpr std::string_view kTelling = "\0\xff\x7f\x80-.,:[]{}eE+9#&*!<>\"\n";
  switch (random() % 7) {
    case 0:
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << (random() % 8)));
      break;
    case 1:
      bytes[at] = kTelling[below(kTelling.size())];
      break;
    case 2:
      bytes.erase(at, 1 + below(8));
      break;
    case 3:
      bytes.insert(at, bytes.substr(below(bytes.size()), 1 + below(16)));
      break;
    case 4:
      bytes.resize(at);
      break;
    case 5: {
      const std::string& other = others[below(others.size())];
      bytes = bytes.substr(0, at) + other.substr(below(other.size()));
      break;
    }
    default:
      bytes.insert(at, std::string(1 + below(64), kTelling[below(kTelling.size())]));
      break;
  }
  return bytes;
}

/// New inputs in every run, for about 20 seconds over all targets; CAIRN_FUZZ_SECONDS=60 extends it
/// (`./dev test --all` sets 5), and CAIRN_FUZZ_SEED, which is printed, reproduces a failure.
TEST_P(ForeignBytes, AnyMutationEndsInAResultOrInOneLine) {
  std::vector<std::string> inputs = GetParam().seeds();
  for (std::string& bytes : found_once(GetParam().name)) inputs.push_back(std::move(bytes));
  const char* const setting = std::getenv("CAIRN_FUZZ_SECONDS");
  const double seconds = setting != nullptr ? std::atof(setting) : 0.8;
  const char* const seed = std::getenv("CAIRN_FUZZ_SEED");
  const auto first =
      seed != nullptr ? static_cast<std::mt19937::result_type>(std::atoll(seed)) : std::random_device()();
  std::cout << "CAIRN_FUZZ_SEED=" << first << std::endl;  // before a crash
  std::mt19937 random(first);
  const auto began = std::chrono::steady_clock::now();
  int tried = 0;
  while (std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count() < seconds) {
    std::string bytes = inputs[random() % inputs.size()];
    for (unsigned changes = 1 + random() % 4; changes > 0; --changes) bytes = changed(bytes, inputs, random);
    ASSERT_NO_THROW((void)GetParam().run(bytes))
        << "input " << tried << ": " << testing::PrintToString(bytes.substr(0, 400));
    ++tried;
  }
  RecordProperty("inputs", tried);
  EXPECT_GT(tried, 0);
}

INSTANTIATE_TEST_SUITE_P(Everything, ForeignBytes, testing::ValuesIn(targets()),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace cairn::fuzz
