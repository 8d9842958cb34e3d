#include "engine/core/characters.hpp"

#include <doctest/doctest.h>

namespace palpate::characters_test {

TEST_CASE("UTF-8 text is decoded into characters, and damaged text ends too") {
  using Characters = std::vector<char32_t>;
  CHECK(charactersOf("aé λ 模") == Characters{'a', 0xe9, ' ', 0x3bb, ' ', 0x6a21});
  CHECK(charactersOf("\xf0\x9f\x98\x80") == Characters{0x1f600});
  CHECK(charactersOf("\xe6\xa8") == Characters{0xfffd, 0xfffd});
  CHECK(charactersOf("\xff!") == Characters{0xfffd, '!'});
  CHECK(charactersOf("\xc3(") == Characters{0xfffd, '('});
  CHECK(charactersOf("").empty());
}

}  // namespace palpate::characters_test
