#include <draco/compression/decode.h>

#include <new>
#include <stdexcept>

#include "engine/core/error.hpp"
#include "engine/io/unpacked_mesh.hpp"

namespace palpate {

namespace {

unsigned kindOf(draco::DataType type) {
  switch (type) {
    case draco::DT_INT8:
      return 5120;
    case draco::DT_UINT8:
      return 5121;
    case draco::DT_INT16:
      return 5122;
    case draco::DT_UINT16:
      return 5123;
    case draco::DT_UINT32:
      return 5125;
    case draco::DT_FLOAT32:
      return 5126;
    default:
      return 0;
  }
}

UnpackedMesh::Attribute unpacked(const draco::PointAttribute& from, std::size_t corners) {
  UnpackedMesh::Attribute to{
      .id = from.unique_id(), .kind = kindOf(from.data_type()), .perElement = from.num_components(), .bytes = {}};
  if (to.kind == 0) throw Error("an attribute has numbers of a type that glTF does not have");
  const std::size_t element = static_cast<std::size_t>(draco::DataTypeLength(from.data_type())) * to.perElement;
  to.bytes.resize(corners * element);
  for (std::size_t i = 0; i < corners; ++i) {
    const draco::AttributeValueIndex value = from.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    if (value.value() >= from.size()) throw Error("its data are damaged");
    from.GetValue(value, to.bytes.data() + i * element);
  }
  return to;
}

}  // namespace

UnpackedMesh unpackMesh(std::span<const std::byte> bytes) try {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  if (!decoded.ok()) throw Error("its data are damaged ({})", decoded.status().error_msg());
  const draco::Mesh& mesh = *decoded.value();
  UnpackedMesh unpackedMesh{.corners = mesh.num_points(), .attributes = {}, .indices = {}};
  for (int k = 0; k < mesh.num_attributes(); ++k)
    unpackedMesh.attributes.push_back(unpacked(*mesh.attribute(k), unpackedMesh.corners));
  for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face)
    for (const draco::PointIndex& corner : mesh.face(face)) unpackedMesh.indices.push_back(corner.value());
  return unpackedMesh;
} catch (const std::bad_alloc&) {
  throw Error("its data are damaged (more elements than fit into memory)");
} catch (const std::length_error&) {
  throw Error("its data are damaged (more elements than fit into memory)");
}

}  // namespace palpate
