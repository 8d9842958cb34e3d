// What is said of a file that ends before what its header promises, or may have been cut off.
#pragma once

#include <fmt/format.h>

#include "engine/core/error.hpp"
#include "engine/core/log.hpp"

namespace palpate {

/// `file` ends at byte `end`, after `there` of `promised` things, in words: "points", "rows of element 'face'".
/// `atMost`: fewer may be there, because their sizes differ.
inline FileError endsAfter(const std::filesystem::path& file, std::uint64_t end, std::uint64_t there,
                           std::uint64_t promised, std::string_view things, bool atMost = false) {
  return FileError::atByte(file, end,
                           fmt::format("the file ends after {}{} of {} {}; it is truncated, or its header is wrong",
                                       atMost ? "at most " : "", there, promised, things));
}

/// The last line of a file `name` that does not state how much it contains has no end.
inline void sayOpenLine(std::string_view name, std::uint64_t line, Log& log) {
  log.warn("{}: line {}, the last one, has no end; the file may be truncated", name, line);
}

}  // namespace palpate
