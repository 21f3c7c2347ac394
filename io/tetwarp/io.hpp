/// @file io.hpp
/// Files: VTKHDF and NIfTI volumes, meshes of VTKHDF, Gmsh and VTK, PNG pictures, FCLIB problems.
///
/// Every function throws IoError on failure; its text is one line that names file, dataset and
/// remedy. Sizes are checked against the file and the available memory before anything is
/// allocated. Writers write to a temporary name in the same folder and rename the file when it is
/// complete. Positions are in the length unit of the file.
///
/// HDF5 may be built without support for threads: call one function at a time.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/contact_io.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/io_export.hpp>
#include <tetwarp/make.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/mesh_array.hpp>
#include <tetwarp/mesh_import.hpp>
#include <tetwarp/names.hpp>
#include <tetwarp/nifti.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// One array of a volume file, without its samples.
struct ArrayHeader {
  std::string name;
  PixelType type = PixelType::float32;
  int components = 1;
  std::optional<NiftiFacts> nifti = {};  ///< of the NIfTI file that the array comes from
  /// Of three components: a displacement, which a NIfTI file that is written holds as ITK's
  /// transforms take it: in millimeters and along the axes in which ITK places the image. ITK turns
  /// the positions of a header from RAS to LPS, unless the header has neither sform nor qform. Of a
  /// single axial slice, which ITK reads as a 2D image, the two components in the slice are
  /// written.
  bool is_itk_field = false;

  bool operator==(const ArrayHeader&) const = default;
};

/// What a volume file holds.
struct VolumeHeader {
  Grid grid;                        ///< dims from 0; the start of WholeExtent moves the origin
  std::vector<ArrayHeader> arrays;  ///< numeric point arrays as stored, or sorted by name
  /// The array that is read when none is named: the active scalars of the file, else the first one
  /// that is no extra output of a warp (their names begin with `tetwarp_`), else the first one.
  std::string active;
  /// Arrays that are stored as floats of less than 4 bytes, and read as float32.
  std::vector<std::string> widened;
  /// What is not read, as paths below /VTKHDF: point arrays of other elements than numbers and
  /// booleans, for example complex ones; cell data and field data.
  std::vector<std::string> not_read;
  /// What the header of a NIfTI file holds beyond grid, samples and NiftiFacts, by its name.
  std::vector<std::string> left_out = {};
  std::vector<std::string> notes = {};  ///< facts that a user should know, one line each
  std::vector<double> times;            ///< one per step; empty: a static file
};

/// Choices of readers of volumes; `axes` for NIfTI, NRRD and MetaImage files.
struct VolumeReadOptions {
  Axes axes = Axes::ras;  ///< of the components in the file, as of read_nifti()
  /// A file, which need not exist. In its folder a step of a gzip file is unpacked before regions
  /// of it are read; no name stays there. Empty: in the system's folder for temporary files.
  std::string scratch = {};
  /// Arrays of floats hold labels: they are read as int32, and a sample that is no whole number is
  /// an error. For files of every format.
  bool are_labels = false;
  /// Of a DICOM folder: the UID of the series; empty: the only one.
  std::string series = {};
};

/// Reads the header of a volume file: VTKHDF ImageData, .vti, NIfTI, NRRD, MetaImage, an image of
/// FreeSurfer, or the DICOM series in a folder, by its content. The array of all but the first two
/// is called `values`, and their grids are in RAS; the steps of a series have times in seconds,
/// where the header names a unit of time.
TETWARP_IO_EXPORT VolumeHeader read_volume_header(const std::string& path,
                                                  const VolumeReadOptions& options = {});

/// Reads an array of a volume file of these formats.
/// @param array  its name; empty: VolumeHeader::active
/// @param step   from 0, of a temporal file; a static file has step 0 only
TETWARP_IO_EXPORT Volume read_volume(const std::string& path,
                                     const std::string& array = {},
                                     std::int64_t step = 0,
                                     const VolumeReadOptions& options = {});

/// One array of a volume file, read region by region, for volumes larger than memory.
class TETWARP_IO_EXPORT VolumeReader {
 public:
  /// Arguments as of read_volume().
  explicit VolumeReader(const std::string& path,
                        const std::string& array = {},
                        std::int64_t step = 0,
                        const VolumeReadOptions& options = {});
  VolumeReader(VolumeReader&&) noexcept;
  ~VolumeReader();

  const Grid& grid() const;
  const ArrayHeader& array() const;

  /// Names of the numeric arrays of the file, in the order of VolumeHeader::arrays.
  std::vector<std::string> array_names() const;

  /// Memory for reading beside the samples [byte]: of HDF5 a chunk before and after decompression.
  double chunk_bytes() const;

  /// Space on the disk that reading parts of the grid takes [byte]; 0 but for gzip files.
  double unpacked_bytes() const;

