#!/bin/sh
# Runs everything in this bundle that needs a CUDA device: tests, memory and race checks, timings.
# Results go to FOLDER (default: results, beside this script). Ends with 1 when anything failed.
# PEERS.py (bench/peers/gpu_samplers.py), if given, is timed on the same device; the option
# --gpu-peers FOLDER/gpu_peers.log of `bench/report tables` puts its times beside ours.
# usage: ./run_on_device.sh [FOLDER [PEERS.py]]
here=$(cd "$(dirname "$0")" && pwd)
results=${1:-$here/results}
peers=${2:-}
mkdir -p "$results" || exit 1
status=0
# run NAME COMMAND...: its output in FOLDER/NAME.log
run() {
  name=$1
  shift
  if "$@" >"$results/$name.log" 2>&1; then
    echo "passed  $name"
  else
    echo "FAILED  $name, see $results/$name.log"
    status=1
  fi
}
nvidia-smi >"$results/device.txt" 2>&1 || echo "no nvidia-smi: tests of back end cuda may skip"
for program in tetwarp_tests tetwarp_stress_tests tetwarp_device_tests; do
  run "$program" "$here/$program" --gtest_output="xml:$results/$program.xml"
done
if command -v compute-sanitizer >/dev/null 2>&1; then
  small='*InFlight*/cuda:*Parity.Owners*waved*:*Parity.Owners*folded*'
  for tool in memcheck racecheck synccheck; do
    run "stages-$tool" compute-sanitizer --tool "$tool" --error-exitcode 1 \
      "$here/tetwarp_tests" --gtest_filter='*/cuda.*'
    run "warp-$tool" compute-sanitizer --tool "$tool" --error-exitcode 1 \
      "$here/tetwarp_device_tests" --gtest_filter="$small"
  done
  for tool in memcheck racecheck; do
    run "contact-$tool" compute-sanitizer --tool "$tool" --error-exitcode 1 \
      "$here/tetwarp_device_tests" --gtest_filter='*ContactCuda*'
  done
else
  echo "left out memory and race checks: no compute-sanitizer"
fi
# Rows for cuda include the sampling floor of the device and the savings by overlap and updates.
run bench "$here/tetwarp_bench" --benchmark_filter='/cuda' --benchmark_out="$results/bench.json"
grep -h -m 1 'back end cuda is left out' "$results/bench.log"
[ -z "$peers" ] || run gpu_peers python3 "$peers"
exit $status
