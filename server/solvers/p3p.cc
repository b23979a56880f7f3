#include "server/solvers/p3p.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include "server/solvers/cubic.h"

namespace maploc {
namespace {

using Symmetric = std::array<std::array<double, 3>, 3>;

// Two solutions side by side, in one register of the baseline architecture (a vector type of GCC
// and clang). Most samples have two, and polishing and poses are half of the work.
using Pair __attribute__((vector_size(16))) = double;

Pair Both(double a, double b) { return Pair{a, b}; }
Pair SquareRoot(Pair v) { return Pair{std::sqrt(v[0]), std::sqrt(v[1])}; }
Pair Absolute(Pair v) { return v < 0 ? -v : v; }

// Three numbers and nothing else: Eigen would join two of them through memory, and wait for it.
template <typename Number>
struct Triple {
  Number x, y, z;
};
using Plain = Triple<double>;
using PlainPair = Triple<Pair>;

Plain ToPlain(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
template <typename A, typename B>
auto operator+(const Triple<A>& a, const Triple<B>& b) {
  return Triple<decltype(a.x + b.x)>{a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename A, typename B>
auto operator-(const Triple<A>& a, const Triple<B>& b) {
  return Triple<decltype(a.x - b.x)>{a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename S, typename A>
auto operator*(S s, const Triple<A>& a) {
  return Triple<decltype(s * a.x)>{s * a.x, s * a.y, s * a.z};
}
template <typename A, typename B>
auto Dot(const Triple<A>& a, const Triple<B>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename A, typename B>
auto Cross(const Triple<A>& a, const Triple<B>& b) {
  return Triple<decltype(a.x * b.x)>{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z,
                                     a.x * b.y - a.y * b.x};
}
double SquaredDistance(const Plain& a, const Plain& b) { return Dot(a - b, a - b); }
Plain Normalized(const Eigen::Vector3d& v) {
  const Plain plain = ToPlain(v);
  return (1.0 / std::sqrt(Dot(plain, plain))) * plain;
}

// Below zero by rounding alone, as a share of the terms that were subtracted: a double root.
constexpr double kDoubleRoot = 1e-10;
// Residual of the distance equations, as a share of the distances, that another step would not
// better; and the number of steps that a sample near the danger cylinder may take. A step that does
// not better is shortened: where three solutions nearly meet, the first leads past them all.
constexpr double kConverged = 1e-14;
constexpr int kMaxSteps = 30;
constexpr double kShortened = 0.25;

// What the three distance equations are made of. aij = |Pi - Pj|^2 over the sum of the three; kij =
// 1 - yi . yj, from the difference of the rays, so that nothing is lost where they are close.
struct Distances {
  double a12, a13, a23;
  double k12, k13, k23;
};

// The pencil of quadrics D1 = a23 (12) - a12 (23), D2 = a13 (23) - a23 (13) of Lambda Twist, where
// (ij) is the form li^2 + lj^2 - 2 li lj cos ij. Both vanish at the depths, whatever their scale.
Symmetric FirstQuadric(const Distances& d) {
  const double c12 = -d.a23 * (1 - d.k12), c23 = d.a12 * (1 - d.k23);
  return {{{d.a23, c12, 0}, {c12, d.a23 - d.a12, c23}, {0, c23, -d.a12}}};
}
Symmetric SecondQuadric(const Distances& d) {
  const double c13 = d.a23 * (1 - d.k13), c23 = -d.a13 * (1 - d.k23);
  return {{{-d.a23, 0, c13}, {0, d.a13, c23}, {c13, c23, d.a13 - d.a23}}};
}

// det(D1 + g D2) / a23 as a cubic in g (Lambda Twist, equations (11)-(14)).
Cubic PencilDeterminant(const Distances& d) {
  const auto [a12, a13, a23, k12, k13, k23] = d;
  const double s12 = k12 * (2 - k12), s13 = k13 * (2 - k13), s23 = k23 * (2 - k23);
  // cos 12 cos 13 cos 23 - 1.
  const double blob = k12 * (k13 + k23 - k13 * k23) + k13 * k23 - (k12 + k13 + k23);
  return {a13 * (a23 * s13 - a13 * s23),
          2 * blob * a23 * a13 + a13 * (2 * a12 + a13) * s23 + a23 * (a23 - a12) * s13,
          a23 * (a13 - a23) * s12 - a12 * a12 * s23 - 2 * a12 * (blob * a23 + a13 * s23),
          a12 * (a12 * s23 - a23 * s12)};
}

// Index of the largest, without a branch.
int LargestOf(double a, double b, double c) {
  const int second = static_cast<int>(b > a);
  const int third = static_cast<int>(c > std::max(a, b));
  return (second & ~third) | (third << 1);
}

// The two planes u, v of a quadric of rank two, as lanes, and the line p in which they meet; none
// of unit length. Complex planes: false.
struct Planes {
  PlainPair normals;
  Plain line;
};

// m = u v^T + v u^T has adj(m) = -p p^T, p = u x v. With i the largest coordinate of p and j, k the
// others, m over (j, k) factors as (mjj x + q y)(q x + mkk y) / q with q = mjk +- sqrt(-adj(m)ii);
// the planes' coordinates along i follow from p . u = p . v = 0.
bool FactorIntoPlanes(const Symmetric& m, Planes* planes) {
  const double d0 = m[1][2] * m[1][2] - m[1][1] * m[2][2];
  const double d1 = m[0][2] * m[0][2] - m[0][0] * m[2][2];
  const double d2 = m[0][1] * m[0][1] - m[0][0] * m[1][1];
  const double d01 = m[0][1] * m[2][2] - m[0][2] * m[1][2];
  const double d02 = m[0][2] * m[1][1] - m[0][1] * m[1][2];
  const double d12 = m[0][0] * m[1][2] - m[0][1] * m[0][2];
  const Symmetric minus_adjugate = {{{d0, d01, d02}, {d01, d1, d12}, {d02, d12, d2}}};
  const int i = LargestOf(d0, d1, d2);
  const int j = static_cast<int>(i == 0);
  const int k = 2 - static_cast<int>(i == 2);
  const double pi = minus_adjugate[i][i], pj = minus_adjugate[i][j], pk = minus_adjugate[i][k];
  if (!(pi > 0)) return false;
  const double q = m[j][k] + std::copysign(std::sqrt(pi), m[j][k]);
  double u[3], v[3], p[3];
  u[i] = -(pj * m[j][j] + pk * q);
  u[j] = pi * m[j][j];
  u[k] = pi * q;
  v[i] = -(pj * q + pk * m[k][k]);
  v[j] = pi * q;
  v[k] = pi * m[k][k];
  p[i] = pi;
  p[j] = pj;
  p[k] = pk;
  planes->normals = {Both(u[0], v[0]), Both(u[1], v[1]), Both(u[2], v[2])};
  planes->line = {p[0], p[1], p[2]};
  return true;
}

template <typename Number>
Triple<Number> operator*(const Symmetric& m, const Triple<Number>& v) {
  return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
          m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
          m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

// Where the planes meet the quadric: at most four directions (l1, l2, l3) with all signs equal,
// which are made positive. Returns how many.
int MeetPlanes(const Symmetric& m, const Planes& planes, Plain directions[4]) {
  // In a plane, l = alpha p + beta e with e across the line p.
  const Plain& p = planes.line;
  const PlainPair e = Cross(planes.normals, p);
  const Plain mp = m * p;
  const double a = Dot(p, mp);
  const Pair b = Dot(e, mp);
  const Pair c = Dot(e, m * e);
  const Pair discriminant = b * b - a * c;
  const auto real = discriminant >= -kDoubleRoot * (b * b + Absolute(a * c));
  const Pair root = SquareRoot(discriminant > 0 ? discriminant : Pair{0, 0});
  const Pair q = -(b + (b < 0 ? -root : root));
  const PlainPair found[2] = {q * p + a * e, c * p + q * e};
  int count = 0;
  for (const PlainPair& l : found) {
    const auto positive = real & (l.x * l.y > 0) & (l.x * l.z > 0);
    for (int lane = 0; lane < 2; ++lane) {
      // Written in any case and kept by counting.
      directions[count] = {std::abs(l.x[lane]), std::abs(l.y[lane]), std::abs(l.z[lane])};
      count -= static_cast<int>(positive[lane]);
    }
  }
  return count;
}

struct Depths {
  Pair l1, l2, l3;
};

struct Residuals {
  Pair r12, r13, r23;

  Pair Sum() const { return Absolute(r12) + Absolute(r13) + Absolute(r23); }
};

// li^2 + lj^2 - 2 li lj cos ij, the squared distances that the depths have.
Residuals SquaredDistances(const Distances& d, const Depths& l) {
  const auto squared = [](Pair li, Pair lj, double kij) {
    return (li - lj) * (li - lj) + 2 * kij * li * lj;
  };
  return {squared(l.l1, l.l2, d.k12), squared(l.l1, l.l3, d.k13), squared(l.l2, l.l3, d.k23)};
}

// s R - t a, of which (1, 1) are the residuals.
Residuals Difference(const Residuals& squared, Pair s, const Distances& d, Pair t) {
  return {squared.r12 * s - t * d.a12, squared.r13 * s - t * d.a13, squared.r23 * s - t * d.a23};
}

// J^-1 r / 2, a step of Newton, where J / 2 is the derivative of SquaredDistances.
Depths Step(const Distances& d, const Depths& l, const Residuals& r) {
  const double c12 = 1 - d.k12, c13 = 1 - d.k13, c23 = 1 - d.k23;
  const Pair j11 = l.l1 - c12 * l.l2, j12 = l.l2 - c12 * l.l1;
  const Pair j21 = l.l1 - c13 * l.l3, j23 = l.l3 - c13 * l.l1;
  const Pair j32 = l.l2 - c23 * l.l3, j33 = l.l3 - c23 * l.l2;
  const Pair u = j11 * j33, v = j11 * j32, w = j12 * j21;
  const Pair a = j21 * j33, b = j12 * j23, c = j23 * j32;
  const Pair inverse = 0.5 / (j11 * c + w * j33);
  return {inverse * (c * r.r12 + j12 * j33 * r.r13 - b * r.r23),
          inverse * (a * r.r12 - u * r.r13 + j11 * j23 * r.r23),
          inverse * (v * r.r13 + w * r.r23 - j21 * j32 * r.r12)};
}

bool Any(decltype(Pair{} < Pair{}) mask) { return mask[0] != 0 || mask[1] != 0; }

// Newton's steps for depths near the danger cylinder, none of which makes them worse.
Depths Polish(const Distances& d, Depths depths) {
  const Pair one = {1, 1};
  Residuals residuals = Difference(SquaredDistances(d, depths), one, d, one);
  Pair share = one;
  for (int i = 0; i < kMaxSteps && Any(residuals.Sum() > kConverged); ++i) {
    const Depths step = Step(d, depths, residuals);
    const Depths next = {depths.l1 - share * step.l1, depths.l2 - share * step.l2,
                         depths.l3 - share * step.l3};
    const Residuals after = Difference(SquaredDistances(d, next), one, d, one);
    const auto better = after.Sum() < residuals.Sum();
    share = better ? one : kShortened * share;
    depths = {better ? next.l1 : depths.l1, better ? next.l2 : depths.l2,
              better ? next.l3 : depths.l3};
    residuals = {better ? after.r12 : residuals.r12, better ? after.r13 : residuals.r13,
                 better ? after.r23 : residuals.r23};
  }
  return depths;
}

// Two directions scaled to the distances, with one step of Newton. J is of first degree in the
// depths, so the step is taken for the direction as it is, beside the square roots:
//   s l - J(s l)^-1 (s^2 R - a) = s l - J(l)^-1 (s R - a / s).
// Only where that did not suffice are there more.
Depths ScaleAndPolish(const Distances& d, const Plain& direction1, const Plain& direction2) {
  const Depths l = {Both(direction1.x, direction2.x), Both(direction1.y, direction2.y),
                    Both(direction1.z, direction2.z)};
  const Residuals squared = SquaredDistances(d, l);
  const Pair total = squared.r12 + squared.r13 + squared.r23;
  const Pair by_scale = SquareRoot(total);  // the distances' sum is 1
  const Pair s = 1 / by_scale;
  const Depths step = Step(d, l, Difference(squared, s, d, by_scale));
  const Depths depths = {s * l.l1 - step.l1, s * l.l2 - step.l2, s * l.l3 - step.l3};
  const Pair one = {1, 1};
  const Residuals residuals = Difference(SquaredDistances(d, depths), one, d, one);
  const auto converged = residuals.Sum() <= kConverged;
  if (converged[0] != 0 && converged[1] != 0) return depths;
  return Polish(d, {s * l.l1, s * l.l2, s * l.l3});
}

struct QuaternionPair {
  Pair w;
  PlainPair v;
};

// The quaternions of two rotation matrices without a branch: the longest row of 4 q q^T,
// normalized.
QuaternionPair ToQuaternions(const PlainPair& a, const PlainPair& b, const PlainPair& c) {
  const Pair x = b.z - c.y, y = c.x - a.z, z = a.y - b.x;
  const Pair xy = b.x + a.y, xz = c.x + a.z, yz = c.y + b.z;
  const Pair ww = 1 + a.x + b.y + c.z, xx = 1 + a.x - b.y - c.z;
  const Pair yy = 1 - a.x + b.y - c.z, zz = 1 - a.x - b.y + c.z;
  const QuaternionPair rows[3] = {{x, {xx, xy, xz}}, {y, {xy, yy, yz}}, {z, {xz, yz, zz}}};
  const Pair lengths[3] = {xx, yy, zz};  // the square of a row's length is 4 times its diagonal
  QuaternionPair row = {ww, {x, y, z}};
  Pair longest = ww;
  for (int i = 0; i < 3; ++i) {
    const auto longer = lengths[i] > longest;
    longest = longer ? lengths[i] : longest;
    row = {longer ? rows[i].w : row.w,
           {longer ? rows[i].v.x : row.v.x, longer ? rows[i].v.y : row.v.y,
            longer ? rows[i].v.z : row.v.z}};
  }
  const Pair inverse = 1 / SquareRoot(row.w * row.w + Dot(row.v, row.v));
  return {row.w * inverse, inverse * row.v};
}

// A basis of two edges of a triangle and their normal, as columns of a matrix.
template <typename Number>
struct Basis {
  Triple<Number> e1, e2, normal;

  Basis(const Triple<Number>& first, const Triple<Number>& second)
      : e1(first), e2(second), normal(Cross(first, second)) {}
};

// R maps the map's triangle onto the camera's, R = camera_basis inverse(map_basis); `inverse` holds
// the latter's rows. The translation is of the rotation as it is returned, so that it holds far
// from the map's origin. Writes `count` poses, 1 or 2.
void WritePoses(const Plain y[3], const Plain& point, const Plain inverse[3], const Depths& depths,
                int count, Rigid3* camera_from_map) {
  const PlainPair seen = depths.l1 * y[0];
  const Basis<Pair> camera(seen - depths.l2 * y[1], seen - depths.l3 * y[2]);
  const auto column = [&](double a, double b, double c) {
    return a * camera.e1 + b * camera.e2 + c * camera.normal;
  };
  const QuaternionPair q = ToQuaternions(column(inverse[0].x, inverse[1].x, inverse[2].x),
                                         column(inverse[0].y, inverse[1].y, inverse[2].y),
                                         column(inverse[0].z, inverse[1].z, inverse[2].z));
  const PlainPair twice = 2.0 * Cross(q.v, point);
  const PlainPair t = seen - (point + q.w * twice + Cross(q.v, twice));
  for (int i = 0; i < count; ++i) {
    Rigid3& pose = camera_from_map[i];
    pose.rotation.w() = q.w[i];
    pose.rotation.x() = q.v.x[i];
    pose.rotation.y() = q.v.y[i];
    pose.rotation.z() = q.v.z[i];
    pose.translation.x() = t.x[i];
    pose.translation.y() = t.y[i];
    pose.translation.z() = t.z[i];
  }
}

// The smallest squared sine of the three angles between neighbours; 0 for a vector of no length.
double SmallestSine2(const Eigen::Vector3d vectors[3]) {
  double smallest = 1.0;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d& a = vectors[i];
    const Eigen::Vector3d& b = vectors[(i + 1) % 3];
    const double scale2 = a.squaredNorm() * b.squaredNorm();
    smallest = std::min(smallest, scale2 > 0 ? a.cross(b).squaredNorm() / scale2 : 0.0);
  }
  return smallest;
}

}  // namespace

int SolveP3p(const Eigen::Vector3d rays[3], const Eigen::Vector3d points[3],
             Rigid3 camera_from_map[4]) {
  const Plain y[3] = {Normalized(rays[0]), Normalized(rays[1]), Normalized(rays[2])};
  const Plain p[3] = {ToPlain(points[0]), ToPlain(points[1]), ToPlain(points[2])};
  const Basis<double> map(p[0] - p[1], p[0] - p[2]);
  const double area2 = Dot(map.normal, map.normal);
  if (!(area2 > 0)) return 0;
  const double a12 = Dot(map.e1, map.e1), a13 = Dot(map.e2, map.e2);
  const double a23 = SquaredDistance(p[1], p[2]);
  const double sum = a12 + a13 + a23;
  const double by_sum = 1.0 / sum;
  const Distances distances = {by_sum * a12,
                               by_sum * a13,
                               by_sum * a23,
                               0.5 * SquaredDistance(y[0], y[1]),
                               0.5 * SquaredDistance(y[0], y[2]),
                               0.5 * SquaredDistance(y[1], y[2])};
  const Symmetric first = FirstQuadric(distances);
  const Symmetric second = SecondQuadric(distances);
  const HomogeneousRoot root = OuterRoot(PencilDeterminant(distances));
  Symmetric degenerate;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      degenerate[i][j] = root.denominator * first[i][j] + root.numerator * second[i][j];
    }
  }
  Planes planes;
  if (!FactorIntoPlanes(degenerate, &planes)) return 0;
  // The quadric of the pencil that is least like the degenerate one.
  const Symmetric& other = std::abs(root.numerator) > std::abs(root.denominator) ? first : second;
  Plain directions[4];
  const int count = MeetPlanes(other, planes, directions);
  const double unit = std::sqrt(sum);
  const double by_area2 = 1.0 / area2;
  const Plain inverse_map_basis[3] = {by_area2 * Cross(map.e2, map.normal),
                                      by_area2 * Cross(map.normal, map.e1), by_area2 * map.normal};
  for (int i = 0; i < count; i += 2) {
    const int last = std::min(i + 1, count - 1);
    const Depths scaled = ScaleAndPolish(distances, directions[i], directions[last]);
    const Depths depths = {unit * scaled.l1, unit * scaled.l2, unit * scaled.l3};
    WritePoses(y, p[0], inverse_map_basis, depths, last - i + 1, camera_from_map + i);
  }
  return count;
}

double P3pConditioning(const Eigen::Vector3d rays[3], const Eigen::Vector3d points[3]) {
  const Eigen::Vector3d edges[3] = {points[1] - points[0], points[2] - points[1],
                                    points[0] - points[2]};
  return std::sqrt(SmallestSine2(edges) * SmallestSine2(rays));
}

}  // namespace maploc
