// A touch session as a file: input from the device, output to it, and edits of the points, so that it can be run again,
// and so that a crash loses little.
//
// The file: a header (magic, version, a text that says how to run the session again), a copy of the header, then
// blocks. A block has some of the ticks, edits (of points, masks and fields) or commands since the previous one, its
// number, the counts of those before it, and a checksum; the last block of a complete session also says how it ended.
// Blocks are small, and each is found by its marker and its checksum, so that damage or a failed write costs little
// more than itself. All numbers are little-endian; all parts are multiples of four bytes.
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
    kForceless = 32,   ///< the device rendered no force
    kCommand = 64,     ///< commands took effect before it
    kForcesOff = 128   ///< the user had switched the forces off
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

/// What took effect between two ticks.
struct LoggedCommand {
  enum class Kind : std::uint32_t {
    begin,      ///< the log begins in a session that goes on: numbers of the loop and of the contacts
    lend,       ///< from the next tick on the planes felt last answer, until the command after this
    back,       ///< the answers come from the surface again, and nothing else has changed
    brush,      ///< another brush, or none; content: the configuration from now on
    contact,    ///< another surface, force or method; content as of brush
    undo,       ///< content: number of strokes
    redo,       ///< content: number of strokes
    parameter,  ///< of a simulation; content: name and value
    frames,     ///< of a depth camera; content: play, pause or step
    attribute,  ///< a mask or a field changes; without content: it is the next one of EditMark::Kind::attribute
    points,     ///< a PointsAction of a set of points; content: bytesIn() it
    cancel      ///< the stroke in progress was taken back
  };
  std::uint64_t tick = 0;  ///< number of ticks of the log before it
  Kind kind = Kind::back;
  std::string content;
};

/// How a session ended.
struct SessionEnd {
  std::uint64_t points = 0;     ///< checksumOf() the final points
  std::uint64_t lostTicks = 0;  ///< missing in the log, because its thread had fallen behind
};

/// The layout of the file.
namespace session_file {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<char, 8> kMagic{'p', 'a', 'l', 'p', 'l', 'o', 'g', '\n'};
/// Higher with each kind of content that a program did not know before: it must not think that the log is damaged.
constexpr std::uint32_t kVersion = 7;
/// Without masks and fields; version 6 has no held points of layers of strokes. Otherwise the same: they are still
/// read.
constexpr std::uint32_t kOldestRead = 5;
/// The force law under which forces are recorded: another one does not find them again.
constexpr std::uint32_t kForceLaw = 2;

struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion;
  std::uint32_t textBytes = 0;  // padded with blanks to a multiple of eight
  std::uint32_t law = kForceLaw, none = 0;
  std::uint64_t checksum = 0;  // of this with checksum 0, and of the text
};
static_assert(sizeof(Header) == 32);

/// The state of a point.
struct State {
  std::uint64_t number = 0, parent = 0;
  std::uint32_t layer = 0, gone = 0;  // layer: 0, as there is one
  Vec3 position{0}, normal{0};
  std::uint32_t color = 0, none = 0;
};
static_assert(sizeof(State) == 56);

/// A command without its content, which follows, padded with zeros to a multiple of eight.
struct Command {
  std::uint64_t tick = 0;
  std::uint32_t kind = 0, bytes = 0;
};

/// A mark; `at` counts states from the beginning of its block. The changes of masks and fields of its kind follow the
/// marks of the block in order: `bytes` of bytesIn(), padded with zeros to a multiple of eight.
struct Mark {
  std::uint64_t at = 0;
  std::uint64_t kind : 8 = 0, bytes : 56 = 0;
};
static_assert(sizeof(Mark) == 16);

struct Block {
  std::uint32_t magic = 0x6b636c62;  // "blck"
  std::uint32_t number = 0;          // 0, 1, 2, …
  std::uint32_t ticks = 0, states = 0, marks = 0;
  std::uint32_t last = 0;  // 1: last block of the session
  std::uint64_t commands = 0, commandBytes = 0;
  std::uint64_t merged = 0;  // states superseded by later ones of the same point
  SessionEnd end;
  std::uint64_t checksum = 0;  // of this with checksum 0, and of all that follows up to the next block
};
static_assert(sizeof(Block) == 72);

/// Follows the Block, and is followed by its ticks, states, marks and commands: how many of them the session had
/// handed over before, whether or not they could be written. A change of a mask or a field counts as a command.
struct Before {
  std::uint64_t ticks = 0, states = 0, commands = 0;
};
static_assert(sizeof(Before) == 24);

}  // namespace session_file

/// A gap in a log: it is damaged, truncated, or was never written.
struct LogGap {
  std::uint64_t begin = 0, end = 0;  ///< bytes of the file that cannot be read; equal if none were written
  std::size_t tick = 0;              ///< number of ticks of the record before it
  /// Missing ticks, states and commands; nothing if the log does not say: at its end.
  std::optional<std::uint64_t> ticks, states, commands;
};

/// A log as far as it can be read: all its complete blocks.
struct SessionRecord {
  std::string text;  ///< of the header
  std::vector<LoggedTick> ticks;
  EditBatch edits;
  std::vector<LoggedCommand> commands;  ///< in order
  std::vector<LogGap> gaps;             ///< in order
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

/// Throws FileError for a file that cannot be read, is not a session log, is of another version or force law, or has
/// lost both its headers. Other damage is skipped and recorded.
SessionRecord readSessionLog(const std::filesystem::path& file);
/// The same for the edits of a log, also of version 4.
SessionRecord readLoggedEdits(const std::filesystem::path& file);

/// What is missing, and where: a sentence for each gap, and one if the session's end is missing.
std::vector<std::string> whatIsMissing(const SessionRecord& record);

}  // namespace palpate
