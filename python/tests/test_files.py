"""Files are written and read back."""

import warnings

import numpy as np
import pytest

import tetwarp

TURN = np.array([(0.8, -0.6, 0), (0.6, 0.8, 0), (0, 0, 1)])


@pytest.mark.parametrize("dtype", ["uint8", "int16", "float32", "float64", "int64"])
@pytest.mark.parametrize("ending", ["vtkhdf", "nii", "nii.gz"])
def test_volumes_come_back(dtype, ending, tmp_path):
    samples = np.arange(4 * 5 * 6).reshape(4, 5, 6).astype(dtype)
    volume = tetwarp.Volume(samples, tetwarp.Grid((4, 5, 6), (1, 2, 3), (4, 5, 6), TURN))

    tetwarp.write(tmp_path / f"a.{ending}", volume)
    read = tetwarp.read(tmp_path / f"a.{ending}")

    assert read.array.dtype == samples.dtype and np.array_equal(read.array, samples)
    assert np.allclose(read.affine, volume.affine, atol=1e-5)


def test_several_arrays_and_steps_come_back(tmp_path):
    grid = tetwarp.Grid((3, 4, 5))
    a, b = np.random.default_rng(1).random((2, 3, 4, 5))

    tetwarp.write(tmp_path / "two.vtkhdf",
                  [tetwarp.Volume(a, grid, "a"), tetwarp.Volume(b, grid, "b")], compress=3)
    tetwarp.write(tmp_path / "steps.vtkhdf", [a, b], grid=grid, times=[0, 0.5])

    header = tetwarp.read_header(tmp_path / "two.vtkhdf")
    assert [array["name"] for array in header.arrays] == ["a", "b"] and header.grid == grid
    assert np.array_equal(tetwarp.read(tmp_path / "two.vtkhdf", array="b"), b)
    assert tetwarp.read_header(tmp_path / "steps.vtkhdf").times == [0, 0.5]
    assert np.array_equal(tetwarp.read(tmp_path / "steps.vtkhdf", step=1), b)


@pytest.mark.parametrize("ending", ["vtkhdf", "nii", "nii.gz", "nrrd", "mha", "mgz"])
def test_times_come_back_or_are_named(ending, volume, tmp_path):
    path = tmp_path / f"steps.{ending}"
    for times in [(0, 1, 2), (0, 1, 5), (2, 1, 0), (1, 1, 1), (2, 1), (1, 1), (0.5, 2), (3, 4)]:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            tetwarp.write(path, [volume.array] * len(times), grid=volume.grid, times=times)
        read = tetwarp.read_header(path).times  # readable, whatever they are
        assert len(read) == len(times)
        named = [str(one.message) for one in caught]
        assert all("times of the steps" in text and str(path) in text for text in named)
        assert named or np.allclose(read, times, atol=1e-3), (times, read)
        if ending == "vtkhdf":
            assert np.array_equal(read, times) and bool(named) == (min(np.diff(times)) <= 0)
        elif np.allclose(read, times, atol=1e-3):
            assert not named, (times, read)


def test_headers_of_nifti_are_kept(tmp_path):
    volume = tetwarp.phantom("fish", (5, 6, 7))
    tetwarp.write(tmp_path / "a.nii", volume)
    read = tetwarp.read(tmp_path / "a.nii")
    read.nifti.update(description="a fish", qform_code=3, intent_code=1002)

    tetwarp.write(tmp_path / "b.nii", read)

    assert tetwarp.read(tmp_path / "b.nii").nifti == read.nifti


def test_results_of_a_warp_keep_the_header(tmp_path, mesh, twisted, volume):
    tetwarp.write(tmp_path / "a.nii", volume)
    read = tetwarp.read(tmp_path / "a.nii")
    read.nifti["description"] = "before"

    tetwarp.write(tmp_path / "b.nii.gz", tetwarp.warp(read, *mesh, twisted))

    assert tetwarp.read(tmp_path / "b.nii.gz").nifti["description"] == "before"
    with pytest.raises(tetwarp.IoError, match="c.nii"):
        tetwarp.write(tmp_path / "c.nii", tetwarp.warp(read, *mesh, twisted, outputs="mask"))


def test_images_of_nibabel_are_the_same(tmp_path):
    nibabel = pytest.importorskip("nibabel")
    affine = np.array([(-2, 0, 0, 90), (0, 0, 3, -126), (0, 2.5, 0, -72), (0, 0, 0, 1.0)])
    image = nibabel.Nifti1Image(np.arange(120, dtype=np.int16).reshape(6, 5, 4), affine)
    nibabel.save(image, tmp_path / "a.nii.gz")

    read = tetwarp.read(tmp_path / "a.nii.gz")

    assert np.array_equal(read.array, np.asarray(image.dataobj).T)
    assert np.allclose(read.affine, affine)


