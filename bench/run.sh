# The work of `./dev bench`, whose functions and variables it uses.
#
# Writes times to build/bench/results, pictures to build/bench/plots and tables to
# build/bench/results.md. --peers also measures other programs (see bench/peers/README.md);
# --install installs what these need; other options go to the benchmark programs. Environment:
#   TETWARP_FCLIB_DATA  folders of recorded contact problems (*.hdf5), colons between them
#   TETWARP_PEERS       output of bench/peers/siconos_nsgs.py on this machine
#   TETWARP_GPU_PEERS   output of bench/peers/gpu_samplers.py on this machine

peer_packages=(libvtk9-dev libtbb-dev libinsighttoolkit5-dev python3-siconos python3-h5py
  python3-scipy python3-torch plastimatch)

run_bench() {
  local folder=$root/build/bench python=/usr/bin/python3 status=0 with_peers=no installs=no
  local argument results
  local arguments=() required=("${packages[@]}" python3-matplotlib)
  for argument in "$@"; do
    case $argument in
      --peers) with_peers=yes ;;
      --install) installs=yes required+=("${peer_packages[@]}" python3-venv) ;;
      *) arguments+=("$argument") ;;
    esac
  done
  install_packages "${required[@]}"
  [[ $installs == no ]] || install_python_peers || echo "not all of bench/peers/python.txt is installed"
  unset OMP_WAIT_POLICY  # threads may spin: nothing else should run meanwhile
  [[ -x $python ]] || python=python3
  results=$folder/results/$(date +%F)-$(machine_name)
  find_cuda_options
  configure "$folder" "${cuda_options[@]}" -DTETWARP_BENCH=ON -DTETWARP_TESTS=OFF
  cmake --build "$folder" --target tetwarp_bench tetwarp_bench_contact
  mkdir -p "$folder/results"
  rm -f "$results".json "$results"-{contact,beside}.json "$folder"/{results,warp_python}.md
  "$folder/tetwarp_bench" --benchmark_out="$results.json" \
    ${arguments[@]+"${arguments[@]}"} || status=$?
  "$folder/tetwarp_bench_contact" --benchmark_out="$results-contact.json" \
    ${arguments[@]+"${arguments[@]}"} || status=$?
  export PYTHONDONTWRITEBYTECODE=1
  [[ $with_peers == no ]] || bench_peers || status=$?
  bench_report
  return "$status"
}

