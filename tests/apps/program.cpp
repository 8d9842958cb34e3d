#include "tests/apps/program.hpp"

#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>

#include "tests/says.hpp"

namespace palpate {

std::string program() {
  const char* elsewhere = std::getenv("PALPATE_PROGRAM");  // set if the tests run on another machine than the build
  return elsewhere ? elsewhere : PALPATE_PROGRAM;
}

Outcome run(const std::string& command) {
  Outcome outcome;
  std::FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  REQUIRE(pipe);
  std::array<char, 4096> piece;
  while (const std::size_t size = std::fread(piece.data(), 1, piece.size(), pipe))
    outcome.text.append(piece.data(), size);
  const int status = ::pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

Outcome palpate(const std::string& arguments) { return run(program() + " " + arguments); }

void works(const std::string& arguments) {
  const Outcome outcome = palpate(arguments);
  REQUIRE_MESSAGE(outcome.code == 0, "palpate " << arguments << "\n" << outcome.text);
}

void checkEnds(int code, const std::string& arguments, const std::vector<std::string>& words) {
  const Outcome outcome = palpate(arguments);
  CAPTURE(arguments);
  CAPTURE(outcome.text);
  CHECK(outcome.code == code);
  for (const std::string& word : words) {
    CAPTURE(word);
    CHECK(says(outcome.text, word));
  }
}

void writePlate(const std::filesystem::path& file, double thickness) {
  const int sides = thickness > 0 ? 2 : 1;
  std::ofstream out(file);
  out << "ply\nformat ascii 1.0\ncomment units: mm\nelement vertex " << 3721 * sides
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
         "property float nz\nend_header\n";
  for (int side = 0; side < sides; ++side)
    for (int i = -30; i <= 30; ++i)
      for (int j = -30; j <= 30; ++j)
        out << i << ' ' << j << ' ' << -side * thickness << " 0 0 " << 1 - 2 * side << '\n';
}

bool isLeftOut(const std::string& arguments) {
  constexpr bool kHasStudy = PALPATE_HAS_STUDY, kHasSimulation = PALPATE_HAS_SIMULATION;
  const auto names = [&](const char* word) { return arguments.find(word) != std::string::npos; };
  constexpr std::array kOfStudy{"bench", "indirect", "naive", "two-step", "brute"};
  constexpr std::array kOfSimulation{"simulate", "bench matter", "water", "jelly"};
  return (!kHasStudy && std::ranges::any_of(kOfStudy, names)) ||
         (!kHasSimulation && std::ranges::any_of(kOfSimulation, names));
}

bool hasScenes() {
  if (!isLeftOut("simulate")) return true;
  MESSAGE("skipped: this palpate was built without PALPATE_SIMULATION");
  return false;
}

Result jsonOf(const std::filesystem::path& file) { return Result::parse(contentOf(file)); }

std::vector<Row> readTrace(const std::filesystem::path& file) {
  std::istringstream lines(contentOf(file));
  std::string line;
  std::getline(lines, line);
  CHECK(line ==
        "t_s,hip_x,hip_y,hip_z,proxy_x,proxy_y,proxy_z,normal_x,normal_y,normal_z,force_x,force_y,force_z,"
        "penetration_mm,contact,neighbours,fresh,gpu_us,step_us");
  std::vector<Row> rows;
  while (std::getline(lines, line)) {
    std::vector<double> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(std::stod(cell));
    REQUIRE(cells.size() == 19);
    const auto at = [&](std::size_t i) { return DVec3(cells[i], cells[i + 1], cells[i + 2]); };
    rows.push_back({cells[0], cells[13], at(1), at(4), at(7), at(10), cells[14] != 0});
  }
  return rows;
}

}  // namespace palpate
