// What runs fewer repetitions under sanitizers runs all of them elsewhere.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

#include "tests/source_folder.hpp"

namespace palpate {

namespace {

namespace fs = std::filesystem;

std::string contentOf(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Entries are named after a room and a file.
std::set<std::string> named() {
  const std::string list = contentOf(sourceFolder() / "tests/CMakeLists.txt");
  std::smatch found;
  REQUIRE(std::regex_search(list, found, std::regex(R"(\nset\(full_in_plain ([^)]*)\))")));
  const std::string names = found[1];
  static const std::regex kWord(R"(\S+)");
  std::set<std::string> entries;
  for (std::sregex_iterator at(names.begin(), names.end(), kWord), end; at != end; ++at) entries.insert(at->str());
  return entries;
}

std::set<std::string> thatRunFewer() {
  std::set<std::string> entries;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(sourceFolder() / "tests")) {
    const fs::path& file = entry.path();
    const std::string stem = file.stem().string(), room = file.parent_path().filename().string();
    if (!entry.is_regular_file() || room == "house") continue;
    if (contentOf(file).find("#include \"tests/under_sanitizers.hpp\"") == std::string::npos) continue;
    CHECK_MESSAGE(file.string().ends_with("_test.cpp"), file.string());
    entries.insert(room + "." + stem.substr(0, stem.rfind("_test")));
  }
  return entries;
}

}  // namespace

TEST_CASE("each test that runs fewer repetitions under sanitizers is one that runs all of them in another leg") {
  if (!fs::exists(sourceFolder() / "tests/CMakeLists.txt")) {
    MESSAGE("skipped: the sources are not at " << sourceFolder().string());
    return;
  }
  const std::set<std::string> entries = thatRunFewer();
  CHECK(!entries.empty());
  CHECK(entries == named());
}

}  // namespace palpate
