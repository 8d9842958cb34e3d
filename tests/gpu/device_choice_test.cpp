#include "engine/gpu/device_choice.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>

#include "engine/gpu/command_list.hpp"
#include "tests/labels.hpp"

namespace palpate::device_choice_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

const std::array kGpus{GpuDescription{"llvmpipe (LLVM 15)", VK_PHYSICAL_DEVICE_TYPE_CPU},
                       GpuDescription{"Intel Iris", VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU},
                       GpuDescription{"NVIDIA H200", VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU},
                       GpuDescription{"NVIDIA T4", VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU}};

VkQueueFamilyProperties family(VkQueueFlags flags, std::uint32_t count) {
  return {.queueFlags = flags, .queueCount = count};
}

constexpr VkQueueFlags kGraphics = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT;
constexpr VkQueueFlags kCompute = VK_QUEUE_COMPUTE_BIT | VK_QUEUE_TRANSFER_BIT;

}  // namespace

TEST_CASE("without a request the first discrete GPU is selected, then integrated, then CPU") {
  CHECK(chooseGpu(kGpus, "") == 2);
  CHECK(chooseGpu(std::span(kGpus).first(2), "") == 1);
  CHECK(chooseGpu(std::span(kGpus).first(1), "") == 0);
}

TEST_CASE("a GPU is selected by number, or by part of its name in any case") {
  CHECK(chooseGpu(kGpus, "0") == 0);
  CHECK(chooseGpu(kGpus, "3") == 3);
  CHECK(chooseGpu(kGpus, "t4") == 3);
  CHECK(chooseGpu(kGpus, "LLVMPIPE") == 0);
}

TEST_CASE("a request that cannot be met lists the available GPUs") {
  CHECK_THROWS_WITH_AS(chooseGpu(std::span(kGpus).first(1), "4"),
                       "unknown GPU number '4'; choose 0 (llvmpipe (LLVM 15))", GpuError);
  CHECK_THROWS_WITH_AS(chooseGpu(std::span(kGpus).first(1), "radeon"),
                       "unknown GPU 'radeon'; choose 0 (llvmpipe (LLVM 15))", GpuError);
  CHECK_THROWS_WITH_AS(chooseGpu({}, ""), doctest::Contains("mesa-vulkan-drivers"), GpuError);
}

TEST_CASE("the best size of subgroups is the driver's usual one, or 16 on Intel's GPUs; all are at most 64") {
  struct Gpu {
    const char* name;
    std::uint32_t vendor;
    SubgroupSizes sizes;
    std::vector<std::uint32_t> usable;
  };
  constexpr std::uint32_t kIntel = 0x8086, kAmd = 0x1002, kQualcomm = 0x5143;
  for (const Gpu& gpu :
       {Gpu{"Mesa on Intel", kIntel, {.usual = 32, .min = 8, .max = 32, .canRequire = true}, {16, 32, 8}},
        {"Intel, without a choice", kIntel, {.usual = 32, .min = 8, .max = 32}, {32}},
        {"NVIDIA", 0x10de, {.usual = 32, .min = 32, .max = 32, .canRequire = true}, {32}},
        {"RADV on RDNA", kAmd, {.usual = 64, .min = 32, .max = 64, .canRequire = true}, {64, 32}},
        {"Adreno", kQualcomm, {.usual = 128, .min = 64, .max = 128, .canRequire = true}, {64}},
        {"Adreno, without a choice", kQualcomm, {.usual = 128, .min = 64, .max = 128}, {}},
        {"SwiftShader", 0x1ae0, {.usual = 4, .min = 4, .max = 4}, {4}},
        {"too narrow", 0, {.usual = 1, .min = 1, .max = 2, .canRequire = true}, {}},
        {"no power of two", 0, {.usual = 24, .min = 24, .max = 24}, {}}}) {
    CAPTURE(gpu.name);
    CHECK(usableSubgroupSizes(gpu.sizes, gpu.vendor) == gpu.usable);
  }
}

TEST_CASE("latency gets a compute-only family, throughput the graphics family") {
  const std::array families{family(kGraphics, 16), family(VK_QUEUE_TRANSFER_BIT, 2), family(kCompute, 8)};
  const auto roles = chooseQueues(families);
  REQUIRE(roles);
  CHECK(roles->latency == QueueChoice{2, 0});
  CHECK(roles->throughput == QueueChoice{0, 0});
  CHECK(roles->draws);
  CHECK_FALSE(roles->shared());
}

TEST_CASE("latency gets a second queue of the same family if there is no other family") {
  const std::array families{family(kGraphics, 4)};
  const auto roles = chooseQueues(families);
  REQUIRE(roles);
  CHECK(roles->latency == QueueChoice{0, 1});
  CHECK_FALSE(roles->shared());
}

TEST_CASE("a single queue is shared by all roles") {
  const std::array families{family(kGraphics, 1)};
  CHECK(chooseQueues(families)->shared());
}

TEST_CASE("background work has its own queue if possible, and shares that of latency only if all share one") {
  struct Case {
    std::vector<VkQueueFamilyProperties> families;
    QueueChoice background;
    bool shares;
  };
  const std::array cases{Case{{family(kGraphics, 16), family(kCompute, 8)}, {1, 1}, false},
                         Case{{family(kGraphics, 16), family(kCompute, 1)}, {0, 1}, false},
                         Case{{family(kGraphics, 1), family(kCompute, 8)}, {1, 1}, false},
                         Case{{family(kGraphics, 1), family(kCompute, 1)}, {0, 0}, true},
                         Case{{family(kGraphics, 3)}, {0, 2}, false},
                         Case{{family(kGraphics, 2)}, {0, 0}, true},
                         Case{{family(kGraphics, 1)}, {0, 0}, true}};
  for (const Case& each : cases) {
    const auto roles = chooseQueues(each.families);
    REQUIRE(roles);
    CHECK(roles->background == each.background);
    CHECK(roles->backgroundShares() == each.shares);
    CHECK((roles->background == roles->latency) == roles->shared());
    const auto used = roles->families();
    CHECK(std::ranges::count(used, roles->background.family) == 1);
    CHECK(used.size() == each.families.size());
  }
}

