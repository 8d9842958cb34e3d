// The test framework's handler allocates memory for its report: after an abort inside malloc it would wait for ever.
// The code here neither allocates nor locks. The signalled thread's calls come first: of a long report often only the
// beginning is kept. A debugger, if available, then prints the position of each thread.
#include "tests/last_words.hpp"
#include "tests/unmoved_reporter.hpp"

#include <doctest/doctest.h>
#include <execinfo.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace palpate {

namespace {

constexpr unsigned kMaxForWords_s = 60;  // in case the debugger hangs

pid_t ours = 0;
std::atomic<const char*> caseName = nullptr, caseFile = nullptr;
std::atomic<unsigned> caseLine = 0;
unsigned limit_s = 0;  // of each case; 0: no limit

void say(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

struct Digits {
  explicit Digits(long number) { *std::to_chars(text.data(), text.data() + text.size() - 1, number).ptr = 0; }
  std::array<char, 24> text;
};

void askDebugger() {
  Digits self(ours);
  const char* words[] = {"gdb",
                         "-nx",
                         "-batch",
                         "-iex",
                         "set debuginfod enabled off",
                         "-p",
                         self.text.data(),
                         "-ex",
                         "thread apply all -ascending backtrace 24",
                         nullptr};
  // The debugger must not inherit this program's preloaded libraries; its warnings go to the same output.
  char path[] = "PATH=/usr/local/bin:/usr/bin:/bin";
  char* surroundings[] = {path, nullptr};
  pid_t debugger = 0;
  if (::posix_spawn(&debugger, "/usr/bin/gdb", nullptr, nullptr, const_cast<char**>(words), surroundings) != 0) return;
  while (::waitpid(debugger, nullptr, 0) < 0 && errno == EINTR) {
  }
}

void sayWhere() {
  if (const char* name = caseName) {
    say(" in the case \"");
    say(name);
    say("\" (");
    say(caseFile.load());
    say(":");
    say(Digits(caseLine).text.data());
    say(")\n");
  } else {
    say(" in no case\n");
  }
  std::array<void*, 60> frames;
  ::backtrace_symbols_fd(frames.data(), ::backtrace(frames.data(), frames.size()), STDERR_FILENO);
  askDebugger();
}

// Child processes would survive, and keep ctest's pipe open.
void endThoseBegun() {
  std::array<char, 64> name{"/proc/self/task/"};
  char* end = std::to_chars(name.data() + std::strlen(name.data()), name.data() + 40, ours).ptr;
  std::memcpy(end, "/children", sizeof "/children");
  const int file = ::open(name.data(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  std::array<char, 1024> numbers;
  const ssize_t size = ::read(file, numbers.data(), numbers.size());
  ::close(file);
  for (const char *at = numbers.data(), *last = at + std::max<ssize_t>(size, 0); at < last; ++at) {
    pid_t child = 0;
    at = std::from_chars(at, last, child).ptr;
    if (child > 0) ::kill(child, SIGTERM);
  }
}

// The handler runs once for each signal; a further one ends the process, also inside the handler.
extern "C" void sayThenGo(int signal) {
  if (::getpid() == ours) {
    std::signal(SIGALRM, SIG_DFL);
    ::alarm(kMaxForWords_s);
    say("\nThis test program is ended by ");
    say(signal == SIGALRM ? "the clock: it took longer than it may" : ::sigdescr_np(signal));
    sayWhere();
    endThoseBegun();
  }
  std::signal(signal, SIG_DFL);
  ::raise(signal);
}

// Reports nothing; records the current case.
struct CaseKeeper final : Unmoved {
  explicit CaseKeeper(const doctest::ContextOptions&) {}
  void test_case_start(const doctest::TestCaseData& of) override {
    caseFile = of.m_file.c_str();
    caseLine = of.m_line;
    caseName = of.m_name;
    ::alarm(limit_s);
  }
  void test_case_end(const doctest::CurrentTestCaseStats&) override {
    caseName = nullptr;
    ::alarm(limit_s);  // the code after the last case may hang, too
  }
};
REGISTER_LISTENER("case_keeper", 0, CaseKeeper);

}  // namespace

void sayLastWords() {
  ours = ::getpid();
  ::prctl(PR_SET_PTRACER, PR_SET_PTRACER_ANY, 0, 0, 0);  // lets its own child, the debugger, attach
  std::array<void*, 2> frames;
  ::backtrace(frames.data(), frames.size());  // the first call loads a library
  // A stack overflow cannot be reported on the same stack.
  static std::array<char, 1 << 16> stack;
  const stack_t apart{.ss_sp = stack.data(), .ss_flags = 0, .ss_size = stack.size()};
  ::sigaltstack(&apart, nullptr);
  struct sigaction action {};
  action.sa_handler = sayThenGo;
  action.sa_flags = SA_ONSTACK;
  for (const int signal : {SIGILL, SIGFPE, SIGSEGV, SIGBUS, SIGABRT, SIGALRM}) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    // A sanitizer's report is more detailed.
    if (before.sa_handler == SIG_DFL) ::sigaction(signal, &action, nullptr);
  }
  // The limit is per case, not per program: a slow machine that makes progress is not ended.
  if (const char* limit = std::getenv("PALPATE_TESTS_LIMIT_S")) limit_s = static_cast<unsigned>(std::atoi(limit));
  ::alarm(limit_s);
}

}  // namespace palpate
