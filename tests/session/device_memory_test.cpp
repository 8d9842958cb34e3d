// What is remembered for a device between programs.
#include "haptics/session/device_memory.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "engine/core/error.hpp"
#include "tests/content_of.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/surroundings.hpp"

namespace palpate::device_memory_test {
namespace {

struct Kept {
  ScratchFolder folder;
  DeviceMemory memory{folder / "palpate" / "devices.json"};
  RememberedDevice inverse{.model = "Inverse3 049D", .stiffness_N_per_mm = 1.25, .axes = "x,z,-y"};
  RememberedDevice touch{.model = "Touch", .stiffness_N_per_mm = 0.3};
};

}  // namespace

TEST_CASE("what is remembered for a device is found by another program, and only for that serial number") {
  const Kept kept;
  CHECK(kept.memory.devices().empty());
  CHECK(kept.memory.find("haply:049D").isEmpty());
  kept.memory.remember("haply:049D", kept.inverse);
  kept.memory.remember("openhaptics:1", kept.touch);
  const DeviceMemory other(kept.memory.file());
  CHECK(other.find("haply:049D") == kept.inverse);
  CHECK(other.find("openhaptics:1") == kept.touch);
  CHECK(other.find("haply:1").isEmpty());
  CHECK(kept.inverse.inWords() == "stiffness at most 1.25 N/mm, axes x,z,-y");
  CHECK(RememberedDevice{}.inWords().empty());
  kept.memory.remember("openhaptics:1", {.model = "Touch"});
  CHECK(other.devices().size() == 1);
}

TEST_CASE("a device is forgotten by its name, all of a kind by the kind, and nothing else") {
  const Kept kept;
  for (const char* key : {"haply:049D", "haply:049DE", "openhaptics:1"}) kept.memory.remember(key, kept.touch);
  kept.memory.choose("haply:049D");
  CHECK(kept.memory.forget("hapl").empty());
  CHECK(kept.memory.chosen() == "haply:049D");
  CHECK(kept.memory.forget("haply:049D") == std::vector<std::string>{"haply:049D"});
  CHECK(kept.memory.chosen().empty());
  CHECK(kept.memory.devices().size() == 2);
  CHECK(kept.memory.forget("haply") == std::vector<std::string>{"haply:049DE"});
  CHECK(kept.memory.forget("haply").empty());
  CHECK(kept.memory.devices().size() == 1);
}

TEST_CASE("a user without a device has no file of devices") {
  const Kept kept;
  kept.memory.choose("mouse");
  CHECK(kept.memory.forget("haply").empty());
  CHECK_FALSE(std::filesystem::exists(kept.memory.file()));
  kept.memory.choose("haply");
  kept.memory.choose("mouse");
  CHECK(kept.memory.chosen() == "mouse");
}

TEST_CASE("a damaged file of devices is reported with its name, and never overwritten") {
  const Kept kept;
  std::filesystem::create_directories(kept.memory.file().parent_path());
  for (const char* text :
       {"{\"version\": 1, ", "[]", R"({"version": 2})", R"({"version": 1, "windows": "haply"})",
        R"({"version": 1, "devices": {"haply:1": {"model": "a", "stiffness_N_per_mm": -1, "axes": ""}}})",
        R"({"version": 1, "devices": {"haply:1": {"model": "a", "stiffness_N_per_mm": 1, "axes": "x,x,z"}}})",
        R"({"version": 1, "devices": {"haply:1": {"model": "a", "stiffness_N_per_mm": "1", "axes": ""}}})"}) {
    CAPTURE(text);
    std::ofstream(kept.memory.file()) << text;
    CHECK_THROWS_WITH_AS(kept.memory.find("haply:1"), doctest::Contains("devices.json"), FileError);
    CHECK_THROWS_AS(kept.memory.remember("haply:1", kept.touch), FileError);
    CHECK_THROWS_AS(kept.memory.choose("haply"), FileError);
    CHECK_THROWS_AS(kept.memory.forget("haply"), FileError);
    CHECK(contentOf(kept.memory.file()) == text);
  }
}

TEST_CASE("a device without a serial number, or a user without a home, has nothing remembered") {
  const Kept kept;
  CHECK(deviceKey("dhd", "").empty());
  CHECK_THROWS_WITH_AS(kept.memory.remember("", kept.touch), doctest::Contains("no serial number"), Error);
  const DeviceMemory homeless{std::filesystem::path()};
  CHECK(homeless.devices().empty());
  CHECK_THROWS_WITH_AS(homeless.remember("haply:1", kept.touch), doctest::Contains("no home folder"), Error);
}

TEST_CASE("devices are remembered in the user's folder of settings") {
  const Kept kept;
#ifndef _WIN32
  const Variable folder("XDG_CONFIG_HOME", kept.folder.path().string());
  CHECK(DeviceMemory().file() == kept.folder / "palpate" / "devices.json");
#endif
  CHECK(DeviceMemory().file().filename() == "devices.json");
}

}  // namespace palpate::device_memory_test
