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
  void said(std::string_view line) override { tell(PP_LOG_NOTE, line); }
  void warned(std::string_view line) override { tell(PP_LOG_WARNING, line); }
  /// Waits for a call of the program's function in progress; no further calls are made.
  void end() { sink_.listen(nullptr); }
  void progressed(std::string_view what, double share) override { watch_.progressed(what, share); }

 private:
  void tell(pp_log_level level, std::string_view line) {
    if (!log_) return;
    const std::string whole(line);
    const InCallback inside;
    log_(user_, level, whole.c_str());
  }

  pp_log_function log_;
  void* user_;
  Watch& watch_;
  Log sink_{true};
};

}  // namespace palpate::library
