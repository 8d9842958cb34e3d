#include "haptics/session_writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
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

using session_file::Before;
using session_file::Block;
using session_file::Header;
using session_file::Mark;

constexpr auto kBetweenBlocks = std::chrono::milliseconds(100);
constexpr double kBetweenSyncs_s = 0.8;

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

SessionWriter::SessionWriter(std::filesystem::path file, std::string text, std::function<void(const std::string&)> tell)
    : file_(std::move(file)), tell_(std::move(tell)), ring_(kRing) {
  if (file_.empty()) throw Error("a session log has an empty name; give it one");
  descriptor_ = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw FileError(file_, becauseOf(errno));
  text.resize((text.size() + 7) / 8 * 8, ' ');
  Header header{.textBytes = static_cast<std::uint32_t>(text.size())};
  Checksum sum;
  sum.add(std::as_bytes(std::span(&header, 1)));
  sum.add(std::as_bytes(std::span(text)));
  header.checksum = sum.value();
  int error = 0;
  for (int copy = 0; copy < 2 && error == 0; ++copy) {
    error = put(std::as_bytes(std::span(&header, 1)));
    if (error == 0) error = put(std::as_bytes(std::span(text)));
  }
  if (error != 0) {
    ::close(descriptor_);
    throw FileError(file_, becauseOf(error));
  }
  bytes_ = 2 * (sizeof header + text.size());
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
  writeBlock({.end = &end});
  sync();
  if (::close(std::exchange(descriptor_, -1)) != 0) fail(errno);
  if (failure_.empty()) return;
  const std::string missing =
      unwrittenTicks_ + unwrittenEdits_ > 0
          ? fmt::format("{} ticks and {} edits of points are missing in it", unwrittenTicks_, unwrittenEdits_)
          : "what is in it may not be on the disk";
  throw FileError(file_, fmt::format("{} ({}; the session went on)", failure_, missing));
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
  writeEdits(merged);
  constexpr std::size_t kTicks = kBlock_bytes / sizeof(LoggedTick);
  for (std::span<const LoggedTick> left = ticks_; !left.empty(); left = left.subspan(std::min(kTicks, left.size())))
    writeBlock({.ticks = left.first(std::min(kTicks, left.size()))});
}

void SessionWriter::writeEdits(std::uint64_t merged) {
  constexpr std::size_t kStates = kBlock_bytes / sizeof(PointState);
  const std::span<const PointState> states = edits_.points;
  std::vector<Mark> marks;
  for (std::size_t begin = 0, mark = 0; begin < states.size() || mark < edits_.marks.size();) {
    const std::size_t end = std::min(begin + kStates, states.size());
    marks.clear();
    for (; mark < edits_.marks.size() && edits_.marks[mark].at <= end; ++mark)
      marks.push_back({edits_.marks[mark].at - begin, static_cast<std::uint64_t>(edits_.marks[mark].kind)});
    writeBlock({.states = states.subspan(begin, end - begin), .marks = marks, .merged = std::exchange(merged, 0)});
    begin = end;
  }
  edits_.clear();
}

void SessionWriter::writeBlock(const Content& content) {
  Block block{.number = blocks_++,
              .ticks = static_cast<std::uint32_t>(content.ticks.size()),
              .states = static_cast<std::uint32_t>(content.states.size()),
              .marks = static_cast<std::uint32_t>(content.marks.size()),
              .last = content.end != nullptr,
              .merged = content.merged};
  if (content.end) block.end = *content.end;
  const Before before = before_;
  before_ = {before.ticks + block.ticks, before.states + block.states};
  const std::array body{std::as_bytes(content.ticks), std::as_bytes(content.states), std::as_bytes(content.marks)};
  Checksum sum;
  sum.addValue(block);
  sum.addValue(before);
  for (const auto bytes : body) sum.add(bytes);
  block.checksum = sum.value();
  std::size_t size = sizeof block + sizeof before;
  int error = isTorn_ ? EIO : put(std::as_bytes(std::span(&block, 1)));
  if (error == 0) error = put(std::as_bytes(std::span(&before, 1)));
  for (const auto bytes : body) {
    if (error == 0) error = put(bytes);
    size += bytes.size();
  }
  if (error == 0) {
    bytes_ += size;
    return;
  }
  unwrittenTicks_ += block.ticks;
  unwrittenEdits_ += block.states;
  takeBackTorn();
  fail(error);
}

int SessionWriter::put(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return 0;
}

void SessionWriter::takeBackTorn() {
  if (isTorn_) return;
  const auto whole = static_cast<off_t>(bytes_);
  isTorn_ = ::ftruncate(descriptor_, whole) != 0 || ::lseek(descriptor_, whole, SEEK_SET) != whole;
}

void SessionWriter::fail(int error) {
  if (!failure_.empty()) return;
  failure_ = becauseOf(error);
  if (tell_)
    tell_(fmt::format("{}: {}; the session goes on, and what cannot be written is missing in its log", file_.string(),
                      failure_));
}

void SessionWriter::sync() {
  // What is no ordinary file, like a pipe, has nothing to bring to a disk.
  if (::fdatasync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) fail(errno);
}

}  // namespace palpate
