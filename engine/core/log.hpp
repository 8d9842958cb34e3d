// What a person reads while a command runs: on stderr, a bar on a terminal, plain lines otherwise.
#pragma once

#include <fmt/format.h>

#include "engine/core/clock.hpp"

#include <mutex>
#include <string>
#include <string_view>

namespace palpate {

/// Receives what a person would read. May throw, which ends what says it.
class LogListener {
 public:
  virtual ~LogListener() = default;
  virtual void said(std::string_view line) = 0;
  virtual void progressed(std::string_view what, double fraction) = 0;
};

/// A sink for remarks and progress. Passed to whoever has something to say, on any thread; there is no global one.
class Log {
 public:
  explicit Log(bool quiet = false);

  template <class... Args>
  void say(fmt::format_string<Args...> text, Args&&... args) {
    write(fmt::format(text, std::forward<Args>(args)...));
  }
  /// `fraction` from 0 to 1; lines are rationed, so it may be called often. What is done within a second is not shown.
  /// Throws Stopped where the job of this thread may be cut there.
  void progress(std::string_view what, double fraction);
  /// Takes the bar away, however far it has come.
  void endProgress();
  bool isQuiet() const { return quiet_; }

  /// From now on, or until null, a listener receives all of it as well, whoever says it.
  void listen(LogListener* listener) {
    const std::scoped_lock hold(lock_);
    listener_ = listener;
  }

 private:
  void write(std::string_view line);
  void clearBar();

  std::mutex lock_;  // of what follows
  LogListener* listener_ = nullptr;
  std::string progressOf_;
  Stopwatch progressSince_;
  bool quiet_;
  bool terminal_;
  int lastTenth_ = -1;
  bool barShown_ = false;
};

}  // namespace palpate
