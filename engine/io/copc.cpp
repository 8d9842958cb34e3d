#include "engine/io/copc.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr std::size_t kInfoBytes = 160, kRootAt = 40, kEntryBytes = 32;
constexpr std::int32_t kIsPage = -1;  // instead of a number of points
constexpr std::int32_t kMaxOctreeDepth = 30;

using Key = std::array<std::int32_t, 4>;  // level, x, y, z

struct Entry {
  Key key;
  std::uint64_t offset;
  std::int32_t bytes, points;
};
static_assert(sizeof(Entry) == kEntryBytes);

/// Pages to be read, and the nodes read so far.
class Hierarchy {
 public:
  Hierarchy(const std::filesystem::path& file, std::uint64_t bodyAt, std::span<const std::byte> body)
      : file_(file), bodyAt_(bodyAt), body_(body) {}

  /// `saidAt`: the byte that contains the page's position.
  void addPage(std::uint64_t at, std::uint64_t bytes, std::uint64_t saidAt) {
    if (bytes % kEntryBytes != 0 || bytes == 0 || !isInside(at, bytes))
      throw refuse(saidAt, fmt::format("a page of {} bytes of the hierarchy at byte {}, outside the file, which ends "
                                       "at byte {}; it is truncated, or its header is wrong",
                                       bytes, at, bodyAt_ + body_.size()));
    if (!pages_.insert(at).second)
      throw refuse(saidAt, fmt::format("the page of the hierarchy at byte {} is referenced twice", at));
    waiting_.emplace_back(at, bytes);
  }
  void readAll() {
    while (!waiting_.empty()) {
      const auto [at, bytes] = waiting_.back();
      waiting_.pop_back();
      for (std::uint64_t k = 0; k < bytes; k += kEntryBytes) {
        Entry entry;
        std::memcpy(&entry, body_.data() + (at + k - bodyAt_), sizeof entry);
        take(entry, at + k);
      }
    }
  }
  const std::map<Key, LazChunk>& nodes() const { return nodes_; }

 private:
  FileError refuse(std::uint64_t at, const std::string& why) const { return FileError::atByte(file_, at, why); }
  bool isInside(std::uint64_t at, std::uint64_t bytes) const {
    return at >= bodyAt_ && at - bodyAt_ <= body_.size() && bytes <= body_.size() - (at - bodyAt_);
  }

  void take(const Entry& entry, std::uint64_t at) {
    const auto [level, x, y, z] = entry.key;
    const bool hasPlace = level >= 0 && level <= kMaxOctreeDepth && std::min({x, y, z}) >= 0 &&
                          std::max({x, y, z}) < std::int32_t{1} << std::min(level, kMaxOctreeDepth);
    if (!hasPlace) throw refuse(at, fmt::format("a node {}-{}-{}-{}, which is not in an octree", level, x, y, z));
    if (entry.points == kIsPage)
      return addPage(entry.offset, entry.bytes < 0 ? 0 : static_cast<std::uint64_t>(entry.bytes), at + 16);
    if (entry.points < 0 || entry.bytes < 0 || (entry.points > 0) != (entry.bytes > 0))
      throw refuse(at + 24, fmt::format("a node of {} points in {} bytes", entry.points, entry.bytes));
    const auto bytes = static_cast<std::uint64_t>(entry.bytes);
    if (bytes > 0 && !isInside(entry.offset, bytes))
      throw refuse(at + 16, fmt::format("a node at byte {}, outside the points", entry.offset));
    const LazChunk chunk{entry.offset, bytes, static_cast<std::uint64_t>(entry.points)};
    if (!nodes_.emplace(entry.key, chunk).second)
      throw refuse(at, fmt::format("the node {}-{}-{}-{} is a duplicate", level, x, y, z));
  }

  const std::filesystem::path& file_;
  std::uint64_t bodyAt_;
  std::span<const std::byte> body_;
  std::set<std::uint64_t> pages_;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> waiting_;
  std::map<Key, LazChunk> nodes_;
};

}  // namespace

bool isCopc(std::span<const std::byte> begin) {
  if (begin.size() < kCopcHead) return false;
  const std::string_view user(reinterpret_cast<const char*>(begin.data()) + kLasHeader14 + 2, kCopcUser.size() + 1);
  return user == std::string_view("copc\0", 5) &&
         loadScalar<std::uint16_t>(begin.data() + kLasHeader14 + 18) == kCopcInfo;
}

CopcNodes readCopcNodes(const std::filesystem::path& file, const LasHeader& header, const LasRecord& info,
                        std::span<const std::byte> body) {
  const std::uint64_t infoAt = info.at + info.head.size();
  if (info.data.size() < kInfoBytes)
    throw FileError::atByte(file, infoAt,
                            fmt::format("the record of COPC has {} bytes; expected {}", info.data.size(), kInfoBytes));
  const auto* said = info.data.data() + kRootAt;
  Hierarchy hierarchy(file, header.pointsAt, body);
  hierarchy.addPage(loadScalar<std::uint64_t>(said), loadScalar<std::uint64_t>(said + 8), infoAt + kRootAt);
  hierarchy.readAll();
  CopcNodes result{.nodes = hierarchy.nodes().size()};
  std::uint64_t points = 0;
  for (const auto& [key, chunk] : hierarchy.nodes()) {
    result.deepest = std::max(result.deepest, key[0]);
    points += chunk.points;
    if (chunk.points > 0) result.found.chunks.push_back(chunk);
  }
  std::ranges::sort(result.found.chunks, {}, &LazChunk::at);
  for (std::size_t k = 1; k < result.found.chunks.size(); ++k) {
    const LazChunk &one = result.found.chunks[k - 1], &next = result.found.chunks[k];
    if (one.at + one.bytes > next.at)
      throw FileError::atByte(file, next.at,
                              fmt::format("two nodes of the hierarchy overlap; one begins at "
                                          "byte {} and has {} bytes",
                                          one.at, one.bytes));
  }
  if (points != header.points)
    throw FileError::atByte(
        file, infoAt + kRootAt,
        fmt::format("the nodes of the hierarchy have {} points, and the header promises {}", points, header.points));
  result.found.end = header.longRecordsAt ? header.longRecordsAt : header.pointsAt + body.size();
  return result;
}

}  // namespace palpate
