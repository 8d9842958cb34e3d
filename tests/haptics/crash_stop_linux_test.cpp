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
#include <new>
#include <vector>

#include "haptics/servo_loop.hpp"
#include "tests/haptics/contact_doubles.hpp"

namespace palpate {
namespace {

/// What a device felt, in memory that outlives the process that wrote it.
struct Record {
  std::atomic<double> force_N = 0, peak_N = 0;
  std::atomic<int> stops = 0;
};

class SharedRecord {
 public:
  SharedRecord() {
    void* page = ::mmap(nullptr, sizeof(Record), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    REQUIRE(page != MAP_FAILED);
    record_ = new (page) Record;
  }
  ~SharedRecord() { ::munmap(record_, sizeof(Record)); }
  SharedRecord(const SharedRecord&) = delete;
  SharedRecord& operator=(const SharedRecord&) = delete;
  Record& operator*() const { return *record_; }
  Record* operator->() const { return record_; }

 private:
  Record* record_ = nullptr;
};

/// A hand that goes 2 mm into the sphere within 0.7 s and stays; its motors keep the last force until told otherwise.
class RecordingDevice final : public HapticDevice {
 public:
  explicit RecordingDevice(Record& record) : record_(record) {}
  std::string_view name() const override { return "recording"; }
  DeviceLimits limits() const override { return {}; }
  DeviceState read(double time_s) noexcept override {
    return {.position = {0, 0, std::max(48.0, 51.5 - 5 * time_s)}, .ok = true};
  }
  bool write(const DVec3& force_N) noexcept override {
    record_.force_N = glm::length(force_N);
    record_.peak_N = std::max(record_.peak_N.load(), record_.force_N.load());
    return true;
  }
  void emergencyStop() noexcept override {
    record_.force_N = 0;
    ++record_.stops;
  }
  std::string faultText() const override { return {}; }

 private:
  Record& record_;
};

/// Does something bad 0.9 s into the session, in the middle of a tick.
class DoomedSphere final : public ContactQuery {
 public:
  explicit DoomedSphere(std::function<void()> doom, std::size_t hands = 1) : sphere_(hands), doom_(std::move(doom)) {}
  std::size_t hands() const noexcept override { return sphere_.hands(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override {
    if (poses.front().time_s >= 0.9 && !done_) {
      done_ = true;
      doom_();
    }
    return sphere_.ask(poses, budget_us);
  }

 private:
  SharedSphere sphere_;
  std::function<void()> doom_;
  bool done_ = false;
};

void writeWhereNoneMay() {
  void* page = ::mmap(nullptr, 4096, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  *static_cast<volatile char*>(page) = 1;
}

std::atomic<bool> stopAsked = false;

/// The status with which a child ends whose session meets `doom`.
int statusOfSession(
    Record& record, const std::function<void()>& doom, const std::function<void()>& before = [] {}) {
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const rlimit none{};
    ::setrlimit(RLIMIT_CORE, &none);
    for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTERM, SIGINT, SIGHUP, SIGQUIT})
      std::signal(signal, SIG_DFL);  // not those of the test program
    before();
    RecordingDevice device(record);
    DoomedSphere sphere(doom);
    ServoLoop(device, sphere, ForceLaw({}, {}), {.duration_s = 1, .stop = &stopAsked}).run();
    ::_exit(stopAsked ? 7 : 0);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  return status;
}

}  // namespace

TEST_CASE("a program that crashes in the middle of a touch leaves no force behind and dies of its own signal") {
  const SharedRecord record;
  int signal = 0;
  std::function<void()> doom;
  SUBCASE("a write where none may") {
    signal = SIGSEGV;
    doom = writeWhereNoneMay;
  }
  SUBCASE("abort") {
    signal = SIGABRT;
    doom = [] { std::abort(); };
  }
  SUBCASE("sent from outside") {
    for (const int sent : {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGBUS, SIGFPE, SIGILL, SIGSEGV}) {
      const std::string name = std::to_string(sent);
      SUBCASE(name.c_str()) {
        signal = sent;
        doom = [sent] { ::kill(::getpid(), sent); };
      }
    }
  }
  const int status = statusOfSession(*record, doom);
  REQUIRE(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == signal);
  CHECK(record->peak_N > 1);
  CHECK(record->force_N == 0);
  CHECK(record->stops == 1);
}

TEST_CASE("a crash takes the force from all hands") {
  std::array<SharedRecord, kMostHands> records;
  const pid_t child = ::fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    const rlimit none{};
    ::setrlimit(RLIMIT_CORE, &none);
    std::signal(SIGSEGV, SIG_DFL);
    DoomedSphere sphere(writeWhereNoneMay, records.size());
    std::deque<RecordingDevice> devices;
    std::vector<SessionHand> hands;
    for (const SharedRecord& record : records)
      hands.push_back({.device = devices.emplace_back(*record), .law = ForceLaw({}, {})});
    ServoLoop(sphere, hands, {.duration_s = 1}).run();
    ::_exit(0);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  for (const SharedRecord& record : records) {
    CHECK(record->peak_N > 1);
    CHECK(record->force_N == 0);
    CHECK(record->stops == 1);
  }
}

TEST_CASE("a signal that the program handles is handled, after the force is gone") {
  const SharedRecord record;
  const int status = statusOfSession(
      *record, [] { std::raise(SIGINT); }, [] { std::signal(SIGINT, [](int) { stopAsked = true; }); });
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 7);
  CHECK(record->stops == 1);
  CHECK(record->force_N == 0);
}

TEST_CASE("a signal that is ignored stays so, and the session goes on") {
  const SharedRecord record;
  const int status = statusOfSession(
      *record, [] { std::raise(SIGHUP); }, [] { std::signal(SIGHUP, SIG_IGN); });
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  CHECK(record->stops == 0);
}

TEST_CASE("after a session the handlers are those from before it") {
  const SharedRecord record;
  struct sigaction before {
  }, after{};
  ::sigaction(SIGTERM, nullptr, &before);
  {
    RecordingDevice one(*record), two(*record);
    const CrashStop first(one);
    const CrashStop second(two);
    ::sigaction(SIGTERM, nullptr, &after);
    CHECK((after.sa_handler != before.sa_handler));
  }
  ::sigaction(SIGTERM, nullptr, &after);
  CHECK((after.sa_handler == before.sa_handler));
}

}  // namespace palpate