TEST_CASE("all roles can share one queue, and queues can have equal priorities") {
  const std::array families{family(kGraphics, 16), family(kCompute, 8)};
  const auto same = chooseQueues(families, QueueArrangement::same);
  REQUIRE(same);
  CHECK(same->shared());
  CHECK(same->backgroundShares());
  CHECK(same->draws);
  CHECK(same->latency == QueueChoice{0, 0});
  CHECK(same->families() == std::vector<std::uint32_t>{0});

  const auto separate = chooseQueues(families), equal = chooseQueues(families, QueueArrangement::noPriority);
  CHECK(equal->latency == separate->latency);
  CHECK(equal->throughput == separate->throughput);
  CHECK(equal->background == separate->background);
}

TEST_CASE("the latency queue has priority, globally if it has its own family, unless disabled") {
  struct Case {
    std::vector<VkQueueFamilyProperties> families;
    QueueArrangement arrangement;
    std::vector<FamilyQueues> queues;
  };
  const VkQueueFamilyProperties graphics = family(kGraphics, 16), compute = family(kCompute, 8);
  const std::array cases{
      Case{{graphics, compute}, QueueArrangement::separate, {{0, {0.5f}, false}, {1, {1.0f, 0.0f}, true}}},
      Case{{graphics, compute}, QueueArrangement::noPriority, {{0, {0.5f}, false}, {1, {0.5f, 0.5f}, false}}},
      Case{{graphics, compute}, QueueArrangement::same, {{0, {0.5f}, false}}},
      Case{{graphics}, QueueArrangement::separate, {{0, {0.5f, 1.0f, 0.0f}, false}}},
      Case{{graphics}, QueueArrangement::noPriority, {{0, {0.5f, 0.5f, 0.5f}, false}}},
      Case{{family(kGraphics, 1)}, QueueArrangement::separate, {{0, {1.0f}, false}}}};
  for (const Case& each : cases) {
    const auto queues = queuesFor(*chooseQueues(each.families, each.arrangement), each.arrangement);
    REQUIRE(queues.size() == each.queues.size());
    for (std::size_t i = 0; i < queues.size(); ++i) {
      CHECK(queues[i].family == each.queues[i].family);
      CHECK(queues[i].priorities == each.queues[i].priorities);
      CHECK(queues[i].high == each.queues[i].high);
    }
  }
}

TEST_CASE("a GPU without graphics queues computes; one without compute queues is refused") {
  const std::array computeOnly{family(kCompute, 2)};
  const auto roles = chooseQueues(computeOnly);
  REQUIRE(roles);
  CHECK(roles->throughput.family == 0);
  CHECK_FALSE(roles->draws);
  CHECK(roles->latency == QueueChoice{0, 1});
  const std::array transferOnly{family(VK_QUEUE_TRANSFER_BIT, 2)};
  CHECK_FALSE(chooseQueues(transferOnly));
}

TEST_CASE("all missing features are named, with the device") {
  const std::array some{FeatureState{"bufferDeviceAddress", false}, FeatureState{"scalarBlockLayout", true},
                        FeatureState{"synchronization2", false}};
  CHECK_THROWS_WITH_AS(requireFeatures(some, "Old GPU"),
                       doctest::Contains("Old GPU lacks bufferDeviceAddress, synchronization2"), GpuError);
  CHECK_NOTHROW(requireFeatures(std::span(some).subspan(1, 1), "Old GPU"));
}

TEST_CASE("a failed Vulkan call throws an error of its kind that names call and device") {
  CHECK_NOTHROW(checkVk(VK_SUCCESS, "vkQueueSubmit2", "GPU"));
  CHECK_NOTHROW(checkVk(VK_TIMEOUT, "vkWaitForFences", "GPU"));
  CHECK_THROWS_WITH_AS(checkVk(VK_ERROR_DEVICE_LOST, "vkQueueSubmit2", "GPU"),
                       doctest::Contains("GPU: vkQueueSubmit2 failed with VK_ERROR_DEVICE_LOST"), DeviceLost);
  CHECK_THROWS_AS(checkVk(VK_ERROR_OUT_OF_DEVICE_MEMORY, "vkAllocateMemory", "GPU"), OutOfGpuMemory);
  CHECK_THROWS_AS(checkVk(VK_ERROR_OUT_OF_HOST_MEMORY, "vkAllocateMemory", "GPU"), OutOfGpuMemory);
  CHECK_THROWS_AS(checkVk(VK_ERROR_INITIALIZATION_FAILED, "vkCreateDevice", "GPU"), GpuError);
}

TEST_CASE("a grid beyond one axis uses a second, covers all groups and wastes less than a row") {
  for (const std::uint64_t groups : {1ull, 65'535ull, 65'536ull, 65'537ull, 1'000'003ull, 400'000'000ull}) {
    const GroupGrid grid = groupGrid(groups, 65'535);
    CHECK(grid.x <= 65'535);
    CHECK(grid.y <= 65'535);
    CHECK(std::uint64_t{grid.x} * grid.y >= groups);
    CHECK(std::uint64_t{grid.x} * grid.y < groups + grid.y);
  }
  CHECK_THROWS_AS(groupGrid(5'000'000'000ull, 65'535), GpuError);
}

TEST_SUITE_END();

}  // namespace palpate::device_choice_test
