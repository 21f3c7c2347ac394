"""DICOM series and doses, which SimpleITK reads as well."""

import numpy as np
import pytest

import tetwarp

pydicom = pytest.importorskip("pydicom")

TILT = np.array([(1, 0, 0), (0, 0.8, -0.6), (0, 0.6, 0.8)])
CT = "1.2.840.10008.5.1.4.1.1.2"


def dataset_of(sop_class, modality, series):
    dataset = pydicom.Dataset()
    dataset.SOPClassUID, dataset.SOPInstanceUID = sop_class, pydicom.uid.generate_uid()
    dataset.SeriesInstanceUID, dataset.Modality = series, modality
    dataset.StudyInstanceUID = dataset.FrameOfReferenceUID = "1.2.3.4"
    dataset.PatientName, dataset.PatientID = "Doe^Jane", "17"
    dataset.SamplesPerPixel, dataset.PhotometricInterpretation = 1, "MONOCHROME2"
    dataset.file_meta = pydicom.dataset.FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = pydicom.uid.ExplicitVRLittleEndian
    dataset.file_meta.MediaStorageSOPClassUID = sop_class
    dataset.file_meta.MediaStorageSOPInstanceUID = dataset.SOPInstanceUID
    return dataset


def ct_series(pixels, slope=1, intercept=-1024):
    """A slice per row of `pixels`, on tilted axes, in an order that is not that of places."""
    series = pydicom.uid.generate_uid()
    slices = []
    for k in np.random.default_rng(3).permutation(len(pixels)):
        dataset = dataset_of(CT, "CT", series)
        dataset.Rows, dataset.Columns = pixels.shape[1:]
        dataset.PixelSpacing, dataset.SliceThickness = [1.5, 2.0], 9
        dataset.ImageOrientationPatient = TILT[:, :2].T.ravel().tolist()
        dataset.ImagePositionPatient = (np.array((10, -20, 30)) + 2.5 * k * TILT[:, 2]).tolist()
        dataset.BitsAllocated = dataset.BitsStored = 16
        dataset.HighBit, dataset.PixelRepresentation = 15, 0
        dataset.RescaleSlope, dataset.RescaleIntercept = slope, intercept
        dataset.InstanceNumber = int(k) + 1
        dataset.PixelData = pixels[k].astype("<u2").tobytes()
        slices.append(dataset)
    return slices


@pytest.fixture
def pixels():
    return np.random.default_rng(2).integers(0, 4000, (5, 6, 7))


@pytest.fixture
def dose():
    array = np.random.default_rng(4).random((4, 5, 6)) * 70
    grid = tetwarp.Grid(array.shape, (2.5, 3, 2), (5, 6, -7), TILT)
    return tetwarp.Volume(array, grid)


def save(datasets, folder):
    for number, dataset in enumerate(datasets):
        dataset.save_as(folder / f"{number}.dcm", enforce_file_format=True)


def test_a_series_is_that_of_simpleitk(pixels, tmp_path):
    sitk = pytest.importorskip("SimpleITK")
    save(ct_series(pixels), tmp_path)

    volume = tetwarp.read_dicom(tmp_path, axes="LPS")

    assert volume.dtype == np.int16 and np.array_equal(volume.array, pixels - 1024)
    names = sitk.ImageSeriesReader.GetGDCMSeriesFileNames(str(tmp_path))
    image = sitk.ReadImage(names)
    expected = tetwarp.volume_from(image, axes="LPS")
    assert np.array_equal(volume.array, expected.array)
    assert np.allclose(volume.affine, expected.affine, atol=1e-6)
    ras = tetwarp.read_dicom(tmp_path, axes="RAS")
    assert np.allclose(ras.affine, np.diag([-1, -1, 1, 1]) @ volume.affine)


def test_slopes_give_floats(pixels):
    volume = tetwarp.read_dicom(ct_series(pixels, 0.5, -1), axes="LPS")

    assert volume.dtype == np.float32 and np.array_equal(volume.array, 0.5 * pixels - 1)


def test_a_dose_comes_back_and_is_that_of_simpleitk(dose, pixels, tmp_path):
    like = ct_series(pixels)[0]

    made = tetwarp.to_rtdose(dose, like, axes="LPS")

    assert made.PatientID == "17" and made.FrameOfReferenceUID == like.FrameOfReferenceUID
    made.save_as(tmp_path / "dose.dcm", enforce_file_format=True)
    again = tetwarp.read_dicom(tmp_path / "dose.dcm", axes="LPS")
    assert np.abs(again.array - dose.array).max() <= 70 * 2.0**-32
    assert np.allclose(again.affine, dose.affine, atol=1e-12) and again.name == "RTDOSE"
    sitk = pytest.importorskip("SimpleITK")
    image = tetwarp.volume_from(sitk.ReadImage(str(tmp_path / "dose.dcm")), axes="LPS")
    assert np.allclose(image.affine, dose.affine, atol=1e-5)
    assert np.allclose(image.array * (1 if image.array.max() < 100 else float(made.DoseGridScaling)),
                       dose.array, atol=1e-5)


