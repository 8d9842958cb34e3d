#pragma once

#include <string>
#include <vector>

namespace palpate {

/// Runs a program found on the system's search path and waits for it. Returns its exit code; 127 if it does not exist.
int runProgram(const std::string& program, std::vector<std::string> arguments);

/// Names of the Python interpreter, in the order to try them.
std::vector<std::string> pythonNames();

}  // namespace palpate
