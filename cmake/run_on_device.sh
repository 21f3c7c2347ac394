#!/usr/bin/env bash
# Runs what needs a CUDA device; every job has a limit of time, all together ten minutes:
#   tests   tests of back end cuda, side by side
#   checks  the same tests under compute-sanitizer, side by side: memcheck, racecheck, initcheck,
#           synccheck
#   times   rows of the benchmarks, one job after the other, with PEERS.py where it is given; then
#           counters of kernels (ncu)
#   all     tests and checks side by side, then times
#   figures rows of the two figures of time against size and against tetrahedra, on the device and on
#           the machine's processor
#   list    how many tests and rows each filter of this script matches; needs no device
# Logs and results go to FOLDER and, as one archive, to FOLDER.tar.gz (default: results, beside this
# script). Prints one table at the end. The exit code is 1 when a job failed or was stopped, a filter
# matches nothing or no device is usable. PEERS.py is bench/peers/gpu_samplers.py.
# `python3 bench/report device FOLDER.tar.gz` prints what was measured.
# usage: ./run_on_device.sh [tests|checks|times|all|figures|list [FOLDER [PEERS.py]]]
set -u
here=$(cd "$(dirname "$0")" && pwd)
part=${1:-all}
results=${2:-$here/results}
peers=${3:-}
cores=$(getconf _NPROCESSORS_ONLN)
names=()      # of the jobs, in the order of the table
deadline=590  # of the jobs [s since the start]

# Filters of tests: of programs with other back ends those on cuda. Contact takes long under the
# sanitizers and has jobs of its own.
stages='*/cuda*:*_cuda'
stress='*/cuda*'
warps='-*Contact*:*/cpu:*/reference'
contact='*Contact*'
steps='-*Large*:Device.*'
# Filters of rows; names of rows end in /iterations:1/manual_time.
resident=('^resident/W[1346]_' '^resident/W2_rotated_(256|384)/linear/float32/cuda/iterations')
figures=('^resident/W2_' '^paper/.*/cuda')
figures_beside=('^paper/.*/cpu/' '^W2_rotated_[0-9_]+/linear/float32/cpu/threads:[0-9]+/iterations'
  '^W2_rotated_[0-9_]+/linear/float32/cpu/threads:[0-9]+/without:culling/')
warp=('^W[0146].*/linear/float32/cuda/iterations'
  '^W2_rotated_(256|384)/linear/(uint8|int16|float32)/cuda/iterations'
  '^(series|overlap)/W3_waved_256_5000.*/cuda/')
solves=('^contact/.*/anderson/float(64|32)/cuda/' '^contact/.*/gauss_seidel/float64/cuda/')
cubes=('^step/tets:.*/cuda/iterations')
profiled_warp=('^resident/W1_' '^resident/W3_waved_256_5000/linear/float32/cuda/iterations')
profiled_contact=('^contact/packing_1k/anderson/float64/cuda/tolerance:1e-04/iterations')
profiled_step=('^step/tets:10985/cuda/iterations')

any_of() {  # FILTER...: one regular expression
  local IFS='|'
  printf '%s' "$*"
}

# ---- does every filter match something? --------------------------------------------------------
missed=0
tests_of() {  # PROGRAM FILTER: prints the number of tests
  "$here/$1" --gtest_list_tests --gtest_filter="$2" 2>/dev/null | grep -c '^  '
}
rows_of() {  # PROGRAM FILTER: prints the number of rows
  "$here/$1" --benchmark_list_tests --benchmark_filter="$2" 2>/dev/null | grep -c /manual_time
}
matched() {  # COUNT PROGRAM FILTER
  printf '%6d  %-30s %s\n' "$1" "$2" "$3"
  (($1 > 0)) || missed=1
}
is_here() {
  [[ -x $here/$1 ]] && return 0
  echo "     -  $1 is not here"
  return 1
}
list_tests() {  # PROGRAM FILTER: every pattern of the filter, also of what it leaves out
  local pattern patterns
  is_here "$1" || return 0
  IFS=: read -ra patterns <<<"${2/-/:}"
  for pattern in "${patterns[@]}"; do
    [[ -z $pattern ]] || matched "$(tests_of "$1" "$pattern")" "$1" "$pattern"
  done
  [[ $2 != *-* ]] || matched "$(tests_of "$1" "$2")" "$1" "$2"
}
list_rows() {  # PROGRAM FILTER...
  local filter
  is_here "$1" || return 0
  for filter in "${@:2}"; do matched "$(rows_of "$1" "$filter")" "$1" "$filter"; done
}
list_filters() {
  list_tests tetwarp_tests "$stages"
  list_tests tetwarp_stress_tests "$stress"
  list_tests tetwarp_device_tests "$warps"
  list_tests tetwarp_device_tests "$contact"
  list_tests tetwarp_device_simulate_tests "$steps"
  list_rows tetwarp_bench "${resident[@]}" "${warp[@]}" "${profiled_warp[@]}" "${figures[@]}" \
    "${figures_beside[@]}"
  list_rows tetwarp_bench_contact "${solves[@]}" "${profiled_contact[@]}"
  list_rows tetwarp_bench_simulate "${cubes[@]}" "${profiled_step[@]}"
  return "$missed"
}

