#include "engine/io/las_head.hpp"

#include <algorithm>
#include <limits>

#include <glm/common.hpp>

#include "engine/io/append_bytes.hpp"
#include "engine/io/saving.hpp"

namespace palpate {

namespace {

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

}  // namespace

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

void putPointsInto(std::vector<std::byte>& head, const LasPlan& plan, const PointCloud& cloud, std::uint64_t end) {
  putCounts(head, plan, cloud.size(), end);
  putSums(head, plan, cloud);
}

}  // namespace palpate