  /// Reads a region of the grid.
  /// @param samples  out, [k][j][i][component] of the region, in the type of array()
  void read(const Region& region, void* samples) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What a mesh file holds.
struct MeshHeader {
  std::int64_t node_count = 0;
  std::int64_t tet_count = 0;
  std::int64_t hex_count = 0;
  std::string merged = {};         ///< how many cells are there twice, as a text; empty: none
  std::vector<double> times;       ///< one per step; a static file has one step at time 0
  bool has_displacement = false;   ///< deformed = rest + displacement; false: the step's points
  bool has_moving_points = false;  ///< steps have points of their own, which may differ
  /// Names of the values of the cell array `group`; see MeshArray::value_names.
  std::map<std::int64_t, std::string> group_names = {};
  /// What MeshReader does not read: arrays but the displacement, cells that are neither tetrahedra
  /// nor hexahedra, and what else import_mesh() names.
  std::vector<std::string> not_read = {};
};

/// Choices of MeshReader.
struct MeshReadOptions {
  /// The step whose points are the rest positions, where points move: of `rest_file`, for which
  /// nothing is an error then, else of the mesh, for which it is 0.
  std::optional<std::int64_t> rest_step = {};
  /// Another mesh file with as many nodes, whose points are the rest positions. A mesh with a
  /// displacement must have the same points.
  std::optional<std::string> rest_file = {};
  /// For files of Gmsh and VTK; its axes also for `rest_file`, and `keeps_curved` for all.
  MeshImportOptions import = {};
};

/// A mesh of tetrahedra and hexahedra with its deformation: a VTKHDF UnstructuredGrid, or what
/// import_mesh() reads. Deformed positions are the points plus the point array `displacement`, or,
/// without that array, the points of the step. Rest positions are the points of `rest_step` or
/// those of `rest_file`. Partitions are concatenated. Of cells that are there twice, with nodes at
/// the same places, the first is kept.
///
/// Of a VTKHDF file steps are read when they are asked for; files of Gmsh and VTK are kept in
/// memory with all steps.
class TETWARP_IO_EXPORT MeshReader {
 public:
  explicit MeshReader(const std::string& path, const MeshReadOptions& options = {});
  MeshReader(MeshReader&&) noexcept;
  ~MeshReader();

  const MeshHeader& header() const;
  const Mesh& mesh() const;  ///< rest positions and checked cells
  /// With MeshImportOptions::keeps_curved those of CurvedMesh; empty: no cell has ten nodes.
  const std::vector<MidNodes>& mid_nodes() const;

  /// Deformed positions of one step, one per node [world].
  std::vector<Point3> read_step(std::int64_t step) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// How a volume file is stored.
struct VolumeWriteOptions {
  /// Deflate level 0 to 9, with shuffle; 0: none. Of .nii.gz the level of gzip; 0: its default.
  int compress = 0;
  double background = 0;               ///< fill value, which chunks that are not stored read as
  bool skip_background_chunks = true;  ///< do not store chunks that hold only the background
  std::string fingerprint = {};  ///< attribute `tetwarp_fingerprint` of /VTKHDF when not empty
  /// The array that becomes the active scalars; when it is none of those written, the first one
  /// whose name does not begin with `tetwarp_`, else the first one.
  std::string scalars = {};
};

/// A volume file that was written.
struct WrittenFile {
  std::int64_t bytes = 0;              ///< size of the file
  std::int64_t chunks = 0;             ///< of all arrays and steps
  std::int64_t chunks_background = 0;  ///< of these, not stored: they hold only the background
};

/// Writes a static VTKHDF ImageData file, Version [1,0], of volumes that share a grid. VTK 9.1
/// and 9.2 crash on files with an axis of one sample; later versions read them.
TETWARP_IO_EXPORT WrittenFile write_volumes(const std::string& path,
                                            const std::vector<const Volume*>& volumes,
                                            const VolumeWriteOptions& options = {});

/// Writes one temporal VTKHDF ImageData file, Version [2,0], step by step.
class TETWARP_IO_EXPORT TemporalVolumeWriter {
 public:
  TemporalVolumeWriter(const std::string& path, const VolumeWriteOptions& options = {});
  TemporalVolumeWriter(TemporalVolumeWriter&&) noexcept;
  ~TemporalVolumeWriter();  ///< without finish(): removes the temporary file

  /// Appends a step. All steps have the same arrays in the same order.
  void append(double time, const std::vector<const Volume*>& volumes);

