#include "engine/io/las_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/cloud/normals.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/io/ends_after.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/las_unit.hpp"
#include "engine/io/las_unpacked.hpp"
#include "engine/io/laz_reader.hpp"
#include "engine/io/saving.hpp"

namespace palpate {

namespace {

constexpr std::size_t kBlock = 4096;                        // points that a thread processes at a time
constexpr std::size_t kSlab = std::size_t{1} << 30;         // bytes of points between synchronisations of threads
constexpr std::size_t kLessSlab = std::size_t{1} << 27;     // likewise, if they are in memory at once
constexpr std::size_t kMaxReserved = std::size_t{1} << 27;  // points: a sparse file may be long without containing data

std::string textOfField(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end > begin) lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

std::optional<LazLayout> packingOf(const std::filesystem::path& file, const LasHead& head) {
  if (!head.header.packed) return std::nullopt;
  for (const LasRecord& record : lasRecords(file, head.header, head.bytes))
    if (record.is(kLazUser, kLazRecord)) return readLazLayout(file, head.header, record);
  throw FileError::atByte(file, 104, "the points are packed (LAZ), but the record of LASzip is missing");
}

LasHead readHead(ChunkedFile& file) {
  LasHead head;
  head.header = readLasHeader(file.path(), file.peek(kLasHeader14));
  const auto bytes = file.peek(head.header.pointsAt);
  if (bytes.size() < head.header.pointsAt)
    throw FileError::atByte(file.path(), bytes.size(),
                            fmt::format("the file ends before its points, which are said to "
                                        "begin at byte {}",
                                        head.header.pointsAt));
  head.bytes.assign(bytes.begin(), bytes.begin() + head.header.pointsAt);
  file.consume(head.header.pointsAt);
  head.format = lasPointFormat(head.header.format);
  std::uint64_t describedAt = 0;
  for (const LasRecord& record : lasRecords(file.path(), head.header, head.bytes)) {
    if (record.is(kLasSpec, kLasExtraBytes)) {
      head.descriptors.assign(record.data.begin(), record.data.end());
      describedAt = record.at;
    }
    if (record.is(kLasOurs, kLasComments)) head.comments = linesOf(textOfField(record.data));
  }
  auto extra = lasExtraFields(head.descriptors, head.format, head.header.pointBytes);
  if (!extra)
    throw FileError::atByte(file.path(), describedAt,
                            fmt::format("describes more extra bytes than the {} that points have",
                                        head.header.pointBytes - head.format.bytes));
  head.extra = std::move(*extra);
  head.packing = packingOf(file.path(), head);
  if (textOfField(std::span(head.bytes).subspan(58, 32)).starts_with(kLasOurs)) {
    PointCloud ours;
    markAsOurs(ours);
    head.comments.insert(head.comments.begin(), ours.storedAs.comments.front());
  }
  return head;
}

}  // namespace

LasReader::LasReader(const std::filesystem::path& path) : file_(path), head_(readHead(file_)) { checkCount(); }

void LasReader::checkCount() const {
  const auto there = file_.remaining();
  const LasHeader& header = head_.header;
  if (there && !header.packed && header.points > *there / header.pointBytes)
    throw endsAfter(file_.path(), file_.offset() + *there, *there / header.pointBytes, header.points, "points");
}

PointCloud LasReader::read(Log* log, std::vector<std::string>& lost, const CloudReadOptions& options) {
  const unsigned threads = options.threads;
  if (log) file_.onProgress([&](double share) { log->progress(file_.path().filename().string(), share); });
  LasColumns columns(head_.header, head_.format, head_.extra, threads);
  const Stopwatch reading;
  const Tail tail = head_.packing ? readPacked(columns, log, lost) : readPlain(columns, threads);
  std::vector<LasRecord> records = lasRecords(file_.path(), head_.header, head_.bytes);
  const std::vector<LasRecord> behind = lasLongRecords(file_.path(), head_.header, tail.bytes, tail.at);
  records.insert(records.end(), behind.begin(), behind.end());
  const LengthUnit unit = lasUnit(records);
  const std::shared_ptr<LasBaggage> baggage = packBaggage(tail);
  baggage->unit = unit;
  std::vector<std::size_t> withoutNormal;
  if (options.stages) options.stages->points_s = reading.elapsed_s(), options.stages->waited_s = columns.waited_s();
  const Stopwatch finishing;
  PointCloud cloud = columns.finish(baggage->colorStep, withoutNormal);
  if (!withoutNormal.empty()) fillMissingNormals(cloud, withoutNormal, file_.path().filename().string(), log);
  StoredAs& stored = cloud.storedAs;
  stored.position = ScalarType::f64;
  stored.comments = head_.comments;
  if (!upSaidIn(stored.comments)) stored.comments.emplace_back(fmt::format("comment up: {}", nameOf(UpAxis::z)));
  sayUnit(stored.comments, unit);
  stored.baggage = baggage;
  if (options.stages) options.stages->finish_s = finishing.elapsed_s();
  return cloud;
}

LasReader::Tail LasReader::readPlain(LasColumns& columns, unsigned threads) {
  const LasHeader& header = head_.header;
  const bool known = file_.remaining().has_value();
  const std::size_t rowBytes = header.pointBytes;
  const std::size_t slab = std::max<std::size_t>(1, (known ? kSlab : kLessSlab) / rowBytes);
  columns.reserve(static_cast<std::size_t>(std::min<std::uint64_t>(known ? header.points : 0, kMaxReserved)));
  for (std::size_t done = 0; done < header.points;) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(slab, header.points - done));
    if (known) {
      columns.makeRoom(done + count);
      const auto take = [&](std::span<const std::byte> rows, std::uint64_t before) {
        columns.take(rows.data(), done + before / rowBytes, rows.size() / rowBytes);
      };
      file_.readBlocks(count * rowBytes, kBlock * rowBytes, threads, take);
    } else {
      const auto rows = file_.peek(count * rowBytes);
      if (rows.size() < count * rowBytes)
        throw FileError::atByte(
            file_.path(), file_.offset() + rows.size(),
            fmt::format("the file ends inside point {} of {}", done + rows.size() / rowBytes + 1, header.points));
      columns.makeRoom(done + count);
      parallelBlocks(count, kBlock, threads, [&](std::size_t begin, std::size_t end) {
        columns.take(rows.data() + begin * rowBytes, done + begin, end - begin);
      });
      file_.consume(count * rowBytes);
    }
    done += count;
  }
  Tail tail{.at = file_.offset()};
  for (auto bytes = file_.peek(1); !bytes.empty(); bytes = file_.peek(1)) {
    tail.bytes.insert(tail.bytes.end(), bytes.begin(), bytes.end());
    file_.consume(bytes.size());
  }
  return tail;
}

