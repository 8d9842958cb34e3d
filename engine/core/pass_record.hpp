#pragma once

#include <cstdint>
#include <string>

namespace palpate {

/// One recorded command, for --print-frame.
struct PassRecord {
  std::string section;
  std::string name;
  std::uint64_t threads =
      0;  ///< invocations that have work, vertices of a draw; 0 for copies and fills, and where the GPU decides
  std::uint64_t bytes = 0;  ///< bytes of the arguments, or moved by a copy or fill
  bool waits = true;        ///< for all passes before it
  double gpu_us = 0;        ///< last measured time; 0 unless passes are timed, and past the first 200 of a list
};

}  // namespace palpate
