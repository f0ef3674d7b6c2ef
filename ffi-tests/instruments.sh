#!/usr/bin/env bash
# The C programs under instruments that see what tests cannot: memory that is not theirs or was never written, leaks, races.
#
#   ffi-tests/instruments.sh [memcheck] [address] [thread] [miri]      all without arguments
#
# What the machine lacks is skipped, aloud. FIXPAIR_REQUIRE_INSTRUMENTS=1: valgrind and clang must be there.
set -euo pipefail
cd "$(dirname "$0")/.."

target=$PWD/target/instruments
platform=x86_64-unknown-linux-gnu
vectors=$PWD/target/ffi/vectors.txt
system=(-pthread -ldl -lm)
options=(-std=c99 -pedantic -Wall -Wextra -Werror -O1 -g -ffp-contract=off -pthread -I include)
mkdir -p "$target"
trap 'jobs -p | xargs -r kill 2>/dev/null || true' EXIT

announce() { printf '\n--> %s\n' "$*"; }

skip() {
  if [ -n "${FIXPAIR_REQUIRE_INSTRUMENTS:-}" ] && [ "$1" = required ]; then
    printf 'missing: %s\n' "$2"
    exit 1
  fi
  printf 'skipped: %s\n' "$2"
}

# Runs a command, says how long it took, and shows what it printed if it fails.
timed() {
  local name=$1 start=$SECONDS log=$target/${1// /-}.log
  shift
  if "$@" >"$log" 2>&1; then
    printf '%-44s %4d s   %s\n' "$name" $((SECONDS - start)) "$(grep -E 'checks, [0-9]+ failures' "$log" | tail -n 1 || true)"
  else
    printf '%-44s %4d s   fails\n' "$name" $((SECONDS - start))
    tail -n 100 "$log"
    exit 1
  fi
}

# An instrument that finds nothing must be able to find: a fault of faults.c, by the words it has for it.
finds() {
  local name=$1 words=$2 log=$target/${1// /-}.log
  shift 2
  if "$@" >"$log" 2>&1 || ! grep -q "$words" "$log"; then
    printf '%s: not found\n' "$name"
    tail -n 100 "$log"
    exit 1
  fi
  printf '%-44s found\n' "$name"
}

# The static library that users get, and the cases that conformance.c compares with: as cargo test leaves them.
released() {
  timed "the library and its cases" cargo test --locked --test ffi c_gets_the_bits_of_rust
}

# A static library whose Rust a sanitizer watches; $1 is its name, the rest features. The standard library comes compiled without it.
instrumented() {
  local sanitizer=$1
  shift
  RUSTC_BOOTSTRAP=1 RUSTFLAGS="-Zsanitizer=$sanitizer -Cunsafe-allow-abi-mismatch=sanitizer" timed "build for $sanitizer" \
    cargo rustc --locked --profile instruments --lib --crate-type staticlib --target "$platform" --target-dir "$target/$sanitizer" "$@"
}

# Not grep -q, which may leave the pipe before all is written, a failure of the pipe.
on_this_platform() { rustc -vV | grep -x "host: $platform" >/dev/null; }

memcheck() {
  announce "memcheck: the library as it is shipped, every bit that decides something, every block"
  if ! command -v valgrind >/dev/null || ! echo '#include <valgrind/memcheck.h>' | ${CC:-cc} -E - >/dev/null 2>&1; then
    skip required "valgrind, or its header"
    return
  fi
  released
  local name
  for name in faults concurrent refusals fuzz conformance; do
    ${CC:-cc} "${options[@]}" -DFIXPAIR_MEMCHECK "ffi-tests/$name.c" target/ffi/release/libfixpair.a "${system[@]}" -o "$target/$name-memcheck"
  done
  local watch=(valgrind --quiet --error-exitcode=99 --leak-check=full --show-leak-kinds=all --errors-for-leak-kinds=all)
  finds "memcheck overflow" "Invalid write" "${watch[@]}" "$target/faults-memcheck" overflow
  finds "memcheck uninitialised" "uninitialised value" "${watch[@]}" "$target/faults-memcheck" uninitialised
  finds "memcheck leak" "definitely lost" "${watch[@]}" "$target/faults-memcheck" leak
  # The longest beside the others; Valgrind runs one thread at a time, so pools of several sizes are no other test.
  timed "memcheck conformance" "${watch[@]}" "$target/conformance-memcheck" "$vectors" 02 &
  local longest=$!
  timed "memcheck concurrent" "${watch[@]}" "$target/concurrent-memcheck" 1
  timed "memcheck refusals" "${watch[@]}" "$target/refusals-memcheck"
  timed "memcheck fuzz" "${watch[@]}" "$target/fuzz-memcheck" 200
  wait "$longest"
}

address() {
  announce "AddressSanitizer, LeakSanitizer and UndefinedBehaviorSanitizer: Rust and C, debug assertions on"
  if ! command -v clang >/dev/null; then
    skip required "clang"
    return
  fi
  if ! on_this_platform; then
    skip optional "the flags below are those of $platform"
    return
  fi
  released
  instrumented address
  local name
  for name in faults concurrent refusals fuzz conformance; do
    clang "${options[@]}" -fsanitize=address,undefined -fno-sanitize-recover=all "ffi-tests/$name.c" \
      "$target/address/$platform/instruments/libfixpair.a" "${system[@]}" -o "$target/$name-address"
  done
  export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_init_order=1
  finds "address overflow" "heap-buffer-overflow" "$target/faults-address" overflow
  finds "address leak" "detected memory leaks" "$target/faults-address" leak
  timed "address concurrent" "$target/concurrent-address"
  timed "address refusals" "$target/refusals-address"
  timed "address fuzz" "$target/fuzz-address" 2000
  timed "address conformance" "$target/conformance-address" "$vectors"
}

thread() {
  announce "ThreadSanitizer: Rust and C, threads of the host's own and of the pool"
  if ! command -v clang >/dev/null; then
    skip required "clang"
    return
  fi
  if ! on_this_platform; then
    skip optional "the flags below are those of $platform"
    return
  fi
  released
  # The dense algebra of faer runs on no threads.
  instrumented thread --no-default-features --features std
  # Rust's runtime, for clang's may be older than what Rust calls.
  local name runtime=$(rustc --print sysroot)/lib/rustlib/$platform/lib/librustc-stable_rt.tsan.a
  for name in faults concurrent conformance; do
    clang "${options[@]}" -fsanitize=thread -DFIXPAIR_NO_LINALG -c "ffi-tests/$name.c" -o "$target/$name-thread.o"
    clang -pthread "$target/$name-thread.o" "$target/thread/$platform/instruments/libfixpair.a" \
      -Wl,--whole-archive "$runtime" -Wl,--no-whole-archive -ldl -lm -lrt -o "$target/$name-thread"
  done
  export TSAN_OPTIONS=suppressions=$PWD/ffi-tests/thread_sanitizer.supp
  finds "thread race" "data race" "$target/faults-thread" race
  finds "thread chunks" "data race" "$target/faults-thread" chunks
  timed "thread concurrent" "$target/concurrent-thread"
  timed "thread conformance" "$target/conformance-thread" "$vectors" 24
}

miri() {
  announce "Miri: the unit tests of what needs no instructions beyond the baseline and no files"
  if ! cargo miri --version >/dev/null 2>&1; then
    skip optional "no Miri here: it is a component of nightly toolchains (rustup component add miri)"
    return
  fi
  # Hours for meshes; the hand-written pointers are those of executors, bricks, borders and scratch.
  timed "miri" cargo miri test --locked --lib -- exec:: mesh:: scratch:: walk:: border::
}

instruments=("$@")
[ $# -gt 0 ] || instruments=(memcheck address thread miri)
for instrument in "${instruments[@]}"; do
  case $instrument in
    memcheck | address | thread | miri) "$instrument" ;;
    *) printf 'no such instrument: %s\n' "$instrument" && exit 2 ;;
  esac
done
