// Assertions that cannot fail prove nothing: no test may use doctest's Approx or WARN, and each case must contain an
// assertion or call a function that does.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tests/source_folder.hpp"

namespace palpate::assertions_test {

namespace {

namespace fs = std::filesystem;

// Functions that assert and are not named "check...".
constexpr std::array<std::string_view, 5> kAsserting{"attacked", "attackedNear", "compareBackends", "refuses", "works"};

// Cases without an assertion, which another case runs in a process of its own to test how it ends.
constexpr std::array<std::string_view, 3> kRunByOthers{"helper: hangs", "helper: takes two seconds",
                                                       "helper: takes two seconds, again"};

bool isWordPart(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// The text with comments, strings and characters replaced by blanks; lines and offsets stay.
std::string codeOf(std::string_view text) {
  std::string code(text);
  const auto blank = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < std::min(to, code.size()); ++i)
      if (code[i] != '\n') code[i] = ' ';
  };
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    std::size_t end = i + 1;
    if (text.substr(i).starts_with("//")) {
      end = std::min(text.find('\n', i), text.size());
    } else if (text.substr(i).starts_with("/*")) {
      end = std::min(text.find("*/", i), text.size() - 2) + 2;
    } else if (text.substr(i).starts_with("R\"")) {
      const std::string close = ")" + std::string(text.substr(i + 2, text.find('(', i) - i - 2)) + "\"";
      end = std::min(text.find(close, i), text.size()) + close.size();
    } else if (c == '"' || (c == '\'' && (i == 0 || !isWordPart(text[i - 1])))) {
      while (end < text.size() && text[end] != c && text[end] != '\n') end += text[end] == '\\' ? 2 : 1;
      ++end;
    } else {
      ++i;
      continue;
    }
    blank(i, end);
    i = end;
  }
  return code;
}

std::vector<std::string_view> identifiersOf(std::string_view code) {
  std::vector<std::string_view> found;
  for (std::size_t i = 0; i < code.size();) {
    const std::size_t begin = i;
    while (i < code.size() && isWordPart(code[i])) ++i;
    if (i > begin) found.push_back(code.substr(begin, i - begin));
    if (i == begin) ++i;
  }
  return found;
}

bool isOneOf(std::string_view word, std::string_view stem) {
  if (word.starts_with("DOCTEST_")) word.remove_prefix(8);
  return word == stem || (word.starts_with(stem) && word[stem.size()] == '_');
}

// Why the code is forbidden, if it contains such an identifier.
std::optional<std::string> forbiddenIn(std::string_view code) {
  for (const std::string_view word : identifiersOf(code)) {
    if (word == "Approx") return "Approx accepts epsilon * (1 + |value|); use near() or within() of tests/near.hpp";
    if (isOneOf(word, "WARN")) return std::string(word) + " fails no test; use CHECK, or MESSAGE for a figure";
  }
  return std::nullopt;
}

bool isAssertion(std::string_view word) {
  if (word.starts_with("PP_")) word.remove_prefix(3);  // tests/library/serving.hpp
  return isOneOf(word, "CHECK") || isOneOf(word, "REQUIRE") || isOneOf(word, "FAIL");
}

// checkSorts, but not checked or checksum.
bool isNamedCheck(std::string_view word) {
  return word.starts_with("check") && (word.size() == 5 || std::isupper(static_cast<unsigned char>(word[5])) != 0);
}

bool isKnownToAssert(std::string_view word) {
  return isNamedCheck(word) || std::ranges::find(kAsserting, word) != kAsserting.end();
}

bool asserts(std::string_view body) {
  return std::ranges::any_of(identifiersOf(body),
                             [](std::string_view word) { return isAssertion(word) || isKnownToAssert(word); });
}

// Offset after the bracket that closes the one at `open`.
std::size_t closeOf(std::string_view code, std::size_t open) {
  const char opens = code[open], closes = opens == '(' ? ')' : '}';
  int depth = 0;
  for (std::size_t i = open; i < code.size(); ++i) {
    depth += code[i] == opens ? 1 : code[i] == closes ? -1 : 0;
    if (depth == 0) return i + 1;
  }
  return code.size();
}

struct Body {
  std::string name;
  std::string_view code;
};

// Cases of a text and the code between their braces; `code` is codeOf() of the text.
std::vector<Body> casesOf(std::string_view text, std::string_view code) {
  std::vector<Body> cases;
  for (std::size_t at = code.find("TEST_CASE"); at != std::string_view::npos; at = code.find("TEST_CASE", at + 1)) {
    const std::size_t open = code.find('(', at), close = closeOf(code, open), brace = code.find('{', close);
    const std::size_t quote = text.find('"', open);
    if (brace == std::string_view::npos || quote > close) continue;
    cases.push_back({std::string(text.substr(quote + 1, text.find('"', quote + 1) - quote - 1)),
                     code.substr(brace, closeOf(code, brace) - brace)});
  }
  return cases;
}

// Functions that are defined in a text: a name, parentheses and a body.
std::vector<Body> functionsOf(std::string_view code) {
  std::vector<Body> functions;
  for (const std::string_view word : identifiersOf(code)) {
    if (!isKnownToAssert(word)) continue;
    const auto end = static_cast<std::size_t>(word.data() + word.size() - code.data());
    if (end >= code.size() || code[end] != '(') continue;
    std::size_t brace = closeOf(code, end);
    while (brace < code.size() && std::isspace(static_cast<unsigned char>(code[brace])) != 0) ++brace;
    for (const std::string_view qualifier : {"const ", "noexcept "})
      if (code.substr(brace).starts_with(qualifier)) brace += qualifier.size();
    if (brace < code.size() && code[brace] == '{')
      functions.push_back({std::string(word), code.substr(brace, closeOf(code, brace) - brace)});
  }
  return functions;
}

