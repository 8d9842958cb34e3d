// Two LAZ chunks that a thread unpacks together: each is unpacked as if it were alone, whatever the other contains.
#include <doctest/doctest.h>

#include "tests/io/laz_bytes.hpp"

namespace palpate::test::laz_side_by_side_test {

namespace {

std::string rowsBy(const std::string& text, unsigned threads) {
  return pointsOf(written(reading(text, threads).cloud));
}

/// Offsets of the chunks of a packed file, and the end of the last one.
std::vector<std::size_t> chunkPlaces(const LasBytes& las, const std::vector<std::size_t>& chunks,
                                     const std::string& packed) {
  std::uint32_t body = 0;
  std::memcpy(&body, packed.data() + 96, sizeof body);
  std::vector<std::size_t> places{body + std::size_t{8}};
  std::size_t done = 0;
  for (const std::size_t points : chunks) {
    const auto rows = std::as_bytes(std::span(las.points)).subspan(done * las.pointBytes, points * las.pointBytes);
    places.push_back(places.back() + encodeLazChunk(lazLayoutFor(las.format, las.pointBytes), rows).size());
    done += points;
  }
  return places;
}

}  // namespace

TEST_CASE("two LAZ chunks unpacked together are exact, even if one is much longer") {
  const std::vector<std::size_t> chunks = {1, 1, 3000, 1, 2, 2049, 1024, 1025, 700, 9, 2500, 2499, 5};
  for (const unsigned format : {0u, 1u, 2u, 3u, 6u, 8u})
    for (const unsigned more : {0u, 12u}) {
      std::size_t count = 0;
      for (const std::size_t points : chunks) count += points;
      const LasBytes las = variedFile(format, count, more);
      const std::string packed = packedFile(las, {.chunks = chunks});
      for (const unsigned threads : {1u, 2u, 16u}) {  // 16: each chunk alone
        CAPTURE(format);
        CAPTURE(more);
        CAPTURE(threads);
        CHECK(rowsBy(packed, threads) == las.points);
      }
    }
}

TEST_CASE("a damaged LAZ chunk of two unpacked together is reported, and the first of two damaged ones") {
  const std::vector<std::size_t> chunks = {4000, 3000, 2000, 2500, 1500};
  for (const unsigned format : {3u, 7u}) {
    const LasBytes las = variedFile(format, 13'000, 2);
    const std::string good = packedFile(las, {.chunks = chunks});
    const std::vector<std::size_t> places = chunkPlaces(las, chunks, good);
    refuses("a.las", good, "read", {.threads = 1});
    // Bytes of 0xff up to a chunk's end: sooner or later they decode to something impossible, or are too few.
    const auto refused = [&](std::initializer_list<std::array<std::size_t, 2>> damaged) {
      std::string text = good;
      for (const auto [k, hundredths] : damaged) {
        const std::size_t from = (places[k + 1] - places[k]) * hundredths / 100;
        std::fill(text.begin() + static_cast<std::ptrdiff_t>(places[k] + from),
                  text.begin() + static_cast<std::ptrdiff_t>(places[k + 1]), '\xff');
      }
      return refusalOf("a.las", text, {.threads = 1});
    };
    const auto sentence = [&](std::size_t k) {
      return fmt::format(": byte {}: the chunk of {} points that begins at byte {} ends inside them, or is damaged",
                         places[k + 1], chunks[k], places[k]);
    };
    const std::size_t early = 5, late = 80;  // far more than a thousand rows lie between them
    for (std::size_t k = 0; k < chunks.size(); ++k) {
      CAPTURE(format);
      CAPTURE(k);
      CHECK(refused({{k, early}}) == sentence(k));
    }
    CHECK(refused({{0, late}, {1, early}}) == sentence(0));
    CHECK(refused({{2, late}, {3, early}}) == sentence(2));
    CHECK(refused({{1, late}, {2, early}}) == sentence(1));
  }
}

TEST_CASE("the unchecked range decoder decodes what the checked one does while enough bytes remain") {
  constexpr int kCount = 20'000;
  RangeEncoder encoder;
  SymbolModel symbols(256);
  BitModel bit;
  Dice dice(3);
  std::vector<std::uint32_t> values;
  for (int i = 0; i < kCount; ++i) values.push_back(dice.oneIn(3) ? dice.below(0xffffffffu) : dice.below(20));
  for (const std::uint32_t value : values) {
    encoder.symbol(symbols, value % 256);
    encoder.bit(bit, value % 5 == 0);
    encoder.bits(1 + value % 32, value >> (31 - value % 32));
  }
  const std::vector<std::byte> stream = encoder.finish();
  RangeDecoder careful(stream);
  SymbolModel model(256);
  BitModel other;
  bool same = true;
  int quick = 0;
  for (const std::uint32_t value : values) {
    const auto decode = [&](auto& decoder) {
      same = same && decoder.symbol(model) == value % 256 && decoder.bit(other) == (value % 5 == 0) &&
             decoder.bits(1 + value % 32) == value >> (31 - value % 32);
    };
    RangeDecoderOf<false> told(careful);
    if (told.left() >= 4 * RangeDecoderOf<false>::kMaxBytes) {
      decode(told);
      careful = RangeDecoder(told);
      ++quick;
    } else {
      decode(careful);
    }
  }
  CHECK(same);
  CHECK(quick > kCount - 100);
  CHECK(careful.left() == 0);
  CHECK(!careful.isWrong());
}

}  // namespace palpate::test::laz_side_by_side_test
