// PLY files made by hand, in any encoding, for the tests of the reader.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <filesystem>
#include <fstream>
#include <string>

#include "engine/io/ply_header.hpp"
#include "tests/error_of.hpp"

namespace palpate::test {

/// A file in the temporary folder, removed by the destructor.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::string_view content = {}) {
    static int number = 0;
    path_ = std::filesystem::temp_directory_path() / fmt::format("palpate_cloud_{}_{}.ply", ::getpid(), number++);
    write(content);
  }
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(std::string_view content) const {
    std::ofstream(path_, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
  }
  std::string content() const {
    std::ifstream file(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Appends values in one encoding.
class BodyWriter {
 public:
  explicit BodyWriter(PlyFormat format) : format_(format) {}

  BodyWriter& put(ScalarType type, double value) {
    visitScalar(type, [&]<class T>(std::type_identity<T>) {
      if (format_ == PlyFormat::ascii) {
        if (!text_.empty() && text_.back() != '\n') text_ += ' ';
        text_ += fmt::format("{}", static_cast<T>(value));
        return;
      }
      auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(static_cast<T>(value));
      if ((format_ == PlyFormat::binaryBigEndian) != (std::endian::native == std::endian::big))
        std::reverse(bytes.begin(), bytes.end());
      text_.append(bytes.data(), bytes.size());
    });
    return *this;
  }
  BodyWriter& endRow() {
    if (format_ == PlyFormat::ascii) text_ += '\n';
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  PlyFormat format_;
  std::string text_;
};

inline constexpr std::array kAllFormats{PlyFormat::ascii, PlyFormat::binaryLittleEndian, PlyFormat::binaryBigEndian};

inline std::string magic(PlyFormat format) { return fmt::format("ply\nformat {} 1.0\n", plyName(format)); }

inline bool contains(const std::string& text, std::string_view part) { return text.find(part) != text.npos; }

}  // namespace palpate::test
