// LZF as compressed PCD files have it, made by hand for the tests of the reader.
#pragma once

#include <algorithm>
#include <string>

namespace palpate::test {

/// Packs what repeats the four bytes before it, and nothing else.
inline std::string packedLzf(const std::string& bytes) {
  constexpr std::size_t kBack = 4, kMostLiteral = 32, kMostRun = 264, kLeastRun = 9;
  std::string out, literal;
  const auto flush = [&] {
    for (std::size_t at = 0; at < literal.size(); at += kMostLiteral) {
      const std::string piece = literal.substr(at, kMostLiteral);
      out += static_cast<char>(piece.size() - 1);
      out += piece;
    }
    literal.clear();
  };
  for (std::size_t at = 0; at < bytes.size();) {
    std::size_t run = 0;
    while (at >= kBack && at + run < bytes.size() && run < kMostRun && bytes[at + run] == bytes[at + run - kBack])
      ++run;
    if (run < kLeastRun) {
      literal += bytes[at++];
      continue;
    }
    flush();
    out += static_cast<char>(7 << 5);
    out += static_cast<char>(run - kLeastRun);
    out += static_cast<char>(kBack - 1);
    at += run;
  }
  flush();
  return out;
}

}  // namespace palpate::test
