# ---- ./dev check: sourced by ./dev, whose functions and variables it uses --------------------

# Parts in the order in which they run; each builds into its own folder below build/.
check_parts=(lint format host tidy small shared cuda release fused asan fuzz types docs)

# source_files EXTENSION...: the C++ and CUDA sources, from the root
source_files() {
  local extension
  for extension in "$@"; do find "${sources[@]}" -type f -name "*.$extension"; done | sort
}

# refuse MESSAGE GREP-ARGUMENT...: fails when grep finds something
refuse() {
  local message=$1
  shift
  if grep -rn "$@"; then
    echo "lint: $message" >&2
    return 1
  fi
}

# Types of one name in several headers of a namespace: the linker keeps one of the templates made of
# them.
refuse_twin_types() {
  local twins
  twins=$(grep -rhoE '^(struct|class|enum class) [A-Za-z0-9]+( final)?( :.*| \{.*)$' kernels host io \
    --include=*.hpp --include=*.cuh --exclude-dir=reference \
    --exclude=h5*.hpp --exclude=fclib*.hpp |
    awk '{ print $1 == "enum" ? $3 : $2 }' | sort | uniq -d)
  [[ -z $twins ]] && return 0
  echo "lint: types of these names are in several headers:" "$twins" >&2
  return 1
}

lint() {
  local status=0
  refuse 'dead code' -E '^[[:space:]]*#[[:space:]]*if[[:space:]]+0' "${sources[@]}" || status=1
  refuse 'printing in a kernel' printf kernels || status=1
  refuse 'a path of one machine' -E '/(home|root|work|tmp|Users)/' \
    "${sources[@]}" cmake CMakeLists.txt dev .ci || status=1
  python3 tests/lint/folders.py || status=1
  python3 tests/lint/sources.py || status=1
  refuse_twin_types || status=1
  source_files hpp cpp cuh cu py | xargs wc -l |
    awk '$1 > 400 && $2 != "total" { print "lint: long, one subject? " $2 ": " $1 " lines" }'
  return "$status"
}

