#!/bin/sh
# All that a device has to say about this bundle, in one call: tests, memory and race checks, times.
# Results go to FOLDER (default: results, beside this script). Ends with 1 when anything failed.
# usage: ./run_on_device.sh [FOLDER]
here=$(cd "$(dirname "$0")" && pwd)
results=${1:-$here/results}
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
run tests "$here/tetwarp_tests" --gtest_output="xml:$results/tests.xml"
if command -v compute-sanitizer >/dev/null 2>&1; then
  small='*/cuda.*:*Parity.Owners*waved*:*Parity.Owners*folded*'
  for tool in memcheck racecheck; do
    run "$tool" compute-sanitizer --tool "$tool" --error-exitcode 1 \
      "$here/tetwarp_tests" --gtest_filter="$small"
  done
else
  echo "left out memcheck and racecheck: no compute-sanitizer"
fi
run bench "$here/tetwarp_bench" --benchmark_filter='/cuda' --benchmark_out="$results/bench.json"
grep -h -m 1 'back end cuda is left out' "$results/bench.log"
exit $status
