#include <rayloom/accel/instance_transform.h>
#include <rayloom/base/det_math.h>
#include <rayloom/tools/bench/numerics/transforms.h>

#include <cstring>

namespace rayloom::bench::numerics {
namespace {

float power_of_ten(Random& random, int low, int high) {
  const int exponent = low + static_cast<int>(random.below(static_cast<uint32_t>(high - low + 1)));
  return static_cast<float>(det::pow(10.0, static_cast<double>(exponent)));
}

/// `outer` after `inner`, in whatever numbers.
template <class Number, class Outer>
std::array<Number, 12> product(const Outer& outer, const std::array<Number, 12>& inner) {
  std::array<Number, 12> out;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) {
      Number sum = column == 3 ? Number(outer[4 * row + 3]) : Number(0);
      for (int k = 0; k < 3; ++k) sum += Number(outer[4 * row + k]) * inner[4 * k + column];
      out[4 * row + column] = sum;
    }
  return out;
}

Exact3 cross(const Exact3& a, const Exact3& b) {
  return {mpq_class(a[1] * b[2] - a[2] * b[1]), mpq_class(a[2] * b[0] - a[0] * b[2]),
          mpq_class(a[0] * b[1] - a[1] * b[0])};
}

mpq_class dot(const Exact3& a, const Exact3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Exact3 difference(const Exact3& a, const Exact3& b) {
  return {mpq_class(a[0] - b[0]), mpq_class(a[1] - b[1]), mpq_class(a[2] - b[2])};
}

}  // namespace

Transform3x4 random_affine(Random& random) {
  Transform3x4 m;
  for (int column = 0; column < 3; ++column) {
    const float scale = power_of_ten(random, -3, 3);
    for (int row = 0; row < 3; ++row) m[4 * row + column] = random.uniform(-1, 1) * scale;
  }
  if (random.chance(3)) {
    const float gap = power_of_ten(random, -7, -1);
    for (int row = 0; row < 3; ++row) m[4 * row + 1] = m[4 * row] + gap * m[4 * row + 1];
  }
  const float reach = random.chance(4) ? 0.0f : power_of_ten(random, 0, 7);
  for (int row = 0; row < 3; ++row) m[4 * row + 3] = random.uniform(-reach, reach);
  return m;
}

Transform3x4 bad_transform(Random& random) {
  Transform3x4 m = random_affine(random);
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), INFINITY, -INFINITY};
  switch (random.below(4)) {
    case 0:
      m.fill(0);
      break;
    case 1:
      for (int k = 0; k < 4; ++k) m[4 + k] = 0;
      break;
    case 2:
      m[random.below(12)] = bad[random.below(3)];
      break;
    default:
      for (int row = 0; row < 3; ++row) m[4 * row + 2] = m[4 * row];
  }
  return m;
}

Matrix similarity(Random& random) {
  double q[4], length = 0;
  for (double& x : q) x = random.uniform(-1, 1), length += x * x;
  const double scale = std::ldexp(random.uniform(1, 2), static_cast<int>(random.below(4)) - 2) / length;
  const auto [w, x, y, z] = q;
  const auto move = [&] { return double{random.uniform(-10, 10)}; };
  return {scale * (w * w + x * x - y * y - z * z),
          scale * 2 * (x * y - w * z),
          scale * 2 * (x * z + w * y),
          move(),
          scale * 2 * (x * y + w * z),
          scale * (w * w - x * x + y * y - z * z),
          scale * 2 * (y * z - w * x),
          move(),
          scale * 2 * (x * z - w * y),
          scale * 2 * (y * z + w * x),
          scale * (w * w - x * x - y * y + z * z),
          move()};
}

std::optional<accel::InstanceRecord> record_of(const Transform3x4& m) {
  accel::InstanceRecord record{};
  std::memcpy(record.object_to_world, m.data(), sizeof(record.object_to_world));
  const auto inverse = accel::invert(record.object_to_world);
  if (!inverse) return std::nullopt;
  std::memcpy(record.world_to_object, inverse->matrix, sizeof(record.world_to_object));
  return record;
}

Point transformed(const Transform3x4& m, const Point& p) {
  Point out;
  for (int row = 0; row < 3; ++row)
    out[row] = m[4 * row] * p[0] + m[4 * row + 1] * p[1] + m[4 * row + 2] * p[2] + m[4 * row + 3];
  return out;
}

Exact3 transformed_exactly(const Transform3x4& m, const mpq_class (&p)[3]) {
  Exact3 out;
  for (int row = 0; row < 3; ++row) {
    out[row] = m[4 * row + 3];
    for (int k = 0; k < 3; ++k) out[row] += mpq_class(m[4 * row + k]) * p[k];
  }
  return out;
}

double largest(const float (&v)[3]) {
  return std::max({std::fabs(double{v[0]}), std::fabs(double{v[1]}), std::fabs(double{v[2]})});
}

double linear_norm(const double (&m)[3][4]) {
  double norm = 0;
  for (const auto& row : m) norm = std::max(norm, std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]));
  return norm;
}

double linear_norm(const Transform3x4& m) {
  double rows[3][4];
  std::copy(m.begin(), m.end(), &rows[0][0]);
  return linear_norm(rows);
}

void Chain::append(const Matrix& m) {
  composed_ = product<double>(m, composed_);
  exact_ = product<mpq_class>(m, exact_);
  for (int row = 0; row < 3; ++row) {
    double coordinate = std::fabs(composed_[4 * row + 3]);
    for (int k = 0; k < 3; ++k) coordinate += std::fabs(composed_[4 * row + k]);
    reach_ = std::max(reach_, coordinate);
  }
}

Transform3x4 Chain::rounded() const {
  Transform3x4 m;
  for (int i = 0; i < 12; ++i) m[i] = static_cast<float>(composed_[i]);
  return m;
}

mpq_class Chain::exact_t(const Ray& ray, const Triangle& triangle) const {
  Exact3 corner[3], origin, direction;
  for (int i = 0; i < 3; ++i)
    for (int row = 0; row < 3; ++row) {
      corner[i][row] = exact_[4 * row + 3];
      for (int k = 0; k < 3; ++k) corner[i][row] += exact_[4 * row + k] * mpq_class(triangle[i][k]);
    }
  for (int k = 0; k < 3; ++k) origin[k] = ray.origin[k], direction[k] = ray.direction[k];
  const Exact3 normal = cross(difference(corner[1], corner[0]), difference(corner[2], corner[0]));
  return dot(normal, difference(corner[0], origin)) / dot(normal, direction);
}

}  // namespace rayloom::bench::numerics