struct Source {
  std::string name, text, code;
};

std::vector<Source> sources() {
  std::vector<Source> all;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(sourceFolder() / "tests")) {
    const std::string ending = entry.path().extension().string();
    if (!entry.is_regular_file() || (ending != ".cpp" && ending != ".hpp")) continue;
    std::ifstream in(entry.path());
    std::string text{std::istreambuf_iterator<char>(in), {}};
    std::string code = codeOf(text);
    all.push_back({fs::relative(entry.path(), sourceFolder()).string(), std::move(text), std::move(code)});
  }
  return all;
}

bool hasSources() {
  if (fs::exists(sourceFolder() / "tests/near.hpp")) return true;
  MESSAGE("skipped: the sources are not at " << sourceFolder().string());
  return false;
}

}  // namespace

TEST_CASE("no test compares by Approx or contains an assertion that only warns") {
  if (!hasSources()) return;
  const std::vector<Source> all = sources();
  CHECK(all.size() > 300);
  for (const Source& source : all) {
    const std::optional<std::string> forbidden = forbiddenIn(source.code);
    CHECK_MESSAGE(!forbidden, source.name << ": " << forbidden.value_or(""));
  }
}

TEST_CASE("each test case contains an assertion or calls a function that does") {
  if (!hasSources()) return;
  std::size_t cases = 0;
  std::set<std::string> without;
  for (const Source& source : sources()) {
    for (const Body& one : casesOf(source.text, source.code)) {
      ++cases;
      if (asserts(one.code)) continue;
      const bool isNamed = std::ranges::find(kRunByOthers, one.name) != kRunByOthers.end();
      CHECK_MESSAGE(isNamed, source.name << ": \"" << one.name << "\" asserts nothing");
      without.insert(one.name);
    }
  }
  CHECK(cases > 1500);
  CHECK(without == std::set<std::string>(kRunByOthers.begin(), kRunByOthers.end()));
}

TEST_CASE("each definition of a function that counts as asserting contains an assertion") {
  if (!hasSources()) return;
  std::map<std::string, std::size_t> definitions;
  for (const Source& source : sources()) {
    for (const Body& one : functionsOf(source.code)) {
      ++definitions[one.name];
      CHECK_MESSAGE(asserts(one.code), source.name << ": " << one.name << "() asserts nothing");
    }
  }
  CHECK(definitions.size() > 80);
  for (const std::string_view name : kAsserting) CHECK_MESSAGE(definitions.contains(std::string(name)), name);
}

TEST_CASE("a forbidden identifier is found in code, but not in comments, strings or longer words") {
  CHECK(forbiddenIn(codeOf("CHECK(x == doctest::Approx(5).epsilon(0.1));")));
  CHECK(forbiddenIn(codeOf("CHECK(x == Approx(5).scale(0));")));
  for (const char* macro : {"WARN", "WARN_EQ", "WARN_MESSAGE", "DOCTEST_WARN", "WARN_THROWS_AS"})
    CHECK_MESSAGE(forbiddenIn(std::string(macro) + "(a == b);"), macro);
  CHECK_FALSE(forbiddenIn(codeOf("CHECK(x == near(5, 0.1));  // not Approx")));
  CHECK_FALSE(forbiddenIn(codeOf("say(\"WARN(x)\", R\"--(Approx\n\")--\"); /* WARN(y)\n */ const int n = 1'000;")));
  CHECK_FALSE(forbiddenIn("WARNING(x); Approximation(y);"));
}

TEST_CASE("a test case without an assertion is found by name") {
  const auto silent = [](const std::string& text) {
    std::vector<std::string> names;
    const std::string code = codeOf(text);
    for (const Body& one : casesOf(text, code))
      if (!asserts(one.code)) names.push_back(one.name);
    return names;
  };
  using Names = std::vector<std::string>;
  CHECK(silent("TEST_CASE(\"a\") { const int x = f(); MESSAGE(x); }") == Names{"a"});
  CHECK(silent("TEST_CASE_FIXTURE(Fixture, \"b\") { g(\"CHECK(1)\"); }  // CHECK(1)") == Names{"b"});
  CHECK(silent("TEST_CASE_TEMPLATE(\"c\", Real, float, double) { checked(); }\nvoid h() { CHECK(1); }") == Names{"c"});
  CHECK(silent("TEST_CASE(\"d\") { PALPATE_CHECK(true); }") == Names{"d"});  // ends the program, which proves nothing
  CHECK(silent("TEST_CASE(\"e\") { if (a) { CHECK(b); } }").empty());
  CHECK(silent("TEST_CASE(\"e\" * doctest::skip()) { checkSorts(keys); }").empty());
  CHECK(silent("TEST_CASE(\"f\") { works(\"info\"); }\nTEST_CASE(\"g\") { PP_REQUIRE_OK(f()); }").empty());
}

TEST_CASE("a function that counts as asserting but does not is found; calls of it are not") {
  const auto silent = [](const std::string& text) {
    std::size_t count = 0;
    const std::string code = codeOf(text);
    for (const Body& one : functionsOf(code)) count += asserts(one.code) ? 0 : 1;
    return count;
  };
  CHECK(silent("void checkSorts(const Keys& keys) {\n  sort(keys);\n}") == 1);
  CHECK(silent("bool works(const std::string& line) const { return run(line) == 0; }") == 1);
  CHECK(silent("void checkSorts(int keys) { CHECK(sort(keys)); }\nvoid f() { checkSorts(1); }") == 0);
  CHECK(silent("void checkAll(int n) { for (int i = 0; i < n; ++i) checkOne(i); }") == 0);
}

}  // namespace palpate::assertions_test