LasReader::Tail LasReader::readPacked(LasColumns& columns, Log* log, std::vector<std::string>& lost) {
  const LasHeader& header = head_.header;
  const auto body = file_.peek(std::numeric_limits<std::size_t>::max() / 2);  // all bytes
  LazChunks found;
  if (isCopc(head_.bytes)) {
    const LasRecord info = lasRecords(file_.path(), header, head_.bytes).front();
    CopcNodes nodes = readCopcNodes(file_.path(), header, info, body);
    lost.push_back(fmt::format("the octree of COPC: {} on {} levels", counted(nodes.nodes, "node"), nodes.deepest + 1));
    found = std::move(nodes.found);
  } else {
    found = readLazChunks(file_.path(), header, *head_.packing, body);
  }
  readLazPoints(file_.path(), *head_.packing, found.chunks, body, header.pointsAt, columns, log);
  const std::uint64_t end = std::clamp<std::uint64_t>(found.end, header.pointsAt, header.pointsAt + body.size());
  const auto tail = body.subspan(end - header.pointsAt);
  return {.bytes = {tail.begin(), tail.end()}, .at = end};
}

/// Data kept from LAS to LAS: the file without its points, as if these were not compressed.
std::shared_ptr<LasBaggage> LasReader::packBaggage(const Tail& tail) {
  const LasHeader& header = head_.header;
  const bool copc = isCopc(head_.bytes);
  auto baggage = std::make_shared<LasBaggage>();
  std::string names;
  std::size_t count = 0;
  const auto name = [&](const LasRecord& record) {
    if (record.is(kLasSpec, kLasExtraBytes) || record.is(kLasOurs, kLasComments)) return;
    names += fmt::format("{}{} {}", count++ == 0 ? "" : ", ", inQuotes(record.user), record.id);
  };
  LasUnpacked unpacked(header, head_.bytes, tail.at);
  for (const LasRecord& record : lasRecords(file_.path(), header, head_.bytes)) {
    if (record.is(kLazUser, kLazRecord) || (copc && record.user == kCopcUser)) continue;
    name(record);
    unpacked.add(record);
  }
  for (const LasRecord& record : lasLongRecords(file_.path(), header, tail.bytes, tail.at)) {
    if (copc && record.user == kCopcUser) continue;
    name(record);
    unpacked.addLong(record);
  }
  if (count > 0) baggage->sentence = fmt::format("{} of LAS: {}", counted(count, "record"), names);
  baggage->format = "LAS";
  baggage->head = header.packed ? unpacked.head() : std::move(head_.bytes);
  baggage->tail = copc ? unpacked.tail() : tail.bytes;
  baggage->descriptors = std::move(head_.descriptors);
  return baggage;
}

}  // namespace palpate
