#include "engine/io/las_writer.hpp"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/atomic_file.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/io/append_bytes.hpp"
#include "engine/io/las_plan.hpp"
#include "engine/io/laz_chunk.hpp"
#include "engine/io/saving.hpp"

namespace palpate {

namespace {

// The bytes before the points of a LAS file that is written.

/// Writes values into the bytes of a header.
class HeaderBytes {
 public:
  explicit HeaderBytes(std::vector<std::byte>& bytes) : bytes_(bytes) {}
  template <class T>
  void put(std::size_t at, T value) {
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  void putText(std::size_t at, std::string_view text, std::size_t longest) {
    std::fill_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at), longest, std::byte{0});
    std::memcpy(bytes_.data() + at, text.data(), std::min(text.size(), longest));
  }

 private:
  std::vector<std::byte>& bytes_;
};

void appendRecord(std::vector<std::byte>& bytes, std::string_view user, unsigned id, std::string_view description,
                  std::span<const std::byte> data) {
  std::vector<std::byte> head(kLasRecordHead);
  HeaderBytes out(head);
  out.putText(2, user, 16);
  out.put(18, static_cast<std::uint16_t>(id));
  out.put(20, static_cast<std::uint16_t>(data.size()));
  out.putText(22, description, 32);
  appendBytes(bytes, head);
  appendBytes(bytes, data);
}

/// All comments except those that the header and its records express.
std::string commentsOf(const PointCloud& cloud, LengthUnit unit) {
  constexpr std::size_t kLongest = 65535;  // of a record
  std::vector<std::string> known{"comment up: z"};
  sayUnit(known, unit);
  std::string text;
  for (const std::string& comment : cloud.storedAs.comments)
    if (!isOurs({&comment, 1}) && std::ranges::find(known, comment) == known.end() &&
        text.size() + comment.size() < kLongest)
      text += comment + '\n';
  return text;
}

/// The records of the original file, and palpate's own.
std::uint32_t appendRecords(std::vector<std::byte>& bytes, const PointCloud& cloud, const LasPlan& plan) {
  std::uint32_t count = 0;
  const std::string comments = commentsOf(cloud, plan.baggage ? plan.baggage->unit : LasBaggage().unit);
  bool described = plan.descriptors.empty(), commented = comments.empty();
  const auto describe = [&] {
    if (!described) appendRecord(bytes, kLasSpec, kLasExtraBytes, "Extra Bytes Record", plan.descriptors), ++count;
    described = true;
  };
  const auto comment = [&] {
    if (!commented)
      appendRecord(bytes, kLasOurs, kLasComments, "comments", std::as_bytes(std::span(comments))), ++count;
    commented = true;
  };
  std::size_t end = plan.old.size;
  if (plan.baggage)
    for (const LasRecord& record : lasRecords({}, plan.old, plan.baggage->head)) {
      end = record.at + record.head.size() + record.data.size();
      const bool extra = record.is(kLasSpec, kLasExtraBytes);
      if (extra && std::ranges::equal(record.data, plan.descriptors)) {
        appendBytes(bytes, record.head), appendBytes(bytes, record.data), ++count;
        described = true;
      } else if (extra) {
        describe();
      } else if (record.is(kLasOurs, kLasComments)) {
        comment();
      } else {
        appendBytes(bytes, record.head), appendBytes(bytes, record.data), ++count;
      }
    }
  describe();
  comment();
  if (plan.baggage) appendBytes(bytes, std::span(plan.baggage->head).subspan(end));  // data after the records
  return count;
}

/// The header and the records, without the values that depend on the points.
std::vector<std::byte> lasHeadFor(const PointCloud& cloud, const LasPlan& plan) {
  const bool kept = plan.baggage && plan.old.minor == plan.minor;
  const std::size_t size = kept              ? plan.old.size
                           : plan.minor == 4 ? kLasHeader14
                           : plan.minor == 3 ? kLasHeader13
                                             : kLasShortHeader;
  std::vector<std::byte> bytes(size);
  if (plan.baggage) std::copy_n(plan.baggage->head.begin(), std::min(size, plan.old.size), bytes.begin());
  HeaderBytes out(bytes);
  if (!plan.baggage) {
    out.putText(0, "LASF", 4);
    out.put(6,
            static_cast<std::uint16_t>(plan.format >= 6 ? 16 : 0));  // a reference system, if any, is text
  }
  if (isOurs(cloud.storedAs.comments)) out.putText(58, kLasOurs, 32);
  out.put(24, std::uint8_t{1});
  out.put(25, static_cast<std::uint8_t>(plan.minor));
  out.put(94, static_cast<std::uint16_t>(size));
  out.put(104, static_cast<std::uint8_t>(plan.format));
  out.put(105, static_cast<std::uint16_t>(plan.pointBytes));
  for (int k = 0; k < 3; ++k) {
    out.put(131 + 8 * static_cast<std::size_t>(k), plan.grid.grid.step[k]);
    out.put(155 + 8 * static_cast<std::size_t>(k), plan.grid.grid.offset[k]);
  }
  const std::uint32_t records = appendRecords(bytes, cloud, plan);
  out.put(96, static_cast<std::uint32_t>(bytes.size()));
  out.put(100, records);
  return bytes;
}

namespace {

/// Sets the number of points, and the position of the data behind them.
void putCounts(std::vector<std::byte>& head, const LasPlan& plan, std::uint64_t points, std::uint64_t end) {
  HeaderBytes out(head);
  const bool early = plan.format < 6 || (plan.baggage && plan.oldEarlyCount > 0);
  const bool fits = points <= std::numeric_limits<std::uint32_t>::max();
  out.put(107, static_cast<std::uint32_t>(early && fits ? points : 0));
  const std::uint64_t oldEnd = plan.old.pointsAt + plan.old.points * plan.old.pointBytes;
  const auto moved = [&](std::uint64_t at) { return at >= oldEnd ? at - oldEnd + end : at; };
  if (plan.minor >= 3) out.put(227, plan.old.waveformsAt ? moved(plan.old.waveformsAt) : std::uint64_t{0});
  if (plan.minor < 4) return;
  if (plan.old.longRecords > 0) out.put(235, moved(plan.old.longRecordsAt));
  out.put(247, points);
}

/// Sets the bounding box, and the number of points of each return.
void putSums(std::vector<std::byte>& head, const LasPlan& plan, const PointCloud& cloud) {
  HeaderBytes out(head);
  DVec3 low(0), high(0);
  std::array<std::uint64_t, 16> returns{};
  const LasSource* number = plan.sourceOf("return_number");
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 place = plan.grid.grid.nearest(cloud.fileCoordinates(i));
    low = i == 0 ? place : glm::min(low, place);
    high = i == 0 ? place : glm::max(high, place);
    if (number) ++returns[static_cast<std::size_t>(number->value(i)) & 15u];
  }
  const DVec3 one = plan.grid.grid.at(low), other = plan.grid.grid.at(high);
  for (int k = 0; k < 3; ++k) {
    const std::size_t at = 179 + 16 * static_cast<std::size_t>(k);
    out.put(at, cloud.empty() ? 0.0 : std::max(one[k], other[k]));
    out.put(at + 8, cloud.empty() ? 0.0 : std::min(one[k], other[k]));
  }
  const bool early = plan.format < 6 || plan.oldEarlyCount > 0;
  for (std::size_t k = 0; k < 5; ++k)
    out.put(111 + 4 * k, static_cast<std::uint32_t>(early ? std::min<std::uint64_t>(returns[k + 1], 0xffffffffu) : 0));
  for (std::size_t k = 0; plan.minor == 4 && k < 15; ++k) out.put(255 + 8 * k, returns[k + 1]);
}

}  // namespace

