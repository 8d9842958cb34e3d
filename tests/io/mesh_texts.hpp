// Files of meshes as texts, and how their readers take them.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "engine/core/error.hpp"
#include "engine/io/mesh_import.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::test::mesh_texts {

using Import = ImportedMesh (*)(const std::filesystem::path&);

inline ImportedMesh imported(Import import, const std::string& text) {
  const ScratchFolder folder;
  std::ofstream(folder / "a.mesh", std::ios::binary) << text;
  return import(folder / "a.mesh");
}

using test::refuses;

inline void refuses(Import import, const std::string& text, const std::string& expected) {
  const std::string said = errorOf<FileError>([&] { imported(import, text); });
  checkSaid(said.substr(std::min(said.find("a.mesh") + 6, said.size())), expected);
}

inline std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  REQUIRE(at != text.npos);
  return text.replace(at, what.size(), with);
}

}  // namespace palpate::test::mesh_texts
