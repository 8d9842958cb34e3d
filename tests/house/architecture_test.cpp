// The rooms and their allowed dependencies: compares every include, and every declaration of a type that another room
// defines, with the table below.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/source_folder.hpp"

namespace palpate::architecture_test {

namespace {

namespace fs = std::filesystem;
using Arrows = std::map<std::string, std::set<std::string>>;

// The rooms that a room may include, besides itself. A single file may stand for its room.
const Arrows& allowedArrows() {
  static const Arrows arrows{
      {"engine/core",
       {"shaders/shared/brush.h", "shaders/shared/brush_traits.h", "shaders/shared/contact.h",
        "shaders/shared/frame.h"}},
      {"engine/cloud", {"engine/core"}},
      {"engine/io", {"engine/cloud", "engine/core"}},
      {"engine/gpu", {"engine/core"}},
      {"engine/spatial", {"engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/proof", {"engine/spatial", "engine/gpu", "engine/core", "shaders"}},
      {"engine/contact", {"engine/spatial", "engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/edit", {"engine/contact", "engine/spatial", "engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/motion", {"engine/spatial", "engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/touch",
       {"engine/motion", "engine/edit", "engine/contact", "engine/spatial", "engine/gpu", "engine/cloud", "engine/core",
        "shaders"}},
      {"engine/matter",
       {"engine/touch/touch_backend.hpp", "engine/touch/probe_group.hpp", "engine/motion/cloud_source.hpp",
        "engine/edit/placed_brush.hpp", "engine/contact/proxy_tracker.hpp", "engine/io", "engine/gpu", "engine/cloud",
        "engine/core", "shaders"}},
      {"engine/mesh",
       {"engine/contact", "engine/spatial", "engine/gpu", "engine/io", "engine/cloud", "engine/core", "shaders"}},
      {"engine/study", {"engine/contact", "engine/spatial", "engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/cuda",
       {"engine/touch/touch_backend.hpp", "engine/edit/spacing_measure.hpp", "engine/spatial", "engine/cloud",
        "engine/core", "shaders"}},
      {"engine/render",
       {"engine/edit/edit_log.hpp", "engine/spatial", "engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/select",
       {"engine/contact/surface.hpp", "engine/spatial", "engine/render/camera.hpp", "engine/render/depth_picture.hpp",
        "engine/cloud", "engine/core", "shaders"}},
      {"haptics", {"engine/core", "engine/cloud"}},
      {"haptics/session",
       {"haptics", "engine/core", "engine/cloud", "engine/io", "engine/contact", "engine/edit", "engine/motion",
        "engine/select", "engine/touch", "engine/render", "engine/proof", "engine/gpu/device.hpp",
        "engine/spatial/hash_grid.hpp", "shaders"}},
      {"haptics/simulation",
       {"haptics/session", "haptics", "engine/core", "engine/cloud", "engine/io", "engine/gpu/device.hpp",
        "engine/matter"}},
      {"haptics/sharing",
       {"haptics/session", "haptics/simulation", "haptics", "engine/core", "engine/cloud", "engine/edit",
        "engine/motion", "engine/matter", "engine/touch"}},
      {"haptics/study", {"haptics/session", "haptics", "engine/cuda", "engine/core", "engine/cloud"}},
      {"haptics/library",
       {"haptics/session", "haptics/sharing/network.hpp", "haptics/sharing/server_thread.hpp",
        "haptics/sharing/session_joiner.hpp", "haptics", "engine/core", "engine/cloud", "engine/io",
        "engine/contact/surface_index.hpp", "engine/edit/history.hpp", "engine/select", "engine/mesh",
        "engine/motion/cloud_source.hpp", "engine/render/image.hpp", "engine/proof", "engine/gpu/device_lookup.hpp",
        "engine/gpu/host_device.hpp"}},
      {"shaders", {"engine/core/vec.hpp"}},
      {"apps",
       {"engine/core",
        "engine/cloud",
        "engine/io",
        "engine/gpu",
        "engine/spatial/hash_grid.hpp",
        "engine/proof",
        "engine/contact",
        "engine/motion",
        "engine/select",
        "engine/touch/memory.hpp",
        "engine/touch/touch_backend.hpp",
        "engine/mesh",
        "engine/render",
        "haptics",
        "haptics/session",
        "haptics/sharing/network.hpp",
        "haptics/sharing/ros.hpp",
        "haptics/sharing/security.hpp",
        "haptics/sharing/session_joiner.hpp",
        "haptics/sharing/shared_cloud.hpp",
        "haptics/study/cuda_backend.hpp",
        "shaders"}},
      {"apps/simulation",
       {"apps", "engine/core", "engine/cloud", "engine/io", "engine/gpu", "engine/matter", "haptics", "haptics/session",
        "haptics/simulation"}},
      {"apps/bench",
       {"apps",
        "apps/simulation",
        "engine/core",
        "engine/cloud",
        "engine/io",
        "engine/gpu",
        "engine/spatial",
        "engine/contact",
        "engine/edit",
        "engine/motion",
        "engine/matter",
        "engine/select",
        "engine/touch/memory.hpp",
        "engine/touch/touch_backend.hpp",
        "engine/touch/gpu_points.hpp",
        "engine/mesh",
        "engine/render",
        "engine/study",
        "engine/cuda/cuda_measure.hpp",
        "haptics",
        "haptics/session",
        "haptics/sharing",
        "haptics/simulation",
        "haptics/study",
        "shaders"}},
  };
  return arrows;
}

// Rooms of the annexes PALPATE_SIMULATION, PALPATE_NETWORK and PALPATE_STUDY. The core builds without them.
bool isAnnex(const std::string& room) {
  static const std::set<std::string> annexes{"engine/matter",   "haptics/simulation", "apps/simulation",
                                             "haptics/sharing", "engine/study",       "engine/cuda",
                                             "haptics/study",   "apps/bench"};
  return annexes.contains(room);
}

std::optional<std::string> roomOf(const std::string& path) {
  std::optional<std::string> innermost;  // a room may be inside another one
  for (const auto& [room, unused] : allowedArrows())
    if (path.starts_with(room + "/") && (!innermost || room.size() > innermost->size())) innermost = room;
  return innermost;
}

// Why `file` (relative to the top) may not include `included`; nothing if it may.
std::optional<std::string> complaint(const std::string& file, const std::string& included) {
  const auto from = roomOf(file);
  const auto to = roomOf(included);
  if (!from) return file + " is in no room";
  if (!to) return file + " includes \"" + included + "\", which is not a path from the top of the tree";
  const auto& allowed = allowedArrows().at(*from);
  if (*from == *to || allowed.contains(*to) || allowed.contains(included)) return std::nullopt;
  return file + " includes \"" + included + "\": room " + *from + " may not include " + *to;
}

std::vector<std::string> includesOf(const fs::path& file) {
  std::vector<std::string> found;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::erase_if(line, [](char c) { return c == ' ' || c == '\t'; });
    constexpr std::string_view kInclude = "#include\"";
    if (!line.starts_with(kInclude)) continue;
    const auto end = line.find('"', kInclude.size());
    found.push_back(line.substr(kInclude.size(), end - kInclude.size()));
  }
  return found;
}

// A line such as "class Device;" or "struct Vec {": the name of the type, and whether it is defined there. Only types
// outside classes and functions.
struct TypeLine {
  std::string name;
  bool isDefined = false;
};
std::optional<TypeLine> typeOf(const std::string& line) {
  std::istringstream words(line);
  std::string kind, name;
  words >> kind;
  if (line.starts_with(' ') || (kind != "class" && kind != "struct" && kind != "enum")) return std::nullopt;
  words >> name;
  if (name == "class") words >> name;
  const auto end = name.find_first_of(";:{");
  const bool isDefined = line.find('{') != std::string::npos;
  if (!isDefined && !line.ends_with(';')) return std::nullopt;
  return TypeLine{.name = name.substr(0, end), .isDefined = isDefined};
}

std::vector<TypeLine> typesOf(const fs::path& file) {
  std::vector<TypeLine> found;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (auto type = typeOf(line)) found.push_back(std::move(*type));
  return found;
}

// Why `file` may not declare a type that is defined in one of these headers; nothing if it may.
std::optional<std::string> complaint(const std::string& file, const std::string& type,
                                     const std::set<std::string>& headers) {
  for (const std::string& header : headers)
    if (!complaint(file, header)) return std::nullopt;
  return file + " declares " + type + " of " + *headers.begin() + ": its room may not know that room";
}

bool isSource(const fs::path& file) {
  static const std::set<std::string> endings{".cpp", ".hpp", ".h", ".cu", ".cuh", ".comp", ".glsl", ".vert", ".frag"};
  return endings.contains(file.extension().string());
}

}  // namespace

TEST_CASE("every include follows an allowed dependency between rooms") {
  const fs::path top = sourceFolder();
  if (!fs::exists(top / "engine")) {
    MESSAGE("skipped: the sources are not at " << top.string());
    return;
  }
  std::size_t files = 0, includes = 0;
  for (const char* folder : {"engine", "haptics", "shaders", "apps"}) {
    for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
      if (!entry.is_regular_file() || !isSource(entry.path())) continue;
      ++files;
      for (const std::string& included : includesOf(entry.path())) {
        ++includes;
        const auto wrong = complaint(fs::relative(entry.path(), top).generic_string(), included);
        CHECK_MESSAGE(!wrong, wrong.value_or(""));
      }
    }
  }
  CHECK(files > 50);
  CHECK(includes > 100);
}

TEST_CASE("every declared type of another room follows an allowed dependency") {
  const fs::path top = sourceFolder();
  if (!fs::exists(top / "engine")) {
    MESSAGE("skipped: the sources are not at " << top.string());
    return;
  }
  std::map<std::string, std::set<std::string>> definedIn;
  std::vector<std::pair<std::string, std::string>> declared;  // file, type
  for (const char* folder : {"engine", "haptics", "apps"}) {
    for (const auto& entry : fs::recursive_directory_iterator(top / folder)) {
      if (entry.path().extension() != ".hpp") continue;
      const std::string file = fs::relative(entry.path(), top).generic_string();
      for (const TypeLine& type : typesOf(entry.path())) {
        if (type.isDefined) definedIn[type.name].insert(file);
        if (!type.isDefined) declared.emplace_back(file, type.name);
      }
    }
  }
  std::size_t known = 0;
  for (const auto& [file, type] : declared) {
    const auto headers = definedIn.find(type);
    if (headers == definedIn.end()) continue;  // defined in a source file, or elsewhere
    ++known;
    const auto wrong = complaint(file, type, headers->second);
    CHECK_MESSAGE(!wrong, wrong.value_or(""));
  }
  CHECK(known > 50);
}

TEST_CASE("the dependencies between rooms have no cycle") {
  // Depth-first, with the rooms on the path.
  std::set<std::string> done;
  const auto visit = [&](const auto& self, const std::string& room, std::set<std::string> way) -> void {
    CHECK_MESSAGE(!way.contains(room), room << " depends on itself");
    if (way.contains(room) || done.contains(room)) return;
    way.insert(room);
    for (const std::string& next : allowedArrows().at(room)) {
      if (!allowedArrows().contains(next)) continue;  // one header is not a room
      self(self, next, way);
    }
    done.insert(room);
  };
  for (const auto& [room, unused] : allowedArrows()) visit(visit, room, {});
}

TEST_CASE("the core includes no annex, except the headers that stand in for one that is not built") {
  for (const auto& [from, rooms] : allowedArrows())
    for (const std::string& to : rooms)
      CHECK_MESSAGE((isAnnex(from) || !isAnnex(to)), from << " may include all of " << to);
  CHECK(complaint("haptics/session/session.cpp", "haptics/sharing/brick_touch.hpp"));
  CHECK(complaint("haptics/session/model.cpp", "engine/matter/matter_scene.hpp"));
  CHECK(complaint("haptics/library/matter.cpp", "haptics/simulation/scene_names.hpp"));
  CHECK(complaint("engine/touch/cpu_touch.cpp", "engine/matter/soft_touch.hpp"));
  CHECK(complaint("apps/cli/touch.cpp", "haptics/sharing/brick_source.hpp"));
  CHECK(complaint("engine/contact/gather.cpp", "engine/study/dynamic_tree.hpp"));
  CHECK(complaint("apps/cli/render.cpp", "apps/bench/picture_judge.hpp"));
  CHECK_FALSE(complaint("apps/cli/serve.cpp", "haptics/sharing/shared_cloud.hpp"));
}

TEST_CASE("a forbidden include and a forbidden declaration are detected") {
  CHECK(complaint("haptics/servo_loop.cpp", "engine/gpu/device.hpp"));
  CHECK(complaint("engine/core/log.cpp", "engine/cloud/point_cloud.hpp"));
  CHECK(complaint("engine/cloud/point_cloud.hpp", "engine/io/ply_header.hpp"));
  CHECK(complaint("engine/render/frame.cpp", "engine/edit/edit_pass.hpp"));
  CHECK(complaint("engine/gpu/device.cpp", "device.hpp"));
  CHECK_FALSE(complaint("engine/render/frame.cpp", "engine/edit/edit_log.hpp"));
  CHECK(complaint("apps/cli/touch.cpp", "engine/touch/touch_side.hpp"));
  CHECK(typeOf("class Device;")->name == "Device");
  CHECK(typeOf("enum class Kind : std::uint32_t;")->name == "Kind");
  CHECK(typeOf("struct Pose {")->isDefined);
  CHECK_FALSE(typeOf("  class Inner;"));
  CHECK(complaint("engine/core/log.hpp", "Device", {"engine/gpu/device.hpp"}));
  CHECK_FALSE(complaint("engine/touch/touch_side.hpp", "Device", {"engine/gpu/device.hpp"}));
  CHECK_FALSE(complaint("haptics/session/vulkan_backend.cpp", "engine/touch/touch_side.hpp"));
}

}  // namespace palpate::architecture_test
