#include <rayloom/base/det_math.h>
#include <rayloom/base/error.h>
#include <rayloom/shaders/distribution.h>
#include <rayloom/shaders/environment.h>
#include <rayloom/shaders/warp.h>

#include <algorithm>
#include <cmath>

namespace rayloom::shaders {
namespace {

using Kind = scenes::Environment::Kind;

/// Latitude-longitude coordinates in [0, 1]: u = 0.5 + atan2(x, -z) / 2 pi, v = 0 straight up (scenes/scene.h).
float2 sphere_to_map(float3 direction) {
  const float u = 0.5f + det::atan2(direction.x, -direction.z) * (0.5f * inverse_pi);
  return {u, det::acos(glm::clamp(direction.y, -1.0f, 1.0f)) * inverse_pi};
}

float row_edge(uint32_t row, uint32_t rows) {
  return det::cos(pi * (static_cast<float>(row) / static_cast<float>(rows)));
}

/// A cell between two latitudes; every column of a row has the same solid angle.
struct Cell {
  float top, bottom;  ///< direction.y
  float solid_angle(uint32_t columns) const { return 2 * pi * (top - bottom) / static_cast<float>(columns); }
};
Cell cell_of_row(uint32_t row, uint32_t rows) { return {row_edge(row, rows), row_edge(row + 1, rows)}; }

float3 gradient(const EnvironmentView& view, float y) {
  return view.horizon + std::fabs(y) * ((y > 0 ? view.zenith : view.nadir) - view.horizon);
}

float3 bilinear(const EnvironmentView& view, float2 map) {
  const float x = map.x * static_cast<float>(view.columns) - 0.5f, y = map.y * static_cast<float>(view.rows) - 0.5f;
  const float floor_x = std::floor(x), floor_y = std::floor(y);
  const auto columns = static_cast<int>(view.columns), rows = static_cast<int>(view.rows);
  const auto texel = [&](int dx, int dy) {
    const int column = (static_cast<int>(floor_x) + dx + columns) % columns;
    const int row = std::clamp(static_cast<int>(floor_y) + dy, 0, rows - 1);
    return view.texels[static_cast<uint64_t>(row) * view.columns + static_cast<uint64_t>(column)];
  };
  return glm::mix(glm::mix(texel(0, 0), texel(1, 0), x - floor_x), glm::mix(texel(0, 1), texel(1, 1), x - floor_x),
                  y - floor_y);
}

float clean(float value, float scale, uint64_t& bad) {
  const float scaled = value * scale;
  if (std::isfinite(scaled) && scaled >= 0) return scaled;
  ++bad;
  return 0;
}

std::vector<float3> decode(const scenes::Image& image, float scale, uint64_t& bad) {
  const scenes::Pixels& pixels = image.pixels();
  std::vector<float3> texels(uint64_t{pixels.width} * pixels.height);
  for (uint64_t i = 0; i < texels.size(); ++i)
    for (uint64_t c = 0; c < 3; ++c)
      texels[i][static_cast<int>(c)] = pixels.bytes.empty()
                                           ? clean(pixels.floats[4 * i + c], scale, bad)
                                           : clean(static_cast<float>(pixels.bytes[4 * i + c]) / 255.0f, scale, bad);
  return texels;
}

/// The luminance that bilinear interpolation gives a cell on average: 1/8, 6/8, 1/8 of its neighbours on each axis.
float smoothed(const EnvironmentTables& tables, uint32_t row, uint32_t column) {
  float sum = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const auto y =
          static_cast<uint32_t>(std::clamp(static_cast<int>(row) + dy, 0, static_cast<int>(tables.rows) - 1));
      const uint32_t x = (column + tables.columns + static_cast<uint32_t>(dx)) % tables.columns;
      const float weight = (dx == 0 ? 0.75f : 0.125f) * (dy == 0 ? 0.75f : 0.125f);
      sum += weight * luminance(tables.texels[uint64_t{y} * tables.columns + x]);
    }
  return sum;
}

void make_image_table(EnvironmentTables& tables) {
  std::vector<float> row_weights, columns, conditional;
  for (uint32_t row = 0; row < tables.rows; ++row) {
    columns.clear();
    for (uint32_t column = 0; column < tables.columns; ++column) columns.push_back(smoothed(tables, row, column));
    const double sum = append_cumulative(columns, conditional);
    row_weights.push_back(static_cast<float>(sum) * cell_of_row(row, tables.rows).solid_angle(tables.columns));
  }
  append_cumulative(row_weights, tables.table);
  tables.table.insert(tables.table.end(), conditional.begin(), conditional.end());
}

/// One column of rows, by the radiance in the middle of each.
void make_gradient_table(EnvironmentTables& tables, const scenes::Environment& environment) {
  EnvironmentView view;
  view.zenith = environment.zenith, view.horizon = environment.horizon, view.nadir = environment.nadir;
  std::vector<float> weights, conditional;
  for (uint32_t row = 0; row < tables.rows; ++row) {
    const Cell cell = cell_of_row(row, tables.rows);
    weights.push_back(luminance(gradient(view, 0.5f * (cell.top + cell.bottom))) * cell.solid_angle(1));
    append_cumulative(std::vector<float>{1.0f}, conditional);
  }
  append_cumulative(weights, tables.table);
  tables.table.insert(tables.table.end(), conditional.begin(), conditional.end());
}

}  // namespace

