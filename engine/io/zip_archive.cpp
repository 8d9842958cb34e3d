#include "engine/io/zip_archive.hpp"

#include <algorithm>
#include <limits>
#include <new>

#include <zlib.h>

#include "engine/cloud/scalar_type.hpp"
#include "engine/core/error.hpp"
#include "engine/io/in_quotes.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kEndOfArchive = 0x06054b50, kWideEnd = 0x06064b50, kWideLocator = 0x07064b50,
                        kEntry = 0x02014b50, kLocalHead = 0x04034b50;
constexpr std::size_t kEndBytes = 22, kEntryBytes = 46, kLocalBytes = 30, kWideEndBytes = 56, kLocatorBytes = 20;
constexpr std::uint32_t kElsewhere = 0xffffffff;  // marks a 32-bit number whose value is in a 64-bit field

class ZipReader {
 public:
  ZipReader(const std::filesystem::path& file, std::span<const std::byte> archive) : file_(file), archive_(archive) {}

  template <class T>
  T load(std::uint64_t at) const {
    if (at > archive_.size() || archive_.size() - at < sizeof(T)) fail(archive_.size(), "the archive ends too early");
    return loadScalar<T>(archive_.data() + at);
  }
  [[noreturn]] void fail(std::uint64_t at, std::string_view what) const { throw FileError::atByte(file_, at, what); }

  std::uint64_t findEnd() const {
    constexpr std::size_t kLongestRemark = 65535;
    const std::size_t last = archive_.size() < kEndBytes ? 0 : archive_.size() - kEndBytes;
    for (std::size_t back = 0; archive_.size() >= kEndBytes && back <= std::min(last, kLongestRemark); ++back)
      if (load<std::uint32_t>(last - back) == kEndOfArchive) return last - back;
    const bool begins = archive_.size() >= 4 && load<std::uint32_t>(0) == kLocalHead;
    fail(archive_.size(), begins ? "the file ends before its list of members; it is truncated" : "not a ZIP archive");
  }

  std::vector<ZipMember> members() const {
    const std::uint64_t end = findEnd();
    std::uint64_t count = load<std::uint16_t>(end + 10), at = load<std::uint32_t>(end + 16);
    if (end >= kLocatorBytes && load<std::uint32_t>(end - kLocatorBytes) == kWideLocator) {
      const auto wide = load<std::uint64_t>(end - kLocatorBytes + 8);
      if (wide > archive_.size() || archive_.size() - wide < kWideEndBytes || load<std::uint32_t>(wide) != kWideEnd)
        fail(end - kLocatorBytes, "the list of members is not where the archive says");
      count = load<std::uint64_t>(wide + 32);
      at = load<std::uint64_t>(wide + 48);
    }
    std::vector<ZipMember> members;
    for (std::uint64_t k = 0; k < count; ++k) {
      if (at > archive_.size() || archive_.size() - at < kEntryBytes || load<std::uint32_t>(at) != kEntry)
        fail(at, fmt::format("expected member {} of {}", k + 1, count));
      members.push_back(memberAt(at));
      at += kEntryBytes + load<std::uint16_t>(at + 28) + load<std::uint16_t>(at + 30) + load<std::uint16_t>(at + 32);
    }
    return members;
  }

 private:
  ZipMember memberAt(std::uint64_t at) const {
    const std::size_t nameBytes = load<std::uint16_t>(at + 28), extraBytes = load<std::uint16_t>(at + 30);
    if (archive_.size() - at - kEntryBytes < nameBytes + extraBytes)
      fail(at, "the archive ends inside its list of members");
    ZipMember member{.name = {reinterpret_cast<const char*>(archive_.data()) + at + kEntryBytes, nameBytes},
                     .packed = load<std::uint32_t>(at + 20),
                     .bytes = load<std::uint32_t>(at + 24),
                     .checksum = load<std::uint32_t>(at + 16)};
    std::uint64_t local = load<std::uint32_t>(at + 42);
    takeWideSizes(at + kEntryBytes + nameBytes, extraBytes, {&member.bytes, &member.packed, &local});
    const unsigned method = load<std::uint16_t>(at + 10);
    if (load<std::uint16_t>(at + 8) & 1u) fail(at, fmt::format("{} is encrypted", inQuotes(member.name)));
    if (method != 0 && method != 8)
      fail(at + 10, fmt::format("{} is packed by method {}, which is not read", inQuotes(member.name), method));
    member.deflated = method == 8;
    if (local > archive_.size() || archive_.size() - local < kLocalBytes || load<std::uint32_t>(local) != kLocalHead)
      fail(at + 42, fmt::format("{} does not begin where the list of members says", inQuotes(member.name)));
    member.at = local + kLocalBytes + load<std::uint16_t>(local + 26) + load<std::uint16_t>(local + 28);
    if (member.at > archive_.size() || archive_.size() - member.at < member.packed)
      fail(local, fmt::format("{} reaches beyond the end of the archive", inQuotes(member.name)));
    return member;
  }

