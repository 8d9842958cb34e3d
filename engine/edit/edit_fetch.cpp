#include "engine/edit/edit_fetch.hpp"

#include <algorithm>
#include <cstring>

#include "engine/gpu/device.hpp"
#include "engine/gpu/queue.hpp"

namespace palpate {

namespace {

constexpr std::uint64_t kPiece = 1 << 18;  // entries copied at a time

}  // namespace

EditFetch::EditFetch(Device& device, EditLog& log)
    : device_(device),
      staging_(Buffer::of<PackedState>(device, std::min(log.capacity(), kPiece), Memory::readback, "edit fetch")),
      list_(device, device.throughputQueue(), "edit fetch"),
      reader_(log) {}

void EditFetch::take(EditBatch& batch) {
  const EditLog::Range range = reader_.unread();
  const std::uint64_t capacity = reader_.log().capacity(), before = batch.points.size();
  PALPATE_CHECK_LE(range.size(), capacity);
  batch.points.resize(before + range.size());
  const std::span<const PackedState> staged = staging_.mapped<PackedState>();
  for (std::uint64_t at = range.begin; at < range.end;) {
    const std::uint64_t slot = at % capacity;
    const std::uint64_t count = std::min({range.end - at, capacity - slot, std::uint64_t{staged.size()}});
    list_.begin();
    list_.copy(reader_.log().entriesBuffer(), staging_, count * sizeof(PackedState), slot * sizeof(PackedState), 0);
    list_.end();
    device_.throughputQueue().run(list_);
    std::ranges::transform(staged.first(count),
                           batch.points.begin() + static_cast<std::ptrdiff_t>(before + at - range.begin), stateOf);
    at += count;
  }
  const std::size_t marksBefore = batch.marks.size();
  reader_.takeMarks(range.begin, range.end, batch.marks);
  for (std::size_t i = marksBefore; i < batch.marks.size(); ++i) batch.marks[i].at += before;
  reader_.consume(range.end);
}

}  // namespace palpate
