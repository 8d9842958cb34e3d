#include "engine/core/thread_priority.hpp"

#include <sys/resource.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <string>

namespace palpate {

namespace {

constexpr int kNice = 10;  // of 19; a tenth of the time of an ordinary thread

// Linux has a nice value for each thread.
void makeNice(id_t thread) noexcept {
  if (::getpriority(PRIO_PROCESS, thread) < kNice) ::setpriority(PRIO_PROCESS, thread, kNice);
}

}  // namespace

void giveWay() noexcept { makeNice(0); }

void letThreadsGiveWay(std::string_view names) noexcept {
  try {
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) {
      std::string name;
      std::getline(std::ifstream(entry.path() / "comm"), name);
      const std::string number = entry.path().filename().string();
      id_t thread = 0;
      std::from_chars(number.data(), number.data() + number.size(), thread);
      if (name.starts_with(names) && thread != 0) makeNice(thread);
    }
  } catch (const std::exception&) {  // without /proc nobody is told
  }
}

}  // namespace palpate
