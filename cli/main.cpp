// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <fcntl.h>
#include <unistd.h>

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

int run(int argc, const char* const* argv) {
  const CommandLine line = declare_command_line();
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

int guarded(int argc, const char* const* argv) {
  try {
    const int code = run(argc, argv);
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
  cairn::cli::hold_standard_streams();
  cairn::cli::usual_terminate = std::set_terminate(cairn::cli::end_in_one_line);
  return cairn::cli::guarded(argc, argv);
}
