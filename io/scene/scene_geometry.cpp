/// @file scene_geometry.cpp
/// Shapes, volumes, meshes, sheets, lattices, surfaces and poses of scene files.
#include "io/scene/scene_geometry.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <tetwarp/certify.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/io.hpp>
#include <tetwarp/scene_io.hpp>

#include "host/base/point3.hpp"
#include "io/files/memory.hpp"
#include "io/import/coarse_surface.hpp"
#include "io/scene/scene_files.hpp"
#include "io/scene/scene_loft.hpp"

namespace tetwarp {
namespace {
/// A shape by its type and the keys beside it.
Shape shape_of_type(const SceneValue& type, SceneObject& object) {
  const std::string word = type.text();
  const auto length = [&](const char* key) { return object.get(key, "a length in m").number(); };
  const auto lengths = [&](const char* key) {
    return object.get(key, "three lengths [x, y, z] in m").point();
  };
  if (word == "box") return BoxShape{lengths("half")};
  if (word == "ellipsoid") return EllipsoidShape{lengths("radii")};
  if (word == "plate") return PlateShape{lengths("size")};
  if (word == "capsule") return CapsuleShape{length("radius"), length("length")};
  if (word == "cylinder") return CylinderShape{length("radius"), length("length")};
  if (word == "torus") return TorusShape{length("radius"), length("tube")};
  if (word == "sphere") {
    const double radius = length("radius");
    return EllipsoidShape{{radius, radius, radius}};
  }
  if (word == "arc") {
    return ArcShape{length("radius"), length("tube"),
                    object.get("angles", "[first, second] in rad").array<2>()};
  }
  if (word == "bent_strip") {
    return BentStripShape{length("width"), length("height"), length("depth"), length("sag")};
  }
  type.fail_word("is no shape", {"box", "sphere", "ellipsoid", "capsule", "cylinder", "torus",
                                 "arc", "bent_strip", "plate", "loft"});
}

void read_shape(const SceneValue& value, SceneFiles& files, Body& into) {
  SceneObject object(value);
  const SceneValue type = object.get("type", "e.g. \"box\"");
  if (type.text() == "loft") {
    read_loft(value, object, files, into);
  } else {
    into.geometry = shape_of_type(type, object);
  }
  object.finish();
}

// ---- volumes ------------------------------------------------------------------
struct Phantom {
  const char* name;
  double threshold;  ///< default
  double voxel_bytes;
  Volume (*make)(const std::array<std::int64_t, 3>& dims, const Point3& spacing);
};

Volume make_torso_phantom(const std::array<std::int64_t, 3>& dims, const Point3&) {
  return make_phantom(dims);
}

constexpr Phantom phantoms[] = {{"torso", 0.02, 4, make_torso_phantom},
                                {"orange", orange_phantom_threshold, 4, make_orange_phantom},
                                {"fish", fish_phantom_threshold, 1, make_fish_phantom}};

void check_voxels(const SceneValue& value, const Grid& grid, double voxel_bytes) {
  try {
    check_grid(grid, "the grid");
  } catch (const std::invalid_argument& error) {
    value.fail(error.what());
  }
  const double bytes = static_cast<double>(grid.voxel_count()) * voxel_bytes;
  if (bytes > available_memory()) {
    value.fail("needs " + bytes_text(bytes) + " of memory, more than there is; use smaller dims");
  }
}

void read_phantom(SceneObject& object, const SceneValue& name, SceneFiles& files, Body& into) {
  const Phantom* chosen = nullptr;
  for (const Phantom& phantom : phantoms) {
    if (name.text() == phantom.name) chosen = &phantom;
  }
  if (chosen == nullptr) name.fail_word("is no phantom", {"torso", "orange", "fish"});
  Grid grid;
  grid.dims = object.get("dims", "the numbers of voxels [i, j, k]").whole_array<3>(1);
  grid.spacing = object.get("spacing", "the distances of voxels [i, j, k] in m").point();
  object.read("origin", grid.origin);
  check_voxels(object.value(), grid, chosen->voxel_bytes);
  ImageGeometry image;
  image.threshold = chosen->threshold;
  object.read("threshold", image.threshold);
  into.geometry = std::move(image);
  std::string content = chosen->name;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double number :
         {static_cast<double>(grid.dims[axis]), grid.spacing[axis], grid.origin[axis]}) {
      content += ' ' + SceneJson(number).dump();
    }
  }
  files.add_volume(object.value(), content, into, [grid, make = chosen->make] {
    Volume volume = make(grid.dims, grid.spacing);
    volume.grid = grid;
    return volume;
  });
}

