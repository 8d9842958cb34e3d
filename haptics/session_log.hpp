// A touch session as a file: input from the device, output to it, and edits of the points, so that it can be run again,
// and so that a crash loses little.
//
// The file: a header (magic, version, a text that says how to run the session again), a copy of the header, then
// blocks. A block has some of the ticks or edits since the previous one, its number, the counts of those before it, and
// a checksum; the last block of a complete session also says how it ended. Blocks are small, and each is found by its
// marker and its checksum, so that damage or a failed write costs little more than itself. All numbers are
// little-endian; all parts are multiples of four bytes.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/edit_batch.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// One tick as a log keeps it.
struct LoggedTick {
  enum Flag : std::uint32_t {
    kContact = 1,
    kFresh = 2,
    kValid = 4,
    kEditLeftOut = 8,  ///< an edit that the answer requested was not done
    kPutDown = 16,     ///< the stylus was lifted before it, and put down elsewhere
    kForceless = 32    ///< the device rendered no force
  };
  static constexpr int kButtonShift = 24;  ///< the first eight buttons, in the highest bits of the flags
  static constexpr std::uint32_t flagsOf(std::uint32_t buttons) { return buttons << kButtonShift; }

  double time_s = 0;
  DVec3 device{0};  ///< position of the device, in its own unit
  DQuat turn{1, 0, 0, 0};
  DVec3 proxy{0};  ///< model units, in the coordinates of the model's file
  DVec3 force_N{0};
  std::uint64_t edits = 0;  ///< states of the log's edits before the tick's answer
  std::uint32_t neighbours = 0;
  std::uint32_t flags = 0;

  bool has(Flag flag) const { return (flags & flag) != 0; }
  std::uint32_t buttons() const { return flags >> kButtonShift; }
};
static_assert(sizeof(LoggedTick) == 128);

/// How a session ended.
struct SessionEnd {
  std::uint64_t points = 0;     ///< checksumOf() the final points
  std::uint64_t lostTicks = 0;  ///< missing in the log, because its thread had fallen behind
};

/// The layout of the file.
namespace session_file {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<char, 8> kMagic{'p', 'a', 'l', 'p', 'l', 'o', 'g', '\n'};
constexpr std::uint32_t kVersion = 4;
/// The last version with the same layout and another force law, under which its forces were recorded.
constexpr std::uint32_t kOtherForceLaw = 3;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t textBytes = 0;  // padded with blanks to a multiple of eight
  std::uint64_t checksum = 0;   // of this with checksum 0, and of the text
};
static_assert(sizeof(Header) == 24);

/// A mark; `at` counts states from the beginning of its block.
struct Mark {
  std::uint64_t at = 0, kind = 0;
};

struct Block {
  std::uint32_t magic = 0x6b636c62;  // "blck"
  std::uint32_t number = 0;          // 0, 1, 2, …
  std::uint32_t ticks = 0, states = 0, marks = 0;
  std::uint32_t last = 0;    // 1: last block of the session
  std::uint64_t merged = 0;  // states superseded by later ones of the same point
  SessionEnd end;
  std::uint64_t checksum = 0;  // of this with checksum 0, and of all that follows up to the next block
};
static_assert(sizeof(Block) == 56);

/// Follows the Block, and is followed by its ticks, states and marks: how many of them the session had
/// handed over before, whether or not they could be written.
struct Before {
  std::uint64_t ticks = 0, states = 0;
};
static_assert(sizeof(Before) == 16);

}  // namespace session_file

/// A gap in a log: it is damaged, truncated, or was never written.
struct LogGap {
  std::uint64_t begin = 0, end = 0;  ///< bytes of the file that cannot be read; equal if none were written
  std::size_t tick = 0;              ///< number of ticks of the record before it
  /// Missing ticks and states; nothing if the log does not say: at its end.
  std::optional<std::uint64_t> ticks, states;
};

/// A log as far as it can be read: all its complete blocks.
struct SessionRecord {
  std::string text;  ///< of the header
  std::vector<LoggedTick> ticks;
  EditBatch edits;
  std::vector<LogGap> gaps;  ///< in order
  /// States superseded by a later one of the same point, because the log had fallen behind.
  std::uint64_t mergedEdits = 0;
  /// Number of states before the first gap or merge: up to there the ticks' `edits` count the states that are here.
  std::uint64_t countedEdits = 0;
  std::optional<SessionEnd> end;  ///< nothing if the session was cut off
  std::uint64_t wholeBytes = 0;   ///< up to the end of the last complete block
  std::uint64_t fileBytes = 0;    ///< larger than that if the end is torn
};

/// Whether a file begins like a session log; false if it cannot be read.
bool isSessionLog(const std::filesystem::path& file);

/// Throws FileError for a file that cannot be read, is not a session log, is of another version, or has lost both its
/// headers. Other damage is skipped and recorded.
SessionRecord readSessionLog(const std::filesystem::path& file);

/// What is missing, and where: a sentence for each gap, and one if the session's end is missing.
std::vector<std::string> whatIsMissing(const SessionRecord& record);

}  // namespace palpate
