#include "engine/edit/given_changes.hpp"

#include <algorithm>
#include <bit>

#include "engine/core/check.hpp"
#include "engine/core/packed_state.hpp"
#include "engine/gpu/device.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kMaxChanges = 1 << 16;

shared::EditEntry entryOf(const PointState& point) { return std::bit_cast<shared::EditEntry>(packedState(point)); }

}  // namespace

GivenChanges::GivenChanges(Device& device, const HashUpdate& update)
    : update_(update),
      subgroupSize_(device.subgroupSize()),
      most_(std::min(kMaxChanges, update.mostMoves())),
      restore_(device, shader_code::edit_restore,
               {.workgroupSize = shared::kUpdateWorkgroup,
                .pushBytes = sizeof(shared::RestoreArgs),
                .constants = {update.dispatch().countsGroups()}}),
      changes_(Buffer::of<shared::GivenChange>(device, most_, Memory::upload, "given changes")) {}

void GivenChanges::give(std::span<const PointChange> changes, std::uint32_t ids) {
  PALPATE_CHECK_LE(changes.size(), most_);
  const auto given = changes_.mapped<shared::GivenChange>();
  for (std::size_t i = 0; i < changes.size(); ++i) {
    PALPATE_CHECK_EQ(changes[i].from.number, changes[i].to.number);
    PALPATE_CHECK_LT(changes[i].to.number, ids);
    given[i] = {.from = entryOf(changes[i].from), .to = entryOf(changes[i].to)};
  }
  count_ = static_cast<std::uint32_t>(changes.size());
}

void GivenChanges::record(CommandList& list, const Io& io, std::uint32_t flags) const {
  const shared::HashUpdateArgs update = update_.args(io.cloud, io.parity);
  list.dispatch(restore_, std::uint64_t{count_} * subgroupSize_,
                shared::RestoreArgs{.cloud = io.cloud,
                                    .update = update.update,
                                    .capacities = update.capacities,
                                    .changes = changes_.address(),
                                    .tables = io.tables,
                                    .lists = io.lists,
                                    .count = count_,
                                    .flags = flags});
}

std::uint64_t GivenChanges::predictedBytes(std::uint64_t points) {
  return std::min<std::uint64_t>(kMaxChanges, HashUpdate::defaultMoves(points)) * sizeof(shared::GivenChange);
}

}  // namespace palpate
