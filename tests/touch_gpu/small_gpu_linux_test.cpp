// GPUs with only the limits that Vulkan guarantees: an insufficient limit is reported, and with sufficient limits the
// answers equal those of any other GPU.
#include "tests/lost_gpu/lost_gpu.hpp"

#include "engine/gpu/compute_pipeline.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/says.hpp"
#include "tests/scenes.hpp"

namespace palpate::small_gpu_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

struct Felt {
  std::vector<Contact> contacts;
  PointCloud cloud;
};

/// A press that sculpts, with more points in reach than a small workgroup holds.
Felt press(Device& device) {
  const Scene scene = makeScene("sphere", 6'000);
  TouchSide touch(
      device, scene.cloud,
      {.radius = 3.5 * scene.radius, .brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 0.2, .radius = 6}});
  Felt felt{.contacts = {}, .cloud = scene.cloud};
  for (int i = 0; i < 20; ++i)
    felt.contacts.push_back(touch.query({.time_s = 1e-3 * i, .hip = {0, 0, 51 - 0.2 * i}}, 0));
  touch.finish();
  touch.readBack(felt.cloud);
  return felt;
}

}  // namespace

TEST_CASE("a GPU below the requirements is refused, and all that it lacks is named") {
  const auto complaint = [](const std::string& gpu) {
    const LostGpuLayer layer(gpu);
    try {
      Device({.gpu = ""});
    } catch (const GpuError& error) {
      return std::string(error.what());
    }
    return std::string("it is taken");
  };
  const std::string least = complaint("minimum");
  CHECK(says(least, "maxComputeWorkGroupInvocations of 256 at least (it is 128)"));
  CHECK(says(least, "maxComputeWorkGroupSize[0] of 256 at least (it is 128)"));
  CHECK(says(least, "scalarBlockLayout"));
  CHECK(least.find("maxComputeSharedMemorySize") == std::string::npos);
  CHECK(says(complaint(kMinGpu + ",maxComputeSharedMemorySize=8192"),
             "maxComputeSharedMemorySize of 16384 at least (it is 8192)"));
  CHECK(says(complaint(kMinGpu + ",subgroupSize=2,minSubgroupSize=1,maxSubgroupSize=2"),
             "a subgroup size from 4 to 64 (it is 2, 1 to 2)"));
  for (const char* feature : {"bufferDeviceAddress", "synchronization2", "computeFullSubgroups"})
    CHECK(says(complaint(kMinGpu + "," + feature + "=0"), " lacks " + std::string(feature) + ";"));
  CHECK(complaint(kMinGpu) == "it is taken");
}

TEST_CASE("the minimum GPU gives the contacts and edits of every GPU") {
  const Felt here = press(plainDevice());
  const LostGpuLayer layer(kMinGpu);
  Device small({.gpu = "", .validation = askedCoreValidation()});
  REQUIRE(sharedBytes(small) == 16384);
  REQUIRE(small.largestBuffer() == 1 << 30);
  const Felt there = press(small);
  REQUIRE(there.contacts.size() == here.contacts.size());
  bool touched = false, spilled = false;
  for (std::size_t i = 0; i < here.contacts.size(); ++i) {
    CAPTURE(i);
    CHECK(there.contacts[i].proxy == here.contacts[i].proxy);
    CHECK(there.contacts[i].neighbours == here.contacts[i].neighbours);
    touched = touched || here.contacts[i].touching;
    spilled = spilled || here.contacts[i].neighbours > 400;
  }
  CHECK(touched);
  CHECK(spilled);
  CHECK(there.cloud.positions == here.cloud.positions);
  small.waitIdle();
  CHECK(small.instance().messages().take().empty());
}

TEST_SUITE_END();

}  // namespace palpate::small_gpu_test
