// A program that runs beside the test and receives signals during its session.
#pragma once

#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <thread>

#include "tests/apps/program.hpp"

namespace palpate {

class RunningProgram {
 public:
  /// Its output goes to `said`.
  RunningProgram(const std::string& arguments, const std::filesystem::path& said) : child_(::fork()) {
    if (child_ == 0) {
      ::signal(SIGINT, SIG_IGN);  // as for a script's background processes
      // The shell is replaced by the program, so that the program itself receives signals.
      const std::string command = "exec " + program() + " " + arguments + " >'" + said.string() + "' 2>&1";
      ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      ::_exit(127);
    }
    REQUIRE(child_ > 0);
  }
  ~RunningProgram() {
    if (!ended()) wait(SIGKILL);
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  bool ended() {
    if (!ended_) ended_ = ::waitpid(child_, &status_, WNOHANG) == child_;
    return ended_;
  }
  /// Waits until `sign` is true; false if the program ends first, or after two minutes.
  bool waitFor(const std::function<bool()>& sign) {
    const auto begin = std::chrono::steady_clock::now();
    while (!sign()) {
      if (ended() || std::chrono::steady_clock::now() - begin > std::chrono::minutes(2)) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
  }
  /// Waits until the session's `log` has ticks. The time before depends on whether the driver must still compile the
  /// shaders.
  bool waitForTicks(const std::filesystem::path& log) {
    const auto bytes = [&] {
      std::error_code none;
      const auto size = std::filesystem::file_size(log, none);
      return none ? 0 : size;
    };
    constexpr std::uintmax_t kHeaderAndTicks = 16'384;  // a hundred ticks of 128
    return waitFor([&] { return bytes() > kHeaderAndTicks; });
  }
  void send(int signal) const { ::kill(child_, signal); }
  /// Sends `signal` and waits for the end; returns the status from waitpid().
  int wait(int signal) {
    if (!ended()) {
      ::kill(child_, signal);
      ::waitpid(child_, &status_, 0);
      ended_ = true;
    }
    return status_;
  }

 private:
  pid_t child_;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace palpate
