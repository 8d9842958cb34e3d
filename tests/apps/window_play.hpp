// The window on a virtual display (Xvfb): plays a script and reads the results.
#pragma once

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

#include <fmt/format.h>

#include <functional>

#include "tests/apps/program.hpp"

namespace palpate {

inline bool hasDisplay() {
  if (std::system("command -v xvfb-run > /dev/null") == 0) return true;
  MESSAGE("skipped: there is no xvfb-run on this machine (package xvfb)");
  return false;
}

/// The script's output is in its folder: %/name is a file there.
struct Played {
  Outcome outcome;
  ScratchFolder folder;
  Result state(const std::string& name) const { return jsonOf(folder.path() / name); }
};

inline std::string inFolder(std::string text, const std::filesystem::path& folder) {
  for (std::size_t at; (at = text.find('%')) != std::string::npos;) text.replace(at, 1, folder.string());
  return text;
}

/// What is in the folder before the program starts.
using Preparation = std::function<void(const std::filesystem::path&)>;

// `arguments` and `script` may name files of the folder with %; the program runs in it.
inline std::unique_ptr<Played> play(const std::string& arguments, const std::string& script,
                                    const std::string& before = "", const Preparation& prepare = {}) {
  auto played = std::make_unique<Played>();
  const std::filesystem::path& folder = played->folder.path();
  if (prepare) prepare(folder);
  std::ofstream(folder / "script.txt") << inFolder(script, folder);
  const std::string program = std::filesystem::absolute(palpate::program()).string();
  const std::string command =
      inFolder("cd % && XDG_STATE_HOME=%/state xvfb-run -a -s '-screen 0 1600x1000x24' timeout 900 ", folder) +
      program + " " + before + " view " + inFolder(arguments, folder) + inFolder(" --script %/script.txt", folder);
  played->outcome = run(command);
  return played;
}

/// The same; fails unless the program ends without an error.
inline std::unique_ptr<Played> playWell(const std::string& arguments, const Preparation& prepare,
                                        const std::string& script, const std::string& before = "") {
  auto played = play(arguments, script, before, prepare);
  REQUIRE_MESSAGE(played->outcome.code == 0, played->outcome.text);
  return played;
}

inline void makeSphere(const std::filesystem::path& folder, int points = 8000) {
  works("--quiet make sphere -n " + std::to_string(points) + " -o " + (folder / "sphere.ply").string());
}

inline Preparation sphereOf(int points = 8000) {
  return [points](const std::filesystem::path& folder) { makeSphere(folder, points); };
}

/// The sphere, and a copy of its file.
inline void makeKeptSphere(const std::filesystem::path& folder) {
  makeSphere(folder, 2000);
  std::filesystem::copy_file(folder / "sphere.ply", folder / "kept.ply");
}

struct Picture {
  explicit Picture(const std::filesystem::path& file) {
    stbi_uc* data = stbi_load(file.c_str(), &width, &height, nullptr, 3);
    REQUIRE_MESSAGE(data, file.string());
    rgb.assign(data, data + std::size_t(width) * std::size_t(height) * 3);
    stbi_image_free(data);
  }
  std::array<int, 3> at(int x, int y) const {
    const std::size_t place = (std::size_t(y) * std::size_t(width) + std::size_t(x)) * 3;
    return {rgb[place], rgb[place + 1], rgb[place + 2]};
  }
  int width = 0, height = 0;
  std::vector<stbi_uc> rgb;
};

// Number of pixels of a square that satisfy a condition.
inline int count(int x, int y, int reach, auto&& holds) {
  int found = 0;
  for (int j = y - reach; j <= y + reach; ++j)
    for (int i = x - reach; i <= x + reach; ++i) found += holds(i, j) ? 1 : 0;
  return found;
}

inline int differing(const Picture& a, const Picture& b, int x, int y, int reach) {
  return count(x, y, reach, [&](int i, int j) {
    const auto p = a.at(i, j), q = b.at(i, j);
    return std::abs(p[0] - q[0]) + std::abs(p[1] - q[1]) + std::abs(p[2] - q[2]) > 24;
  });
}

}  // namespace palpate
