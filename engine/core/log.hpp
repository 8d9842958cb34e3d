// Messages to the user while a command runs: on stderr, with a progress bar on a terminal, plain lines otherwise.
#pragma once

#include <fmt/format.h>

#include "engine/core/clock.hpp"

#include <mutex>
#include <string>
#include <string_view>

namespace palpate {

/// Receives the messages. May throw, which ends the operation that reports.
class LogListener {
 public:
  virtual ~LogListener() = default;
  virtual void said(std::string_view line) = 0;
  virtual void warned(std::string_view line) { said(line); }
  virtual void progressed(std::string_view what, double fraction) = 0;
};

/// A sink for messages and progress. Passed to all code that reports, on any thread; there is no global one.
class Log {
 public:
  explicit Log(bool quiet = false);

  template <class... Args>
  void say(fmt::format_string<Args...> text, Args&&... args) {
    write(fmt::format(text, std::forward<Args>(args)...), &LogListener::said);
  }
  /// The same for what the user has lost, or may lose: points, frames, strokes.
  template <class... Args>
  void warn(fmt::format_string<Args...> text, Args&&... args) {
    write(fmt::format(text, std::forward<Args>(args)...), &LogListener::warned);
  }
  /// `fraction` from 0 to 1; lines are rationed, so it may be called often. Work shorter than a second is not shown.
  /// Throws Stopped if the job of this thread may be cut there.
  void progress(std::string_view what, double fraction);
  /// Removes the bar, at any fraction.
  void endProgress();
  bool isQuiet() const { return quiet_; }

  /// From now on, or until null, a listener receives all messages as well, from every source.
  void listen(LogListener* listener) {
    const std::scoped_lock hold(lock_);
    listener_ = listener;
  }

 private:
  void write(std::string_view line, void (LogListener::*how)(std::string_view));
  void clearBar();

  std::mutex lock_;  // guards the members below
  LogListener* listener_ = nullptr;
  std::string progressOf_;
  Stopwatch progressSince_;
  bool quiet_;
  bool terminal_;
  int lastStep_ = -1;
  bool barShown_ = false;
};

}  // namespace palpate
