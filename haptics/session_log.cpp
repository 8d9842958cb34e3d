#include "haptics/session_log.hpp"

#include <algorithm>
#include <fstream>
#include <functional>
#include <span>
#include <utility>

#include "engine/core/checksum.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

using session_file::Before;
using session_file::Block;
using session_file::Header;
using session_file::Mark;

/// Reads pieces of a file of known size; an incomplete piece appends nothing.
class Source {
 public:
  explicit Source(const std::filesystem::path& file) : in_(file, std::ios::binary) {
    std::error_code error;
    size_ = std::filesystem::file_size(file, error);
    if (!in_ || error) throw FileError(file, "cannot be opened; check that it exists and may be read");
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

template <class T>
void addFrom(Checksum& sum, const std::vector<T>& values, std::size_t first) {
  sum.add(std::as_bytes(std::span(values).subspan(first)));
}

/// Reads a log front to back; after an unreadable part it continues with the next complete block.
class LogReader {
 public:
  explicit LogReader(const std::filesystem::path& file) : file_(file), source_(file) {}

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
  bool readBlock();
  bool isWholeBlock(Block& block, std::vector<Mark>& marks);
  void noteGap(std::uint64_t begin, const Block& block);

  std::filesystem::path file_;
  Source source_;
  SessionRecord record_;
  std::uint32_t next_ = 0;  // number of the next block
  Before before_, sofar_;   // counts before the current block, and counts of the complete ones
};

bool LogReader::isWholeHeader(Header& header) {
  if (!source_.take(header) || header.magic != session_file::kMagic) return false;
  if (header.version != session_file::kVersion) return false;
  record_.text.clear();
  if (header.textBytes <= source_.left()) record_.text.resize(header.textBytes);
  const std::uint64_t checksum = std::exchange(header.checksum, 0);
  Checksum sum;
  sum.add(std::as_bytes(std::span(&header, 1)));
  const bool whole = source_.take(std::as_writable_bytes(std::span(record_.text)));
  sum.add(std::as_bytes(std::span(record_.text)));
  return whole && record_.text.size() == header.textBytes && sum.value() == checksum;
}

// If the first header is damaged, the second one is used.
void LogReader::readHeader() {
  const std::string_view magic(session_file::kMagic.data(), session_file::kMagic.size());
  Header first, header;
  const bool isThere = source_.take(first) && first.magic == session_file::kMagic;
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
  if (first.version == session_file::kOtherForceLaw)
    throw FileError(file_,
                    fmt::format("is a session log of version {}; the force law has changed since, so that its forces "
                                "would not be found again; use the palpate that wrote it",
                                first.version));
  if (first.version != session_file::kVersion)
    throw FileError(
        file_, fmt::format("is a session log of version {}, and this palpate reads version {}; use the palpate that "
                           "wrote it",
                           first.version, session_file::kVersion));
  throw FileError::atByte(file_, sizeof(Header), "the header of the session log is damaged; nothing can be read");
}

bool LogReader::isWholeBlock(Block& block, std::vector<Mark>& marks) {
  const std::size_t ticks = record_.ticks.size(), states = record_.edits.points.size();
  if (!source_.take(block) || block.magic != Block().magic || block.number < next_) return false;
  before_ = sofar_;
  if (!source_.take(before_)) return false;
  if (before_.ticks < sofar_.ticks || before_.states < sofar_.states) return false;
  if (!source_.append(record_.ticks, block.ticks) || !source_.append(record_.edits.points, block.states) ||
      !source_.append(marks, block.marks))
    return false;
  const std::uint64_t checksum = std::exchange(block.checksum, 0);
  Checksum sum;
  sum.addValue(block);
  sum.addValue(before_);
  addFrom(sum, record_.ticks, ticks);
  addFrom(sum, record_.edits.points, states);
  addFrom(sum, marks, 0);
  if (sum.value() != checksum) return false;
  std::uint64_t last = 0;
  for (const Mark& mark : marks) {
    if (mark.at < last || mark.at > block.states || mark.kind > static_cast<std::uint64_t>(EditMark::Kind::change))
      return false;
    last = mark.at;
  }
  return true;
}

void LogReader::noteGap(std::uint64_t begin, const Block& block) {
  if (begin == record_.wholeBytes && block.number == next_) return;
  record_.gaps.push_back({.begin = record_.wholeBytes,
                          .end = begin,
                          .tick = record_.ticks.size() - block.ticks,
                          .ticks = before_.ticks - sofar_.ticks,
                          .states = before_.states - sofar_.states});
}

/// False, with the record unchanged, for a block that is torn or damaged.
bool LogReader::readBlock() {
  const std::uint64_t begin = source_.at();
  const std::size_t ticks = record_.ticks.size(), states = record_.edits.points.size();
  Block block;
  std::vector<Mark> marks;
  if (!isWholeBlock(block, marks)) {
    record_.ticks.resize(ticks);
    record_.edits.points.resize(states);
    return false;
  }
  noteGap(begin, block);
  next_ = block.number + 1;
  sofar_ = {before_.ticks + block.ticks, before_.states + block.states};
  record_.wholeBytes = source_.at();
  for (const Mark& mark : marks)
    record_.edits.marks.push_back({states + mark.at, static_cast<EditMark::Kind>(mark.kind)});
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
  const std::string what = gap.ticks ? fmt::format("{} and {} of points, {},", counted(*gap.ticks, "tick"),
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

SessionRecord readSessionLog(const std::filesystem::path& file) { return LogReader(file).read(); }

std::vector<std::string> whatIsMissing(const SessionRecord& record) {
  std::vector<std::string> sentences;
  for (const LogGap& gap : record.gaps) sentences.push_back(sentenceOf(record, gap));
  if (!record.end && record.wholeBytes == record.fileBytes)
    sentences.push_back(fmt::format("it ends at byte {} without the session's end; everything after {} is missing",
                                    record.fileBytes, lastBefore(record, record.ticks.size())));
  return sentences;
}

}  // namespace palpate
