#pragma once

#include <doctest/doctest.h>

#include <string>

namespace palpate {

/// Whether `part` stands in `text`; shows the text where it does not.
inline bool says(const std::string& text, const std::string& part) {
  if (text.find(part) != std::string::npos) return true;
  MESSAGE(text);
  return false;
}

}  // namespace palpate
