#!/usr/bin/env bash
# Checks every #include of a source tree (default: this one) against the arrows of docs/architecture.md, and that every
# file the README names exists. Prints one line a violation, file:line: reason; exit code 1 if there is any.
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

folders=(base accel runtime hwmodel scenes shaders tools)
declare -A may_include=(
  [base]="base"
  [accel]="base accel"
  [runtime]="base accel runtime"
  [hwmodel]="base accel runtime hwmodel"
  [scenes]="base scenes"
  [shaders]="base accel runtime scenes shaders"
  [tools]="base accel runtime hwmodel scenes shaders tools tests"  # bench/numerics shares oracles with the tests
)
# Headers a public header of accel or hwmodel may name: the standard library's, and ours.
standard='^(<[a-z0-9_]+>|<rayloom/.*>)$'
violations=0

report() {
  echo "$1"
  violations=$((violations + 1))
}

# Prints file:line:<header> or file:line:"header" for each include of a folder.
includes_of() {
  grep -rnE --include='*.h' --include='*.cpp' '^[[:space:]]*#[[:space:]]*include' "$1" |
    sed -E 's/^([^:]+:[0-9]+):[^<"]*([<"][^>"]*[>"]).*/\1 \2/' || true
}

is_public_header() {  # accel's and hwmodel's SIMD kernels are internal
  [[ $1 == *.h && $1 != *-inl.h && $1 != */simd/* ]]
}

check_include() {
  local folder=$1 place=$2 header=$3 file=${2%%:*}
  if [[ $header == \"* ]]; then
    local name=${header//\"/}
    [[ $name != */* && -e $(dirname "$file")/$name ]] || report "$place: $header: include it as <rayloom/folder/file.h>"
  elif [[ $header == "<rayloom/"* ]]; then
    local target=${header#<rayloom/}
    target=${target%%/*}
    [[ " ${may_include[$folder]} " == *" $target "* ]] || report "$place: $folder must not include $target"
  elif [[ $header == "<glm/"* && $folder =~ ^(base|accel|hwmodel)$ ]]; then
    report "$place: $folder knows no GLM"
  elif [[ $folder =~ ^(accel|hwmodel)$ ]] && is_public_header "$file" && ! [[ $header =~ $standard ]]; then
    report "$place: $header: no third-party header in a public header of $folder"
  fi
}

for folder in "${folders[@]}"; do
  [[ -d $folder ]] || continue
  while read -r place header; do
    check_include "$folder" "$place" "$header"
  done < <(includes_of "$folder")
done

# shellcheck disable=SC2016  # the backquotes are Markdown
if [[ -e README.md ]]; then
  while IFS=: read -r line path; do
    path=${path//\`/}
    compgen -G "$path*" > /dev/null || report "README.md:$line: no such file: $path"
  done < <(grep -onE '`(base|accel|runtime|hwmodel|scenes|shaders|tools|tests|docs)/[A-Za-z0-9_./-]+`' README.md || true)
fi

[[ $violations -eq 0 ]] || { echo "$violations include or README violation(s)"; exit 1; }
