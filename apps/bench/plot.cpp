#include <filesystem>
#include <fstream>

#include "apps/bench/plot.hpp"
#include "apps/bench/plot_scripts.hpp"
#include "apps/cli/run_program.hpp"
#include "engine/core/error.hpp"
#include "engine/core/system_file.hpp"

namespace palpate {

namespace {

// A temporary folder, deleted with its contents.
class ScratchFolder {
 public:
  ScratchFolder() {
    const std::filesystem::path all = std::filesystem::temp_directory_path();
    std::error_code error;
    for (int number = 0; !error; ++number) {
      path_ = all / fmt::format("palpate-{}-{}", processNumber(), number);
      if (std::filesystem::create_directory(path_, error)) return;  // otherwise the name is taken
    }
    throw Error("{}: cannot create a temporary folder there: {}", all.string(), error.message());
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

std::string pythonWithMatplotlib() {
  for (const std::string& python : pythonNames())
    if (runProgram(python,
                   {"-c", "import importlib.util, sys; sys.exit(not importlib.util.find_spec('matplotlib'))"}) == 0)
      return python;
  throw Error("--plot requires python3 with matplotlib; install python3-matplotlib");
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
  const std::filesystem::path json = folder.path() / "result.json", main = folder.path() / "plot.py";
  std::ofstream(json) << result.dump();
  std::ofstream(main) << textOf(script);
  std::ofstream(folder.path() / "plot_page.py") << plot_script::kPage;  // shared by the scripts
  if (runProgram(pythonWithMatplotlib(), {main.string(), json.string(), std::filesystem::absolute(file).string()}) != 0)
    throw Error("{}: cannot draw the plot; see the message above", file);
}

}  // namespace palpate
