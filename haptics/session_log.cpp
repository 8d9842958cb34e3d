#include "haptics/session_log.hpp"

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <span>
#include <system_error>
#include <type_traits>
#include <utility>

#include "engine/cloud/attribute_bytes.hpp"
#include "engine/core/checksum.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/packed_state.hpp"

namespace palpate {

namespace {

using session_file::Before;
using session_file::Block;
using session_file::Header;
using session_file::Mark;

/// The layout of an older version, whose unsaved strokes are still read.
namespace version4 {

constexpr std::uint32_t kVersion = 4;

struct Header {
  std::array<char, 8> magic{};
  std::uint32_t version = 0, textBytes = 0;
  std::uint64_t checksum = 0;
};
struct Block {
  std::uint32_t magic = 0, number = 0, ticks = 0, states = 0, marks = 0, last = 0;
  std::uint64_t merged = 0;
  SessionEnd end;
  std::uint64_t checksum = 0;
};
struct Before {
  std::uint64_t ticks = 0, states = 0;
};
static_assert(sizeof(Header) == 24 && sizeof(Block) == 56 && sizeof(Before) == 16 && sizeof(PackedState) == 36);

}  // namespace version4

bool isRead(std::uint32_t version) { return session_file::kOldestRead <= version && version <= session_file::kVersion; }

// Nothing for a point that no back end can have.
std::optional<PointState> knownState(const session_file::State& state) {
  constexpr std::uint64_t kEnd = PackedState::kGone;
  if (state.number >= kEnd || state.parent >= kEnd || state.layer != 0 || state.gone > 1) return std::nullopt;
  return PointState{.position = state.position,
                    .gone = state.gone != 0,
                    .number = state.number,
                    .normal = state.normal,
                    .color = state.color,
                    .parent = state.parent};
}
std::optional<PointState> knownState(const PackedState& entry) { return stateOf(entry); }

/// Reads pieces of a file of known size; an incomplete piece appends nothing.
class Source {
 public:
  explicit Source(const std::filesystem::path& file) : in_(file, std::ios::binary) {
    std::error_code error;
    size_ = std::filesystem::file_size(file, error);
    const std::string why = in_ ? error.message() : std::generic_category().message(errno);
    if (!in_ || error) throw FileError(file, "cannot be opened: " + why);
  }

  std::uint64_t size() const { return size_; }
  std::uint64_t at() const { return at_; }
  std::uint64_t left() const { return size_ - at_; }
  void go(std::uint64_t to) {
    at_ = std::min(to, size_);
    in_.clear();
    in_.seekg(static_cast<std::streamoff>(at_));
  }

  template <class T>
  bool take(T& value) {
    return take(std::as_writable_bytes(std::span(&value, 1)));
  }
  /// Appends `count` values; allocates only for data that exist.
  template <class T>
  bool append(std::vector<T>& values, std::uint64_t count) {
    if (count > left() / sizeof(T)) return false;
    const std::size_t before = values.size();
    values.resize(before + count);
    return take(std::as_writable_bytes(std::span(values).subspan(before)));
  }
  bool take(std::span<std::byte> bytes) {
    if (bytes.size() > left()) return false;
    in_.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    at_ += bytes.size();
    return in_.good();
  }

  /// Goes to the next occurrence of `what` from `from` on; if there is none, returns false and is at the end.
  bool find(std::string_view what, std::uint64_t from) {
    constexpr std::size_t kPiece = 1 << 16;
    for (std::string piece; from + what.size() <= size_; from += piece.size() - what.size() + 1) {
      go(from);
      piece.resize(std::min<std::uint64_t>(kPiece, left()));
      if (!take(std::as_writable_bytes(std::span(piece)))) break;
      const std::boyer_moore_horspool_searcher searcher(what.begin(), what.end());
      const auto place = std::search(piece.begin(), piece.end(), searcher);
      if (place == piece.end()) continue;
      go(from + static_cast<std::uint64_t>(place - piece.begin()));
      return true;
    }
    go(size_);
    return false;
  }

