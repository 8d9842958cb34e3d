// Test programs that crash or hang, and their reports. A sanitizer detects memory faults first and has its own report.
#include <doctest/doctest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <thread>

#include "tests/says.hpp"
#include "tests/surroundings.hpp"

namespace palpate::last_words_test {

namespace {

constexpr char kWithinMalloc[] = "helper: aborts within malloc", kStandsStill[] = "helper: hangs",
               kNullPointer[] = "helper: reads a null pointer", kGetsOn[] = "helper: takes two seconds*";

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

struct End {
  int signal = 0, code = 0;
  std::string text;
};

End endOf(const std::string& name, const std::string& before = "") {
  // exec replaces the shell, so that the status is the program's; a hang is ended by another signal.
  const std::string command = before + " exec timeout -s KILL 60 " PALPATE_EMULATOR " '" +
                              (programFolder() / "tests_core").string() + "' --no-skip --test-case='" + name + "' 2>&1";
  std::FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe);
  End end;
  std::array<char, 4096> piece;
  while (const std::size_t size = std::fread(piece.data(), 1, piece.size(), pipe)) end.text.append(piece.data(), size);
  const int status = ::pclose(pipe);
  end.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  end.code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
  return end;
}

[[gnu::noinline]] void standStill() {
  for (;;) ::pause();
}

}  // namespace

// The crashes and hangs, for the programs that the other cases start.
TEST_CASE("helper: aborts within malloc" * doctest::skip()) {
  std::thread([] {}).join();  // with a second thread malloc locks its arena
  // More than malloc caches per thread, at the end of its arena: the next size that it reads there is wrong.
  auto* last = static_cast<char*>(std::malloc(2000));
  REQUIRE(last);
  std::memset(last + 2000, 0xff, 64);
  for (int k = 0; k < 1000; ++k) CHECK(std::malloc(3000) != nullptr);
}

TEST_CASE("helper: hangs" * doctest::skip()) {
  std::thread other(standStill);
  standStill();
  other.join();
}

TEST_CASE("helper: reads a null pointer" * doctest::skip()) {
  const volatile int* nothing = nullptr;
  CHECK(*nothing == 0);
}

TEST_CASE("helper: takes two seconds" * doctest::skip()) { std::this_thread::sleep_for(std::chrono::seconds(2)); }

TEST_CASE("helper: takes two seconds, again" * doctest::skip()) {
  std::this_thread::sleep_for(std::chrono::seconds(2));
}

TEST_CASE("a test program that aborts within malloc reports its case and ends at once") {
  const End end = endOf(kWithinMalloc);
  CAPTURE(end.text);
  CHECK(says(end.text, "last_words_linux_test.cpp:"));
  if (kSanitized) {
    CHECK(end.code != 0);
    CHECK(says(end.text, "AddressSanitizer: heap-buffer-overflow"));
    return;
  }
  CHECK(end.signal == SIGABRT);
  CHECK(says(end.text, "ended by Aborted in the case \"helper: aborts within malloc\" ("));
}

TEST_CASE("a test program that hangs reports its case and, with a debugger, all threads, and ends") {
  const End end = endOf(kStandsStill, "PALPATE_TESTS_LIMIT_S=1");
  CAPTURE(end.text);
  CHECK(end.signal == SIGALRM);
  CHECK(says(end.text, "ended by the clock: it took longer than it may in the case \"helper: hangs\" ("));
  if (::access("/usr/bin/gdb", X_OK) == 0) {
    const std::size_t first = end.text.find("standStill");
    REQUIRE(first != std::string::npos);
    CHECK(end.text.find("standStill", first + 1) != std::string::npos);
  } else {
    MESSAGE("gdb is not installed, which reports the positions of all threads");
    CHECK(says(end.text, "tests_core("));
  }
}

TEST_CASE("a test program of many cases may take longer than the limit of one case") {
  const End end = endOf(kGetsOn, "PALPATE_TESTS_LIMIT_S=3");
  CAPTURE(end.text);
  CHECK(end.signal == 0);
  CHECK(says(end.text, "2 passed"));
}

TEST_CASE("a test program that reads a null pointer reports the case") {
  const End end = endOf(kNullPointer);
  CAPTURE(end.text);
  if (kSanitized) {
    CHECK(end.code != 0);
    CHECK(says(end.text, "AddressSanitizer: SEGV"));
    CHECK(says(end.text, "last_words_linux_test.cpp:"));
    return;
  }
  CHECK(end.signal == SIGSEGV);
  CHECK(says(end.text, "ended by Segmentation fault in the case \"helper: reads a null pointer\" ("));
}

}  // namespace palpate::last_words_test