def test_numbers_that_nifti_1_has_no_place_for_are_left_out(tmp_path):
    nibabel = pytest.importorskip("nibabel")
    image = nibabel.Nifti2Image(np.zeros((4, 3, 2), np.float32), np.eye(4))
    image.header["cal_max"], image.header["cal_min"] = 1e300, -3
    image.header["pixdim"][4] = 1e300
    image.to_filename(tmp_path / "two.nii")

    volume = tetwarp.read(tmp_path / "two.nii")
    for name in ("one.nii", "one.vtkhdf"):
        tetwarp.write(tmp_path / name, volume)
        assert tetwarp.read(tmp_path / name).nifti == volume.nifti
    assert (volume.nifti["cal_min"], volume.nifti["cal_max"]) == (-3, 0)


def test_hdf5_of_h5py_and_of_the_library_live_together(tmp_path):
    h5py = pytest.importorskip("h5py")
    volume = tetwarp.phantom("fish", (5, 6, 7))
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["x"] = np.arange(5)
        tetwarp.write(tmp_path / "a.vtkhdf", volume)
        with h5py.File(tmp_path / "a.vtkhdf") as mine:
            stored = mine["VTKHDF/PointData/fish"][...]
        read = tetwarp.read(tmp_path / "a.vtkhdf")

    assert np.array_equal(stored, volume.array) and np.array_equal(read.array, volume.array)


@pytest.mark.parametrize("hexahedra", [False, True])
def test_meshes_and_their_steps_come_back(hexahedra, volume, tmp_path):
    mesh = tetwarp.lattice_mesh(volume, cells=3, hexahedra=hexahedra)
    steps = [tetwarp.deform(*mesh, time=time) for time in (0, 0.5, 1)]

    tetwarp.write(tmp_path / "mesh.vtkhdf", mesh, deformed=steps)
    file = tetwarp.read(tmp_path / "mesh.vtkhdf")

    assert np.array_equal(file.mesh.points, mesh.points)
    assert np.array_equal(file.mesh.cells, mesh.cells)
    assert file.times == [0, 0.5, 1] and len(file) == 3
    assert all(np.allclose(x, y, rtol=0, atol=1e-12) for x, y in zip(file, steps))
    assert np.array_equal(file.step(-1), file.step(2))
    with pytest.raises(ValueError, match="number: expected a step from 0 to 2, got 3"):
        file.step(3)


def test_every_ending_of_a_volume_is_a_format(volume, tmp_path):
    endings = tetwarp._core.volume_endings
    for ending in endings:
        tetwarp.write(tmp_path / f"a{ending}", volume)

    is_hdf5 = [(tmp_path / f"a{end}").read_bytes().startswith(b"\x89HDF") for end in endings]
    assert is_hdf5 == [end in tetwarp._core.vtkhdf_endings for end in endings]
    assert set(tetwarp._core.vtkhdf_endings) < set(endings)


def test_surfaces_come_back(volume, mesh, tmp_path):
    surface = tetwarp.boundary_surface(*mesh)

    tetwarp.write(tmp_path / "skin.vtkhdf", surface)

    assert "points" in repr(surface)
    read = tetwarp.read(tmp_path / "skin.vtkhdf")
    assert np.array_equal(read.points, surface.points)
    assert np.array_equal(read.triangles, surface.triangles)
    with pytest.raises(tetwarp.IoError, match="skin.vtkhdf"):
        tetwarp.MeshFile(tmp_path / "skin.vtkhdf")  # triangles are no mesh to warp by


def test_surfaces_of_other_programs_are_read(tmp_path):
    """By tetwarp-read, which the module finds beside itself."""
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\n")

    try:
        surface = tetwarp.read(tmp_path / "a.obj")
    except tetwarp._core.MissingLibrary as error:
        pytest.skip(str(error))

    assert surface.points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert surface.triangles.tolist() == [[0, 2, 1], [0, 1, 3]]


def write_vtu(path, points, cells):
    def array(name, kind, values, columns=1):
        text = " ".join(map(str, np.ravel(values).tolist()))
        return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{columns}" '
                f'format="ascii">{text}</DataArray>')

    ends = 4 * np.arange(1, len(cells) + 1)
    path.write_text(
        '<VTKFile type="UnstructuredGrid" version="1.0"><UnstructuredGrid>'
        f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}"><Points>'
        f'{array("Points", "Float64", points, 3)}</Points><Cells>'
        f'{array("connectivity", "Int64", cells)}{array("offsets", "Int64", ends)}'
        f'{array("types", "UInt8", [10] * len(cells))}</Cells></Piece></UnstructuredGrid></VTKFile>')


