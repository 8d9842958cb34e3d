#include "tests/gpu/shared_layout.h"

#include "engine/gpu/command_list.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/test_shaders.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"

namespace palpate::shared_layout_test {

TEST_SUITE_BEGIN(kPortable);

TEST_CASE_FIXTURE(GpuFixture, "a shader reads the struct that C++ wrote, field by field") {
  shared::LayoutPattern pattern{.a = 1,
                                .b = {2, 3, 4},
                                .c = {5, 6},
                                .d = 7,
                                .grid = {.origin = {8, 9, 10}, .inverseCell = 11, .bucketMask = 12, .blockBits = 13},
                                .e = {14, 15, 16, 17},
                                .m = {}};
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) pattern.m[column][row] = static_cast<float>(18 + column * 4 + row);
  const std::vector<shared::LayoutPattern> patterns{{}, pattern};

  const Buffer input = Buffer::of<shared::LayoutPattern>(device, 2, Memory::device, "patterns");
  const Buffer output = Buffer::of<float>(device, 33, Memory::device, "numbers");
  upload(device, input, patterns);
  const ComputePipeline pipeline(device, shader_code::gpu_shared_layout,
                                 {.workgroupSize = 32, .pushBytes = sizeof(shared::LayoutArgs)});
  CommandList list(device, device.latencyQueue(), "layout");
  list.begin();
  list.dispatch(pipeline, 1,
                shared::LayoutArgs{.pattern = input.address(), .numbers = output.address(), .scale = 3, .unused = 0});
  list.end();
  device.latencyQueue().run(list);
  const auto numbers = download<float>(device, output, 33);
  for (int i = 0; i < 33; ++i) CHECK(numbers[static_cast<std::size_t>(i)] == 3.0f * static_cast<float>(i + 1));
}

TEST_SUITE_END();

}  // namespace palpate::shared_layout_test
