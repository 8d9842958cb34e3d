// What a test says to each system in another way.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// A variable of the environment, while it lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value);
  ~Variable();
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
};

/// Where the program lies that is running.
std::filesystem::path programFolder();

/// Processor time that this process has taken, and those that it began and waited for.
double processorSeconds();

/// What the file of a library is called that is loaded while a program runs.
std::string libraryFileName(const std::string& name);

}  // namespace palpate
