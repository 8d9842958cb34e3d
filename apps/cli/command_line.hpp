#pragma once

#include <string>
#include <vector>

namespace palpate {

/// The words of the command line in UTF-8, the program's name first. The standard streams take UTF-8 from then on.
std::vector<std::string> commandLine(int argc, char** argv);

}  // namespace palpate