STEP_TIMES = [0.0, 0.25, 1.5]


@pytest.mark.parametrize("name, text", [
    ("list.pvd", '<VTKFile type="Collection"><Collection>' + "".join(
        f'<DataSet timestep="{time}" file="step_{n}.vtu"/>' for n, time in enumerate(STEP_TIMES))
     + "</Collection></VTKFile>"),
    ("list.vtu.series", '{"file-series-version": "1.0", "files": [' + ", ".join(
        f'{{"name": "step_{n}.vtu", "time": {time}}}' for n, time in enumerate(STEP_TIMES)) + "]}"),
    ("step_*.vtu", ""),
    ("LIST.PVD", '<VTKFile type="Collection"><Collection>' + "".join(
        f'<DataSet timestep="{time}" file="step_{n}.vtu"/>' for n, time in enumerate(STEP_TIMES))
     + "</Collection></VTKFile>"),
])
def test_meshes_in_many_files_are_one_series(name, text, mesh, tmp_path):
    steps = [tetwarp.deform(*mesh, amount=0.3, time=time) for time in (0.2, 0.6, 1)]
    for number, step in enumerate(steps):
        write_vtu(tmp_path / f"step_{number}.vtu", step, mesh.cells)
    if text:
        (tmp_path / name).write_text(text)

    try:
        file = tetwarp.read(tmp_path / name)
        last = tetwarp.MeshFile(tmp_path / name, rest_step=2, axes="lps")
    except tetwarp._core.MissingLibrary as error:
        pytest.skip(str(error))

    assert np.array_equal(file.mesh.cells, mesh.cells)
    assert file.times == (STEP_TIMES if text else [0, 1, 2])
    assert np.array_equal(file.mesh.points, steps[0])
    assert np.allclose(list(file), steps, rtol=0, atol=1e-12)  # kept as displacements
    assert np.allclose(last.mesh.points, steps[2] * (-1, -1, 1), rtol=0, atol=1e-12)


def test_blocks_of_a_file_are_one_mesh(mesh, tmp_path):
    away = mesh.points + 1000
    for number, points in enumerate((mesh.points, away)):
        write_vtu(tmp_path / f"{number}.vtu", points, mesh.cells)
    (tmp_path / "two.vtm").write_text(
        '<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet>'
        '<DataSet index="0" file="0.vtu"/><DataSet index="1" file="1.vtu"/>'
        "</vtkMultiBlockDataSet></VTKFile>")

    try:
        both = tetwarp.read(tmp_path / "two.vtm").mesh
    except tetwarp._core.MissingLibrary as error:
        pytest.skip(str(error))

    assert np.array_equal(both.points, np.vstack([mesh.points, away]))
    assert np.array_equal(both.cells, np.vstack([mesh.cells, mesh.cells + len(away)]))


def test_axes_without_effect_are_refused_before_samples_are_read(tmp_path):
    tetwarp.write(tmp_path / "a.vtkhdf", np.zeros((2, 3, 4)), grid=tetwarp.Grid((2, 3, 4)))

    with pytest.raises(ValueError, match="axes: has no effect on a volume that is no NIfTI"):
        tetwarp.read(tmp_path / "a.vtkhdf", axes="lps", array="none")


def test_displacement_fields_are_written_for_itk(mesh, twisted, volume, tmp_path):
    field = tetwarp.displacement_field(*mesh, twisted, reference=volume)

    tetwarp.write(tmp_path / "field.nii.gz", field)
    read = tetwarp.read(tmp_path / "field.nii.gz", axes="lps")

    assert np.allclose(read.array, field.values, atol=1e-5)
    plain = tetwarp.read(tmp_path / "field.nii.gz")  # ITK's components: x and y turned
    assert np.allclose(plain.array * (-1, -1, 1), field.values, atol=1e-5)


def test_errors_name_file_and_remedy(tmp_path):
    with pytest.raises(tetwarp.IoError, match="none.vtkhdf"):
        tetwarp.read(tmp_path / "none.vtkhdf")
    (tmp_path / "text.vtkhdf").write_text("not a volume")
    with pytest.raises(OSError, match="text.vtkhdf"):
        tetwarp.read(tmp_path / "text.vtkhdf")
    with pytest.raises(tetwarp.IoError):
        tetwarp.write(tmp_path / "text.vtkhdf/a.nii", tetwarp.phantom("fish", (4, 4, 4)))
    with pytest.raises(ValueError, match="grid: an array needs its grid"):
        tetwarp.write(tmp_path / "a.nii", np.zeros((2, 2, 2)))


