#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace palpate {

/// The words of the command line in UTF-8, the program's name first. The standard streams take UTF-8 from then on.
std::vector<std::string> commandLine(int argc, char** argv);

/// A standard stream passes bytes unchanged from then on, line ends included.
void passBytes(std::FILE* stream) noexcept;

/// After an error, lets the user read it if the system opened a console for this program alone and would close it now.
void keepConsole(int exitCode);

}  // namespace palpate
