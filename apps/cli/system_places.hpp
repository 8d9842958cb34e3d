// Paths that differ between operating systems.
#pragma once

#include <filesystem>
#include <vector>

namespace palpate {

/// The font of panels and pictures, followed by fonts that may have letters missing in it. None of the files need
/// exist.
std::vector<std::filesystem::path> fontFiles();

/// This program's own file.
std::filesystem::path programFile();

/// Folder for the program's state of a user between runs; empty if it is unknown.
std::filesystem::path stateFolder();

}  // namespace palpate
