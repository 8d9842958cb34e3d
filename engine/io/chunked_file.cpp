#include "engine/io/chunked_file.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>

#include "engine/core/parallel.hpp"
#include "engine/core/system_file.hpp"

namespace palpate {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 20;
constexpr std::size_t kMinRoom = 64;  // of the buffer, for the next read

}  // namespace

std::optional<Utf16Start> utf16Start(std::span<const std::byte> begin) {
  if (begin.size() < 2) return std::nullopt;
  const auto byte = [&](std::size_t k) { return std::to_integer<unsigned>(begin[k]); };
  if (byte(0) == 0xff && byte(1) == 0xfe) return Utf16Start{.bigEndian = false, .markBytes = 2};
  if (byte(0) == 0xfe && byte(1) == 0xff) return Utf16Start{.bigEndian = true, .markBytes = 2};
  if (begin.size() < 4) return std::nullopt;
  const auto isLetter = [&](std::size_t k) { return byte(k) == '\t' || (byte(k) >= ' ' && byte(k) <= '~'); };
  if (isLetter(0) && byte(1) == 0 && isLetter(2) && byte(3) == 0) return Utf16Start{.bigEndian = false};
  if (byte(0) == 0 && isLetter(1) && byte(2) == 0 && isLetter(3)) return Utf16Start{.bigEndian = true};
  return std::nullopt;
}

void Utf16Decoder::decode(std::span<const std::byte> bytes, BareVector<std::byte>& out) {
  for (const std::byte raw : bytes) {
    const auto byte = std::to_integer<unsigned>(raw);
    if (!half_) {
      half_ = byte;
      continue;
    }
    const std::uint32_t unit = bigEndian_ ? *half_ << 8 | byte : byte << 8 | *half_;
    half_.reset();
    const bool isHigh = (unit & 0xfc00) == 0xd800, isLow = (unit & 0xfc00) == 0xdc00;
    if (high_ != 0 && isLow) {
      put(0x10000 + ((high_ & 0x3ff) << 10) + (unit & 0x3ff), out);
      high_ = 0;
      continue;
    }
    if (high_ != 0) put('?', out);
    high_ = isHigh ? unit : 0;
    if (!isHigh) put(isLow ? '?' : unit, out);
  }
}

void Utf16Decoder::put(std::uint32_t code, BareVector<std::byte>& out) {
  const auto add = [&](std::uint32_t byte) { out.push_back(static_cast<std::byte>(byte)); };
  const auto further = [&](unsigned shift) { add(0x80 | ((code >> shift) & 0x3f)); };
  if (code < 0x80) return add(code);
  if (code < 0x800) return add(0xc0 | code >> 6), further(0);
  if (code < 0x10000) return add(0xe0 | code >> 12), further(6), further(0);
  add(0xf0 | code >> 18), further(12), further(6), further(0);
}

ChunkedFile::ChunkedFile(std::filesystem::path file) : path_(std::move(file)), buffer_(kChunk) {
  std::error_code unknown;
  if (std::filesystem::is_directory(path_, unknown)) throw FileError(path_, "is a folder; name a file in it");
  constexpr double kPipeWait_s = 2;
  isPipe_ = std::filesystem::is_fifo(path_, unknown);
  file_ = isPipe_ ? openPipe(path_, kPipeWait_s) : openFile(path_, "rb");
  if (!file_ && isPipe_ && errno == ETIMEDOUT)
    throw FileError(path_, fmt::format("is a pipe to which no program has written for {} s", kPipeWait_s));
  if (file_ && isTerminal(file_)) {
    std::fclose(file_);
    throw FileError(path_, "is a keyboard; name a file, or let a program write to it");
  }
  if (!file_) throw FileError(path_, fmt::format("cannot be read: {}", std::strerror(errno)));
  std::setvbuf(file_, nullptr, _IONBF, 0);  // buffer_ is the buffer
  if (std::filesystem::is_regular_file(path_, unknown)) {
    const auto size = std::filesystem::file_size(path_, unknown);
    if (!unknown) size_ = size;
  }
}

ChunkedFile::~ChunkedFile() { std::fclose(file_); }

