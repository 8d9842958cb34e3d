// Messages of a call, for the program's log function.
#pragma once

#include <palpate/palpate.h>

#include <string>
#include <string_view>

#include "engine/core/log.hpp"
#include "haptics/library/callbacks.hpp"
#include "haptics/library/watch.hpp"

namespace palpate::library {

/// Passes messages to the program.
class Messages final : public LogListener {
 public:
  /// `watch` receives progress, if the program wants it; must outlive this.
  Messages(pp_log_function log, void* user, Watch& watch) : log_(log), user_(user), watch_(watch) {
    if (log || watch.isTold()) sink_.listen(this);
  }
  Log& sink() { return sink_; }
  void said(std::string_view line) override {
    if (!log_) return;
    const std::string whole(line);
    const InCallback inside;
    log_(user_, whole.c_str());
  }
  /// Waits for a call of the program's function in progress; no further calls are made.
  void end() { sink_.listen(nullptr); }
  void progressed(std::string_view what, double share) override { watch_.progressed(what, share); }

 private:
  pp_log_function log_;
  void* user_;
  Watch& watch_;
  Log sink_{true};
};

}  // namespace palpate::library
