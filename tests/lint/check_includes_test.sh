#!/usr/bin/env bash
# tools/check_includes.sh accepts a clean tree and finds each kind of violation when it is planted.
set -euo pipefail
check=$(realpath "$1")
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

plant() {  # path, line
  mkdir -p "$tree/$(dirname "$1")"
  printf '%s\n' "$2" > "$tree/$1"
}

must_find() {  # path, line, expected message
  plant "$1" "$2"
  if output=$("$check" "$tree"); then
    echo "not found: $2 in $1"
    failures=$((failures + 1))
  elif [[ $output != *"$1:1: $3"* ]]; then
    echo "expected \"$1:1: $3\", got: $output"
    failures=$((failures + 1))
  fi
  rm "$tree/$1"
}

plant base/error.h '#include <string>'
plant accel/trace.h '#include <rayloom/base/error.h>'
plant accel/simd/kernel.h '#include <hwy/highway.h>'
plant accel/hull-inl.h '#include <hwy/highway.h>'
plant runtime/device.cpp '#include <glm/glm.hpp>'
plant shaders/view.cpp '#include <rayloom/scenes/scene.h>'
# shellcheck disable=SC2016  # the README's own backquotes
plant README.md 'Start at `accel/trace`, then `runtime/device.cpp`.'
"$check" "$tree" || { echo "a clean tree is refused"; exit 1; }

must_find base/hash.h '#include <rayloom/accel/trace.h>' 'base must not include accel'
must_find accel/a.cpp '#include <rayloom/runtime/device.h>' 'accel must not include runtime'
must_find runtime/b.h '#  include <rayloom/hwmodel/gpu.h>' 'runtime must not include hwmodel'
must_find hwmodel/c.cpp '#include <rayloom/shaders/view.h>' 'hwmodel must not include shaders'
must_find scenes/d.h '#include <rayloom/accel/trace.h>' 'scenes must not include accel'
must_find shaders/e.h '#include <rayloom/tools/cli.h>' 'shaders must not include tools'
must_find accel/f.cpp '#include <glm/vec3.hpp>' 'accel knows no GLM'
must_find hwmodel/g.h '#include <fmt/format.h>' '<fmt/format.h>: no third-party header'
must_find accel/h.h '#include <nlohmann/json.hpp>' '<nlohmann/json.hpp>: no third-party header'
must_find accel/i.cpp '#include "../base/error.h"' '"../base/error.h": include it as'
must_find runtime/j.cpp '#include "missing.h"' '"missing.h": include it as'
# shellcheck disable=SC2016
must_find README.md 'Read `accel/gone.h`.' 'no such file: accel/gone.h'
[[ $failures -eq 0 ]]
