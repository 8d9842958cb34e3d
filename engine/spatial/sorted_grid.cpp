#include "engine/spatial/sorted_grid.hpp"

#include <tuple>
#include <utility>

namespace palpate {

namespace {

// An update of at least this share of the points costs more than a build.
constexpr std::size_t kShareToBuild = 16, kFewestToBuild = 1024;
// A bucket returns to its own slots, or to a smaller block, once this share of them would stay free, so that one that
// grows and shrinks by a few points stays where it is.
constexpr std::uint32_t kShareFree = 8, kShareUsed = 4;
constexpr std::uint32_t kBucketsPerBlock = 4;

}  // namespace

SortedGrid::SortedGrid(const HashGrid& grid, unsigned threads, CellTags cellTags)
    : grid_(grid),
      team_(threads),
      sort_(grid.bucketMask + 1),
      buckets_(std::size_t{grid.bucketMask} + 1, Bucket()),
      cellTags_(cellTags),
      tags_(buckets_.size()),
      blockMask_(grid.bucketMask / kBucketsPerBlock),
      blocks_(std::size_t{blockMask_} + 1) {}

void SortedGrid::build(std::span<const Vec3> positions, std::span<const std::uint8_t> there) {
  PALPATE_CHECK(there.empty() || there.size() == positions.size());
  positions_ = positions;
  there_ = there;
  const auto bucketOfPoint = [grid = grid_, positions, there](std::size_t i) {
    return there.empty() || there[i] ? bucketOf(grid, cellOf(grid, positions[i])) : kNoBucket;
  };
  sort_.sort(positions.size(), team_, bucketOfPoint, [positions](std::size_t i, Placed& placed) {
    placed.position = positions[i];
    placed.number = static_cast<std::uint32_t>(i);
  });
  spare_.clear();
  std::ranges::fill(blocks_, cellTags_ == CellTags::off ? 1 : 0);
  constexpr std::size_t kPart = std::size_t{1} << 15;  // buckets
  team_.forEach((buckets_.size() + kPart - 1) / kPart, [&](std::size_t part) {
    const std::span<const std::uint32_t> starts = sort_.starts();
    const std::size_t end = std::min(buckets_.size(), (part + 1) * kPart);
    for (std::size_t b = part * kPart; b < end; ++b) {
      buckets_[b] = {starts[b], starts[b + 1] - starts[b]};
      tags_[b] = tagsOf(bucket(static_cast<std::uint32_t>(b)));
    }
  });
  size_ = sort_.items().size();
  isFresh_ = true;
  ++builds_;
}

void SortedGrid::update(std::span<const Vec3> positions, std::span<const std::uint8_t> there,
                        std::span<const std::uint32_t> changed) {
  BareVector<std::uint32_t>& keys = sort_.keys();
  PALPATE_CHECK(there.empty() || there.size() == positions.size());
  PALPATE_CHECK(keys.size() <= positions.size());
  if (changed.size() > std::max(kFewestToBuild, positions.size() / kShareToBuild)) return build(positions, there);
  positions_ = positions;
  there_ = there;
  keys.resize(positions.size(), kNoBucket);
  isFresh_ = false;
  const std::size_t parts = (changed.size() + kFollowed - 1) / kFollowed;
  followed_.resize(std::max(followed_.size(), parts));
  team_.forEach(parts, [&](std::size_t part) {
    const std::size_t begin = part * kFollowed;
    follow(changed.subspan(begin, std::min(kFollowed, changed.size() - begin)), followed_[part]);
  });
  transfers_.clear();
  for (const Followed& part : std::span(followed_).first(parts)) {
    transfers_.insert(transfers_.end(), part.transfers.begin(), part.transfers.end());
    written_ += part.written;
  }
  for (const Transfer& one : transfers_) __builtin_prefetch(&buckets_[one.bucket]);
  std::ranges::sort(transfers_, {}, [](const Transfer& one) { return std::tuple(one.bucket, one.number); });
  for (const Transfer& one : transfers_) fetch(bucket(one.bucket));
  for (std::size_t begin = 0, end = 0; begin < transfers_.size(); begin = end) {
    while (end < transfers_.size() && transfers_[end].bucket == transfers_[begin].bucket) ++end;
    transfer(std::span(transfers_).subspan(begin, end - begin));
  }
}

// Points that stay in their buckets get their positions at once; memory is fetched ahead.
void SortedGrid::follow(std::span<const std::uint32_t> changed, Followed& followed) {
  std::array<std::uint32_t, kFollowed> before, after;
  std::array<IVec3, kFollowed> cells;
  BareVector<std::uint32_t>& keys = sort_.keys();
  followed.transfers.clear();
  followed.written = 0;
  for (const std::uint32_t number : changed) {
    __builtin_prefetch(&keys[number]);
    __builtin_prefetch(&positions_[number]);
  }
  for (std::size_t i = 0; i < changed.size(); ++i) {
    const std::uint32_t number = changed[i];
    cells[i] = cellOf(grid_, positions_[number]);
    after[i] = there_.empty() || there_[number] ? bucketOf(grid_, cells[i]) : kNoBucket;
    before[i] = std::exchange(keys[number], after[i]);
    if (after[i] != kNoBucket) __builtin_prefetch(&buckets_[after[i]]);
  }
  for (std::size_t i = 0; i < changed.size(); ++i)
    if (before[i] == after[i] && after[i] != kNoBucket) __builtin_prefetch(at(buckets_[after[i]].begin));
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (before[i] == after[i]) {
      followed.written += replace(after[i], changed[i], cells[i]);
      continue;
    }
    if (before[i] != kNoBucket) followed.transfers.push_back({before[i], changed[i], false});
    if (after[i] != kNoBucket) followed.transfers.push_back({after[i], changed[i], true});
  }
}

