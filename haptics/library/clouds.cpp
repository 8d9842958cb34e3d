// The C interface: clouds, and the list of GPUs.
#include <algorithm>
#include <cstring>

#include "engine/io/cloud_formats.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "haptics/library/failures.hpp"
#include "haptics/library/gpu_half.hpp"
#include "haptics/library/messages.hpp"
#include "haptics/library/objects.hpp"
#include "haptics/library/options.hpp"

using namespace palpate;
using namespace palpate::library;

namespace {

const char* nameOf(ScalarType type) {
  constexpr const char* kNames[]{"int8",   "uint8",   "int16",   "uint16", "int32",
                                 "uint32", "float32", "float64", "int64",  "uint64"};
  return kNames[static_cast<std::size_t>(type)];
}

}  // namespace

namespace palpate::library {

pp_points viewOf(const PointCloud& cloud) {
  pp_points points{};
  points.count = cloud.size();
  const Bounds box = boundsOf(cloud);
  for (int k = 0; k < 3; ++k) {
    points.origin[k] = cloud.origin[k];
    points.min[k] = cloud.empty() ? 0 : cloud.origin[k] + box.min[k];
    points.max[k] = cloud.empty() ? 0 : cloud.origin[k] + box.max[k];
  }
  if (cloud.empty()) return points;
  points.positions = &cloud.positions.front().x;
  if (cloud.hasNormals()) points.normals = &cloud.normals.front().x;
  if (cloud.hasColors()) points.colors = cloud.colors.front().data();
  return points;
}

}  // namespace palpate::library

pp_status pp_cloud_create(const pp_cloud_arrays* arrays, pp_cloud* cloud) {
  clear(cloud);
  return guarded([&] {
    const pp_cloud_arrays given = optionsFrom(&required(arrays, "arrays"), "arrays");
    required(cloud, "cloud") = opened<pp_cloud>(std::make_shared<CloudObject>(cloudFrom(arraysFrom(given))));
  });
}

pp_status pp_cloud_read(const char* file, const pp_read_options* options, pp_cloud* cloud) {
  clear(cloud);
  return guarded([&] {
    const pp_read_options given = optionsFrom(options, "options");
    const std::string name = &required(file, "file");
    required(cloud, "cloud");
    if (isRgbdFolder(name))
      throw FileError(name, "is the folder of a recorded depth camera, and not one cloud; open a session of it");
    Watch watch(given.watch);
    Messages messages(given.log, given.log_user, watch);
    StoredCloud stored;
    watch.runCut([&] {
      stored = readCloud(name, &messages.sink(),
                         {.normalsFromFaces = given.normals_from_faces != 0,
                          .pointsOnly = true,
                          .keepUnreliable = given.keep_unreliable != 0});
    });
    if (!stored.leftOut.empty())
      messages.sink().warn("{}: left out: {}; keep_unreliable keeps them", name, stored.leftOut);
    *cloud = opened<pp_cloud>(std::make_shared<CloudObject>(
        std::move(stored.cloud),
        ModelConfig{.file = name,
                    .normals = given.normals_from_faces ? NormalSource::face : NormalSource::keep,
                    .keepUnreliable = given.keep_unreliable != 0}));
  });
}

pp_status pp_cloud_write(pp_cloud cloud, const char* file, const pp_write_options* options) {
  return guarded([&] {
    const auto found = objectOf<CloudObject>(cloud.id);
    const std::string name = &required(file, "file");
    const pp_write_options given = optionsFrom(options, "options");
    std::filesystem::path kept;
    Watch watch(given.watch);
    watch.runCut([&] {
      cloudFormats().toWrite(name).write(
          name, found->cloud,
          {.ascii = given.ascii != 0, .keptAs = given.backup ? &kept : nullptr, .progress = [&](double share) {
             throwIfStopWanted();
             watch.progressed("writing", share);
           }});
    });
  });
}

const char* pp_formats_read(void) {
  static const std::string all = cloudFormats().endingsRead();
  return all.c_str();
}

const char* pp_formats_written(void) {
  static const std::string all = cloudFormats().endingsWritten();
  return all.c_str();
}

pp_status pp_cloud_view(pp_cloud cloud, pp_points* points) {
  clear(points);
  return guarded([&] { required(points, "points") = objectOf<CloudObject>(cloud.id)->view; });
}

pp_status pp_cloud_copy_positions(pp_cloud cloud, double* positions, uint64_t count) {
  return guarded([&] {
    const auto found = objectOf<CloudObject>(cloud.id);
    if (count != found->cloud.size())
      throw UsageError("count: {} positions were requested, but the cloud has {}", count, found->cloud.size());
    if (count > 0) required(positions, "positions");
    for (std::size_t i = 0; i < count; ++i) {
      const DVec3 place = found->cloud.fileCoordinates(i);
      for (int k = 0; k < 3; ++k) positions[3 * i + static_cast<std::size_t>(k)] = place[k];
    }
  });
}

pp_status pp_cloud_attribute_count(pp_cloud cloud, uint64_t* count) {
  clear(count);
  return guarded([&] { required(count, "count") = objectOf<CloudObject>(cloud.id)->cloud.extra.size(); });
}

pp_status pp_cloud_get_attribute(pp_cloud cloud, uint64_t index, pp_attribute* attribute) {
  clear(attribute);
  return guarded([&] {
    const auto found = objectOf<CloudObject>(cloud.id);
    const auto& all = found->cloud.extra;
    if (index >= all.size())
      throw UsageError("index: {} is out of range; the cloud has {} attributes", index, all.size());
    required(attribute, "attribute") = {all[index].name.c_str(), nameOf(all[index].type), all[index].data.data()};
  });
}

pp_status pp_cloud_close(pp_cloud cloud) {
  return guarded([&] { handles().remove(HandleKind::cloud, cloud.id); });
}

pp_status pp_gpu_count(uint32_t* count) {
  clear(count);
  return guarded([&] { required(count, "count") = static_cast<std::uint32_t>(gpuNames().size()); });
}

pp_status pp_gpu_name(uint32_t index, char* name, uint64_t capacity) {
  if (name && capacity > 0) name[0] = '\0';
  return guarded([&] {
    const std::vector<std::string> names = gpuNames();
    if (index >= names.size())
      throw UsageError("index: {} is out of range; this machine has {} GPUs", index, names.size());
    if (capacity == 0) throw UsageError("capacity: is 0, too small for a name");
    const std::size_t length = std::min<std::size_t>(names[index].size(), capacity - 1);
    std::memcpy(&required(name, "name"), names[index].data(), length);
    name[length] = '\0';
  });
}
