// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <exception>
#include <filesystem>
#include <io/atomic_file.hpp>
#include <iostream>

#include "facts.hpp"

namespace cairn::cli {
namespace {

void put(const std::filesystem::path& path, const std::string& text) {
  io::make_folder(path.parent_path());
  io::write_file(path, text);
}

void write_manual(const std::filesystem::path& folder) {
  const CommandLine line = declare_command_line();
  const std::vector<CommandFacts> commands = facts_of(*line.app);
  for (const NamedText& page : man_pages(commands)) put(folder / page.name, page.text);
  put(folder / "bash-completion/completions/cairn", bash_completion(commands));
  put(folder / "zsh/site-functions/_cairn", zsh_completion(commands));
  put(folder / "fish/vendor_completions.d/cairn.fish", fish_completion(commands));
}

}  // namespace
}  // namespace cairn::cli

/// cairn_manual DIR: manual pages and shell completion, below DIR as they are installed below share/ or
/// share/man/.
int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: cairn_manual DIR\n";
    return 2;
  }
  try {
    cairn::cli::write_manual(argv[1]);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "cairn_manual: " << error.what() << '\n';
    return 1;
  }
}
