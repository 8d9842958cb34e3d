// The body of a PLY file, one pair of functions per family of encodings. All throw FileError with the location.
#pragma once

#include <string_view>

#include "engine/io/chunked_file.hpp"
#include "engine/io/ply_faces.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/ply_row_sink.hpp"

namespace palpate {

/// Reads the whole body that `info` declares, so that a truncated file is rejected wherever it ends: passes the rows of
/// the element `vertex` to `vertices`, and polygons of other elements to `faces` if it is not null. Bytes after the
/// last element are ignored and logged.
void readPlyBody(ChunkedFile& file, const PlyInfo& info, PlyRowSink& vertices, PlyFaces* faces, Log* log);

void readBinaryVertices(ChunkedFile& file, const PlyElement& element, bool swapBytes, PlyRowSink& vertices);
void readAsciiVertices(ChunkedFile& file, const PlyElement& element, PlyRowSink& vertices);

/// Property of a face: the number of its texture.
inline constexpr std::string_view kTextureNumber = "texnumber";

/// Skips an element other than `vertex`; passes its polygons to `faces` if it is not null.
void passBinaryElement(ChunkedFile& file, const PlyElement& element, bool swapBytes, PlyFaces* faces);
void passAsciiElement(ChunkedFile& file, const PlyElement& element, PlyFaces* faces);

/// Throws FileError if `element`, whose rows have at least `rowBytes`, cannot fit into the rest of the file and `spare`
/// bytes; nothing if the size of the file is unknown. Called before memory is allocated for the element.
void checkPromise(const ChunkedFile& file, const PlyElement& element, std::uint64_t rowBytes, std::uint64_t spare = 0);

}  // namespace palpate
