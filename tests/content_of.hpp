#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace palpate {

/// The content of a file; empty if it does not exist.
inline std::string contentOf(const std::filesystem::path& file) {
  std::ostringstream content;
  content << std::ifstream(file, std::ios::binary).rdbuf();
  return content.str();
}

}  // namespace palpate
