#pragma once

#include <string>
#include <vector>

namespace palpate {

/// Runs a program that is found as the system finds programs, and waits for it: its exit code, 127 where there is none.
int runProgram(const std::string& program, std::vector<std::string> arguments);

/// What Python is called, in the order in which it is to be tried.
std::vector<std::string> pythonNames();

}  // namespace palpate
