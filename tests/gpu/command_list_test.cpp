#include "engine/gpu/command_list.hpp"

#include <algorithm>
#include <numeric>

#include "engine/core/clock.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/test_shaders.hpp"
#include "tests/gpu/add_one.h"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"

namespace palpate::command_list_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

class CommandListFixture : public GpuFixture {
 protected:
  Buffer words(std::uint64_t count, Memory memory = Memory::device) {
    return Buffer::of<std::uint32_t>(device, count, memory, "words");
  }
  shared::AddOneArgs args(const Buffer& from, const Buffer& to, std::uint32_t count) {
    return {.from = from.address(), .to = to.address(), .count = count, .unused = 0};
  }

  ComputePipeline addOne{
      device, shader_code::gpu_add_one, {.workgroupSize = 64, .pushBytes = sizeof(shared::AddOneArgs)}};
};

}  // namespace

TEST_CASE_FIXTURE(CommandListFixture, "each command sees the writes of earlier commands without explicit barriers") {
  constexpr std::uint32_t kCount = 10'007, kRounds = 20;
  const Buffer a = words(kCount), b = words(kCount);
  CommandList list(device, device.latencyQueue(), "chain");
  list.begin();
  list.fill(a, 5, a.bytes());
  for (std::uint32_t round = 0; round < kRounds; ++round) {
    list.dispatch(addOne, kCount, args(a, b, kCount));
    list.dispatch(addOne, kCount, args(b, a, kCount));
  }
  list.end();
  for (int run = 1; run <= 3; ++run) device.latencyQueue().run(list);  // recorded once, submitted repeatedly
  CHECK(download<std::uint32_t>(device, a, kCount) == std::vector<std::uint32_t>(kCount, 5 + 2 * kRounds));
}

TEST_CASE("a preemptible pass does all its work once") {
  Device device({.gpu = "", .validation = Validation::off});  // passes are not sliced under validation,
  device.noteUrgentWork(1);                                   // or without urgent work
  const ComputePipeline sliced{device,
                               shader_code::gpu_add_one,
                               {.workgroupSize = 64, .pushBytes = sizeof(shared::AddOneArgs), .sliceThreads = 256}};
  // From less than one slice to more than the maximum per pass.
  for (const std::uint32_t count : {1u, 255u, 256u, 257u, 10'007u, 70'001u}) {
    CAPTURE(count);
    const Buffer a = Buffer::of<std::uint32_t>(device, count, Memory::device, "words");
    const shared::AddOneArgs args{.from = a.address(), .to = a.address(), .count = count, .unused = 0};
    for (Queue* queue : {&device.latencyQueue(), &device.throughputQueue()}) {
      CommandList list(device, *queue, "sliced");
      list.begin();
      list.fill(a, 7, a.bytes());
      list.dispatch(sliced, count, args);
      list.dispatch(sliced, count, args);
      list.end();
      CHECK(list.passes().size() == 3);
      queue->run(list);
      CHECK(download<std::uint32_t>(device, a, count) == std::vector<std::uint32_t>(count, 9));
    }
  }
}

TEST_CASE_FIXTURE(CommandListFixture, "lists submitted one after another see each other's writes, on either queue") {
  constexpr std::uint32_t kCount = 1000;
  const Buffer a = words(kCount), b = words(kCount);
  for (Queue* queue : {&device.latencyQueue(), &device.throughputQueue()}) {
    CommandList fill(device, *queue, "fill"), add(device, *queue, "add");
    fill.begin();
    fill.fill(a, 1, a.bytes());
    fill.end();
    add.begin();
    add.dispatch(addOne, kCount, args(a, b, kCount));
    add.copy(b, a, a.bytes());
    add.end();
    queue->submit(fill);
    Queue::Ticket last = 0;
    for (int i = 0; i < 20; ++i) {  // more than may be in flight
      if (last) queue->wait(last);
      last = queue->submit(add);
    }
    CHECK(queue->wait(last));
    CHECK(queue->isDone(last));
    CHECK(download<std::uint32_t>(device, a, kCount) == std::vector<std::uint32_t>(kCount, 21));
  }
}

TEST_CASE_FIXTURE(CommandListFixture,
                  "commands in an independent scope all run, and the next command waits for all of them") {
  constexpr std::uint32_t kCount = 5000;
  const Buffer zero = words(kCount), a = words(kCount), b = words(kCount), sum = words(kCount);
  CommandList list(device, device.latencyQueue(), "independent");
  list.begin();
  list.fill(zero, 0, zero.bytes());
  {
    const auto overlap = list.independent();
    list.dispatch(addOne, kCount, args(zero, a, kCount));
    list.dispatch(addOne, kCount, args(zero, b, kCount));
  }
  list.dispatch(addOne, kCount, args(a, sum, kCount));
  list.end();
  // Some drivers run commands in order anyway, so that no result would show a missing barrier.
  std::vector<bool> waits;
  for (const PassRecord& pass : list.passes()) waits.push_back(pass.waits);
  CHECK(waits == std::vector<bool>{true, true, false, true});
  device.latencyQueue().run(list);
  CHECK(download<std::uint32_t>(device, b, kCount) == std::vector<std::uint32_t>(kCount, 1));
  CHECK(download<std::uint32_t>(device, sum, kCount) == std::vector<std::uint32_t>(kCount, 2));
}

