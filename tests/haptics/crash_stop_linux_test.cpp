#include "haptics/crash_stop.hpp"

#include <doctest/doctest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <deque>
#include <functional>
#include <list>
#include <vector>

#include "engine/core/error.hpp"
#include "haptics/devices/simulated_touch.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/haptics/doomed_session.hpp"

namespace palpate::crash_stop_test {
namespace {

/// Records of a device, in memory that outlives the process that wrote them.
class SharedNote {
 public:
  SharedNote() {
    void* page = ::mmap(nullptr, sizeof(FakeNote), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    REQUIRE(page != MAP_FAILED);
    note_ = new (page) FakeNote;
  }
  ~SharedNote() { ::munmap(note_, sizeof(FakeNote)); }
  SharedNote(const SharedNote&) = delete;
  SharedNote& operator=(const SharedNote&) = delete;
  FakeNote& operator*() const { return *note_; }
  FakeNote* operator->() const { return note_; }

 private:
  FakeNote* note_ = nullptr;
};

void writeWhereNoneMay() {
  void* page = ::mmap(nullptr, 4096, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  *static_cast<volatile char*>(page) = 1;
}

std::atomic<bool> stopAsked = false;

/// Exit status of a child that does `act`.
int statusOf(const std::function<void()>& act) {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const rlimit none{};
    ::setrlimit(RLIMIT_CORE, &none);
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGINT, SIGHUP, SIGQUIT})
      std::signal(signal, SIG_DFL);  // not those of the test program
    act();
    ::_exit(stopAsked ? 7 : 0);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  return status;
}

/// Exit status of a child whose session runs `doom`.
int statusOfSession(
    FakeNote& note, const std::function<void()>& doom, const std::function<void()>& before = [] {}) {
  return statusOf([&] {
    before();
    RecordingDevice device(note);
    DoomedSphere sphere(doom);
    ServoLoop(device, sphere, ForceLaw({}, {}), {.duration_s = 1, .stop = &stopAsked}).run();
  });
}

}  // namespace

TEST_CASE("a program that crashes during a touch leaves no force and ends by the original signal") {
  const SharedNote note;
  int signal = 0;
  std::function<void()> doom;
  SUBCASE("a write to protected memory") {
    signal = SIGSEGV;
    doom = writeWhereNoneMay;
  }
  SUBCASE("abort") {
    signal = SIGABRT;
    doom = [] { std::abort(); };
  }
  SUBCASE("a signal from outside") {
    for (const int sent : {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGBUS, SIGFPE, SIGILL, SIGSEGV}) {
      const std::string name = std::to_string(sent);
      SUBCASE(name.c_str()) {
        signal = sent;
        doom = [sent] { ::kill(::getpid(), sent); };
      }
    }
  }
  const int status = statusOfSession(*note, doom);
  REQUIRE(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == signal);
  checkStopped(*note);
}

TEST_CASE("a crash stops the force of all hands") {
  std::array<SharedNote, kMaxHands> notes;
  const int status = statusOf([&] {
    DoomedSphere sphere(writeWhereNoneMay, notes.size());
    std::deque<RecordingDevice> devices;
    std::vector<SessionHand> hands;
    for (const SharedNote& note : notes)
      hands.push_back({.device = devices.emplace_back(*note), .law = ForceLaw({}, {})});
    ServoLoop(sphere, hands, {.duration_s = 1}).run();
  });
  CHECK(WIFSIGNALED(status));
  for (const SharedNote& note : notes) checkStopped(*note);
}

TEST_CASE("a signal that the program handles is handled after the force has stopped") {
  const SharedNote note;
  const int status = statusOfSession(
      *note, [] { std::raise(SIGINT); }, [] { std::signal(SIGINT, [](int) { stopAsked = true; }); });
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 7);
  checkStopped(*note);
}

TEST_CASE("a signal that the program ignores stays ignored, and the session continues") {
  const SharedNote note;
  const int status = statusOfSession(
      *note, [] { std::raise(SIGHUP); }, [] { std::signal(SIGHUP, SIG_IGN); });
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  CHECK(note->closed == 0);
}

