// Which cases a test program runs and how it reports them, with a program that contains a case of each kind.
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

#include "tests/content_of.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate {

namespace {

struct Run {
  int code = 0;
  std::string text, results;
};

Run runCases(const std::string& surroundings) {
  const ScratchFolder folder;
  const auto results = folder / "results";
  const std::string command = "env -u PALPATE_TESTS_TIER -u PALPATE_TESTS_ONLY PALPATE_TESTS_RESULTS='" +
                              results.string() + "' " + surroundings + " " PALPATE_LABELLED_CASES " -s 2>&1";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe);
  Run run;
  std::array<char, 4096> piece;
  while (const std::size_t size = std::fread(piece.data(), 1, piece.size(), pipe)) run.text.append(piece.data(), size);
  const int status = ::pclose(pipe);
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  run.results = contentOf(results);
  return run;
}

bool lacks(const std::string& text, const std::string& part) { return text.find(part) == std::string::npos; }

bool ran(const Run& run, const std::string& name) { return says(run.results, "passed\t") && says(run.results, name); }

}  // namespace

TEST_CASE("the quick tier leaves out the cases of the full tier and runs fewer repetitions") {
  const Run quick = runCases("");
  CHECK(quick.code == 0);
  CHECK(ran(quick, "programs/labelled_cases.cpp\tplain\n"));
  CHECK(ran(quick, "portable\tprograms/labelled_cases.cpp\ton every driver\n"));
  CHECK(lacks(quick.results, "of the full tier\n"));
  CHECK(says(quick.text, "repetitions: 3\n"));
  const Run full = runCases("PALPATE_TESTS_TIER=full");
  CHECK(full.code == 0);
  CHECK(ran(full, "full\tprograms/labelled_cases.cpp\tof the full tier\n"));
  CHECK(ran(full, "\tplain\n"));
  CHECK(says(full.text, "repetitions: 30\n"));
}

TEST_CASE("a leg with a label runs only the cases with that label") {
  const Run portable = runCases("PALPATE_TESTS_ONLY=portable");
  CHECK(portable.code == 0);
  CHECK(ran(portable, "\ton every driver\n"));
  CHECK(lacks(portable.results, "plain\n"));
  CHECK(lacks(portable.results, "of the full tier\n"));
  const Run truths = runCases("PALPATE_TESTS_ONLY=full");
  CHECK(truths.code == 0);
  CHECK(ran(truths, "full portable\tprograms/labelled_cases.cpp\ton every driver, of the full tier\n"));
  CHECK(says(truths.text, "repetitions: 30\n"));
  CHECK(lacks(truths.results, "plain\n"));
}

TEST_CASE("a skipped check is reported with its reason") {
  CHECK(says(runCases("").results, "\ton every driver\n"));
  CHECK(says(runCases("").results, "\tskipped: there is no such driver\n"));
}

TEST_CASE("cases that measure real time get one second try, other cases do not") {
  const Run late = runCases("FAIL_ONCE=1");
  CHECK(late.code == 0);
  CHECK(says(late.text, "second try: measures a clock, late once\n"));
  CHECK(says(late.results, "failed\t"));
  const Run always = runCases("FAIL_ONCE=1 FAIL_ALWAYS=1");
  CHECK(always.code == 1);
  CHECK(says(always.text, "second try: measures a clock, always late\n"));
  const Run wrong = runCases("FAIL_ONCE=1 FAIL_PLAIN=1");
  CHECK(wrong.code == 1);
  CHECK(lacks(wrong.text, "second try"));
}

}  // namespace palpate
