// Loads a fake driver library with a script into a test and the programs that it starts. The libraries are in the
// folder fake_devices beside the test program, or in PALPATE_FAKE_DEVICES_FOLDER.
#pragma once

#include <doctest/doctest.h>

#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>

#include "tests/fake_devices/fake_device.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/surroundings.hpp"

namespace palpate {

inline std::filesystem::path fakeDevicesFolder() {
  const char* elsewhere = std::getenv("PALPATE_FAKE_DEVICES_FOLDER");
  return elsewhere ? elsewhere : programFolder() / "fake_devices";
}

inline std::filesystem::path fakeDriverFile(const std::string& name) {
  const std::filesystem::path file = fakeDevicesFolder() / libraryFileName(name);
  REQUIRE_MESSAGE(std::filesystem::exists(file), "no " << file.string() << "; build the target fake_drivers");
  return file;
}

/// The device behind a stylus and the record of its events.
class FakeStylus {
 public:
  /// `script`: see FakeDevice; % is replaced by its folder. `hand`: rows of a path, may be empty.
  FakeStylus(const char* variable, std::string script, const std::string& hand)
      : variable_(variable, (folder_ / "script").string()) {
    for (std::size_t at; (at = script.find('%')) != std::string::npos;) script.replace(at, 1, folder_.path().string());
    if (!hand.empty()) {
      std::ofstream(folder_ / "hand.csv") << "t_s,x,y,z\n" << hand;
      script += "\nhand " + (folder_ / "hand.csv").string() + "\n";
    }
    std::ofstream(folder_ / "script") << script << "\nnote " << (folder_ / "note").string() << "\n";
  }

  const ScratchFolder& folder() const { return folder_; }
  FakeNote note() const {
    FakeNote note;
    std::ifstream(folder_ / "note", std::ios::binary).read(reinterpret_cast<char*>(&note), sizeof note);
    return note;
  }
  DVec3 lastForce_N() const {
    const FakeNote seen = note();
    return {seen.force_N[0], seen.force_N[1], seen.force_N[2]};
  }
  bool waitForZero() const {
    for (int i = 0; i < 20'000 && lastForce_N() != DVec3(0); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return lastForce_N() == DVec3(0);
  }
  /// Waits for a force of at least `least_N` and returns it: the stylus bounces, so that a later reading may be
  /// smaller.
  double waitForForce_N(double least_N) const {
    double felt_N = 0;
    for (int i = 0; i < 20'000 && felt_N < least_N; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      felt_N = glm::length(lastForce_N());
    }
    return felt_N;
  }

 private:
  ScratchFolder folder_;
  Variable variable_;
};

class FakeDriver : public FakeStylus {
 public:
  explicit FakeDriver(const std::string& library = "fake_hd", const std::string& script = "",
                      const std::string& hand = "")
      : FakeStylus(FakeDevice::kFirst, script, hand),
        library_(library.starts_with("fake_dhd") ? "PALPATE_DHD_LIBRARY" : "PALPATE_HD_LIBRARY",
                 fakeDriverFile(library).string()) {}

 private:
  Variable library_;
};

/// The "Right Device" of an OpenHaptics driver, beside its "Left Device".
class SecondFakeStylus : public FakeStylus {
 public:
  explicit SecondFakeStylus(const std::string& script = "", const std::string& hand = "")
      : FakeStylus(FakeDevice::kSecond, script, hand) {}
};

}  // namespace palpate
