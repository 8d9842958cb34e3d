// Bytes of a file, requested in pieces of any size.
#include "engine/io/chunked_file.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/io/ply_bytes.hpp"

namespace palpate::test::chunked_file_test {
namespace {

std::string someBytes(std::size_t count) {
  std::string bytes(count, '\0');
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<char>(i * i * 2654435761u >> 13);
  return bytes;
}

std::string_view textOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

TEST_CASE("the bytes of a file are read in order, in small pieces or in large ones shared by threads") {
  constexpr std::size_t kMega = std::size_t{1} << 20;
  const std::string content = someBytes(9 * kMega + 3);
  const TemporaryFile written(content);
  for (const std::size_t wanted : {std::size_t{1}, kMega, 2 * kMega - 1, 2 * kMega, 3 * kMega + 1, 20 * kMega}) {
    CAPTURE(wanted);
    ChunkedFile file(written.path());
    double share = 0;
    file.onProgress([&](double told) { share = told; });
    std::size_t at = 0;
    bool same = true;
    while (at < content.size()) {
      const auto unread = file.peek(wanted);
      REQUIRE(unread.size() >= std::min(wanted, content.size() - at));
      same = same && textOf(unread) == std::string_view(content).substr(at, unread.size());
      CHECK(file.offset() == at);
      CHECK(file.remaining() == content.size() - at);
      // Not all of it, so that the remainder precedes the next bytes.
      const std::size_t read = std::max<std::size_t>(1, unread.size() - unread.size() / 7);
      file.consume(read);
      at += read;
    }
    CHECK(same);
    CHECK(file.peek(wanted).empty());
    CHECK(share == 1);
  }
}

TEST_CASE("a file truncated after it was opened is read up to its new end") {
  constexpr std::size_t kMega = std::size_t{1} << 20;
  const std::string content = someBytes(6 * kMega);
  for (const std::size_t left : {std::size_t{0}, kMega + 5, 5 * kMega, 6 * kMega - 1}) {
    CAPTURE(left);
    const TemporaryFile written(content);
    ChunkedFile file(written.path());
    std::filesystem::resize_file(written.path(), left);
    const auto unread = file.peek(6 * kMega);
    CHECK(textOf(unread) == std::string_view(content).substr(0, left));
    file.consume(unread.size());
    CHECK(file.peek(1).empty());
  }
}

}  // namespace palpate::test::chunked_file_test
