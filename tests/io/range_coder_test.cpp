// The coder of LASzip: encoded values are decoded exactly, and invalid streams are detected.
#include "engine/io/range_coder.hpp"

#include <doctest/doctest.h>

#include "engine/io/integer_model.hpp"
#include "tests/io/laz_bytes.hpp"

namespace palpate::test::range_coder_test {

TEST_CASE("symbols, bits and integers of any probability are decoded as encoded, to the last byte") {
  for (const unsigned symbols : {2u, 16u, 17u, 64u, 256u, 516u}) {
    CAPTURE(symbols);
    Dice dice(symbols);
    std::vector<unsigned> values;
    for (int i = 0; i < 60'000; ++i)  // rare ones, runs, and all equal
      values.push_back(i % 20'000 < 7000 ? dice.below(symbols) : dice.oneIn(400) ? dice.below(symbols) : symbols - 1);
    RangeEncoder encoder;
    SymbolModel model(symbols), other(symbols);
    BitModel bit, otherBit;
    for (const unsigned value : values) {
      encoder.symbol(model, value);
      encoder.bit(bit, value % 7 == 0);
      if (value % 64 == 0) encoder.bits(1 + value % 32, value & ((1u << (1 + value % 31)) - 1) & 1u);
      if (value % 128 == 1) encoder.bits(32, 0xfffffff0u + value % 16);
    }
    const std::vector<std::byte> stream = encoder.finish();
    RangeDecoder decoder(stream);
    bool same = true;
    for (const unsigned value : values) {
      same = same && decoder.symbol(other) == value && decoder.bit(otherBit) == (value % 7 == 0);
      if (value % 64 == 0) same = same && decoder.bits(1 + value % 32) == (value & ((1u << (1 + value % 31)) - 1) & 1u);
      if (value % 128 == 1) same = same && decoder.bits(32) == 0xfffffff0u + value % 16;
    }
    CHECK(same);
    CHECK(decoder.left() == 0);
    CHECK(!decoder.isWrong());
    decoder.symbol(other);
    for (int k = 0; k < 100; ++k) decoder.bits(16);
    CHECK(decoder.isWrong());
  }
}

TEST_CASE("arbitrary bytes decode to existing symbols, and the range decoder reports an error") {
  for (const unsigned symbols : {2u, 17u, 256u, 516u})
    for (const unsigned kept : {0u, 1u, 2u, 3u, 4u, 64u}) {  // number of leading bytes that are 0xff
      CAPTURE(symbols);
      CAPTURE(kept);
      Dice dice(kept + 1);
      std::vector<std::byte> stream(64, std::byte{0xff});
      for (std::size_t k = kept; k < stream.size(); ++k) stream[k] = static_cast<std::byte>(dice.below(256));
      RangeDecoder decoder(stream);
      SymbolModel model(symbols);
      bool known = true;
      for (int k = 0; k < 5000; ++k) known = known && decoder.symbol(model) < symbols;
      CHECK(known);
      // If one of two symbols is so probable that it costs almost no bits, bytes may remain after 5000 symbols.
      for (int k = 0; k < 512; ++k) decoder.bits(1);
      CHECK(decoder.isWrong());
    }
}

TEST_CASE("a probable symbol takes fewer bits than an improbable one, close to the entropy") {
  RangeEncoder encoder;
  SymbolModel model(64);
  Dice dice(5);
  constexpr int kCount = 100'000;
  int rare = 0;
  for (int i = 0; i < kCount; ++i) {
    const bool isRare = dice.oneIn(10);
    rare += isRare;
    encoder.symbol(model, isRare ? 9 : 50);
  }
  const double share = static_cast<double>(rare) / kCount;
  const double bits = -kCount * (share * std::log2(share) + (1 - share) * std::log2(1 - share));
  const double used = 8.0 * static_cast<double>(encoder.finish().size());
  CHECK(used > bits);
  CHECK(used < 1.05 * bits);
}

TEST_CASE("numbers near and far from their prediction are decoded, in 16 bits and in 32") {
  for (const unsigned bits : {16u, 32u}) {
    std::vector<std::array<std::int32_t, 2>> pairs;  // expected, value
    const std::int32_t least = bits == 32 ? -2147483647 - 1 : 0, most = bits == 32 ? 2147483647 : 65535;
    for (const std::int32_t a : {least, least + 1, 0, 1, 2, 100, most - 1, most})
      for (const std::int32_t b : {least, least + 1, 0, 1, 2, 3, 99, 356, 357, most - 1, most}) pairs.push_back({a, b});
    Dice dice(bits);
    for (int i = 0; i < 20'000; ++i) {
      const auto a = static_cast<std::int32_t>(dice.below(bits == 32 ? 0xffffffffu : 65536u));
      const std::int32_t b = a / 2 + dice.upTo(1 << dice.below(14));
      pairs.push_back({a, bits == 32 ? b : std::clamp(b, 0, 65535)});
    }
    RangeEncoder encoder;
    IntegerModel model(bits, 3), other(bits, 3);
    unsigned context = 0;
    for (const auto& [expected, value] : pairs) model.code(encoder, expected, value, context++ % 3);
    const std::vector<std::byte> stream = encoder.finish();
    RangeDecoder decoder(stream);
    context = 0;
    bool same = true;
    for (const auto& [expected, value] : pairs) same = same && other.code(decoder, expected, 0, context++ % 3) == value;
    CHECK(same);
    CHECK(decoder.left() == 0);
    CHECK(!decoder.isWrong());
  }
}

}  // namespace palpate::test::range_coder_test
