// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/device/vulkan/instance.hpp>
#include <cairn/device/vulkan/shaders.hpp>
#include <cairn/device/vulkan/vulkan_engine.hpp>
#include <cairn/stereo/semi_global_kernels.hpp>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>
#include <string>

namespace cairn::device {
namespace {

using kernels::SearchLayout;

// A device that takes longer has hung. Drivers may compile a kernel when it is first used; those that run on the
// processor take seconds.
constexpr std::uint64_t kSecond = 1'000'000'000, kPatience = 2 * kSecond, kPatienceAtFirst = 20 * kSecond,
                        kPatienceInSoftware = 120 * kSecond;
constexpr std::size_t kKernels = std::size(kKernelNames);
constexpr std::uint32_t kNoSum = 0xFFFF;  // right.comp

/// The push constants of search.glsl.
struct Search {
  std::int32_t width;
  std::int32_t height;
  std::int32_t first_d;
  std::int32_t count;
  std::int32_t row_words;
  [[nodiscard]] std::int64_t pixels() const { return std::int64_t{width} * height; }
  friend bool operator==(const Search&, const Search&) = default;
};

/// How the candidates of a path are shared out.
struct Team {
  std::uint32_t lanes;  // a power of two
  int words;            // of each lane
  [[nodiscard]] std::uint32_t all_words() const { return lanes * static_cast<std::uint32_t>(words); }
};

/// The fewest spare candidates; of those, the fewest words a lane.
Team team_for(int count, std::uint32_t most_lanes) {
  const auto words_needed = static_cast<std::uint32_t>(count + 3) / 4;
  std::optional<Team> best;
  for (int words = kLeastWords; words <= kMostWords; ++words) {
    for (std::uint32_t lanes = 1; lanes <= most_lanes; lanes *= 2) {
      const Team team{lanes, words};
      if (team.all_words() >= words_needed && (!best || team.all_words() < best->all_words())) best = team;
    }
  }
  if (!best) {
    throw Unfit(std::to_string(count) + " disparities are more than a group of " +
                std::to_string(most_lanes) + " can share");
  }
  return *best;
}

enum class Place : std::uint8_t { upload, device, download };

struct Buffer {
  vk::raii::Buffer buffer;
  vk::raii::DeviceMemory memory;
  void* mapped = nullptr;
  std::uint64_t bytes = 0;

  template <class T>
  [[nodiscard]] T* as() const {
    return static_cast<T*>(mapped);
  }
};

/// The buffers of search.glsl, in its order.
enum Binding : std::uint8_t { given, described, costs, vertical, leftward, found, bindings };
static_assert(bindings == kStorageBuffers);

/// Everything for one size and range: it is kept from pair to pair.
struct Program {
  Search search;
  Team team;
  std::vector<Buffer> buffers;
  vk::raii::DescriptorPool sets{nullptr};
  vk::raii::DescriptorSet set{nullptr};
  vk::raii::CommandBuffer commands{nullptr};
};

using Pipelines = std::vector<vk::raii::Pipeline>;

/// The words after the image.
std::uint32_t* store_pixels(View<const Gray> image, int row_words, std::uint32_t* to) {
  for (int y = 0; y < image.height(); ++y, to += row_words)
    std::memcpy(to, image.row(y), static_cast<std::size_t>(image.width()));
  return to;
}

float cost_of(std::uint32_t sum) {
  return sum == kNoSum ? kNoCost : static_cast<float>(sum);
}

/// From what right.comp writes, four words for each pixel, to row y of the maps.
void unpack_row(const std::uint32_t* all, const Search& search, int y, Matches& out) {
  const int width = search.width;
  const std::size_t first = static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
  const std::uint32_t* const at = all + 4 * first;
  const auto unpack = [&](auto& map, const auto& value) {
    auto* const to = map.row(y);
    for (int x = 0; x < width; ++x) to[x] = value(x);
  };
  unpack(out.best, [&](int x) { return static_cast<std::int16_t>(static_cast<std::uint16_t>(at[4 * x])); });
  unpack(out.cost, [&](int x) { return cost_of(at[4 * x] >> 16U); });
  if (out.runner_up.empty()) return;
  unpack(out.cost_before, [&](int x) { return cost_of(at[4 * x + 1] & 0xFFFFU); });
  unpack(out.cost_after, [&](int x) { return cost_of(at[4 * x + 1] >> 16U); });
  unpack(out.runner_up, [&](int x) { return cost_of(at[4 * x + 2]); });
  if (out.best_right.empty()) return;
  const std::uint32_t* const right = all + 4 * static_cast<std::size_t>(search.pixels()) + first;
  unpack(out.best_right,
         [&](int x) { return static_cast<std::int16_t>(static_cast<std::int32_t>(right[x])); });
  // The quotient is the processor's: on a device it may be off by 2.5 units in the last place.
  const SearchLayout layout{width, search.height, search.first_d, search.count, search.count};
  unpack(out.mean_cost, [&](int x) {
    const int candidates = layout.end(x) - layout.begin(x);
    const float mean = static_cast<float>(at[4 * x + 3]) / static_cast<float>(std::max(1, candidates));
    return candidates > 0 ? mean : kNoCost;
  });
}

class VulkanEngine final : public Engine {
 public:
  VulkanEngine(FindFunction find, std::size_t number, Tuning tuning, const std::string& name);
  ~VulkanEngine() override;

