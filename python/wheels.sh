#!/usr/bin/env bash
# Builds wheels of the Python package into build/wheels, and uses each in an empty environment:
#   python/wheels.sh [PYTHON...]    one per interpreter, such as python3.10 python3.11 python3.12
# That of 3.12 serves all later versions. The library is compiled once, in build/wheel. Wheels hold all
# libraries that they need beside those of manylinux; what other programs have written is read by the
# Python packages for it. Options of pip: WHEEL_OPTIONS, such as "-C cmake.define.TETWARP_CUDA=OFF".
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
platform=manylinux_2_35_x86_64

python3 -m venv "$work/tools"
"$work/tools/bin/pip" install -q auditwheel wheel
for python in "${@:-python3}"; do
  rm -rf "$work/made" "$work/empty"
  read -ra options <<<"${WHEEL_OPTIONS:-}"
  "$python" -m pip wheel "$root" --no-deps -w "$work/made" -C build-dir="$root/build/wheel" \
    -C "cmake.version=>=3.26" -C cmake.define.TETWARP_BUNDLE=ON ${options[@]+"${options[@]}"}
  "$work/tools/bin/auditwheel" show "$work"/made/*.whl | tee "$work/shown"
  grep -q "\"$platform\"" "$work/shown" || { echo "it does not run on $platform" >&2; exit 1; }
  (cd "$work/made" && "$work/tools/bin/wheel" tags --remove --platform-tag "$platform" ./*.whl)
  "$python" -m venv "$work/empty"
  "$work/empty/bin/pip" install -q h5py "$work"/made/*.whl
  (cd "$work/empty" && PATH="$work/empty/bin:$PATH" env -u PYTHONPATH bin/python "$root/python/tests/check_wheel.py")
  mkdir -p "$root/build/wheels"
  mv "$work"/made/*.whl "$root/build/wheels"
done
ls -l "$root"/build/wheels/*.whl
