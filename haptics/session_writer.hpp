#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <span>
#include <thread>

#include "haptics/session_log.hpp"

namespace palpate {

/// Writes a session log from a thread of its own. The file has its name from the beginning, so that a crash leaves what
/// there is: every tick is in it a fifth of a second after it was added, and on the disk a second after. What cannot be
/// written is left out and counted, and what comes later is written again once it can be.
class SessionWriter {
 public:
  /// `text` says how to run the session again. `tell` is called once, on the log's thread, when something cannot be
  /// written, with a sentence for a person. Throws FileError when the file cannot be made.
  SessionWriter(std::filesystem::path file, std::string text, std::function<void(const std::string&)> tell = {});
  /// Without finish() the log ends like that of a session that did not come to its end.
  ~SessionWriter();
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  /// For the servo thread: waits for nobody. A tick for which there is no room is counted as lost.
  void add(const LoggedTick& tick) noexcept;
  /// For one thread, not the servo's: what was done to the points since the last call. Where too much waits for the
  /// disk, only the last state of each point in each stroke is kept of it, and the others are counted as merged.
  void add(const EditBatch& edits);
  /// States that wait for the disk.
  std::size_t waitingEdits() const;
  /// Waits until all that was added is in the file, or cannot be. Not for the servo thread against the clock.
  void flush();
  /// Writes what is left and how the session ended. Throws FileError that says how much is missing when not all of it
  /// could be written; the session has gone on without that.
  void finish(std::uint64_t pointsChecksum);

  std::uint64_t lostTicks() const { return lostTicks_.load(std::memory_order_relaxed); }
  std::uint64_t mergedEdits() const { return mergedEdits_; }  ///< after finish()
  std::uint64_t bytes() const { return bytes_; }              ///< of the file; after finish()

 private:
  static constexpr std::size_t kRing = 1 << 15;       // ticks that may wait: half a minute at 1 kHz
  static constexpr std::size_t kMostEdits = 1 << 20;  // states that may
  // Of a block: as much as a torn one costs.
  static constexpr std::size_t kBlock_bytes = 1 << 14;

  void serve(const std::stop_token& stop);
  // Both on the log's own thread, or once that is gone.
  void writePending();
  void writeEdits(std::uint64_t merged);
  struct Content {
    std::span<const LoggedTick> ticks;
    std::span<const PointState> states;
    std::span<const session_file::Mark> marks;
    std::uint64_t merged = 0;
    const SessionEnd* end = nullptr;
  };
  void writeBlock(const Content& content);
  // The system's number of what went wrong, or 0.
  int put(std::span<const std::byte> bytes);
  void fail(int error);
  // What was not written whole is taken away again.
  void takeBackTorn();
  void sync();

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::function<void(const std::string&)> tell_;
  std::uint32_t blocks_ = 0;
  session_file::Before before_;  // of the next block
  std::uint64_t bytes_ = 0, mergedEdits_ = 0;
  std::uint64_t unwrittenTicks_ = 0, unwrittenEdits_ = 0;
  std::string failure_;  // the first one
  bool isTorn_ = false;  // for good: nothing can stand behind it

  std::vector<LoggedTick> ring_;
  std::atomic<std::uint64_t> added_ = 0, taken_ = 0, lostTicks_ = 0;

  mutable std::mutex lock_;  // of what follows
  std::condition_variable_any wake_;
  std::condition_variable written_;
  EditBatch pending_;
  std::uint64_t pendingMerged_ = 0;
  std::size_t leastPending_ = 0;        // what merging left
  std::uint64_t asked_ = 0, done_ = 0;  // flushes

  EditBatch edits_;  // the log thread's
  std::vector<LoggedTick> ticks_;
  std::jthread thread_;
};

}  // namespace palpate
