// Programs that crash in the middle of a touch: each is this one again, which finds in its
// environment what to do, and notes in a file that is mapped into memory what its device felt.
#include <windows.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>

#include "haptics/crash_stop.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/haptics/contact_doubles.hpp"

namespace palpate {
namespace {

constexpr UINT kCrashed = 77;
constexpr const char *kDoom = "PALPATE_TESTS_DOOM", *kRecord = "PALPATE_TESTS_RECORD";

/// A hand that goes 2 mm into the sphere within 0.7 s and stays; its motors keep the last force until told otherwise.
class RecordingDevice final : public HapticDevice {
 public:
  explicit RecordingDevice(FakeNote& note) : note_(note) {}
  std::string_view name() const override { return "recording"; }
  DeviceLimits limits() const override { return {}; }
  DeviceState read(double time_s) noexcept override {
    return {.position = {0, 0, std::max(48.0, 51.5 - 5 * time_s)}, .ok = true};
  }
  bool write(const DVec3& force_N) noexcept override {
    note_.force_N[2] = glm::length(force_N);
    note_.mostForce_N = std::max(note_.mostForce_N, note_.force_N[2]);
    return true;
  }
  void emergencyStop() noexcept override {
    note_.force_N[2] = 0;
    ++note_.closed;
  }
  std::string faultText() const override { return {}; }

 private:
  FakeNote& note_;
};

/// Does something bad 0.9 s into the session, in the middle of a tick.
class DoomedSphere final : public ContactQuery {
 public:
  explicit DoomedSphere(std::function<void()> doom) : sphere_(1), doom_(std::move(doom)) {}
  std::size_t hands() const noexcept override { return sphere_.hands(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override {
    if (poses.front().time_s >= 0.9) doom_();
    return sphere_.ask(poses, budget_us);
  }

 private:
  SharedSphere sphere_;
  std::function<void()> doom_;
};

std::function<void()> doomNamed(const std::string& name) {
  if (name == "abort") return [] { std::abort(); };
  return [] { *static_cast<volatile char*>(nullptr) = 1; };
}

struct End {
  DWORD code = 0;
  FakeNote note;
};

/// How a program ends that meets `doom`.
End endOfProgram(const std::string& doom) {
  const ScratchFolder folder;
  const Variable what(kDoom, doom), where(kRecord, (folder / "note").string());
  wchar_t self[MAX_PATH]{};
  ::GetModuleFileNameW(nullptr, self, MAX_PATH);
  std::wstring line = L"\"" + std::wstring(self) + L"\" --no-skip --test-case=\"*doomed program*\"";
  STARTUPINFOW startup{};
  startup.cb = sizeof startup;
  PROCESS_INFORMATION child{};
  REQUIRE(::CreateProcessW(self, line.data(), nullptr, nullptr, FALSE, CREATE_NEW_PROCESS_GROUP, nullptr, nullptr,
                           &startup, &child));
  CHECK(::WaitForSingleObject(child.hProcess, 60'000) == WAIT_OBJECT_0);
  End end;
  ::GetExitCodeProcess(child.hProcess, &end.code);
  ::CloseHandle(child.hThread);
  ::CloseHandle(child.hProcess);
  std::ifstream(folder / "note", std::ios::binary).read(reinterpret_cast<char*>(&end.note), sizeof end.note);
  return end;
}

}  // namespace

TEST_CASE("a doomed program" * doctest::skip()) {
  const char *doom = std::getenv(kDoom), *record = std::getenv(kRecord);
  REQUIRE(doom);
  REQUIRE(record);
  // Neither that of the test program nor the system's, which asks a person.
  ::SetUnhandledExceptionFilter([](EXCEPTION_POINTERS*) -> LONG {
    ::TerminateProcess(::GetCurrentProcess(), kCrashed);
    return EXCEPTION_EXECUTE_HANDLER;
  });
  std::signal(SIGABRT, [](int) { ::TerminateProcess(::GetCurrentProcess(), kCrashed); });
  RecordingDevice device(*mappedNote(record));
  DoomedSphere sphere(doomNamed(doom));
  ServoLoop(device, sphere, ForceLaw({}, {}), {.duration_s = 1}).run();
}

TEST_CASE("a program that crashes or aborts in the middle of a touch leaves no force behind") {
  for (const char* doom : {"write", "abort"}) {
    CAPTURE(doom);
    const End end = endOfProgram(doom);
    CHECK(end.code == kCrashed);
    CHECK(end.note.mostForce_N > 1);
    CHECK(end.note.force_N[2] == 0);
    CHECK(end.note.closed == 1);
  }
}

}  // namespace palpate
