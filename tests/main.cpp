#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "tests/until_end.hpp"

int main(int count, char** words) {
  doctest::Context context(count, words);
  const int result = context.run();
  auto& kept = palpate::keptUntilEnd();
  while (!kept.empty()) kept.pop_back();  // the last one first
  return result;
}
