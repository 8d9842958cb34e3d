#define DOCTEST_CONFIG_IMPLEMENT
#ifndef _WIN32
#define DOCTEST_CONFIG_NO_POSIX_SIGNALS  // last_words.hpp has them
#endif
#include <doctest/doctest.h>

#include "tests/last_words.hpp"
#include "tests/until_end.hpp"

int main(int count, char** words) {
  palpate::sayLastWords();
  doctest::Context context(count, words);
  const int result = context.run();
  auto& kept = palpate::keptUntilEnd();
  while (!kept.empty()) kept.pop_back();  // the last one first
  return result;
}
