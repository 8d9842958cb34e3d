// The format of the sources: clang-format's for C, C++ and CUDA, and at most 120 columns in every file.
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <future>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/source_folder.hpp"

namespace palpate::format_test {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxColumns = 120;
constexpr const char* kFolders[] = {"apps", "engine", "haptics", "shaders", "tests", "third_party"};

bool isFormatted(const fs::path& file) {
  static const std::set<std::string> endings{".cpp", ".hpp", ".h", ".c", ".cu", ".cuh"};
  return endings.contains(file.extension().string());
}

// Includes GLSL, which clang-format does not support.
bool isSource(const fs::path& file) {
  static const std::set<std::string> endings{".bash", ".cmake", ".comp", ".cs",  ".frag", ".glsl",  ".idl", ".in",
                                             ".map",  ".mjs",   ".py",   ".pyi", ".rc",   ".rules", ".sh",  ".vert"};
  return isFormatted(file) || endings.contains(file.extension().string()) || file.filename() == "CMakeLists.txt";
}

// Sources for which `wanted` is true, relative to the top.
std::vector<std::string> sources(bool (*wanted)(const fs::path&)) {
  const fs::path top = sourceFolder();
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(top))
    if (entry.is_regular_file() && wanted(entry.path())) found.push_back(entry.path().filename().string());
  for (const char* folder : kFolders)
    for (const auto& entry : fs::recursive_directory_iterator(top / folder))
      if (entry.is_regular_file() && wanted(entry.path()))
        found.push_back(fs::relative(entry.path(), top).generic_string());
  return found;
}

struct LongLine {
  std::size_t number, columns;
  bool operator==(const LongLine&) const = default;
};

// Lines of a UTF-8 text with more than kMaxColumns characters.
std::vector<LongLine> longLines(std::string_view text) {
  std::vector<LongLine> found;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const std::string_view line = text.substr(0, text.find('\n'));
    std::size_t columns = 0;
    for (const char byte : line) columns += (static_cast<unsigned char>(byte) & 0xc0) != 0x80;
    if (columns > kMaxColumns) found.push_back({number, columns});
    text.remove_prefix(std::min(text.size(), line.size() + 1));
  }
  return found;
}

struct Outcome {
  int code = 0;
  std::string text;
};

Outcome shell(const std::string& command) {
  Outcome outcome;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (!pipe) return {-1, "popen: no process"};
  std::array<char, 4096> piece;
  while (const std::size_t size = std::fread(piece.data(), 1, piece.size(), pipe))
    outcome.text.append(piece.data(), size);
  const int status = ::pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

// Changes that clang-format would make in `files` below `top`; empty if none. Runs a process for every kBatch files.
std::string unformatted(const fs::path& top, const std::vector<std::string>& files) {
  constexpr std::size_t kBatch = 400;  // their names fit into one argument of a shell
  std::vector<std::future<Outcome>> running;
  for (std::size_t first = 0; first < files.size(); first += kBatch) {
    std::string command = "cd '" + top.string() + "' && clang-format --dry-run -Werror";
    for (std::size_t i = first; i < std::min(first + kBatch, files.size()); ++i) command += " '" + files[i] + "'";
    running.push_back(std::async(std::launch::async, shell, command));
  }
  std::string text;
  for (auto& each : running)
    if (const Outcome outcome = each.get(); outcome.code != 0)
      text += outcome.text.empty() ? "clang-format failed without a message\n" : outcome.text;
  return text;
}

// Why the clang-format with this `version` output cannot be used; empty if it can. Versions format differently.
std::string wrongVersion(const Outcome& version) {
  if (version.code == 0 && version.text.find("clang-format version 14.") != std::string::npos) return {};
  return "requires clang-format 14 (Debian 12's package clang-format, which third_party/install.sh installs); " +
         (version.code == 0 ? "found: " + version.text : "it was not found: " + version.text);
}

bool hasSources() {
  if (fs::exists(sourceFolder() / "engine")) return true;
  MESSAGE("skipped: the sources are not at " << sourceFolder().string());
  return false;
}

}  // namespace

TEST_CASE("every C, C++ and CUDA source is formatted as by clang-format 14") {
  if (!hasSources()) return;
  const std::string wrong = wrongVersion(shell("clang-format --version"));
  REQUIRE_MESSAGE(wrong.empty(), wrong);
  const auto files = sources(isFormatted);
  CHECK(files.size() > 1000);
  const std::string changes = unformatted(sourceFolder(), files);
  CHECK_MESSAGE(changes.empty(), "not formatted (clang-format -i FILE does it):\n" << changes);
}

TEST_CASE("no line of a source is longer than 120 columns") {
  if (!hasSources()) return;
  const auto files = sources(isSource);
  CHECK(files.size() > 1200);
  for (const std::string& file : files) {
    std::stringstream text;
    text << std::ifstream(sourceFolder() / file).rdbuf();
    for (const auto& [number, columns] : longLines(text.str()))
      FAIL_CHECK(file << ":" << number << ": " << columns << " columns, at most " << kMaxColumns << " are allowed");
  }
}

TEST_CASE("a source that clang-format would change is reported, and a formatted one is not") {
  if (!hasSources()) return;
  const ScratchFolder folder;
  fs::copy_file(sourceFolder() / ".clang-format", folder / ".clang-format");
  std::ofstream(folder / "good.cpp") << "int sum(int a, int b) { return a + b; }\n";
  std::ofstream(folder / "bad.cu") << "int sum( int a,int b ) {\n    return a+b; }\n";
  const std::string changes = unformatted(folder.path(), {"good.cpp", "bad.cu"});
  CHECK_MESSAGE(says(changes, "bad.cu:1:"), changes);
  CHECK_MESSAGE(changes.find("good.cpp") == std::string::npos, changes);
  CHECK(unformatted(folder.path(), {"good.cpp"}).empty());
  CHECK_FALSE(unformatted(folder.path(), {"missing.cpp"}).empty());
}

TEST_CASE("line length is measured in characters, without the line end") {
  const std::string full(kMaxColumns, 'x');
  std::string accents;
  for (std::size_t i = 0; i < kMaxColumns; ++i) accents += "\u00e9";
  CHECK(longLines("").empty());
  CHECK(longLines(full).empty());
  CHECK(longLines(full + "\n" + full + "\n").empty());
  CHECK(longLines(accents + "\n").empty());
  CHECK(longLines(full + "y") == std::vector<LongLine>{{1, kMaxColumns + 1}});
  CHECK(longLines("a\n\n" + accents + "bc\n" + full + "\n") == std::vector<LongLine>{{3, kMaxColumns + 2}});
}

TEST_CASE("any clang-format but version 14 is refused with the name of the package") {
  CHECK(wrongVersion({0, "Debian clang-format version 14.0.6\n"}).empty());
  CHECK(says(wrongVersion({0, "Ubuntu clang-format version 15.0.7\n"}), "15.0.7"));
  CHECK(says(wrongVersion({0, "Ubuntu clang-format version 15.0.7\n"}), "package clang-format"));
  CHECK(says(wrongVersion({127, "sh: 1: clang-format: not found\n"}), "package clang-format"));
}

}  // namespace palpate::format_test
