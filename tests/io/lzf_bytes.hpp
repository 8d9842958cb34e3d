// LZF as in compressed PCD files, made by hand for the tests of the reader.
#pragma once

#include <algorithm>
#include <string>

namespace palpate::test {

/// Compresses repetitions of the preceding four bytes, and nothing else.
inline std::string packedLzf(const std::string& bytes) {
  constexpr std::size_t kBack = 4, kMaxLiteral = 32, kMaxRun = 264, kMinRun = 9;
  std::string out, literal;
  const auto flush = [&] {
    for (std::size_t at = 0; at < literal.size(); at += kMaxLiteral) {
      const std::string piece = literal.substr(at, kMaxLiteral);
      out += static_cast<char>(piece.size() - 1);
      out += piece;
    }
    literal.clear();
  };
  for (std::size_t at = 0; at < bytes.size();) {
    std::size_t run = 0;
    while (at >= kBack && at + run < bytes.size() && run < kMaxRun && bytes[at + run] == bytes[at + run - kBack]) ++run;
    if (run < kMinRun) {
      literal += bytes[at++];
      continue;
    }
    flush();
    out += static_cast<char>(7 << 5);
    out += static_cast<char>(run - kMinRun);
    out += static_cast<char>(kBack - 1);
    at += run;
  }
  flush();
  return out;
}

}  // namespace palpate::test
