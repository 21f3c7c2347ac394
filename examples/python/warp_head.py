"""Warps a NIfTI image by a lattice of tetrahedra, and its displacement field for other programs.

    python warp_head.py [IMAGE.nii.gz]

Without an image a phantom is written to head.nii.gz first. Writes bent.nii.gz and field.nii.gz.
"""

import sys

import tetwarp


def main():
    path = sys.argv[1] if len(sys.argv) > 1 else "head.nii.gz"
    if len(sys.argv) == 1:
        tetwarp.write(path, tetwarp.phantom(shape=(61, 80, 128)))
    head = tetwarp.read(path)
    mesh = tetwarp.lattice_mesh(head, cells=8, threshold=0.1 * float(head.array.max()))
    bent = tetwarp.deform(*mesh, kind="bend", amount=0.4)

    result = tetwarp.warp(head, *mesh, bent)
    print(head, mesh, result, sep="\n")
    tetwarp.write("bent.nii.gz", result)

    field = tetwarp.displacement_field(*mesh, bent, reference=head)
    tetwarp.write("field.nii.gz", field)
    volume = tetwarp.jacobian_determinant(*mesh, bent, reference=head)
    print(f"local volume {volume.values[volume.mask].min():.2f} to "
          f"{volume.values[volume.mask].max():.2f}")
    return head, result, volume


if __name__ == "__main__":
    main()
