#include "engine/io/e57_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "engine/cloud/scalar_type.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"

namespace palpate {

namespace {

constexpr std::size_t kSectionHead = 32, kDataHead = 6, kPadding = 16;  // bytes
enum class Packet : unsigned { index, data, empty };

}  // namespace

unsigned E57Field::bits() const {
  switch (kind) {
    case Kind::single:
      return 32;
    case Kind::real:
      return 64;
    case Kind::text:
      return 0;
    default:
      return static_cast<unsigned>(
          std::bit_width(static_cast<std::uint64_t>(most) - static_cast<std::uint64_t>(least)));
  }
}

E57Records::E57Records(const E57Pages& pages, const E57Scan& scan) : scan_(scan), streams_(scan.fields.size()) {
  if (scan.points > 0) readPackets(pages);
  checkCounts(pages);
  for (auto& stream : streams_) stream.resize(stream.size() + kPadding);
}

/// Reads the section packet by packet.
void E57Records::readPackets(const E57Pages& pages) {
  const auto head = pages.from(scan_.pointsAt, kSectionHead, scan_.pointsAt);
  const auto refuse = [&](std::size_t at, const std::string& why) {
    return FileError::atByte(pages.file(), pages.fileByteOf(head.data() + at), why);
  };
  if (head[0] != std::byte{1}) throw refuse(0, "no section of points begins here");
  const auto length = loadScalar<std::uint64_t>(head.data() + 8), dataAt = loadScalar<std::uint64_t>(head.data() + 16);
  const auto section = pages.from(scan_.pointsAt, length, pages.fileByteOf(head.data() + 8));
  const auto data = pages.from(dataAt, pages.fileByteOf(head.data() + 16));
  if (data.data() < section.data() || data.data() >= section.data() + section.size())
    throw refuse(16, fmt::format("the points begin at byte {}, outside their section", dataAt));
  std::size_t left = static_cast<std::size_t>(section.data() + section.size() - data.data()), at = 0;
  while (left >= 4) {
    const std::size_t taken = takePacket(pages, data.subspan(at, left));
    at += taken;
    left -= taken;
  }
}

/// Appends a packet, which has at least four bytes, and returns its size.
std::size_t E57Records::takePacket(const E57Pages& pages, std::span<const std::byte> packet) {
  const auto refuse = [&](std::size_t at, const std::string& why) {
    return FileError::atByte(pages.file(), pages.fileByteOf(packet.data() + at), why);
  };
  const auto kind = static_cast<unsigned>(packet[0]);
  const std::size_t length = std::size_t{loadScalar<std::uint16_t>(packet.data() + 2)} + 1;
  if (kind > static_cast<unsigned>(Packet::empty))
    throw refuse(0, fmt::format("a packet of kind {}; 0 to 2 are known", kind));
  if (length > packet.size() || length % 4 != 0)
    throw refuse(2, fmt::format("a packet of {} bytes, where {} are left", length, packet.size()));
  if (kind != static_cast<unsigned>(Packet::data)) return length;
  const std::size_t count = length < kDataHead ? 0 : loadScalar<std::uint16_t>(packet.data() + 4);
  if (count != streams_.size())
    throw refuse(4, fmt::format("a packet of {} streams; the points have {} fields", count, streams_.size()));
  std::size_t at = kDataHead + 2 * count;
  for (std::size_t k = 0; k < count; ++k) {
    if (at > length) throw refuse(2, "a packet that is too short for its streams");
    const std::size_t bytes = loadScalar<std::uint16_t>(packet.data() + kDataHead + 2 * k);
    if (bytes > length - at)
      throw refuse(kDataHead + 2 * k,
                   fmt::format("stream {} has {} bytes, and {} are left of its packet", k + 1, bytes, length - at));
    const auto stream = packet.subspan(at, bytes);
    streams_[k].insert(streams_[k].end(), stream.begin(), stream.end());
    at += bytes;
  }
  return length;
}

void E57Records::checkCounts(const E57Pages& pages) const {
  if (scan_.points == 0) return;
  bool any = false;
  for (std::size_t k = 0; k < streams_.size(); ++k) {
    const unsigned bits = scan_.fields[k].bits();
    if (bits == 0) continue;
    any = true;
    const std::uint64_t there = 8 * std::uint64_t{streams_[k].size()} / bits;
    if (there < scan_.points)
      throw FileError::atByte(
          pages.file(), scan_.pointsAt,
          fmt::format("a scan of {} has {} values of {}", counted(scan_.points, "point"), there, scan_.fields[k].name));
  }
  if (!any)
    throw FileError::atByte(pages.file(), scan_.pointsAt,
                            fmt::format("a scan of {} stores no data", counted(scan_.points, "point")));
}

double E57Records::value(std::size_t field, std::uint64_t point) const {
  const E57Field& known = scan_.fields[field];
  const std::byte* stream = streams_[field].data();
  if (known.kind == E57Field::Kind::single) return loadScalar<float>(stream + 4 * point);
  if (known.kind == E57Field::Kind::real) return loadScalar<double>(stream + 8 * point);
  const unsigned bits = known.bits();
  std::uint64_t raw = 0;
  if (bits > 0) {
    const std::uint64_t first = point * bits, shift = first % 8;
    const std::byte* at = stream + first / 8;
    raw = loadScalar<std::uint64_t>(at) >> shift;
    if (shift + bits > 64) raw |= static_cast<std::uint64_t>(at[8]) << (64 - shift);
    if (bits < 64) raw &= (std::uint64_t{1} << bits) - 1;
  }
  const auto whole = static_cast<std::int64_t>(raw + static_cast<std::uint64_t>(known.least));
  const auto number = static_cast<double>(whole);
  return known.kind == E57Field::Kind::scaled ? number * known.scale + known.offset : number;
}

}  // namespace palpate
