// What a test case asks of a run, written beside the case: TEST_CASE("..." * kFull * kClock). A label that does not
// exist stops the build.
#pragma once

#include <doctest/doctest.h>

#include <array>
#include <cstdlib>
#include <string>
#include <string_view>

namespace palpate {

/// Labels are kept where the framework keeps a case's suite, so that its filters know them: `--test-suite='*full*'`.
struct CaseLabel {
  unsigned bit;

  static constexpr std::array<std::string_view, 4> kNames{"full", "more", "clock", "portable"};

  void fill(doctest::detail::TestCase& labelled) const { labelled.m_test_suite = with(labelled.m_test_suite); }
  void fill(doctest::detail::TestSuite& labelled) const { labelled.m_test_suite = with(labelled.m_test_suite); }

 private:
  const char* with(const char* before) const {
    static std::array<std::string, 1 << kNames.size()> words;  // the framework keeps pointers to them
    const std::string_view known = before ? before : "";
    std::size_t bits = 0;
    std::string text;
    for (std::size_t k = 0; k < kNames.size(); ++k) {
      if (k != bit && known.find(kNames[k]) == std::string_view::npos) continue;
      bits |= std::size_t{1} << k;
      text += (text.empty() ? "" : " ") + std::string(kNames[k]);
    }
    if (words[bits].empty()) words[bits] = text;
    return words[bits].c_str();
  }
};

/// Costs more than the quick tier allows (2 s of a core, 10 for a whole program). A smaller case that sends the same
/// code through the quick tier stands near it.
inline constexpr CaseLabel kFull{0};
/// Runs in both tiers, with more repetitions or points in the full one (byTier()).
inline constexpr CaseLabel kMoreInFull{1};
/// Measures real time: a machine that stands still for a moment fails it, so it has a second try, and the run says so.
inline constexpr CaseLabel kClock{2};
/// Runs within seconds on every driver; the legs of other drivers and layers run these cases alone.
inline constexpr CaseLabel kPortable{3};

inline bool inFullTier() {
  const auto is = [](const char* name) {
    const char* value = std::getenv(name);
    return value && std::string_view(value) == "full";
  };
  return is("PALPATE_TESTS_TIER") || is("PALPATE_TESTS_ONLY");
}

/// How many repetitions, points or ticks; the case is labelled kMoreInFull.
template <class T>
T byTier(T quick, T full) {
  return inFullTier() ? full : quick;
}

}  // namespace palpate
