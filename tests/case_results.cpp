// Run time and result of each case: `--reporters=times` lists each case with its processor time, including that of the
// programs it waited for, and its wall time. PALPATE_TESTS_RESULTS names a file that gets a line for each case (result,
// processor seconds, wall seconds, labels, file, name) and for each skipped check.
#include "tests/case_results.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <ostream>
#include <sstream>
#include <string_view>
#include <utility>

#include "tests/surroundings.hpp"
#include "tests/unmoved_reporter.hpp"

namespace palpate {

namespace {

std::vector<FailedCase> failed;

struct Result {
  std::string name, file, labels;
  double processor_s = 0, wall_s = 0;
  bool passed = true;
};

/// The times of the running case.
class Watch {
 public:
  void begin(const doctest::TestCaseData& of) {
    at_ = {.name = of.m_name, .file = of.m_file.c_str(), .labels = of.m_test_suite ? of.m_test_suite : ""};
    at_.file = at_.file.substr(at_.file.rfind("tests/") + 6);
    processor_s_ = processorSeconds();
    wall_ = std::chrono::steady_clock::now();
  }
  Result end(const doctest::CurrentTestCaseStats& stats) {
    at_.processor_s = processorSeconds() - processor_s_;
    at_.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
    at_.passed = stats.testCaseSuccess;
    return at_;
  }
  const Result& at() const { return at_; }

 private:
  Result at_;
  double processor_s_ = 0;
  std::chrono::steady_clock::time_point wall_;
};

/// Writes each line with one call, so that concurrent programs can share the file.
struct ResultFile final : Unmoved {
  explicit ResultFile(const doctest::ContextOptions&) {
    if (const char* name = std::getenv("PALPATE_TESTS_RESULTS")) out.open(name, std::ios::app);
  }

  void test_case_start(const doctest::TestCaseData& of) override { watch.begin(of); }
  void test_case_end(const doctest::CurrentTestCaseStats& stats) override {
    const Result result = watch.end(stats);
    if (!result.passed) failed.push_back({result.name, result.labels.find("clock") != std::string::npos});
    write(result.passed ? "passed" : "failed", result, result.name);
  }
  void log_message(const doctest::MessageData& message) override {
    if (std::string_view(message.m_string.c_str()).starts_with("skipped"))
      write("skipped", watch.at(), message.m_string.c_str());
  }

  void write(const char* result, const Result& of, const std::string& text) {
    if (!out.is_open()) return;
    std::ostringstream line;
    line << result << '\t' << std::fixed << std::setprecision(2) << of.processor_s << '\t' << of.wall_s << '\t'
         << of.labels << '\t' << of.file << '\t' << text << '\n';
    out << line.str() << std::flush;
  }

  std::ofstream out;
  Watch watch;
};

struct CaseTimes final : Unmoved {
  explicit CaseTimes(const doctest::ContextOptions& options) : out(*options.cout) {}

  void test_case_start(const doctest::TestCaseData& of) override { watch.begin(of); }
  void test_case_end(const doctest::CurrentTestCaseStats& stats) override { cases.push_back(watch.end(stats)); }
  void test_run_end(const doctest::TestRunStats&) override {
    std::ranges::sort(cases, std::greater{}, &Result::processor_s);
    out << std::fixed << std::setprecision(2) << "processor s  wall s\n";
    for (const Result& each : cases)
      out << std::setw(11) << each.processor_s << std::setw(8) << each.wall_s << "  " << each.file << ": " << each.name
          << '\n';
  }

  std::ostream& out;
  std::vector<Result> cases;
  Watch watch;
};

REGISTER_REPORTER("times", 0, CaseTimes);
REGISTER_LISTENER("results", 0, ResultFile);

}  // namespace

std::vector<FailedCase> takeFailedCases() { return std::exchange(failed, {}); }

}  // namespace palpate
