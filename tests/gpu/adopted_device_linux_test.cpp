// A device created by another program, with Vulkan of its own, which the program continues to use.
#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <thread>

#include "engine/gpu/command_list.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/spatial/sorted_grid.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/test_shaders.hpp"
#include "tests/gpu/add_one.h"
#include "tests/gpu/host_program.hpp"
#include "tests/labels.hpp"

namespace palpate::adopted_device_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

// Adds one to each of many numbers, repeatedly.
void checkAdding(Device& device, Queue& queue) {
  constexpr std::uint32_t kCount = 10'007, kRounds = 20;
  const ComputePipeline addOne(device, shader_code::gpu_add_one,
                               {.workgroupSize = 64, .pushBytes = sizeof(shared::AddOneArgs)});
  const Buffer numbers = Buffer::of<std::uint32_t>(device, kCount, Memory::device, "numbers");
  CommandList list(device, queue, "adding");
  list.begin();
  for (std::uint32_t round = 0; round < kRounds; ++round)
    list.dispatch(addOne, kCount,
                  shared::AddOneArgs{.from = numbers.address(), .to = numbers.address(), .count = kCount, .unused = 0});
  list.end();
  upload(device, queue, numbers, std::vector<std::uint32_t>(kCount, 3));
  for (int run = 0; run < 10; ++run) queue.run(list);
  CHECK(download<std::uint32_t>(device, queue, numbers, kCount) ==
        std::vector<std::uint32_t>(kCount, 3 + 10 * kRounds));
}

// Builds the index of a grid of points and compares its order with the CPU's.
void checkHash(Device& device) {
  PointCloud cloud;
  for (int i = 0; i < 5000; ++i)
    cloud.positions.emplace_back(static_cast<float>(i * 37 % 101), static_cast<float>(i * 53 % 89),
                                 static_cast<float>(i % 7));
  cloud.normals.assign(cloud.positions.size(), Vec3(0, 0, 1));
  const HashGrid grid = makeHashGrid(Vec3(0), 3, cloud.size());
  LiveCloud live(device, cloud);
  SpatialHash hash(device, grid, live.count());
  hash.build(live);
  SortedGrid reference(grid, 1);
  reference.build(cloud.positions);
  const std::vector<PointState> points = live.points();
  REQUIRE(points.size() == cloud.size());
  std::size_t others = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    others += points[i].position != cloud.positions[reference.placed()[i].number];
  CHECK(others == 0);
}

}  // namespace

TEST_CASE("palpate shares a device with the program that created it and leaves it usable") {
  HostProgram host;
  {
    Device device(host.lend());
    CHECK(device.roles().shared());
    CHECK_FALSE(device.draws());
    std::atomic<bool> well = true;
    std::thread hosts([&] { well = host.worksItself(200); });
    checkAdding(device, device.latencyQueue());
    checkAdding(device, device.throughputQueue());
    checkHash(device);
    hosts.join();
    CHECK(well);
    CHECK(host.holds() >= 20);
    device.waitIdle();
  }
  CHECK(host.worksItself(1));
  // And again: nothing is left behind that would be in the way.
  Device again(host.lend());
  checkAdding(again, again.backgroundQueue());
}

TEST_CASE("a lent device and one of palpate's own work side by side") {
  HostProgram host;
  Device adopted(host.lend());
  {
    Device own({.gpu = "", .validation = Validation::off});
    checkAdding(own, own.latencyQueue());
    checkAdding(adopted, adopted.latencyQueue());
  }
  checkAdding(adopted, adopted.latencyQueue());
}

TEST_CASE("a lent device without a required feature is refused by the feature's name and stays usable") {
  for (const char* feature : {"bufferDeviceAddress", "scalarBlockLayout", "synchronization2", "computeFullSubgroups"}) {
    CAPTURE(feature);
    HostProgram host(feature);
    CHECK_THROWS_WITH_AS(Device{host.lend()}, doctest::Contains(feature), GpuError);
    CHECK(host.holds() == 0);
    CHECK(host.worksItself(1));
  }
}

TEST_CASE("an incompletely described lent device, or one without a queue, is refused with the missing part") {
  HostProgram host;
  const auto refused = [&](auto&& change, const char* name) {
    HostDevice lent = host.lend();
    change(lent);
    CHECK_THROWS_WITH_AS(Device{lent}, doctest::Contains(name), GpuError);
  };
  refused([](HostDevice& lent) { lent.features = nullptr; }, "features");
  refused([](HostDevice& lent) { lent.throughput = {}; }, "a queue for throughput");
  refused([](HostDevice& lent) { lent.latency = {.handle = lent.throughput.handle, .family = 99}; }, "family 99");
  refused([](HostDevice& lent) { lent.apiVersion = VK_API_VERSION_1_2; }, "Vulkan 1.3");
  refused([](HostDevice& lent) { lent.device = VK_NULL_HANDLE; }, "a device");
  refused([](HostDevice& lent) { lent.getInstanceProcAddr = nullptr; }, "vkGetInstanceProcAddr");
  refused([](HostDevice& lent) { lent.unlock = nullptr; }, "unlock");
  CHECK(host.worksItself(1));
}

TEST_CASE("features are found in the structs of a Vulkan version and in those of its extensions") {
  VkPhysicalDeviceVulkan13Features v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  v13.synchronization2 = VK_TRUE;
  VkPhysicalDeviceScalarBlockLayoutFeatures layout{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SCALAR_BLOCK_LAYOUT_FEATURES,
      .pNext = &v13,
      .scalarBlockLayout = VK_TRUE};
  const VkPhysicalDeviceFeatures2 chain{
      .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &layout, .features = {.shaderInt64 = VK_TRUE}};
  const Features found = featuresIn(chain);
  CHECK(found.synchronization2);
  CHECK(found.scalarBlockLayout);
  CHECK(found.int64);
  CHECK_FALSE((found.computeFullSubgroups || found.bufferDeviceAddress || found.bufferInt64Atomics || found.clocks ||
               found.dynamicRendering || found.largePoints));
}

TEST_CASE("lent queues serve the roles they were lent for, and other roles share the throughput queue") {
  std::array<VkQueueFamilyProperties, 2> families{};
  families[0] = {.queueFlags = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT, .queueCount = 4};
  families[1] = {.queueFlags = VK_QUEUE_COMPUTE_BIT, .queueCount = 4};
  const auto queue = [](std::uintptr_t number) { return reinterpret_cast<VkQueue>(number); };
  HostDevice host{.throughput = {queue(1), 0}};
  QueueRoles roles = rolesOf(host, families);
  CHECK(roles.shared());
  CHECK(roles.backgroundShares());
  CHECK(roles.draws);
  host.latency = {queue(2), 1};
  host.background = {queue(3), 1};
  roles = rolesOf(host, families);
  CHECK(roles.throughput == QueueChoice{0, 0});
  CHECK(roles.latency == QueueChoice{1, 0});
  CHECK(roles.background == QueueChoice{1, 1});
  host.throughput = {queue(4), 1};
  CHECK_FALSE(rolesOf(host, families).draws);
}

TEST_SUITE_END();

}  // namespace palpate::adopted_device_test
