#include <rayloom/tools/bench/numerics/rows.h>

namespace rayloom::bench::numerics {

const std::vector<Row>& all_rows() {
  static const std::vector<Row> rows{{"K1", "edge watertightness", "O3, O2", run_edges},
                                     {"K2", "vertex watertightness", "O3, O2", run_vertices},
                                     {"K3", "exactly one hit", "O2 with the symbolic shift", run_exactly_one},
                                     {"K4", "scale", "O3", run_scales},
                                     {"K5", "far from the origin", "O3, O1", run_far_from_origin},
                                     {"K6", "contraction and optimisation", "bits", run_contraction},
                                     {"K7", "accuracy of t, u, v", "O2", run_accuracy},
                                     {"K8", "grazing rays", "O2", run_grazing},
                                     {"K9", "slivers and needles", "O2, O3", run_needles},
                                     {"K10", "degenerate triangles", "O2 (area)", run_degenerate},
                                     {"K11", "duplicates, coplanar triangles", "O1", run_duplicates},
                                     {"K12", "accepted triangle, missed box", "every ancestor", run_box_misses},
                                     {"K13", "ridges and corridors", "O1, O3", run_ridges},
                                     {"K14", "enclosure by stored nodes", "exact", run_node_enclosure},
                                     {"K15", "axis-aligned rays", "exact slabs, O1", run_axis_aligned},
                                     {"K16", "tiny and huge directions", "O1, scaling", run_direction_scales},
                                     {"K17", "NaN and infinity in rays", "rules", run_invalid_rays},
                                     {"K18", "NaN and infinity in geometry", "rules", run_invalid_geometry},
                                     {"K19", "ends of the interval", "O2", run_interval_ends},
                                     {"K20", "walking from hit to hit", "O1", run_next_hits},
                                     {"K21", "flush to zero in the caller", "bits", run_flush_to_zero},
                                     {"K22", "rounding mode of the caller", "bits", run_rounding_modes},
                                     {"T1", "instances that change nothing", "bits", run_exact_transforms},
                                     {"T2", "general affine instances", "O2, O1, O3", run_affine_transforms},
                                     {"T3", "singular and NaN transforms", "rules", run_singular_transforms},
                                     {"T4", "chains of transforms", "O2", run_transform_chains},
                                     {"T5", "refit", "O1", run_refit},
                                     {"T6", "self-hits of spawned rays", "own id", run_self_hits},
                                     {"T7", "missed contact", "which sheet", run_missed_contact},
                                     {"T8", "light leaks", "energy", run_light_leaks},
                                     {"B1", "identical centres", "depth", run_equal_centres},
                                     {"B2", "exponential spacing", "depth, O1", run_exponential},
                                     {"B3", "overlapping slivers", "O1", run_slivers},
                                     {"B4", "stack bound", "high water", run_stack},
                                     {"B5", "random bits as input", "no harm", run_garbage},
                                     {"B6", "ends of the index ranges", "rules", run_index_limits},
                                     {"B7", "thread counts", "bytes", run_threads},
                                     {"B8", "instruction sets", "bits", run_instruction_sets},
                                     {"B9", "order of the input", "bits", run_orders},
                                     {"B10", "build modes", "bits", run_build_modes}};
  return rows;
}

}  // namespace rayloom::bench::numerics