def test_texts_in_another_encoding_keep_their_bytes(volume, tmp_path):
    """Of Latin-1, as scanners write it."""
    tetwarp.write(tmp_path / "a.nii", volume)
    content = bytearray((tmp_path / "a.nii").read_bytes())
    content[148:155] = "Sch\u00e4del".encode("latin-1")  # the header's description
    (tmp_path / "a.nii").write_bytes(content)

    read = tetwarp.read(tmp_path / "a.nii")
    read.name = read.nifti["description"]
    tetwarp.write(tmp_path / "b.nii", read)
    tetwarp.write(tmp_path / "b.vtkhdf", read)

    assert (tmp_path / "b.nii").read_bytes() == content
    assert tetwarp.read(tmp_path / "b.vtkhdf").nifti == read.nifti
    name = read.nifti["description"]
    assert name.encode("latin-1", "surrogateescape").decode("latin-1") == "Sch\u00e4del"
    assert tetwarp.read_header(tmp_path / "b.vtkhdf").active == name
    assert np.array_equal(tetwarp.read(tmp_path / "b.vtkhdf", array=name), volume)
    with pytest.raises(tetwarp.IoError, match="missing dataset"):
        tetwarp.read(tmp_path / "b.vtkhdf", array=name + name)


@pytest.mark.parametrize("facts, text", [
    (5, "nifti: expected a dict"),
    ({"descrip": "x"}, "nifti: 'descrip' is no member"),
    ({"sform_code": 1.5}, "nifti: sform_code: expected such as 1"),
    ({"intent_p": (1, 2)}, "nifti: intent_p: expected such as"),
    ({"intent_name": b"x"}, "nifti: intent_name: expected a text"),
    ({"component_axes": "xyz"}, "nifti: component_axes: 'xyz' is not one of ras, lps"),
    ({"intent_code": 2**15}, "intent_code is 32768, expected 0 to 32767"),
    ({"xyzt_units": -1}, "xyzt_units is -1, expected 0 to 255"),
    ({"intent_name": 17 * "x"}, "intent_name has 17 bytes, expected at most 16"),
    ({"description": 41 * "\u00e4"}, "description has 82 bytes, expected at most 80"),
    ({"cal_max": 1e39}, "cal_max is no finite number of 32 bits"),
    ({"time_step": 0}, "time_step is not above 0"),
    ({"time_step": -1}, "time_step is not above 0"),
    ({"time_step": 1e-50}, "time_step is not above 0"),
])
@pytest.mark.parametrize("ending", ["nii", "vtkhdf"])
def test_what_a_header_cannot_hold_is_not_written(ending, facts, text, volume, tmp_path):
    volume.nifti = facts

    with pytest.raises((ValueError, tetwarp.IoError), match=text):
        tetwarp.write(tmp_path / f"a.{ending}", volume)

    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("times", [(0, np.nan), (np.inf, 0)])
def test_times_that_no_reader_takes_are_not_written(times, volume, mesh, tmp_path):
    with pytest.raises(tetwarp.IoError, match="a.vtkhdf: the time of a step is"):
        tetwarp.write(tmp_path / "a.vtkhdf", [volume, volume], times=times)
    with pytest.raises(tetwarp.IoError, match="b.vtkhdf: the time of a step is"):
        tetwarp.write(tmp_path / "b.vtkhdf", mesh, deformed=[mesh.points] * 2, times=times)

    assert not list(tmp_path.iterdir())


