/// @file io.hpp
/// Files: VTKHDF volumes and meshes (ParaView, VTK, PyVista), NIfTI volumes, PNG pictures, FCLIB
/// contact problems.
///
/// Every failure is an IoError whose one line names file, dataset and remedy. Sizes are checked
/// against the file and the machine's memory before anything is allocated. Writers write to a
/// temporary name in the same folder and rename when complete: no half file stands under its name.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>
#include <tetwarp/error.hpp>
#include <tetwarp/make.hpp>
#include <tetwarp/mesh.hpp>
#include <tetwarp/names.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// One array of a volume file, without its samples.
struct ArrayHeader {
  std::string name;
  PixelType type = PixelType::float32;
  int components = 1;

  bool operator==(const ArrayHeader&) const = default;
};

/// What a volume file holds.
struct VolumeHeader {
  Grid grid;                        ///< WholeExtent's start is folded into the origin
  std::vector<ArrayHeader> arrays;  ///< numeric point arrays, in the file's name order
  std::vector<double> times;        ///< one per step; empty: static
};

/// Reads the header of a VTKHDF ImageData file.
VolumeHeader read_volume_header(const std::string& path);

/// Reads one array of a VTKHDF ImageData file.
/// @param array  empty: the only or first array
/// @param step   of a temporal file; static files have step 0 only
Volume read_volume(const std::string& path, const std::string& array = {}, std::int64_t step = 0);

/// One array of a VTKHDF ImageData file, read region by region.
class VolumeReader {
 public:
  /// Arguments as of read_volume().
  explicit VolumeReader(const std::string& path,
                        const std::string& array = {},
                        std::int64_t step = 0);
  VolumeReader(VolumeReader&&) noexcept;
  ~VolumeReader();

  const Grid& grid() const;
  const ArrayHeader& array() const;

  /// Bytes that HDF5 holds of the array while it reads: its largest chunk, unpacked and packed.
  double chunk_bytes() const;

  /// Reads a region of the grid.
  /// @param samples  out, [k][j][i][component]
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
  std::vector<double> times;      ///< one per step; a static file has one step at time 0
  bool has_displacement = false;  ///< deformed = rest + displacement, else points that move
};

/// Choices of MeshReader.
struct MeshReadOptions {
  std::int64_t rest_step = 0;  ///< for points that move: the step that is rest
  std::optional<std::string> rest_file =
      {};  ///< rest positions from another mesh file with as many nodes
};

/// A VTKHDF UnstructuredGrid of tetrahedra with its deformation, in this order of preference:
/// point array `displacement` added to the rest points; points that move with the steps; the points
/// of `rest_file` as rest and this file's points as deformed. Partitions are concatenated.
class MeshReader {
 public:
  explicit MeshReader(const std::string& path, const MeshReadOptions& options = {});
  MeshReader(MeshReader&&) noexcept;
  ~MeshReader();

  const MeshHeader& header() const;
  const Mesh& mesh() const;  ///< rest positions and checked tetrahedra

  /// Deformed node positions of one step. Throws IoError for a step that does not exist.
  std::vector<Point3> read_step(std::int64_t step) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// How a volume file is stored.
struct VolumeWriteOptions {
  int compress = 0;                    ///< deflate level 0 to 9 with shuffle; 0: none
  double background = 0;               ///< fill value: chunks that hold nothing else are not stored
  bool skip_background_chunks = true;  ///< false: every chunk is stored
  std::string fingerprint = {};  ///< attribute `tetwarp_fingerprint` of /VTKHDF when not empty
};

/// A volume file that was written.
struct WrittenFile {
  std::int64_t bytes = 0;
  std::int64_t chunks = 0;             ///< of all arrays and steps
  std::int64_t chunks_background = 0;  ///< of these, not stored: they hold only the background
};

/// Writes one static VTKHDF ImageData file, Version [1,0], of volumes that share a grid.
/// Throws IoError on an axis of one sample (VTK crashes on those) and on any write failure.
WrittenFile write_volumes(const std::string& path,
                          const std::vector<const Volume*>& volumes,
                          const VolumeWriteOptions& options = {});

/// Writes one temporal VTKHDF ImageData file, Version [2,0], step by step.
class TemporalVolumeWriter {
 public:
  TemporalVolumeWriter(const std::string& path, const VolumeWriteOptions& options = {});
  TemporalVolumeWriter(TemporalVolumeWriter&&) noexcept;
  ~TemporalVolumeWriter();  ///< without finish(): removes the temporary file

  /// Appends a step. The same arrays in the same order each time.
  void append(double time, const std::vector<const Volume*>& volumes);

  /// Appends a step equal to the last one: its offset is repeated, its data are not stored twice.
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

/// Writes a VTKHDF ImageData file whose arrays come in regions: a static one, or a temporal one
/// step by step.
class BlockVolumeWriter {
 public:
  BlockVolumeWriter(const std::string& path,
                    const Grid& grid,
                    const std::vector<ArrayHeader>& arrays,
                    const VolumeWriteOptions& options,
                    bool is_temporal,
                    ChunkShape chunks = ChunkShape::bricks);
  BlockVolumeWriter(BlockVolumeWriter&&) noexcept;
  ~BlockVolumeWriter();  ///< without finish(): removes the temporary file