float3 environment_radiance(const EnvironmentView& view, float3 direction) {
  switch (view.kind) {
    case Kind::none:
      return float3(0);
    case Kind::constant:
      return view.zenith;
    case Kind::gradient:
      return gradient(view, direction.y);
    case Kind::image:
      return bilinear(view, sphere_to_map(direction));
  }
  return float3(0);
}

DirectionSample sample_environment(const EnvironmentView& view, float2 u) {
  if (view.kind == Kind::constant) return {uniform_sphere(u), uniform_sphere_pdf};
  const Choice row = choose(view.table, 0, view.rows, u.y);
  const Choice column = choose(view.table, view.rows + 1 + row.index * (view.columns + 1), view.columns, u.x);
  const Cell cell = cell_of_row(row.index, view.rows);
  const float y = glm::mix(cell.top, cell.bottom, row.offset);
  const float turn = (static_cast<float>(column.index) + column.offset) / static_cast<float>(view.columns) - 0.5f;
  const float3 about_pole = direction_at(y, turn);  // x and y span the horizon: u = 0.5 looks along -z
  return {{about_pole.y, y, -about_pole.x}, row.probability * column.probability / cell.solid_angle(view.columns)};
}

float environment_pdf(const EnvironmentView& view, float3 direction) {
  if (view.kind == Kind::none) return 0;
  if (view.kind == Kind::constant) return uniform_sphere_pdf;
  const float2 map = sphere_to_map(direction);
  const uint32_t row = std::min(static_cast<uint32_t>(map.y * static_cast<float>(view.rows)), view.rows - 1);
  const uint32_t column =
      std::min(static_cast<uint32_t>(std::fmax(map.x, 0.0f) * static_cast<float>(view.columns)), view.columns - 1);
  const uint64_t first = view.rows + 1 + uint64_t{row} * (view.columns + 1) + column;
  const float probability = (view.table[row + 1] - view.table[row]) * (view.table[first + 1] - view.table[first]);
  return probability / cell_of_row(row, view.rows).solid_angle(view.columns);
}

EnvironmentTables make_environment_tables(const scenes::Scene& scene, const scenes::Environment& environment,
                                          uint64_t& bad_pixels) {
  EnvironmentTables tables;
  if (environment.kind == Kind::gradient) {
    tables.rows = 128, tables.columns = 1;
    make_gradient_table(tables, environment);
  } else if (environment.kind == Kind::image) {
    const scenes::Image& image = *scene.images.at(environment.image);
    tables.texels = decode(image, environment.scale, bad_pixels);
    tables.rows = image.pixels().height, tables.columns = image.pixels().width;
    if (tables.texels.empty()) throw InputError(image.name(), "environment", "the image has no pixels");
    make_image_table(tables);
  }
  return tables;
}

}  // namespace rayloom::shaders
