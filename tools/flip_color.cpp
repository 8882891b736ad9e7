#include <rayloom/tools/flip_color.h>

#include <rayloom/base/det_math.h>

#include <cmath>

namespace rayloom::tools::flip {
namespace {

using Vector = std::array<double, 3>;
using Matrix = std::array<Vector, 3>;

constexpr Vector operator*(const Matrix& m, const Vector& v) {
  Vector result{};
  for (size_t i = 0; i < 3; ++i) result[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return result;
}

/// The cofactor formula; the indices run cyclically, which is where the signs went.
constexpr Matrix inverse(const Matrix& m) {
  Matrix result{};
  double determinant = 0;
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      const size_t r = (j + 1) % 3, s = (j + 2) % 3, p = (i + 1) % 3, q = (i + 2) % 3;
      result[i][j] = m[r][p] * m[s][q] - m[r][q] * m[s][p];
    }
  }
  for (size_t j = 0; j < 3; ++j) determinant += m[0][j] * result[j][0];
  for (Vector& row : result) {
    for (double& value : row) value /= determinant;
  }
  return result;
}

constexpr Vector from_chromaticity(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }

/// Columns are the XYZ of the primaries, scaled so that they add up to the white.
constexpr Matrix rgb_to_xyz_matrix(const std::array<Vector, 3>& primaries, const Vector& white) {
  Matrix columns{};
  for (size_t i = 0; i < 3; ++i) columns[i] = {primaries[0][i], primaries[1][i], primaries[2][i]};
  const Vector scale = inverse(columns) * white;
  for (Vector& row : columns) {
    for (size_t j = 0; j < 3; ++j) row[j] *= scale[j];
  }
  return columns;
}

/// XYZ over the white's XYZ: linear RGB (1,1,1) gives (1,1,1).
constexpr Matrix relative_xyz_matrix() {
  const Vector white = from_chromaticity(0.3127, 0.3290);
  Matrix m = rgb_to_xyz_matrix(
      {from_chromaticity(0.64, 0.33), from_chromaticity(0.30, 0.60), from_chromaticity(0.15, 0.06)}, white);
  for (size_t i = 0; i < 3; ++i) {
    for (double& value : m[i]) value /= white[i];
  }
  return m;
}

using FloatMatrix = std::array<Color, 3>;

constexpr FloatMatrix to_float(const Matrix& m) {
  FloatMatrix result{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) result[i][j] = static_cast<float>(m[i][j]);
  }
  return result;
}

constexpr FloatMatrix rgb_to_xyz = to_float(relative_xyz_matrix());
constexpr FloatMatrix xyz_to_rgb = to_float(inverse(relative_xyz_matrix()));

Color multiply(const FloatMatrix& m, const Color& v) {
  Color result;
  for (size_t i = 0; i < 3; ++i) result[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return result;
}

/// CIE 15: the cube root with a straight piece near black.
float lab_curve(float t) {
  constexpr float delta = 6.0f / 29;
  return t > delta * delta * delta ? det::cbrt(t) : t / (3 * delta * delta) + 4.0f / 29;
}

}  // namespace

float decode_srgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : det::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float luminance(const Color& rgb) { return multiply(rgb_to_xyz, rgb)[1]; }

Color to_ycxcz(const Color& rgb) {
  const auto [x, y, z] = multiply(rgb_to_xyz, rgb);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Color from_ycxcz(const Color& ycxcz) {
  const float y = (ycxcz[0] + 16) / 116;
  return multiply(xyz_to_rgb, {y + ycxcz[1] / 500, y, y - ycxcz[2] / 200});
}

Color to_hunt_lab(const Color& rgb) {
  Color f = multiply(rgb_to_xyz, rgb);
  for (float& value : f) value = lab_curve(value);
  const float lightness = 116 * f[1] - 16;
  const float hunt = 0.01f * lightness;
  return {lightness, hunt * 500 * (f[0] - f[1]), hunt * 200 * (f[1] - f[2])};
}

float hyab(const Color& x, const Color& y) {
  const float da = x[1] - y[1], db = x[2] - y[2];
  return std::abs(x[0] - y[0]) + std::sqrt(da * da + db * db);
}

}  // namespace rayloom::tools::flip
