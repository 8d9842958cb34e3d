#include "engine/io/ply_body.hpp"

#include <bit>

namespace palpate {
namespace {

/// Logs if data follows the last element; blank lines are ignored.
void remarkOnRest(ChunkedFile& file, Log* log) {
  const std::uint64_t offset = file.offset();
  const auto rest = file.peek(1);
  for (const std::byte b : rest) {
    if (b == std::byte{'\n'} || b == std::byte{'\r'} || b == std::byte{' '}) continue;
    log->warn("{}: what follows the last element, from byte {} on, is ignored", file.path().filename().string(),
              offset);
    return;
  }
}

}  // namespace

void readPlyBody(ChunkedFile& file, const PlyInfo& info, PlyRowSink& vertices, PlyFaces* faces, Log* log) {
  const bool ascii = info.format == PlyFormat::ascii;
  const bool littleEndian = info.format == PlyFormat::binaryLittleEndian;
  const bool swapBytes = littleEndian != (std::endian::native == std::endian::little);
  for (const PlyElement& element : info.elements) {
    const bool isVertex = element.name == "vertex";
    if (ascii)
      isVertex ? readAsciiVertices(file, element, vertices) : passAsciiElement(file, element, faces);
    else
      isVertex ? readBinaryVertices(file, element, swapBytes, vertices)
               : passBinaryElement(file, element, swapBytes, faces);
  }
  if (log) remarkOnRest(file, log);
}

}  // namespace palpate
