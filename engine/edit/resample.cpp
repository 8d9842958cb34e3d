#include "engine/edit/resample.hpp"

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

PipelineOptions pipeline(std::uint32_t pushBytes) {
  return {.workgroupSize = shared::kUpdateWorkgroup, .pushBytes = pushBytes};
}

constexpr std::uint64_t kWord = sizeof(std::uint32_t);
constexpr std::uint64_t kClaimsAt = sizeof(shared::Resampling) + kWord * shared::kMostBirths;

std::uint64_t listBytes(std::uint64_t mostWishes) {
  return kClaimsAt + kWord * shared::kClaimSlots + sizeof(shared::PointWish) * mostWishes;
}

}  // namespace

Resample::Resample(Device& device, const LiveCloud& live, std::uint32_t mostWishes, double radius)
    : device_(device),
      radius_(radius),
      mostWishes_(mostWishes),
      measure_(device, shader_code::edit_measure_spacing, pipeline(sizeof(shared::SpacingArgs))),
      recall_(device, shader_code::edit_recall, pipeline(sizeof(shared::RecallArgs))),
      birth_(device, shader_code::edit_birth, pipeline(sizeof(shared::BirthArgs))),
      heard_(device, shader_code::edit_heard, pipeline(sizeof(shared::RecallArgs))),
      wish_(device, shader_code::edit_wish, pipeline(sizeof(shared::WishArgs))),
      lists_(device, listBytes(mostWishes), Memory::device, "resample lists"),
      spacings_(Buffer::of<float>(device, live.count(), Memory::device, "target spacings")),
      looks_(Buffer::of<std::uint32_t>(device, live.slots(), Memory::device, "looks")),
      report_(Buffer::of<shared::Resampling>(device, 1, Memory::readback, "resample report")) {
  report_.mapped<shared::Resampling>()[0] = {};
  CommandList list(device, device.touch(), "clear resampling");
  list.begin();
  list.fill(lists_, 0, kClaimsAt);
  list.fill(lists_, 1, 2 * kWord, offsetof(shared::Resampling, wishGroups) + kWord);
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
  list.dispatch(measure_, threads, args);
  args.counts = 0;
  list.dispatch(measure_, threads, args);
  list.fill(looks_, 0, looks_.bytes());
  list.end();
  device_.touch().run(list);
}

shared::RecallArgs Resample::recallArgs(const Io& io, bool forgets) const {
  return {.cloud = io.update.cloud,
          .update = io.update.update,
          .moves = io.update.moves,
          .marks = io.update.marks,
          .touched = io.update.touched,
          .state = io.contactState,
          .brush = io.brush,
          .tables = io.tables,
          .lists = lists_.address(),
          .mostMoves = io.update.mostMoves,
          .forgets = forgets ? 1u : 0u};
}

void Resample::recordRecall(CommandList& list, const Io& io) const {
  const auto section = list.section("recall");
  list.dispatchIndirect(recall_, lists_, recallArgs(io, false), offsetof(shared::Resampling, wishGroups));
  list.dispatch(birth_, shared::kUpdateWorkgroup,
                shared::BirthArgs{.grid = io.update.cloud.grid,
                                  .update = io.update.update,
                                  .moves = io.update.moves,
                                  .marks = io.update.marks,
                                  .touched = io.update.touched,
                                  .tables = io.tables,
                                  .lists = lists_.address(),
                                  .mostMoves = io.update.mostMoves,
                                  .unused = 0});
}

void Resample::recordHeard(CommandList& list, const Io& io) const {
  list.dispatch(heard_, shared::kUpdateWorkgroup, recallArgs(io, false));
}

void Resample::recordForget(CommandList& list, const Io& io) const {
  list.dispatchIndirect(recall_, lists_, recallArgs(io, true), offsetof(shared::Resampling, wishGroups));
  recordHeard(list, io);
}

void Resample::recordWishes(CommandList& list, const Io& io, DeviceAddress changed) const {
  const auto section = list.section("wishes");
  recordHeard(list, io);
  list.dispatchIndirect(wish_, io.counters,
                        shared::WishArgs{.cloud = io.update.cloud,
                                         .update = io.update.update,
                                         .changed = changed,
                                         .tables = io.tables,
                                         .lists = lists_.address(),
                                         .radius = static_cast<float>(radius_),
                                         .most = mostWishes_},
                        offsetof(shared::HashUpdate, changedGroups));
}

void Resample::recordReport(CommandList& list) const { list.copy(lists_, report_, sizeof(shared::Resampling)); }

std::uint64_t Resample::predictedBytes(std::uint64_t points, std::uint64_t slots, std::uint64_t mostWishes) {
  return listBytes(mostWishes) + kWord * (points + slots);
}

}  // namespace palpate