void read_volume_key(const SceneValue& value, SceneFiles& files, Body& into) {
  SceneObject object(value);
  if (const auto phantom = object.find("phantom")) {
    read_phantom(object, *phantom, files, into);
  } else {
    const SceneValue file = object.get("file", "the name of a volume file");
    const auto array = object.find("array");
    const std::string array_name = array ? array->text() : "";
    ImageGeometry image;
    image.threshold = object.get("threshold", "a number: foreground is from there on").number();
    into.geometry = std::move(image);
    const std::string path = files.path_of(file);
    files.add_volume(file, "file " + path + '\n' + array_name, into,
                     [path, array_name] { return read_volume(path, array_name); });
  }
  object.finish();
}

constexpr double most_distance = 0.1;  // of a coarser surface, over the body's size

// ---- meshes -------------------------------------------------------------------
/// Refuses surfaces that touch themselves: they do not tell inside from outside.
/// @param what  the surface, for the message
/// @throws std::invalid_argument
void check_simple(const Surface& surface, const std::string& what) {
  const MovingSurface still{surface.points, surface.points, surface.triangles};
  const Certificate certificate = certify({&still, 1});
  if (certificate.pairs.empty()) return;
  const auto [a, b] = certificate.pairs.front().triangles;
  const std::size_t others = certificate.pairs.size() - 1;
  std::string problem =
      what + " intersects itself, in triangles " + std::to_string(a) + " and " + std::to_string(b);
  if (others > 0) {
    problem += " and " + std::to_string(others) + (others == 1 ? " other pair" : " other pairs");
  }
  throw std::invalid_argument(problem);
}

/// A mesh of tetrahedra or else of triangles.
Geometry read_either(const std::string& path, SceneFiles& files) {
  try {
    return files.read_mesh(path);
  } catch (const IoError&) {
    try {
      return files.read_triangles(path);
    } catch (const IoError&) {
    }
    throw;
  }
}

void read_mesh_key(const SceneValue& value, SceneFiles& files, Body& into) {
  SceneObject object(value);
  const SceneValue file = object.get("file", "the name of a mesh file");
  object.finish();
  const std::string path = files.path_of(file);
  // Until the file is read: a geometry of the kind that the file will hold.
  if (into.kind == BodyKind::fem || into.kind == BodyKind::scripted) {
    into.geometry = Mesh{};
  } else {
    into.geometry = Surface{};
  }
  files.add(file, [path, &files, &into] {
    if (into.lattice) {
      Surface surface = files.read_triangles(path);
      check_simple(surface, "the surface");
      into.geometry = std::move(surface);
    } else if (into.kind == BodyKind::fem) {
      into.geometry = files.read_mesh(path);
    } else if (into.kind == BodyKind::scripted) {
      into.geometry = read_either(path, files);
    } else {
      into.geometry = files.read_triangles(path);
    }
  });
}

Sheet read_sheet(const SceneValue& value) {
  SceneObject object(value);
  Sheet sheet;
  sheet.size = object.get("size", "two lengths [a, b] in m").array<2>();
  sheet.cells = object.get("cells", "two numbers of squares [m, n]").whole_array<2>(1);
  object.read("origin", sheet.origin);
  if (const auto axes = object.find("axes")) {
    const std::vector<SceneValue> rows = axes->items("two vectors [[x, y, z], [x, y, z]]");
    if (rows.size() != 2) axes->fail_type("two vectors [[x, y, z], [x, y, z]]");
    for (std::size_t a = 0; a < 2; ++a) {
      Point3 axis = rows[a].point();
      const double length = std::hypot(axis[0], axis[1], axis[2]);
      if (!(length > 0 && length < 1e150)) rows[a].fail("expected a vector with a direction");
      for (double& component : axis) component /= length;
      sheet.axes[a] = axis;
    }
  }
  object.finish();
  return sheet;
}
}  // namespace

