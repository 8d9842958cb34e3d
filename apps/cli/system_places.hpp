// Where each system keeps what the program looks for.
#pragma once

#include <filesystem>

namespace palpate {

/// The font of panels and pictures; it may not be there.
std::filesystem::path fontFile();

/// Where a program keeps what it remembers of a person from one time to the next; empty where nobody says.
std::filesystem::path stateFolder();

}  // namespace palpate
