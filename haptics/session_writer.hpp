#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

#include "haptics/pending_edits.hpp"
#include "haptics/session_log_file.hpp"
#include "haptics/tick_ring.hpp"

namespace palpate {

/// Writes a session log from a thread of its own. The file has its name from the beginning, so that a crash leaves what
/// there is: every tick is in it a fifth of a second after it was added, and on the disk a second after. What cannot be
/// written is left out and counted, and what comes later is written again once it can be.
class SessionWriter {
 public:
  /// `text` says how to run the session again. `onFailure` is called once, on the log's thread, when something cannot
  /// be written, with a sentence for a person. Throws FileError when the file cannot be made.
  SessionWriter(std::filesystem::path file, std::string text, std::function<void(const std::string&)> onFailure = {});
  /// Without finish() the log ends like that of a session that did not come to its end.
  ~SessionWriter();
  SessionWriter(const SessionWriter&) = delete;
  SessionWriter& operator=(const SessionWriter&) = delete;

  /// For the servo thread: waits for nobody. A tick for which there is no room is counted as lost.
  void add(const LoggedTick& tick) noexcept { ticks_.add(tick); }
  /// For one thread, not the servo's: what was done to the points since the last call. Where too much waits for the
  /// disk, only the last state of each point in each stroke is kept of it, and the others are counted as merged.
  void add(const EditBatch& edits) { edits_.add(edits); }
  /// States that wait for the disk.
  std::size_t waitingEdits() const { return edits_.size(); }
  /// Waits until all that was added is in the file, or cannot be. Not for the servo thread against the clock.
  void flush();
  /// Writes what is left and how the session ended. Throws FileError that says how much is missing when not all of it
  /// could be written; the session has gone on without that.
  void finish(std::uint64_t pointsChecksum);

  std::uint64_t lostTicks() const { return ticks_.lost(); }
  std::uint64_t mergedEdits() const { return mergedEdits_; }  ///< after finish()
  std::uint64_t bytes() const { return file_.bytes(); }       ///< of the file; after finish()

 private:
  void serve(const std::stop_token& stop);
  // Both on the log's own thread, or once that is gone.
  void writePending();
  void writeEdits(std::uint64_t merged);

  SessionLogFile file_;
  TickRing ticks_;
  PendingEdits edits_;
  std::uint64_t mergedEdits_ = 0;

  std::mutex lock_;  // of what follows
  std::condition_variable_any wake_;
  std::condition_variable written_;
  std::uint64_t asked_ = 0, done_ = 0;  // flushes

  // What the log's thread is writing.
  std::vector<LoggedTick> takenTicks_;
  EditBatch takenEdits_;
  std::jthread thread_;
};

}  // namespace palpate
