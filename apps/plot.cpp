#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "apps/bench.hpp"
#include "apps/plot_bench.hpp"

namespace palpate {

namespace {

// A folder that goes away with what is in it.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "palpate-XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw Error("{}: no folder for temporary files could be made there", pattern);
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

int runPython(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "python3");
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawnp(&child, "python3", nullptr, nullptr, pointers.data(), environ) != 0)
    throw Error("--plot: python3 could not be started; install python3-matplotlib");
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

}  // namespace

void plotRecords(const Json& result, const std::string& file) {
  const ScratchFolder folder;
  const std::string json = folder.path() / "result.json";
  std::ofstream(json) << result.dump();
  if (runPython({"-c", plot_script::kBench, json, std::filesystem::absolute(file).string()}) != 0)
    throw Error("{}: the plot could not be drawn; install python3-matplotlib, and see what it said above", file);
}

}  // namespace palpate
