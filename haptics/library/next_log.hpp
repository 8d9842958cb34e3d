// The log that the next path, or live session, is recorded to.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "haptics/session/session.hpp"

namespace palpate::library {

class NextLog {
 public:
  void set(const std::string& file) { file_ = file; }
  explicit operator bool() const { return file_.has_value(); }

  /// Begins to record, if a file was set. `log` receives what cannot be recorded, and must outlive the recording.
  void begin(Session& session, const OpenHand& hand, const RunOptions& run, Log& log) {
    if (!file_) return;
    const std::string file = *std::exchange(file_, std::nullopt);
    session.record(
        file, hand, [&log](const std::string& what) { log.warn("{}", what); }, run);
  }

 private:
  std::optional<std::string> file_;
};

}  // namespace palpate::library