# Other programs on the same problems.
bench_peers() {
  local problems=$folder/problems name
  for name in "${peer_packages[@]}"; do
    dpkg-query -W -f='${db:Status-Status}\n' "$name" 2>/dev/null | grep -qx installed ||
      echo "missing: $name; its program is left out, --install installs it"
  done
  cmake --build "$folder" --target tetwarp_bench_peers
  "$folder/tetwarp_bench_peers" "$results-beside.json" || return
  bench_warp_python || echo "warp_python.py failed"
  bench_cantilever
  bench_contact_scenes
  "$python" -c 'import siconos.numerics, h5py, scipy' 2>/dev/null || return 0
  "$folder/tetwarp_bench_contact" --export="$problems"
  while read -r -d : folder_of_files; do cp "$folder_of_files"/*.hdf5 "$problems"; done \
    <<<"${TETWARP_FCLIB_DATA:+$TETWARP_FCLIB_DATA:}"
  "$python" "$root/bench/peers/siconos_nsgs.py" "$problems"/*.hdf5 | tee "$results-siconos.log"
  TETWARP_PEERS=$results-siconos.log
}

# Packages of PyPI that the warp from Python is measured beside, in an environment of their own. It is
# of the interpreter that CMake builds the module for.
install_python_peers() {
  # Where a module of venv is missing, it leaves a folder without pip.
  [[ -x $folder/python_peers/bin/pip ]] || python3 -m venv "$folder/python_peers" || return
  "$folder/python_peers/bin/pip" install --quiet --no-compile \
    -r "$root/bench/peers/python.txt" &&
    "$folder/python_peers/bin/pip" install --quiet --no-compile --no-deps \
      -r "$root/bench/peers/python_alone.txt"
}

bench_warp_python() {
  local program=$root/bench/peers/warp_python.py python=$folder/python_peers/bin/python
  if [[ ! -x $python ]]; then
    echo "missing: $folder/python_peers; the warp from Python is left out, --install installs it"
    return 0
  fi
  cmake --build "$folder" --target tetwarp_python tetwarp_command || return
  PYTHONPATH=$folder/python "$python" "$program" all "$folder/warp_python" "$results-python.json" &&
    "$python" "$program" table "$results-python.json" >"$folder/warp_python.md" || return
  program=$root/bench/peers/warp_memory.py
  local status=0
  PYTHONPATH=$folder/python "$python" "$program" all "$folder/tetwarp" "$folder/warp_memory" \
    "$results-python.json" && "$python" "$program" table "$results-python.json" >>"$folder/warp_python.md" ||
    status=1
  rm -rf "$folder/warp_memory"  # 6 GB
  return "$status"
}

# One cantilever in several simulators, on one thread; a program that is missing is left out.
bench_cantilever() {
  local peers=$root/bench/peers log=$results-cantilever.log
  : >"$log"
  if "$python" -c 'import h5py, numpy' 2>/dev/null; then
    { cmake --build "$folder" --target tetwarp_command &&
      "$python" "$peers/cantilever_tetwarp.py" "$folder/tetwarp" | tee -a "$log"; } ||
      echo "cantilever_tetwarp.py failed"
  else
    echo "missing: h5py or numpy; the cantilever in tetwarp is left out"
  fi
  if "$python" -c 'import mujoco' 2>/dev/null; then
    (cd "$folder" && "$python" "$peers/cantilever_mujoco.py") | tee -a "$log" ||
      echo "cantilever_mujoco.py failed"
  else
    echo "missing: mujoco (PyPI); the cantilever in MuJoCo is left out"
  fi
  if "$python" -c 'import newton' 2>/dev/null; then
    (cd "$folder" && OMP_NUM_THREADS=1 "$python" "$peers/cantilever_newton.py") | tee -a "$log" ||
      echo "cantilever_newton.py failed"
  else
    echo "missing: newton (PyPI); the cantilever in Newton is left out"
  fi
}

# Scenes with contact in several simulators, on one thread; a program that is missing is left out.
bench_contact_scenes() {
  local peers=$root/bench/peers log=$results-contact-scenes.log program module
  (cd "$peers" && "$python" -c 'import contact_scenes; print(contact_scenes.HEADER)') >"$log" || return
  for program in tetwarp:h5py mujoco:mujoco pybullet:pybullet drake:pydrake newton:newton; do
    module=${program#*:} program=${program%:*}
    if ! "$python" -c "import numpy, $module" 2>/dev/null; then
      echo "missing: $module; the scenes with contact in $program are left out"
    else
      (cd "$folder" && OMP_NUM_THREADS=1 "$python" "$peers/contact_scenes_$program.py" \
        "$folder/tetwarp") | tee -a "$log" || echo "contact_scenes_$program.py failed"
    fi
  done
}

# Tables and plots of the results files that were written.
bench_report() {
  local files=() logs=() file
  [[ -z ${TETWARP_PEERS:-} ]] || logs+=(--peers "$TETWARP_PEERS")
  for file in "$results".json "$results"-contact.json; do
    [[ ! -s $file ]] || files+=("$file")
  done
  ((${#files[@]})) || return 0
  "$python" "$root/bench/report" plots --folder "$folder/plots" ${logs[@]+"${logs[@]}"} \
    "${files[@]}"
  [[ ! -s $results-beside.json ]] || files+=("$results-beside.json")
  [[ -z ${TETWARP_GPU_PEERS:-} ]] || logs+=(--gpu-peers "$TETWARP_GPU_PEERS")
  "$python" "$root/bench/report" tables ${logs[@]+"${logs[@]}"} "${files[@]}" \
    >"$folder/results.md"
  if [[ -s $folder/warp_python.md ]]; then
    files+=("$results-python.json")
    { printf '\n### The warp from Python\n\n' && cat "$folder/warp_python.md"; } >>"$folder/results.md"
  fi
  printf '%s\n' "${files[@]}" "$folder/results.md"
}
