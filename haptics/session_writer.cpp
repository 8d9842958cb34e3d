#include "haptics/session_writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <numeric>
#include <utility>

#include "engine/core/check.hpp"
#include "engine/core/checksum.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

using session_file::Block;
using session_file::Header;
using session_file::Mark;

constexpr auto kBetweenBlocks = std::chrono::milliseconds(100);
constexpr double kBetweenSyncs_s = 0.8;
constexpr double kLongestBlock_s = 0.5;  // of session time

std::string becauseOf(int error) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  return fmt::format("cannot be written: {}{}", std::strerror(error), full ? "; free some space" : "");
}

// Of each stretch between marks, the last state of each point. Says how many went.
std::uint64_t mergeEdits(EditBatch& edits) {
  const std::vector<PointState> all = std::exchange(edits.points, {});
  std::vector<std::uint32_t> order;
  const auto keep = [&](std::size_t begin, std::size_t end) {
    order.resize(end - begin);
    std::iota(order.begin(), order.end(), static_cast<std::uint32_t>(begin));
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return all[i].number(); });
    for (std::size_t i = 0; i < order.size(); ++i)
      if (i + 1 == order.size() || all[order[i]].number() != all[order[i + 1]].number())
        edits.points.push_back(all[order[i]]);
  };
  std::size_t begin = 0;
  for (EditMark& mark : edits.marks) {
    keep(begin, mark.at);
    begin = std::exchange(mark.at, edits.points.size());
  }
  keep(begin, all.size());
  return all.size() - edits.points.size();
}

}  // namespace

SessionWriter::SessionWriter(std::filesystem::path file, std::string text) : file_(std::move(file)), ring_(kRing) {
  if (file_.empty()) throw Error("a session log has an empty name; give it one");
  descriptor_ = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw FileError(file_, becauseOf(errno));
  text.resize((text.size() + 7) / 8 * 8, ' ');
  Checksum sum;
  sum.add(std::as_bytes(std::span(text)));
  const Header header{.textBytes = static_cast<std::uint32_t>(text.size()), .checksum = sum.value()};
  put(std::as_bytes(std::span(&header, 1)));
  put(std::as_bytes(std::span(text)));
  if (!failure_.empty()) {
    ::close(descriptor_);
    throw FileError(file_, failure_);
  }
  thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
}

SessionWriter::~SessionWriter() {
  thread_ = {};
  if (descriptor_ < 0) return;
  try {
    writePending();
  } catch (...) {  // no memory: the log ends with the block before
  }
  ::close(descriptor_);
}

void SessionWriter::add(const LoggedTick& tick) noexcept {
  const std::uint64_t next = added_.load(std::memory_order_relaxed);
  if (next - taken_.load(std::memory_order_acquire) == kRing) {
    lostTicks_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  ring_[next % kRing] = tick;
  added_.store(next + 1, std::memory_order_release);
}

void SessionWriter::add(const EditBatch& edits) {
  const std::scoped_lock hold(lock_);
  const std::size_t before = pending_.points.size();
  pending_.points.insert(pending_.points.end(), edits.points.begin(), edits.points.end());
  for (const EditMark& mark : edits.marks) pending_.marks.push_back({before + mark.at, mark.kind});
  // Merged at most once for as many states as there may be, so that it stays cheap where all are of different points.
  if (pending_.points.size() - leastPending_ < kMostEdits) return;
  pendingMerged_ += mergeEdits(pending_);
  leastPending_ = pending_.points.size();
}

std::size_t SessionWriter::waitingEdits() const {
  const std::scoped_lock hold(lock_);
  return pending_.points.size();
}

void SessionWriter::flush() {
  std::unique_lock hold(lock_);
  const std::uint64_t mine = ++asked_;
  wake_.notify_all();
  written_.wait(hold, [&] { return done_ >= mine; });
}

void SessionWriter::finish(std::uint64_t pointsChecksum) {
  thread_ = {};
  writePending();
  const SessionEnd end{.points = pointsChecksum, .lostTicks = lostTicks()};
  writeBlock({}, {}, 0, &end);
  sync();
  if (::close(std::exchange(descriptor_, -1)) != 0 && failure_.empty()) failure_ = becauseOf(errno);
  if (!failure_.empty()) throw FileError(file_, failure_ + " (the session went on without its log)");
}

void SessionWriter::serve(const std::stop_token& stop) {
  Stopwatch sinceSync;
  while (!stop.stop_requested()) {
    std::uint64_t asked = 0;
    {
      std::unique_lock hold(lock_);
      wake_.wait_for(hold, stop, kBetweenBlocks, [this] { return asked_ > done_; });
      asked = asked_;
    }
    writePending();
    if (sinceSync.elapsed_s() > kBetweenSyncs_s) {
      sync();
      sinceSync = Stopwatch();
    }
    const std::scoped_lock hold(lock_);
    done_ = asked;
    written_.notify_all();
  }
}

void SessionWriter::writePending() {
  std::uint64_t merged = 0;
  {
    const std::scoped_lock hold(lock_);
    std::swap(pending_, edits_);
    merged = std::exchange(pendingMerged_, 0);
    leastPending_ = 0;
  }
  mergedEdits_ += merged;
  const std::uint64_t begin = taken_.load(std::memory_order_relaxed), end = added_.load(std::memory_order_acquire);
  ticks_.clear();
  for (std::uint64_t i = begin; i < end; ++i) ticks_.push_back(ring_[i % kRing]);
  taken_.store(end, std::memory_order_release);
  // Blocks of half a second, the edits with the first.
  std::span<const LoggedTick> left = ticks_;
  while (!left.empty() || !edits_.empty()) {
    std::size_t count = 0;
    while (count < left.size() && left[count].time_s <= left.front().time_s + kLongestBlock_s) ++count;
    writeBlock(left.first(count), edits_, std::exchange(merged, 0), nullptr);
    edits_.clear();
    left = left.subspan(count);
  }
}

void SessionWriter::writeBlock(std::span<const LoggedTick> ticks, const EditBatch& edits, std::uint64_t merged,
                               const SessionEnd* end) {
  if (!failure_.empty()) return;  // nothing stands behind a gap
  std::vector<Mark> marks;
  for (const EditMark& mark : edits.marks) marks.push_back({mark.at, static_cast<std::uint64_t>(mark.kind)});
  Block block{.number = blocks_++,
              .ticks = static_cast<std::uint32_t>(ticks.size()),
              .states = static_cast<std::uint32_t>(edits.points.size()),
              .marks = static_cast<std::uint32_t>(marks.size()),
              .last = end != nullptr,
              .merged = merged};
  if (end) block.end = *end;
  const auto tickBytes = std::as_bytes(ticks), stateBytes = std::as_bytes(std::span(edits.points)),
             markBytes = std::as_bytes(std::span(marks));
  Checksum sum;
  sum.addValue(block);
  for (const auto bytes : {tickBytes, stateBytes, markBytes}) sum.add(bytes);
  block.checksum = sum.value();
  put(std::as_bytes(std::span(&block, 1)));
  for (const auto bytes : {tickBytes, stateBytes, markBytes}) put(bytes);
}

void SessionWriter::put(std::span<const std::byte> bytes) {
  while (!bytes.empty() && failure_.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      failure_ = becauseOf(errno);
      return;
    }
    bytes_ += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void SessionWriter::sync() {
  // What is no ordinary file, like a pipe, has nothing to bring to a disk.
  if (failure_.empty() && ::fdatasync(descriptor_) != 0 && errno != EINVAL && errno != EROFS)
    failure_ = becauseOf(errno);
}

}  // namespace palpate
