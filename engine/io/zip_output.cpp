#include "engine/io/zip_output.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <new>

#include "engine/io/zip_archive.hpp"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace palpate {

namespace {

constexpr std::uint32_t kEndOfArchive = 0x06054b50, kWideEnd = 0x06064b50, kWideLocator = 0x07064b50,
                        kEntry = 0x02014b50, kLocalHead = 0x04034b50;
constexpr std::uint64_t kMax32 = 0xffffffff, kMax16 = 0xffff;
constexpr std::uint16_t kVersion = 20, kWideVersion = 45, kUtf8 = 1 << 11, kDeflate = 8;
constexpr std::uint16_t kFirstDay = 1 << 5 | 1;  // January 1, 1980: the same bytes in each run

void number(std::string& out, std::uint64_t value, unsigned bytes) {
  for (unsigned k = 0; k < bytes; ++k) out += static_cast<char>(value >> (8 * k) & 0xff);
}

/// Raw deflate data, without the two bytes before and the four bytes behind it of a zlib stream; empty if it is not
/// smaller.
std::string deflated(std::span<const std::byte> bytes) {
  constexpr std::size_t kMax = std::size_t{1} << 30, kBefore = 2, kBehind = 4;
  if (bytes.empty() || bytes.size() > kMax) return {};
  constexpr int kQuality = 8;
  int length = 0;
  // The input is only read.
  auto* given = reinterpret_cast<unsigned char*>(const_cast<std::byte*>(bytes.data()));
  const std::unique_ptr<unsigned char, decltype(&std::free)> packed(
      stbi_zlib_compress(given, static_cast<int>(bytes.size()), &length, kQuality), &std::free);
  if (!packed) throw std::bad_alloc();
  const auto size = static_cast<std::size_t>(length);
  if (size <= kBefore + kBehind || size - kBefore - kBehind >= bytes.size()) return {};
  return {reinterpret_cast<const char*>(packed.get()) + kBefore, size - kBefore - kBehind};
}

}  // namespace

void ZipOutput::put(const std::string& bytes) {
  file_.write(std::string_view(bytes));
  at_ += bytes.size();
}

void ZipOutput::add(const std::string& name, std::span<const std::byte> bytes) {
  const std::string packed = deflated(bytes);
  const std::uint64_t size = packed.empty() ? bytes.size() : packed.size(), local = at_;
  const bool wide = std::max<std::uint64_t>(size, bytes.size()) >= kMax32, far = local >= kMax32;
  std::string sizes;  // 64-bit sizes
  if (wide) number(sizes, bytes.size(), 8), number(sizes, size, 8);
  const auto common = [&](std::string& out, std::size_t extra) {
    number(out, wide || far ? kWideVersion : kVersion, 2);
    number(out, kUtf8, 2);
    number(out, packed.empty() ? 0 : kDeflate, 2);
    number(out, 0, 2), number(out, kFirstDay, 2);
    number(out, zipChecksum(bytes), 4);
    number(out, wide ? kMax32 : size, 4), number(out, wide ? kMax32 : bytes.size(), 4);
    number(out, name.size(), 2), number(out, extra, 2);
  };
  std::string head;
  number(head, kLocalHead, 4);
  common(head, wide ? 4 + sizes.size() : 0);
  head += name;
  if (wide) number(head, 1, 2), number(head, sizes.size(), 2), head += sizes;
  put(head);
  if (packed.empty()) {
    file_.write(bytes);
    at_ += bytes.size();
  } else {
    put(packed);
  }

  if (far) number(sizes, local, 8);
  number(list_, kEntry, 4);
  number(list_, wide || far ? kWideVersion : kVersion, 2);
  common(list_, sizes.empty() ? 0 : 4 + sizes.size());
  number(list_, 0, 2), number(list_, 0, 2), number(list_, 0, 2), number(list_, 0, 4);  // no comment, disk or attributes
  number(list_, far ? kMax32 : local, 4);
  list_ += name;
  if (!sizes.empty()) number(list_, 1, 2), number(list_, sizes.size(), 2), list_ += sizes;
  ++members_;
}

void ZipOutput::finish(std::filesystem::path* keptAs) {
  const std::uint64_t listAt = at_, listBytes = list_.size();
  put(list_);
  std::string end;
  if (listAt >= kMax32 || listBytes >= kMax32 || members_ >= kMax16) {
    const std::uint64_t wideAt = at_;
    number(end, kWideEnd, 4), number(end, 44, 8);
    number(end, kWideVersion, 2), number(end, kWideVersion, 2);
    number(end, 0, 4), number(end, 0, 4);
    number(end, members_, 8), number(end, members_, 8);
    number(end, listBytes, 8), number(end, listAt, 8);
    number(end, kWideLocator, 4), number(end, 0, 4), number(end, wideAt, 8), number(end, 1, 4);
  }
  number(end, kEndOfArchive, 4), number(end, 0, 2), number(end, 0, 2);
  number(end, std::min(members_, kMax16), 2), number(end, std::min(members_, kMax16), 2);
  number(end, std::min(listBytes, kMax32), 4), number(end, std::min(listAt, kMax32), 4);
  number(end, 0, 2);
  put(end);
  if (keptAs)
    *keptAs = file_.commitAndKeep();
  else
    file_.commit();
}

}  // namespace palpate
