// PALPATE_TESTS_TIER=full runs every case; without it, the quick tier runs those that are not labelled full.
// PALPATE_TESTS_ONLY=LABEL runs only the cases with that label (labels.hpp).
#define DOCTEST_CONFIG_IMPLEMENT
#ifndef _WIN32
#define DOCTEST_CONFIG_NO_POSIX_SIGNALS  // last_words.hpp handles them
#endif
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>

#include "tests/case_results.hpp"
#include "tests/labels.hpp"
#include "tests/last_words.hpp"
#include "tests/until_end.hpp"

namespace palpate {

namespace {

std::string asked(const char* variable) {
  const char* value = std::getenv(variable);
  return value ? value : "";
}

void chooseCases(doctest::Context& context) {
  const std::string only = asked("PALPATE_TESTS_ONLY");
  if (!only.empty()) context.addFilter("test-suite", ("*" + only + "*").c_str());
  if (only == "full") context.addFilter("test-suite", "*more*");
  if (!inFullTier()) context.addFilter("test-suite-exclude", "*full*");
}

/// Reruns the failed cases once if all of them measure a clock.
bool passAtSecondTry() {
  const std::vector<FailedCase> failed = takeFailedCases();
  if (failed.empty() || !std::ranges::all_of(failed, &FailedCase::measuresClock)) return false;
  doctest::Context again;
  for (const FailedCase& each : failed) {
    std::cout << "second try: " << each.name << std::endl;
    std::string name;
    for (const char c : each.name) name += c == ',' ? std::string("\\,") : std::string(1, c);
    again.addFilter("test-case", name.c_str());
  }
  return again.run() == 0;
}

}  // namespace

}  // namespace palpate

int main(int count, char** words) {
  palpate::sayLastWords();
  doctest::Context context(count, words);
  palpate::chooseCases(context);
  int result = context.run();
  if (result != 0 && !context.shouldExit() && palpate::passAtSecondTry()) result = 0;
  auto& kept = palpate::keptUntilEnd();
  while (!kept.empty()) kept.pop_back();  // in reverse order
  return result;
}
