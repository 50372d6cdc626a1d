// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/device/vulkan/instance.hpp>

#include <dlfcn.h>

#include <algorithm>
#include <cairn/device/engine.hpp>
#include <cstring>
#include <string>

namespace cairn::device {
namespace {

constexpr std::uint32_t kApi = VK_API_VERSION_1_1;
constexpr std::uint32_t kBroadcom = 0x14E4, kIntel = 0x8086;
constexpr const char* kSubgroupSizes = VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME;

vk::raii::Instance made_instance(const vk::raii::Context& context) {
  try {
    const vk::ApplicationInfo application("cairn", 0, "cairn", 0, kApi);
    return {context, vk::InstanceCreateInfo({}, &application)};
  } catch (const vk::SystemError& failed) {
    throw Unfit(std::string("Vulkan finds no driver (") + failed.what() + ")");
  }
}

std::string kind_of(vk::PhysicalDeviceType type) {
  switch (type) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
      return "discrete";
    case vk::PhysicalDeviceType::eIntegratedGpu:
      return "integrated";
    case vk::PhysicalDeviceType::eVirtualGpu:
      return "virtual";
    case vk::PhysicalDeviceType::eCpu:
      return kSoftware;
    default:
      return "other";
  }
}

std::string version_text(std::uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) +
         "." + std::to_string(VK_API_VERSION_PATCH(version));
}

bool has_extension(const vk::raii::PhysicalDevice& device, const char* name) {
  return std::ranges::any_of(device.enumerateDeviceExtensionProperties(), [&](const auto& one) {
    return std::strcmp(one.extensionName.data(), name) == 0;
  });
}

/// Lanes that exchange values by shuffles, all of them at work: 0 if there are none.
void describe_subgroups(const vk::raii::PhysicalDevice& device, Traits& traits) {
  const auto chain =
      device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceSubgroupProperties>();
  const auto& subgroups = chain.get<vk::PhysicalDeviceSubgroupProperties>();
  const auto needed = vk::SubgroupFeatureFlagBits::eBasic | vk::SubgroupFeatureFlagBits::eShuffle |
                      vk::SubgroupFeatureFlagBits::eShuffleRelative;
  if ((subgroups.supportedOperations & needed) != needed) return;
  if (!(subgroups.supportedStages & vk::ShaderStageFlagBits::eCompute)) return;
  bool can_vary = device.getProperties().vendorID == kIntel;
  if (has_extension(device, kSubgroupSizes)) {
    const auto sizes = device
                           .getProperties2<vk::PhysicalDeviceProperties2,
                                           vk::PhysicalDeviceSubgroupSizeControlPropertiesEXT>()
                           .get<vk::PhysicalDeviceSubgroupSizeControlPropertiesEXT>();
    const auto features =
        device.getFeatures2<vk::PhysicalDeviceFeatures2, vk::PhysicalDeviceSubgroupSizeControlFeaturesEXT>()
            .get<vk::PhysicalDeviceSubgroupSizeControlFeaturesEXT>();
    can_vary = sizes.minSubgroupSize != sizes.maxSubgroupSize;
    traits.can_fix_subgroups = features.subgroupSizeControl && features.computeFullSubgroups &&
                               (sizes.requiredSubgroupSizeStages & vk::ShaderStageFlagBits::eCompute);
  }
  if (!can_vary || traits.can_fix_subgroups) traits.listed.subgroup = subgroups.subgroupSize;
}

Traits traits_of(const vk::raii::PhysicalDevice& device) {
  const auto properties = device.getProperties();
  Traits traits;
  Listed& listed = traits.listed;
  listed.name = properties.deviceName.data();
  listed.kind = kind_of(properties.deviceType);
  listed.driver =
      "driver " + version_text(properties.driverVersion) + ", Vulkan " + version_text(properties.apiVersion);
  listed.largest_buffer_bytes = properties.limits.maxStorageBufferRange;
  listed.group = properties.limits.maxComputeWorkGroupInvocations;
  const auto families = device.getQueueFamilyProperties();
  const auto with_compute = std::ranges::find_if(
      families, [](const auto& family) { return bool(family.queueFlags & vk::QueueFlagBits::eCompute); });
  if (properties.apiVersion < kApi) {
    listed.unusable = "its Vulkan is older than 1.1";
  } else if (properties.limits.maxPerStageDescriptorStorageBuffers < kStorageBuffers) {
    listed.unusable = "it has " + std::to_string(properties.limits.maxPerStageDescriptorStorageBuffers) +
                      " storage buffers for a kernel, expected " + std::to_string(kStorageBuffers);
  } else if (with_compute == families.end()) {
    listed.unusable = "it computes nothing";
  }
  if (!listed.unusable.empty()) return traits;
  traits.queue_family = static_cast<std::uint32_t>(with_compute - families.begin());
  if (const std::uint32_t bits = with_compute->timestampValidBits; bits > 0)
    traits.clock_mask = ~std::uint64_t{0} >> (64 - bits);
  traits.ns_per_tick = static_cast<double>(properties.limits.timestampPeriod);
  describe_subgroups(device, traits);
  if (properties.deviceType != vk::PhysicalDeviceType::eDiscreteGpu &&
      properties.deviceType != vk::PhysicalDeviceType::eIntegratedGpu) {
    listed.not_by_itself = "it is no graphics processor";
  } else if (properties.vendorID == kBroadcom) {
    listed.not_by_itself = "the processor beside it is faster";
  }
  return traits;
}

}  // namespace

FindFunction vulkan_library() {
  void* library = ::dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
  void* find = library == nullptr ? nullptr : ::dlsym(library, "vkGetInstanceProcAddr");
  if (find == nullptr) throw Unfit("libvulkan.so.1 is not installed (package libvulkan1)");
  return reinterpret_cast<FindFunction>(find);
}

Instance::Instance(FindFunction find)
    : context_(find), instance_(made_instance(context_)), devices_(vk::raii::PhysicalDevices(instance_)) {}

std::vector<Traits> Instance::traits() const {
  std::vector<Traits> all;
  for (const auto& device : devices_) {
    all.push_back(traits_of(device));
    all.back().number = all.size() - 1;
  }
  return all;
}

std::vector<Listed> vulkan_devices(FindFunction find) {
  std::vector<Listed> all;
  for (const Traits& traits : Instance(find).traits()) all.push_back(traits.listed);
  return all;
}

}  // namespace cairn::device
