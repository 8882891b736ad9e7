#!/usr/bin/env bash
# package_test.sh PREFIX CONSUMER SOURCE BUILD COMPILER COMPONENTS: builds a copy of CONSUMER against a moved copy of
# PREFIX and runs it. Nothing installed may name the source or build tree.
set -euo pipefail
prefix=$1 consumer=$2 source=$3 build=$4 compiler=$5 components=$6
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if grep -rIlF -e "$source" -e "$build" "$prefix/include" "$prefix"/lib*; then
  echo "the files above name the source or build tree" >&2
  exit 1
fi
cp -r "$prefix" "$work/moved prefix"
cp -r "$consumer" "$work/consumer"
cd "$work"
cmake -S consumer -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_PREFIX_PATH="$work/moved prefix" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF \
  -DCOMPONENTS="$components"
cmake --build build
if grep -qF -e "$source/" -e "$build/" build/build.ninja; then
  echo "the consumer's build reaches into the source or build tree" >&2
  exit 1
fi
for program in build/use_*; do
  "$program"
done
