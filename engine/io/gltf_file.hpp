// What a glTF file is made of: its JSON and its buffers, and numbers out of them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "engine/core/error.hpp"

namespace palpate {

/// Numbers of an accessor, some for each element; they are there.
struct GltfNumbers {
  const std::byte* data = nullptr;
  std::size_t stride = 0, count = 0;
  unsigned kind = 0;  ///< as glTF numbers types: 5120 a signed byte, … 5126 a float
  unsigned perElement = 0;
  bool normalized = false;  ///< whole numbers stand for -1 or 0 to 1

  double number(std::size_t element, std::size_t k) const;
  std::uint32_t index(std::size_t element) const;
};

class GltfFile {
 public:
  /// Reads it whole, and buffers that are files beside it. Throws FileError.
  explicit GltfFile(std::filesystem::path file);

  const nlohmann::json& json() const { return json_; }
  [[noreturn]] void fail(std::string_view what) const { throw FileError(path_, what); }

  /// The element of a list of the file, "meshes" say, that a number in `from` names. Throws where there is none.
  const nlohmann::json& named(const char* list, const nlohmann::json& number) const;
  /// `perElement`: as many numbers as there must be.
  GltfNumbers numbers(const nlohmann::json& accessor, std::initializer_list<unsigned> perElement);
  /// A whole number that is not negative; `otherwise` where it is not there.
  std::size_t whole(const nlohmann::json& object, const char* name, std::size_t otherwise) const;

 private:
  using Bytes = std::vector<std::byte>;

  void readGlb(const Bytes& all);
  Bytes bytesOf(const nlohmann::json& buffer, std::size_t number) const;

  std::filesystem::path path_;
  nlohmann::json json_;
  Bytes packed_;  // of GLB
  bool hasPacked_ = false;
  std::vector<Bytes> buffers_;
};

}  // namespace palpate
