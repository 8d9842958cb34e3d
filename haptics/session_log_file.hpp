#pragma once

#include <functional>
#include <span>

#include "engine/core/system_file.hpp"
#include "haptics/session_log.hpp"

namespace palpate {

/// The file of a session log while it is written: its header, and block after block. Data that cannot be written are
/// dropped and counted; later data are written again once that is possible. Not thread-safe.
class SessionLogFile {
 public:
  /// `text`: of the header. `onFailure` is called once, at the first failure, with a message for the user. An older log
  /// of that name is kept as NAME.bak and so on (AtomicFile::nameToKeep()). Throws FileError if the file cannot be
  /// created.
  SessionLogFile(std::filesystem::path file, std::string text, std::function<void(const std::string&)> onFailure);

  struct Content {
    std::span<const LoggedTick> ticks;
    std::span<const PointState> states;
    std::span<const session_file::Mark> marks;
    std::span<const std::byte> attribute = {};  ///< of the last mark, padded as in the file
    std::span<const LoggedCommand> commands;
    std::uint64_t merged = 0;
    const SessionEnd* end = nullptr;
  };
  /// On a full disk the end takes the place of the last block.
  void append(const Content& content);
  /// Flushes the written data to the disk.
  void sync();
  /// Ends the file. Throws FileError that says how much is missing if not all of it could be written.
  void close();

  bool isOpen() const { return output_.isOpen(); }
  const std::filesystem::path& keptAs() const { return keptAs_; }  ///< the older log; empty if there was none
  std::uint64_t bytes() const { return bytes_; }

 private:
  void fail(int error);
  void keepOlder();
  // Truncates the file after the last complete write.
  void takeBackTorn();
  // The same before the last block. False if there is none.
  bool takeBackLast();

  std::filesystem::path file_, keptAs_;
  UnbufferedFile output_;
  std::function<void(const std::string&)> onFailure_;
  std::uint32_t blocks_ = 0;
  session_file::Before before_;  // of the next block
  std::uint64_t bytes_ = 0;
  struct {
    std::uint64_t bytes = 0, ticks = 0, states = 0, commands = 0;
  } last_;  // the last block that was written
  std::uint64_t unwrittenTicks_ = 0, unwrittenEdits_ = 0, unwrittenCommands_ = 0;
  std::string failure_;  // the first one
  bool isTorn_ = false;  // permanently: nothing can be appended
};

}  // namespace palpate
