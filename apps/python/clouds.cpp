// Clouds and meshes in Python: views of the library's memory.
#include "apps/python/interruption.hpp"

namespace palpate::python {

using CloudPointer = std::shared_ptr<PyCloud>;
using Vector = std::array<double, 3>;

namespace {

/// Converts integers of any type to bytes. Throws palpate.UsageError that names the first one out of range.
py::array bytesOf(const py::array& whole) {
  const py::object outside = whole.attr("__lt__")(0).attr("__or__")(whole.attr("__gt__")(255)).attr("ravel")();
  const auto first = outside.attr("argmax")().cast<py::ssize_t>();
  if (outside.attr("size").cast<py::ssize_t>() > 0 && outside.attr("__getitem__")(first).cast<bool>()) {
    constexpr const char* kNames[]{"red", "green", "blue"};
    refuse("colors: row " + std::to_string(first / 3) + ": " + kNames[first % 3] + " is " +
           std::string(py::str(whole.attr("ravel")().attr("__getitem__")(first))) +
           "; whole numbers are 0 to 255 (uint16: 0 to 65535)");
  }
  return whole.attr("astype")("uint8");
}

pp_rows colorsOf(py::array& kept, const py::object& given, py::ssize_t count) {
  refuseMasked(given, "colors");
  py::array any = py::array::ensure(given);
  if (!any) PyErr_Clear();
  if (any && any.ndim() == 2 && any.shape(1) == 4)  // with alpha, which points do not have
    any = py::array(any.attr("T").attr("__getitem__")(py::slice(0, 3, 1)).attr("T"));
  const auto keep = [&]<class Number>(Number) {
    kept = py::array_t<Number, py::array::c_style>(any);
    return pp::rows(static_cast<const Number*>(kept.data()));
  };
  const char type = any ? any.dtype().kind() : 'f';
  if (type != 'f' && type != 'i' && type != 'u')
    refuseType("colors: must be whole numbers (0 to 255; uint16: 0 to 65535) or floats (0 to 1, or 0 to 255), not " +
               std::string(py::str(any.dtype())));
  if (any && type != 'f' && any.ndim() == 2 && any.shape(0) == count && any.shape(1) == 3) {
    if (any.dtype().equal(py::dtype::of<std::uint16_t>())) return keep(std::uint16_t{});
    if (!any.dtype().equal(py::dtype::of<std::uint8_t>())) any = bytesOf(any);
    return keep(std::uint8_t{});
  }
  kept = threeColumns(any ? py::object(any) : given, "colors", count);
  return rowsOf(kept);
}

py::object fieldOf(const CloudPointer& cloud, const py::object& owner, const char* name) {
  std::uint64_t count = 0;
  pp::check(pp_cloud_attribute_count(cloud->cloud().handle(), &count));
  for (std::uint64_t i = 0; i < count; ++i) {
    pp_attribute attribute{};
    pp::check(pp_cloud_get_attribute(cloud->cloud().handle(), i, &attribute));
    if (std::string(attribute.name) != name) continue;
    py::array view(py::dtype(std::string(attribute.type)), {cloud->view().count}, {}, attribute.data, owner);
    view.attr("setflags")(py::arg("write") = false);
    return view;
  }
  throw Refusal("UnknownNameError", "name: the cloud has no attribute '" + std::string(name) + "'");
}

std::vector<std::string> attributesOf(const CloudPointer& cloud) {
  std::uint64_t count = 0;
  pp::check(pp_cloud_attribute_count(cloud->cloud().handle(), &count));
  std::vector<std::string> names;
  for (std::uint64_t i = 0; i < count; ++i) {
    pp_attribute attribute{};
    pp::check(pp_cloud_get_attribute(cloud->cloud().handle(), i, &attribute));
    names.emplace_back(attribute.name);
  }
  return names;
}

/// File coordinates: a view of the floats if the cloud was made of float32 and they are exact, else a copy in doubles.
py::object placesOf(const py::object& self) {
  const auto cloud = self.cast<CloudPointer>();
  const pp_points points = cloud->view();
  const auto count = static_cast<py::ssize_t>(points.count);
  const bool atOrigin = points.origin[0] == 0 && points.origin[1] == 0 && points.origin[2] == 0;
  if (cloud->isSingle() && atOrigin) return viewOf(points.positions, {count, 3}, self);
  py::array_t<double> places(std::vector<py::ssize_t>{count, 3});
  double* const to = places.mutable_data();
  {
    const WithoutGil released;
    pp::check(pp_cloud_copy_positions(cloud->cloud().handle(), to, points.count));
  }
  places.attr("setflags")(py::arg("write") = false);
  return places;
}

void bindMeshes(py::module_& module) {
  py::class_<PyMesh, std::shared_ptr<PyMesh>>(
      module, "Mesh",
      "Triangles and their vertices, immutable, as Session.mesh() returns them. Arrays are read-only\n"
      "views of palpate's memory and keep the mesh alive.")
      .def_property_readonly(
          "vertices",
          [](const py::object& self) -> py::object {
            const pp_triangles mesh = self.cast<std::shared_ptr<PyMesh>>()->mesh().view();
            const auto count = static_cast<py::ssize_t>(mesh.vertices.count);
            return viewOf(mesh.vertices.positions, {count, 3}, self);
          },
          "(N, 3) float32 view, model units, relative to origin.")
      .def_property_readonly(
          "origin",
          [](const PyMesh& mesh) {
            const pp_points points = mesh.mesh().view().vertices;
            return Vector{points.origin[0], points.origin[1], points.origin[2]};
          },
          "Three floats, model units: file coordinates = origin + vertices.")
      .def_property_readonly(
          "normals",
          [](const py::object& self) -> py::object {
            const pp_triangles mesh = self.cast<std::shared_ptr<PyMesh>>()->mesh().view();
            const auto count = static_cast<py::ssize_t>(mesh.vertices.count);
            return viewOf(mesh.vertices.normals, {count, 3}, self);
          },
          "(N, 3) float32 view, unit length, outward.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) -> py::object {
            const pp_triangles mesh = self.cast<std::shared_ptr<PyMesh>>()->mesh().view();
            return viewOf(mesh.triangles, {static_cast<py::ssize_t>(mesh.count), 3}, self);
          },
          "(M, 3) uint32 view: indices of vertices, anticlockwise as seen from outside.")
      .def_property_readonly(
          "closed", [](const PyMesh& mesh) { return mesh.mesh().view().closed != 0; },
          "True if the mesh has no border.")
      .def(
          "save",
          [](const PyMesh& mesh, const py::object& path, bool ascii) {
            const std::string file = fileOf(path);
            pp_write_options options = pp_default_write_options();
            options.ascii = ascii ? 1 : 0;
            const WithoutGil released;
            mesh.mesh().write(file, options);
          },
          py::arg("file"), py::arg("ascii") = false,
          "save(file, ascii=False)\n\n"
          "Writes vertices with normals and triangles, in the format of the file's extension, as write()\n"
          "does. ascii: text, if the format has both. Raises Error with the file.")
      .def("_repr_png_", [](const py::object& self) { return helper("picture_of_mesh")(self); })
      .def("__repr__", [](const PyMesh& mesh) {
        const pp_triangles triangles = mesh.mesh().view();
        return "<palpate.Mesh of " + std::to_string(triangles.count) + " triangles, " +
               (triangles.closed ? "closed>" : "open>");
      });
}

}  // namespace

