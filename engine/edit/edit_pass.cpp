#include "engine/edit/edit_pass.hpp"

#include <algorithm>
#include <cstring>

#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

EditPass::EditPass(Device& device, const BrushOptions& brush, const SpatialHash& hash, const LiveCloud& live,
                   const EditLog& log, std::span<const std::uint32_t> colors, double radius)
    : device_(device),
      hash_(hash),
      live_(live),
      update_(device, device.latencyQueue(), hash, {.points = live.count(), .slots = live.slots()}),
      moves_(device, update_, hash.grid(), brush, radius),
      given_(device, update_),
      many_(device),
      sequel_(device, update_, log, radius),
      tables_(Buffer::of<shared::PointTables>(device, 1, Memory::device, "point tables")),
      colors_(Buffer::of<std::uint32_t>(device, colors.empty() ? 0 : live.slots(), Memory::device, "live colors")),
      parents_(Buffer::of<std::uint32_t>(device, live.slots() - live.count(), Memory::device, "parents")),
      founds_(Buffer::of<shared::Found>(device, live.slots(), Memory::device, "founds")),
      resample_(device, live, update_, radius) {
  CommandList list(device, device.latencyQueue(), "clear founds");
  list.begin();
  list.fill(founds_, 0, founds_.bytes());
  list.end();
  device.latencyQueue().run(list);
  if (!colors.empty()) {
    std::vector<std::uint32_t> byId(live.slots());
    std::ranges::copy(colors, byId.begin());
    upload(device, colors_, byId);
  }
  uploadTables();
  resample_.measure(view(live.front()), tables_.address());
}

void EditPass::setBrush(const BrushOptions& brush) {
  moves_.setBrush(brush);
  uploadTables();
}

void EditPass::lock(const PointLock& lock) {
  constexpr std::uint32_t kBits = 32;
  if (!locked_ && lock.empty()) return;
  PALPATE_CHECK_LE(lock.points.end(), std::uint64_t{live_.slots()});
  if (!locked_)
    locked_ = Buffer::of<std::uint32_t>(device_, 2 * (live_.slots() / (2 * kBits) + 1), Memory::device, "locked");
  upload(device_, *locked_, lock.points.bits(kBits * locked_->bytes() / sizeof(std::uint32_t)));
  lockWeights_.reset();
  if (!lock.weights.empty()) {
    std::vector<std::uint32_t> words(1 + (lock.weights.size() + 3) / 4);
    words[0] = static_cast<std::uint32_t>(lock.weights.size());
    std::memcpy(&words[1], lock.weights.data(), lock.weights.size());
    lockWeights_ = Buffer::of<std::uint32_t>(device_, words.size(), Memory::device, "lock weights");
    upload(device_, *lockWeights_, words);
  }
  uploadTables();
}

void EditPass::uploadTables() {
  upload(device_, tables_,
         std::vector<shared::PointTables>{{.colors = colors_.bytes() == 0 ? 0 : colors_.address(),
                                           .parents = parents_.address(),
                                           .spacings = resample_.spacings(),
                                           .rests = resample_.rests(),
                                           .reaches = resample_.reaches(),
                                           .founds = founds_.address(),
                                           .brush = moves_.address(),
                                           .tool = moves_.tool(),
                                           .examined = resample_.examined(),
                                           .carried = resample_.carried(),
                                           .lists = resample_.lists(),
                                           .moves = update_.moves(),
                                           .marks = update_.marks(),
                                           .touched = update_.touched(),
                                           .movesOf = update_.bySlot(),
                                           .locked = locked_ ? locked_->address() : 0,
                                           .lockWeights = lockWeights_ ? lockWeights_->address() : 0,
                                           .firstNew = live_.count(),
                                           .ids = live_.slots(),
                                           .mostMoves = update_.mostMoves(),
                                           .resamples = resamples() ? 1u : 0u}});
}

Resample::Io EditPass::resampleIo(const shared::CloudView& cloud, std::uint32_t parity) const {
  return {.update = update_.args(cloud, parity), .tables = tables_.address(), .lists = update_};
}

void EditPass::recordIncremental(CommandList& list, const LiveCloud::Half& half, Reach reach) const {
  const shared::CloudView cloud = view(half);
  const BrushMoves::Io io = movesIo(cloud, half.parity);
  {
    const auto edit = list.section("edit");
    {
      const auto section = list.section("brush");
      moves_.record(list, io, moves_.select(boxOf(reach), live_.slots()), recalls());
    }
    update_.recordApply(list, cloud, half.parity);
    recordSequel(list, cloud, half.parity, scratch(), true);
  }
  recordRequests(list, cloud, half.parity, scratch());
}

void EditPass::recordRebuild(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to, SortMethod sort,
                             Reach reach) const {
  {
    const auto edit = list.section("edit");
    recordReached(list, from, reach);
    hash_.recordBuild(list, from, to, live_.slots(), sort);
    update_.recordRecount(list, view(to), to.parity, scratch(from).changed);
    recordSequel(list, view(to), to.parity, scratch(from), true);
  }
  recordRequests(list, view(to), to.parity, scratch(from));
}

void EditPass::recordReached(CommandList& list, const LiveCloud::Half& from, Reach reach) const {
  const shared::CloudView cloud = view(from);
  const BrushMoves::Io io = movesIo(cloud, from.parity);
  const auto section = list.section("brush");
  if (hasBox(reach)) {
    moves_.record(list, io, moves_.select(boxOf(reach), live_.slots()), recalls());
  } else {
    for (std::uint32_t first = 0; first < live_.slots(); first += update_.mostMoves()) {
      const std::uint32_t slots = std::min(update_.mostMoves(), live_.slots() - first);
      moves_.record(list, io, {.firstSlot = first, .slots = slots}, shared::kRecallsNothing);
      update_.recordCommit(list, cloud);
      sequel_.recordGone(list, sequelIo(cloud, from.parity, {}));
      update_.recordBegin(list);
    }
    if (resamples()) moves_.recordRecalls(list, io, recalls());
  }
  update_.recordCommit(list, cloud);
}

