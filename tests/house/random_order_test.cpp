// Compilers differ in which argument of a call they begin with, and random numbers come in an order: a call with two of
// them has other data on another system. In braces they come from left to right everywhere.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "tests/source_folder.hpp"

namespace palpate::random_order_test {

namespace {

namespace fs = std::filesystem;

/// What opens the list that a place of a text stands in; 0 where nothing does.
char openerOf(const std::string& text, std::size_t place) {
  int depth = 0;
  while (place-- > 0) {
    const char c = text[place];
    if (c == ')' || c == '}') ++depth;
    if ((c == '(' || c == '{') && depth-- == 0) return c;
  }
  return 0;
}

bool hasTwoInACall(const std::string& text) {
  static const std::regex kTwo(R"(\w+\((random|generator)\),\s*-?\w+\((random|generator)\))");
  for (std::sregex_iterator at(text.begin(), text.end(), kTwo), end; at != end; ++at)
    if (openerOf(text, static_cast<std::size_t>(at->position())) == '(') return true;
  return false;
}

}  // namespace

TEST_CASE("no call takes two random numbers, whose order would be the compiler's") {
  CHECK(hasTwoInACall("Vec3 p(unit(random), unit(random), 0);"));
  CHECK_FALSE(hasTwoInACall("Vec3 p{unit(random), unit(random), 0};"));
  std::size_t files = 0;
  for (const char* folder : {"apps", "engine", "haptics", "tests"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(sourceFolder() / folder)) {
      const fs::path& file = entry.path();
      if ((file.extension() != ".cpp" && file.extension() != ".hpp") || file.filename() == "random_order_test.cpp")
        continue;
      std::ifstream in(file);
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      CHECK_MESSAGE(!hasTwoInACall(text), file.string());
      ++files;
    }
  CHECK(files > 500);
}

}  // namespace palpate::random_order_test
