#pragma once

#include <doctest/doctest.h>

#include <string>

namespace palpate {

/// Whether `text` contains `part`; prints the text if not.
inline bool says(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return true;
  MESSAGE(text);
  return false;
}

}  // namespace palpate
