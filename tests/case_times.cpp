// Where a test program's time goes: `--reporters=times` lists each case with the processor time and the time on the
// wall that it took, the longest first. The first of them also stands for beside what else the machine does.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <iomanip>
#include <ostream>
#include <string>
#include <vector>

namespace {

struct CaseTimes final : doctest::IReporter {
  explicit CaseTimes(const doctest::ContextOptions& options) : out(*options.cout) {}

  void test_case_start(const doctest::TestCaseData& of) override {
    name = of.m_name;
    file = of.m_file.c_str();
    processor = std::clock();
    wall = std::chrono::steady_clock::now();
  }
  void test_case_reenter(const doctest::TestCaseData&) override {}
  void test_case_end(const doctest::CurrentTestCaseStats&) override {
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - wall;
    cases.push_back({static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC, took.count(),
                     file.substr(file.rfind('/') + 1) + ": " + name});
  }
  void test_run_end(const doctest::TestRunStats&) override {
    std::ranges::sort(cases, std::greater{}, &Case::processor_s);
    out << std::fixed << std::setprecision(2) << "processor s  wall s\n";
    for (const Case& each : cases)
      out << std::setw(11) << each.processor_s << std::setw(8) << each.wall_s << "  " << each.name << '\n';
  }

  void report_query(const doctest::QueryData&) override {}
  void test_run_start() override {}
  void test_case_exception(const doctest::TestCaseException&) override {}
  void subcase_start(const doctest::SubcaseSignature&) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData&) override {}
  void log_message(const doctest::MessageData&) override {}
  void test_case_skipped(const doctest::TestCaseData&) override {}

  struct Case {
    double processor_s, wall_s;
    std::string name;
  };
  std::ostream& out;
  std::vector<Case> cases;
  std::string name, file;
  std::clock_t processor = 0;
  std::chrono::steady_clock::time_point wall;
};

REGISTER_REPORTER("times", 0, CaseTimes);

}  // namespace
