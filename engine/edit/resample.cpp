#include "engine/edit/resample.hpp"

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

PipelineOptions pipeline(std::uint32_t pushBytes, const HashUpdate& update) {
  return {.workgroupSize = shared::kUpdateWorkgroup,
          .pushBytes = pushBytes,
          .constants = {update.dispatch().countsGroups()}};
}

constexpr std::uint64_t kWord = sizeof(std::uint32_t);
constexpr std::uint64_t kClaimsAt = sizeof(shared::Resampling) + kWord * shared::kMostBirths;

std::uint64_t listBytes(std::uint64_t mostWishes) {
  return kClaimsAt + (kWord + sizeof(Vec3)) * shared::kClaimSlots + sizeof(shared::PointWish) * mostWishes;
}

}  // namespace

Resample::Resample(Device& device, const LiveCloud& live, const HashUpdate& update, double radius)
    : device_(device),
      radius_(radius),
      mostWishes_(update.mostMoves()),
      measure_(device, shader_code::edit_measure_spacing, pipeline(sizeof(shared::SpacingArgs), update)),
      wish_(device, shader_code::edit_wish, pipeline(sizeof(shared::WishArgs), update)),
      grant_(device, shader_code::edit_grant_wishes, pipeline(sizeof(shared::WishArgs), update)),
      lists_(device, listBytes(mostWishes_), Memory::device, "resample lists"),
      spacings_(Buffer::of<float>(device, live.count(), Memory::device, "target spacings")),
      looks_(Buffer::of<std::uint32_t>(device, live.slots(), Memory::device, "looks")),
      // One to spare: GPU-assisted validation takes the last three words of a buffer for more than they are.
      rests_(Buffer::of<Vec3>(device, live.slots() + 1, Memory::device, "rests")),
      reaches_(Buffer::of<float>(device, live.slots() - live.count(), Memory::device, "reaches")),
      report_(Buffer::of<shared::Resampling>(device, 1, Memory::readback, "resample report")) {
  report_.mapped<shared::Resampling>()[0] = {};
  CommandList list(device, device.touch(), "clear resampling");
  list.begin();
  list.fill(lists_, 0, kClaimsAt);
  list.fill(lists_, live.count(), kWord, offsetof(shared::Resampling, nextId));
  list.fill(lists_, 0xffffffffu, kWord * shared::kClaimSlots, kClaimsAt);
  list.end();
  device.touch().run(list);
}

void Resample::measure(const shared::CloudView& cloud, DeviceAddress tables) {
  shared::SpacingArgs args{.cloud = cloud, .tables = tables, .radius = static_cast<float>(radius_), .counts = 1};
  const std::uint64_t threads = std::uint64_t{cloud.slots} * device_.subgroupSize();
  CommandList list(device_, device_.touch(), "measure spacings");
  list.begin();
  list.fill(rests_, shared::kNeverRested, rests_.bytes());
  list.dispatch(measure_, threads, args);
  args.counts = 0;
  list.dispatch(measure_, threads, args);
  list.fill(looks_, 0, looks_.bytes());
  list.end();
  device_.touch().run(list);
}

void Resample::recordWishes(CommandList& list, const Io& io, DeviceAddress changed, DeviceAddress fitted,
                            const shared::EditEnd& end) const {
  const shared::WishArgs args{.cloud = io.update.cloud,
                              .update = io.update.update,
                              .changed = changed,
                              .fitted = fitted,
                              .tables = io.tables,
                              .lists = lists_.address(),
                              .end = end,
                              .radius = static_cast<float>(radius_),
                              .most = mostWishes_};
  for (const ComputePipeline* pass : {&wish_, &grant_})
    io.lists.dispatch()(list, *pass, CountedDispatch::Step::subgroup, io.lists.counters(),
                        offsetof(shared::HashUpdate, changedGroups), args);
}

std::uint64_t Resample::predictedBytes(std::uint64_t points, std::uint64_t slots, std::uint64_t mostWishes) {
  return listBytes(mostWishes) + kWord * (points + slots) + sizeof(Vec3) * (slots + 1) + sizeof(float) * (slots - points);
}

}  // namespace palpate
