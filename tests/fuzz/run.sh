#!/usr/bin/env bash
# Runs fuzz targets one after the other: run.sh [TARGET...], all of them without a name.
# RUNS: executions of each; SECONDS_EACH: stop a target after this time; SANITIZER: none (libtorch is built without one)
# or address, with which the targets that need libtorch are left out. More words for cargo-fuzz: FUZZ_OPTIONS.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
runs=${RUNS:-10000000} seconds=${SECONDS_EACH:-0} sanitizer=${SANITIZER:-none}
unset RUSTFLAGS RUSTUP_TOOLCHAIN
fuzz() { rustup run nightly "${CARGO_FUZZ:-cargo-fuzz}" "$@"; }
features=(--features torch)
[ "$sanitizer" = none ] || features=()
# Temporary files of model readers go into memory.
[ ! -d /dev/shm ] || export TMPDIR=/dev/shm
targets=("$@")
if [ $# = 0 ]; then
  mapfile -t targets < <(fuzz fuzz list --fuzz-dir tests/fuzz)
fi
failed=()
for target in "${targets[@]}"; do
  if [ "$sanitizer" != none ] && grep -A6 "name = \"$target\"" tests/fuzz/Cargo.toml | grep -q required-features; then
    continue
  fi
  mkdir -p "target/fuzz-corpus/$target" "tests/fuzz/corpus/$target"
  # shellcheck disable=SC2086
  fuzz fuzz run "$target" --fuzz-dir tests/fuzz --target-dir target/fuzz --sanitizer "$sanitizer" "${features[@]}" \
    ${FUZZ_OPTIONS:-} "target/fuzz-corpus/$target" "tests/fuzz/corpus/$target" -- -max_len=1024 -timeout=5 \
    -rss_limit_mb=2048 -malloc_limit_mb=64 -print_final_stats=1 "-runs=$runs" "-max_total_time=$seconds" \
    > "target/fuzz-corpus/$target.log" 2>&1 || failed+=("$target")
  units=$(sed -n 's/^stat::number_of_executed_units: *//p' "target/fuzz-corpus/$target.log")
  # Nothing may count as fuzzed that was not.
  [ -n "$units" ] || { tail -n 40 "target/fuzz-corpus/$target.log"; exit 1; }
  echo "| $target | $units | $(find "target/fuzz-corpus/$target" -type f | wc -l) |"
done
if [ ${#failed[@]} -gt 0 ]; then
  tail -n 60 "target/fuzz-corpus/${failed[0]}.log"
  echo "broke: ${failed[*]}; the inputs are in tests/fuzz/artifacts: fix the reader, and add each to the corpus"
  exit 1
fi
