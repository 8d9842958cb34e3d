#include "haptics/session_writer.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "engine/cloud/attribute_bytes.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/start_thread.hpp"

namespace palpate {

namespace {

constexpr auto kBetweenBlocks = std::chrono::milliseconds(100);
constexpr double kBetweenSyncs_s = 0.5;
// Maximum of a block: the loss if one is torn.
constexpr std::size_t kBlock_bytes = 1 << 14;

}  // namespace

SessionWriter::SessionWriter(std::filesystem::path file, std::string text,
                             std::function<void(const std::string&)> onFailure)
    : file_(std::move(file), std::move(text), std::move(onFailure)),
      thread_(startThread([this](const std::stop_token& stop) { serve(stop); })) {}

SessionWriter::~SessionWriter() {
  thread_ = {};
  if (!file_.isOpen()) return;
  try {
    writePending();
  } catch (...) {  // no memory: the log ends with the previous block
  }
}

void SessionWriter::add(LoggedCommand command) {
  const std::scoped_lock hold(lock_);
  commands_.push_back(std::move(command));
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
  file_.append({.end = &end});
  file_.close();
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
    const bool endsStroke = writePending();
    {
      const std::scoped_lock hold(lock_);
      done_ = asked;
      written_.notify_all();
    }
    if (!endsStroke && sinceSync.elapsed_s() < kBetweenSyncs_s) continue;
    file_.sync();
    sinceSync = Stopwatch();
  }
}

bool SessionWriter::writePending() {
  const std::uint64_t merged = edits_.take(takenEdits_);
  mergedEdits_ += merged;
  takenTicks_.clear();
  writtenTicks_ = 0;
  ticks_.take(takenTicks_);
  const bool endsStroke = std::ranges::any_of(takenEdits_.marks, [](const EditMark& mark) {
    return mark.kind == EditMark::Kind::stroke || mark.kind == EditMark::Kind::change || mark.hasAttribute();
  });
  const std::uint64_t states = takenEdits_.points.size() + merged;
  writeCommands();
  writeEdits(merged);
  states_ += states;
  writeTicks(std::numeric_limits<std::uint64_t>::max());
  return endsStroke;
}

void SessionWriter::writeTicks(std::uint64_t states) {
  constexpr std::size_t kTicks = kBlock_bytes / sizeof(LoggedTick);
  const std::span<const LoggedTick> all = takenTicks_;
  while (writtenTicks_ < all.size() && all[writtenTicks_].edits <= states) {
    std::size_t end = writtenTicks_;
    while (end < all.size() && end - writtenTicks_ < kTicks && all[end].edits <= states) ++end;
    file_.append({.ticks = all.subspan(writtenTicks_, end - writtenTicks_)});
    writtenTicks_ = end;
  }
}

void SessionWriter::writeCommands() {
  std::vector<LoggedCommand> commands;
  {
    const std::scoped_lock hold(lock_);
    commands.swap(commands_);
  }
  for (const LoggedCommand& command : commands) file_.append({.commands = {&command, 1}});
}

// Each block of edits follows the ticks before its edits, so that an end that is lost, or damage, costs as much of
// both.
// Each change of a mask or a field ends its block.
void SessionWriter::writeEdits(std::uint64_t merged) {
  constexpr std::size_t kStates = kBlock_bytes / sizeof(session_file::State);
  const std::span<const PointState> states = takenEdits_.points;
  const std::vector<EditMark>& all = takenEdits_.marks;
  std::vector<session_file::Mark> marks;
  std::vector<std::byte> attribute;  // of the last of these
  auto next = takenEdits_.attributes.begin();
  for (std::size_t begin = 0, mark = 0; begin < states.size() || mark < all.size();) {
    writeTicks(states_ + begin);
    std::size_t end = std::min(begin + kStates, states.size());
    marks.clear();
    attribute.clear();
    for (; mark < all.size() && all[mark].at <= end && attribute.empty(); ++mark) {
      marks.push_back({.at = all[mark].at - begin, .kind = static_cast<std::uint8_t>(all[mark].kind)});
      if (!all[mark].hasAttribute()) continue;
      end = all[mark].at;
      attribute = bytesIn(*next++);
      marks.back().bytes = attribute.size();
      attribute.resize((attribute.size() + 7) / 8 * 8);
    }
    file_.append({.states = states.subspan(begin, end - begin),
                  .marks = marks,
                  .attribute = attribute,
                  .merged = std::exchange(merged, 0)});
    begin = end;
  }
  takenEdits_.clear();
}

}  // namespace palpate
