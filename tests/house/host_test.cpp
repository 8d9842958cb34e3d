// Code that runs without a GPU is built without Vulkan: follows every include of it, directly and indirectly.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/source_folder.hpp"

namespace palpate::host_test {

namespace {

namespace fs = std::filesystem;

// The includes of a file as written, without their quotes or brackets; nothing if the file does not exist.
using Includes = std::function<std::optional<std::vector<std::string>>(const std::string& file)>;

bool isVulkan(const std::string& included) {
  return included.starts_with("engine/gpu/") || included.starts_with("vulkan/") || included == "volk.h";
}

// The chain of includes from `file` to Vulkan; empty if there is none. Files in `seen` are not examined again.
std::string wayToVulkan(const std::string& file, const Includes& includesOf, std::set<std::string>& seen) {
  if (!seen.insert(file).second) return {};
  const auto includes = includesOf(file);
  if (!includes) return {};
  for (const std::string& included : *includes) {
    if (isVulkan(included)) return file + " -> " + included;
    if (const std::string way = wayToVulkan(included, includesOf, seen); !way.empty()) return file + " -> " + way;
  }
  return {};
}

std::optional<std::vector<std::string>> includesOf(const std::string& file) {
  std::ifstream in(sourceFolder() / file);
  if (!in) return std::nullopt;
  std::vector<std::string> found;
  for (std::string line; std::getline(in, line);) {
    std::erase_if(line, [](char c) { return c == ' ' || c == '\t'; });
    for (const auto& [begin, end] : {std::pair<std::string, char>{"#include\"", '"'}, {"#include<", '>'}})
      if (line.starts_with(begin))
        found.push_back(line.substr(begin.size(), line.find(end, begin.size()) - begin.size()));
  }
  return found;
}

}  // namespace

TEST_CASE("no file that runs without a GPU includes Vulkan, directly or indirectly") {
  if (!fs::exists(sourceFolder() / "engine")) {
    MESSAGE("skipped: the sources are not at " << sourceFolder().string());
    return;
  }
  std::ifstream sources(PALPATE_HOST_SOURCES);
  std::set<std::string> seen;
  std::size_t files = 0;
  for (std::string file; std::getline(sources, file); ++files) {
    CHECK_MESSAGE(fs::exists(sourceFolder() / file), file);
    const std::string way = wayToVulkan(file, includesOf, seen);
    CHECK_MESSAGE(way.empty(), way);
  }
  CHECK(files > 100);
  CHECK(seen.contains("engine/touch/cpu_touch.hpp"));
  CHECK(seen.contains("shaders/shared/types.h"));
}

TEST_CASE("an indirect include of Vulkan is detected") {
  const auto wayWith = [](const std::string& last) {
    std::set<std::string> seen;
    const auto made = [&](const std::string& file) -> std::optional<std::vector<std::string>> {
      if (file == "a.cpp") return {{"string", "a.hpp", "b.hpp"}};
      if (file == "a.hpp") return {{"b.hpp"}};
      if (file == "b.hpp") return {{"a.hpp", last}};
      return std::nullopt;
    };
    return wayToVulkan("a.cpp", made, seen);
  };
  CHECK(wayWith("vector").empty());
  CHECK(wayWith("engine/gpu/device.hpp") == "a.cpp -> a.hpp -> b.hpp -> engine/gpu/device.hpp");
  CHECK(wayWith("vulkan/vulkan.h") == "a.cpp -> a.hpp -> b.hpp -> vulkan/vulkan.h");
  CHECK(wayWith("volk.h") == "a.cpp -> a.hpp -> b.hpp -> volk.h");
}

}  // namespace palpate::host_test