 private:
  std::ifstream in_;
  std::uint64_t size_ = 0, at_ = 0;
};

template <class T>
std::string_view bytesOf(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// Reads a log front to back; after an unreadable part it continues with the next complete block.
class LogReader {
 public:
  /// `readsOlder`: also version 4.
  LogReader(const std::filesystem::path& file, bool readsOlder) : file_(file), source_(file), readsOlder_(readsOlder) {}

  SessionRecord read() {
    readHeader();
    record_.fileBytes = source_.size();
    record_.wholeBytes = source_.at();
    const Block marker;
    while (!record_.end && source_.left() > 0) {
      if (readBlock()) continue;
      std::uint64_t from = record_.wholeBytes;
      do {
        if (!source_.find(bytesOf(marker.magic), from + 1)) break;
        from = source_.at();
      } while (!readBlock());
    }
    if (!record_.end && record_.wholeBytes < record_.fileBytes)
      record_.gaps.push_back({.begin = record_.wholeBytes, .end = record_.fileBytes, .tick = record_.ticks.size()});
    return std::move(record_);
  }

 private:
  void readHeader();
  bool isWholeHeader(Header& header);
  template <class SomeHeader>
  bool isWhole(SomeHeader& header);
  bool readBlock();
  /// What a block contains.
  struct Content {
    std::vector<LoggedTick> ticks;
    std::vector<PointState> states;
    std::vector<Mark> marks;
    std::vector<AttributeChange> attributes;
    std::vector<LoggedCommand> commands;
  };
  bool isWholeBlock(Block& block, Content& content);
  template <class SomeBlock, class SomeBefore, class SomeState>
  bool isWholeBlock(SomeBlock& block, SomeBefore& before, Content& content);
  template <class T>
  bool take(std::vector<T>& values, std::uint64_t count, Checksum& sum);
  bool takeAttributes(Content& content, Checksum& sum);
  bool takeCommands(const Block& block, Content& content, Checksum& sum);
  void noteGap(std::uint64_t begin, const Block& block);

  std::filesystem::path file_;
  Source source_;
  bool readsOlder_;
  std::uint32_t version_ = session_file::kVersion;  // of the file
  SessionRecord record_;
  std::uint32_t next_ = 0;  // number of the next block
  Before before_, sofar_;   // counts before the current block, and counts of the complete ones
};

template <class SomeHeader>
bool LogReader::isWhole(SomeHeader& header) {
  if (!source_.take(header)) return false;
  record_.text.clear();
  if (header.textBytes <= source_.left()) record_.text.resize(header.textBytes);
  const std::uint64_t checksum = std::exchange(header.checksum, 0);
  Checksum sum;
  sum.add(std::as_bytes(std::span(&header, 1)));
  const bool whole = source_.take(std::as_writable_bytes(std::span(record_.text)));
  sum.add(std::as_bytes(std::span(record_.text)));
  return whole && record_.text.size() == header.textBytes && sum.value() == checksum;
}

bool LogReader::isWholeHeader(Header& header) {
  const std::uint64_t at = source_.at();
  version4::Header older;  // begins with the same members
  if (!source_.take(older) || older.magic != session_file::kMagic) return false;
  source_.go(at);
  version_ = older.version;
  if (readsOlder_ && version_ == version4::kVersion) return isWhole(older);
  return isRead(version_) && isWhole(header) && header.law == session_file::kForceLaw;
}

// If the first header is damaged, the second one is used.
void LogReader::readHeader() {
  const std::string_view magic(session_file::kMagic.data(), session_file::kMagic.size());
  Header header;
  version4::Header first;  // its members are those of all versions
  std::uint32_t law = session_file::kForceLaw;
  const bool isThere = source_.take(first) && first.magic == session_file::kMagic;
  source_.go(offsetof(Header, law));
  if (isRead(first.version)) source_.take(law);
  source_.go(0);
  bool whole = isWholeHeader(header);
  if (whole) source_.go(2 * source_.at());
  for (std::uint64_t from = 1; !whole && source_.find(magic, from); from = source_.at() + 1) {
    const std::uint64_t place = source_.at();
    whole = isWholeHeader(header);
    if (!whole) source_.go(place);
  }
  if (whole) return;
  if (!isThere) throw FileError(file_, "is not a session log; record a session to get one");
  if (!isRead(first.version))
    throw FileError(file_,
                    fmt::format("is a session log of version {}{}, and this palpate reads versions {} to {}; use {}",
                                first.version, first.version > session_file::kVersion ? ", of a newer palpate" : "",
                                session_file::kOldestRead, session_file::kVersion,
                                first.version > session_file::kVersion ? "a newer one" : "the palpate that wrote it"));
  if (law != session_file::kForceLaw)
    throw FileError(file_,
                    fmt::format("is a session log with the force law {}, and this palpate has the law {}, under which "
                                "its forces would not be found again; use the palpate that wrote it",
                                law, session_file::kForceLaw));
  throw FileError::atByte(file_, sizeof(Header), "the header of the session log is damaged; nothing can be read");
}

template <class T>
bool LogReader::take(std::vector<T>& values, std::uint64_t count, Checksum& sum) {
  if (!source_.append(values, count)) return false;
  sum.add(std::as_bytes(std::span(values)));
  return true;
}

bool LogReader::takeAttributes(Content& content, Checksum& sum) {
  for (const Mark& mark : content.marks) {
    if (mark.kind > static_cast<std::uint64_t>(EditMark::Kind::redone)) return false;
    if (!EditMark{.kind = static_cast<EditMark::Kind>(mark.kind)}.hasAttribute()) continue;
    std::vector<std::byte> bytes;
    if (!take(bytes, (std::uint64_t{mark.bytes} + 7) / 8 * 8, sum)) return false;
    bytes.resize(mark.bytes);
    if (!readChange(bytes, content.attributes.emplace_back())) return false;
  }
  return true;
}

bool LogReader::takeCommands(const Block& block, Content& content, Checksum& sum) {
  std::vector<char> bytes;
  if (!take(bytes, block.commandBytes, sum)) return false;
  std::span<const char> left = bytes;
  while (!left.empty()) {
    session_file::Command command;
    if (left.size() < sizeof command) return false;
    std::memcpy(&command, left.data(), sizeof command);
    left = left.subspan(sizeof command);
    const std::uint64_t padded = (std::uint64_t{command.bytes} + 7) / 8 * 8;
    if (padded > left.size() || command.kind > static_cast<std::uint32_t>(LoggedCommand::Kind::cancel)) return false;
    content.commands.push_back({.tick = command.tick,
                                .kind = static_cast<LoggedCommand::Kind>(command.kind),
                                .content = std::string(left.data(), command.bytes)});
    left = left.subspan(padded);
  }
  return content.commands.size() == block.commands;
}

template <class SomeBlock, class SomeBefore, class SomeState>
bool LogReader::isWholeBlock(SomeBlock& block, SomeBefore& before, Content& content) {
  if (!source_.take(block) || block.magic != Block().magic || block.number < next_ || !source_.take(before))
    return false;
  const std::uint64_t checksum = std::exchange(block.checksum, 0);
  Checksum sum;
  sum.addValue(block);
  sum.addValue(before);
  std::vector<SomeState> states;
  if (!take(content.ticks, block.ticks, sum) || !take(states, block.states, sum) ||
      !take(content.marks, block.marks, sum) || !takeAttributes(content, sum))
    return false;
  if constexpr (std::is_same_v<SomeBlock, Block>)
    if (!takeCommands(block, content, sum)) return false;
  content.states.reserve(states.size());
  for (const SomeState& state : states)
    if (const auto known = knownState(state)) content.states.push_back(*known);
  return sum.value() == checksum && content.states.size() == block.states;
}

bool LogReader::isWholeBlock(Block& block, Content& content) {
  before_ = sofar_;
  if (version_ == version4::kVersion) {
    version4::Block older;
    version4::Before before;
    if (!isWholeBlock<version4::Block, version4::Before, PackedState>(older, before, content)) return false;
    block = {.number = older.number,
             .ticks = older.ticks,
             .states = older.states,
             .marks = older.marks,
             .last = older.last,
             .merged = older.merged,
             .end = older.end};
    before_ = {.ticks = before.ticks, .states = before.states};
  } else if (!isWholeBlock<Block, Before, session_file::State>(block, before_, content)) {
    return false;
  }
  if (before_.ticks < sofar_.ticks || before_.states < sofar_.states || before_.commands < sofar_.commands)
    return false;
  std::uint64_t last = 0;
  for (const Mark& mark : content.marks) {
    if (mark.at < last || mark.at > block.states) return false;
    last = mark.at;
  }
  return true;
}

void LogReader::noteGap(std::uint64_t begin, const Block& block) {
  if (begin == record_.wholeBytes && block.number == next_) return;
  record_.gaps.push_back({.begin = record_.wholeBytes,
                          .end = begin,
                          .tick = record_.ticks.size(),
                          .ticks = before_.ticks - sofar_.ticks,
                          .states = before_.states - sofar_.states,
                          .commands = before_.commands - sofar_.commands});
}

/// False, with the record unchanged, for a block that is torn or damaged.
bool LogReader::readBlock() {
  const std::uint64_t begin = source_.at();
  Block block;
  Content content;
  if (!isWholeBlock(block, content)) return false;
  noteGap(begin, block);
  next_ = block.number + 1;
  sofar_ = {before_.ticks + block.ticks, before_.states + block.states,
            before_.commands + block.commands + content.attributes.size()};
  record_.wholeBytes = source_.at();
  for (const Mark& mark : content.marks)
    record_.edits.marks.push_back({record_.edits.points.size() + mark.at, static_cast<EditMark::Kind>(mark.kind)});
  std::ranges::copy(content.ticks, std::back_inserter(record_.ticks));
  std::ranges::copy(content.states, std::back_inserter(record_.edits.points));
  std::ranges::move(content.attributes, std::back_inserter(record_.edits.attributes));
  std::ranges::move(content.commands, std::back_inserter(record_.commands));
  record_.mergedEdits += block.merged;
  if (record_.mergedEdits == 0 && record_.gaps.empty()) record_.countedEdits = record_.edits.points.size();
  if (block.last) record_.end = block.end;
  return true;
}

std::string lastBefore(const SessionRecord& record, std::size_t tick) {
  return tick > 0 ? fmt::format("{:.3f} s", record.ticks[tick - 1].time_s) : "its beginning";
}

std::string sentenceOf(const SessionRecord& record, const LogGap& gap) {
  const std::string from = lastBefore(record, gap.tick);
  if (gap.end == record.fileBytes && gap.begin == record.wholeBytes)
    return fmt::format("it is truncated at byte {} of {}; everything after {} is missing", gap.begin, gap.end, from);
  const std::string when = gap.tick < record.ticks.size()
                               ? fmt::format("between {} and {:.3f} s", from, record.ticks[gap.tick].time_s)
                               : "after " + from;
  const std::string commands = gap.commands.value_or(0) > 0 ? ", " + counted(*gap.commands, "command") : "";
  const std::string what = gap.ticks ? fmt::format("{}{} and {} of points, {},", counted(*gap.ticks, "tick"), commands,
                                                   counted(*gap.states, "edit"), when)
                                     : fmt::format("ticks and edits {}", when);
  if (gap.begin == gap.end) return fmt::format("at byte {} {} are missing: they were not written", gap.begin, what);
  return fmt::format("bytes {} to {} of {} are damaged: {} are missing", gap.begin, gap.end, record.fileBytes, what);
}

}  // namespace

bool isSessionLog(const std::filesystem::path& file) {
  std::array<char, session_file::kMagic.size()> begin{};
  std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
  return begin == session_file::kMagic;
}

SessionRecord readSessionLog(const std::filesystem::path& file) { return LogReader(file, false).read(); }

SessionRecord readLoggedEdits(const std::filesystem::path& file) { return LogReader(file, true).read(); }

std::vector<std::string> whatIsMissing(const SessionRecord& record) {
  std::vector<std::string> sentences;
  for (const LogGap& gap : record.gaps) sentences.push_back(sentenceOf(record, gap));
  if (!record.end && record.wholeBytes == record.fileBytes)
    sentences.push_back(fmt::format("it ends at byte {} without the session's end; everything after {} is missing",
                                    record.fileBytes, lastBefore(record, record.ticks.size())));
  return sentences;
}

}  // namespace palpate
