#include "haptics/session_writer.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "engine/core/clock.hpp"

namespace palpate {

namespace {

constexpr auto kBetweenBlocks = std::chrono::milliseconds(100);
constexpr double kBetweenSyncs_s = 0.8;
// Maximum of a block: the loss if one is torn.
constexpr std::size_t kBlock_bytes = 1 << 14;

}  // namespace

SessionWriter::SessionWriter(std::filesystem::path file, std::string text,
                             std::function<void(const std::string&)> onFailure)
    : file_(std::move(file), std::move(text), std::move(onFailure)),
      thread_([this](const std::stop_token& stop) { serve(stop); }) {}

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
    writePending();
    if (sinceSync.elapsed_s() > kBetweenSyncs_s) {
      file_.sync();
      sinceSync = Stopwatch();
    }
    const std::scoped_lock hold(lock_);
    done_ = asked;
    written_.notify_all();
  }
}

void SessionWriter::writePending() {
  const std::uint64_t merged = edits_.take(takenEdits_);
  mergedEdits_ += merged;
  takenTicks_.clear();
  ticks_.take(takenTicks_);
  writeCommands();
  writeEdits(merged);
  constexpr std::size_t kTicks = kBlock_bytes / sizeof(LoggedTick);
  for (std::span<const LoggedTick> left = takenTicks_; !left.empty();
       left = left.subspan(std::min(kTicks, left.size())))
    file_.append({.ticks = left.first(std::min(kTicks, left.size()))});
}

void SessionWriter::writeCommands() {
  std::vector<LoggedCommand> commands;
  {
    const std::scoped_lock hold(lock_);
    commands.swap(commands_);
  }
  for (const LoggedCommand& command : commands) file_.append({.commands = {&command, 1}});
}

void SessionWriter::writeEdits(std::uint64_t merged) {
  constexpr std::size_t kStates = kBlock_bytes / sizeof(session_file::State);
  const std::span<const PointState> states = takenEdits_.points;
  std::vector<session_file::Mark> marks;
  for (std::size_t begin = 0, mark = 0; begin < states.size() || mark < takenEdits_.marks.size();) {
    const std::size_t end = std::min(begin + kStates, states.size());
    marks.clear();
    for (; mark < takenEdits_.marks.size() && takenEdits_.marks[mark].at <= end; ++mark)
      marks.push_back({takenEdits_.marks[mark].at - begin, static_cast<std::uint64_t>(takenEdits_.marks[mark].kind)});
    file_.append({.states = states.subspan(begin, end - begin), .marks = marks, .merged = std::exchange(merged, 0)});
    begin = end;
  }
  takenEdits_.clear();
}

}  // namespace palpate
