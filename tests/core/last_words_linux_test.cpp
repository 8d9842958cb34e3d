// Programs of this kind that come to a bad end, and what they say of it. A sanitizer sees faults of memory first, and
// its words are others.
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

constexpr char kWithinMalloc[] = "it is aborted from within malloc", kStandsStill[] = "it stands still",
               kNullPointer[] = "it reads where nothing is", kGetsOn[] = "it gets on*";

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
  // The shell is replaced, so that the status is the program's; what waits for ever is ended by another signal.
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

// These are the bad ends, for the programs that the others begin.
TEST_CASE("it is aborted from within malloc" * doctest::skip()) {
  std::thread([] {}).join();  // with a second thread malloc locks what it works on
  // More than malloc keeps for threads, and at the end of its memory: the next size that it reads there is wrong.
  auto* last = static_cast<char*>(std::malloc(2000));
  REQUIRE(last);
  std::memset(last + 2000, 0xff, 64);
  for (int k = 0; k < 1000; ++k) CHECK(std::malloc(3000) != nullptr);
}

TEST_CASE("it stands still" * doctest::skip()) {
  std::thread other(standStill);
  standStill();
  other.join();
}

TEST_CASE("it reads where nothing is" * doctest::skip()) {
  const volatile int* nothing = nullptr;
  CHECK(*nothing == 0);
}

TEST_CASE("it gets on, slowly" * doctest::skip()) { std::this_thread::sleep_for(std::chrono::seconds(2)); }

TEST_CASE("it gets on, as slowly as before" * doctest::skip()) { std::this_thread::sleep_for(std::chrono::seconds(2)); }

TEST_CASE("a test program that is aborted from within malloc says so and ends at once") {
  const End end = endOf(kWithinMalloc);
  CAPTURE(end.text);
  CHECK(says(end.text, "last_words_linux_test.cpp:"));
  if (kSanitized) {
    CHECK(end.code != 0);
    CHECK(says(end.text, "AddressSanitizer: heap-buffer-overflow"));
    return;
  }
  CHECK(end.signal == SIGABRT);
  CHECK(says(end.text, "ended by Aborted in the case \"it is aborted from within malloc\" ("));
}

TEST_CASE("a test program that takes too long says where its threads stand, where there is a debugger, and ends") {
  const End end = endOf(kStandsStill, "PALPATE_TESTS_LIMIT_S=1");
  CAPTURE(end.text);
  CHECK(end.signal == SIGALRM);
  CHECK(says(end.text, "ended by the clock: it took longer than it may in the case \"it stands still\" ("));
  if (::access("/usr/bin/gdb", X_OK) == 0) {
    const std::size_t first = end.text.find("standStill");
    REQUIRE(first != std::string::npos);
    CHECK(end.text.find("standStill", first + 1) != std::string::npos);
  } else {
    MESSAGE("there is no gdb here, which says where all threads stand");
    CHECK(says(end.text, "tests_core("));
  }
}

TEST_CASE("a test program of many cases may take longer than one of them") {
  const End end = endOf(kGetsOn, "PALPATE_TESTS_LIMIT_S=3");
  CAPTURE(end.text);
  CHECK(end.signal == 0);
  CHECK(says(end.text, "2 passed"));
}

TEST_CASE("a test program that reads where nothing is says in which case") {
  const End end = endOf(kNullPointer);
  CAPTURE(end.text);
  if (kSanitized) {
    CHECK(end.code != 0);
    CHECK(says(end.text, "AddressSanitizer: SEGV"));
    CHECK(says(end.text, "last_words_linux_test.cpp:"));
    return;
  }
  CHECK(end.signal == SIGSEGV);
  CHECK(says(end.text, "ended by Segmentation fault in the case \"it reads where nothing is\" ("));
}

}  // namespace palpate::last_words_test
