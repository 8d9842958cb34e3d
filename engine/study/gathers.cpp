// The table of the query methods that the fused one is compared with.
#include <algorithm>
#include <array>

#include "engine/contact/gather.hpp"
#include "shaders/study.hpp"

namespace palpate {

namespace {

/// The two passes shared by the bucket methods: a plan of the cells around the probe, and the gather of planned cells.
/// The methods differ in how the second is launched, and how often.
class BucketPasses {
 public:
  /// `cells`: maximum number of cells that one gather visits.
  BucketPasses(Device& device, std::uint32_t cells)
      : cells_(cells),
        plan_(device, shader_code::contact_gather_plan,
              {.workgroupSize = shared::kContactWorkgroup, .pushBytes = sizeof(shared::GatherPlanArgs)}),
        gather_(device, shader_code::contact_gather_buckets,
                {.workgroupSize = shared::kGatherChunk, .pushBytes = sizeof(shared::GatherBucketsArgs)}),
        planned_(Buffer::of<shared::GatherCell>(device, cells, Memory::device, "gather cells")) {}

  std::uint32_t cells() const { return cells_; }
  std::uint64_t slots() const {
    // Each cell may leave its last chunk almost empty.
    return std::uint64_t{cells_} * shared::kGatherChunk +
           std::uint64_t{gatherRounds(cells_)} * shared::kPatchRoundCandidates;
  }

  /// `plan`: a kPlan... of shaders/shared/gather.h, which defines the contents of `launch`.
  void recordPlan(CommandList& list, const GatherIo& io, std::uint32_t plan, const Buffer& launch) const {
    list.dispatch(plan_, shared::kContactWorkgroup,
                  shared::GatherPlanArgs{.cloud = io.cloud,
                                         .pose = io.pose,
                                         .state = io.state,
                                         .gathered = io.patch,
                                         .cells = planned_.address(),
                                         .launch = launch.address(),
                                         .radius = io.radius,
                                         .mostCells = cells_,
                                         .plan = plan,
                                         .unused = 0});
  }

  /// One row of workgroups for each cell from `firstCell` on; reads the indirect command in `groups` at `offset` bytes.
  void recordGather(CommandList& list, const GatherIo& io, const Buffer& groups, std::uint64_t offset = 0,
                    std::uint32_t firstCell = 0) const {
    list.dispatchIndirect(gather_, groups,
                          shared::GatherBucketsArgs{.cloud = io.cloud,
                                                    .pose = io.pose,
                                                    .gathered = io.patch,
                                                    .cells = planned_.address(),
                                                    .firstCell = firstCell,
                                                    .radius = io.radius},
                          offset);
  }

 private:
  std::uint32_t cells_;
  ComputePipeline plan_, gather_;
  Buffer planned_;
};

constexpr PipelineOptions brutePipeline() {
  return {.workgroupSize = shared::kContactWorkgroup, .pushBytes = sizeof(shared::GatherBruteArgs)};
}

std::uint32_t chunksOf(std::uint32_t points) {
  return static_cast<std::uint32_t>((std::uint64_t{points} + shared::kBruteChunk - 1) / shared::kBruteChunk);
}

/// Brute force (thesis section 4.3.1): visits every point of the cloud and needs no index.
class GatherBrute final : public Gather {
 public:
  /// `points`: maximum number of points of the cloud. `mostPoints`: capacity of a patch; more points in reach are
  /// subsampled.
  GatherBrute(Device& device, std::uint32_t points, std::uint32_t mostPoints)
      : points_(points),
        mostPoints_(mostPoints),
        gather_(device, shader_code::contact_gather_brute, brutePipeline()),
        sum_(device, shader_code::contact_gather_brute_sum, brutePipeline()),
        starts_(
            Buffer::of<std::uint32_t>(device, std::uint64_t{chunksOf(points)} + 1, Memory::device, "brute starts")) {
    // Each invocation of the sum iterates over its run of chunks twice.
    PALPATE_CHECK_LE(2 * (chunksOf(points) / shared::kContactWorkgroup + 1), shared::kContactWorkBudget);
  }

