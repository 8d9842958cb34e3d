// Words replaced by technical terms: no identifier may contain them.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tests/source_folder.hpp"

namespace palpate::words_test {

namespace {

namespace fs = std::filesystem;

// Their replacements: request, state, reset, carry out, scheduling statistics, voxel sample, outlier, observer.
constexpr std::array<std::string_view, 13> kGone{"wish", "wishes", "story", "stories", "anew",   "afresh", "obey",
                                                 "toll", "gist",   "stray", "strays",  "umpire", "witness"};

bool isWordPart(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Identifiers of a text in C++ or GLSL, outside comments and quotes (on one line).
std::set<std::string> identifiersOf(std::string_view text) {
  std::set<std::string> found;
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    if (text.substr(i).starts_with("//")) {
      i = std::min(text.find('\n', i), text.size());
    } else if (c == '"' || c == '\'') {
      for (++i; i < text.size() && text[i] != c && text[i] != '\n'; ++i) i += text[i] == '\\' ? 1 : 0;
      ++i;
    } else if (isWordPart(c)) {
      const std::size_t begin = i;
      while (i < text.size() && (isWordPart(text[i]) || (text[i] == '\'' && std::isdigit(text[begin]) != 0))) ++i;
      found.emplace(text.substr(begin, i - begin));
    } else {
      ++i;
    }
  }
  return found;
}

// "kMaxStrays_mm": k, max, strays, mm.
std::vector<std::string> wordsOf(std::string_view identifier) {
  std::vector<std::string> words;
  bool begins = true;
  for (const char c : identifier) {
    const auto letter = static_cast<unsigned char>(c);
    if (std::isalpha(letter) == 0) {
      begins = true;
      continue;
    }
    if (begins || std::isupper(letter) != 0) words.emplace_back();
    words.back() += static_cast<char>(std::tolower(letter));
    begins = false;
  }
  return words;
}

bool hasGoneWord(std::string_view identifier) {
  return std::ranges::any_of(wordsOf(identifier),
                             [](const std::string& word) { return std::ranges::find(kGone, word) != kGone.end(); });
}

bool isSource(const fs::path& file) {
  static const std::set<std::string> endings{".cpp", ".hpp", ".h", ".cu", ".cuh", ".comp", ".glsl", ".vert", ".frag"};
  return endings.contains(file.extension().string());
}

// Public names that were replaced (haptics/library/CHANGES.md), so that each thing has one name.
constexpr std::array<std::string_view, 44> kReplaced{"PP_MOST_HANDS",
                                                     "pp_feel",
                                                     "pp_default_feel",
                                                     "pp_session_set_feel",
                                                     "pp_session_follow",
                                                     "pp_live_take",
                                                     "pp_session_hold",
                                                     "pp_session_others",
                                                     "pp_session_show_camera",
                                                     "pp_cloud_copy_places",
                                                     "pp_log",
                                                     "pp_log_read",
                                                     "pp_log_view",
                                                     "pp_log_close",
                                                     "pp_log_replay",
                                                     "pp_seen_session",
                                                     "pp_network_survey",
                                                     "most_points",
                                                     "keeps_points",
                                                     "keeps_density",
                                                     "keepsDensity",
                                                     "tau_mm",
                                                     "all_points",
                                                     "allPoints",
                                                     "undoable",
                                                     "redoable",
                                                     "left_out_s",
                                                     "patience_s",
                                                     "near_hands",
                                                     "openness",
                                                     "at_rest",
                                                     "show_camera",
                                                     "SeenSession",
                                                     "allow_python",
                                                     "read_log",
                                                     "skipped_edits",
                                                     "index_builds",
                                                     "second_hand",
                                                     "fresh_share",
                                                     "not_compared_because",
                                                     "up_why",
                                                     "mostly_ends",
                                                     "fps_made_anew",
                                                     "goOn_s"};

// Those of a text, each with its line.
std::vector<std::string> replacedIn(std::string_view text) {
  std::vector<std::string> found;
  std::size_t line = 1;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t begin = i;
    while (i < text.size() && isWordPart(text[i])) ++i;
    if (i == begin)
      line += text[i++] == '\n' ? 1 : 0;
    else if (const auto word = text.substr(begin, i - begin); std::ranges::find(kReplaced, word) != kReplaced.end())
      found.push_back(std::to_string(line) + ": " + std::string(word));
  }
  return found;
}

// Words of a dialect that comments, messages and documents were once written in.
constexpr std::array<std::string_view, 6> kDialect{"whoever", "whosoever", "nobody", "somebody", "anew", "afresh"};

// The words of a text that are in the dialect, each with its line.
std::vector<std::string> dialectIn(std::string_view text) {
  std::vector<std::string> found;
  std::size_t line = 1;
  for (std::size_t i = 0; i < text.size();) {
    if (!isWordPart(text[i])) {
      line += text[i++] == '\n' ? 1 : 0;
      continue;
    }
    std::string word;
    for (; i < text.size() && isWordPart(text[i]); ++i)
      word += static_cast<char>(std::tolower(static_cast<unsigned char>(text[i])));
    if (std::ranges::find(kDialect, word) != kDialect.end()) found.push_back(std::to_string(line) + ": " + word);
  }
  return found;
}

}  // namespace