std::optional<std::uint64_t> ChunkedFile::remaining() const {
  if (!size_) return std::nullopt;
  return *size_ > offset_ ? *size_ - offset_ : 0;
}

void ChunkedFile::fill(std::size_t wanted) {
  if (begin_ > 0) std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  fillTogether(wanted);
  while (end_ < wanted && !atEnd_) {
    // Doubling keeps long lines linear; the buffer grows only after it was filled with bytes that exist.
    if (buffer_.size() - end_ < kMinRoom) buffer_.resize(2 * buffer_.size());
    const std::size_t got = readRaw(buffer_.data() + end_, buffer_.size() - end_);
    atEnd_ = got == 0;
    end_ += got;
  }
  sayProgress();
}

/// 0 at the end of the file.
std::size_t ChunkedFile::readBytes(std::span<std::byte> to) {
  if (!isPipe_) {
    const std::size_t got = std::fread(to.data(), 1, to.size(), file_);
    if (got > 0 || !std::ferror(file_)) return got;
  } else if (const auto got = readPipe(file_, to)) {
    return *got;
  }
  throw FileError::atByte(path_, offset_ + end_, fmt::format("cannot be read: {}", std::strerror(errno)));
}

/// With conversion of UTF-16 to UTF-8; 0 at the end of the file.
std::size_t ChunkedFile::readRaw(std::byte* to, std::size_t most) {
  if (!utf16_) return readBytes({to, most});
  constexpr std::size_t kGrowth = 3;  // 2 bytes of UTF-16 to 3 of UTF-8; half a surrogate pair from before
  BareVector<std::byte> raw(2 * ((most - kGrowth) / kGrowth)), text;
  while (text.empty()) {
    const std::size_t got = readBytes(raw);
    if (got == 0) break;
    utf16_->decode({raw.data(), got}, text);
  }
  std::copy(text.begin(), text.end(), to);
  return text.size();
}

/// Bytes already in the buffer are converted there.
void ChunkedFile::passTextMark() {
  if (offset_ > 0) return;
  const auto begin = peek(4);
  constexpr std::array kUtf8Mark{std::byte{0xef}, std::byte{0xbb}, std::byte{0xbf}};
  if (begin.size() >= kUtf8Mark.size() && std::ranges::equal(begin.first(kUtf8Mark.size()), kUtf8Mark))
    return consume(kUtf8Mark.size());
  const auto start = utf16Start(begin);
  if (!start) return;
  consume(start->markBytes);
  BareVector<std::byte> text;
  utf16_.emplace(start->bigEndian).decode({buffer_.data() + begin_, end_ - begin_}, text);
  begin_ = 0, end_ = text.size();
  text.resize(std::max(text.size() + 1, kChunk));
  buffer_ = std::move(text);
}

void ChunkedFile::sayProgress() const {
  if (onProgress_ && size_ && *size_ > 0)
    onProgress_(std::min(1.0, static_cast<double>(offset_ + end_) / static_cast<double>(*size_)));
}

/// Reads on many threads up to the known size; fill() handles a file that became shorter.
void ChunkedFile::fillTogether(std::size_t wanted) {
  const std::uint64_t from = offset_ + end_, left = size_ && *size_ > from ? *size_ - from : 0;
  const auto bytes = static_cast<std::size_t>(std::min<std::uint64_t>(wanted - end_, left));
  if (wanted <= end_ || bytes < 2 * kChunk || utf16_) return;
  buffer_.resize(std::max(buffer_.size(), end_ + bytes + 1));  // and room to detect that nothing follows
  std::atomic<std::size_t> whole = bytes;                      // up to the first byte that could not be read
  parallelBlocks(bytes, kChunk, 0, [&](std::size_t begin, std::size_t end) {
    const std::size_t got = readAt(file_, from + begin, {buffer_.data() + end_ + begin, end - begin});
    for (std::size_t known = whole; begin + got < std::min(end, known);)
      if (whole.compare_exchange_weak(known, begin + got)) break;
  });
  if (!seekTo(file_, from + whole))
    throw FileError::atByte(path_, from, fmt::format("cannot be read: {}", std::strerror(errno)));
  end_ += whole;
}