def test_doses_on_grids_of_either_hand_and_order_keep_their_places(dose):
    turned = tetwarp.Volume(dose.array, tetwarp.Grid(
        dose.shape, dose.grid.spacing, dose.grid.origin, TILT * (1, 1, -1)))

    back = tetwarp.read_dicom(
        tetwarp.to_rtdose(turned, pydicom.Dataset(), axes="RAS"), axes="RAS")
    made = tetwarp.to_rtdose(dose, pydicom.Dataset(), axes="LPS")
    made.GridFrameOffsetVector = [-float(x) for x in made.GridFrameOffsetVector]
    down = tetwarp.read_dicom(made, axes="LPS")

    assert np.allclose(back.grid.points()[::-1], turned.grid.points())
    assert np.allclose(back.array[::-1], turned.array)
    assert np.allclose(down.grid.points()[-1], dose.grid.points()[0])
    assert np.allclose(down.array[::-1], dose.array)


def test_a_dose_that_is_warped_keeps_unit_and_plan(dose):
    like = tetwarp.to_rtdose(dose, pydicom.Dataset(), axes="LPS")
    like.DoseUnits, like.DoseSummationType = "RELATIVE", "BEAM"
    mesh = tetwarp.lattice_mesh(dose, cells=2)
    result = tetwarp.warp(dose, *mesh, tetwarp.deform(*mesh, amount=0.1))

    made = tetwarp.to_rtdose(tetwarp.Volume(result.volume, result.grid), like, axes="LPS")

    assert (made.DoseUnits, made.DoseSummationType) == ("RELATIVE", "BEAM")
    assert made.SOPInstanceUID != like.SOPInstanceUID
    assert np.allclose(tetwarp.read_dicom(made, axes="LPS").array, result.volume, atol=1e-7)


@pytest.mark.parametrize("break_it, message", [
    (lambda s: s.pop(2), "expected slices at equal distances, found 2.5 to 5 mm"),
    (lambda s: s.append(s[0]), "slices are missing or there twice"),
    (lambda s: setattr(s[0], "PixelSpacing", [1, 2]), "one orientation, size and pixel spacing"),
    (lambda s: setattr(s[0], "SeriesInstanceUID", "1.2"), "expected one series, found 2"),
    (lambda s: s.clear(), "expected DICOM files with pixels"),
    (lambda s: [setattr(d, "ImagePositionPatient", [10, -20, d.ImagePositionPatient[2]])
                for d in s], "tilted gantry"),
    (lambda s: s[0].pop("ImageOrientationPatient"), "expected ImageOrientationPatient"),
    (lambda s: s[0].pop("PixelSpacing"), "instance 1 has no PixelSpacing"),
    (lambda s: s[0].pop("SeriesInstanceUID"), "instance 1 has no SeriesInstanceUID"),
    (lambda s: setattr(s[1], "PhotometricInterpretation", "PALETTE COLOR"), "palettes and tables"),
    (lambda s: setattr(s[1], "ModalityLUTSequence", []), "palettes and tables"),
    (lambda s: s.append("missing.dcm"), "missing.dcm: No such file"),
])
def test_what_is_no_series_is_refused(pixels, break_it, message):
    slices = sorted(ct_series(pixels), key=lambda d: d.InstanceNumber)
    break_it(slices)

    with pytest.raises(ValueError, match=message):
        tetwarp.read_dicom(slices, axes="LPS")


def test_a_slope_without_a_value_is_1(pixels):
    slices = ct_series(pixels, None, None)

    assert np.array_equal(tetwarp.read_dicom(slices, axes="LPS").array, pixels)


@pytest.mark.parametrize("numbers", [(0, 1), (0, 0), (np.nan, 0), (1, np.inf)])
def test_slopes_that_erase_samples_are_refused(numbers, pixels):
    slices = ct_series(pixels, 1, 0)
    slices[1].RescaleSlope, slices[1].RescaleIntercept = map(float, numbers)

    with pytest.raises(ValueError, match="source: has a rescale slope or intercept"):
        tetwarp.read_dicom(slices, axes="LPS")


@pytest.mark.parametrize("offsets, message", [
    (None, "expected a GridFrameOffsetVector of 4 frames, found 1"),
    ([0, 5], "expected a GridFrameOffsetVector of 4 frames, found 2"),
    ([100, 102, 104, 106], "begins neither at 0 nor"),
])
def test_doses_whose_frames_have_no_place_are_refused(dose, offsets, message):
    made = tetwarp.to_rtdose(dose, pydicom.Dataset(), axes="LPS")
    if offsets is None:
        made.pop("GridFrameOffsetVector")
    else:
        made.GridFrameOffsetVector = offsets

    with pytest.raises(ValueError, match=message):
        tetwarp.read_dicom(made, axes="LPS")


def test_decimals_of_a_dose_have_at_most_16_letters(dose):
    grid = tetwarp.Grid(dose.shape, (1 / 3, 1.1, 2.4), (5, 6, -7), TILT)

    made = tetwarp.to_rtdose(tetwarp.Volume(dose.array, grid), pydicom.Dataset(), axes="LPS")

    for element in made:
        values = element.value if element.VM > 1 else [element.value]
        assert element.VR != "DS" or all(len(str(value)) <= 16 for value in values), element.name


def test_bad_doses_and_axes_are_named(dose):
    negative = tetwarp.Volume(dose.array - 50, dose.grid)
    with pytest.raises(ValueError, match="volume: expected finite doses of 0 or more"):
        tetwarp.to_rtdose(negative, pydicom.Dataset(), axes="LPS")
    with pytest.raises(ValueError, match="axes: expected 'RAS' or 'LPS'"):
        tetwarp.to_rtdose(dose, pydicom.Dataset(), axes="LAS")
