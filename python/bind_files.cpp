/// @file bind_files.cpp
/// Files of volumes, meshes and surfaces.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tetwarp/io.hpp>
#include <tetwarp/itk_space.hpp>
#include <tetwarp/scene_io.hpp>
#include <tetwarp/surface_reader.hpp>
#include <utility>
#include <vector>

#include "io/files/extension.hpp"
#include "python/arrays.hpp"
#include "python/bind.hpp"
#include "python/choices.hpp"
#include "python/curved_arrays.hpp"
#include "python/file_call.hpp"
#include "python/text.hpp"

namespace tetwarp::python {
namespace {
nb::dict dict_of(const NiftiFacts& facts) {
  nb::dict all;
  all["sform_code"] = facts.sform_code;
  all["qform_code"] = facts.qform_code;
  all["xyzt_units"] = facts.xyzt_units;
  all["intent_code"] = facts.intent_code;
  all["intent_p"] = nb::make_tuple(facts.intent_p[0], facts.intent_p[1], facts.intent_p[2]);
  all["intent_name"] = text_of(facts.intent_name);
  all["description"] = text_of(facts.description);
  all["component_axes"] = name_of(facts.component_axes);
  all["cal_min"] = facts.cal_min;
  all["cal_max"] = facts.cal_max;
  all["time_step"] = facts.time_step;
  return all;
}

/// @param all  as dict_of(); what is missing keeps its default
/// @throws std::invalid_argument  naming a member that is unknown or of another type
NiftiFacts facts_of(const nb::dict& all) {
  NiftiFacts facts;
  const nb::dict known = dict_of(facts);
  for (const auto [key, value] : all) {
    if (known.contains(key)) continue;
    throw std::invalid_argument("nifti: " + std::string(nb::repr(key).c_str()) +
                                " is no member of what read() gives");
  }
  const auto set = [&](const char* name, auto& member) {
    if (!all.contains(name) || nb::try_cast(all[name], member)) return;
    throw std::invalid_argument(std::string("nifti: ") + name + ": expected such as " +
                                nb::repr(known[name]).c_str());
  };
  const auto set_text = [&](const char* name, std::string& member) {
    if (all.contains(name)) member = bytes_of(all[name], std::string("nifti: ") + name);
  };
  set("sform_code", facts.sform_code);
  set("qform_code", facts.qform_code);
  set("xyzt_units", facts.xyzt_units);
  set("intent_code", facts.intent_code);
  set("intent_p", facts.intent_p);
  set_text("intent_name", facts.intent_name);
  set_text("description", facts.description);
  std::string axes = name_of(facts.component_axes);
  set_text("component_axes", axes);
  facts.component_axes = choice<Axes>("nifti: component_axes", axes);
  set("cal_min", facts.cal_min);
  set("cal_max", facts.cal_max);
  set("time_step", facts.time_step);
  return facts;
}

nb::list texts_of(const std::vector<std::string>& texts) {
  nb::list all;
  for (const std::string& text : texts) all.append(text_of(text));
  return all;
}

nb::object dict_of(const std::optional<NiftiFacts>& facts) {
  return facts ? nb::object(dict_of(*facts)) : nb::none();
}

nb::dict volume_header(const std::string& path) {
  const VolumeHeader header = file_call([&] { return read_volume_header(path); });
  nb::list arrays;
  for (const ArrayHeader& array : header.arrays) {
    nb::dict entry;
    entry["name"] = text_of(array.name);
    entry["dtype"] = name_of(array.type);
    entry["components"] = array.components;
    arrays.append(entry);
  }
  nb::dict all;
  all["grid"] = header.grid;
  all["arrays"] = arrays;
  all["active"] = text_of(header.active);
  all["times"] = header.times;
  all["not_read"] = texts_of(header.not_read);
  return all;
}

/// Samples, grid, name, header of NIfTI or None.
nb::tuple read_one_volume(const std::string& path,
                          const nb::str& array,
                          std::int64_t step,
                          const std::string& axes,
                          bool are_labels) {
  VolumeReadOptions options;
  options.axes = choice<Axes>("axes", axes);
  options.are_labels = are_labels;
  std::optional<NiftiFacts> facts;
  const std::string wanted = bytes_of(array, "array");
  Volume volume = file_call([&] {
    Volume read = read_volume(path, wanted, step, options);
    for (const ArrayHeader& header : read_volume_header(path, options).arrays) {
      if (header.name == read.name) facts = header.nifti;
    }
    return read;
  });
  const Grid grid = volume.grid;
  const nb::object name = text_of(volume.name);
  return nb::make_tuple(array_of(std::move(volume)), grid, name, dict_of(facts));
}

/// @param arrays  a dict per array: name, nifti (dict or None), is_itk_field, samples (a list, one
///                array per step)
void write_volume_file(const std::string& path,
                       const Grid& grid,
                       const std::vector<nb::dict>& arrays,
                       const std::vector<double>& times,
                       int compress) {
  std::vector<ArrayHeader> headers;
  std::vector<std::vector<InSamples>> samples;  // [array][step]
  for (const nb::dict& array : arrays) {
    samples.push_back(nb::cast<std::vector<InSamples>>(array["samples"], false));
    std::vector<VolumeView> steps;
    for (const InSamples& step : samples.back()) steps.push_back(view_of(AnySamples(step), grid));
    const VolumeView& first = steps.front();
    const auto is_other = [&](const VolumeView& step) {
      return step.type != first.type || step.components != first.components;
    };
    if (std::ranges::any_of(steps, is_other)) {
      throw std::invalid_argument("samples: expected steps of one type");
    }
    ArrayHeader header{bytes_of(array["name"], "name"), first.type, first.components};
    nb::dict facts;
    if (array["nifti"].is_none()) {
      header.nifti = default_nifti_facts(header.components);
    } else if (nb::try_cast(array["nifti"], facts)) {
      header.nifti = facts_of(facts);
    } else {
      throw std::invalid_argument("nifti: expected a dict, as read() gives it");
    }
    header.is_itk_field = nb::cast<bool>(array["is_itk_field"]);
    if (header.is_itk_field) header.nifti->component_axes = Axes::lps;
    headers.push_back(header);
  }
  VolumeWriteOptions options;
  options.compress = compress;
  file_call([&] {
    BlockVolumeWriter writer(path, grid, headers, options, !times.empty(), ChunkShape::rows);
    const Region whole{{0, 0, 0}, grid.dims};
    for (std::size_t step = 0; step < samples.front().size(); ++step) {
      if (!times.empty()) writer.begin_step(times[step]);
      for (std::size_t array = 0; array < samples.size(); ++array) {
        writer.write(array, whole, samples[array][step].data());
      }
    }
    return writer.finish().bytes;
  });
}

/// A MeshReader, whose calls are file calls; so is its end, which closes the file.
class MeshFile {
 public:
  MeshFile(const std::string& path,
           std::int64_t rest_step,
           const std::string& axes,
           bool keeps_curved)
      : reader_(open(path, rest_step, axes, keeps_curved)) {}
  ~MeshFile() {
    file_call([this] { reader_.reset(); });
  }
  MeshFile(const MeshFile&) = delete;
  MeshFile& operator=(const MeshFile&) = delete;

