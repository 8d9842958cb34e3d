// A service of Haply devices, with a simulated hand that taps on what is below it, for programs of any system: prints
// the name of its configuration file, serves until its input ends, and prints the largest and the last force. The hand
// rests above from each connection of a device until the file "taps" exists beside the configuration file.
#include <cstdio>
#include <iostream>
#include <string>

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
  double most_N = 0, last_N = 0;
  for (const FakeHaply::Command& command : service.commands())
    most_N = std::max(most_N, last_N = glm::length(command.force_N));
  std::printf("%.3f %.3f\n", most_N, last_N);
}
