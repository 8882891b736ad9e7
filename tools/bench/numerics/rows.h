#pragma once

// The rows' functions, by the file that holds them.

#include <rayloom/tools/bench/numerics/lab.h>

namespace rayloom::bench::numerics {

// watertight_rows.cpp
void run_edges(RowRun&);
void run_vertices(RowRun&);
void run_exactly_one(RowRun&);
void run_scales(RowRun&);
void run_far_from_origin(RowRun&);
// compiler_row.cpp
void run_contraction(RowRun&);
// accuracy_rows.cpp
void run_accuracy(RowRun&);
void run_grazing(RowRun&);
void run_needles(RowRun&);
// degenerate_rows.cpp
void run_degenerate(RowRun&);
void run_duplicates(RowRun&);
// box_rows.cpp
void run_box_misses(RowRun&);
void run_ridges(RowRun&);
void run_node_enclosure(RowRun&);
void run_axis_aligned(RowRun&);
// ray_rows.cpp
void run_direction_scales(RowRun&);
void run_invalid_rays(RowRun&);
void run_interval_ends(RowRun&);
void run_next_hits(RowRun&);
// invalid_geometry_row.cpp
void run_invalid_geometry(RowRun&);
// environment_rows.cpp
void run_flush_to_zero(RowRun&);
void run_rounding_modes(RowRun&);
// instance_rows.cpp
void run_exact_transforms(RowRun&);
void run_affine_transforms(RowRun&);
void run_singular_transforms(RowRun&);
void run_transform_chains(RowRun&);
// refit_row.cpp
void run_refit(RowRun&);
// spawn_rows.cpp
void run_self_hits(RowRun&);
void run_missed_contact(RowRun&);
void run_light_leaks(RowRun&);
// shape_rows.cpp
void run_equal_centres(RowRun&);
void run_exponential(RowRun&);
void run_slivers(RowRun&);
void run_stack(RowRun&);
// input_rows.cpp
void run_garbage(RowRun&);
void run_index_limits(RowRun&);
// determinism_rows.cpp
void run_threads(RowRun&);
void run_instruction_sets(RowRun&);
void run_orders(RowRun&);
void run_build_modes(RowRun&);

}  // namespace rayloom::bench::numerics
