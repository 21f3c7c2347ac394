#!/usr/bin/env python3
"""Checks that every source file lies beside a header of its name.

    sources.py           fails with one line per file that breaks the rules
    sources.py --test    checks this script on a small made-up tree
"""
import re
import sys
from pathlib import Path

TOPS = ("kernels", "host", "io")
SOURCES = (".cpp", ".cu")
HEADERS = (".hpp", ".cuh", "-inl.hpp")
PUBLIC = ("host/tetwarp", "io/tetwarp", "kernels/base/tetwarp")
# Files chosen when the project is built or when it runs: NAME_VARIANT.cpp of NAME.hpp, which may
# also lie one folder up or be public.
VARIANTS = ("cuda", "nocuda", "cpu", "reference", "avx2", "avx512", "base", "gif", "nogif", "gmsh",
            "nogmsh", "gdcm", "nogdcm", "mpi", "nompi", "sdl", "nosdl", "spnav",
            "nospnav", "vrpn", "novrpn", "vtk", "novtk", "zmq", "nozmq")
# Programs: main and its subcommands have no header.
PROGRAMS = re.compile(r"(host/cli|host/view/window|io/reader)/(main|(\w+/)?cmd_\w+)\.cpp")
# Other files whose functions a header of another name declares, by this header.
DECLARED_IN = {
    # Public headers of several subjects: a file for each, in the folder of the subject.
    "host/tetwarp/blocks.hpp": ["host/warp/block_mesh.cpp"],
    "host/tetwarp/contact.hpp": [
        "host/contact/adhesion.cpp", "host/contact/contact_solver.cpp", "host/contact/report.cpp",
        "host/contact/solve_arrays.cpp"],
    "host/tetwarp/contact_analysis.hpp": ["host/contact/energy.cpp", "host/contact/modes.cpp"],
    "host/tetwarp/contact_problem.hpp": ["host/contact/problem/problem.cpp"],
    "host/tetwarp/contact_tracker.hpp": ["host/contact/tracker/tracker.cpp"],
    "host/tetwarp/make.hpp": [
        "host/make/deform_mesh.cpp", "host/make/lattice_mesh.cpp", "host/make/phantom.cpp",
        "host/make/phantom_fish.cpp", "host/make/phantom_orange.cpp",
        "host/make/render_surfaces.cpp", "host/make/render_volume.cpp"],
    "host/tetwarp/scene.hpp": ["host/scene/checks/check_scene.cpp"],
    "host/tetwarp/simulate.hpp": [
        "host/simulate/run/simulator.cpp", "host/simulate/step/cell_fields.cpp"],
    "host/tetwarp/surface.hpp": ["host/simulate/model/surface_mesh.cpp"],
    "host/tetwarp/warp.hpp": ["host/warp/warper.cpp"],
    "io/tetwarp/contact_io.hpp": ["io/fclib/contact_checkpoint.cpp"],
    "io/tetwarp/io.hpp": [
        "io/fclib/fclib_contact.cpp", "io/fclib/fclib_write.cpp", "io/files/names.cpp",
        "io/picture/png_image.cpp", "io/volume/file_kind.cpp", "io/volume/mesh_reader.cpp",
        "io/volume/times_warning.cpp",
        "io/volume/volume_file.cpp", "io/vtkhdf/vtkhdf_write.cpp",
        "io/vtkhdf/vtkhdf_write_mesh.cpp"],
    "io/tetwarp/scene_io.hpp": ["io/scene/scene_file.cpp", "io/vtkhdf/surface_file.cpp"],
    # One function per back end or library, declared together.
    "host/base/warp_backend.hpp": [
        "host/reference/warp/backend_reference.cpp", "host/warp/cpu/backend_cpu.cpp",
        "host/warp/cuda/backend_cuda.cu", "host/warp/cuda/backend_nocuda.cpp"],
    "host/contact/cuda/device.hpp": ["host/contact/cuda/contact_nocuda.cpp"],
    "io/reader/image_readers.hpp": [
        "io/reader/dicom_gdcm.cpp", "io/reader/dicom_nogdcm.cpp", "io/reader/image_vtk.cpp"],
    "io/reader/mesh_readers.hpp": [
        "io/reader/mesh_gmsh.cpp", "io/reader/mesh_nogmsh.cpp", "io/reader/mesh_novtk.cpp",
        "io/reader/coarsen_vtk.cpp", "io/reader/mesh_vtk.cpp", "io/reader/surface_vtk.cpp"],
    # Kernels include nothing of the host.
    "kernels/base/host_tasks.hpp": ["host/base/host_tasks.cpp"],
    # Compiling CUB takes long: only this file includes it.
    "kernels/exec/exec_cuda.cuh": ["kernels/exec/primitives_cuda.cu"],
}


