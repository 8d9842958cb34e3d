#include "engine/edit/many_changes.hpp"

#include <algorithm>
#include <bit>

#include "engine/core/point_words.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/edit.h"

namespace palpate {

namespace {

constexpr std::uint64_t kAtOnce = 1 << 20;  // points, but for a word

}  // namespace

ManyChanges::ManyChanges(Device& device)
    : device_(device), place_(device, shader_code::edit_place_points, {.pushBytes = sizeof(shared::PlacePointsArgs)}) {}

void ManyChanges::carryOut(const LiveCloud& cloud, const Buffer& tables, const PointSet& changed,
                           std::span<const PointState> states, const PointSet& without) {
  const LiveCloud::Half &from = cloud.front(), &to = cloud.back();
  const auto run = [&](auto&& record) {
    CommandList list(device_, device_.latencyQueue(), "many changes");
    list.begin();
    record(list);
    list.end();
    device_.latencyQueue().run(list);
  };
  const std::vector<std::uint64_t> bits = changed.bits(cloud.slots());
  const Buffer changedBits = Buffer::of<std::uint64_t>(device_, bits.size(), Memory::device, "changed points");
  upload(device_, changedBits, bits);
  shared::PlacePointsArgs args{.positionsIn = from.positions.address(),
                               .normalsIn = from.normals.address(),
                               .colorsIn = 0,
                               .positionsOut = to.positions.address(),
                               .normalsOut = to.normals.address(),
                               .changed = changedBits.address(),
                               .tables = tables.address(),
                               .count = cloud.slots(),
                               .unused = 0};
  run([&](CommandList& list) {
    list.fill(to.positions, shared::kEmptySlot, to.positions.bytes());
    list.fill(to.normals, 0, to.normals.bytes());
    list.dispatch(place_, args.count, args);
  });
  const std::vector<std::uint64_t> out = without.bits(states.size());
  const PointWords there = wordsWhere(changed, [&](std::uint64_t point) {
    return point < states.size() && (out[point / 64] >> point % 64 & 1) == 0 && !states[point].gone;
  });
  const std::uint64_t capacity = std::min(there.points, kAtOnce + 64);
  if (capacity == 0) return;
  if (!sent_ || sent_->positions.bytes() < capacity * sizeof(Vec4)) {
    sent_.reset();
    sent_ = {Buffer::of<Vec4>(device_, capacity, Memory::staging, "changed positions"),
             Buffer::of<Vec4>(device_, capacity, Memory::staging, "changed normals"),
             Buffer::of<std::uint32_t>(device_, capacity, Memory::staging, "changed colors")};
  }
  const auto positions = sent_->positions.mapped<Vec4>(), normals = sent_->normals.mapped<Vec4>();
  const auto colors = sent_->colors.mapped<std::uint32_t>();
  args.positionsIn = sent_->positions.address();
  args.normalsIn = sent_->normals.address();
  args.colorsIn = sent_->colors.address();
  for (std::size_t begin = 0, end = 0; begin < there.words.size(); begin = end) {
    const std::uint64_t before = there.words[begin].before;
    while (end < there.words.size() && there.words[end].before - before < kAtOnce) ++end;
    args.count =
        static_cast<std::uint32_t>((end < there.words.size() ? there.words[end].before : there.points) - before);
    parallelFor(end - begin, 0, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = begin + first; i < begin + last; ++i)
        there.words[i].forEach([&](std::uint64_t point, std::uint64_t k) {
          const PointState& state = states[point];
          positions[k - before] = Vec4(state.position, std::bit_cast<float>(static_cast<std::uint32_t>(point)));
          normals[k - before] = Vec4(state.normal, 0);
          colors[k - before] = state.color;
        });
    });
    run([&](CommandList& list) { list.dispatch(place_, args.count, args); });
  }
}

}  // namespace palpate
