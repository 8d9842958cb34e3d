// Narrow file names are UTF-8 on every system. mingw's standard library produces UTF-8 (std::filesystem::path::string),
// but reads names with mbrtowc, in whose locale each byte is a character of its own. This file replaces that function
// at link time (--wrap).
#include <cerrno>
#include <cstdint>
#include <cwchar>

extern "C" std::size_t __wrap_mbrtowc(wchar_t* to, const char* from, std::size_t length, std::mbstate_t* kept);

namespace {

constexpr std::size_t kNoCharacter = static_cast<std::size_t>(-1), kUnfinished = static_cast<std::size_t>(-2);

// Length of the character that begins with this byte; 0: no character begins with it.
std::size_t bytesFrom(unsigned char first) {
  if (first < 0x80) return 1;
  if (first >= 0xc2 && first < 0xe0) return 2;
  if (first >= 0xe0 && first < 0xf0) return 3;
  return first >= 0xf0 && first < 0xf5 ? 4 : 0;
}

}  // namespace

/// Converts UTF-8 to one unit of UTF-16. For a character with two units the second one is kept and returned with the
/// last byte.
std::size_t __wrap_mbrtowc(wchar_t* to, const char* from, std::size_t length, std::mbstate_t* kept) {
  static thread_local std::mbstate_t own{};
  if (!kept) kept = &own;
  if (!from) return *kept = 0, 0;
  if (length == 0) return kUnfinished;
  if (*kept != 0) {
    if (to) *to = static_cast<wchar_t>(*kept);
    *kept = 0;
    return 1;
  }
  const auto byteAt = [from](std::size_t i) { return static_cast<unsigned char>(from[i]); };
  const std::size_t bytes = bytesFrom(byteAt(0));
  if (bytes == 0) return errno = EILSEQ, kNoCharacter;
  std::uint32_t code = bytes == 1 ? byteAt(0) : byteAt(0) & (0x7fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if (i == length) return kUnfinished;
    if ((byteAt(i) & 0xc0) != 0x80) return errno = EILSEQ, kNoCharacter;
    code = code << 6 | (byteAt(i) & 0x3f);
  }
  if (code >= 0x10000) {
    *kept = static_cast<std::mbstate_t>(0xdc00 | ((code - 0x10000) & 0x3ff));
    code = 0xd800 | ((code - 0x10000) >> 10);
  }
  if (to) *to = static_cast<wchar_t>(code);
  return code == 0 ? 0 : *kept != 0 ? bytes - 1 : bytes;
}