  const MeshReader& reader() const { return *reader_; }

 private:
  static MeshReader open(const std::string& path,
                         std::int64_t rest_step,
                         const std::string& axes,
                         bool keeps_curved) {
    MeshReadOptions options;
    options.rest_step = rest_step;
    options.import.keeps_curved = keeps_curved;
    options.import.axes = choice<Axes>("axes", axes);
    return file_call([&] { return MeshReader(path, options); });
  }

  std::optional<MeshReader> reader_;
};

nb::tuple mesh_arrays(const MeshFile& file) {
  Mesh mesh = file.reader().mesh();
  return nb::make_tuple(array_of(std::move(mesh.rest_positions)), array_of(std::move(mesh.tets)),
                        array_of(std::move(mesh.hexes)),
                        array_of(std::vector(file.reader().mid_nodes())));
}

/// @param displacements  [steps] of [nodes][3]
void write_mesh_file(const std::string& path,
                     const InPoints& points,
                     const InTets& tets,
                     const InHexes& hexes,
                     const InMidNodes& mids,
                     const std::vector<InPoints>& displacements,
                     const std::vector<double>& times) {
  const CurvedMesh mesh = curved_mesh_of(points, tets, hexes, mids);
  std::vector<std::vector<Point3>> steps;
  steps.reserve(displacements.size());
  for (const InPoints& step : displacements) steps.push_back(points_of(step));
  file_call([&] {
    write_mesh(path, mesh, steps, times);
    return true;
  });
}

nb::tuple strings_of(std::span<const std::string_view> texts) {
  nb::list all;
  for (const std::string_view text : texts) all.append(nb::str(text.data(), text.size()));
  return nb::tuple(all);
}
}  // namespace

void bind_files(nb::module_& module) {
  make_files_survive_forks();
  module.def(
      "kind_of",
      [](const std::string& path) { return name_of(file_call([&] { return kind_of(path); })); },
      nb::arg("path"));
  module.def("has_mesh_extension", &has_mesh_extension, nb::arg("path"));
  module.def(
      "has_component_axes",
      [](const std::string& path) { return file_call([&] { return has_component_axes(path); }); },
      nb::arg("path"));
  module.def(
      "is_surface_file",
      [](const std::string& path) { return file_call([&] { return is_surface_file(path); }); },
      nb::arg("path"));
  module.def("times_warning", &times_warning, nb::arg("path"), nb::arg("times"));
  module.attr("vtkhdf_endings") = strings_of(vtkhdf_endings);
  module.attr("volume_endings") = strings_of(volume_endings);
  module.def("volume_header", &volume_header, nb::arg("path"));
  module.def("read_volume", &read_one_volume, nb::arg("path"), nb::arg("array"), nb::arg("step"),
             nb::arg("axes"), nb::arg("are_labels"));
  module.def("write_volumes", &write_volume_file, nb::arg("path"), nb::arg("grid"),
             nb::arg("arrays"), nb::arg("times"), nb::arg("compress"));
  nb::class_<MeshFile>(module, "MeshFile")
      .def(nb::init<const std::string&, std::int64_t, const std::string&, bool>(), nb::arg("path"),
           nb::arg("rest_step"), nb::arg("axes"), nb::arg("keeps_curved"))
      .def("mesh", &mesh_arrays)
      .def_prop_ro("times", [](const MeshFile& file) { return file.reader().header().times; })
      .def_prop_ro("not_read",
                   [](const MeshFile& file) { return texts_of(file.reader().header().not_read); })
      .def(
          "read_step",
          [](const MeshFile& file, std::int64_t step) {
            return array_of(file_call([&] { return file.reader().read_step(step); }));
          },
          nb::arg("step"));
  module.def("write_mesh", &write_mesh_file, nb::arg("path"), nb::arg("points"), nb::arg("tets"),
             nb::arg("hexes"), nb::arg("mids"), nb::arg("displacements"), nb::arg("times"));
  module.def(
      "read_surface",
      [](const std::string& path) {
        Surface surface = file_call([&] { return read_surface(path); });
        return nb::make_tuple(array_of(std::move(surface.points)),
                              array_of(std::move(surface.triangles)));
      },
      nb::arg("path"));
  module.def(
      "write_surface",
      [](const std::string& path, const InPoints& points, const InTriangles& triangles) {
        const Surface surface{points_of(points), triangles_of(triangles)};
        file_call([&] { write_surface(path, surface); });
      },
      nb::arg("path"), nb::arg("points"), nb::arg("triangles"));
}

}  // namespace tetwarp::python
