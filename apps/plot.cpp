#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "apps/plot.hpp"
#include "apps/plot_scripts.hpp"
#include "engine/core/error.hpp"

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

int run(const std::string& program, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), program);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, pointers.data(), environ) != 0) return 127;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

// The system's own python knows the system's packages; another one may come first on the path.
std::string pythonWithMatplotlib() {
  for (const char* python : {"/usr/bin/python3", "python3"})
    if (run(python, {"-c", "import importlib.util, sys; sys.exit(not importlib.util.find_spec('matplotlib'))"}) == 0)
      return python;
  throw Error("--plot: no python3 with matplotlib was found; install python3-matplotlib");
}

const char* textOf(PlotScript script) {
  switch (script) {
    case PlotScript::bench:
      return plot_script::kBench;
    case PlotScript::touch:
      return plot_script::kTouch;
    case PlotScript::edit:
      return plot_script::kEdit;
  }
  return "";
}

}  // namespace

void plot(PlotScript script, const Json& result, const std::string& file) {
  const ScratchFolder folder;
  const std::string json = folder.path() / "result.json", main = folder.path() / "plot.py";
  std::ofstream(json) << result.dump();
  std::ofstream(main) << textOf(script);
  std::ofstream(folder.path() / "plot_page.py") << plot_script::kPage;  // what the scripts share
  if (run(pythonWithMatplotlib(), {main, json, std::filesystem::absolute(file).string()}) != 0)
    throw Error("{}: the plot could not be drawn; see what it said above", file);
}

}  // namespace palpate
