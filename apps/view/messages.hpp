// What the window tells a person: remarks, each for a while, and errors, until they were seen.
#pragma once

#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "engine/core/clock.hpp"

namespace palpate {

class Log;

class Messages {
 public:
  explicit Messages(Log& log) : log_(log) {}

  /// A remark beside a few others, of which the oldest gives way; in the log, too.
  void say(const std::string& text);
  /// What went wrong, likewise; it stays until it is closed.
  void sayError(const std::string& text);
  /// A remark beside all others, what the log has already.
  void add(const std::string& text);
  /// Does it, and says what went wrong. A lost GPU is none of that: it ends the program.
  void tryTo(const std::function<void()>& act);
  void dropOld();
  /// Another model is opened: what was said of the one before is of no use.
  void forget();
  /// Whether there were any.
  bool closeErrors();

  std::vector<std::string> remarks() const;  ///< the newest last
  const std::vector<std::string>& errors() const { return errors_; }
  const std::string& last() const { return last_; }  ///< also when it is gone

 private:
  struct Remark {
    std::string text;
    Stopwatch since;
  };
  Log& log_;
  std::deque<Remark> remarks_;
  std::vector<std::string> errors_;  ///< each once, the newest last
  std::string last_;
};

}  // namespace palpate
