#pragma once

#include <atomic>

namespace palpate {

/// While it lives, who asks the program to end (SIGINT, SIGTERM, SIGHUP; on Windows Ctrl+C, Ctrl+Break or a console
/// that is closed) asks for an end in order. One at a time.
class StopBySignal {
 public:
  StopBySignal();
  ~StopBySignal();
  StopBySignal(const StopBySignal&) = delete;
  StopBySignal& operator=(const StopBySignal&) = delete;

  /// Whether anybody has asked since the program began.
  static const std::atomic<bool>& requested();
  /// That of a program that was ended by the signal that asked: 130 for Ctrl+C, 143 for SIGTERM.
  static int exitCode();
};

}  // namespace palpate
