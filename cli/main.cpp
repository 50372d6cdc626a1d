// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// `cairn segment` and `cairn disparity` are part of the program, which links no more than they need; the other commands
// are a module, because its libraries (OpenCV with LAPACK, SQLite, OpenSSL) take longer to load than a pair to segment.
#include <fcntl.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cairn/core/error.hpp>
#include <cairn/io/load_module.hpp>
#include <iostream>
#include <string_view>

#include "app.hpp"

namespace cairn::cli {
namespace {

/// nullptr for a command of the module.
Work declare_own(std::string_view command, CLI::App& app) {
  if (command == "segment") return declare_segment(app);
  if (command == "disparity") return declare_disparity(app);
  return nullptr;
}

bool is_own(int argc, const char* const* argv) {
  if (argc < 2 || *argv[1] == '-') return true;  // --help, --version
  const std::string_view command = argv[1];
  return command == "segment" || command == "disparity" || !unknown_command(argv[1]).empty();
}

#ifdef CAIRN_ONE_PROGRAM
int run_other(int argc, const char* const* argv) {
  return run(argc, argv, declare_any);
}
#else
int run_other(int argc, const char* const* argv) {
  try {
    constexpr io::Part kCommands{"cairn-commands.so", "it needs", "its module and the libraries of that",
                                 "reinstall cairn"};
    void* entry = io::module_entry(kCommands, kCommandsEntry, std::string("cairn ") + argv[1]);
    return reinterpret_cast<CommandsEntry>(entry)(argc, argv);
  } catch (const Error& error) {
    std::cerr << "cairn: " << error.what() << '\n';
    return 2;
  }
}
#endif

/// If stdout was closed by the caller, the first file opened would take its number. A read-only /dev/null
/// takes it instead; writing to it fails, which is reported like any write error on stdout.
void hold_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) < 0) (void)::open("/dev/null", O_RDONLY);  // gets the lowest free number
  }
}

}  // namespace
}  // namespace cairn::cli

int main(int argc, char** argv) {
  using namespace cairn::cli;
  hold_standard_streams();
  end_in_one_line_without_memory();
  return is_own(argc, argv) ? run(argc, argv, declare_own) : run_other(argc, argv);
}
