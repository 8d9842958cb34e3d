#include "engine/edit/edit_log.hpp"

#include <algorithm>
#include <bit>

#include "engine/gpu/transfer.hpp"

namespace palpate {

namespace {

// A buffer of slightly less than 4 GiB, the maximum allocation of some drivers. An edit that may write more entries is
// dropped: it would have to change more than a sixteenth of a cloud with more points than that.
constexpr std::uint64_t kMaxEntries = std::bit_floor((std::uint64_t{4094} << 20) / sizeof(PackedState));

}  // namespace

std::uint64_t EditLog::capacityFor(std::uint64_t points, std::uint64_t slack) {
  if (points == 0) return 1;  // no edits
  return std::min(std::bit_ceil(points + std::max(points, slack)), kMaxEntries);
}

EditLog::EditLog(Device& device, std::uint64_t points, std::uint64_t slack)
    : capacity_(capacityFor(points, slack)),
      entries_(Buffer::of<PackedState>(device, capacity_, Memory::device, "edit log")),
      head_(Buffer::of<std::uint32_t>(device, 1, Memory::device, "edit log head")) {
  upload(device, head_, std::vector<std::uint32_t>{0});
}

std::uint64_t EditLog::positionOf(std::uint32_t head) const {
  const std::uint64_t before = published();
  return before + (head - static_cast<std::uint32_t>(before));
}

void EditLog::publish(std::uint32_t head) { published_.store(positionOf(head), std::memory_order_release); }

bool EditLog::publishChange(std::uint32_t head) {
  const std::uint64_t end = positionOf(head);
  if (end == published()) return false;
  mark(end, EditMark::Kind::change);
  published_.store(end, std::memory_order_release);
  return true;
}

void EditLog::publishReceived(std::uint32_t head, bool inStroke) {
  const std::uint64_t end = positionOf(head);
  if (inStroke) mark(published(), EditMark::Kind::part);
  mark(end, EditMark::Kind::received);
  published_.store(end, std::memory_order_release);
}

void EditLog::mark(std::uint64_t position, EditMark::Kind kind) {
  const std::uint64_t next = marked_.load(std::memory_order_relaxed);
  for (const Seat& seat : seats_)
    PALPATE_CHECK(!seat.taken.load(std::memory_order_acquire) ||
                  next - seat.consumedMarks.load(std::memory_order_acquire) < kMarks);
  marks_[next % kMarks] = {position, kind};
  marked_.store(next + 1, std::memory_order_release);
}

std::uint64_t EditLog::room() const {
  std::uint64_t room = capacity_;
  for (const Seat& seat : seats_) {
    if (!seat.taken.load(std::memory_order_acquire)) continue;
    const std::uint64_t marks =
        marked_.load(std::memory_order_relaxed) - seat.consumedMarks.load(std::memory_order_acquire);
    if (marks + kMarksPerTick > kMarks) return 0;
    room = std::min(room, capacity_ - (published() - seat.consumed.load(std::memory_order_acquire)));
  }
  return room;
}

EditLog::Reader::Reader(EditLog& log)
    : log_(log), seat_([&]() -> Seat& {
        for (Seat& seat : log.seats_) {
          if (seat.taken.load(std::memory_order_acquire)) continue;
          seat.consumed.store(log.published_.load(std::memory_order_acquire), std::memory_order_relaxed);
          seat.consumedMarks.store(log.marked_.load(std::memory_order_acquire), std::memory_order_relaxed);
          seat.taken.store(true, std::memory_order_release);
          return seat;
        }
        stopOnBug(__FILE__, __LINE__, "a free seat", fmt::format(" ({} readers)", kMaxReaders));
      }()) {}

EditLog::Reader::~Reader() { seat_.taken.store(false, std::memory_order_release); }

EditLog::Range EditLog::Reader::unread() const {
  return {seat_.consumed.load(std::memory_order_relaxed), log_.published_.load(std::memory_order_acquire)};
}

void EditLog::Reader::takeMarks(std::uint64_t from, std::uint64_t upTo, std::vector<EditMark>& marks) {
  // A mark before an entry was added before that entry was published.
  std::uint64_t next = seat_.consumedMarks.load(std::memory_order_relaxed);
  const std::uint64_t end = log_.marked_.load(std::memory_order_acquire);
  for (; next < end && log_.marks_[next % kMarks].at <= upTo; ++next) {
    const EditMark& mark = log_.marks_[next % kMarks];
    marks.push_back({mark.at - from, mark.kind});
  }
  seat_.consumedMarks.store(next, std::memory_order_release);
}

void EditLog::Reader::consume(std::uint64_t upTo) {
  PALPATE_CHECK_LE(upTo, log_.published_.load(std::memory_order_acquire));
  std::uint64_t next = seat_.consumedMarks.load(std::memory_order_relaxed);
  const std::uint64_t end = log_.marked_.load(std::memory_order_acquire);
  // A mark at `upTo` itself may have been added since the reader looked.
  while (next < end && log_.marks_[next % kMarks].at < upTo) ++next;
  seat_.consumedMarks.store(next, std::memory_order_release);
  seat_.consumed.store(upTo, std::memory_order_release);
}

}  // namespace palpate