void ChunkedFile::readBlocks(std::uint64_t bytes, std::size_t block, unsigned threads,
                             const std::function<void(std::span<const std::byte>, std::uint64_t)>& take) {
  const std::uint64_t blocks = (bytes + block - 1) / block;
  std::atomic<std::uint64_t> next = 0;
  const auto work = [&](std::size_t) {
    BareVector<std::byte> buffer(static_cast<std::size_t>(std::min<std::uint64_t>(block, bytes)));
    for (std::uint64_t k; (k = next++) < blocks;) {
      const std::uint64_t before = k * block;
      const std::span<std::byte> piece(buffer.data(),
                                       static_cast<std::size_t>(std::min<std::uint64_t>(block, bytes - before)));
      const std::size_t got = readAt(file_, offset_ + before, piece);
      if (got < piece.size())
        throw FileError::atByte(path_, offset_ + before + got,
                                fmt::format("the file ends before the {} bytes from byte {} on", bytes, offset_));
      take(piece, before);
    }
  };
  parallelParts(static_cast<std::size_t>(std::min<std::uint64_t>(blocks, threadCount(threads))), work);
  offset_ += bytes;
  begin_ = end_ = 0;
  if (!seekTo(file_, offset_))
    throw FileError::atByte(path_, offset_, fmt::format("cannot be read: {}", std::strerror(errno)));
  sayProgress();
}

bool ChunkedFile::skip(std::uint64_t bytes) {
  while (bytes > 0) {
    const std::size_t step = static_cast<std::size_t>(std::min<std::uint64_t>(peek(1).size(), bytes));
    if (step == 0) return false;
    consume(step);
    bytes -= step;
  }
  return true;
}

char ChunkedFile::lineEndOfFirstLine(std::size_t longest) {
  for (std::size_t searched = 0;;) {
    const auto unread = peek(searched + 1);
    const std::string_view text(reinterpret_cast<const char*>(unread.data()), unread.size());
    const std::size_t end = text.find_first_of("\r\n", searched);
    if (end != text.npos) {
      const auto further = peek(end + 2);
      return further[end] == std::byte{'\r'} && further.size() > end + 1 && further[end + 1] != std::byte{'\n'} ? '\r'
                                                                                                                : '\n';
    }
    if (text.size() == searched || text.size() > longest) return '\n';
    searched = text.size();
  }
}

FileError ChunkedFile::errorInLine(std::string_view what) const {
  return FileError::atLine(
      path_, line_,
      lineIsOpen_ ? fmt::format("{}; the file ends in this line, it may be truncated", what) : std::string(what));
}

std::optional<std::string_view> ChunkedFile::readLine(std::size_t longest) {
  if (lineEnd_ == 0) {
    passTextMark();
    lineEnd_ = lineEndOfFirstLine(longest);
  }
  // In such a file a line that ends with CR LF nevertheless leaves its LF to the next line.
  if (linesEndWithCr() && !peek(1).empty() && peek(1)[0] == std::byte{'\n'}) consume(1);
  std::size_t searched = 0;
  for (;;) {
    const auto unread = peek(searched + 1);
    if (unread.empty()) return std::nullopt;
    const auto* text = reinterpret_cast<const char*>(unread.data());
    const void* newline = std::memchr(text + searched, lineEnd_, unread.size() - searched);
    const bool lastLine = !newline && unread.size() == searched;
    std::size_t length = newline ? static_cast<std::size_t>(static_cast<const char*>(newline) - text) : unread.size();
    if (length > longest) {
      throw FileError::atLine(
          path_, line_ + 1, fmt::format("a line of more than {} bytes; this is not the text it claims to be", longest));
    }
    if (newline || lastLine) {
      ++line_;
      lineIsOpen_ = !newline;
      consume(length + (newline ? 1 : 0));
      // Programs of DOS end a file with the sign 0x1A.
      if (lastLine && text[length - 1] == '\x1a' && --length == 0) return std::nullopt;
      if (length > 0 && text[length - 1] == '\r') --length;
      return std::string_view(text, length);
    }
    searched = unread.size();
  }
}

}  // namespace palpate