  [[nodiscard]] std::string name() const override { return traits_.listed.name; }
  [[nodiscard]] std::string full_name() const override { return name() + " (" + traits_.listed.driver + ")"; }
  [[nodiscard]] std::string variant(int num_disparities) const override {
    const Team team = team_for(num_disparities, tuning_.group);
    return std::to_string(team.lanes) + " lanes of " + std::to_string(4 * team.words) + " candidates by " +
           (uses_shuffles(team) ? "shuffles" : "shared memory");
  }
  void submit(const StereoPair& pair, const MatchConfig& config, const SemiGlobalConfig& penalties) override;
  Matches finish(const Exec& exec) override;
  [[nodiscard]] std::vector<DeviceKernel> work() const override { return work_; }
  [[nodiscard]] std::int64_t memory_bytes() const override;

 private:
  vk::raii::Device made_device() const;
  [[nodiscard]] std::uint32_t memory_type(std::uint32_t allowed, Place place) const;
  [[nodiscard]] Buffer made_buffer(std::uint64_t bytes, Place place) const;
  [[nodiscard]] bool uses_shuffles(const Team& team) const {
    return tuning_.shuffles && team.lanes <= traits_.listed.subgroup &&
           tuning_.group % traits_.listed.subgroup == 0;
  }
  const Pipelines& pipelines_for(const Team& team);
  [[nodiscard]] vk::raii::Pipeline made_pipeline(Kernel kernel, const Team& team) const;
  [[nodiscard]] Program made_program(const Search& search);
  void record(const Program& program, const Pipelines& run) const;
  void prepare(const Search& search);
  void wait();
  void read_clock();

  Instance instance_;
  Tuning tuning_;
  Traits traits_;
  vk::raii::Device device_;
  vk::raii::Queue queue_;
  vk::raii::DescriptorSetLayout set_layout_;
  vk::raii::PipelineLayout layout_;
  vk::raii::CommandPool commands_;
  vk::raii::QueryPool clock_{nullptr};
  vk::raii::Fence fence_;
  std::map<std::pair<std::uint32_t, int>, Pipelines> pipelines_;  // by lanes and words
  std::optional<Program> program_;
  MatchMaps maps_ = MatchMaps::full;  // of the pair at work
  bool is_at_work_ = false;
  bool is_first_ = true;  // pair of this program
  std::vector<DeviceKernel> work_;

