// Runs the program as a user does, and reads its output.
#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/vec.hpp"
#include "tests/apps/result.hpp"
#include "tests/content_of.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate {

struct Outcome {
  int code = 0;
  std::string text;  // stdout and stderr
};

/// Path of the executable.
std::string program();
/// Runs a shell command and reads its output.
Outcome run(const std::string& command);
Outcome palpate(const std::string& arguments);
/// For commands that must succeed: on failure prints the command and its output.
void works(const std::string& arguments);
/// For commands that must end with this code and print each of these words.
void checkEnds(int code, const std::string& arguments, const std::vector<std::string>& words);

/// Writes a plate of 61 x 61 points a side, 1 mm apart, under z = 0; of no thickness: one side alone.
void writePlate(const std::filesystem::path& file, double thickness);

/// Whether a command needs PALPATE_STUDY or PALPATE_SIMULATION, and this palpate was built without.
bool isLeftOut(const std::string& arguments);
/// False, with a message, if this palpate was built without PALPATE_SIMULATION: the case is skipped.
bool hasScenes();

Result jsonOf(const std::filesystem::path& file);

struct Row {
  double t_s = 0, penetration_mm = 0;
  DVec3 hip{0}, proxy{0}, normal{0}, force{0};
  bool contact = false;
};
std::vector<Row> readTrace(const std::filesystem::path& file);

}  // namespace palpate
