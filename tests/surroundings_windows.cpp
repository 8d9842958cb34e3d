#include <windows.h>

#include <cstdlib>
#include <ctime>

#include "tests/surroundings.hpp"

namespace palpate {

Variable::Variable(const char* name, const std::string& value) : name_(name) { ::_putenv_s(name, value.c_str()); }

Variable::~Variable() { ::_putenv_s(name_, ""); }

std::filesystem::path programFolder() {
  wchar_t program[MAX_PATH]{};
  ::GetModuleFileNameW(nullptr, program, MAX_PATH - 1);
  return std::filesystem::path(program).parent_path();
}

double processorSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;  // on Windows the wall time, and only of this process
}

std::string libraryFileName(const std::string& name) { return "lib" + name + ".dll"; }

}  // namespace palpate