void read_geometry(SceneObject& object, SceneFiles& files, Body& into) {
  int count = 0;
  if (const auto shape = object.find("shape")) {
    read_shape(*shape, files, into);
    ++count;
  }
  if (const auto volume = object.find("volume")) {
    read_volume_key(*volume, files, into);
    ++count;
  }
  if (const auto mesh = object.find("mesh")) {
    read_mesh_key(*mesh, files, into);
    ++count;
  }
  if (const auto sheet = object.find("sheet")) {
    into.geometry = read_sheet(*sheet);
    ++count;
  }
  if (count > 1) {
    object.fail("has several geometries, expected one of shape, volume, mesh and sheet");
  }
}

void read_lattice(SceneObject& object, Body& into) {
  const auto value = object.find("lattice");
  if (!value) return;
  SceneObject keys(*value);
  Lattice lattice;
  if (const auto cells = keys.find("cells")) lattice.cells = cells->whole_array<3>(1);
  keys.read("edge", lattice.edge);
  if (const auto tets = keys.find("tets")) lattice.tets = tets->whole(1);
  keys.finish();
  into.lattice = lattice;
  if (std::holds_alternative<Mesh>(into.geometry)) into.geometry = Surface{};  // of its file
}

void read_surface_file(const SceneValue& value,
                       SceneFiles& files,
                       std::function<void(Surface)> store) {
  const std::string path = files.path_of(value);
  files.add(value, [path, &files, store = std::move(store)] { store(files.read_triangles(path)); });
}

namespace {
/// Of the box around all points.
double diagonal_of(const Surface& surface) {
  Bounds box;
  for (const Point3& point : surface.points) box.include(point);
  return norm(minus(box.high, box.low));
}

/// Puts a coarser copy of the body's mesh in the place of its surface.
void read_distance(const SceneValue& value, SceneFiles& files, Body& into) {
  const double distance = value.number();
  if (!(distance > 0)) value.fail("expected a length above 0");
  files.add(value, [distance, &into] {
    const auto* fine = std::get_if<Surface>(&into.geometry);
    if (fine == nullptr || !into.lattice) {
      throw std::invalid_argument(
          "is only for bodies of a mesh of triangles with a lattice, remove it");
    }
    const double size = diagonal_of(*fine);
    if (!(distance <= most_distance * size)) {
      throw std::invalid_argument("is too coarse: expected at most a tenth of the body's size, " +
                                  SceneJson(most_distance * size).dump());
    }
    Surface coarse = coarse_surface("the surface", *fine, distance);
    check_simple(coarse, "is too coarse: the surface of " +
                             std::to_string(coarse.triangles.size()) + " triangles");
    into.surface = std::move(coarse);
  });
}
}  // namespace

void read_surface_choice(SceneObject& object, SceneFiles& files, Body& into) {
  const auto value = object.find("surface");
  if (!value) return;
  SceneObject keys(*value);
  const auto triangles = keys.find("triangles");
  const auto mesh = keys.find("mesh");
  const auto distance = keys.find("distance");
  if (triangles.has_value() + mesh.has_value() + distance.has_value() != 1) {
    value->fail("expected one of triangles, mesh and distance");
  }
  if (triangles) into.surface = triangles->whole(4);
  if (mesh) {
    read_surface_file(*mesh, files, [&into](Surface read) { into.surface = std::move(read); });
  }
  if (distance) read_distance(*distance, files, into);
  keys.finish();
}

void read_pose(SceneObject& object, Pose& into) {
  const auto value = object.find("pose");
  if (!value) return;
  SceneObject keys(*value);
  keys.read("position", into.position);
  const auto axis_angle = keys.find("axis_angle");
  const auto quaternion = keys.find("quaternion");
  if (axis_angle && quaternion) value->fail("expected either axis_angle or quaternion");
  if (axis_angle) {
    const Point3 turn = axis_angle->point();
    const double angle = std::hypot(turn[0], turn[1], turn[2]);
    if (!(angle < 1e6)) axis_angle->fail("turns by more than 1e6 rad, give a smaller angle");
    const double factor = angle > 0 ? std::sin(angle / 2) / angle : 0;
    into.rotation = {std::cos(angle / 2), factor * turn[0], factor * turn[1], factor * turn[2]};
  }
  if (quaternion) {
    into.rotation = quaternion->array<4>();
    double sum = 0;
    for (const double component : into.rotation) sum += component * component;
    if (!(sum > 1e-12 && sum < 1e12)) quaternion->fail("expected [w, x, y, z] of length 1");
    for (double& component : into.rotation) component /= std::sqrt(sum);
  }
  keys.finish();
}

}  // namespace tetwarp
