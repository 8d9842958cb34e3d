// The rooms and their allowed dependencies: compares every include with the table below.
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
      {"engine/core", {"shaders/shared/brush.h", "shaders/shared/contact.h", "shaders/shared/frame.h"}},
      {"engine/cloud", {"engine/core"}},
      {"engine/matter", {"engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/io", {"engine/matter", "engine/cloud", "engine/core"}},
      {"engine/gpu", {"engine/core"}},
      {"engine/spatial", {"engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/contact", {"engine/spatial", "engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/edit", {"engine/contact", "engine/spatial", "engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/motion", {"engine/spatial", "engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/touch",
       {"engine/matter", "engine/motion", "engine/edit", "engine/contact", "engine/spatial", "engine/gpu",
        "engine/cloud", "engine/core", "shaders"}},
      {"engine/mesh",
       {"engine/contact", "engine/spatial", "engine/gpu", "engine/io", "engine/cloud", "engine/core", "shaders"}},
      {"engine/study", {"engine/contact", "engine/spatial", "engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"engine/cuda", {"engine/touch/touch_backend.hpp", "engine/cloud", "engine/core", "shaders"}},
      {"engine/render",
       {"engine/edit/edit_log.hpp", "engine/spatial", "engine/gpu", "engine/cloud", "engine/core", "shaders"}},
      {"haptics", {"engine/core", "engine/cloud"}},
      {"haptics/session",
       {"haptics", "engine/core", "engine/cloud", "engine/io", "engine/contact", "engine/edit", "engine/motion",
        "engine/matter", "engine/touch", "engine/render", "engine/gpu/device.hpp", "engine/spatial/hash_grid.hpp",
        "shaders"}},
      {"haptics/sharing",
       {"haptics/session", "haptics", "engine/core", "engine/cloud", "engine/edit", "engine/motion", "engine/matter",
        "engine/touch"}},
      {"haptics/study", {"haptics/session", "haptics", "engine/cuda", "engine/core", "engine/cloud"}},
      {"haptics/library",
       {"haptics/session", "haptics/sharing/network.hpp", "haptics/sharing/server_thread.hpp",
        "haptics/sharing/session_joiner.hpp", "haptics", "engine/core", "engine/cloud", "engine/io",
        "engine/edit/journal.hpp", "engine/matter", "engine/mesh", "engine/motion/cloud_source.hpp",
        "engine/render/image.hpp", "engine/gpu/device_lookup.hpp", "engine/gpu/host_device.hpp"}},
      {"shaders", {"engine/core/vec.hpp"}},
      {"apps",
       {"engine/core",
        "engine/cloud",
        "engine/io",
        "engine/gpu",
        "engine/spatial/hash_grid.hpp",
        "engine/contact",
        "engine/motion",
        "engine/matter",
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
      {"apps/bench",
       {"apps",
        "engine/core",
        "engine/cloud",
        "engine/io",
        "engine/gpu",
        "engine/spatial",
        "engine/contact",
        "engine/edit",
        "engine/motion",
        "engine/matter",
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
        "haptics/study",
        "shaders"}},
  };
  return arrows;
}

// Rooms of the annexes PALPATE_NETWORK and PALPATE_STUDY. The core builds without them.
bool isAnnex(const std::string& room) {
  static const std::set<std::string> annexes{"haptics/sharing", "engine/study", "engine/cuda", "haptics/study",
                                             "apps/bench"};
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
  CHECK(complaint("apps/cli/touch.cpp", "haptics/sharing/brick_source.hpp"));
  CHECK(complaint("engine/contact/gather.cpp", "engine/study/gather_brute.hpp"));
  CHECK(complaint("apps/cli/render.cpp", "apps/bench/picture_way.hpp"));
  CHECK_FALSE(complaint("apps/cli/serve.cpp", "haptics/sharing/shared_cloud.hpp"));
}

TEST_CASE("a forbidden include is detected") {
  CHECK(complaint("haptics/servo_loop.cpp", "engine/gpu/device.hpp"));
  CHECK(complaint("engine/core/log.cpp", "engine/cloud/point_cloud.hpp"));
  CHECK(complaint("engine/cloud/point_cloud.hpp", "engine/io/ply_header.hpp"));
  CHECK(complaint("engine/render/frame.cpp", "engine/edit/edit_pass.hpp"));
  CHECK(complaint("engine/gpu/device.cpp", "device.hpp"));
  CHECK_FALSE(complaint("engine/render/frame.cpp", "engine/edit/edit_log.hpp"));
  CHECK(complaint("apps/cli/touch.cpp", "engine/touch/touch_side.hpp"));
  CHECK_FALSE(complaint("haptics/session/vulkan_backend.cpp", "engine/touch/touch_side.hpp"));
}

}  // namespace palpate::architecture_test
