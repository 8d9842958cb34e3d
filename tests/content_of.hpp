#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace palpate {

/// All of a file; empty where there is none.
inline std::string contentOf(const std::filesystem::path& file) {
  std::ostringstream content;
  content << std::ifstream(file, std::ios::binary).rdbuf();
  return content.str();
}

}  // namespace palpate
