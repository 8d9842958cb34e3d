// The evaluation order of a call's arguments is unspecified, so that a call with two random numbers has different data
// with another compiler. In braces the order is from left to right.
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

/// The bracket that opens the list around an offset of a text; 0 if there is none.
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

TEST_CASE("no call has two random arguments, whose order would depend on the compiler") {
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