def sources(root):
    for top in TOPS:
        for path in sorted((root / top).rglob("*")):
            if path.suffix in SOURCES:
                yield path.relative_to(root)


def has_header(root, name, folders):
    """Whether a header of this name lies in one of the folders."""
    return any((root / folder / (name + end)).exists() for folder in folders for end in HEADERS)


def is_beside_header(root, path):
    """Whether the name of a file leads to the header that declares its functions."""
    if has_header(root, path.stem, [path.parent]) or PROGRAMS.fullmatch(path.as_posix()):
        return True
    text = (root / path).read_text(encoding="utf-8")
    name, _, variant = path.stem.rpartition("_")
    is_variant = variant in VARIANTS
    return any(
        f"#include <tetwarp/{stem}.hpp>" in text and has_header(root, stem, PUBLIC)
        for stem in (path.stem, name if is_variant else path.stem)
    ) or (is_variant and has_header(root, name, [path.parent, path.parent.parent]))


def violations(root, declared_in=None):
    declared_in = DECLARED_IN if declared_in is None else declared_in
    listed = {file: header for header, files in declared_in.items() for file in files}
    for path in sources(root):
        name = path.as_posix()
        header = listed.pop(name, None)
        if is_beside_header(root, path):
            if header:
                yield f"{name} has a header of its name: it needs no line in sources.py"
        elif header is None:
            yield f"{name} has no header of its name beside it"
        elif not (root / header).exists():
            yield f"{name} is listed in sources.py below {header}, which does not exist"
    for name in listed:
        yield f"{name} is listed in sources.py and does not exist"


def test():
    """Files without a header are found, and exceptions that are none."""
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        for name, text in {
            "kernels/exec/scan.cuh": "",
            "kernels/exec/scan.cu": "",
            "host/tetwarp/warp.hpp": "",
            "host/warp/warp.cpp": "#include <tetwarp/warp.hpp>\n",
            "host/warp/rows.hpp": "",
            "host/warp/cpu/rows_cpu.cpp": "",
            "host/cli/warp/cmd_warp.cpp": "",
        }.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        assert not list(violations(root, {})), list(violations(root, {}))
        (root / "host/warp/slice.cpp").write_text("")
        (root / "host/cli/warp.cpp").write_text("")  # does not include the public header
        assert list(violations(root, {})) == [
            "host/cli/warp.cpp has no header of its name beside it",
            "host/warp/slice.cpp has no header of its name beside it"]
        (root / "host/cli/warp.cpp").unlink()
        assert not list(violations(root, {"host/warp/rows.hpp": ["host/warp/slice.cpp"]}))
        assert list(violations(root, {
            "host/warp/gone.hpp": ["host/warp/slice.cpp"],
            "host/warp/rows.hpp": ["host/warp/gone.cpp", "kernels/exec/scan.cu"]})) == [
            "kernels/exec/scan.cu has a header of its name: it needs no line in sources.py",
            "host/warp/slice.cpp is listed in sources.py below host/warp/gone.hpp, "
            "which does not exist",
            "host/warp/gone.cpp is listed in sources.py and does not exist"]


def main():
    if "--test" in sys.argv:
        test()
    found = list(violations(Path(__file__).resolve().parents[2]))
    print("\n".join(found) or "source files lie beside headers of their names")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
