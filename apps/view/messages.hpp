// Messages to the user: remarks, each shown for a while, and errors, shown until they are closed.
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

  /// Shows and logs a remark; the oldest one is dropped if there are too many.
  void say(const std::string& text);
  /// The same, in place of the one that this showed before.
  void sayNow(const std::string& text);
  /// Shows and logs an error; it stays until it is closed.
  void sayError(const std::string& text);
  /// Shows a remark that is already in the log; drops no other.
  void add(const std::string& text);
  /// Calls `act` and shows its failure. DeviceLost is rethrown: it ends the program.
  void tryTo(const std::function<void()>& act);
  void dropOld();
  /// Clears all messages, as they concern the model before.
  void forget();
  /// Returns whether there were any.
  bool closeErrors();

  std::vector<std::string> remarks() const;  ///< the newest last
  const std::vector<std::string>& errors() const { return errors_; }
  const std::string& last() const { return last_; }  ///< also when it is no longer shown

 private:
  struct Remark {
    std::string text;
    Stopwatch since;
    bool isOfNow = false;
  };
  Log& log_;
  std::deque<Remark> remarks_;
  std::vector<std::string> errors_;  ///< each once, the newest last
  std::string last_;
};

}  // namespace palpate
