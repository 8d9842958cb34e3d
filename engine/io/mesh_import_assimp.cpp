#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>

#include <cmath>
#include <new>

#include "engine/core/error.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/mesh_import.hpp"

namespace palpate {

namespace {

constexpr std::uintmax_t kLargestFile = std::uintmax_t{4} << 30;  // bytes: the library holds them several times over
constexpr unsigned kDeepest = 1000;                               // nodes below each other

DVec3 placed(const aiMatrix4x4t<double>& matrix, const aiVector3D& v) {
  return {matrix.a1 * v.x + matrix.a2 * v.y + matrix.a3 * v.z + matrix.a4,
          matrix.b1 * v.x + matrix.b2 * v.y + matrix.b3 * v.z + matrix.b4,
          matrix.c1 * v.x + matrix.c2 * v.y + matrix.c3 * v.z + matrix.c4};
}

/// All meshes of a scene as often as its nodes show them, each where its node has it.
class SceneWalk {
 public:
  SceneWalk(const std::filesystem::path& file, const aiScene& scene, ImportedMesh& result)
      : file_(file), scene_(scene), result_(result) {
    for (unsigned k = 0; k < scene.mNumMeshes; ++k) {
      const aiMesh& mesh = *scene.mMeshes[k];
      if (!(mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE)) continue;
      normals_ = normals_ && mesh.HasNormals();
      colors_ = colors_ && mesh.HasVertexColors(0);
    }
  }

  void walk(const aiNode& node, const aiMatrix4x4t<double>& above, unsigned depth) {
    if (depth > kDeepest) throw FileError(file_, fmt::format("parts are nested more than {} deep", kDeepest));
    const aiMatrix4x4t<double> here = above * aiMatrix4x4t<double>(node.mTransformation);
    for (unsigned k = 0; k < node.mNumMeshes; ++k) add(*scene_.mMeshes[node.mMeshes[k]], here);
    for (unsigned k = 0; k < node.mNumChildren; ++k) walk(*node.mChildren[k], here, depth + 1);
  }

  std::size_t others() const { return others_; }

 private:
  void add(const aiMesh& mesh, const aiMatrix4x4t<double>& here) {
    TriangleSoup& soup = result_.soup;
    const std::size_t first = soup.corners.size();
    if (first + mesh.mNumVertices > 0xffffffffu) throw FileError(file_, "more than 4,294,967,295 corners");
    if (!(mesh.mPrimitiveTypes & aiPrimitiveType_TRIANGLE)) {
      others_ += mesh.mNumFaces;
      return;
    }
    aiMatrix4x4t<double> inverse = here;
    inverse.Inverse().Transpose();  // what normals are turned by
    inverse.a4 = inverse.b4 = inverse.c4 = 0;
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      soup.corners.push_back(placed(here, mesh.mVertices[v]));
      if (normals_) soup.normals.push_back(Vec3(placed(inverse, mesh.mNormals[v])));
      if (colors_) soup.colors.push_back(byteColor(mesh.mColors[0][v]));
    }
    const bool mirrored = here.Determinant() < 0;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) {
        ++others_;
        continue;
      }
      std::array<std::uint32_t, 3> triangle;
      for (unsigned k = 0; k < 3; ++k) {
        const unsigned corner = face.mIndices[mirrored ? 2 - k : k];
        if (corner >= mesh.mNumVertices)
          throw FileError(file_, fmt::format("a triangle has corner {} of {}", corner, mesh.mNumVertices));
        triangle[k] = static_cast<std::uint32_t>(first + corner);
      }
      soup.triangles.push_back(triangle);
    }
  }
  static std::array<std::uint8_t, 4> byteColor(const aiColor4D& color) {
    const auto byte = [](float value) {
      return static_cast<std::uint8_t>(std::isfinite(value) ? std::lround(255 * std::fmin(std::fmax(value, 0.f), 1.f))
                                                            : 0);
    };
    return {byte(color.r), byte(color.g), byte(color.b), 255};
  }

  const std::filesystem::path& file_;
  const aiScene& scene_;
  ImportedMesh& result_;
  bool normals_ = true, colors_ = true;  // all meshes have them
  std::size_t others_ = 0;               // points and lines
};

}  // namespace

bool canImportMeshes() { return true; }

ImportedMesh importMesh(const std::filesystem::path& file, const std::string& ending) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(file, unknown)) throw FileError(file, "cannot be read: it is no ordinary file");
  const auto bytes = std::filesystem::file_size(file, unknown);
  if (unknown || bytes > kLargestFile)
    throw FileError(file, fmt::format("a mesh of {} bytes; at most {} are read", bytes, kLargestFile));
  if (bytes == 0) throw FileError(file, "is empty");
  try {
    Assimp::Importer importer;
    // Nothing but places, normals and colours: no pictures, no other file's materials.
    importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS,
                                aiComponent_TEXTURES | aiComponent_TEXCOORDS | aiComponent_MATERIALS |
                                    aiComponent_ANIMATIONS | aiComponent_LIGHTS | aiComponent_CAMERAS |
                                    aiComponent_BONEWEIGHTS | aiComponent_TANGENTS_AND_BITANGENTS);
    const aiScene* scene = importer.ReadFile(
        file.string(), aiProcess_ValidateDataStructure | aiProcess_Triangulate | aiProcess_RemoveComponent);
    if (!scene || !scene->mRootNode)
      throw FileError(
          file, fmt::format("no {} file that can be read: {}", ending.substr(1), inQuotes(importer.GetErrorString())));
    ImportedMesh result;
    SceneWalk walk(file, *scene, result);
    walk.walk(*scene->mRootNode, {}, 0);
    if (walk.others() > 0) result.lost.push_back(fmt::format("{} points and lines", walk.others()));
    if (scene->mNumAnimations > 0) result.lost.push_back(fmt::format("{} animations", scene->mNumAnimations));
    return result;
  } catch (const FileError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw FileError(file, "takes more memory than there is");
  } catch (const std::exception& error) {
    throw FileError(file, fmt::format("cannot be read: {}", inQuotes(error.what())));
  }
}

}  // namespace palpate
