#!/usr/bin/env bash
# Renders one scene with two seeds and compares: fails because the pictures differ. Anything else that goes wrong passes,
# which the test, being expected to fail, reports.
rayloom=$1
cd "$2" || exit 0
for seed in 1 2; do
  "$rayloom" render cornell --size 16x16 --spp 1 --seed "$seed" -o "must_differ_$seed.exr" -q > /dev/null || exit 0
done
"$rayloom" diff must_differ_1.exr must_differ_2.exr
[[ $? -ne 1 ]]