TEST_CASE("the signal handlers are restored after a session") {
  const SharedNote note;
  struct sigaction before {
  }, after{};
  ::sigaction(SIGTERM, nullptr, &before);
  {
    RecordingDevice one(*note), two(*note);
    const CrashStop first(one);
    const CrashStop second(two);
    ::sigaction(SIGTERM, nullptr, &after);
    CHECK((after.sa_handler != before.sa_handler));
  }
  ::sigaction(SIGTERM, nullptr, &after);
  CHECK((after.sa_handler == before.sa_handler));
}

TEST_CASE(
    "a handler that the program installs during a session stays, and comes after the force from the next one on") {
  const SharedNote first, second;
  static std::atomic<int> handled = 0;
  static struct sigaction beneath;  // of the program's handler, which calls it
  static double force_N = -1;
  static const FakeNote* watched = nullptr;
  const int status = statusOf([&] {
    const auto install = [] {
      struct sigaction ours {};
      ours.sa_handler = [](int signal) {
        ++handled;
        force_N = watched->force_N[2];
        if (beneath.sa_flags & SA_SIGINFO) beneath.sa_sigaction(signal, nullptr, nullptr);
      };
      ::sigaction(SIGINT, &ours, &beneath);
    };
    std::signal(SIGINT, [](int) { stopAsked = true; });
    const auto touch = [](FakeNote& note, const std::function<void()>& doom) {
      watched = &note;
      RecordingDevice device(note);
      DoomedSphere sphere(doom);
      ServoLoop(device, sphere, ForceLaw({}, {}), {.duration_s = 1, .stop = &stopAsked}).run();
    };
    touch(*first, install);
    struct sigaction now {};
    ::sigaction(SIGINT, nullptr, &now);
    if ((now.sa_flags & SA_SIGINFO) || now.sa_handler == SIG_DFL) ::_exit(1);  // not the program's
    touch(*second, [] { std::raise(SIGINT); });
    ::_exit(handled == 1 && force_N == 0 && stopAsked ? 0 : 2);
  });
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  CHECK(second->mostForce_N > 1);
  CHECK(second->force_N[2] == 0);
}

TEST_CASE("a session that goes on after Ctrl+C reports no force, and has one again when asked, from free space") {
  const auto former = std::signal(SIGINT, [](int) {});
  constexpr WorkspaceMap kMap{.scale = 1, .offset = {0, 0, 50}};
  SimulatedTouch touch(Path({{0, {0, 0, 54}},
                             {0.4, {0, 0, 54}},
                             {0.6, {0, 0, 49}},
                             {1.7, {0, 0, 49}},
                             {1.9, {0, 0, 54}},
                             {2.3, {0, 0, 54}},
                             {2.5, {0, 0, 49}},
                             {3.5, {0, 0, 49}}}),
                       kMap);
  DoomedSphere sphere([] { std::raise(SIGINT); });
  std::atomic<bool> on = true;
  ServoLoop loop(touch, sphere, ForceLaw({.stiffness_N_per_mm = 0.5}, {}), {.duration_s = 3.5, .forcesOn = &on},
                 {.map = kMap});
  const ServoResult result = loop.run({}, [&](std::uint64_t tick) {
    if (tick == 1400) CrashStop::resume(nullptr);  // of another session
    if (tick == 1500) CrashStop::resume(&on);
  });
  std::signal(SIGINT, former);
  CHECK_FALSE(result.deviceFailed);
  const auto most_N = [&](double from_s, double to_s) {
    double most = 0;
    for (const TraceRow& row : result.trace().rows)
      if (row.time_s >= from_s && row.time_s < to_s) most = std::max(most, glm::length(row.force_N));
    return most;
  };
  CHECK(most_N(0, 0.9) > 0.1);
  CHECK(most_N(0.902, 1.5) == 0);
  CHECK(most_N(1.5, 2.3) < 0.02);  // on the way out a small demand ends the wait
  CHECK(most_N(2.6, 3.5) > 0.1);
}

TEST_CASE("guarding more devices than possible is an error, and the others stay guarded") {
  const SharedNote note;
  RecordingDevice device(*note);
  {
    std::list<CrashStop> guarded;
    for (int i = 0; i < CrashStop::kMaxDevices; ++i) guarded.emplace_back(device);
    CHECK_THROWS_AS(guarded.emplace_back(device), Error);
    guarded.pop_back();
    guarded.emplace_back(device);
  }
  const CrashStop after(device);
}

}  // namespace palpate::crash_stop_test
