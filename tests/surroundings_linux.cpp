#include <cstdlib>

#include "tests/surroundings.hpp"

namespace palpate {

Variable::Variable(const char* name, const std::string& value) : name_(name) { ::setenv(name, value.c_str(), 1); }

Variable::~Variable() { ::unsetenv(name_); }

std::filesystem::path programFolder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

std::string libraryFileName(const std::string& name) { return "lib" + name + ".so"; }

}  // namespace palpate
