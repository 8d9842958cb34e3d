#include "engine/study/gather_brute.hpp"

#include <algorithm>

#include "shaders/study.hpp"

namespace palpate {

namespace {

constexpr PipelineOptions brutePipeline() {
  return {.workgroupSize = shared::kContactWorkgroup, .pushBytes = sizeof(shared::GatherBruteArgs)};
}

std::uint32_t chunksOf(std::uint32_t points) {
  return static_cast<std::uint32_t>((std::uint64_t{points} + shared::kBruteChunk - 1) / shared::kBruteChunk);
}

}  // namespace

GatherBrute::GatherBrute(Device& device, std::uint32_t points, std::uint32_t mostPoints)
    : points_(points),
      mostPoints_(mostPoints),
      gather_(device, shader_code::contact_gather_brute, brutePipeline()),
      sum_(device, shader_code::contact_gather_brute_sum, brutePipeline()),
      starts_(Buffer::of<std::uint32_t>(device, std::uint64_t{chunksOf(points)} + 1, Memory::device, "brute starts")) {
  // Each invocation of the sum iterates over its run of chunks twice.
  PALPATE_CHECK_LE(2 * (chunksOf(points) / shared::kContactWorkgroup + 1), shared::kContactWorkBudget);
}

std::uint64_t GatherBrute::slots() const { return std::min(points_, mostPoints_); }

void GatherBrute::record(CommandList& list, std::uint32_t, const GatherIo& io) const {
  PALPATE_CHECK_LE(io.cloud.slots, points_);
  shared::GatherBruteArgs args{.cloud = io.cloud,
                               .pose = io.pose,
                               .state = io.state,
                               .gathered = io.patch,
                               .starts = starts_.address(),
                               .radius = io.radius,
                               .chunks = chunksOf(io.cloud.slots),
                               .fill = 0,
                               .mostPoints = mostPoints_};
  const std::uint64_t threads = std::uint64_t{args.chunks} * shared::kContactWorkgroup;
  list.dispatch(gather_, threads, args);
  list.dispatch(sum_, shared::kContactWorkgroup, args);
  args.fill = 1;
  list.dispatch(gather_, threads, args);
}

}  // namespace palpate
