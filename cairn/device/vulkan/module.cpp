// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/device/careful_device.hpp>
#include <cairn/device/module.hpp>
#include <cairn/device/vulkan/vulkan_engine.hpp>
#include <cairn/io/names_and_numbers.hpp>
#include <cctype>

namespace cairn::device {
namespace {

std::string in_lower_case(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string names_of(const std::vector<Listed>& all) {
  std::string names;
  for (std::size_t i = 0; i < all.size(); ++i)
    names += (i > 0 ? ", " : "") + std::to_string(i) + " " + all[i].name;
  return names.empty() ? "none" : names;
}

/// By its number, else by a part of its name. Throws Error.
std::size_t number_of(const std::string& wanted, const std::string& source, const std::vector<Listed>& all) {
  auto found = io::whole<std::size_t>(wanted);
  if (found && *found >= all.size()) found.reset();  // "4090"
  for (std::size_t i = 0; i < all.size() && !found; ++i)
    if (in_lower_case(all[i].name).find(in_lower_case(wanted)) != std::string::npos) found = i;
  if (!found) {
    throw Error(
        source + " " + wanted +
        ": there is no such device, expected off, auto, or the number or name of one of: " + names_of(all));
  }
  if (!all[*found].unusable.empty())
    throw Error(source + " " + wanted + ": " + all[*found].name + ": " + all[*found].unusable);
  return *found;
}

std::optional<std::size_t> first_by_itself(const std::vector<Listed>& all) {
  const auto found = std::ranges::find_if(
      all, [](const Listed& one) { return one.unusable.empty() && one.not_by_itself.empty(); });
  return found == all.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - all.begin()));
}

}  // namespace
}  // namespace cairn::device

using namespace cairn::device;

std::vector<Listed>* cairn_list_devices() {
  try {
    return std::make_unique<std::vector<Listed>>(vulkan_devices(vulkan_library())).release();
  } catch (const std::runtime_error& failed) {
    throw cairn::Error(std::string("devices: ") + failed.what());
  }
}

cairn::MatchDevice* cairn_open_device(const std::string& wanted, const std::string& source,
                                      const Notice& notice) {
  try {
    const std::vector<Listed> all = vulkan_devices(vulkan_library());
    const bool is_auto = wanted == "auto";
    const std::optional<std::size_t> number = is_auto ? first_by_itself(all) : number_of(wanted, source, all);
    if (!number) return nullptr;
    const auto open = [number = *number, name = all[*number].name] {
      return vulkan_engine(vulkan_library(), number, {}, name);
    };
    Notice with_source;
    if (notice) with_source = [notice, source](const std::string& says) { notice(source + ": " + says); };
    return std::make_unique<CarefulDevice>(open, Trust{.must_be_faster = is_auto}, with_source, wanted)
        .release();
  } catch (const cairn::Error&) {
    throw;
  } catch (const std::runtime_error& failed) {
    throw cairn::Error(source + " " + wanted + ": " + failed.what());
  }
}
