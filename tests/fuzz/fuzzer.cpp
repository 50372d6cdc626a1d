// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// libFuzzer's entry point for every target, selected by CAIRN_FUZZ_TARGET. With CAIRN_FUZZ_SEEDS=FOLDER it
// only writes the target's seeds there. ./dev fuzz does both.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "targets.hpp"

namespace {

const cairn::fuzz::Target* target = nullptr;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  const char* const wanted = std::getenv("CAIRN_FUZZ_TARGET");
  for (const cairn::fuzz::Target& one : cairn::fuzz::targets()) {
    if (wanted != nullptr && one.name == std::string_view(wanted)) target = &one;
  }
  if (target == nullptr) {
    for (const cairn::fuzz::Target& one : cairn::fuzz::targets()) std::printf("%s\n", one.name);
    std::exit(wanted == nullptr ? 0 : 2);
  }
  if (const char* const folder = std::getenv("CAIRN_FUZZ_SEEDS")) {
    int number = 0;
    for (const std::string& seed : target->seeds()) {
      std::ofstream(std::filesystem::path(folder) / ("seed" + std::to_string(number++)), std::ios::binary)
          << seed;
    }
    std::exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  (void)target->run({reinterpret_cast<const char*>(data), size});
  return 0;
}