TEST_CASE_FIXTURE(CommandListFixture,
                  "an indirect dispatch runs the number of workgroups that an earlier pass wrote, including none") {
  constexpr std::uint32_t kCount = 1000;
  const Buffer a = words(kCount), b = words(kCount), groups = words(3);
  for (const std::uint32_t wanted : {0u, 1u, 3u, 16u}) {
    upload(device, groups, std::vector<std::uint32_t>{wanted, 1, 1});
    CommandList list(device, device.latencyQueue(), "indirect");
    list.begin();
    list.fill(a, 8, a.bytes());
    list.fill(b, 0, b.bytes());
    list.dispatchIndirect(addOne, groups, args(a, b, kCount));
    list.end();
    device.latencyQueue().run(list);
    const auto values = download<std::uint32_t>(device, b, kCount);
    CHECK(std::ranges::count(values, 9u) == std::min(wanted * 64, kCount));
  }
}

TEST_CASE_FIXTURE(CommandListFixture, "an indirect dispatch reads its command from any offset in a buffer") {
  constexpr std::uint32_t kCount = 1000;
  const Buffer a = words(kCount), b = words(kCount), groups = words(9);
  upload(device, groups, std::vector<std::uint32_t>{0, 1, 1, 2, 1, 1, 5, 1, 1});
  CommandList list(device, device.latencyQueue(), "offset");
  list.begin();
  list.fill(a, 8, a.bytes());
  list.fill(b, 0, b.bytes());
  list.dispatchIndirect(addOne, groups, args(a, b, kCount), 12);
  list.end();
  device.latencyQueue().run(list);
  CHECK(std::ranges::count(download<std::uint32_t>(device, b, kCount), 9u) == 2 * 64);
}

// A software driver runs commands in order: only the validation layer detects a missing barrier here.
TEST_CASE_FIXTURE(CommandListFixture, "an indirect dispatch waits for the copy in its own list that writes its size") {
  constexpr std::uint32_t kCount = 1000;
  const Buffer a = words(kCount), b = words(kCount), groups = words(3), size = words(3);
  upload(device, size, std::vector<std::uint32_t>{2, 1, 1});
  CommandList list(device, device.latencyQueue(), "indirect");
  list.begin();
  list.fill(a, 8, a.bytes());
  list.fill(b, 0, b.bytes());
  list.copy(size, groups, groups.bytes());
  list.dispatchIndirect(addOne, groups, args(a, b, kCount));
  list.end();
  device.latencyQueue().run(list);
  const auto values = download<std::uint32_t>(device, b, kCount);
  CHECK(std::ranges::count(values, 9u) == 2 * 64);
}

TEST_CASE_FIXTURE(CommandListFixture, "a list with more passes than can be timed is timed as a whole") {
  const Buffer a = words(10), b = words(10);
  CommandList list(device, device.latencyQueue(), "long", CommandList::Timing::passes);
  list.begin();
  for (int part = 0; part < 2; ++part) {
    const auto section = list.section(part == 0 ? "first" : "second");
    for (int i = 0; i < 300; ++i) list.dispatch(addOne, 10, args(a, b, 10));
  }
  list.end();
  device.latencyQueue().run(list);
  const auto passes = list.passes();
  REQUIRE(passes.size() == 600);
  CHECK(passes.front().gpu_us > 0);
  CHECK(passes.back().gpu_us == 0);
  CHECK(list.sectionTime_us("second") > 0);
}

