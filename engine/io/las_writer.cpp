#include "engine/io/las_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include <glm/common.hpp>

#include "engine/core/atomic_file.hpp"
#include "engine/core/parallel.hpp"
#include "engine/io/las_grid.hpp"
#include "engine/io/las_layout.hpp"
#include "engine/io/las_plan.hpp"
#include "engine/io/saving.hpp"

namespace palpate {

namespace {

constexpr std::size_t kSlab = std::size_t{1} << 18;  // points that are written at a time

/// Puts values into the bytes of a header.
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

void append(std::vector<std::byte>& bytes, std::span<const std::byte> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

void appendRecord(std::vector<std::byte>& bytes, std::string_view user, unsigned id, std::string_view description,
                  std::span<const std::byte> data) {
  std::vector<std::byte> head(kLasRecordHead);
  HeaderBytes out(head);
  out.putText(2, user, 16);
  out.put(18, static_cast<std::uint16_t>(id));
  out.put(20, static_cast<std::uint16_t>(data.size()));
  out.putText(22, description, 32);
  append(bytes, head);
  append(bytes, data);
}

/// All comments but what the header says in its own way.
std::string commentsOf(const PointCloud& cloud) {
  constexpr std::size_t kLongest = 65535;  // of a record
  std::string text;
  for (const std::string& comment : cloud.storedAs.comments)
    if (!isOurs({&comment, 1}) && comment != "comment up: z" && text.size() + comment.size() < kLongest)
      text += comment + '\n';
  return text;
}

/// The records of the file that the cloud came from, and palpate's own.
std::uint32_t appendRecords(std::vector<std::byte>& bytes, const PointCloud& cloud, const LasPlan& plan) {
  std::uint32_t count = 0;
  const std::string comments = commentsOf(cloud);
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
        append(bytes, record.head), append(bytes, record.data), ++count;
        described = true;
      } else if (extra) {
        describe();
      } else if (record.is(kLasOurs, kLasComments)) {
        comment();
      } else {
        append(bytes, record.head), append(bytes, record.data), ++count;
      }
    }
  describe();
  comment();
  if (plan.baggage) append(bytes, std::span(plan.baggage->head).subspan(end));  // what some programs leave there
  return count;
}

/// The header and what follows it, but for what only the points tell.
std::vector<std::byte> headOf(const PointCloud& cloud, const LasPlan& plan) {
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
            static_cast<std::uint16_t>(plan.format >= 6 ? 16 : 0));  // its reference system is text, where it has one
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

/// How many points there are, and where what stands behind them begins.
void putCounts(std::vector<std::byte>& head, const LasPlan& plan, std::uint64_t points) {
  HeaderBytes out(head);
  const bool early = plan.format < 6 || (plan.baggage && plan.oldEarlyCount > 0);
  const bool fits = points <= std::numeric_limits<std::uint32_t>::max();
  out.put(107, static_cast<std::uint32_t>(early && fits ? points : 0));
  const std::uint64_t end = head.size() + points * plan.pointBytes;
  const std::uint64_t oldEnd = plan.old.pointsAt + plan.old.points * plan.old.pointBytes;
  const auto moved = [&](std::uint64_t at) { return at >= oldEnd ? at - oldEnd + end : at; };
  if (plan.minor >= 3) out.put(227, plan.old.waveformsAt ? moved(plan.old.waveformsAt) : std::uint64_t{0});
  if (plan.minor < 4) return;
  if (plan.old.longRecords > 0) out.put(235, moved(plan.old.longRecordsAt));
  out.put(247, points);
}

/// The box around the points, and how many there are of each return.
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

void encode(const PointCloud& cloud, const LasPlan& plan, std::size_t begin, std::size_t end, std::byte* rows) {
  const std::size_t rowBytes = plan.pointBytes;
  std::byte* row = rows;
  for (std::size_t i = begin; i < end; ++i, row += rowBytes) {
    const DVec3 place = plan.grid.grid.nearest(cloud.fileCoordinates(i));
    for (int k = 0; k < 3; ++k) {
      const auto number = static_cast<std::int32_t>(place[k]);
      std::memcpy(row + 4 * k, &number, sizeof number);
    }
    if (plan.points.colorAt == 0 || !cloud.hasColors()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint16_t value = plan.color(cloud, i, k);
      std::memcpy(row + plan.points.colorAt + 2 * k, &value, sizeof value);
    }
  }
  for (const LasSource& source : plan.sources) source.encode(begin, end, rows, rowBytes);
}

}  // namespace

void writeLas(const std::filesystem::path& path, const PointCloud& cloud, const CloudWriteOptions& options) {
  const LasPlan plan(cloud);
  plan.check(path);
  AtomicFile file(path);
  std::vector<std::byte> head = headOf(cloud, plan);
  putCounts(head, plan, cloud.size());
  putSums(head, plan, cloud);
  file.write(head);
  std::vector<std::byte> rows;
  for (std::size_t begin = 0; begin < cloud.size(); begin += kSlab) {
    if (options.progress) options.progress(static_cast<double>(begin) / static_cast<double>(cloud.size()));
    const std::size_t count = std::min(kSlab, cloud.size() - begin);
    rows.assign(count * plan.pointBytes, std::byte{0});
    parallelBlocks(count, 4096, 0, [&](std::size_t from, std::size_t to) {
      encode(cloud, plan, begin + from, begin + to, rows.data() + from * plan.pointBytes);
    });
    file.write(rows);
  }
  if (plan.baggage) file.write(plan.baggage->tail);
  if (options.keptAs)
    *options.keptAs = file.commitAndKeep();
  else
    file.commit();
}

std::vector<std::string> lacksOfLas(const StoredCloud& stored) {
  std::vector<std::string> lost;
  if (!stored.triangles.empty()) lost.push_back(fmt::format("{} triangles", stored.triangles.size()));
  if (stored.cloud.storedAs.alpha) lost.emplace_back("the alpha of colours");
  if (const LasGrid grid = lasGridFor(stored.cloud); !grid.exact)
    lost.push_back(fmt::format("coordinates finer than {:.3g}", 0.5 * std::abs(grid.grid.step.x)));
  for (const Attribute& attribute : stored.cloud.extra)
    if (attribute.name.size() > 32) lost.push_back(fmt::format("the end of the name '{}'", attribute.name));
  for (const std::string& name : lasNamesGivingWay(stored.cloud))
    lost.push_back(fmt::format("the attribute '{}', for what is written under its name", name));
  return lost;
}

}  // namespace palpate