TEST_CASE("no identifier contains a word that was replaced by a technical term") {
  const fs::path top = sourceFolder();
  if (!fs::exists(top / "engine")) {
    MESSAGE("skipped: the sources are not at " << top.string());
    return;
  }
  std::size_t identifiers = 0;
  for (const char* folder : {"engine", "haptics", "shaders", "apps", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
      if (!entry.is_regular_file() || !isSource(entry.path())) continue;
      std::ifstream in(entry.path());
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      for (const std::string& identifier : identifiersOf(text)) {
        ++identifiers;
        CHECK_MESSAGE(!hasGoneWord(identifier), fs::relative(entry.path(), top).string() << ": " << identifier);
      }
    }
  }
  CHECK(identifiers > 10'000);
}

TEST_CASE("comments, messages and documents are plain English") {
  const fs::path top = sourceFolder();
  if (!fs::exists(top / "engine")) {
    MESSAGE("skipped: the sources are not at " << top.string());
    return;
  }
  std::size_t files = 0;
  for (const char* folder : {".github", "engine", "haptics", "shaders", "apps", "third_party"}) {
    for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
      const std::string ending = entry.path().extension().string();
      if (!entry.is_regular_file() || !(isSource(entry.path()) || ending == ".md" || ending == ".py")) continue;
      std::ifstream in(entry.path());
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      ++files;
      for (const std::string& word : dialectIn(text))
        FAIL_CHECK(fs::relative(entry.path(), top).string() << ":" << word);
    }
  }
  CHECK(files > 900);
  CHECK(dialectIn("// Nobody\n// knows it anew\nint renewed, nobody_s;") ==
        std::vector<std::string>{"1: nobody", "2: anew"});
}

TEST_CASE("a public name that was replaced is used nowhere, so that each thing has one name") {
  const fs::path top = sourceFolder();
  if (!fs::exists(top / "engine")) {
    MESSAGE("skipped: the sources are not at " << top.string());
    return;
  }
  static const std::set<std::string> endings{".md", ".py", ".pyi", ".sh", ".c", ".cs", ".rst", ".patch", ".txt"};
  std::size_t files = 0;
  for (const char* folder : {"engine", "haptics", "shaders", "apps", "tests"}) {
    for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
      const std::string name = entry.path().filename().string();
      if (!entry.is_regular_file() || name == "CHANGES.md" || name == "words_test.cpp") continue;
      if (!isSource(entry.path()) && !endings.contains(entry.path().extension().string())) continue;
      std::ifstream in(entry.path());
      const std::string text{std::istreambuf_iterator<char>(in), {}};
      ++files;
      for (const std::string& word : replacedIn(text))
        FAIL_CHECK(fs::relative(entry.path(), top).string() << ":" << word);
    }
  }
  CHECK(files > 1500);
  CHECK(replacedIn("int a;\nb.tau_mm = pp_log_function;") == std::vector<std::string>{"2: tau_mm"});
}

TEST_CASE("a replaced word is found in an identifier, but not in a comment, a string or a longer word") {
  CHECK(hasGoneWord("parseWishes"));
  CHECK(hasGoneWord("kMaxStrays_mm"));
  CHECK(hasGoneWord("edits_built_anew"));
  CHECK_FALSE(hasGoneWord("history"));
  CHECK_FALSE(hasGoneWord("registers"));
  CHECK(identifiersOf("int a = 1'000;  // a wish\nsay(\"built_\\\"anew\", 'b');") ==
        std::set<std::string>{"1'000", "a", "int", "say"});
}

}  // namespace palpate::words_test
