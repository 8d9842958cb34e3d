// What the window tells a person, each sentence for a while.
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

  /// Beside a few others, of which the oldest gives way; in the log, too.
  void say(const std::string& text);
  /// Beside all others, what the log has already.
  void add(const std::string& text);
  /// Does it, and says what went wrong. A lost GPU is none of that: it ends the program.
  void tryTo(const std::function<void()>& act);
  void dropOld();

  std::vector<std::string> texts() const;            ///< the newest last
  const std::string& last() const { return last_; }  ///< also when it is gone

 private:
  struct Message {
    std::string text;
    Stopwatch since;
  };
  Log& log_;
  std::deque<Message> shown_;
  std::string last_;
};

}  // namespace palpate
