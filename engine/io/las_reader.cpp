#include "engine/io/las_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/io/append_bytes.hpp"
#include "engine/io/ends_after.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/laz_reader.hpp"
#include "engine/io/saving.hpp"

namespace palpate {

namespace {

// The unit of length of a LAS file according to its coordinate system, given as GeoTIFF keys (OGC 19-008) or as text
// (OGC 18-010).

constexpr std::string_view kProjection = "LASF_Projection";
constexpr unsigned kTextRecord = 2112, kKeysRecord = 34735, kNamesRecord = 34737;

std::string_view wordsIn(const LasRecord& record) {
  return {reinterpret_cast<const char*>(record.data.data()), record.data.size()};
}

LengthUnit unitOfMetres(double metres) {
  constexpr double kInternational = 1e-5;  // the US survey foot is 2e-6 longer than the international foot
  for (const auto& [unit, size] : {std::pair{LengthUnit::m, 1.0},
                                   {LengthUnit::foot, 0.3048},
                                   {LengthUnit::cm, 0.01},
                                   {LengthUnit::mm, 0.001},
                                   {LengthUnit::inch, 0.0254}})
    if (std::abs(metres / size - 1) < kInternational) return unit;
  return LengthUnit::unknown;
}

/// The text in the brackets behind the first of the words that occurs.
std::optional<std::string_view> insideOf(std::string_view text, std::initializer_list<std::string_view> words) {
  for (const std::string_view word : words) {
    const std::size_t begin = text.find(word);
    if (begin == text.npos) continue;
    std::size_t depth = 0;
    for (std::size_t i = begin; i < text.size(); ++i) {
      if (text[i] == '[') ++depth;
      if (text[i] == ']' && --depth == 0) return text.substr(begin + word.size(), i - begin - word.size());
    }
  }
  return std::nullopt;
}

/// The last unit of length in a projected system is that of its axes; units of parameters come first.
LengthUnit unitInText(std::string_view text) {
  auto projected = insideOf(text, {"PROJCS[", "PROJCRS[", "PROJECTEDCRS["});
  if (!projected) {
    const bool degrees = insideOf(text, {"GEOGCS[", "GEOGCRS[", "GEOGRAPHICCRS["}).has_value();
    return degrees ? LengthUnit::unknown : LengthUnit::m;  // local or geocentric system
  }
  // Some programs nest the vertical system.
  projected = projected->substr(
      0, std::min({projected->find("VERTCS["), projected->find("VERT_CS["), projected->find("VERTCRS[")}));
  LengthUnit unit = LengthUnit::m;
  for (std::size_t at = 0; (at = projected->find("UNIT[", at)) != projected->npos; at += 5) {
    const std::string_view before = projected->substr(0, at);
    if (before.ends_with("ANGLE") || before.ends_with("SCALE")) continue;
    const std::size_t comma = projected->find(',', at);
    double metres = 0;
    const char* const end = projected->data() + projected->size();
    if (comma == projected->npos) break;
    std::from_chars(std::find_if(projected->data() + comma + 1, end, [](char c) { return c != ' '; }), end, metres);
    constexpr double kDegree = 0.0174532925;  // of a nested geographic system, in WKT 1
    if (std::abs(metres / kDegree - 1) > 1e-6) unit = unitOfMetres(metres);
  }
  return unit;
}

LengthUnit unitInKeys(std::span<const std::byte> data, std::string_view names) {
  constexpr unsigned kModel = 1024, kProjected = 3072, kLinearUnits = 3076;
  constexpr unsigned kGeographic = 2, kMetre = 9001, kFoot = 9002, kSurveyFoot = 9003;
  constexpr unsigned kFirstInFeet = 2222, kLastInFeet = 2289;  // NAD83 state planes in EPSG's list
  LengthUnit unit = LengthUnit::m;
  if (names.find("ftUS") != names.npos || names.find("foot") != names.npos || names.find("feet") != names.npos)
    unit = LengthUnit::foot;
  std::optional<LengthUnit> said;
  constexpr std::size_t kKey = 8;
  for (std::size_t at = kKey; at + kKey <= data.size(); at += kKey) {
    const unsigned key = loadScalar<std::uint16_t>(data.data() + at);
    const unsigned value = loadScalar<std::uint16_t>(data.data() + at + 6);
    if (key == kModel && value == kGeographic) return LengthUnit::unknown;
    if (key == kProjected && value >= kFirstInFeet && value <= kLastInFeet) unit = LengthUnit::foot;
    if (key == kLinearUnits)
      said = value == kMetre                          ? LengthUnit::m
             : value == kFoot || value == kSurveyFoot ? LengthUnit::foot
                                                      : LengthUnit::unknown;
  }
  return said.value_or(unit);
}

/// Metres if the system declares no other unit; unknown without a system, and if coordinates are in degrees or in an
/// unsupported unit.
LengthUnit lasUnit(std::span<const LasRecord> records) {
  std::string_view names;
  for (const LasRecord& record : records) {
    if (record.is(kProjection, kTextRecord)) return unitInText(wordsIn(record));
    if (record.is(kProjection, kNamesRecord)) names = wordsIn(record);
  }
  for (const LasRecord& record : records)
    if (record.is(kProjection, kKeysRecord)) return unitInKeys(record.data, names);
  return LengthUnit::unknown;
}

// The bytes before and behind the points of a LAZ file as they would be in an uncompressed LAS file.

/// Collects the records that are kept, in order.
class LasUnpacked {
 public:
  /// `head`: the bytes of the file before its points; `tailAt`: start of the bytes behind them. `head` must outlive the
  /// object.
  LasUnpacked(const LasHeader& header, std::span<const std::byte> head, std::uint64_t tailAt)
      : header_(header), head_(head), tailAt_(tailAt) {}

  void add(const LasRecord& record) {
    appendBytes(records_, record.head);
    appendBytes(records_, record.data);
    ++count_;
  }

  void addLong(const LasRecord& record) {
    appendBytes(tail_, record.head);
    appendBytes(tail_, record.data);
    ++longCount_;
  }

  /// Header, added records, and the bytes after the file's records.
  std::vector<std::byte> head() const {
    std::size_t recordsEnd = header_.size;
    for (const LasRecord& record : lasRecords({}, header_, head_))
      recordsEnd = record.at + record.head.size() + record.data.size();
    std::vector<std::byte> bytes;
    appendBytes(bytes, head_.first(header_.size));
    appendBytes(bytes, records_);
    appendBytes(bytes, head_.subspan(recordsEnd));
    const auto put = [&](std::size_t at, auto value) { std::memcpy(bytes.data() + at, &value, sizeof value); };
    put(96, static_cast<std::uint32_t>(bytes.size()));
    put(100, count_);
    put(104, static_cast<std::uint8_t>(header_.format));
    const std::uint64_t end = bytes.size() + header_.points * header_.pointBytes;
    if (header_.minor >= 3 && header_.waveformsAt >= tailAt_) put(227, header_.waveformsAt - tailAt_ + end);
    if (header_.minor < 4 || header_.longRecords == 0) return bytes;
    const bool all = longCount_ == header_.longRecords;
    put(235, longCount_ == 0 ? std::uint64_t{0} : end + (all ? header_.longRecordsAt - tailAt_ : 0));
    put(243, longCount_);
    return bytes;
  }

  /// The added long records only.
  const std::vector<std::byte>& tail() const { return tail_; }

 private:
  const LasHeader& header_;
  std::span<const std::byte> head_;
  std::uint64_t tailAt_;
  std::vector<std::byte> records_, tail_;
  std::uint32_t count_ = 0, longCount_ = 0;
};

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