// Whether the point is in a bucket.
bool SortedGrid::replace(std::uint32_t bucket, std::uint32_t number, const IVec3& cell) {
  if (bucket == kNoBucket) return false;
  Placed* const begin = at(buckets_[bucket].begin);
  Placed* const end = begin + buckets_[bucket].count;
  Placed* const found = std::ranges::lower_bound(begin, end, number, {}, &Placed::number);
  PALPATE_CHECK(found != end && found->number == number);
  found->position = positions_[number];
  tag(bucket, cell);
  return true;
}

std::uint32_t SortedGrid::slots(std::uint32_t bucket) const {
  const std::uint32_t begin = buckets_[bucket].begin;
  return begin < firstSpare() ? homeSlots(bucket) : spare_.slots(begin - firstSpare());
}

// All those of one bucket, by number.
void SortedGrid::transfer(std::span<const Transfer> transfers) {
  const std::uint32_t number = transfers.front().bucket;
  Bucket& bucket = buckets_[number];
  const auto entering = static_cast<std::uint32_t>(std::ranges::count(transfers, true, &Transfer::enters));
  if (entering < transfers.size()) leave(bucket, transfers);
  if (entering > 0) {
    if (bucket.count + entering > slots(number)) moveTo(number, firstSpare() + spare_.take(bucket.count + entering));
    enter(bucket, transfers, entering);
  }
  size_ += 2 * entering;
  size_ -= transfers.size();
  shrink(number);
  if (bucket.count == 0) tags_[number] = 0;
}

std::uint8_t SortedGrid::tagsOf(std::span<const Placed> points) {
  if (cellTags_ == CellTags::off) return points.empty() ? 0 : 0xff;
  std::uint8_t tags = 0;
  for (const Placed& point : points) {
    const IVec3 cell = cellOf(grid_, point.position);
    tags |= tagOf(cell);
    mark(cell);
  }
  return tags;
}

void SortedGrid::leave(Bucket& bucket, std::span<const Transfer> transfers) {
  Placed* const begin = at(bucket.begin);
  Placed* const end = begin + bucket.count;
  Placed* to = begin;
  auto next = transfers.begin();
  for (Placed* from = begin; from != end; ++from) {
    while (next != transfers.end() && (next->enters || next->number < from->number)) ++next;
    if (next != transfers.end() && next->number == from->number) continue;
    if (to != from) {
      *to = *from;
      ++written_;
    }
    ++to;
  }
  bucket.count = static_cast<std::uint32_t>(to - begin);
}

// From the back, so that each point moves at most once.
void SortedGrid::enter(Bucket& bucket, std::span<const Transfer> transfers, std::uint32_t entering) {
  Placed* const begin = at(bucket.begin);
  Placed* from = begin + bucket.count;
  Placed* to = from + entering;
  bucket.count += entering;
  written_ += entering;
  for (auto next = transfers.rbegin(); next != transfers.rend(); ++next) {
    if (!next->enters) continue;
    for (; from != begin && (from - 1)->number > next->number; ++written_) *--to = *--from;
    *--to = {positions_[next->number], next->number};
    tag(next->bucket, cellOf(grid_, to->position));
  }
}

void SortedGrid::moveTo(std::uint32_t bucket, std::uint32_t slot) {
  Bucket& moved = buckets_[bucket];
  std::copy_n(at(moved.begin), moved.count, at(slot));
  written_ += moved.count;
  if (moved.begin >= firstSpare()) spare_.giveBack(moved.begin - firstSpare());
  moved.begin = slot;
}

void SortedGrid::shrink(std::uint32_t bucket) {
  const auto [begin, count] = buckets_[bucket];
  if (begin < firstSpare()) return;
  const std::uint32_t home = homeSlots(bucket), mine = slots(bucket);
  if (count == 0 || count + home / kShareFree < home)
    moveTo(bucket, sort_.starts()[bucket]);
  else if (count < mine / kShareUsed && spare_.slotsFor(2 * count) < mine)
    moveTo(bucket, firstSpare() + spare_.take(2 * count));
}

void SortedGrid::move(std::span<const PointMove> moves) {
  std::vector<std::uint32_t> moved;
  moved.reserve(moves.size());
  for (const PointMove& one : moves) moved.push_back(one.point);
  update(positions_, there_, moved);
}

void SortedGrid::near(const DVec3& center, double radius, std::vector<std::uint32_t>& found) const {
  forEachNear(center, radius, [&](const Placed& point) { found.push_back(point.number); });
}

std::size_t SortedGrid::bytes() const {
  return sort_.bytes() + buckets_.size() * sizeof(Bucket) + tags_.size() + blocks_.size() + spare_.bytes() +
         transfers_.capacity() * sizeof(Transfer);
}

}  // namespace palpate