# ---- jobs --------------------------------------------------------------------------------------
# Errors in the log of a sanitizer: those of its summary or, where it was stopped before, those
# that it had printed.
errors_of() {
  local log=$1 count
  count=$(sed -nE 's/^=+ (ERROR|RACECHECK) SUMMARY: ([0-9]+).*/\2/p' "$log" |
    { sum=0 && while read -r n; do sum=$((sum + n)); done && echo "$sum"; })
  if ! grep -aq '^=* [A-Z]* SUMMARY' "$log"; then
    count=$(grep -aE '^========= [A-Z]' "$log" | grep -acvE 'COMPUTE-SANITIZER|Target application')
  fi
  echo "$count"
}

# A program that was stopped leaves its results file without an end.
close_json() {
  local last
  last=$(tail -n 1 "$1")
  [[ $last != '    }'* ]] || printf '\n  ]\n}\n' >>"$1"
}

run() {  # NAME SECONDS COMMAND...: its output in FOLDER/NAME.log, a line of the table in NAME.row
  local name=$1 limit=$2 log=$results/$1.log start=$SECONDS code errors=- ran state=passed
  shift 2
  ((limit < deadline - start)) || limit=$((deadline - start))
  if ((limit > 0)); then
    timeout -k 5 "$limit" "$@" >"$log" 2>&1
    code=$?
  else
    echo "no time was left" >"$log"
    code=124
  fi
  [[ $* != *compute-sanitizer* ]] || errors=$(errors_of "$log")
  ran=$(grep -acE '^\[       OK \]|/manual_time .*[0-9] ms ' "$log")
  if ((code == 124 || code == 137)); then
    state=stopped
  elif ((code != 0)) || [[ $errors != [-0] ]]; then
    state=failed
  elif [[ $* == *--gtest_filter=* || $* == *--benchmark_filter=* ]] && ((ran == 0)); then
    state=failed
  elif grep -aq 'No kernels were profiled' "$log"; then
    state=failed
  fi
  [[ ! -s $results/${name#bench-}.json ]] || close_json "$results/${name#bench-}.json"
  printf '%-7s %7d %5d %6s  %s\n' "$state" $((SECONDS - start)) "$ran" "$errors" "$name" \
    >"$results/$name.row"
}

alone() {  # NAME SECONDS COMMAND...
  names+=("$1")
  run "$@"
}

beside() {  # NAME SECONDS COMMAND...: with others, twice as many as cores, as they wait a lot
  names+=("$1")
  while (($(jobs -rp | wc -l) >= 2 * cores)); do wait -n; done
  run "$@" &
}

need() {  # TOOL: whether it is installed
  command -v "$1" >/dev/null 2>&1 && return 0
  echo "left out: $1 is not installed"
  return 1
}

tests() {
  beside tests-stages 120 "$here/tetwarp_tests" --gtest_filter="$stages"
  beside tests-stress 200 "$here/tetwarp_stress_tests" --gtest_filter="$stress"
  beside tests-warp 200 "$here/tetwarp_device_tests" --gtest_filter="$warps"
  beside tests-contact 200 "$here/tetwarp_device_tests" --gtest_filter="$contact"
  beside tests-simulate 120 "$here/tetwarp_device_simulate_tests"
}

sanitize() {  # TOOL NAME SHARES PROGRAM FILTER: the tests in so many processes
  local share
  for ((share = 0; share < $3; ++share)); do
    beside "$1-$2-$((share + 1))" 250 env GTEST_TOTAL_SHARDS="$3" GTEST_SHARD_INDEX="$share" \
      compute-sanitizer --tool "$1" --error-exitcode 9 "$here/$4" --gtest_filter="$5"
  done
}

checks() {
  local tool
  need compute-sanitizer || return 0
  for tool in racecheck memcheck initcheck synccheck; do
    sanitize "$tool" warp 3 tetwarp_device_tests "$warps"
    sanitize "$tool" contact 2 tetwarp_device_tests "$contact"
    sanitize "$tool" simulate 1 tetwarp_device_simulate_tests "$steps"
    sanitize "$tool" stages 1 tetwarp_tests "$stages"
  done
}

rows() {  # NAME SECONDS PROGRAM FILTER...
  alone "bench-$1" "$2" "$here/$3" --benchmark_filter="$(any_of "${@:4}")" \
    --benchmark_out="$results/$1.json"
}

counters() {  # NAME SECONDS LAUNCHES PROGRAM FILTER...: of the first launches of all kernels
  alone "ncu-$1" "$2" ncu --clock-control none --kernel-name-base demangled --launch-count "$3" \
    --section SpeedOfLight --section Occupancy --section LaunchStats --section WarpStateStats \
    --section MemoryWorkloadAnalysis --csv "$here/$4" --benchmark_filter="$(any_of "${@:5}")"
}

times() {
  rows resident 60 tetwarp_bench "${resident[@]}"
  rows warp 70 tetwarp_bench "${warp[@]}"
  rows contact 60 tetwarp_bench_contact "${solves[@]}"
  rows simulate 40 tetwarp_bench_simulate "${cubes[@]}"
  [[ -z $peers ]] || alone gpu-peers 45 python3 "$peers"
  need ncu || return 0
  counters warp 40 40 tetwarp_bench "${profiled_warp[@]}"
  counters contact 30 24 tetwarp_bench_contact "${profiled_contact[@]}"
  counters simulate 30 40 tetwarp_bench_simulate "${profiled_step[@]}"
}

figures() {
  rows figures 280 tetwarp_bench "${figures[@]}"
  rows figures-beside 300 tetwarp_bench "${figures_beside[@]}"
}

print_table() {  # and the tests that failed; 1 when a job has not passed
  local name rows=()
  for name in "${names[@]}"; do rows+=("$results/$name.row"); done
  printf '%-7s %7s %5s %6s  %s\n' result seconds ran errors job
  cat "${rows[@]}"
  grep -ahE '^\[  FAILED  \] .* \([0-9]+ ms\)|wrong result' "$results"/*.log | sort -u
  echo "all: $SECONDS s"
  ! grep -qv '^passed' "${rows[@]}"
}

case $part in
  tests | checks | times | all | figures) ;;
  list)
    list_filters
    exit
    ;;
  *)
    echo "$0: expected tests, checks, times, all, figures or list, got '$part'" >&2
    exit 2
    ;;
esac
mkdir -p "$results" || exit 1
rm -f "$results"/*.row
{ nvidia-smi; lscpu; ldd --version; } >"$results/device.txt" 2>&1
timeout 60 "$here/tetwarp_device_simulate_tests" --gtest_filter='Device.IsUsable' \
  >"$results/usable.log" 2>&1 || {
  cat "$results/usable.log"
  echo "no usable CUDA device: nothing was run" >&2
  exit 1
}
status=0
list_filters >"$results/filters.txt" || {
  grep '^     0' "$results/filters.txt"
  echo "these filters match nothing"
  status=1
}
if [[ $part == all ]]; then deadline=270; fi
if [[ $part == all || $part == tests ]]; then tests; fi
if [[ $part == all || $part == checks ]]; then checks; fi
wait
deadline=590
if [[ $part == all || $part == times ]]; then times; fi
if [[ $part == figures ]]; then figures; fi
print_table >"$results/table.txt" || status=1
cat "$results/table.txt"
tar -czf "$results.tar.gz" -C "$results" . || status=1
echo "results: $results.tar.gz"
exit "$status"