  [[nodiscard]] std::uint64_t patience() const {
    if (traits_.listed.kind == kSoftware) return kPatienceInSoftware;
    return is_first_ ? kPatienceAtFirst : kPatience;
  }
};

/// A failure of Vulkan loses the device, unless it is about memory.
template <class Work>
auto guarded(const std::string& name, const Work& work) {
  try {
    return work();
  } catch (const vk::OutOfDeviceMemoryError& refused) {
    throw Unfit(name + " has too little memory (" + refused.what() + ")");
  } catch (const vk::OutOfHostMemoryError& refused) {
    throw Unfit(name + " has too little memory (" + refused.what() + ")");
  } catch (const vk::SystemError& failed) {
    throw Lost(name + " has failed (" + failed.what() + ")");
  }
}

vk::raii::DescriptorSetLayout made_set_layout(const vk::raii::Device& device) {
  std::vector<vk::DescriptorSetLayoutBinding> all;
  for (std::uint32_t i = 0; i < bindings; ++i)
    all.emplace_back(i, vk::DescriptorType::eStorageBuffer, 1, vk::ShaderStageFlagBits::eCompute);
  return {device, vk::DescriptorSetLayoutCreateInfo({}, all)};
}

vk::raii::PipelineLayout made_layout(const vk::raii::Device& device, vk::DescriptorSetLayout sets) {
  const vk::PushConstantRange search(vk::ShaderStageFlagBits::eCompute, 0, sizeof(Search));
  return {device, vk::PipelineLayoutCreateInfo({}, sets, search)};
}

/// Numbers change when a device disappears.
Traits usable_traits(const Instance& instance, std::size_t number, const std::string& name) {
  const std::vector<Traits> all = instance.traits();
  auto found = std::ranges::find(all, number, &Traits::number);
  if (!name.empty() && (found == all.end() || found->listed.name != name)) {
    found = std::ranges::find_if(all, [&](const Traits& one) { return one.listed.name == name; });
    if (found == all.end()) throw Lost(name + " is not there any more");
  }
  if (found == all.end()) throw Unfit("there is no device " + std::to_string(number));
  if (!found->listed.unusable.empty()) throw Unfit(found->listed.name + ": " + found->listed.unusable);
  return *found;
}

VulkanEngine::VulkanEngine(FindFunction find, std::size_t number, Tuning tuning, const std::string& name)
    : instance_(find),
      tuning_(tuning),
      traits_(usable_traits(instance_, number, name)),
      device_(made_device()),
      queue_(device_.getQueue(traits_.queue_family, 0)),
      set_layout_(made_set_layout(device_)),
      layout_(made_layout(device_, *set_layout_)),
      commands_(device_, vk::CommandPoolCreateInfo({}, traits_.queue_family)),
      fence_(device_, vk::FenceCreateInfo()) {
  if (traits_.clock_mask != 0) {
    clock_ =
        vk::raii::QueryPool(device_, vk::QueryPoolCreateInfo({}, vk::QueryType::eTimestamp, kKernels + 1));
  }
}

VulkanEngine::~VulkanEngine() {
  if (!is_at_work_) return;
  try {
    static_cast<void>(device_.waitForFences(*fence_, VK_TRUE, patience()));
  } catch (const vk::SystemError&) {
    // Lost: nothing is at work any more.
  }
}

vk::raii::Device VulkanEngine::made_device() const {
  constexpr float kPriority = 1;
  const vk::DeviceQueueCreateInfo queue({}, traits_.queue_family, 1, &kPriority);
  vk::PhysicalDeviceSubgroupSizeControlFeaturesEXT subgroups(VK_TRUE, VK_TRUE);
  std::vector<const char*> extensions;
  vk::DeviceCreateInfo info({}, queue);
  if (traits_.can_fix_subgroups) {
    extensions.push_back(VK_EXT_SUBGROUP_SIZE_CONTROL_EXTENSION_NAME);
    info.setPEnabledExtensionNames(extensions).setPNext(&subgroups);
  }
  return {instance_.devices()[traits_.number], info};
}

// ---- memory ----

std::uint32_t VulkanEngine::memory_type(std::uint32_t allowed, Place place) const {
  using Flag = vk::MemoryPropertyFlagBits;
  const vk::MemoryPropertyFlags readable = Flag::eHostVisible | Flag::eHostCoherent;
  std::vector<vk::MemoryPropertyFlags> wishes;  // best first
  if (place == Place::device) wishes = {Flag::eDeviceLocal, {}};
  if (place == Place::upload) wishes = {readable};
  if (place == Place::download) wishes = {readable | Flag::eHostCached, readable};
  const auto types = instance_.devices()[traits_.number].getMemoryProperties();
  for (const vk::MemoryPropertyFlags wish : wishes) {
    for (std::uint32_t i = 0; i < types.memoryTypeCount; ++i)
      if ((allowed >> i & 1U) != 0 && (types.memoryTypes[i].propertyFlags & wish) == wish) return i;
  }
  throw Unfit(name() + " has no memory that the processor can read");
}

Buffer VulkanEngine::made_buffer(std::uint64_t bytes, Place place) const {
  if (bytes > traits_.listed.largest_buffer_bytes) {
    throw Unfit("images of this size and range need buffers of " + std::to_string(bytes) + " bytes, " +
                name() + " has " + std::to_string(traits_.listed.largest_buffer_bytes));
  }
  Buffer made{
      vk::raii::Buffer(device_, vk::BufferCreateInfo({}, bytes, vk::BufferUsageFlagBits::eStorageBuffer)),
      vk::raii::DeviceMemory(nullptr), nullptr, bytes};
  const vk::MemoryRequirements needs = made.buffer.getMemoryRequirements();
  try {
    made.memory = vk::raii::DeviceMemory(
        device_, vk::MemoryAllocateInfo(needs.size, memory_type(needs.memoryTypeBits, place)));
  } catch (const vk::SystemError& refused) {
    throw Unfit(name() + " refuses " + std::to_string(needs.size) + " bytes (" + refused.what() + ")");
  }
  made.buffer.bindMemory(*made.memory, 0);
  if (place != Place::device) made.mapped = made.memory.mapMemory(0, bytes);
  return made;
}

std::int64_t VulkanEngine::memory_bytes() const {
  if (!program_) return 0;
  return std::accumulate(
      program_->buffers.begin(), program_->buffers.end(), std::int64_t{0},
      [](std::int64_t sum, const Buffer& one) { return sum + static_cast<std::int64_t>(one.bytes); });
}

// ---- kernels ----

vk::raii::Pipeline VulkanEngine::made_pipeline(Kernel kernel, const Team& team) const {
  const bool shuffles = uses_shuffles(team);
  const std::span<const std::uint32_t> words = shader(kernel, team.words, shuffles);
  const vk::raii::ShaderModule code(device_,
                                    vk::ShaderModuleCreateInfo({}, words.size_bytes(), words.data()));
  const std::array<std::uint32_t, 2> constants{tuning_.group, team.lanes};
  const std::array<vk::SpecializationMapEntry, 2> entries{vk::SpecializationMapEntry(0, 0, 4),
                                                          vk::SpecializationMapEntry(1, 4, 4)};
  const vk::SpecializationInfo special(entries.size(), entries.data(), sizeof constants, constants.data());
  vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *code, "main", &special);
  const vk::PipelineShaderStageRequiredSubgroupSizeCreateInfoEXT size(traits_.listed.subgroup);
  if (shuffles && traits_.can_fix_subgroups) {
    stage.setPNext(&size);
    stage.setFlags(vk::PipelineShaderStageCreateFlagBits::eRequireFullSubgroupsEXT);
  }
  return {device_, nullptr, vk::ComputePipelineCreateInfo({}, stage, *layout_)};
}

const Pipelines& VulkanEngine::pipelines_for(const Team& team) {
  Pipelines& all = pipelines_[{team.lanes, team.words}];
  for (std::size_t i = all.size(); i < kKernels; ++i)
    all.push_back(made_pipeline(static_cast<Kernel>(i), team));
  return all;
}

Program VulkanEngine::made_program(const Search& search) {
  Program made{.search = search, .team = team_for(search.count, tuning_.group), .buffers = {}};
  const auto pixels = static_cast<std::uint64_t>(search.pixels());
  const std::uint64_t image_words =
      static_cast<std::uint64_t>(search.row_words) * static_cast<std::uint64_t>(search.height);
  const std::uint64_t volume = pixels * made.team.all_words();
  for (const auto& [words, place] :
       {std::pair(2 * image_words + 1 + 256, Place::upload), std::pair(3 * pixels, Place::device),
        std::pair(volume, Place::device), std::pair(volume, Place::device), std::pair(volume, Place::device),
        std::pair(5 * pixels, Place::download)})
    made.buffers.push_back(made_buffer(4 * words, place));
  const vk::DescriptorPoolSize size(vk::DescriptorType::eStorageBuffer, bindings);
  made.sets = vk::raii::DescriptorPool(
      device_, vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, size));
  const vk::DescriptorSetLayout set_layout = *set_layout_;
  made.set = std::move(
      vk::raii::DescriptorSets(device_, vk::DescriptorSetAllocateInfo(*made.sets, set_layout)).front());
  std::vector<vk::DescriptorBufferInfo> whole;
  for (const Buffer& one : made.buffers) whole.emplace_back(*one.buffer, 0, VK_WHOLE_SIZE);
  device_.updateDescriptorSets(
      vk::WriteDescriptorSet(*made.set, 0, 0, vk::DescriptorType::eStorageBuffer, {}, whole), {});
  made.commands =
      std::move(vk::raii::CommandBuffers(
                    device_, vk::CommandBufferAllocateInfo(*commands_, vk::CommandBufferLevel::ePrimary, 1))
                    .front());
  return made;
}