void EditPass::recordRestore(CommandList& list, const LiveCloud::Half& half, Given given, std::uint32_t flags) const {
  if (given == Given::offered) flags |= shared::kRestoreOffered;
  const shared::CloudView cloud = view(half);
  given_.record(list, {.cloud = cloud, .parity = half.parity, .tables = tables_.address(), .lists = resample_.lists()},
                flags);
}

void EditPass::recordForget(CommandList& list, const LiveCloud::Half& half) const {
  const shared::CloudView cloud = view(half);
  moves_.recordRecalls(list, movesIo(cloud, half.parity), shared::kForgetsRequests);
}

void EditPass::recordGivenIncremental(CommandList& list, const LiveCloud::Half& half, Given given) const {
  const shared::CloudView cloud = view(half);
  update_.recordBegin(list);
  recordForget(list, half);
  recordRestore(list, half, given, 0);
  update_.recordApply(list, cloud, half.parity);
  recordRestore(list, half, given, shared::kRestoreFinishes);
  recordSequel(list, cloud, half.parity, scratch(), false);
}

void EditPass::recordGivenRebuild(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to,
                                  SortMethod sort, Given given) const {
  update_.recordBegin(list);
  recordForget(list, from);
  recordRestore(list, from, given, 0);
  update_.recordCommit(list, view(from));
  recordRestore(list, from, given, shared::kRestoreFinishes);
  hash_.recordBuild(list, from, to, live_.slots(), sort);
  update_.recordRecount(list, view(to), to.parity, scratch(from).changed);
  recordSequel(list, view(to), to.parity, scratch(from), false);
}

void EditPass::recordForgetting(CommandList& list, const LiveCloud::Half& half) const {
  update_.recordBegin(list);
  recordForget(list, half);
  update_.recordEnd(list);
}

void EditPass::recordCompaction(CommandList& list, const LiveCloud::Half& from, const LiveCloud::Half& to,
                                SortMethod sort) const {
  update_.recordBegin(list);
  hash_.recordBuild(list, from, to, live_.slots(), sort);
  update_.recordRecount(list, view(to), to.parity, scratch(from).changed);
  update_.recordEnd(list);
}

BrushMoves::Io EditPass::movesIo(const shared::CloudView& cloud, std::uint32_t parity) const {
  return {.cloud = cloud, .parity = parity, .tables = tables_.address()};
}

SurfaceMeasure EditPass::measure() const {
  const shared::HashUpdate& sums = report();
  SurfaceMeasure measure{.weights = sums.weights,
                         .normals = {sums.normals[0], sums.normals[1], sums.normals[2]},
                         .heights = sums.heights,
                         .blocked = sums.blocked};
  std::ranges::copy(sums.seen, measure.seen.begin());
  measure.nearest = sums.nearest;
  return measure;
}

EditSequel::Io EditPass::sequelIo(const shared::CloudView& cloud, std::uint32_t parity, const Scratch& scratch) const {
  return {.cloud = cloud,
          .parity = parity,
          .tables = tables_.address(),
          .lists = examines() ? resample_.lists() : 0,
          .scratch = scratch};
}

void EditPass::recordSequel(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                            const Scratch& scratch, bool requests) const {
  sequel_.record(list, sequelIo(cloud, parity, scratch), requests && examines() ? shared::EditEnd{} : end());
}

void EditPass::recordRequests(CommandList& list, const shared::CloudView& cloud, std::uint32_t parity,
                              const Scratch& scratch) const {
  if (!examines()) return;
  const auto section = list.section("requests");
  resample_.recordRequests(list, resampleIo(cloud, parity), scratch.changed, scratch.fitted, end());
}

shared::EditEnd EditPass::end() const {
  return {.report = update_.reportAddress(),
          .resampling = examines() ? resample_.reportAddress() : 0,
          .empty = update_.emptyCounters()};
}

void EditPass::complete(std::vector<PointState>& points) const {
  const auto parents = download<std::uint32_t>(device_, parents_, live_.slots() - live_.count());
  const auto byId = download<std::uint32_t>(device_, colors_, colors_.bytes() / sizeof(std::uint32_t));
  for (PointState& point : points) {
    if (point.number >= live_.count()) point.parent = parents[point.number - live_.count()];
    if (!byId.empty()) point.color = byId[point.number];
  }
}

std::uint64_t EditPass::mostLogged(Reach reach) const { return hasBox(reach) ? update_.mostMoves() : live_.slots(); }

std::uint64_t EditPass::bytes() const {
  return update_.bytes() + resample_.bytes() + moves_.bytes() + given_.bytes() + tables_.bytes() + colors_.bytes() +
         parents_.bytes() + founds_.bytes() + (locked_ ? locked_->bytes() : 0) +
         (lockWeights_ ? lockWeights_->bytes() : 0);
}

std::uint64_t EditPass::predictedBytes(std::uint64_t points, bool colors) {
  constexpr std::uint64_t kWord = sizeof(std::uint32_t);
  const std::uint64_t spare = HashUpdate::spareSlots(points);
  return HashUpdate::predictedBytes(points) + kWord * spare + sizeof(shared::Found) * (points + spare) +
         (colors ? kWord * (points + spare) : 0) + GivenChanges::predictedBytes(points) +
         Resample::predictedBytes(points, points + spare, HashUpdate::defaultMoves(points));
}

}  // namespace palpate
