#include "engine/edit/resample.hpp"

#include <algorithm>

#include "engine/edit/edit_pipelines.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr std::uint64_t kWord = sizeof(std::uint32_t);
constexpr std::uint64_t kClaimsAt = sizeof(shared::Resampling) + kWord * shared::kBirthSlots;

std::uint64_t listBytes(std::uint64_t mostRequests) {
  return kClaimsAt + 2 * (kWord + sizeof(Vec3)) * shared::kClaimSlots + sizeof(shared::PointRequest) * mostRequests;
}

// Workgroups are as wide as the device's shared memory allows, which holds the neighbours kept by their invocations and
// the sector data of each subgroup.
PipelineOptions requestPipeline(const Device& device, const HashUpdate& update) {
  constexpr std::uint32_t kSectorBytes = 28 * shared::kGapSectors, kNeighbourBytes = 20, kElse = 256;
  PipelineOptions options = editPipeline(sizeof(shared::RequestArgs), update);
  const auto subgroups = [&] { return std::max(1u, options.workgroupSize / device.subgroupSize()); };
  const auto needed = [&] {
    return options.workgroupSize * shared::kWalkedAtOnce * kNeighbourBytes + subgroups() * kSectorBytes + kElse;
  };
  while (needed() > sharedBytes(device)) options.workgroupSize /= 2;
  options.constants.push_back(subgroups());
  return options;
}

}  // namespace

Resample::Resample(Device& device, const LiveCloud& live, const HashUpdate& update, double radius)
    : device_(device),
      radius_(radius),
      mostRequests_(update.mostMoves()),
      measure_(device, shader_code::edit_measure_spacing, editPipeline(sizeof(shared::SpacingArgs), update)),
      request_(device, shader_code::edit_request, requestPipeline(device, update)),
      grant_(device, shader_code::edit_grant_requests, editPipeline(sizeof(shared::RequestArgs), update)),
      lists_(device, listBytes(mostRequests_), Memory::device, "resample lists"),
      spacings_(Buffer::of<float>(device, live.count(), Memory::device, "target spacings")),
      examined_(Buffer::of<std::uint32_t>(device, live.slots(), Memory::device, "examined")),
      carried_(Buffer::of<std::uint32_t>(device, live.slots(), Memory::device, "carried")),
      // One more than is used: GPU-assisted validation overestimates accesses to the last three words of a buffer.
      rests_(Buffer::of<Vec3>(device, live.slots() + 1, Memory::device, "rests")),
      reaches_(Buffer::of<float>(device, live.slots() - live.count(), Memory::device, "reaches")),
      report_(Buffer::of<shared::Resampling>(device, 1, Memory::readback, "resample report")) {
  report_.mapped<shared::Resampling>()[0] = {};
  CommandList list(device, device.latencyQueue(), "clear resampling");
  list.begin();
  list.fill(lists_, 0, kClaimsAt);
  list.fill(lists_, live.count(), kWord, offsetof(shared::Resampling, nextId));
  list.fill(lists_, 0xffffffffu, 2 * (kWord + sizeof(Vec3)) * shared::kClaimSlots, kClaimsAt);
  list.end();
  device.latencyQueue().run(list);
}

void Resample::measure(const shared::CloudView& cloud, DeviceAddress tables) {
  shared::SpacingArgs args{.cloud = cloud, .tables = tables, .radius = static_cast<float>(radius_), .counts = 1};
  const std::uint64_t threads = std::uint64_t{cloud.slots} * device_.subgroupSize();
  CommandList list(device_, device_.latencyQueue(), "measure spacings");
  list.begin();
  list.fill(rests_, shared::kNeverRested, rests_.bytes());
  list.dispatch(measure_, threads, args);
  args.counts = 0;
  list.dispatch(measure_, threads, args);
  for (const Buffer* each : {&examined_, &carried_}) list.fill(*each, 0, each->bytes());
  list.end();
  device_.latencyQueue().run(list);
}

void Resample::recordRequests(CommandList& list, const Io& io, DeviceAddress changed, DeviceAddress fitted,
                              const shared::EditEnd& end) const {
  const shared::RequestArgs args{.cloud = io.update.cloud,
                                 .update = io.update.update,
                                 .changed = changed,
                                 .fitted = fitted,
                                 .tables = io.tables,
                                 .lists = lists_.address(),
                                 .end = end,
                                 .radius = static_cast<float>(radius_),
                                 .most = mostRequests_};
  for (const ComputePipeline* pass : {&request_, &grant_})
    io.lists.dispatch()(list, *pass, CountedDispatch::Step::subgroup, io.lists.counters(),
                        offsetof(shared::HashUpdate, changedGroups), args);
}

std::uint64_t Resample::predictedBytes(std::uint64_t points, std::uint64_t slots, std::uint64_t mostRequests) {
  return listBytes(mostRequests) + kWord * (points + 2 * slots) + sizeof(Vec3) * (slots + 1) +
         sizeof(float) * (slots - points);
}

}  // namespace palpate
