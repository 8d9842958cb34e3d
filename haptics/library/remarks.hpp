// What is said on the way of a call, for who wants to hear it.
#pragma once

#include <palpate/palpate.h>

#include <string>
#include <string_view>

#include "engine/core/log.hpp"

namespace palpate::library {

/// This thread is in a log function of the program's, which what it would call may be waiting for.
inline thread_local bool isInLogFunction = false;

/// Passes remarks on.
class Remarks final : public LogListener {
 public:
  Remarks(pp_log_function log, void* user) : log_(log), user_(user) {
    if (log) sink_.listen(this);
  }
  Log& sink() { return sink_; }
  void said(std::string_view line) override {
    struct Inside {
      Inside() { isInLogFunction = true; }
      ~Inside() { isInLogFunction = false; }
    };
    const std::string whole(line);
    const Inside inside;
    log_(user_, whole.c_str());
  }
  /// Waits for the program's function where it is called now; it is not called again.
  void end() { sink_.listen(nullptr); }
  void progressed(std::string_view, double) override {}

 private:
  pp_log_function log_;
  void* user_;
  Log sink_{true};
};

}  // namespace palpate::library
