"""A module of 3D Slicer: a volume and a grid transform follow a mesh of tetrahedra.

The computation is TetWarpLib/fill.py; here are the nodes of MRML and the panel.
"""

import qt
import slicer
import vtk
from slicer.ScriptedLoadableModule import (
    ScriptedLoadableModule,
    ScriptedLoadableModuleLogic,
    ScriptedLoadableModuleWidget,
)

OUTSIDE = ("background", "identity", "nearest", "falloff")


class TetWarp(ScriptedLoadableModule):
    """What Slicer shows in its list of modules."""

    def __init__(self, parent):
        super().__init__(parent)
        parent.title = "TetWarp"
        parent.categories = ["Registration"]
        parent.helpText = (
            "Warps a volume by a deformed mesh of tetrahedra, and fills a grid transform with the "
            "displacements at every voxel, also beyond the mesh."
        )


class TetWarpLogic(ScriptedLoadableModuleLogic):
    """Between nodes of MRML and TetWarpLib."""

    def process(self, volume, rest, deformed, output=None, transform=None, *,
                outside="falloff", falloff=20.0, interpolator="linear"):
        """Fills `output`, a scalar volume node, and `transform`, a grid transform node; either may
        be None.

        volume : scalar volume node
        rest, deformed : model nodes whose meshes have the same points, before and after
        outside, falloff : of the voxels that no cell covers, as in tetwarp.Warper [mm]
        """
        from TetWarpLib import fill

        matrix = vtk.vtkMatrix4x4()
        volume.GetIJKToRASMatrix(matrix)
        ijk_to_ras = slicer.util.arrayFromVTKMatrix(matrix)
        mesh, positions = rest.GetMesh(), fill.points_of(deformed.GetMesh())
        options = {"outside": outside}
        if outside == "falloff":
            options["falloff"] = falloff
        result = field = None
        if output is not None:
            image = vtk.vtkImageData()
            result = fill.fill_image(image, volume.GetImageData(), ijk_to_ras, mesh, positions,
                                     interpolator=interpolator, **options)
            output.SetIJKToRASMatrix(matrix)
            output.SetAndObserveImageData(image)
            if output.GetDisplayNode() is None:  # without one, nothing is drawn
                output.CreateDefaultDisplayNodes()
        if transform is not None:
            grid_transform = slicer.vtkOrientedGridTransform()
            field = fill.fill_grid_transform(
                grid_transform, volume.GetImageData().GetDimensions(), ijk_to_ras, mesh, positions,
                **options)
            transform.SetAndObserveTransformFromParent(grid_transform)
        return result, field


class TetWarpWidget(ScriptedLoadableModuleWidget):
    """Choosers of nodes, and a button."""

    def setup(self):
        super().setup()
        self.logic = TetWarpLogic()
        form = qt.QFormLayout()
        self.layout.addLayout(form)
        self.nodes = {}
        for name, node_class, is_optional in (
            ("Volume", "vtkMRMLScalarVolumeNode", False),
            ("Mesh at rest", "vtkMRMLModelNode", False),
            ("Mesh deformed", "vtkMRMLModelNode", False),
            ("Warped volume", "vtkMRMLScalarVolumeNode", True),
            ("Grid transform", "vtkMRMLGridTransformNode", True),
        ):
            chooser = slicer.qMRMLNodeComboBox()
            chooser.nodeTypes = [node_class]
            chooser.noneEnabled = chooser.addEnabled = is_optional
            chooser.setMRMLScene(slicer.mrmlScene)
            form.addRow(name, chooser)
            self.nodes[name] = chooser
        self.outside = qt.QComboBox()
        self.outside.addItems(list(OUTSIDE))
        self.outside.setCurrentText("falloff")
        form.addRow("Outside of the mesh", self.outside)
        self.falloff = qt.QDoubleSpinBox()
        self.falloff.setRange(0.1, 1000)
        self.falloff.value = 20
        form.addRow("Falloff [mm]", self.falloff)
        button = qt.QPushButton("Warp")
        button.connect("clicked()", self.warp)
        form.addRow(button)
        self.layout.addStretch(1)

    def warp(self):
        volume, rest, deformed, output, transform = (
            chooser.currentNode() for chooser in self.nodes.values())
        if volume is None or rest is None or deformed is None:
            slicer.util.errorDisplay("Choose a volume and two meshes.")
            return
        with slicer.util.tryWithErrorDisplay("The warp failed."):
            result, field = self.logic.process(
                volume, rest, deformed, output, transform, outside=self.outside.currentText,
                falloff=self.falloff.value)
            shown = [repr(x) for x in (result, field) if x is not None]
            slicer.util.showStatusMessage("; ".join(shown) or "Choose an output.")