void VulkanEngine::record(const Program& program, const Pipelines& run) const {
  using Stage = vk::PipelineStageFlagBits;
  using Access = vk::AccessFlagBits;
  const vk::raii::CommandBuffer& commands = program.commands;
  const auto wait = [&](vk::PipelineStageFlags next, vk::AccessFlags access) {
    commands.pipelineBarrier(Stage::eComputeShader, next, {}, vk::MemoryBarrier(Access::eShaderWrite, access),
                             {}, {});
  };
  const auto wait_for_kernels = [&] {
    wait(Stage::eComputeShader, Access::eShaderRead | Access::eShaderWrite);
  };
  const auto stamp = [&](std::uint32_t i) {
    if (traits_.clock_mask != 0) commands.writeTimestamp(Stage::eBottomOfPipe, *clock_, i);
  };
  const auto dispatch = [&](Kernel kernel, std::uint64_t paths, std::uint32_t lanes) {
    const auto i = static_cast<std::uint32_t>(kernel);
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *run[i]);
    const std::uint64_t teams = tuning_.group / lanes;
    constexpr std::uint64_t kMostGroups = 65'535;  // promised; only `describe` may want more, and goes round
    commands.dispatch(static_cast<std::uint32_t>(std::min(kMostGroups, (paths + teams - 1) / teams)), 1, 1);
    stamp(i + 1);
  };
  const auto columns = static_cast<std::uint64_t>(program.search.width),
             rows = static_cast<std::uint64_t>(program.search.height);
  const std::uint32_t lanes = program.team.lanes;

  commands.begin(vk::CommandBufferBeginInfo());
  if (traits_.clock_mask != 0) commands.resetQueryPool(*clock_, 0, kKernels + 1);
  commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *layout_, 0, *program.set, {});
  commands.pushConstants<Search>(*layout_, vk::ShaderStageFlagBits::eCompute, 0, program.search);
  wait_for_kernels();  // of the pair before
  stamp(0);
  dispatch(Kernel::describe, columns * rows, 1);
  wait_for_kernels();
  dispatch(Kernel::down, columns, lanes);
  wait_for_kernels();
  dispatch(Kernel::up, columns, lanes);
  dispatch(Kernel::left, rows, lanes);  // beside it: each reads the costs and writes a volume of its own
  wait_for_kernels();
  dispatch(Kernel::right, rows, lanes);
  wait(Stage::eHost, Access::eHostRead);
  commands.end();
}

