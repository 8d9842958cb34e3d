// The parts of a glTF file: its JSON, its buffers, and numbers from them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "engine/core/error.hpp"

namespace palpate {

unsigned bytesOfGltfKind(std::size_t kind);  ///< of a component type; 0 if it is unknown

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
  using Bytes = std::vector<std::byte>;

  /// Reads the whole file, and buffers in files beside it. Throws FileError.
  explicit GltfFile(std::filesystem::path file);
  ~GltfFile();
  GltfFile(const GltfFile&) = delete;
  GltfFile& operator=(const GltfFile&) = delete;

  const nlohmann::json& json() const { return *json_; }
  [[noreturn]] void fail(std::string_view what) const { throw FileError(path_, what); }

  /// The element of a list of the file (for example "meshes") with the index `number`. Throws if there is none.
  const nlohmann::json& named(const char* list, const nlohmann::json& number) const;
  /// The extension of an object by its name; null: the object lacks it.
  const nlohmann::json* extension(const nlohmann::json& object, const char* name) const;
  /// `perElement`: the allowed numbers of components.
  GltfNumbers numbers(const nlohmann::json& accessor, std::initializer_list<unsigned> perElement);
  /// The same without data: those of a compressed mesh have their own.
  GltfNumbers described(const nlohmann::json& accessor, std::initializer_list<unsigned> perElement) const;
  /// The bytes of an entry of "bufferViews", without compression (EXT_meshopt_compression).
  std::span<const std::byte> view(const nlohmann::json& number);
  /// The picture of an entry of "images": in a view, embedded as text, or in a file beside this one.
  Bytes picture(const nlohmann::json& number);
  const std::filesystem::path& path() const { return path_; }
  /// A non-negative integer; `otherwise` if missing.
  std::size_t whole(const nlohmann::json& object, const char* name, std::size_t otherwise) const;

 private:
  void readGlb(const Bytes& all);
  /// `what`: "buffer 0", for messages.
  Bytes bytesAt(const nlohmann::json& uri, std::string_view what) const;
  /// The part of a buffer that a view, or its compressed form, states.
  std::span<const std::byte> partOf(const nlohmann::json& view);
  Bytes unpacked(const nlohmann::json& packed);

  std::filesystem::path path_;
  std::unique_ptr<const nlohmann::json> json_;
  Bytes packed_;  // from a GLB file
  bool hasPacked_ = false;
  std::vector<Bytes> buffers_;
  std::map<std::size_t, Bytes> unpacked_;  // views
};

}  // namespace palpate
