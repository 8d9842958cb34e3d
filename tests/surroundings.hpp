// System-dependent functions of the tests.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// Sets an environment variable for its lifetime.
class Variable {
 public:
  Variable(const char* name, const std::string& value);
  ~Variable();
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

/// Folder of the running program.
std::filesystem::path programFolder();

/// Processor time of this process, and of the children that it has waited for.
double processorSeconds();

/// File name of a library that is loaded at run time.
std::string libraryFileName(const std::string& name);

}  // namespace palpate
