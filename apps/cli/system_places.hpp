// Where each system keeps what the program looks for.
#pragma once

#include <filesystem>
#include <vector>

namespace palpate {

/// The font of panels and pictures, and behind it those that may have letters which it lacks. None need be there.
std::vector<std::filesystem::path> fontFiles();

/// Where a program keeps what it remembers of a person from one time to the next; empty where nobody says.
std::filesystem::path stateFolder();

}  // namespace palpate
