#!/bin/sh
# Runs what needs a CUDA device, in three parts that each end on their own:
#   tests   tests of back end cuda, and their accesses to memory (memcheck)      about 5 minutes
#   checks  races, barriers (racecheck, synccheck), counters of kernels (ncu)    about 5 minutes
#   times   steps, contact solves, floors, and PEERS.py where it is given        about 8 minutes
# Results go to FOLDER and, as one archive, to FOLDER.tar.gz (default: results, in this folder).
# Every stage has a limit of time. Ends with 1 when a stage failed or no device is usable. PEERS.py
# is bench/peers/gpu_samplers.py. `python3 bench/report device FOLDER.tar.gz` prints the tables.
# usage: ./run_on_device.sh [tests|checks|times|all [FOLDER [PEERS.py]]]
here=$(cd "$(dirname "$0")" && pwd)
part=${1:-all}
results=${2:-$here/results}
peers=${3:-}
case $part in
  tests | checks | times | all) ;;
  *)
    echo "$0: expected tests, checks, times or all, got '$part'" >&2
    exit 2
    ;;
esac
mkdir -p "$results" || exit 1
status=0

# run NAME SECONDS COMMAND...: its output in FOLDER/NAME.log
run() {
  name=$1
  limit=$2
  shift 2
  start=$(date +%s)
  timeout "$limit" "$@" >"$results/$name.log" 2>&1
  code=$?
  passed=$(($(date +%s) - start))
  if [ "$code" -eq 0 ]; then
    echo "passed  $name, $passed s"
  elif [ "$code" -eq 124 ]; then
    echo "STOPPED $name after $limit s, see $results/$name.log"
    status=1
  else
    echo "FAILED  $name with $code, $passed s, see $results/$name.log"
    status=1
  fi
}
# need TOOL: whether it is installed; says so where it is not.
need() {
  command -v "$1" >/dev/null 2>&1 && return 0
  echo "left out: $1 is not installed"
  return 1
}

nvidia-smi >"$results/device.txt" 2>&1
timeout 60 "$here/tetwarp_device_simulate_tests" --gtest_filter='Device.IsUsable' \
  >"$results/usable.log" 2>&1 || {
  cat "$results/usable.log"
  echo "no usable CUDA device: nothing was run" >&2
  exit 1
}

on_device='*/cuda*:*_cuda'
features='*Parity*:*Hexahedra*:*Fields*:*Rounding*:*Quantities*:*Intensity*:*Antialias*:*InFlight*'
sanitize() {  # TOOL SECONDS-PER-PROGRAM
  run "$1-stages" "$2" compute-sanitizer --tool "$1" --error-exitcode 1 \
    "$here/tetwarp_tests" --gtest_filter="$on_device"
  run "$1-warp" "$2" compute-sanitizer --tool "$1" --error-exitcode 1 \
    "$here/tetwarp_device_tests" --gtest_filter="$features"
  run "$1-contact" "$2" compute-sanitizer --tool "$1" --error-exitcode 1 \
    "$here/tetwarp_device_tests" --gtest_filter='*ContactCuda*'
  run "$1-simulate" "$2" compute-sanitizer --tool "$1" --error-exitcode 1 \
    "$here/tetwarp_device_simulate_tests" --gtest_filter='*Small*'
}
# counters NAME KERNELS PROGRAM ROWS: of the first 40 launches of kernels whose names match
counters() {
  run "ncu-$1" 90 ncu --clock-control none --kernel-name-base demangled --kernel-name "regex:$2" \
    --launch-count 40 --section SpeedOfLight --section Occupancy --section LaunchStats \
    --section MemoryWorkloadAnalysis --csv "$here/$3" --benchmark_filter="$4"
}

if [ "$part" = tests ] || [ "$part" = all ]; then
  run tests-stages 60 "$here/tetwarp_tests" --gtest_filter="$on_device"
  run tests-stress 60 "$here/tetwarp_stress_tests" --gtest_filter="$on_device"
  run tests-device 90 "$here/tetwarp_device_tests"
  run tests-simulate 60 "$here/tetwarp_device_simulate_tests"
  need compute-sanitizer && sanitize memcheck 60
fi
if [ "$part" = checks ] || [ "$part" = all ]; then
  need compute-sanitizer && sanitize racecheck 40 && sanitize synccheck 20
  if need ncu; then
    counters warp 'Raster|TetSetup|CellCull|Floor' tetwarp_bench '^resident/W3_waved_256_5000'
    counters contact 'island|color|grid' tetwarp_bench_contact '^contact/packing_1k/.*/cuda'
    counters simulate 'Tet|Block|Gradient|island' tetwarp_bench_simulate '^step/tets:10985/cuda'
  fi
fi
if [ "$part" = times ] || [ "$part" = all ]; then
  # Names of rows end in /iterations:1/manual_time.
  brief='(W0|W1|W4).*/linear/float32/cuda/iterations|W2_rotated_(256|384)/linear/(uint8|int16|float32)/cuda/iterations'
  run bench-resident 120 "$here/tetwarp_bench" --benchmark_filter='^resident/' \
    --benchmark_out="$results/resident.json"
  run bench-warp 150 "$here/tetwarp_bench" \
    --benchmark_filter="$brief|^(series|overlap)/W3_waved_256_5000.*/cuda" \
    --benchmark_out="$results/warp.json"
  run bench-contact 90 "$here/tetwarp_bench_contact" --benchmark_filter='/cuda/' \
    --benchmark_out="$results/contact.json"
  run bench-simulate 90 "$here/tetwarp_bench_simulate" --benchmark_filter='/cuda/iterations' \
    --benchmark_out="$results/simulate.json"
  [ -z "$peers" ] || run gpu-peers 90 python3 "$peers"
fi
tar -czf "$results.tar.gz" -C "$results" . || status=1
echo "results: $results.tar.gz"
exit $status
