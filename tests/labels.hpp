// Requirements of a test case, written beside the case: TEST_CASE("..." * kFull * kClock). An unknown label stops the
// build.
#pragma once

#include <doctest/doctest.h>

#include <array>
#include <cstdlib>
#include <string>
#include <string_view>

namespace palpate {

/// Labels are stored as the framework's test suite of a case, so that its filters apply: `--test-suite='*full*'`.
struct CaseLabel {
  unsigned bit;

  static constexpr std::array<std::string_view, 4> kNames{"full", "more", "clock", "portable"};

  void fill(doctest::detail::TestCase& labelled) const { labelled.m_test_suite = with(labelled.m_test_suite); }
  void fill(doctest::detail::TestSuite& labelled) const { labelled.m_test_suite = with(labelled.m_test_suite); }

 private:
  const char* with(const char* before) const {
    static std::array<std::string, 1 << kNames.size()> words;  // the framework stores pointers to them
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

/// Exceeds the quick tier's limit (2 s of a core, 10 for a whole program). A smaller case nearby covers the same code
/// in the quick tier.
inline constexpr CaseLabel kFull{0};
/// Runs in both tiers, with more repetitions or points in the full one (byTier()).
inline constexpr CaseLabel kMoreInFull{1};
/// Measures real time: it fails if the machine stalls for a moment, so it has a second try, which the run reports.
inline constexpr CaseLabel kClock{2};
/// Runs within seconds on every driver; the legs of other drivers and layers run only these cases.
inline constexpr CaseLabel kPortable{3};

inline bool inFullTier() {
  const auto is = [](const char* name) {
    const char* value = std::getenv(name);
    return value && std::string_view(value) == "full";
  };
  return is("PALPATE_TESTS_TIER") || is("PALPATE_TESTS_ONLY");
}

/// Number of repetitions, points or ticks; the case is labelled kMoreInFull.
template <class T>
T byTier(T quick, T full) {
  return inFullTier() ? full : quick;
}

}  // namespace palpate
