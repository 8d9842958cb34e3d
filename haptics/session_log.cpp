#include "haptics/session_log.hpp"

#include <fstream>
#include <span>
#include <utility>

#include "engine/core/checksum.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

using session_file::Block;
using session_file::Header;
using session_file::Mark;

/// Reads pieces of a file of known size; a piece that is not whole leaves nothing behind.
class Source {
 public:
  explicit Source(const std::filesystem::path& file) : in_(file, std::ios::binary) {
    std::error_code error;
    size_ = std::filesystem::file_size(file, error);
    if (!in_ || error) throw FileError(file, "cannot be opened; does it exist, and may you read it?");
  }

  std::uint64_t size() const { return size_; }
  std::uint64_t left() const { return size_ - at_; }

  template <class T>
  bool take(T& value) {
    return take(std::as_writable_bytes(std::span(&value, 1)));
  }
  /// Appends `count` values: memory is taken for what is really there.
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

 private:
  std::ifstream in_;
  std::uint64_t size_ = 0, at_ = 0;
};

std::string readHeader(Source& source, const std::filesystem::path& file) {
  Header header;
  if (!source.take(header) || header.magic != session_file::kMagic)
    throw FileError(file, "is no session log; palpate touch --log writes one");
  if (header.version != session_file::kVersion)
    throw FileError(file, fmt::format("is a session log of version {}, and this palpate reads version {}; take the "
                                      "palpate that wrote it",
                                      header.version, session_file::kVersion));
  std::string text;
  if (header.textBytes <= source.left()) text.resize(header.textBytes);
  Checksum sum;
  const bool whole = source.take(std::as_writable_bytes(std::span(text)));
  sum.add(std::as_bytes(std::span(text)));
  if (!whole || text.size() != header.textBytes || sum.value() != header.checksum)
    throw FileError::atByte(file, sizeof(Header), "the header of the session log is damaged; nothing can be read");
  return text;
}

template <class T>
void addFrom(Checksum& sum, const std::vector<T>& values, std::size_t first) {
  sum.add(std::as_bytes(std::span(values).subspan(first)));
}

/// False, and the record as it was, for a block that is torn or damaged.
bool readBlock(Source& source, std::uint32_t number, SessionRecord& record) {
  Block block;
  std::vector<Mark> marks;
  const std::size_t ticks = record.ticks.size(), states = record.edits.points.size();
  const auto isWhole = [&] {
    if (!source.take(block) || block.magic != Block().magic || block.number != number) return false;
    if (!source.append(record.ticks, block.ticks) || !source.append(record.edits.points, block.states) ||
        !source.append(marks, block.marks))
      return false;
    const std::uint64_t checksum = std::exchange(block.checksum, 0);
    Checksum sum;
    sum.addValue(block);
    addFrom(sum, record.ticks, ticks);
    addFrom(sum, record.edits.points, states);
    addFrom(sum, marks, 0);
    if (sum.value() != checksum) return false;
    std::uint64_t last = 0;
    for (const Mark& mark : marks) {
      if (mark.at < last || mark.at > block.states || mark.kind > static_cast<std::uint64_t>(EditMark::Kind::change))
        return false;
      last = mark.at;
    }
    return true;
  };
  if (!isWhole()) {
    record.ticks.resize(ticks);
    record.edits.points.resize(states);
    return false;
  }
  for (const Mark& mark : marks)
    record.edits.marks.push_back({states + mark.at, static_cast<EditMark::Kind>(mark.kind)});
  record.mergedEdits += block.merged;
  if (record.mergedEdits == 0) record.countedEdits = record.edits.points.size();
  if (block.last) record.end = block.end;
  return true;
}

}  // namespace

bool isSessionLog(const std::filesystem::path& file) {
  std::array<char, session_file::kMagic.size()> begin{};
  std::ifstream(file, std::ios::binary).read(begin.data(), begin.size());
  return begin == session_file::kMagic;
}

SessionRecord readSessionLog(const std::filesystem::path& file) {
  Source source(file);
  SessionRecord record{.text = readHeader(source, file)};
  record.fileBytes = source.size();
  record.wholeBytes = source.size() - source.left();
  for (std::uint32_t number = 0; source.left() > 0 && !record.end && readBlock(source, number, record); ++number)
    record.wholeBytes = source.size() - source.left();
  return record;
}

}  // namespace palpate
