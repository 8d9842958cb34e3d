// Reads a file front to back through one buffer, so that memory depends on the bytes read and never on what a header
// claims.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "engine/core/bare_vector.hpp"
#include "engine/core/error.hpp"

namespace palpate {

/// UTF-16 text, as saved by Windows programs as "Unicode" (The Unicode Standard, chapter 3.9).
/// Detects UTF-16 by its byte order mark, or by a one-byte character and a zero byte.
struct Utf16Start {
  bool bigEndian = false;
  std::size_t markBytes = 0;
};
std::optional<Utf16Start> utf16Start(std::span<const std::byte> begin);

/// Converts bytes to UTF-8 incrementally. Unpaired surrogates become '?'.
class Utf16Decoder {
 public:
  explicit Utf16Decoder(bool bigEndian) : bigEndian_(bigEndian) {}

  /// Appends to `out`.
  void decode(std::span<const std::byte> bytes, BareVector<std::byte>& out);

 private:
  void put(std::uint32_t code, BareVector<std::byte>& out);

  bool bigEndian_;
  std::optional<unsigned> half_;  // the first byte of a unit
  std::uint32_t high_ = 0;        // the first unit of a surrogate pair
};

/// Large reads use many threads if the size is known. Works on pipes too; only remaining() requires a regular file.
/// Throws FileError if the system fails.
class ChunkedFile {
 public:
  explicit ChunkedFile(std::filesystem::path file);
  ~ChunkedFile();
  ChunkedFile(const ChunkedFile&) = delete;
  ChunkedFile& operator=(const ChunkedFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t offset() const { return offset_; }  ///< of the next unread byte
  std::uint64_t line() const { return line_; }      ///< 1-based, of the last line returned by readLine()
  /// Whether that line has no end, because the file ends in it.
  bool endsInLine() const { return lineIsOpen_; }
  /// An error in that line; says if the file ends in it.
  FileError errorInLine(std::string_view what) const;
  /// Called from time to time with the share that was read, if the size is known.
  void onProgress(std::function<void(double share)> progress) { onProgress_ = std::move(progress); }
  /// Bytes not yet read; nothing if unknown.
  std::optional<std::uint64_t> remaining() const;

  /// Contiguous unread bytes: at least `wanted`, fewer only at the end of the file. Valid until the next call.
  std::span<const std::byte> peek(std::size_t wanted) {
    if (end_ - begin_ < wanted) fill(wanted);
    return {buffer_.data() + begin_, end_ - begin_};
  }
  /// Marks bytes returned by peek() as read.
  void consume(std::size_t bytes) {
    begin_ += bytes;
    offset_ += bytes;
  }
  /// Passes the next `bytes`, of a file whose size is known, to `threads` (0: one per core): in blocks of `block`
  /// bytes, the last one shorter, each with the number of bytes before it. The bytes then count as read, and are not
  /// buffered. Throws FileError with the byte if the file ends early.
  void readBlocks(std::uint64_t bytes, std::size_t block, unsigned threads,
                  const std::function<void(std::span<const std::byte>, std::uint64_t before)>& take);
  /// Skips `bytes`; false if the file ends early.
  bool skip(std::uint64_t bytes);

  /// The next line without its end; nothing at the end of the file. Valid until the next call. The first line
  /// determines the line end: LF, CR LF or CR. A line longer than `longest` bytes is an error. A UTF-8 byte order mark
  /// is skipped; UTF-16 of either order is converted to UTF-8, and offset() then counts UTF-8 bytes.
  std::optional<std::string_view> readLine(std::size_t longest);
  /// Skips a UTF-8 byte order mark at the beginning of a text file, and enables the conversion of UTF-16, like
  /// readLine().
  void passTextMark();
  /// Whether the first line ended with CR only.
  bool linesEndWithCr() const { return lineEnd_ == '\r'; }

 private:
  void fill(std::size_t wanted);
  void fillTogether(std::size_t wanted);
  void sayProgress() const;
  char lineEndOfFirstLine(std::size_t longest);
  std::size_t readRaw(std::byte* to, std::size_t most);
  std::size_t readBytes(std::span<std::byte> to);

  std::filesystem::path path_;
  std::FILE* file_ = nullptr;
  bool isPipe_ = false;
  std::optional<std::uint64_t> size_;
  std::function<void(double)> onProgress_;
  BareVector<std::byte> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // unread part of buffer_
  bool atEnd_ = false;
  std::uint64_t offset_ = 0;
  std::uint64_t line_ = 0;
  bool lineIsOpen_ = false;
  char lineEnd_ = 0;  // last byte of a line's end; 0: not known yet
  std::optional<Utf16Decoder> utf16_;
};

}  // namespace palpate
