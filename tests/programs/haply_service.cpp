// A service of Haply devices, with a simulated hand that taps on what is below it, for programs of any system: prints
// the name of its configuration file, serves until its input ends, and prints the largest and the last force, the
// longest time without a command, and the number of forces in the tenth of a second after it. The hand rests above from
// each connection of a device until the file "taps" exists beside the configuration file.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <string>
#include <thread>

#include "engine/core/clock.hpp"
#include "tests/fake_devices/fake_haply.hpp"

int main() {
  using namespace palpate;
  std::vector<PathKey> hand;
  for (double t_s = 0; t_s < 60; t_s += 0.6)
    for (const auto& [after_s, height_mm] : {std::pair{0.0, 40.0}, {0.2, 40.0}, {0.3, 26.0}, {0.5, 26.0}})
      hand.push_back({t_s + after_s, {0, height_mm, 0}});
  const FakeHaply service({.hand = hand, .begins = "taps", .restarts = true});
  std::puts((service.folder() / "haply.json").string().c_str());
  std::fflush(stdout);
  for (std::string line; std::getline(std::cin, line);) {
  }
  std::vector<FakeHaply::Command> commands = service.commands();
  for (const Stopwatch since; !commands.empty() && commands.back().force_N != DVec3(0) && since.elapsed_s() < 1;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));  // the last one may be under way
    commands = service.commands();
  }
  double most_N = 0, last_N = 0, gap_s = 0, before_s = 0, gapEnds_s = 0;
  for (const FakeHaply::Command& command : commands) {
    most_N = std::max(most_N, last_N = glm::length(command.force_N));
    if (before_s > 0 && command.time_s - before_s > gap_s) {
      gap_s = command.time_s - before_s;
      gapEnds_s = command.time_s;
    }
    before_s = command.time_s;
  }
  const auto forces = std::ranges::count_if(commands, [&](const FakeHaply::Command& command) {
    return command.force_N != DVec3(0) && command.time_s >= gapEnds_s && command.time_s < gapEnds_s + 0.1;
  });
  std::printf("%.3f %.3f %.3f %d\n", most_N, last_N, gap_s, static_cast<int>(forces));
}
