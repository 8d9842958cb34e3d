// The body of a PLY file, one pair of functions per family of encodings. All throw FileError with the place.
#pragma once

#include <string>

#include "engine/io/chunked_file.hpp"
#include "engine/io/ply_faces.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/ply_row_sink.hpp"

namespace palpate {

/// Walks the whole body that `info` announces, so that a truncated one is refused wherever it ends: hands the rows of
/// the element `vertex` to `vertices`, the polygons of others to `faces` where that is not null. Bytes after the last
/// element are ignored and said through `log`.
void readPlyBody(ChunkedFile& file, const PlyInfo& info, PlyRowSink& vertices, PlyFaces* faces, Log* log);

void readBinaryVertices(ChunkedFile& file, const PlyElement& element, bool swapBytes, PlyRowSink& vertices);
void readAsciiVertices(ChunkedFile& file, const PlyElement& element, PlyRowSink& vertices);

/// Passes over an element that is no vertex; hands its polygons to `faces` where that is not null.
void passBinaryElement(ChunkedFile& file, const PlyElement& element, bool swapBytes, PlyFaces* faces);
void passAsciiElement(ChunkedFile& file, const PlyElement& element, PlyFaces* faces);

/// What is wrong when `element` cannot fit into the rest of the file, its rows having at least `rowBytes`; empty when
/// it can or the size of the file is unknown. Asked before anything is allocated for the element.
std::string brokenPromise(const ChunkedFile& file, const PlyElement& element, std::uint64_t rowBytes);

}  // namespace palpate