def test_arguments_without_an_effect_are_refused(volume, mesh, twisted, tmp_path):
    surface, problem = tetwarp.boundary_surface(*mesh), tetwarp.ContactProblem(
        delassus=np.eye(3), free_velocity=[-1, 0, 0], friction=[0])
    kinds = {"mesh": mesh, "surface": surface, "volume": volume, "problem": problem,
             "result": tetwarp.warp(volume, *mesh, twisted)}
    for name, value in kinds.items():
        tetwarp.write(tmp_path / f"{name}.vtkhdf", value)

    for given, names in {
        "grid": "mesh surface problem result", "compress": "mesh surface problem",
        "deformed": "surface problem volume result", "times": "surface problem",
    }.items():
        values = {"grid": volume.grid, "compress": 1, "deformed": [twisted], "times": [0]}
        for name in names.split():
            with pytest.raises(ValueError, match=f"{given}: has no effect on a"):
                tetwarp.write(tmp_path / "none.vtkhdf", kinds[name], **{given: values[given]})
    with pytest.raises(ValueError, match="grid: value.0. has one; leave it out"):
        tetwarp.write(tmp_path / "none.vtkhdf", volume, grid=tetwarp.Grid(volume.shape))
    for given, value in {"array": "a", "step": 1, "axes": "lps", "labels": True}.items():
        for name in ("mesh", "surface", "problem"):
            with pytest.raises(ValueError, match=f"{given}: has no effect on a"):
                tetwarp.read(tmp_path / f"{name}.vtkhdf", **{given: value})
    assert not (tmp_path / "none.vtkhdf").exists()


@pytest.mark.parametrize("case", [str.lower, str.upper])
@pytest.mark.parametrize("ending", tetwarp._core.volume_endings)
def test_what_has_no_effect_on_a_volume_is_refused(ending, case, tmp_path):
    """`compress` packs, or is refused; `axes` turn, or are refused: for all formats."""
    path = tmp_path / f"a{case(ending)}"
    zeros = np.zeros((20, 20, 20), np.float32)
    grid = tetwarp.Grid(zeros.shape)
    tetwarp.write(path, zeros, grid=grid)
    plain = sum(file.stat().st_size for file in tmp_path.iterdir())

    try:
        tetwarp.write(path, zeros, grid=grid, compress=9)
    except ValueError as error:
        assert str(error).startswith("compress: has no effect on a volume of")
        assert ending in (".nii", ".mgh", ".vti")
        assert plain > zeros.nbytes
    else:
        packed = [file for file in tmp_path.iterdir() if file.suffix.lower() != ".raw"]
        assert sum(file.stat().st_size for file in packed) < zeros.nbytes / 4
        assert ending not in (".nii", ".mgh", ".vti")
    components = () if ending in (".mgh", ".mgz") else (3,)  # these hold one number per voxel
    vectors = np.random.default_rng(1).random((2, 3, 4, *components)).astype(np.float32)
    tetwarp.write(path, vectors, grid=tetwarp.Grid((2, 3, 4)))
    usual = tetwarp.read(path).array
    if ending in (".nii", ".nii.gz", ".nrrd", ".mha", ".mhd"):
        assert np.array_equal(tetwarp.read(path, axes="lps").array, usual * np.float32([-1, -1, 1]))
        return
    with pytest.raises((ValueError, OSError), match="axes"):
        tetwarp.read(path, axes="lps")


def test_axes_of_meshes_of_vtkhdf_are_refused(mesh, tmp_path):
    tetwarp.write(tmp_path / "a.vtkhdf", mesh)

    for call in (tetwarp.read, tetwarp.MeshFile):
        with pytest.raises(ValueError, match="axes: has no effect on a mesh of VTKHDF"):
            call(tmp_path / "a.vtkhdf", axes="lps")


@pytest.mark.parametrize("ending", [".nii", ".nrrd", ".mha"])
def test_vectors_along_lps_axes_are_written_as_they_were(tmp_path, ending):
    vectors = np.random.default_rng(1).normal(size=(2, 3, 4, 3)).astype(np.float32)
    path = tmp_path / ("a" + ending)
    tetwarp.write(path, vectors, grid=tetwarp.Grid((2, 3, 4)))

    tetwarp.write(path, tetwarp.read(path, axes="lps"))

    np.testing.assert_array_equal(tetwarp.read(path).array, vectors)
    tetwarp.write(path, vectors[..., 0], grid=tetwarp.Grid((2, 3, 4)))
    with pytest.raises(tetwarp.IoError, match='axes="lps" turns'):
        tetwarp.read(path, axes="lps")


def test_remedies_name_arguments_of_the_package(tmp_path):
    tetwarp.write(tmp_path / "a.nii", np.zeros((2, 3, 4)), grid=tetwarp.Grid((2, 3, 4)))
    calls = {
        'axes="lps" turns': lambda: tetwarp.read(tmp_path / "a.nii", axes="lps"),
        "steps in files of their own$": lambda: tetwarp.write(
            tmp_path / "a.vti", [np.zeros((2, 3, 4))] * 2, grid=tetwarp.Grid((2, 3, 4)), times=[0, 1]),
    }

    for text, call in calls.items():
        with pytest.raises(tetwarp.IoError, match=text) as caught:
            call()
        assert "--" not in str(caught.value)
