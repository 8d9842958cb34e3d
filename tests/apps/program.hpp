// The program as a user meets it: runs it, and reads what it leaves.
#pragma once

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
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

/// The file that is run.
std::string program();
/// Runs a command of the shell, and reads what it says.
Outcome run(const std::string& command);
Outcome palpate(const std::string& arguments);
/// For commands that have to work: a failing one says what it was and what it said.
void works(const std::string& arguments);

Result jsonOf(const std::filesystem::path& file);

struct Row {
  double t_s = 0, penetration_mm = 0;
  DVec3 hip{0}, proxy{0}, normal{0}, force{0};
  bool contact = false;
};
std::vector<Row> readTrace(const std::filesystem::path& file);

}  // namespace palpate