void VulkanEngine::prepare(const Search& search) {
  if (program_ && program_->search == search) return;
  program_.reset();  // first: both may not fit into memory
  Program made = made_program(search);
  record(made, pipelines_for(made.team));
  program_.emplace(std::move(made));
  is_first_ = true;
}

// ---- pairs ----

void VulkanEngine::submit(const StereoPair& pair, const MatchConfig& config,
                          const SemiGlobalConfig& penalties) {
  const auto [width, height] = pair.size();
  const Search search{width, height, config.min_disparity, config.num_disparities, (width + 3) / 4};
  guarded(name(), [&] {
    if (is_at_work_) wait();  // for a pair that was never taken
    prepare(search);
    auto* to = program_->buffers[given].as<std::uint32_t>();
    to = store_pixels(pair.left(), search.row_words, to);
    to = store_pixels(pair.right(), search.row_words, to);
    const kernels::SemiGlobalPenalties table = kernels::penalty_table(penalties);
    *to++ = table.small;
    std::ranges::copy(table.large, to);
    maps_ = config.maps;
    queue_.submit(vk::SubmitInfo({}, {}, *program_->commands), *fence_);
    is_at_work_ = true;
  });
}

void VulkanEngine::wait() {
  if (device_.waitForFences(*fence_, VK_TRUE, patience()) == vk::Result::eTimeout)
    throw Lost(name() + " has not answered for " + std::to_string(patience() / kSecond) + " s", true);
  is_at_work_ = is_first_ = false;
  device_.resetFences(*fence_);
  read_clock();
}