py::object helper(const char* name) { return py::module_::import("palpate._notebook").attr(name); }

std::shared_ptr<PyCloud> PyCloud::of(const py::object& xyz, const py::object& normals, const py::object& colors) {
  const py::array places = threeColumns(xyz, "xyz");
  pp_cloud_arrays arrays = pp_default_cloud_arrays();
  arrays.count = static_cast<std::uint64_t>(places.shape(0));
  arrays.positions = rowsOf(places);
  py::array facing, painted;  // kept alive until they are copied
  if (!normals.is_none()) {
    facing = threeColumns(normals, "normals", places.shape(0));
    arrays.normals = rowsOf(facing);
  }
  if (!colors.is_none()) arrays.colors = colorsOf(painted, colors, places.shape(0));
  const bool isSingle = places.dtype().equal(py::dtype::of<float>());
  const WithoutGil released;
  return std::make_shared<PyCloud>(pp::Cloud(arrays), isSingle);
}

namespace {

pp_prepare_options prepareOptions(const std::string& steps, double mm_per_unit, const std::optional<std::string>& up,
                                  Interruption& interruption) {
  pp_prepare_options options = pp_default_prepare_options();
  options.steps = steps.c_str();
  options.mm_per_unit = mm_per_unit;
  options.up = up ? up->c_str() : nullptr;
  options.watch = interruption.watch();
  return options;
}

py::array_t<bool> maskOf(const PyCloud& cloud, const std::string& steps, double mm_per_unit,
                         const std::optional<std::string>& up) {
  std::vector<std::uint8_t> kept;
  {
    Interruption interruption;
    const pp_prepare_options options = prepareOptions(steps, mm_per_unit, up, interruption);
    const WithoutGil released;
    kept = interruption.during([&] { return cloud.cloud().kept(options); });
  }
  py::array_t<bool> mask(static_cast<py::ssize_t>(kept.size()));
  std::copy(kept.begin(), kept.end(), mask.mutable_data());
  return mask;
}

std::shared_ptr<PyCloud> preparedCloud(const PyCloud& cloud, const std::string& steps, double mm_per_unit,
                                       const std::optional<std::string>& up) {
  Interruption interruption;
  const pp_prepare_options options = prepareOptions(steps, mm_per_unit, up, interruption);
  const WithoutGil released;
  return std::make_shared<PyCloud>(interruption.during([&] { return cloud.cloud().prepared(options); }),
                                   cloud.isSingle());
}

py::array_t<double> fieldValues(const PyCloud& cloud, const std::string& number, double mm_per_unit,
                                const std::optional<std::string>& up) {
  std::vector<double> values;
  {
    Interruption interruption;
    const pp_prepare_options options = prepareOptions("{}", mm_per_unit, up, interruption);
    const WithoutGil released;
    values = interruption.during([&] { return cloud.cloud().compute(number, options); });
  }
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

/// The points of a mask, as NumPy has it: bool, one for each point.
std::shared_ptr<PyCloud> chosenCloud(const PyCloud& cloud, const py::array& mask) {
  const auto flags = py::array_t<bool, py::array::c_style | py::array::forcecast>(mask);
  if (!mask.dtype().equal(py::dtype::of<bool>()) || flags.ndim() != 1)
    refuseType("mask: must be booleans, one for each point, not " + std::string(py::str(mask.dtype())) + " of shape " +
               shapeOf(mask));
  const std::vector<std::uint8_t> chosen(flags.data(), flags.data() + flags.size());
  const WithoutGil released;
  return std::make_shared<PyCloud>(cloud.cloud().choose(chosen), cloud.isSingle());
}

void bindCloud(py::module_& module) {
  py::class_<PyCloud, CloudPointer>(
      module, "Cloud",
      "Cloud(xyz, normals=None, colors=None)\n\n"
      "Points, immutable. xyz: (N, 3), model units; doubles keep their precision. normals: (N, 3), are\n"
      "normalized; a zero one is replaced by that of the nearest point, and UsageError raised if more than\n"
      "a tenth are zero. colors: (N, 3), or (N, 4) whose alpha is dropped: integers of 0 to 255, uint16 of\n"
      "0 to 65535, or floats of 0 to 1, or of 0 to 255 if any is above 1. All are copied. Properties are\n"
      "read-only views of palpate's memory and keep the cloud alive.")
      .def(py::init(&PyCloud::of), py::arg("xyz"), py::arg("normals") = py::none(), py::arg("colors") = py::none())
      .def("__repr__",
           [](const PyCloud& cloud) {
             const pp_points p = cloud.view();
             const auto side = [&](int k) { return py::str("{:.6g}").format(p.max[k] - p.min[k]).cast<std::string>(); };
             return "<palpate.Cloud of " + std::to_string(p.count) + " points" + (p.normals ? ", normals" : "") +
                    (p.colors ? ", colors" : "") + ", " + side(0) + " x " + side(1) + " x " + side(2) + ">";
           })
      .def("__len__", [](const PyCloud& cloud) { return cloud.view().count; })
      .def("__getitem__", &chosenCloud, py::arg("mask"),
           "The points where a mask is true: booleans, one for each point, as select() returns them. They keep all\n"
           "that they have.")
      .def(
          "field", &fieldValues, py::arg("number"), py::arg("mm_per_unit") = 0.0, py::arg("up") = py::none(),
          "field(number, mm_per_unit=0, up=None) -> array\n\n"
          "(N,) float64. number: an expression of fields, as 'z - 12.5', 'intensity / 256', or one that is computed: "
          "height,\n"
          "density (1/mm2), roughness (mm), curvature (1/mm), verticality. mm_per_unit: 0: as the file states, or the\n"
          "longest side is 100 mm. up: 'z', '-y' and such; None: found from the shape. Raises UsageError with the\n"
          "column of what is wrong, and the names of all fields.")
      .def(
          "select",
          [](const PyCloud& cloud, const std::string& condition, double mm_per_unit,
             const std::optional<std::string>& up) {
            return maskOf(cloud, helper("steps")(py::arg("where") = condition).cast<std::string>(), mm_per_unit, up);
          },
          py::arg("condition"), py::arg("mm_per_unit") = 0.0, py::arg("up") = py::none(),
          "select(condition, mm_per_unit=0, up=None) -> array\n\n"
          "(N,) bool: where a condition on fields holds, as 'classification == 2 && z > 3'. Comparisons with NaN do\n"
          "not hold; 64-bit whole numbers are compared exactly. Options and errors as for field().")
      .def(
          "outliers",
          [](const PyCloud& cloud, std::uint32_t neighbours, double sigma) {
            if (neighbours == 0) refuse("neighbours: is 0; it must be at least 1");
            const auto text =
                helper("steps")(py::arg("outlier_neighbours") = neighbours, py::arg("outlier_sigma") = sigma);
            return py::object(~maskOf(cloud, text.cast<std::string>(), 0, {}));
          },
          py::arg("neighbours") = 8, py::arg("sigma") = 1.0,
          "outliers(neighbours=8, sigma=1.0) -> array\n\n"
          "(N,) bool: points whose mean distance to their nearest neighbours is more than sigma standard deviations\n"
          "above the mean of all. cloud[~cloud.outliers()] is the cloud without them.")
      .def(
          "duplicates",
          [](const PyCloud& cloud) {
            return py::object(
                ~maskOf(cloud, helper("steps")(py::arg("drop_duplicates") = true).cast<std::string>(), 0, {}));
          },
          "duplicates() -> array\n\n"
          "(N,) bool: points with exactly the coordinates of an earlier one.")
      .def(
          "subsample",
          [](const PyCloud& cloud, double spacing_mm, double mm_per_unit) {
            return preparedCloud(cloud, helper("steps")(py::arg("subsample_mm") = spacing_mm).cast<std::string>(),
                                 mm_per_unit, {});
          },
          py::arg("spacing_mm"), py::arg("mm_per_unit") = 0.0,
          "subsample(spacing_mm, mm_per_unit=0) -> Cloud\n\n"
          "One original point in each cell, the one nearest to its middle. spacing_mm: side of a cell. mm_per_unit: as "
          "for\n"
          "field().")
      .def(
          "prepared",
          [](const PyCloud& cloud, double mm_per_unit, const std::optional<std::string>& up,
             const py::kwargs& settings) {
            return preparedCloud(cloud, helper("steps")(**settings).cast<std::string>(), mm_per_unit, up);
          },
          py::arg("mm_per_unit") = 0.0, py::arg("up") = py::none(),
          "prepared(mm_per_unit=0, up=None, crop=None, crop_outside=None, where='', drop_duplicates=False, "
          "outlier_neighbours=0, outlier_sigma=1, radius_neighbours=0, radius_mm=1, fill_holes_mm=0, subsample_mm=0, "
          "random=0, seed=1, set=[], upright=None, level=False) -> Cloud\n\n"
          "The steps of palpate convert, in their order: crop and crop_outside (two corners), where, drop_duplicates,\n"
          "outlier_neighbours and outlier_sigma, radius_neighbours and radius_mm, fill_holes_mm (the widest), "
          "subsample_mm,\n"
          "random (points) and seed, set (a list of rules, as 'uint8 label = 3 if z > 2'), upright (the axis that "
          "becomes z),\n"
          "level (the ground); as the section prepare of the\n"
          "reference describes them. mm_per_unit and up: as for field(). The cloud may be empty. In a splat scene the\n"
          "steps are done to the Gaussians, whose columns are fields, as in 'opacity > 0'; a mask of select() is of "
          "the\n"
          "points of their surface.")
      .def("__reduce__", [](const py::object& self) { return helper("reduced")(self); })
      .def("_repr_png_", [](const py::object& self) { return helper("picture")(self); })
      .def_property_readonly(
          "lost", [](const PyCloud& cloud) { return cloud.lost(); },
          "What of its file the cloud does not keep, one line each; empty for a cloud of arrays. A pickled\n"
          "cloud keeps everything but these lines and the Gaussians of a splat scene.")
      .def_property_readonly(
          "xyz", &placesOf,
          "(N, 3), file coordinates: float64. For a cloud made of float32 a float32 view, while origin is\n"
          "zero.")
      .def_property_readonly(
          "positions",
          [](const py::object& self) {
            const pp_points points = self.cast<CloudPointer>()->view();
            return viewOf(points.positions, {static_cast<py::ssize_t>(points.count), 3}, self);
          },
          "(N, 3) float32 view, relative to origin.")
      .def_property_readonly(
          "origin",
          [](const PyCloud& cloud) {
            const pp_points points = cloud.view();
            return Vector{points.origin[0], points.origin[1], points.origin[2]};
          },
          "Three floats, model units: file coordinates = origin + positions. Zero if float32 alone is\n"
          "precise enough.")
      .def_property_readonly(
          "normals",
          [](const py::object& self) -> py::object {
            const pp_points points = self.cast<CloudPointer>()->view();
            if (!points.normals) return py::none();
            return viewOf(points.normals, {static_cast<py::ssize_t>(points.count), 3}, self);
          },
          "(N, 3) float32 view, unit length; None without normals.")
      .def_property_readonly(
          "colors",
          [](const py::object& self) -> py::object {
            const pp_points points = self.cast<CloudPointer>()->view();
            if (!points.colors) return py::none();
            return viewOf(points.colors, {static_cast<py::ssize_t>(points.count), 4}, self);
          },
          "(N, 4) uint8 view: red, green, blue, alpha, 0 to 255; None without colours.")
      .def_property_readonly(
          "bounds",
          [](const PyCloud& cloud) {
            const pp_points p = cloud.view();
            return std::pair(Vector{p.min[0], p.min[1], p.min[2]}, Vector{p.max[0], p.max[1], p.max[2]});
          },
          "Minimum and maximum corner of the bounding box, three floats each, file coordinates; zeros\n"
          "without points.")
      .def_property_readonly("attributes", &attributesOf,
                             "Names of the further numbers of each point in the file, such as an intensity.")
      .def(
          "attribute",
          [](const py::object& self, const std::string& name) {
            return fieldOf(self.cast<CloudPointer>(), self, name.c_str());
          },
          py::arg("name"),
          "attribute(name) -> array\n\n"
          "One of attributes: (N,), a view in the file's type and unit. Raises UnknownNameError for an\n"
          "unknown name.");
}

void bindFiles(py::module_& module) {
  module.def(
      "read",
      [](const py::object& path, bool keep_unreliable, bool normals_from_faces) {
        const std::string file = fileOf(path);
        pp_read_options options = pp_default_read_options();
        options.keep_unreliable = keep_unreliable ? 1 : 0;
        options.normals_from_faces = normals_from_faces ? 1 : 0;
        Interruption interruption;
        options.watch = interruption.watch();
        std::vector<std::string> lost;
        options.log = [](void* lines, std::int32_t, const char* line) {
          static_cast<std::vector<std::string>*>(lines)->emplace_back(line);
        };
        options.log_user = &lost;
        const WithoutGil released;
        pp::Cloud cloud = interruption.during([&] { return pp::Cloud::read(file, options); });
        return std::make_shared<PyCloud>(std::move(cloud), false, std::move(lost));
      },
      py::arg("file"), py::arg("keep_unreliable") = false, py::arg("normals_from_faces") = false,
      "read(file, keep_unreliable=False, normals_from_faces=False) -> Cloud\n\n"
      "Reads a cloud of any format in formats_read(). keep_unreliable: includes points of a reconstruction\n"
      "that its own measures mark as unreliable. normals_from_faces: area-weighted normals of the faces\n"
      "replace those of the file. Raises Error with file and line.");
  module.def(
      "write",
      [](const py::object& path, const PyCloud& cloud, bool ascii, bool backup) {
        const std::string file = fileOf(path);
        pp_write_options options = pp_default_write_options();
        options.ascii = ascii ? 1 : 0;
        options.backup = backup ? 1 : 0;
        Interruption interruption;
        options.watch = interruption.watch();
        const WithoutGil released;
        interruption.during([&] { cloud.cloud().write(file, options); });
      },
      py::arg("file"), py::arg("cloud"), py::arg("ascii") = false, py::arg("backup") = false,
      "write(file, cloud, ascii=False, backup=False)\n\n"
      "Writes a cloud in the format of the file's extension, one of formats_written(). The file appears\n"
      "under its name only when it is complete. What the format cannot hold is not written: .pts has positions,\n"
      "colours and intensity alone; palpate convert names what is lost. ascii: text, if the format has both. backup: "
      "an existing\n"
      "file is kept as NAME.EXT.bak. Raises Error with the file.");
}

}  // namespace

void bindClouds(py::module_& module) {
  bindCloud(module);
  bindMeshes(module);
  bindFiles(module);
}

}  // namespace palpate::python
