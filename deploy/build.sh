# What the scripts of deploy share: checks of the machine, times, and the build. To be sourced from the project's folder.

# Measured (/usr/bin/time): the largest of the largest batches needs 1.62 GB (programs/0, with -Werror); a job leaves room for
# its linker.
memory_per_job_MB=1800
# Measured on two virtual cores, without a cache: 105 batches of the preset release, with links and the page's core, took
# 920 s: 17.5 s of one core for each.
step_s=18

endWith() {  # message: ends the script with one line
  echo "$0: $1" >&2
  exit 1
}

timed() {  # command ...
  began=$(date +%s)
  "$@"
  echo "== $* took $(($(date +%s) - began)) s =="
}

checkMachine() {  # free megabytes that the build needs
  command -v g++ >/dev/null || endWith "g++ is missing: run deploy/install-deps"
  compiler=$(g++ -dumpversion | cut -d. -f1)
  [ "$compiler" -ge 12 ] || endWith "g++ $compiler is too old: C++20 with coroutines needs g++ 12 or newer (Debian 12)"
  free_MB=$(df -Pm . | awk 'NR == 2 { print $4 }')
  [ "$free_MB" -ge "$1" ] || endWith "$free_MB MB are free in $PWD, the build needs $1 MB: free some, or build elsewhere"
}

countJobs() {  # prints how many compilers fit into the processors and the memory
  awk -v cores="$(nproc)" -v each="$memory_per_job_MB" '
    /^MemAvailable/ { fit = int($2 / 1024 / each) }
    END { jobs = fit < cores ? fit : cores; print jobs < 1 ? 1 : jobs }' /proc/meminfo
}

# One cache for all work trees: paths are stored relative to the tree, and a precompiled header counts by its content.
# Batches name their sources by absolute paths, so only the preprocessor's output is the same in two trees: CCACHE_DEPEND,
# which saves its run, would miss everything in a fresh clone.
useCache() {
  command -v ccache >/dev/null || return 0
  export CCACHE_BASEDIR="$PWD" CCACHE_NOHASHDIR=1
  export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
  CCACHE_STATSLOG=$(mktemp)
  export CCACHE_STATSLOG
}

printHitRate() {
  [ -s "${CCACHE_STATSLOG:-}" ] || return 0
  ccache --show-log-stats | sed -n 's/^ *Hits: */ccache hits: /p' | head -n 1
  rm -f "$CCACHE_STATSLOG"
}

# Two builds differ from a preset by switches alone: `plain` has neither batches nor precompiled headers and finds a
# missing include, `tidy` is what clang-tidy reads.
listFlags() {  # preset, plain or tidy: prints the arguments of cmake
  case "$1" in
    plain) echo "--preset debug -B build/plain -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_CXX_FLAGS_DEBUG=-O0" ;;
    tidy) echo "--preset release -B build/tidy -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=16" ;;
    *) echo "--preset $1" ;;
  esac
}

configure() {  # preset, plain or tidy; with strict=yes a warning is an error
  mkdir -p build
  # shellcheck disable=SC2046
  cmake $(listFlags "$1") ${strict:+-DHAPTICAST_WERROR=ON} >"build/$1.configure.log" 2>&1 || {
    grep -A3 -E 'CMake Error|not found|Could not find' "build/$1.configure.log" >&2
    endWith "cmake $(listFlags "$1") failed (build/$1.configure.log); deploy/install-deps installs what is missing"
  }
}

build() {  # preset, plain or tidy; targets ...
  preset=$1
  shift
  configure "$preset"
  jobs=$(countJobs)
  [ "$jobs" -eq "$(nproc)" ] || echo "$jobs of $(nproc) processors are used: each compiler may need $memory_per_job_MB MB"
  steps=$(ninja -C "build/$preset" -t inputs "${@:-all}" 2>/dev/null | grep '\.o$' | (
    cd "build/$preset"
    while read -r object; do [ -e "$object" ] || echo missing; done
  ) | wc -l)
  about=""
  [ "$preset" != release ] || about=": about $(((steps * step_s / jobs + 59) / 60)) minutes, less with a warm cache"
  [ "$steps" -eq 0 ] || echo "Compiling $steps batches (preset $preset)$about"
  quiet=""
  [ -t 1 ] || quiet="--quiet"  # on a terminal ninja shows its progress in one line
  # shellcheck disable=SC2086
  NINJA_STATUS="[%f of %t, %es] " ninja -C "build/$preset" $quiet -j "$jobs" "$@"
}
