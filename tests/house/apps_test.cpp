// The programs use sessions: none refers to a back end or the servo loop, which a session combines.
#include <doctest/doctest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/source_folder.hpp"

namespace palpate::apps_test {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kForbidden[] = {"TouchSide", "CpuTouch", "CudaTouch", "ServoLoop", "dynamic_cast"};

bool isOfName(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

bool namesWord(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !isOfName(text[at - 1])) && (end == text.size() || !isOfName(text[end]))) return true;
  }
  return false;
}

std::vector<std::string_view> forbiddenIn(std::string_view text) {
  std::vector<std::string_view> found;
  for (const std::string_view word : kForbidden)
    if (namesWord(text, word)) found.push_back(word);
  return found;
}

}  // namespace

TEST_CASE("no program names a back end's class or a servo loop, or tests an object's dynamic type") {
  const fs::path top = sourceFolder();
  if (!fs::exists(top / "apps")) {
    MESSAGE("skipped: the sources are not at " << top.string());
    return;
  }
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(top / "apps")) {
    const std::string ending = entry.path().extension().string();
    if (!entry.is_regular_file() || (ending != ".cpp" && ending != ".hpp")) continue;
    ++files;
    std::stringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    for (const std::string_view word : forbiddenIn(text.str()))
      FAIL_CHECK(fs::relative(entry.path(), top).generic_string() << " uses " << word);
  }
  CHECK(files > 50);
}

TEST_CASE("a forbidden word is found as a whole word, not as part of another one") {
  CHECK(forbiddenIn("auto& side = dynamic_cast<TouchSide&>(backend);").size() == 2);
  CHECK(forbiddenIn("ServoLoop loop(hand, query);").size() == 1);
  CHECK(forbiddenIn("std::unique_ptr<TouchBackend> backend; ServoLoops").empty());
}

}  // namespace palpate::apps_test
