#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "haptics/pending_edits.hpp"
#include "haptics/session_log.hpp"
#include "haptics/session_log_file.hpp"

namespace palpate {

/// Ticks from the servo thread to a thread that writes them; neither waits for the other.
class TickRing {
 public:
  TickRing() : ring_(kTicks) {}

  /// For the thread that ticks. A tick without room is counted as lost.
  void add(const LoggedTick& tick) noexcept {
    const std::uint64_t next = added_.load(std::memory_order_relaxed);
    if (next - taken_.load(std::memory_order_acquire) == kTicks) {
      lost_.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    ring_[next % kTicks] = tick;
    added_.store(next + 1, std::memory_order_release);
  }
  /// For the thread that writes: appends all added ticks to `ticks`.
  void take(std::vector<LoggedTick>& ticks) {
    const std::uint64_t begin = taken_.load(std::memory_order_relaxed), end = added_.load(std::memory_order_acquire);
    for (std::uint64_t i = begin; i < end; ++i) ticks.push_back(ring_[i % kTicks]);
    taken_.store(end, std::memory_order_release);
  }
  std::uint64_t lost() const { return lost_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kTicks = 1 << 15;  // waiting at most: half a minute at 1 kHz

  std::vector<LoggedTick> ring_;
  std::atomic<std::uint64_t> added_ = 0, taken_ = 0, lost_ = 0;
};

/// Writes a session log on a thread of its own. The file has its name from the beginning, so that a crash leaves what
/// was written: every tick is in it a fifth of a second after it was added. The log's thread flushes the file to the
/// disk at the end of each stroke, and twice a second: a power cut costs a second at most. Data that cannot be written
/// are dropped and counted; later data are written again once that is possible.
class SessionWriter {
 public:
  /// `text` says how to run the session again. `onFailure` is called once, on the log's thread, with a message for the
  /// user, if something cannot be written. Throws FileError if the file cannot be created.
  SessionWriter(std::filesystem::path file, std::string text, std::function<void(const std::string&)> onFailure = {});
  /// Without finish() the log ends like that of a session that was cut off.
  ~SessionWriter();
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  /// For the servo thread: never blocks. A tick without room is counted as lost.
  void add(const LoggedTick& tick) noexcept { ticks_.add(tick); }
  /// For one thread, not the servo's: edits since the last call. If too much waits for the disk, only the last state of
  /// each point in each stroke is kept, and the others are counted as merged.
  void add(const EditBatch& edits) { edits_.add(edits); }
  /// For one thread, not the servo's.
  void add(LoggedCommand command);
  /// States that wait for the disk.
  std::size_t waitingEdits() const { return edits_.size(); }
  /// Waits until all that was added is written, or has failed. Not for the servo thread in real time.
  void flush();
  /// Writes the remainder and how the session ended. Throws FileError that says how much is missing if not all of it
  /// could be written; the session itself was not affected.
  void finish(std::uint64_t pointsChecksum);

  const std::filesystem::path& keptAs() const { return file_.keptAs(); }  ///< an older log of that name
  std::uint64_t lostTicks() const { return ticks_.lost(); }
  std::uint64_t mergedEdits() const { return mergedEdits_; }  ///< after finish()
  std::uint64_t bytes() const { return file_.bytes(); }       ///< of the file; after finish()

 private:
  void serve(const std::stop_token& stop);
  // These on the log's own thread, or after it has ended.
  /// Returns whether a stroke, or another change, is complete now.
  bool writePending();
  /// The ticks that have seen no more than so many states, and are not written yet.
  void writeTicks(std::uint64_t states);
  void writeEdits(std::uint64_t merged);
  void writeCommands();

  SessionLogFile file_;
  TickRing ticks_;
  PendingEdits edits_;
  std::uint64_t mergedEdits_ = 0;

  std::mutex lock_;  // guards the members below
  std::condition_variable_any wake_;
  std::condition_variable written_;
  std::uint64_t asked_ = 0, done_ = 0;  // flushes
  std::vector<LoggedCommand> commands_;

  // Being written by the log's thread.
  std::vector<LoggedTick> takenTicks_;
  std::size_t writtenTicks_ = 0;  // of these
  EditBatch takenEdits_;
  std::uint64_t states_ = 0;  // taken before these
  std::jthread thread_;
};

}  // namespace palpate
