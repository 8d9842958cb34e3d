#include "tests/edit_gpu/edited_scene.hpp"

#include <bit>

#include "engine/gpu/transfer.hpp"
#include "tests/edit/tool_at.hpp"

namespace palpate {

EditedScene::EditedScene(Device& device, const PointCloud& cloud, const HashGrid& grid, double radius,
                         const BrushOptions& brush, std::span<const std::uint32_t> colors, SortMethod sort,
                         std::optional<std::uint32_t> spare, const CompactionOptions& compaction)
    : device_(device),
      live_(device, cloud, spare.value_or(HashUpdate::spareSlots(cloud.size()))),
      hash_(device, grid, live_.slots(), sort, BucketOrder::stable, Slots::spare),
      log_(device, live_.slots()),
      radius_(radius) {
  hash_.build(live_);
  edit_.emplace(device, brush, hash_, live_, log_, colors, radius);
  compaction_.emplace(device, hash_, live_, edit_->update(), compaction);
}

bool EditedScene::run(How how, const std::function<void(CommandList&)>& record) {
  if (how != How::incremental) compaction_->settle();
  CommandList list(device_, device_.latencyQueue(), "edit");
  list.begin();
  record(list);
  list.end();
  device_.latencyQueue().run(list);
  if (how != How::incremental) live_.flip();
  return edit_->report().failed == 0;
}

bool EditedScene::brush(const DVec3& hip, const DVec3& spring, How how, const DVec3& motion) {
  edit_->setTool(spring == DVec3(0) ? BrushStroke::Tool() : toolAt(edit_->brush(), radius_, hip, spring, motion));
  return run(how, [&](CommandList& list) {
    if (how == How::incremental)
      edit_->recordIncremental(list, live_.front(), edit_->reach());
    else
      edit_->recordRebuild(list, live_.front(), live_.back(), hash_.sort(),
                           how == How::rebuild ? edit_->reach() : EditPass::Reach::all);
  });
}

bool EditedScene::change(std::span<const PointChange> changes, How how) {
  edit_->give(changes);
  return run(how, [&](CommandList& list) {
    if (how == How::incremental)
      edit_->recordGivenIncremental(list, live_.front(), EditPass::Given::exactly);
    else
      edit_->recordGivenRebuild(list, live_.front(), live_.back(), hash_.sort(), EditPass::Given::exactly);
  });
}

void EditedScene::compact() {
  run(How::rebuild,
      [&](CommandList& list) { edit_->recordCompaction(list, live_.front(), live_.back(), hash_.sort()); });
}

bool EditedScene::compactFurther(std::uint32_t steps) {
  using Stage = HashCompaction::Stage;
  for (; steps > 0; --steps) {
    device_.waitIdle();
    if (compaction_->stage() == Stage::idle) {
      compaction_->begin();
      continue;
    }
    compaction_->advance();
    if (compaction_->stage() != Stage::copied) continue;
    compaction_->end();
    device_.waitIdle();
    if (!compaction_->collect()) return false;
    live_.flip();
    return true;
  }
  return false;
}

std::vector<PointState> EditedScene::takeLog() {
  const auto head = download<std::uint32_t>(device_, log_.headBuffer(), 1)[0];
  PALPATE_CHECK_LE(head - logSeen_, log_.capacity());  // else entries were overwritten before they were read
  const auto ring = download<PackedState>(device_, log_.entriesBuffer(), log_.capacity());
  std::vector<PointState> taken;
  for (; logSeen_ != head; ++logSeen_) taken.push_back(stateOf(ring[logSeen_ % log_.capacity()]));
  return taken;
}

std::map<std::uint32_t, PointState> EditedScene::points() const {
  auto points = live_.points();
  edit_->complete(points);
  std::map<std::uint32_t, PointState> byId;
  for (const PointState& point : points) byId[point.number] = point;
  return byId;
}

std::size_t EditedScene::faults() const {
  const auto positions = download<Vec4>(device_, live_.front().positions, live_.slots());
  const auto normals = download<Vec4>(device_, live_.front().normals, live_.slots());
  const std::uint32_t buckets = hash_.grid().bucketMask + 1;
  const auto ranges = download<UVec2>(device_, hash_.ranges(live_.front()), buckets);
  std::vector<bool> owned(positions.size());
  std::map<std::uint32_t, int> ids;
  std::size_t faults = 0;
  for (std::uint32_t bucket = 0; bucket < buckets; ++bucket) {
    for (std::uint32_t slot = ranges[bucket].x; slot < ranges[bucket].y; ++slot) {
      if (slot >= positions.size() || owned[slot]) {
        ++faults;
        continue;
      }
      owned[slot] = true;
      const auto id = std::bit_cast<std::uint32_t>(positions[slot].w);
      if (id == shared::kEmptySlot || bucketOf(hash_.grid(), cellOf(hash_.grid(), Vec3(positions[slot]))) != bucket ||
          ids[id]++ > 0 || (normals[slot].w != 0 && normals[slot].w != shared::kMarkGoes))
        ++faults;
    }
  }
  for (std::size_t slot = 0; slot < positions.size(); ++slot)
    if (!owned[slot] && std::bit_cast<std::uint32_t>(positions[slot].w) != shared::kEmptySlot) ++faults;
  const auto& head = edit_->report().head;
  for (std::size_t slot = head; slot < positions.size(); ++slot) faults += owned[slot];
  return faults;
}

std::map<std::uint32_t, std::vector<std::uint32_t>> EditedScene::buckets() const {
  const auto positions = download<Vec4>(device_, live_.front().positions, live_.slots());
  const auto ranges = download<UVec2>(device_, hash_.ranges(live_.front()), hash_.grid().bucketMask + 1);
  std::map<std::uint32_t, std::vector<std::uint32_t>> all;
  for (std::uint32_t bucket = 0; bucket < ranges.size(); ++bucket)
    for (std::uint32_t slot = ranges[bucket].x; slot < ranges[bucket].y; ++slot)
      all[bucket].push_back(std::bit_cast<std::uint32_t>(positions[slot].w));
  return all;
}

}  // namespace palpate
