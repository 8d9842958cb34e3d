#include "engine/edit/many_changes.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "engine/core/parallel.hpp"
#include "engine/gpu/device.hpp"
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
  if (!changed_ || changed_->bytes() < bits.size() * sizeof bits[0]) {
    changed_.reset();
    changed_ = Buffer::of<std::uint64_t>(device_, bits.size(), Memory::staging, "changed points");
  }
  std::ranges::copy(bits, changed_->mapped<std::uint64_t>().begin());
  shared::PlacePointsArgs args{.positionsIn = from.positions.address(),
                               .normalsIn = from.normals.address(),
                               .colorsIn = 0,
                               .positionsOut = to.positions.address(),
                               .normalsOut = to.normals.address(),
                               .changed = changed_->address(),
                               .tables = tables.address(),
                               .count = cloud.slots(),
                               .unused = 0};
  run([&](CommandList& list) {
    list.fill(to.positions, shared::kEmptySlot, to.positions.bytes());
    list.fill(to.normals, 0, to.normals.bytes());
    list.dispatch(place_, args.count, args);
  });
  const std::vector<std::uint64_t> out = without.bits(states.size());
  std::vector<PointSet::Word> words = changed.list();
  std::uint64_t count = 0;
  for (PointSet::Word& word : words) {
    if (word.begin / 64 < out.size()) word.bits &= ~out[word.begin / 64];
    word.before = std::exchange(count, count + static_cast<std::uint64_t>(std::popcount(word.bits)));
  }
  const std::uint64_t capacity = std::min(count, kAtOnce + 64);
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
  for (std::size_t begin = 0, end = 0; begin < words.size(); begin = end) {
    const std::uint64_t before = words[begin].before;
    while (end < words.size() && words[end].before - before < kAtOnce) ++end;
    args.count = static_cast<std::uint32_t>((end < words.size() ? words[end].before : count) - before);
    parallelFor(end - begin, 0, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = begin + first; i < begin + last; ++i)
        words[i].forEach([&](std::uint64_t point, std::uint64_t k) {
          if (point >= states.size() || states[point].gone) {
            positions[k - before] = Vec4(Vec3(0), std::bit_cast<float>(shared::kEmptySlot));
            return;
          }
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
