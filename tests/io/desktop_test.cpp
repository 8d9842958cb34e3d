// File types and program entry that the desktop receives for the formats that are read.
#include <doctest/doctest.h>

#include <fstream>
#include <regex>
#include <set>

#include "engine/io/cloud_formats.hpp"
#include "tests/source_folder.hpp"

namespace palpate::test::desktop_test {

namespace {

std::string packaged(const char* name) {
  std::ifstream file(sourceFolder() / "third_party" / "debian" / name);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::set<std::string> matches(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), regex), end; at != end; ++at) found.insert((*at)[1]);
  return found;
}

}  // namespace

TEST_CASE("the desktop knows every ending that is read, and offers the program for each of its types") {
  const std::string types = packaged("palpate.xml"), entry = packaged("palpate.desktop");
  const std::set<std::string> patterns = matches(types, "<glob pattern=\"\\*([^\"]+)\"/>");
  // Every desktop defines these types; the program is not to become the default for general text.
  const std::set<std::string> elsewhere{".txt", ".csv"};
  std::set<std::string> endings;
  for (const CloudFormat& format : cloudFormats().all())
    for (const std::string_view ending : format.endings) {
      CAPTURE(std::string(ending));
      endings.emplace(ending);
      CHECK(patterns.contains(std::string(ending)) != elsewhere.contains(std::string(ending)));
    }
  for (const std::string& pattern : patterns) CHECK_MESSAGE(endings.contains(pattern), pattern);
  const std::string offered = *matches(entry, "MimeType=([^\n]+)\n").begin();
  const std::set<std::string> named = matches(types, "<mime-type type=\"([^\"]+)\">");
  CHECK(named.size() > 10);
  for (const std::string& type : named) CHECK_MESSAGE(offered.find(type + ";") != std::string::npos, type);
  CHECK(offered.find("text/csv;") != std::string::npos);
}

}  // namespace palpate::test::desktop_test
