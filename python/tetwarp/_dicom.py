"""DICOM series and dose distributions, by pydicom, which is imported when it is needed.

The world of DICOM is left, posterior, superior (LPS); functions take the axes of the caller's world.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from ._bridges import package, signs_of, turned
from ._grid import Grid
from ._values import check_kind, list_of
from ._volume import Volume, checked_volume

_RT_DOSE = "1.2.840.10008.5.1.4.1.1.481.2"
#: Of patient, study and frame of reference, which an object made of another one shares with it.
_SHARED = (
    "PatientName", "PatientID", "PatientBirthDate", "PatientSex", "StudyInstanceUID", "StudyDate",
    "StudyTime", "StudyID", "AccessionNumber", "ReferringPhysicianName", "FrameOfReferenceUID",
    "PositionReferenceIndicator",
)
#: Further ones that a dose shares with the dose it was made of.
_SHARED_OF_DOSES = (
    "DoseUnits", "DoseType", "DoseSummationType", "ReferencedRTPlanSequence",
    "TissueHeterogeneityCorrection",
)


def _datasets_of(source: Any, series: str | None) -> list[Any]:
    """The datasets with pixels of a folder, of files, or as they are given."""
    pydicom = package("pydicom", "read_dicom", "pydicom")
    if isinstance(source, (str, os.PathLike)):
        path = Path(source)
        source = sorted(p for p in path.iterdir() if p.is_file()) if path.is_dir() else [path]
    elif isinstance(source, pydicom.Dataset):
        source = [source]
    datasets = []
    for item in list_of(source, "source", "a folder, files or datasets"):
        if isinstance(item, pydicom.Dataset):
            datasets.append(item)
            continue
        try:
            datasets.append(pydicom.dcmread(item))
        except pydicom.errors.InvalidDicomError as error:
            raise ValueError(f"source: {item}: is no DICOM file; leave it out") from error
        except OSError as error:
            raise ValueError(f"source: {item}: {error.strerror}") from error
    datasets = [d for d in datasets if "PixelData" in d]
    for dataset in datasets:
        _check(dataset)
    found = sorted({str(d.SeriesInstanceUID) for d in datasets})
    if series is not None:
        datasets = [d for d in datasets if d.SeriesInstanceUID == series]
    elif len(found) > 1:
        raise ValueError(f"source: expected one series, found {len(found)}; give series=, one of "
                         f"{', '.join(found)}")
    if not datasets:
        raise ValueError("source: expected DICOM files with pixels"
                         + (f" of series {series}, there are {', '.join(found)}" if found else ""))
    return datasets


def _check(dataset: Any) -> None:
    """Refuses a dataset that lacks what is needed, or whose samples are no values."""
    needed = ["SeriesInstanceUID", "Rows", "Columns", "PixelSpacing"]
    if str(dataset.get("Modality")) == "RTDOSE":
        needed.append("DoseGridScaling")
    for name in needed:
        if dataset.get(name) in (None, ""):
            raise ValueError(f"source: instance {dataset.get('InstanceNumber', '?')} has no {name}")
    if "ModalityLUTSequence" in dataset or not str(
            dataset.get("PhotometricInterpretation")).startswith("MONOCHROME"):
        raise ValueError("source: colors, palettes and tables of values are not read; convert the "
                         "images to NIfTI")


def _axes_of(dataset: Any) -> np.ndarray:
    """Unit vectors along columns, rows and slices, as the columns of a matrix (LPS)."""
    if "ImageOrientationPatient" not in dataset or "ImagePositionPatient" not in dataset:
        raise ValueError("source: expected ImageOrientationPatient and ImagePositionPatient; an "
                         "image without them has no place in the patient")
    x, y = np.array(dataset.ImageOrientationPatient, float).reshape(2, 3)
    return np.stack([x, y, np.cross(x, y)], axis=1)


def _step_of(places: np.ndarray) -> float:
    """The distance of slices at places along their normal, which must be equal."""
    gaps = np.diff(places)
    if not len(gaps):
        return 0.0
    if gaps.min() <= 0 or gaps.max() - gaps.min() > max(1e-3 * gaps.mean(), 2e-3):
        raise ValueError(
            f"source: expected slices at equal distances, found {gaps.min():g} to {gaps.max():g} "
            "mm: slices are missing or there twice"
        )
    return float((places[-1] - places[0]) / len(gaps))


def _grid_of(dataset: Any, count: int, step: float, origin: np.ndarray) -> Grid:
    rows, columns = (float(s) for s in dataset.PixelSpacing)
    depth = step or float(dataset.get("SliceThickness") or 1.0)
    return Grid((count, int(dataset.Rows), int(dataset.Columns)), (columns, rows, depth),
                tuple(origin), tuple(map(tuple, _axes_of(dataset))))


def _number_in(dataset: Any, name: str, default: float) -> float:
    """A number of a dataset; one without a value is as good as none."""
    value = dataset.get(name)
    return default if value is None or value == "" else float(value)


def _rescaled(datasets: list[Any]) -> np.ndarray:
    """Samples with slope and intercept: integers where these are, else float32."""
    slopes = [_number_in(d, "RescaleSlope", 1.0) for d in datasets]
    shifts = [_number_in(d, "RescaleIntercept", 0.0) for d in datasets]
    if not np.isfinite(slopes + shifts).all() or 0 in slopes:
        raise ValueError("source: has a rescale slope or intercept that is no finite number, or a "
                         "slope of 0")
    pixels = [d.pixel_array for d in datasets]
    if all(s == 1 for s in slopes) and all(s.is_integer() for s in shifts):
        wide = np.stack([p.astype(np.int64) + int(s) for p, s in zip(pixels, shifts)])
        for dtype in (np.int16, np.uint16, np.int32):
            if np.iinfo(dtype).min <= wide.min() and wide.max() <= np.iinfo(dtype).max:
                return wide.astype(dtype)
        return wide
    return np.stack([(p * s + t).astype(np.float32) for p, s, t in zip(pixels, slopes, shifts)])


def _series_of(datasets: list[Any]) -> Volume:
    first = datasets[0]
    axes = _axes_of(first)
    for dataset in datasets:
        if int(dataset.get("NumberOfFrames", 1)) > 1:
            raise ValueError("source: multi-frame images other than doses are not read; convert "
                             "them to one file per slice or to NIfTI")
        same = (np.abs(_axes_of(dataset) - axes).max() < 1e-4
                and (dataset.Rows, dataset.Columns) == (first.Rows, first.Columns)
                and list(dataset.PixelSpacing) == list(first.PixelSpacing))
        if not same:
            raise ValueError("source: expected slices of one orientation, size and pixel spacing, "
                             f"instance {dataset.get('InstanceNumber', '?')} differs")
    origins = np.array([dataset.ImagePositionPatient for dataset in datasets], float)
    order = np.argsort(origins @ axes[:, 2], kind="stable")
    origins = origins[order]
    step = _step_of(origins @ axes[:, 2])
    sheared = origins - origins[0]
    sheared -= np.outer(sheared @ axes[:, 2], axes[:, 2])
    if np.abs(sheared).max() > 0.01:
        raise ValueError(f"source: slices are shifted by up to {np.abs(sheared).max():g} mm within "
                         "their plane (tilted gantry); resample the series first")
    ordered = [datasets[number] for number in order]
    return Volume(_rescaled(ordered), _grid_of(first, len(ordered), step, origins[0]),
                  str(first.get("Modality", "values")))


def _dose_of(dataset: Any) -> Volume:
    axes = _axes_of(dataset)
    pixels = dataset.pixel_array.reshape(-1, int(dataset.Rows), int(dataset.Columns))
    dose = pixels * float(dataset.DoseGridScaling)
    origin = np.array(dataset.ImagePositionPatient, float)
    offsets = np.atleast_1d(np.array(dataset.get("GridFrameOffsetVector", 0.0), float))
    if len(offsets) != len(dose):
        raise ValueError(f"source: expected a GridFrameOffsetVector of {len(dose)} frames, found "
                         f"{len(offsets)}")
    if offsets[0] != 0:  # places along the axis of the patient, of axial frames
        if abs(abs(axes[2, 2]) - 1) > 1e-4 or abs(offsets[0] - origin[2]) > 1e-3:
            raise ValueError("source: GridFrameOffsetVector begins neither at 0 nor, of an axial "
                             "dose, at the z of ImagePositionPatient")
        offsets = (offsets - origin[2]) * axes[2, 2]
    if len(offsets) > 1 and offsets[-1] < offsets[0]:
        offsets, dose = offsets[::-1], dose[::-1]
    grid = _grid_of(dataset, len(dose), _step_of(offsets), origin + axes[:, 2] * offsets[0])
    return Volume(dose, grid, "RTDOSE")


def read_dicom(source: Any, *, axes: str, series: str | None = None) -> Volume:
    """A series of slices, or a dose distribution (RTDOSE), as a Volume.

    Slices are ordered by their place; slope and intercept are applied (Hounsfield units are int16),
    doses are float64 in their unit.

    Parameters
    ----------
    source : folder, file or files, or datasets of pydicom
    axes : of the world that it is brought to: ``"RAS"`` or ``"LPS"``
    series : SeriesInstanceUID, where there are several

    Raises
    ------
    ValueError
        the files are no series at equal distances; the text says what differs.
    ImportError
        pydicom is not installed.

    >>> import pydicom, tetwarp
    >>> dose = tetwarp.Volume(np.ones((2, 3, 4)), tetwarp.Grid((2, 3, 4), spacing=(2, 2, 3)))
    >>> read_dicom(to_rtdose(dose, pydicom.Dataset(), axes="LPS"), axes="RAS")
    Volume((2, 3, 4) of float64, spacing (2.0, 2.0, 3.0), name 'RTDOSE')
    """
    datasets = _datasets_of(source, series)
    if any(str(d.get("Modality")) == "RTDOSE" for d in datasets):
        if len(datasets) > 1:
            raise ValueError(f"source: expected one dose, found {len(datasets)} files")
        volume = _dose_of(datasets[0])
    else:
        volume = _series_of(datasets)
    return Volume(volume.array, turned(volume.grid, signs_of(axes, "LPS")), volume.name)


def to_rtdose(volume: Volume, like: Any, *, axes: str) -> Any:
    """A dose as a dataset of pydicom, which ``save_as(path, enforce_file_format=True)`` writes.

    Doses are stored as 32-bit integers of equal steps: rounding changes them by at most 2^-33 of
    the highest one.

    Parameters
    ----------
    volume : doses of one component, 0 or more
    like : dataset of the same patient, study and frame of reference: an RTDOSE, whose unit, kind
        and plan the new one keeps (else GY, PHYSICAL, PLAN), or a slice
    axes : of the volume's world, ``"RAS"`` or ``"LPS"``

    Raises
    ------
    ValueError
        naming the argument.
    ImportError
        pydicom is not installed.

    >>> import pydicom, tetwarp
    >>> dose = tetwarp.Volume(np.ones((2, 3, 4)), tetwarp.Grid((2, 3, 4)))
    >>> dataset = to_rtdose(dose, pydicom.Dataset(), axes="LPS")
    >>> dataset.Modality, dataset.DoseUnits, int(dataset.NumberOfFrames)
    ('RTDOSE', 'GY', 2)
    """
    pydicom = package("pydicom", "to_rtdose", "pydicom")
    volume = checked_volume(volume, "volume")
    check_kind(like, pydicom.Dataset, "like")
    dose = np.asarray(volume.array, np.float64)
    if dose.ndim != 3 or not np.isfinite(dose).all() or dose.min() < 0:
        raise ValueError("volume: expected finite doses of 0 or more, one per voxel")
    grid = turned(volume.grid, signs_of(axes, "LPS"))
    directions = np.array(grid.direction)
    if np.linalg.det(directions) < 0:  # frames go along the normal
        grid = Grid(grid.shape, grid.spacing,
                    grid.points()[-1, 0, 0], tuple(map(tuple, directions * (1, 1, -1))))
        dose = dose[::-1]
    scaling = max(float(dose.max()), np.finfo(float).tiny) / (2**32 - 1)
    result = pydicom.Dataset()
    for name in _SHARED + (_SHARED_OF_DOSES if like.get("Modality") == "RTDOSE" else ()):
        if name in like:
            result[name] = like[name]
    kinds = {"DoseUnits": "GY", "DoseType": "PHYSICAL", "DoseSummationType": "PLAN"}
    for name, value in kinds.items():
        if name not in result:
            setattr(result, name, value)
    result.SOPClassUID, result.SOPInstanceUID = _RT_DOSE, pydicom.uid.generate_uid()
    result.SeriesInstanceUID = pydicom.uid.generate_uid()
    result.Modality, result.Manufacturer = "RTDOSE", "tetwarp"
    result.SeriesNumber = result.InstanceNumber = 1
    result.NumberOfFrames, result.Rows, result.Columns = dose.shape
    result.FrameIncrementPointer = pydicom.tag.Tag("GridFrameOffsetVector")
    result.GridFrameOffsetVector = [
        _decimal(pydicom, grid.spacing[2] * k) for k in range(len(dose))]
    result.ImagePositionPatient = [_decimal(pydicom, x) for x in grid.origin]
    result.ImageOrientationPatient = [
        _decimal(pydicom, x) for x in np.array(grid.direction)[:, :2].T.ravel()]
    result.PixelSpacing = [_decimal(pydicom, grid.spacing[1]), _decimal(pydicom, grid.spacing[0])]
    result.SliceThickness = _decimal(pydicom, grid.spacing[2])
    result.DoseGridScaling = _decimal(pydicom, scaling)
    result.SamplesPerPixel, result.PhotometricInterpretation = 1, "MONOCHROME2"
    result.BitsAllocated = result.BitsStored = 32
    result.HighBit, result.PixelRepresentation = 31, 0
    steps = np.rint(dose / float(result.DoseGridScaling)).clip(0, 2**32 - 1)
    result.PixelData = steps.astype("<u4").tobytes()
    result.file_meta = pydicom.dataset.FileMetaDataset()
    result.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    result.file_meta.MediaStorageSOPClassUID = _RT_DOSE
    result.file_meta.MediaStorageSOPInstanceUID = result.SOPInstanceUID
    return result


def _decimal(pydicom: Any, value: float) -> Any:
    """A number in the 16 letters of a decimal string."""
    return pydicom.valuerep.DSfloat(float(value), auto_format=True)
