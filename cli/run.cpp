// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/core/nearest.hpp>
#include <cctype>
#include <cerrno>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "app.hpp"

namespace cairn::cli {
namespace {

enum ExitCode { kDone = 0, kFailed = 1, kBadUsage = 2 };

int complain(std::string message, ExitCode code) {
  std::replace(message.begin(), message.end(), '\n', ' ');
  message.erase(message.find_last_not_of(" .") + 1);
  std::cout.flush();
  std::cerr << "cairn: " << message << '\n';
  return code;
}

std::string suggestion(const std::string& name, const std::vector<std::string>& known) {
  const std::string close = nearest(name, known);
  return close.empty() ? "" : ", did you mean '" + close + "'?";
}

/// An error message for the first option unknown to `app`; empty if all are known.
std::string unknown_option(const CLI::App& app, const std::vector<std::string>& words) {
  std::vector<std::string> known;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
    for (const std::string& name : option->get_snames()) known.push_back("-" + name);
  }
  for (const std::string& word : words) {
    if (word == "--") break;
    const std::string name = word.substr(0, word.find('='));
    if (name.size() < 2 || name[0] != '-' || std::isdigit(static_cast<unsigned char>(name[1])) != 0) continue;
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    if (name[1] != '-' && std::find(known.begin(), known.end(), name.substr(0, 2)) != known.end()) continue;
    const std::string close = suggestion(name, known);
    return "unknown option '" + name + "'" +
           (close.empty()
                ? "; " + (app.get_name().empty() ? "cairn" : "cairn " + app.get_name()) + " --help lists them"
                : close);
  }
  return {};
}

int parse_and_work(int argc, const char* const* argv, Declare declare) {
  const CommandLine line = declare_command_line(declare);
  CLI::App& app = *line.app;
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  if (!words.empty() && !words.front().starts_with('-')) {
    const std::string sentence = unknown_command(words.front());
    if (!sentence.empty()) return complain(sentence, kBadUsage);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    const CLI::App* meant = &app;
    for (const auto& [sub, work] : line.commands)
      meant = !words.empty() && sub->get_name() == words.front() ? sub : meant;
    const std::string sentence = unknown_option(*meant, words);
    return complain(sentence.empty() ? error.what() : sentence, kBadUsage);
  }
  for (const auto& [sub, work] : line.commands) {
    if (*sub) return work();
  }
  std::cout << app.help();
  return kDone;
}

std::terminate_handler usual_terminate = std::abort;

/// Memory may run out where no exception can be caught: in a library's destructor, in another thread.
[[noreturn]] void end_in_one_line() {
  bool is_memory = errno == ENOMEM;  // an uncaught exception may not be current here
  try {
    if (const std::exception_ptr why = std::current_exception()) std::rethrow_exception(why);
  } catch (const std::bad_alloc&) {
    is_memory = true;
  } catch (...) {
    is_memory = false;
  }
  if (!is_memory) {
    usual_terminate();  // reports what was thrown
    std::abort();
  }
  constexpr std::string_view kLine = "cairn: not enough memory\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kLine.data(), kLine.size());
  ::_exit(kFailed);
}

}  // namespace

int run(int argc, const char* const* argv, Declare declare) {
  try {
    const int code = parse_and_work(argc, argv, declare);
    std::cout.flush();
    if (!std::cout) return complain("standard output: cannot be written", kFailed);
    return code;
  } catch (const Error& error) {
    return complain(error.what(), kBadUsage);
  } catch (const std::bad_alloc&) {
    return complain("not enough memory", kFailed);
  } catch (const std::exception& error) {
    return complain(error.what(), kFailed);
  }
}

void end_in_one_line_without_memory() {
  usual_terminate = std::set_terminate(end_in_one_line);
}

}  // namespace cairn::cli