/// Sets these values: the number of points and of returns, the bounding box, and the end of the points (byte `end`),
/// where further data begins.
void putPointsInto(std::vector<std::byte>& head, const LasPlan& plan, const PointCloud& cloud, std::uint64_t end) {
  putCounts(head, plan, cloud.size(), end);
  putSums(head, plan, cloud);
}

constexpr std::size_t kPointsAtOnce = std::size_t{1} << 18;  // points written at a time

void finish(AtomicFile& file, const LasPlan& plan, const CloudWriteOptions& options) {
  if (plan.baggage) file.write(plan.baggage->tail);
  if (options.keptAs)
    *options.keptAs = file.commitAndKeep();
  else
    file.commit();
}

void sayProgress(const CloudWriteOptions& options, std::size_t done, std::size_t all) {
  if (options.progress) options.progress(static_cast<double>(done) / static_cast<double>(all));
}

/// Header of a compressed file: LASzip's record follows all others.
std::vector<std::byte> packedHead(const PointCloud& cloud, const LasPlan& plan, const LazLayout& layout) {
  std::vector<std::byte> head = lasHeadFor(cloud, plan);
  const LasHeader header = readLasHeader({}, head);
  std::size_t end = header.size;
  for (const LasRecord& record : lasRecords({}, header, head))
    end = record.at + record.head.size() + record.data.size();
  const std::vector<std::byte> record = lazRecordFor(plan.format, layout);
  head.insert(head.begin() + static_cast<std::ptrdiff_t>(end), record.begin(), record.end());
  const auto put = [&](std::size_t at, auto value) { std::memcpy(head.data() + at, &value, sizeof value); };
  put(96, static_cast<std::uint32_t>(head.size()));
  put(100, header.records + 1);
  put(104, static_cast<std::uint8_t>(plan.format | kLazBit));
  return head;
}

