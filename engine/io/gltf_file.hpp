// The parts of a glTF file: its JSON, its buffers, and numbers from them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include "engine/core/error.hpp"

namespace palpate {

/// Numbers of an accessor, one or more for each element; the range was validated.
struct GltfNumbers {
  const std::byte* data = nullptr;
  std::size_t stride = 0, count = 0;
  unsigned kind = 0;  ///< component type of glTF: 5120 for a signed byte, … 5126 for a float
  unsigned perElement = 0;
  bool normalized = false;  ///< integers represent -1 to 1, or 0 to 1

  double number(std::size_t element, std::size_t k) const;
  std::uint32_t index(std::size_t element) const;
};

class GltfFile {
 public:
  /// Reads the whole file, and buffers in files beside it. Throws FileError.
  explicit GltfFile(std::filesystem::path file);
  ~GltfFile();
  GltfFile(const GltfFile&) = delete;
  GltfFile& operator=(const GltfFile&) = delete;

  const nlohmann::json& json() const { return *json_; }
  [[noreturn]] void fail(std::string_view what) const { throw FileError(path_, what); }

  /// The element of a list of the file (for example "meshes") with the index `number`. Throws if there is none.
  const nlohmann::json& named(const char* list, const nlohmann::json& number) const;
  /// `perElement`: the allowed numbers of components.
  GltfNumbers numbers(const nlohmann::json& accessor, std::initializer_list<unsigned> perElement);
  /// A non-negative integer; `otherwise` if missing.
  std::size_t whole(const nlohmann::json& object, const char* name, std::size_t otherwise) const;

 private:
  using Bytes = std::vector<std::byte>;

  void readGlb(const Bytes& all);
  Bytes bytesOf(const nlohmann::json& buffer, std::size_t number) const;

  std::filesystem::path path_;
  std::unique_ptr<const nlohmann::json> json_;
  Bytes packed_;  // from a GLB file
  bool hasPacked_ = false;
  std::vector<Bytes> buffers_;
};

}  // namespace palpate
