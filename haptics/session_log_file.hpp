#pragma once

#include <functional>
#include <span>

#include "engine/core/system_file.hpp"
#include "haptics/session_log.hpp"

namespace palpate {

/// The file of a session log while it is written: its header, and block after block. What cannot be written is left out
/// and counted, and what comes later is written again once it can be. For one thread at a time.
class SessionLogFile {
 public:
  /// `text`: of the header. `onFailure` is called once, at the first failure, with a sentence for a person. Throws
  /// FileError when the file cannot be made.
  SessionLogFile(std::filesystem::path file, std::string text, std::function<void(const std::string&)> onFailure);

  struct Content {
    std::span<const LoggedTick> ticks;
    std::span<const PointState> states;
    std::span<const session_file::Mark> marks;
    std::uint64_t merged = 0;
    const SessionEnd* end = nullptr;
  };
  void append(const Content& content);
  /// Brings what is written to the disk.
  void sync();
  /// Nothing comes any more. Throws FileError that says how much is missing when not all of it could be written.
  void close();

  bool isOpen() const { return output_.isOpen(); }
  std::uint64_t bytes() const { return bytes_; }

 private:
  void fail(int error);
  // What was not written whole is taken away again.
  void takeBackTorn();

  std::filesystem::path file_;
  UnbufferedFile output_;
  std::function<void(const std::string&)> onFailure_;
  std::uint32_t blocks_ = 0;
  session_file::Before before_;  // of the next block
  std::uint64_t bytes_ = 0;
  std::uint64_t unwrittenTicks_ = 0, unwrittenEdits_ = 0;
  std::string failure_;  // the first one
  bool isTorn_ = false;  // for good: nothing can stand behind it
};

}  // namespace palpate