TEST_CASE_FIXTURE(CommandListFixture, "passes and sections are named, counted and timed") {
  const Buffer a = words(100'000), b = words(100'000);
  CommandList list(device, device.latencyQueue(), "timed", CommandList::Timing::passes);
  list.begin();
  {
    const auto outer = list.section("outer");
    const auto inner = list.section("inner");
    list.fill(a, 7, a.bytes());
    list.dispatch(addOne, 100'000, args(a, b, 100'000));
    list.dispatch(addOne, 0, args(a, b, 0));  // nothing to do records nothing
  }
  list.end();
  CHECK(list.sectionTime_us("outer") == 0);  // it has not run yet
  const Stopwatch watch;
  device.latencyQueue().run(list);
  const double wall_us = watch.elapsed_us();
  CHECK(list.sectionTime_us("outer") < wall_us);
  CHECK(list.sectionTime_us("outer") > 1e-3 * wall_us);
  const auto passes = list.passes();
  REQUIRE(passes.size() == 2);
  CHECK(passes[0].name == "fill words");
  CHECK(passes[0].bytes == 400'000);
  CHECK(passes[1].name == "gpu_add_one");
  CHECK(passes[1].section == "outer/inner");
  CHECK(passes[1].threads == 100'000);
  CHECK(passes[1].gpu_us > 0);
  CHECK(list.sectionTime_us("outer") >= list.sectionTime_us("outer/inner"));
  CHECK(list.sectionTime_us("outer/inner") >= passes[1].gpu_us);
  CHECK(list.sectionTime_us("elsewhere") == 0);
}

TEST_CASE_FIXTURE(CommandListFixture,
                  "buffers of any size, also in several pieces, are uploaded and downloaded completely") {
  for (const std::size_t count : {0u, 1u, 3u, 65'537u, 17'000'001u}) {
    CAPTURE(count);
    std::vector<std::uint32_t> values(count);
    std::iota(values.begin(), values.end(), 3u);
    const Buffer buffer = words(count);
    CHECK(buffer.address() != 0);
    upload(device, buffer, values);
    CHECK(download<std::uint32_t>(device, buffer, count) == values);
  }
}

TEST_CASE_FIXTURE(CommandListFixture, "mapped buffers are visible to host and GPU, also after a move") {
  Buffer input = words(100, Memory::upload);
  Buffer output = words(100, Memory::readback);
  std::ranges::fill(input.mapped<std::uint32_t>(), 41u);
  const Buffer moved = std::move(input);
  CommandList list(device, device.latencyQueue(), "mapped");
  list.begin();
  list.dispatch(addOne, 100, args(moved, output, 100));
  list.end();
  device.latencyQueue().run(list);
  for (const std::uint32_t value : output.mapped<std::uint32_t>()) CHECK(value == 42);
}

TEST_CASE_FIXTURE(CommandListFixture, "a buffer that is too large is refused with its name, its size and the device") {
  const auto tooLarge = [&] { Buffer(device, 1ull << 60, Memory::device, "the whole world"); };
  CHECK_THROWS_WITH_AS(tooLarge(), doctest::Contains("the whole world"), OutOfGpuMemory);
  CHECK_THROWS_WITH_AS(tooLarge(), doctest::Contains(device.name().c_str()), OutOfGpuMemory);
}

TEST_CASE("the validation used by the tests reports a mistake") {
  if (askedValidation() == Validation::off) {
    MESSAGE("skipped: validation is off");
    return;
  }
  Device device({.gpu = "", .validation = askedValidation()});
  const VkBufferCreateInfo empty{
      .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = 0, .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT};
  VkBuffer buffer = VK_NULL_HANDLE;
  device.vk().vkCreateBuffer(device.handle(), &empty, nullptr, &buffer);
  device.vk().vkDestroyBuffer(device.handle(), buffer, nullptr);
  CHECK(device.instance().messages().take().size() > 0);
  if (askedValidation() != Validation::full) return;

  const Buffer a = Buffer::of<std::uint32_t>(device, 16, Memory::device, "too small");
  const ComputePipeline addOne(device, shader_code::gpu_add_one,
                               {.workgroupSize = 64, .pushBytes = sizeof(shared::AddOneArgs)});
  CommandList list(device, device.latencyQueue(), "mistaken");
  list.begin();
  // Reads far past the end of every buffer: only GPU-assisted validation detects it.
  list.dispatch(addOne, 1,
                shared::AddOneArgs{.from = a.address() + (1ull << 40), .to = a.address(), .count = 1, .unused = 0});
  list.end();
  device.latencyQueue().run(list);
  CHECK(device.instance().messages().count() > 0);
}

TEST_CASE_FIXTURE(CommandListFixture, "a pass with more workgroups than one axis allows reaches every element") {
  const ComputePipeline small(device, shader_code::gpu_add_one,
                              {.workgroupSize = 32, .pushBytes = sizeof(shared::AddOneArgs)});
  constexpr std::uint32_t kCount = 32 * 65'536 + 17;
  const Buffer a = words(kCount), b = words(kCount);
  CommandList list(device, device.latencyQueue(), "wide");
  list.begin();
  list.fill(a, 6, a.bytes());
  list.dispatch(small, kCount, args(a, b, kCount));
  list.end();
  device.latencyQueue().run(list);
  CHECK(std::ranges::count(download<std::uint32_t>(device, b, kCount), 7u) == kCount);
}

TEST_CASE_FIXTURE(CommandListFixture, "a device reports how much memory its buffers take") {
  const std::uint64_t before = device.allocatedBytes();
  {
    Buffer large = words(1 << 20);
    CHECK(device.allocatedBytes() >= before + (4 << 20));
    const Buffer moved = std::move(large);
    CHECK(device.allocatedBytes() < before + (5 << 20));
  }
  CHECK(device.allocatedBytes() == before);
}

TEST_SUITE_END();

}  // namespace palpate::command_list_test
