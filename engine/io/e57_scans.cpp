#include "engine/io/e57_scans.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>

#include "engine/cloud/scalar_type.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/crc32c.hpp"
#include "engine/io/ends_after.hpp"

namespace palpate {

namespace {

constexpr std::size_t kPage = 1024, kChecked = 1020, kHeader = 48;

}  // namespace

E57Pages::E57Pages(const std::filesystem::path& file, Log* log) : file_(file) {
  ChunkedFile input(file);
  if (log) input.onProgress([&](double share) { log->progress(file.filename().string(), share); });
  constexpr std::string_view kSignature = "ASTM-E57";
  const auto begin = input.peek(kHeader);
  if (begin.size() < kSignature.size() || std::memcmp(begin.data(), kSignature.data(), kSignature.size()) != 0)
    throw FileError(file, "is not an E57 file");
  checkPages(input.peek(std::numeric_limits<std::size_t>::max() / 2));
  readHeader(bytes_.size() / kChecked * kPage);
}

void E57Pages::checkPages(std::span<const std::byte> whole) {
  const std::size_t pages = whole.size() / kPage;
  if (whole.size() % kPage != 0 || pages == 0)
    throw FileError::atByte(file_, whole.size(), fmt::format("the file ends inside page {}", pages + 1));
  bytes_.resize(pages * kChecked);
  std::atomic<std::size_t> damaged = pages;
  parallelBlocks(pages, 256, 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t page = begin; page < end; ++page) {
      const auto checked = whole.subspan(page * kPage, kChecked);
      std::uint32_t sum = 0;  // big-endian
      for (std::size_t k = 0; k < 4; ++k)
        sum = sum << 8 | static_cast<std::uint32_t>(whole[page * kPage + kChecked + k]);
      if (crc32c(checked) != sum)
        for (std::size_t known = damaged; page < known && !damaged.compare_exchange_weak(known, page);) {
        }
      std::copy(checked.begin(), checked.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(page * kChecked));
    }
  });
  if (damaged < pages)
    throw FileError::atByte(file_, damaged * kPage,
                            fmt::format("page {} of {} is damaged: its checksum does not fit", damaged + 1, pages));
}

void E57Pages::readHeader(std::size_t fileBytes) {
  const auto number = [&](std::size_t at) { return loadScalar<std::uint64_t>(bytes_.data() + at); };
  const auto major = loadScalar<std::uint32_t>(bytes_.data() + 8),
             minor = loadScalar<std::uint32_t>(bytes_.data() + 12);
  if (major != 1)
    throw FileError::atByte(file_, 8, fmt::format("E57 version {}.{}; only version 1 can be read", major, minor));
  if (number(16) > fileBytes) throw endsAfter(file_, fileBytes, fileBytes, number(16), "bytes");
  if (number(16) != fileBytes)
    throw FileError::atByte(file_, 16,
                            fmt::format("the header promises {} bytes, but the file has {}", number(16), fileBytes));
  if (number(40) != kPage)
    throw FileError::atByte(file_, 40, fmt::format("pages of {} bytes; expected {}", number(40), kPage));
  const auto xml = from(number(24), number(32), 24);
  xml_ = {reinterpret_cast<const char*>(xml.data()), xml.size()};
}

std::span<const std::byte> E57Pages::from(std::uint64_t fileByte, std::uint64_t saidAt) const {
  const std::uint64_t page = fileByte / kPage, within = fileByte % kPage;
  if (page >= bytes_.size() / kChecked || within >= kChecked)
    throw FileError::atByte(file_, saidAt, fmt::format("refers to byte {}, which holds no data", fileByte));
  return std::span<const std::byte>(bytes_).subspan(page * kChecked + within);
}

std::span<const std::byte> E57Pages::from(std::uint64_t fileByte, std::uint64_t count, std::uint64_t saidAt) const {
  const auto rest = from(fileByte, saidAt);
  if (count > rest.size())
    throw FileError::atByte(
        file_, saidAt,
        fmt::format("refers to {} bytes from byte {} on, but only {} are there", count, fileByte, rest.size()));
  return rest.first(count);
}

std::uint64_t E57Pages::fileByteOf(const std::byte* at) const {
  const auto logical = static_cast<std::uint64_t>(at - bytes_.data());
  return logical / kChecked * kPage + logical % kChecked;
}

}  // namespace palpate
