#include <sys/resource.h>

#include <cstdlib>

#include "tests/surroundings.hpp"

namespace palpate {

Variable::Variable(const char* name, const std::string& value) : name_(name) { ::setenv(name, value.c_str(), 1); }

Variable::~Variable() { ::unsetenv(name_); }

std::filesystem::path programFolder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

double processorSeconds() {
  double seconds = 0;
  for (const int whose : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage used{};
    ::getrusage(whose, &used);
    for (const timeval& part : {used.ru_utime, used.ru_stime})
      seconds += static_cast<double>(part.tv_sec) + 1e-6 * static_cast<double>(part.tv_usec);
  }
  return seconds;
}

std::string libraryFileName(const std::string& name) { return "lib" + name + ".so"; }

}  // namespace palpate