# register_table: registers, stack and spills of our kernels from ptxas' output. Fails on a stack
# larger than stack_bytes of host/warp/cuda/backend_cuda.cu, and on a spill, unless
# tests/lint/spills_allowed.txt has a line with the architecture and a part of the kernel's name.
register_table() {
  local most
  most=$(sed -n 's/^constexpr double stack_bytes = \([0-9]*\);$/\1/p' \
    "$root/host/warp/cuda/backend_cuda.cu")
  c++filt | awk -v allowed="$root/tests/lint/spills_allowed.txt" -v most="$most" '
    BEGIN {
      while ((getline line < allowed) > 0) {
        if (line ~ /^#/ || line == "") continue
        split(line, word, " "); architectures[++count] = word[1]; names[count] = word[2]
      }
    }
    function is_allowed(architecture, kernel,   i) {
      for (i = 1; i <= count; ++i) {
        if (architectures[i] == architecture && index(kernel, names[i])) return 1
      }
      return 0
    }
    /Compiling entry function/ {
      split($0, part, "\047"); kernel = part[2]; architecture = part[4]
      sub(/^void /, "", kernel)
      ours = kernel ~ /^tetwarp::/
      sub(/\(.*/, "", kernel)
    }
    /bytes stack frame/ { stack = $1; spills = $5 + $9 }
    ours && /Used [0-9]+ registers/ {
      match($0, /Used [0-9]+/)
      registers = substr($0, RSTART + 5, RLENGTH - 5)
      verdict = spills == 0 ? "" : is_allowed(architecture, kernel) ? "  (allowed)" : "  (REFUSED)"
      if (stack > most + 0) verdict = verdict "  (REFUSED: stack)"
      printf "%-6s %4d registers %5d stack %5d spilled  %s%s\n",
        architecture, registers, stack, spills, kernel, verdict
      refused += verdict ~ /REFUSED/
    }
    END { exit refused > 0 }' | sort -k8 -k1
}

check_lint() {
  local script
  lint
  for script in folders sources dead; do python3 "$root/tests/lint/$script.py" --test; done
}

check_format() {
  has clang-format || { echo "left out: no clang-format"; return 0; }
  source_files hpp cpp cuh cu | xargs clang-format --dry-run -Werror
}

# configure_host FOLDER CMAKE-OPTION...: without CUDA and precompiled headers.
configure_host() {
  configure "$@" -DTETWARP_CUDA=OFF -DTETWARP_BENCH=ON -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON
}

# Every file compiles alone, so it includes what it needs; warnings are errors. Then functions that
# only tests reach: those compiled, without optimization so that every call is one, and not in the
# command (also on the emulated device), the benchmarks and the examples. Without the Python package.
check_host() {
  local folder=$root/build/check-host
  configure_host "$folder" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG= \
    -DCMAKE_CXX_FLAGS='-Werror -ffunction-sections' -DCMAKE_EXE_LINKER_FLAGS=-Wl,--gc-sections \
    -DTETWARP_DEAD_CODE=ON -DTETWARP_UNITY=OFF -DTETWARP_PYTHON=OFF
  cmake --build "$folder"
  python3 "$root/tests/lint/dead.py" "$folder" --programs "$folder"/tetwarp{,-read,-view} \
    "$folder"/tetwarp_{emulated_command,collision_pairs} "$folder"/tetwarp_example_* \
    "$folder"/tetwarp_bench{,_collide,_contact,_peers,_simulate}
}

# All files that a build without CUDA compiles, except docs_blocks.cpp, which is written during the
# build, those of ITK, whose headers refuse clang, and those of nanobind. Units of several files take
# half the time: most of it goes into the headers of others.
check_tidy() {
  local folder=$root/build/check-tidy
  has clang-tidy || { echo "left out: no clang-tidy"; return 0; }
  configure_host "$folder" -DCMAKE_UNITY_BUILD=ON -DCMAKE_EXPORT_COMPILE_COMMANDS=ON \
    -DCMAKE_DISABLE_FIND_PACKAGE_ITK=ON
  sed -n '/docs_blocks/d; /nanobind/d; s/^ *"file": "\(.*\)".*/\1/p' "$folder/compile_commands.json" |
    sort -u | xargs -n 1 -P "$CMAKE_BUILD_PARALLEL_LEVEL" clang-tidy --quiet \
      --extra-arg=-Wno-unknown-warning-option -p "$folder"
}

# Without tetwarp::io.
check_small() {
  configure "$root/build/check-small" -DTETWARP_CUDA=OFF -DTETWARP_IO=OFF -DCMAKE_CXX_FLAGS=-Werror
  cmake --build "$root/build/check-small"
  run_tests "$root/build/check-small" -LE long
}

check_shared() {
  find_cuda_options
  configure "$root/build/check-shared" -DBUILD_SHARED_LIBS=ON -DTETWARP_BENCH=OFF \
    "${cuda_options[@]}"
  cmake --build "$root/build/check-shared"
  run_tests "$root/build/check-shared" -LE long
}

# All architectures: registers and spills of every kernel.
check_cuda() {
  local folder=$root/build/check-cuda
  if ! configure "$folder" -DTETWARP_CUDA=ON -DTETWARP_TESTS=OFF \
    -DCMAKE_CUDA_FLAGS='-Xptxas -v,-warn-spills' >"$folder.log" 2>&1; then
    echo "left out: no CUDA compiler"
    return 0
  fi
  cmake --build "$folder" --clean-first >"$folder.log" 2>&1 || { cat "$folder.log"; return 1; }
  register_table <"$folder.log"
}

# All tests, the long ones too.
check_release() {
  build_release
  run_tests "$release"
}

# The emulated device with fused multiply-add, as a device computes, beside a host without.
check_fused() {
  local folder=$root/build/check-fused
  configure "$folder" -DTETWARP_CUDA=OFF -DTETWARP_IO=OFF -DTETWARP_FUSED_EMULATION=ON
  cmake --build "$folder" --target tetwarp_emulated_tests
  "$folder/tetwarp_emulated_tests" --gtest_brief=1
}

check_asan() {
  cmake --preset asan -S "$root"
  cmake --build "$root/build/asan"
  run_tests "$root/build/asan" -LE long
}

check_fuzz() {
  cmake --preset asan -S "$root"
  cmake --build "$root/build/asan" --target fuzz_io fuzz_mesh
  "$root/build/asan/fuzz_io" 60 "${RANDOM}"
  "$root/build/asan/fuzz_mesh" 60 "${RANDOM}"
}

# Types of the Python package, its stubs and examples; the tests run mypy alone.
check_types() {
  python3 -m pyright --version >/dev/null 2>&1 ||
    { echo "left out: no pyright; python3 -m pip install 'pyright[nodejs]'"; return 0; }
  build_release tetwarp_python_stub
  local folder=$root/build/check-types
  rm -rf "$folder" && mkdir -p "$folder"
  cp -rL "$release/python/tetwarp" "$root"/examples/python/*.py "$root/pyproject.toml" "$folder"
  (cd "$folder" && python3 -m pyright)
}

check_docs() { docs; }

# check [PART...]: all parts, or these; prints how long each took.
check() {
  local part start times=()
  local -a parts=("$@")
  ((${#parts[@]})) || parts=("${check_parts[@]}")
  install_packages "${packages[@]}"
  cd "$root"
  mkdir -p build
  for part in "${parts[@]}"; do
    if ! declare -F "check_$part" >/dev/null; then
      echo "check has the parts ${check_parts[*]}, not $part" >&2
      return 2
    fi
  done
  for part in "${parts[@]}"; do
    say "check $part"
    start=$SECONDS
    "check_$part"
    times+=("$part $((SECONDS - start)) s")
  done
  say "all checks passed"
  printf '%s\n' "${times[@]}"
}