Matches VulkanEngine::finish(const Exec& exec) {
  const Search& search = program_->search;
  Matches out = kernels::make_matches({search.width, search.height}, maps_, exec.pool);
  guarded(name(), [&] { wait(); });
  const auto* const all = program_->buffers[found].as<const std::uint32_t>();
  constexpr int kLeastRows = 16;
  parallel_for(exec, search.height, kLeastRows, [&](int first, int last) {
    for (int y = first; y < last; ++y) unpack_row(all, search, y, out);
  });
  return out;
}

void VulkanEngine::read_clock() {
  const Search& search = program_->search;
  const std::int64_t pixels = search.pixels(), volume = 4 * pixels * program_->team.all_words();
  const std::int64_t images = std::int64_t{8} * search.row_words * search.height;
  const std::array<std::int64_t, kKernels> bytes{images + 12 * pixels, 2 * volume, 3 * volume, 2 * volume,
                                                 3 * volume + 20 * pixels};
  work_.clear();
  for (std::size_t i = 0; i < kKernels; ++i) work_.push_back({kKernelNames[i], 0, bytes[i], 1});
  if (traits_.clock_mask == 0) return;
  const auto [result, ticks] =
      clock_.getResults<std::uint64_t>(0, kKernels + 1, (kKernels + 1) * sizeof(std::uint64_t),
                                       sizeof(std::uint64_t), vk::QueryResultFlagBits::e64);
  if (result != vk::Result::eSuccess) return;
  for (std::size_t i = 0; i < kKernels; ++i) {
    work_[i].ms =
        static_cast<double>((ticks[i + 1] - ticks[i]) & traits_.clock_mask) * traits_.ns_per_tick * 1e-6;
  }
}

}  // namespace

std::unique_ptr<Engine> vulkan_engine(FindFunction find, std::size_t number, Tuning tuning,
                                      const std::string& name) {
  try {
    return std::make_unique<VulkanEngine>(find, number, tuning, name);
  } catch (const vk::SystemError& failed) {
    throw Lost(std::string("the device cannot be opened (") + failed.what() + ")");
  }
}

}  // namespace cairn::device