  /// Appends a step equal to the last one: its samples are not stored again.
  void repeat(double time);
  /// Flushes and moves the file to its name.
  WrittenFile finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Shapes of the chunks in which an array is stored.
enum class ChunkShape {
  rows,   ///< for arrays that are written whole: as write_volumes() stores them
  bricks  ///< for arrays that are written in blocks: nearly cubes, edges by block_step()
};

/// Writes a volume file region by region: a static one, or a temporal one step by step. A name that
/// ends in .nii or .nii.gz is written as NIfTI, of one array, along the axes of its NiftiFacts; one
/// of has_image_name() in its format, .vti as VTK's XML image of one step; any other as VTKHDF
/// ImageData. Blocks and series of NIfTI,
/// and series and packed files of other images take their space on the disk twice until they are
/// finished.
class TETWARP_IO_EXPORT BlockVolumeWriter {
 public:
  BlockVolumeWriter(const std::string& path,
                    const Grid& grid,
                    const std::vector<ArrayHeader>& arrays,
                    const VolumeWriteOptions& options,
                    bool is_temporal,
                    ChunkShape chunks = ChunkShape::bricks);
  BlockVolumeWriter(BlockVolumeWriter&&) noexcept;
  ~BlockVolumeWriter();  ///< without finish(): removes the temporary file

  /// In a temporal file: begins a step, to which all writes until the next call belong. Of NIfTI
  /// files times should be equally spaced: they keep the first and the mean of the intervals.
  void begin_step(double time);
  /// In a temporal file: appends a step equal to the last one.
  void repeat_step(double time);

  /// Writes a region of an array.
  /// @param region   with ChunkShape::rows the whole grid; else begins and ends at multiples of
  ///                 block_step(), or at the grid's end
  /// @param samples  [k][j][i][component] of the region
  void write(std::size_t array, const Region& region, const void* samples);

  /// Flushes and moves the file to its name.
  WrittenFile finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Edges of the bricks in which BlockVolumeWriter stores arrays [voxel].
TETWARP_IO_EXPORT std::array<std::int64_t, 3> block_step(const Grid& grid,
                                                         const std::vector<ArrayHeader>& arrays);

/// Writes a mesh as a VTKHDF UnstructuredGrid.
/// @param displacements  deformed minus rest position [world], per step, per node; may be empty
/// @param times          one per step
/// @param arrays         other arrays of nodes and cells, the same at every step
TETWARP_IO_EXPORT void write_mesh(const std::string& path,
                                  const Mesh& mesh,
                                  const std::vector<std::vector<Point3>>& displacements = {},
                                  const std::vector<double>& times = {},
                                  const std::vector<MeshArray>& arrays = {});
/// The same with tetrahedra of ten nodes.
TETWARP_IO_EXPORT void write_mesh(const std::string& path,
                                  const CurvedMesh& mesh,
                                  const std::vector<std::vector<Point3>>& displacements = {},
                                  const std::vector<double>& times = {},
                                  const std::vector<MeshArray>& arrays = {});

/// The fingerprint that a volume file was written with; nothing when there is no such file or
/// fingerprint.
TETWARP_IO_EXPORT std::optional<std::string> read_fingerprint(const std::string& path);

/// Writes an 8-bit RGB PNG.
TETWARP_IO_EXPORT void write_png(const std::string& path, const Image& image);

/// Kinds of files; name_of() gives a noun for messages: "volume", "contact problem".
enum class FileKind {
  volume,           ///< VTKHDF ImageData
  mesh,             ///< VTKHDF UnstructuredGrid
  other_vtkhdf,     ///< VTKHDF of another Type
  contact_problem,  ///< FCLIB
  hdf5,             ///< any other HDF5 file, also a damaged one
  nifti,            ///< NIfTI-1 or NIfTI-2, plain or gzip; also either file of a pair
  analyze,          ///< Analyze 7.5, header or samples
  image,            ///< NRRD (.nrrd, .nhdr), MetaImage (.mha, .mhd), FreeSurfer (.mgh, .mgz), .vti,
                    ///< DICOM; also a folder, which may hold a DICOM series
  unknown
};
template <>
TETWARP_IO_EXPORT std::span<const EnumName<FileKind>> names_of();

/// True for names of NIfTI images that can be written: .nii and .nii.gz.
TETWARP_IO_EXPORT bool has_nifti_name(const std::string& path);

/// True for other names of images of one array that can be written: .nrrd, .mha, .mhd, .mgh, .mgz.
TETWARP_IO_EXPORT bool has_image_name(const std::string& path);

/// What a series loses of its times by the format of its name: NIfTI, NRRD and MetaImage keep a
/// first time and an interval, FreeSurfer's images none; in VTKHDF, times that do not increase are
/// refused by other programs.
/// @param output  name of the file to write
/// @param times   of the steps
/// @returns one line with a remedy, empty if nothing is lost
TETWARP_IO_EXPORT std::string times_warning(const std::string& output,
                                            const std::vector<double>& times);

/// True for names of VTK's XML images: .vti.
TETWARP_IO_EXPORT bool has_vtk_image_name(const std::string& path);

/// The kind of a file, from its content. Throws IoError only when the file cannot be opened.
TETWARP_IO_EXPORT FileKind kind_of(const std::string& path);

/// Throws IoError if a file of the kind `hdf5` cannot be opened: it is truncated or damaged.
TETWARP_IO_EXPORT void check_sound(const std::string& path, FileKind kind);

}  // namespace tetwarp
