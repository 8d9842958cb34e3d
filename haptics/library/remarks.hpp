// What is said on the way of a call, for who wants to hear it.
#pragma once

#include <palpate/palpate.h>

#include <string>
#include <string_view>

#include "engine/core/log.hpp"

namespace palpate::library {

/// Passes remarks on.
class Remarks final : public LogListener {
 public:
  Remarks(pp_log_function log, void* user) : log_(log), user_(user) {
    if (log) sink_.listen(this);
  }
  Log& sink() { return sink_; }
  void said(std::string_view line) override { log_(user_, std::string(line).c_str()); }
  void progressed(std::string_view, double) override {}

 private:
  pp_log_function log_;
  void* user_;
  Log sink_{true};
};

}  // namespace palpate::library