  void takeWideSizes(std::uint64_t at, std::size_t bytes, std::initializer_list<std::uint64_t*> numbers) const {
    for (const std::uint64_t end = at + bytes; at + 4 <= end;) {
      const unsigned id = load<std::uint16_t>(at), length = load<std::uint16_t>(at + 2);
      std::uint64_t next = at + 4;
      at = next + length;
      if (id != 1 || at > end) continue;
      for (std::uint64_t* number : numbers)
        if (*number == kElsewhere && next + 8 <= at) {
          *number = load<std::uint64_t>(next);
          next += 8;
        }
    }
  }

  const std::filesystem::path& file_;
  std::span<const std::byte> archive_;
};

constexpr std::uint64_t kMaxPerDeflatedByte = 1032;                          // deflate's maximum ratio
constexpr std::uint64_t kMaxInflated = std::numeric_limits<int>::max() - 2;  // bytes, packed or not

/// Whether `packed` begins with raw deflate data that fill `bytes` exactly. Both have at most kMaxInflated bytes.
bool inflatesTo(std::span<std::byte> bytes, std::span<const std::byte> packed) {
  constexpr int kRaw = -15;  // no header, the largest window
  std::byte beyond{};        // zlib wants a place even for no bytes
  z_stream stream{};
  stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(packed.data()));  // only read
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.empty() ? &beyond : bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  if (inflateInit2(&stream, kRaw) != Z_OK) throw std::bad_alloc();
  const bool ends = inflate(&stream, Z_FINISH) == Z_STREAM_END;
  inflateEnd(&stream);
  return ends && stream.avail_out == 0;
}

}  // namespace

std::uint32_t zipChecksum(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::vector<ZipMember> zipMembers(const std::filesystem::path& file, std::span<const std::byte> archive) {
  return ZipReader(file, archive).members();
}

std::vector<std::byte> unpackZip(const std::filesystem::path& file, std::span<const std::byte> archive,
                                 const ZipMember& member) {
  const auto packed = archive.subspan(member.at, member.packed);
  const auto damaged = [&](std::string_view what) {
    return FileError::atByte(file, member.at, fmt::format("{} {}", inQuotes(member.name), what));
  };
  std::vector<std::byte> bytes;
  if (!member.deflated) {
    if (member.bytes != member.packed) throw damaged("has two different sizes");
    bytes.assign(packed.begin(), packed.end());
  } else {
    if (member.bytes > kMaxInflated || member.packed > kMaxInflated)
      throw damaged("is packed and larger than 2 GiB, which is not read");
    if (member.bytes / kMaxPerDeflatedByte > member.packed) throw damaged("has an impossible size");
    bytes.resize(member.bytes);
    if (!inflatesTo(bytes, packed)) throw damaged("is damaged: it cannot be unpacked");
  }
  if (zipChecksum(bytes) != member.checksum) throw damaged("is damaged: its checksum does not match");
  return bytes;
}

std::vector<std::byte> unpackGzip(const std::filesystem::path& file, std::span<const std::byte> packed) {
  constexpr std::size_t kHead = 10, kTail = 8;
  constexpr unsigned kChecked = 2, kExtra = 4, kNamed = 8, kRemarked = 16;
  const auto fail = [&](std::size_t at, std::string_view what) { throw FileError::atByte(file, at, what); };
  const auto byte = [&](std::size_t k) { return std::to_integer<unsigned>(packed[k]); };
  if (packed.size() < kHead + kTail || byte(0) != 0x1f || byte(1) != 0x8b || byte(2) != 8)
    fail(0, "is not packed by gzip, as it should be");
  const std::size_t end = packed.size() - kTail;
  std::size_t at = kHead;
  const unsigned flags = byte(3);
  if (flags & kExtra) at += 2 + (at + 2 <= end ? loadScalar<std::uint16_t>(packed.data() + at) : end);
  for (const unsigned text : {kNamed, kRemarked}) {
    if (!(flags & text)) continue;
    while (at < end && byte(at) != 0) ++at;
    ++at;
  }
  if (flags & kChecked) at += 2;
  if (at >= end) fail(packed.size(), "ends within its header");
  const auto checksum = loadScalar<std::uint32_t>(packed.data() + end),
             size = loadScalar<std::uint32_t>(packed.data() + end + 4);
  if (size > kMaxInflated || packed.size() > kMaxInflated)
    fail(end + 4, "is larger than 2 GiB, which is not unpacked here, or is truncated");
  if (size / kMaxPerDeflatedByte > packed.size()) fail(end + 4, "has an impossible size");
  std::vector<std::byte> bytes(size);
  if (!inflatesTo(bytes, packed.subspan(at, end - at))) fail(at, "is damaged: it cannot be unpacked");
  if (zipChecksum(bytes) != checksum) fail(end, "is damaged: its checksum does not match");
  return bytes;
}

}  // namespace palpate