/// Compresses all points, chunk by chunk.
std::vector<std::vector<std::byte>> packPoints(const PointCloud& cloud, const LasPlan& plan, const LazLayout& layout,
                                               const CloudWriteOptions& options) {
  const std::size_t chunkPoints = *layout.chunkPoints, count = (cloud.size() + chunkPoints - 1) / chunkPoints;
  const std::size_t together = 4 * std::size_t{threadCount(0)};
  std::vector<std::vector<std::byte>> packed(count);
  for (std::size_t first = 0; first < count; first += together) {
    sayProgress(options, first, count);
    parallelBlocks(std::min(together, count - first), 1, 0, [&](std::size_t k, std::size_t) {
      const std::size_t begin = (first + k) * chunkPoints, end = std::min(cloud.size(), begin + chunkPoints);
      std::vector<std::byte> rows((end - begin) * plan.pointBytes);
      plan.encode(cloud, begin, end, rows.data());
      packed[first + k] = encodeLazChunk(layout, rows);
    });
  }
  return packed;
}

}  // namespace

void writeLas(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  const LasPlan plan(cloud);
  plan.check(path);
  AtomicFile file(path);
  std::vector<std::byte> head = lasHeadFor(cloud, plan);
  putPointsInto(head, plan, cloud, head.size() + std::uint64_t{cloud.size()} * plan.pointBytes);
  file.write(head);
  std::vector<std::byte> rows;
  for (std::size_t begin = 0; begin < cloud.size(); begin += kPointsAtOnce) {
    sayProgress(options, begin, cloud.size());
    const std::size_t count = std::min(kPointsAtOnce, cloud.size() - begin);
    rows.assign(count * plan.pointBytes, std::byte{0});
    parallelBlocks(count, 4096, 0, [&](std::size_t from, std::size_t to) {
      plan.encode(cloud, begin + from, begin + to, rows.data() + from * plan.pointBytes);
    });
    file.write(rows);
  }
  finish(file, plan, options);
}

void writeLaz(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  const LasPlan plan(cloud);
  plan.check(path);
  if (plan.points.hasWaves) throw FileError(path, "points with wave packets cannot be packed; name the file .las");
  const LazLayout layout = lazLayoutFor(plan.format, plan.pointBytes);
  AtomicFile file(path);
  std::vector<std::byte> head = packedHead(cloud, plan, layout);
  const std::vector<std::vector<std::byte>> packed = packPoints(cloud, plan, layout, options);
  std::vector<LazChunk> chunks;
  std::uint64_t at = head.size() + sizeof(std::int64_t);
  for (const std::vector<std::byte>& chunk : packed) {
    chunks.push_back({at, chunk.size(), 0});
    at += chunk.size();
  }
  const std::vector<std::byte> table = lazChunkTable(chunks);
  putPointsInto(head, plan, cloud, at + table.size());
  file.write(head);
  file.write(std::as_bytes(std::span(&at, 1)));
  for (const std::vector<std::byte>& chunk : packed) file.write(chunk);
  file.write(table);
  finish(file, plan, options);
}

std::vector<const Attribute*> attributesOfLas(const PointCloud& cloud) {
  const std::vector<std::string> givingWay = lasNamesGivingWay(cloud);
  std::vector<const Attribute*> attributes;
  for (const Attribute& attribute : cloud.extra)
    if (std::ranges::find(givingWay, attribute.name) == givingWay.end()) attributes.push_back(&attribute);
  return attributes;
}

std::vector<std::string> lacksOfLas(const PointCloud& cloud) {
  std::vector<std::string> lost;
  if (cloud.storedAs.alpha) lost.emplace_back("the alpha of colours");
  if (const LasGrid grid = lasGridFor(cloud); !grid.exact) {
    const double step = std::abs(grid.grid.step.x);
    const auto& known = cloud.storedAs.grid;
    const bool refined = known && step < std::abs(known->step.x);
    lost.push_back(fmt::format("coordinates finer than {:.3g}", 0.5 * step) +
                   (refined
                        ? fmt::format(" (the scale becomes {:.3g}, as {:.3g} is coarse for the spacing of the points)",
                                      step, std::abs(known->step.x))
                        : ""));
  }
  for (const Attribute& attribute : cloud.extra)
    if (attribute.name.size() > 32) lost.push_back(fmt::format("the end of the name '{}'", attribute.name));
  for (const std::string& name : lasNamesGivingWay(cloud))
    lost.push_back(fmt::format("the attribute '{}', because another one is written under its name", name));
  return lost;
}

}  // namespace palpate