  std::uint64_t slots() const override { return std::min(points_, mostPoints_); }
  void record(CommandList& list, std::uint32_t, const GatherIo& io) const override {
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

 private:
  std::uint32_t points_, mostPoints_;
  ComputePipeline gather_, sum_;
  Buffer starts_;
};

/// Array-based dynamic parallelism (thesis section 4.3.3): the GPU lists the occupied buckets and makes one launch,
/// with a workgroup for each.
class GatherIndirect final : public Gather {
 public:
  GatherIndirect(Device& device, std::uint32_t cells)
      : passes_(device, cells),
        command_(Buffer::of<VkDispatchIndirectCommand>(device, 1, Memory::device, "gather command")) {}

  std::uint64_t slots() const override { return passes_.slots(); }
  void record(CommandList& list, std::uint32_t, const GatherIo& io) const override {
    passes_.recordPlan(list, io, shared::kPlanList, command_);
    passes_.recordGather(list, io, command_);
  }

 private:
  BucketPasses passes_;
  Buffer command_;
};

/// Naive dynamic parallelism (thesis section 4.3.3): a launch for each bucket, of as many threads as the bucket has
/// points. In Vulkan: an indirect dispatch for every possible cell, recorded ahead, whose size the plan writes.
class GatherNaive final : public Gather {
 public:
  GatherNaive(Device& device, std::uint32_t cells)
      : passes_(device, cells),
        commands_(Buffer::of<VkDispatchIndirectCommand>(device, cells, Memory::device, "gather commands")) {}

  std::uint64_t slots() const override { return passes_.slots(); }
  void record(CommandList& list, std::uint32_t, const GatherIo& io) const override {
    passes_.recordPlan(list, io, shared::kPlanCommands, commands_);
    const auto children = list.independent();
    for (std::uint32_t cell = 0; cell < passes_.cells(); ++cell)
      passes_.recordGather(list, io, commands_, cell * sizeof(VkDispatchIndirectCommand), cell);
  }

 private:
  BucketPasses passes_;
  Buffer commands_;
};

/// Two steps (thesis section 4.3.2): a first submission counts the points of the buckets; the host reads the largest
/// count and launches buckets x largest count threads with a second one, recorded ahead like the first.
class GatherTwoStep final : public Gather {
 public:
  GatherTwoStep(Device& device, std::uint32_t cells)
      : passes_(device, cells),
        counts_(Buffer::of<std::uint32_t>(device, 2, Memory::readback, "gather counts")),
        command_(Buffer::of<VkDispatchIndirectCommand>(device, 1, Memory::upload, "gather command")) {}

  std::uint64_t slots() const override { return passes_.slots(); }
  std::uint32_t submissions() const override { return 2; }
  void record(CommandList& list, std::uint32_t submission, const GatherIo& io) const override {
    if (submission == 0)
      passes_.recordPlan(list, io, shared::kPlanCounts, counts_);
    else
      passes_.recordGather(list, io, command_);
  }

  void resume() const override {
    const auto counts = counts_.mapped<const std::uint32_t>();
    const std::uint32_t buckets = counts[0], largest = counts[1];
    command_.mapped<VkDispatchIndirectCommand>()[0] = {
        .x = (largest + shared::kGatherChunk - 1) / shared::kGatherChunk, .y = buckets, .z = 1};
  }

 private:
  BucketPasses passes_;
  Buffer counts_, command_;
};

template <class Method>
std::unique_ptr<Gather> overCells(Device& device, const shared::HashGrid& grid, double radius, std::uint32_t) {
  return std::make_unique<Method>(device, cellsPerGather(grid, radius));
}

std::unique_ptr<Gather> overPoints(Device& device, const shared::HashGrid& grid, double radius, std::uint32_t points) {
  return std::make_unique<GatherBrute>(device, points,
                                       gatherRounds(cellsPerGather(grid, radius)) * shared::kPatchRoundCandidates);
}

}  // namespace

std::span<const GatherKind> gatherKinds() {
  static constexpr std::array<GatherKind, 4> kinds{{{QueryMethod::indirect, overCells<GatherIndirect>},
                                                    {QueryMethod::naive, overCells<GatherNaive>},
                                                    {QueryMethod::twoStep, overCells<GatherTwoStep>},
                                                    {QueryMethod::brute, overPoints}}};
  return kinds;
}

}  // namespace palpate
