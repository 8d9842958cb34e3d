// Programs that crash during touch: each is this program started again, which reads its task from the environment, and
// writes its device's record to a mapped file.
#include <windows.h>

#include <doctest/doctest.h>

#include <csignal>
#include <cstdlib>
#include <fstream>

#include "haptics/crash_stop.hpp"
#include "haptics/servo_loop.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/haptics/doomed_session.hpp"

namespace palpate::crash_stop_test {
namespace {

constexpr UINT kCrashed = 77;
constexpr const char *kDoom = "PALPATE_TESTS_DOOM", *kRecord = "PALPATE_TESTS_RECORD";

std::function<void()> doomNamed(const std::string& name) {
  if (name == "abort") return [] { std::abort(); };
  return [] { *static_cast<volatile char*>(nullptr) = 1; };
}

struct End {
  DWORD code = 0;
  FakeNote note;
};

/// Exit of a program that runs `doom`.
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
  // Replaces the handlers of the test program and of the system, which opens a dialog.
  ::SetUnhandledExceptionFilter([](EXCEPTION_POINTERS*) -> LONG {
    ::TerminateProcess(::GetCurrentProcess(), kCrashed);
    return EXCEPTION_EXECUTE_HANDLER;
  });
  std::signal(SIGABRT, [](int) { ::TerminateProcess(::GetCurrentProcess(), kCrashed); });
  RecordingDevice device(*mappedNote(record));
  DoomedSphere sphere(doomNamed(doom));
  ServoLoop(device, sphere, ForceLaw({}, {}), {.duration_s = 1}).run();
}

TEST_CASE("a program that crashes or aborts during a touch leaves no force") {
  for (const char* doom : {"write", "abort"}) {
    CAPTURE(doom);
    const End end = endOfProgram(doom);
    CHECK(end.code == kCrashed);
    checkStopped(end.note);
  }
}

}  // namespace palpate::crash_stop_test
