// The documents for newcomers: their links lead to files, and the front page is short.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "tests/source_folder.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = palpate::sourceFolder();

std::string textOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<fs::path> documents() {
  std::vector<fs::path> found{kRoot / "README.md"};
  for (const char* room : {".github", "apps", "engine", "haptics", "shaders", "tests", "third_party"})
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / room))
      if (entry.path().extension() == ".md") found.push_back(entry.path());
  return found;
}

// Targets of the links and pictures of a text that are files.
std::vector<std::string> linksOf(const std::string& text) {
  static const std::regex link(R"(\]\(([^)#]+)\))");
  std::vector<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at)
    if (!(*at)[1].str().starts_with("http")) found.push_back((*at)[1]);
  return found;
}

}  // namespace

TEST_CASE("every link of a document leads to a file") {
  const auto all = documents();
  CHECK(all.size() > 8);
  std::size_t links = 0;
  for (const fs::path& document : all)
    for (const std::string& link : linksOf(textOf(document))) {
      ++links;
      CHECK_MESSAGE(fs::exists(document.parent_path() / link), document.string() << ": " << link);
    }
  CHECK(links > 30);
  CHECK(linksOf("see [one](a/b.md), ![two](c.png) and [three](#here)") == std::vector<std::string>{"a/b.md", "c.png"});
}

TEST_CASE("the front page is short") {
  const std::string text = textOf(kRoot / "README.md");
  CHECK(std::ranges::count(text, '\n') <= 120);
}
