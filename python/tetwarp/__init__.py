"""Warps volumes by deformed meshes of tetrahedra and hexahedra, simulates such meshes, and solves
frictional, adhesive contact.

Volumes are arrays of shape (z, y, x) or (z, y, x, components) in C order, meshes are (n, 3) nodes
and (m, 4), (m, 10) or (m, 8) cells. See docs/python.md.
"""

from ._autograd import autograd_warp
from ._bridges import (
    mesh_from,
    to_meshio,
    to_nibabel,
    to_pyvista,
    to_sitk,
    to_sitk_transform,
    volume_from,
)
from ._certify import Certificate, Collisions, certify, find_collisions
from ._compose import ComposedField, InverseMesh, compose, invert
from ._contact import ContactProblem, ContactSolution, ContactSolver, Csr, solve_contacts
from ._core import Cancelled, CudaError, IoError
from ._core import version as __version__
from ._device import available_backends
from ._dicom import read_dicom, to_rtdose
from ._fields import (
    Field,
    displacement_field,
    jacobian_determinant,
    rasterize,
    strain,
    transform_points,
)
from ._files import MeshFile, VolumeHeader, read, read_header, write
from ._grid import Grid
from ._mesh import (
    Mesh,
    Surface,
    boundary_surface,
    deform,
    isosurface,
    lattice_mesh,
    split_ten_nodes,
)
from ._operator import WarpOperator
from ._resample import resample
from ._result import WarpResult
from ._simulate import Contacts, Simulator, StepRecord, shipped_scene, shipped_scenes
from ._tracker import AdhesionStep, ContactRecords, ContactTracker, TrackedContacts
from ._volume import Volume, phantom
from ._warp import warp
from ._warper import Warper

__all__ = [
    "AdhesionStep",
    "Cancelled",
    "Certificate",
    "Collisions",
    "ComposedField",
    "ContactProblem",
    "ContactRecords",
    "ContactSolution",
    "ContactSolver",
    "ContactTracker",
    "Contacts",
    "Csr",
    "CudaError",
    "Field",
    "Grid",
    "InverseMesh",
    "IoError",
    "Mesh",
    "MeshFile",
    "Simulator",
    "StepRecord",
    "Surface",
    "TrackedContacts",
    "Volume",
    "VolumeHeader",
    "WarpOperator",
    "WarpResult",
    "Warper",
    "autograd_warp",
    "available_backends",
    "boundary_surface",
    "certify",
    "compose",
    "deform",
    "displacement_field",
    "find_collisions",
    "invert",
    "isosurface",
    "jacobian_determinant",
    "lattice_mesh",
    "mesh_from",
    "phantom",
    "rasterize",
    "read",
    "read_dicom",
    "read_header",
    "resample",
    "shipped_scene",
    "shipped_scenes",
    "solve_contacts",
    "split_ten_nodes",
    "strain",
    "to_meshio",
    "to_nibabel",
    "to_pyvista",
    "to_rtdose",
    "to_sitk",
    "to_sitk_transform",
    "transform_points",
    "volume_from",
    "warp",
    "write",
]