  /// Of temporal files: what is written next belongs to a new step, or: a step equal to the last.
  void begin_step(double time);
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

/// Edges of the bricks in which BlockVolumeWriter stores such arrays [voxel].
std::array<std::int64_t, 3> block_step(const Grid& grid, const std::vector<ArrayHeader>& arrays);

/// Writes a mesh; `displacements` (one vector of displacements per step) may be empty.
void write_mesh(const std::string& path,
                const Mesh& mesh,
                const std::vector<std::vector<Point3>>& displacements = {},
                const std::vector<double>& times = {});

/// The fingerprint attribute of a complete file, nothing when there is no such file or attribute.
std::optional<std::string> read_fingerprint(const std::string& path);

/// Reads a NIfTI file (.nii, .nii.gz); the affine (sform, else qform) becomes the grid. Positions
/// keep NIfTI's RAS world. scl_slope and scl_inter other than 1 and 0 give float32 samples
/// (float64 for float64). A shear in the sform that no grid can hold is an error.
/// Axis `dim[4]` (time) must be 1; `dim[5]` becomes components.
Volume read_nifti(const std::string& path);

/// Axes in which a NIfTI file holds samples that are vectors.
enum class NiftiVectors {
  world,  ///< those of the samples: the world axes of the volume
  lps     ///< x and y negated: a displacement field as ITK and ANTs read it
};
template <>
std::span<const EnumName<NiftiVectors>> names_of();

/// Writes a NIfTI file; qform and sform both hold the grid (qform only when direction is a
/// rotation). Samples of several components get the intent code VECTOR.
///
/// NIfTI's world is RAS, that of ITK and ANTs LPS: they turn positions when they read a file, but
/// not the samples of an image of vectors.
void write_nifti(const std::string& path,
                 const Volume& volume,
                 NiftiVectors vectors = NiftiVectors::world);

/// Writes an 8-bit RGB PNG.
void write_png(const std::string& path, const Image& image);

/// What an FCLIB file says around its problem.
struct ContactFileHeader {
  std::string title;
  std::string description;
  std::int64_t guesses = 0;           ///< starting points, /guesses/1 and so on
  bool has_solution = false;          ///< /solution/r is there; whose, and how good, is not said
  std::optional<std::string> status;  ///< of a solution of ours, as name_of(ContactStatus)
  std::optional<double> residual;     ///< eta of a solution of ours
};

/// Reads what an FCLIB file says around its problem.
ContactFileHeader read_contact_header(const std::string& path);

/// Where the iterations start.
enum class ContactStart {
  zero,   ///< `impulse_guess` stays empty
  stored  ///< the impulses of /solution or, when there are none or all are zero, of /guesses/1
};
template <>
std::span<const EnumName<ContactStart>> names_of();

/// Reads a contact problem in FCLIB's HDF5 format, checked by check_problem(): /fclib_local (W, q,
/// mu) or /fclib_global (M, H, f, w, mu) with matrices by columns, by rows or as triplets, and,
/// where they are there, /adhesion and /blocks. Numbers may be stored in any width, vectors in any
/// shape.
///
/// Three dimensions, no equality constraints (G, or V and R) and no rolling friction.
/// In /adhesion a missing `intensity` is 0; other vectors that are missing stay empty.
ContactProblem read_contact_problem(const std::string& path,
                                    ContactStart start = ContactStart::zero);

/// Writes a problem that check_problem() accepts as an FCLIB file; matrices by rows, H by columns.
/// @returns bytes of the file
std::int64_t write_contact_problem(const std::string& path,
                                   const ContactProblem& problem,
                                   const std::string& title = {},
                                   const std::string& description = {});

/// Writes a complete FCLIB file: everything the problem's file holds, with this solution in place
/// of its own and, when given, the adhesion of the next step.
///
/// /solution/{r, u, v, residual_history} (no v in local form) has the attributes `converged` (1 or
/// 0), `status`, `residual` (eta), `fclib_error` and `method`; /adhesion_next holds `intensity` and
/// `gap`. Throws IoError when the solution is that of another problem.
/// @returns bytes of the file
std::int64_t write_contact_solution(const std::string& path,
                                    const std::string& problem_path,
                                    const ContactSolution& solution,
                                    const AdhesionStep* adhesion_next = nullptr);

/// Kinds of files; name_of() gives a noun for messages: "volume", "contact problem".
enum class FileKind {
  volume,           ///< VTKHDF ImageData
  mesh,             ///< VTKHDF UnstructuredGrid
  other_vtkhdf,     ///< VTKHDF of another Type
  contact_problem,  ///< FCLIB
  hdf5,             ///< any other HDF5 file, also a damaged one
  nifti,            ///< NIfTI-1 in a single file, plain or gzip
  unknown
};
template <>
std::span<const EnumName<FileKind>> names_of();

/// The kind of a file, from its content. Throws IoError only when the file cannot be opened.
FileKind kind_of(const std::string& path);

}  // namespace tetwarp
