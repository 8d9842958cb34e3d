// A touch session as a file: what came from the device, what went to it, and what was done to the points, so that it
// can be run again, and so that a crash loses little.
//
// The file: a header (magic, version, a text that says how to run the session again), then blocks. A block has the
// ticks and edits that have come since the last one, its number and a checksum; the last block of a session that ended
// also says how it ended. All numbers are little-endian; all parts are multiples of four bytes.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "engine/core/edit_batch.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// One tick as a log keeps it.
struct LoggedTick {
  enum Flag : std::uint32_t {
    kContact = 1,
    kFresh = 2,
    kValid = 4,
    kEditLeftOut = 8,  ///< an edit that the answer asked for was not done
    kPutDown = 16,     ///< the stylus was lifted before it, and put down elsewhere
    kForceless = 32    ///< the device let no force through
  };
  static constexpr int kButtonShift = 24;  ///< the first eight buttons, in the highest bits of the flags
  static constexpr std::uint32_t flagsOf(std::uint32_t buttons) { return buttons << kButtonShift; }

  double time_s = 0;
  DVec3 device{0};  ///< where the device was, in its own unit
  DQuat turn{1, 0, 0, 0};
  DVec3 proxy{0};  ///< model units, in the coordinates of the model's file
  DVec3 force_N{0};
  std::uint64_t edits = 0;  ///< states of the log's edits that came before the tick's answer
  std::uint32_t neighbours = 0;
  std::uint32_t flags = 0;

  bool has(Flag flag) const { return (flags & flag) != 0; }
  std::uint32_t buttons() const { return flags >> kButtonShift; }
};
static_assert(sizeof(LoggedTick) == 128);

/// How a session ended.
struct SessionEnd {
  std::uint64_t points = 0;     ///< checksumOf() the points as they were in the end
  std::uint64_t lostTicks = 0;  ///< that the log has not, because its thread had fallen behind
};

/// The layout of the file.
namespace session_file {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<char, 8> kMagic{'p', 'a', 'l', 'p', 'l', 'o', 'g', '\n'};
constexpr std::uint32_t kVersion = 2;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t textBytes = 0;  // padded with blanks to a multiple of eight
  std::uint64_t checksum = 0;   // of the text
};
static_assert(sizeof(Header) == 24);

/// A mark, counted in states from the beginning of its block.
struct Mark {
  std::uint64_t at = 0, kind = 0;
};

struct Block {
  std::uint32_t magic = 0x6b636c62;  // "blck"
  std::uint32_t number = 0;          // 0, 1, 2, …
  std::uint32_t ticks = 0, states = 0, marks = 0;
  std::uint32_t last = 0;    // 1: the session ended with it
  std::uint64_t merged = 0;  // states that gave way to later ones of the same point
  SessionEnd end;
  std::uint64_t checksum = 0;  // of this with checksum 0, and of the ticks, states and marks that follow
};
static_assert(sizeof(Block) == 56);

}  // namespace session_file

/// A log as it was read, up to its last whole block.
struct SessionRecord {
  std::string text;  ///< of the header
  std::vector<LoggedTick> ticks;
  EditBatch edits;
  /// States left out because a later one of the same point followed, where the log had fallen behind; and how many
  /// states stand before the first such place: that far the ticks' `edits` count the states that are here.
  std::uint64_t mergedEdits = 0, countedEdits = 0;
  std::optional<SessionEnd> end;  ///< nothing where the session did not come to its end
  std::uint64_t wholeBytes = 0;   ///< up to the end of the last whole block
  std::uint64_t fileBytes = 0;    ///< more than that where the last block is torn
};

/// Whether a file begins like a session log. False for one that cannot be read.
bool isSessionLog(const std::filesystem::path& file);

/// Throws FileError for a file that cannot be read, is no session log, is of another version, or has a damaged header.
/// A block that is torn or damaged ends the record.
SessionRecord readSessionLog(const std::filesystem::path& file);

}  // namespace palpate
