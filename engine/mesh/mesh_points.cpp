#include "engine/mesh/mesh_points.hpp"

#include <bit>
#include <unordered_map>

#include "engine/core/check.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/mesh/mesh_storage.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr float kNowhere = std::bit_cast<float>(0x7fc00000u);  // as defined in the shaders

// The points that the plan uses; their new index is their rank among them.
PointCloud partOf(const PointCloud& cloud, const MeshPlan& plan) {
  if (plan.share >= 1) return cloud;
  PointCloud part;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (!plan.uses(i)) continue;
    part.positions.push_back(cloud.positions[i]);
    part.normals.push_back(cloud.normals[i]);
    if (cloud.hasColors()) part.colors.push_back(cloud.colors[i]);
  }
  return part;
}

// Ranks of all possible points in the subset; empty if all are used.
std::vector<std::uint32_t> placesIn(const MeshPlan& plan, std::uint64_t points, std::uint32_t none) {
  if (plan.share >= 1) return {};
  std::vector<std::uint32_t> places(points, none);
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < points; ++i)
    if (plan.uses(i)) places[i] = next++;
  return places;
}

std::uint32_t spareIn(const MeshPlan& plan, std::size_t points, std::uint32_t spare) {
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < spare; ++i) kept += plan.uses(static_cast<std::uint32_t>(points) + i);
  return kept;
}

std::uint32_t packed(const std::array<std::uint8_t, 4>& color) { return std::bit_cast<std::uint32_t>(color); }

HashGrid gridOf(const MeshPlan& plan, const LiveCloud& live) {
  return makeHashGrid(plan.lattice.origin, static_cast<double>(plan.lattice.radius), live.slots());
}

}  // namespace

MeshPoints::MeshPoints(Device& device, const PointCloud& cloud, const MeshPlan& plan, std::uint32_t spare, bool painted)
    : device_(device),
      colored_(cloud.hasColors() || painted),
      placeOf_(placesIn(plan, cloud.size() + spare, kNoPlace)),
      origin_(cloud.origin),
      live_(device, partOf(cloud, plan), plan.share < 1 ? spareIn(plan, cloud.size(), spare) : spare,
            &device.throughputQueue()),
      hash_(device, gridOf(plan, live_), live_.slots(),
            sortInOrder(device, gridOf(plan, live_), cloud.positions, Slots::spare), BucketOrder::stable, Slots::spare,
            &device.throughputQueue()),
      movePoints_(device, shader_code::mesh_move_points, {.pushBytes = sizeof(shared::MeshMoveArgs)}),
      colors_(
          Buffer::of<std::uint32_t>(device, colored_ ? live_.slots() : 0, Memory::device, "mesh colours of points")),
      moves_(Buffer::of<std::uint32_t>(device, 0, Memory::device, "mesh moves")) {
  if (!colored_) return;
  std::vector<std::uint32_t> colors(live_.slots(), packed(kUnpainted));
  for (std::uint32_t i = 0, place = 0; i < cloud.size(); ++i)
    if (plan.uses(i) && cloud.hasColors()) colors[place++] = packed(cloud.colors[i]);
  upload(device, device.throughputQueue(), colors_, colors);
}

std::vector<shared::MeshMove> MeshPoints::movesOf(std::span<const PointState> edits) const {
  std::unordered_map<std::uint32_t, std::size_t> lastOf;
  std::vector<shared::MeshMove> moves;
  for (const PointState& edit : edits) {
    PALPATE_CHECK_LT(edit.number, placeOf_.empty() ? live_.slots() : placeOf_.size());
    const std::uint32_t place = placeOf_.empty() ? static_cast<std::uint32_t>(edit.number) : placeOf_[edit.number];
    if (place == kNoPlace) continue;
    const shared::MeshMove move{.from = Vec3(0),
                                .to = edit.gone ? Vec3(kNowhere) : edit.position,
                                .normal = edit.normal,
                                .id = place,
                                .color = edit.color != 0 ? edit.color : packed(kUnpainted)};
    const auto [entry, isNew] = lastOf.try_emplace(place, moves.size());
    if (isNew)
      moves.push_back(move);
    else
      moves[entry->second] = move;
  }
  return moves;
}

std::uint32_t MeshPoints::set(std::span<const PointState> edits) {
  const std::vector<shared::MeshMove> moves = movesOf(edits);
  moveCount_ = static_cast<std::uint32_t>(moves.size());
  if (moves.empty()) return 0;
  growBuffer(device_, moves_, moves.size() * sizeof(shared::MeshMove));
  uploadBytes(device_, device_.throughputQueue(), moves_, std::as_bytes(std::span(moves)));
  CommandList list(device_, device_.throughputQueue(), "move points");
  list.begin();
  list.dispatch(movePoints_, moveCount_,
                shared::MeshMoveArgs{.positions = live_.front().positions.address(),
                                     .normals = live_.front().normals.address(),
                                     .colors = colors_.address(),
                                     .moves = moves_.address(),
                                     .count = moveCount_,
                                     .colored = colored_});
  list.end();
  device_.throughputQueue().run(list);
  return moveCount_;
}

double MeshPoints::buildIndex() {
  double time_us = 0;
  // Always from the order of numbers: the content of a bucket must not depend on its history.
  for (SortMethod used = hash_.sort();; used = hash_.fallback()) {
    CommandList list(device_, device_.throughputQueue(), "mesh index", CommandList::Timing::sections);
    list.begin();
    {
      const auto section = list.section("index");
      hash_.recordBuild(list, live_.front(), live_.back(), live_.slots(), used);
    }
    list.end();
    device_.throughputQueue().run(list);
    time_us += list.sectionTime_us("index");
    if (used == hash_.sort()) return time_us;
  }
}

std::uint64_t MeshPoints::bytes() const {
  const auto halfBytes = [](const LiveCloud::Half& half) { return half.positions.bytes() + half.normals.bytes(); };
  return halfBytes(live_.front()) + halfBytes(live_.back()) + hash_.bytes() + colors_.bytes() + moves_.bytes();
}

}  // namespace palpate
