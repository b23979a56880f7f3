// What a camera sees at one pixel, to first order: the one thing that errors in pixels need to know
// of a camera, whatever its lens.
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace maploc {

// A point at q in the camera's frame is seen off this pixel by
//     (across q) / (ray . q)
// pixels (or the unit that `across` is scaled to), and is in front of it where ray . q > 0: no
// plane, hence no limit at 90 degrees off the axis.
//
// A line whose plane through the camera's centre has the normal m passes the pixel at the distance
//     (m . ray) / |gradient m|.
struct PixelFrame {
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();  // unit
  // d pixel / d ray along the sphere; the rows are perpendicular to `ray`.
  Eigen::Matrix<double, 2, 3> across = Eigen::Matrix<double, 2, 3>::Identity();

  // across' pseudo-inverse, transposed: what turns a plane's normal into a line of the image.
  Eigen::Matrix<double, 2, 3> Gradient() const {
    const double a = across.row(0).squaredNorm();
    const double b = across.row(0).dot(across.row(1));
    const double c = across.row(1).squaredNorm();
    Eigen::Matrix2d adjugate;
    adjugate << c, -b, -b, a;
    return adjugate * across / (a * c - b * b);
  }
  // Pixels a radian, the geometric mean over directions.
  double Scale() const {
    const double b = across.row(0).dot(across.row(1));
    return std::sqrt(std::sqrt(across.row(0).squaredNorm() * across.row(1).squaredNorm() - b * b));
  }
};

}  // namespace maploc
