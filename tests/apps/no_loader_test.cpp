// A machine without a Vulkan loader: all that needs no GPU works, and what needs one says what to install.
#include <algorithm>
#include <fstream>

#include "tests/apps/program.hpp"
#include "tests/content_of.hpp"
#include "tests/says.hpp"

namespace palpate::no_loader_test {

namespace {

/// Runs palpate where the first loader that is found is not a library.
struct Machine {
  Machine() {
    for (const char* name : {"libvulkan.so", "libvulkan.so.1"}) std::ofstream(folder / name) << "no library";
  }
  Outcome palpate(const std::string& arguments) const {
    return run("LD_LIBRARY_PATH=" + folder.path().string() + " " + program() + " " + arguments);
  }
  std::string file(const std::string& name) const { return (folder / name).string(); }
  ScratchFolder folder;
};

}  // namespace

TEST_CASE("doctor without a Vulkan loader reports everything else, and that no GPU can be used") {
  const Machine machine;
  const Outcome outcome = machine.palpate("doctor --servo 0.1 --json " + machine.file("doctor.json"));
  CHECK(outcome.code == 1);
  for (const char* part : {"GPU: none. no Vulkan loader", "--device openhaptics", "Display: none", "Empty servo loop",
                           "work on the processor", "install the package libvulkan1", "mesa-vulkan-drivers"})
    CHECK(says(outcome.text, part));
  const auto found = jsonOf(machine.file("doctor.json"));
  CHECK(found["gpus"].empty());
  CHECK(found["in_use"].is_null());
  CHECK(found["haptics"].contains("drivers"));
}

TEST_CASE("without a Vulkan loader files are made, converted and felt on the CPU") {
  const Machine machine;
  const std::string model = machine.file("model.ply"), other = machine.file("model.las");
  for (const std::string& arguments :
       {"make sphere -n 5000 -o " + model, "info " + model, "convert " + model + " " + other,
        "touch --backend cpu " + other, "touch " + other, std::string("simulate jelly --duration 0.01")}) {
    const Outcome outcome = machine.palpate(arguments);
    CAPTURE(arguments + ": " + outcome.text);
    CHECK(outcome.code == 0);
  }
}

TEST_CASE("without a Vulkan loader touch --picture is refused before the session, and the error is written as JSON") {
  const Machine machine;
  const std::string model = machine.file("model.ply"), json = machine.file("out.json");
  REQUIRE(machine.palpate("make sphere -n 500 -o " + model).code == 0);
  const Outcome outcome = machine.palpate("touch --backend cpu --picture " + machine.file("a.png") + " --trace " +
                                          machine.file("t.csv") + " --json " + json + " " + model);
  CHECK(outcome.code == 1);
  CHECK_FALSE(std::filesystem::exists(machine.file("t.csv")));
  CHECK(says(std::string(jsonOf(json)["error"]), "no Vulkan loader"));
  CHECK(jsonOf(json)["exit_code"] == 1);
  // A file that exists may be the model of a command that was not understood.
  const std::string before = contentOf(model), other = machine.file("other.json");
  CHECK(machine.palpate("info --nonsense --json " + model).code == 2);
  CHECK(contentOf(model) == before);
  CHECK(machine.palpate("info --json=" + other + " --nonsense").code == 2);
  CHECK(says(std::string(jsonOf(other)["error"]), "--nonsense"));
  CHECK(jsonOf(other)["exit_code"] == 2);
}

TEST_CASE("without a Vulkan loader each command that needs a GPU says in one line what to install") {
  const Machine machine;
  const std::string model = machine.file("model.ply");
  REQUIRE(machine.palpate("make sphere -n 500 -o " + model).code == 0);
  for (const std::string& arguments :
       {"touch --quiet --backend vulkan " + model, "render --quiet -o " + machine.file("a.png") + " " + model,
        "mesh --quiet -o " + machine.file("a.ply") + " " + model}) {
    const Outcome outcome = machine.palpate(arguments);
    CAPTURE(arguments + ": " + outcome.text);
    CHECK(outcome.code == 1);
    CHECK(says(outcome.text, "install the package libvulkan1"));
    CHECK(std::ranges::count(outcome.text, '\n') == 1);
  }
  CHECK_FALSE(std::filesystem::exists(machine.file("a.png")));
  CHECK_FALSE(std::filesystem::exists(machine.file("a.ply")));
}

}  // namespace palpate::no_loader_test
