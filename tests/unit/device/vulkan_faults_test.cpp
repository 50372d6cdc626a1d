// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// Every function of Vulkan fails once: the frame's result is the processor's, with one notice, and nothing leaks. And:
// what the kernels may demand of a device.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cairn/device/careful_device.hpp>
#include <cairn/device/vulkan/shaders.hpp>
#include <cairn/device/vulkan/vulkan_engine.hpp>
#include <cstdlib>
#include <string>
#include <string_view>
#include <support/first_difference.hpp>
#include <support/random_pair.hpp>
#include <vector>

namespace cairn::device {
namespace {

/// The call of this number fails, counted over all functions that can.
struct Saboteur {
  int calls = 0;
  int fails_at = -1;
  VkResult result = VK_ERROR_DEVICE_LOST;
  bool removes_barriers = false;

  bool strikes() { return calls++ == fails_at; }
};
Saboteur saboteur;

#define CAIRN_FUNCTIONS(X)       \
  X(vkCreateInstance)            \
  X(vkEnumeratePhysicalDevices)  \
  X(vkCreateDevice)              \
  X(vkCreateDescriptorSetLayout) \
  X(vkCreatePipelineLayout)      \
  X(vkCreateCommandPool)         \
  X(vkCreateFence)               \
  X(vkCreateQueryPool)           \
  X(vkCreateBuffer)              \
  X(vkAllocateMemory)            \
  X(vkBindBufferMemory)          \
  X(vkMapMemory)                 \
  X(vkCreateDescriptorPool)      \
  X(vkAllocateDescriptorSets)    \
  X(vkAllocateCommandBuffers)    \
  X(vkCreateShaderModule)        \
  X(vkCreateComputePipelines)    \
  X(vkBeginCommandBuffer)        \
  X(vkEndCommandBuffer)          \
  X(vkQueueSubmit)               \
  X(vkWaitForFences)             \
  X(vkResetFences)               \
  X(vkGetQueryPoolResults)

/// The real function of each name.
#define X(function)                              \
  struct Real_##function {                       \
    static inline PFN_##function real = nullptr; \
  };
CAIRN_FUNCTIONS(X)
#undef X

template <class Function, class... Of>
VKAPI_ATTR VkResult VKAPI_CALL stand_in(Of... of) {
  return saboteur.strikes() ? saboteur.result : Function::real(of...);
}
template <class Function, class... Of>
PFN_vkVoidFunction stand_in_for(VkResult(VKAPI_PTR* /*like*/)(Of...)) {
  return reinterpret_cast<PFN_vkVoidFunction>(&stand_in<Function, Of...>);
}

PFN_vkGetDeviceProcAddr real_find_of_device = nullptr;

template <class... Of>
VKAPI_ATTR void VKAPI_CALL no_barrier(Of... /*of*/) {}
template <class... Of>
PFN_vkVoidFunction no_barrier_like(void(VKAPI_PTR* /*like*/)(Of...)) {
  return reinterpret_cast<PFN_vkVoidFunction>(&no_barrier<Of...>);
}

PFN_vkVoidFunction with_stand_ins(const std::string& name, PFN_vkVoidFunction real) {
  if (real == nullptr) return real;
#define X(function)                                                 \
  if (name == #function) {                                          \
    Real_##function::real = reinterpret_cast<PFN_##function>(real); \
    return stand_in_for<Real_##function>(PFN_##function{});         \
  }
  CAIRN_FUNCTIONS(X)
#undef X
  if (name == "vkCmdPipelineBarrier" && saboteur.removes_barriers)
    return no_barrier_like(PFN_vkCmdPipelineBarrier{});
  return real;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL find_of_device(VkDevice device, const char* name) {
  const PFN_vkVoidFunction real = real_find_of_device(device, name);
  if (std::string_view(name) == "vkGetDeviceProcAddr")
    return reinterpret_cast<PFN_vkVoidFunction>(&find_of_device);
  return with_stand_ins(name, real);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL find_with_stand_ins(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction real = vulkan_library()(instance, name);
  if (std::string_view(name) != "vkGetDeviceProcAddr") return with_stand_ins(name, real);
  real_find_of_device = reinterpret_cast<PFN_vkGetDeviceProcAddr>(real);
  return reinterpret_cast<PFN_vkVoidFunction>(&find_of_device);
}

bool has_layer(std::string_view wanted) {
  const auto list = reinterpret_cast<PFN_vkEnumerateInstanceLayerProperties>(
      vulkan_library()(nullptr, "vkEnumerateInstanceLayerProperties"));
  std::uint32_t count = 0;
  list(&count, nullptr);
  std::vector<VkLayerProperties> all(count);
  list(&count, all.data());
  return std::ranges::any_of(all, [&](const VkLayerProperties& layer) { return wanted == layer.layerName; });
}

class VulkanFaults : public testing::Test {
 protected:
  const RandomPair images{{31, 12}, 1};
  const MatchConfig config{.method = MatchMethod::semi_global, .num_disparities = 12};
  const Matches expected = match_semi_global(images.pair(), config, {}, {});
  std::vector<std::string> notices;

  void SetUp() override {
    saboteur = {};
    try {
      if (!vulkan_devices(vulkan_library()).empty()) return;
    } catch (const Unfit&) {
      // No driver.
    }
    GTEST_SKIP() << "no Vulkan device (package mesa-vulkan-drivers has one in software)";
  }

  std::shared_ptr<MatchDevice> opened() {
    return std::make_shared<CarefulDevice>([] { return vulkan_engine(&find_with_stand_ins, 0); }, Trust{},
                                           [this](const std::string& says) { notices.push_back(says); });
  }
  void expect_right(const std::shared_ptr<MatchDevice>& device) {
    Exec exec;
    exec.device = device;
    EXPECT_EQ(first_difference(expected, match(images.pair(), config, {}, exec)), "");
  }
  /// Two pairs, the second begun early. Returns whether the device could be opened.
  bool run() {
    std::shared_ptr<MatchDevice> device;
    try {
      device = opened();
    } catch (const std::runtime_error& failed) {
      EXPECT_STRNE(failed.what(), "");
      return false;
    }
    device->begin(images.pair(), config, {});
    expect_right(device);
    expect_right(device);
    return true;
  }
};

TEST_F(VulkanFaults, EachCallMayFailWithoutChangingAResult) {
  ASSERT_TRUE(run());
  const int calls = saboteur.calls;
  ASSERT_GT(calls, 50);
  int refusals = 0;
  for (int fails_at = 0; fails_at < calls; ++fails_at) {
    constexpr std::array kResults{VK_ERROR_OUT_OF_DEVICE_MEMORY, VK_ERROR_DEVICE_LOST, VK_TIMEOUT,
                                  VK_ERROR_INITIALIZATION_FAILED};
    saboteur = {.fails_at = fails_at,
                .result = kResults.at(static_cast<std::size_t>(fails_at) % kResults.size())};
    notices.clear();
    refusals += run() ? 0 : 1;
    EXPECT_LE(notices.size(), 1U) << "call " << fails_at;
  }
  EXPECT_GT(refusals, 0) << "while it is opened";
  EXPECT_LT(refusals, calls) << "and later";
}

TEST_F(VulkanFaults, TheKernelsPassValidationAndABarrierLessDoesNot) {
  if (!has_layer("VK_LAYER_KHRONOS_validation"))
    GTEST_SKIP() << "no validation layer (package vulkan-validationlayers)";
  setenv("VK_INSTANCE_LAYERS", "VK_LAYER_KHRONOS_validation", 1);
  setenv("VK_LAYER_ENABLES", "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT", 1);
  const auto messages = [&](bool removes_barriers) {
    saboteur = {.removes_barriers = removes_barriers};
    testing::internal::CaptureStdout();
    for (const bool shuffles : {true, false}) {
      const auto engine = vulkan_engine(&find_with_stand_ins, 0, {.shuffles = shuffles});
      for (int k = 0; k < 3; ++k) {
        engine->submit(images.pair(), config, {});
        static_cast<void>(engine->finish({}));
      }
    }
    return testing::internal::GetCapturedStdout();
  };
  EXPECT_EQ(messages(false), "");
  EXPECT_NE(messages(true).find("SYNC-HAZARD"), std::string::npos);
  unsetenv("VK_INSTANCE_LAYERS");
  unsetenv("VK_LAYER_ENABLES");
}

TEST(Shaders, DemandIntegersOf32BitsAndNothingElse) {
  constexpr std::uint32_t kCapability = 17, kTypeInt = 21, kTypeFloat = 22;
  constexpr std::array<std::uint32_t, 4> kAllowed{1, 61, 65, 66};  // Shader; subgroups: basic, shuffles
  for (int kernel = 0; kernel < static_cast<int>(std::size(kKernelNames)); ++kernel) {
    for (int words = kLeastWords; words <= kMostWords; ++words) {
      for (const bool shuffles : {false, true}) {
        SCOPED_TRACE(std::string(kKernelNames[kernel]) + " " + std::to_string(words) + " " +
                     std::to_string(shuffles));
        const auto code = shader(static_cast<Kernel>(kernel), words, shuffles);
        ASSERT_GT(code.size(), 5U);
        for (std::size_t at = 5; at < code.size(); at += code[at] >> 16U) {
          const std::uint32_t op = code[at] & 0xFFFFU;
          ASSERT_GT(code[at] >> 16U, 0U);
          EXPECT_NE(op, kTypeFloat);
          if (op == kTypeInt) {
            EXPECT_EQ(code[at + 2], 32U);
          }
          if (op != kCapability) continue;
          const bool is_plain = code[at + 1] == 1;
          EXPECT_TRUE(is_plain || (shuffles && std::ranges::find(kAllowed, code[at + 1]) != kAllowed.end()))
              << "capability " << code[at + 1];
        }
      }
    }
  }
}

}  // namespace
}  // namespace cairn::device
