// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <cairn/device/device.hpp>
#include <cairn/device/module.hpp>

namespace cairn::device {
namespace {

constexpr io::Part kVulkan{"cairn-vulkan.so", "devices need", "Vulkan",
                           "package cairn-vulkan; it is built where libvulkan-dev and glslc are",
                           "devices are not built in: they need Vulkan (libvulkan-dev glslc)"};

}  // namespace

std::vector<Listed> devices() {
  const auto entry = CAIRN_ENTRY(CAIRN_HOW_VULKAN, cairn_list_devices, kVulkan, "devices");
  const std::unique_ptr<std::vector<Listed>> listed(entry());
  return *listed;
}

std::shared_ptr<MatchDevice> open(const std::string& wanted, const std::string& source,
                                  const Notice& notice) {
  if (wanted.empty() || wanted == "off") return nullptr;
  try {
    const auto entry = CAIRN_ENTRY(CAIRN_HOW_VULKAN, cairn_open_device, kVulkan, source + " " + wanted);
    return std::shared_ptr<MatchDevice>(entry(wanted, source, notice));
  } catch (const Error&) {
    if (wanted == "auto")
      return nullptr;  // a computer without Vulkan: nothing that a user would have to know
    throw;
  }
}

}  // namespace cairn::device
