#pragma once

#include <atomic>

namespace palpate {

/// While an object lives, a request to end the program (SIGINT, SIGTERM, SIGHUP; on Windows Ctrl+C, Ctrl+Break or
/// closing the console) leads to an orderly end. One object at a time.
class StopBySignal {
 public:
  StopBySignal();
  /// From now on such a request ends the program at once, without the temporary files of its output.
  ~StopBySignal();
  StopBySignal(const StopBySignal&) = delete;
  StopBySignal& operator=(const StopBySignal&) = delete;

  /// Whether an end has been requested since the program began.
  static const std::atomic<bool>& requested();
  /// The exit code of a program ended by that signal: 130 for Ctrl+C, 143 for SIGTERM.
  static int exitCode();
};

/// Before the first object: such a request ends the program at once, as after the last one. So do other signals that
/// end programs; a file that exceeds the limit of sizes is reported by what writes it.
void removeTemporaryFilesAtSignals();

}  // namespace palpate
