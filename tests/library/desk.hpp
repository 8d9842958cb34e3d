// A Haply service in a process of its own, whose simulated hand taps on a ball, and its user's settings.
#pragma once

#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "tests/library/ball.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/surroundings.hpp"

namespace palpate {

/// Its hand rests 40 mm above the middle and taps down to 26 mm.
class Desk {
 public:
  Desk() {
    const std::filesystem::path said = folder_ / "said", number = folder_ / "number";
    service_ = ::popen(
        ("echo $$ > " + number.string() + "; exec " + PALPATE_HAPLY_SERVICE + " > " + said.string()).c_str(), "w");
    REQUIRE(service_ != nullptr);
    std::string config;
    for (int i = 0; i < 500 && config.empty(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      std::ifstream in(said);
      if (!std::getline(in, config) || in.eof()) config.clear();
    }
    REQUIRE_FALSE(config.empty());
    std::ifstream(number) >> number_;
    config_.emplace("PALPATE_HAPLY_CONFIG", config);
    taps_ = std::filesystem::path(config).replace_filename("taps");
  }
  ~Desk() { leave(); }
  Desk(const Desk&) = delete;
  Desk& operator=(const Desk&) = delete;

  void agree(const std::string& device) const {
    std::filesystem::create_directories(folder_ / "palpate");
    std::ofstream(folder_ / "palpate" / "devices.json")
        << R"({"version": 1, "devices": {"haply:049D": )" << device << "}}";
  }
  /// From the next session on. One that began with the hand inside the ball would feel it from there.
  void rest() const { std::filesystem::remove(taps_); }
  void tap() const { std::ofstream{taps_}; }

  /// To the service.
  void send(int signal) const { REQUIRE(::kill(number_, signal) == 0); }
  struct Received {
    double most_N = -1, last_N = -1, gap_s = -1;  ///< largest and last force, longest time without a command
    int forcesAfterGap = -1;                      ///< of the 0.1 s after it
  };
  /// Ends the service, and returns what it received.
  Received leave() {
    if (service_) ::pclose(std::exchange(service_, nullptr));
    Received received;
    std::ifstream said(folder_ / "said");
    std::string config;
    std::getline(said, config);
    said >> received.most_N >> received.last_N >> received.gap_s >> received.forcesAfterGap;
    return received;
  }

 private:
  ScratchFolder folder_;
  Variable home_{"XDG_CONFIG_HOME", folder_.path().string()};
  std::filesystem::path taps_;  // exists while the hand shall tap
  std::FILE* service_ = nullptr;
  pid_t number_ = 0;
  std::optional<Variable> config_;
};

/// A ball of 30 mm radius in the hand.
inline pp_session_options smallBall() {
  pp_session_options options = cpuOptions();
  options.mm_per_unit = 0.6;
  return options;
}

inline pp_live_options haply() {
  pp_live_options options = pp_default_live_options();
  options.device = "haply";
  return options;
}

}  // namespace palpate
