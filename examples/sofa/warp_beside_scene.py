"""A controller of SOFA: a CT follows a running simulation of tetrahedra.

    runSofa -l SofaPython3 warp_beside_scene.py

`VolumeFollower` is the computation and needs no SOFA.
"""

import numpy as np
import tetwarp


class VolumeFollower:
    """Warps a volume to positions of nodes that change from step to step.

    volume : tetwarp.Volume, or an array with the keywords of tetwarp.Warper in `options`
    rest, tetrahedra : (n, 3) and (m, 4)
    every : steps per warp
    on_volume : called with the number of the step and the warped samples, which stay the same array
    """

    def __init__(self, volume, rest, tetrahedra, *, every=1, on_volume=None, **options):
        if every < 1:
            raise ValueError(f"every: expected 1 or more steps, got {every}")
        samples = np.asarray(volume)
        self.samples = np.empty_like(samples)
        self.step, self._every, self._on_volume = 0, every, on_volume
        self._warper = tetwarp.Warper(volume, rest, tetrahedra, **options)

    def follow(self, positions):
        """Counts a step and, each `every` steps, warps. Returns the WarpResult, or None."""
        self.step += 1
        if self.step % self._every != 0:
            return None
        result = self._warper(np.asarray(positions, float), out=self.samples)
        if self._on_volume is not None:
            self._on_volume(self.step, self.samples)
        return result


def make_controller(follower, mechanical_object):
    """A controller for the root node: after each step the volume follows the mechanical object."""
    import Sofa.Core

    class TetWarpController(Sofa.Core.Controller):
        def onAnimateEndEvent(self, event):
            follower.follow(mechanical_object.position.value)

    return TetWarpController(name="tetwarp")


def createScene(root):
    """A block of tissue that is an image sags; warped images go to sagging_*.nii.gz."""
    volume = tetwarp.phantom("orange", (48, 48, 48), spacing=(2.0, 2.0, 2.0))
    mesh = tetwarp.lattice_mesh(volume, cells=6)
    low = mesh.points[:, 2].min()
    fixed = np.flatnonzero(mesh.points[:, 2] < low + 1e-6)
    root.gravity = [0, 0, -9810]
    root.dt = 0.01
    for plugin in ("LinearSolver.Direct", "ODESolver.Backward", "StateContainer", "Mass",
                   "Topology.Container.Dynamic", "SolidMechanics.FEM.Elastic",
                   "Constraint.Projective"):
        root.addObject("RequiredPlugin", name=f"Sofa.Component.{plugin}")
    root.addObject("DefaultAnimationLoop")
    body = root.addChild("body")
    body.addObject("EulerImplicitSolver")
    body.addObject("SparseLDLSolver", template="CompressedRowSparseMatrixMat3x3d")
    body.addObject("TetrahedronSetTopologyContainer", position=mesh.points.tolist(),
                   tetrahedra=mesh.cells.tolist())
    state = body.addObject("MechanicalObject", template="Vec3d")
    body.addObject("UniformMass", totalMass=0.5)
    body.addObject("TetrahedronFEMForceField", youngModulus=5000, poissonRatio=0.45)
    body.addObject("FixedProjectiveConstraint", indices=fixed.tolist())

    def save(step, samples):
        tetwarp.write(f"sagging_{step:04}.nii.gz", tetwarp.Volume(samples, volume.grid))

    follower = VolumeFollower(volume, *mesh, every=10, on_volume=save)
    root.addObject(make_controller(follower, state))
