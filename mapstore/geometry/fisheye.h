// Equidistant fisheye (Kannala and Brandt, OpenCV's `fisheye`): the angle off the axis is bent by
// an odd polynomial, bent = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), and the
// image's radius is focal length times bent. Says nothing of a plane: 90 degrees and more are
// angles like others.
#pragma once

#include <optional>

namespace maploc {

// bent and d bent / d theta.
double Bend(const double k[4], double theta_rad);
double BendSlope(const double k[4], double theta_rad);

// Up to which angle the polynomial rises: past its fold a radius is another ray's. At most a
// hundredth short of pi, where every direction of the image meets in one ray.
double MaxBendableAngle(const double k[4]);

// The angle in [0, max_theta_rad] that is bent to `bent`; nullopt when there is none.
// REQUIRES: max_theta_rad <= MaxBendableAngle(k); bent >= 0.
std::optional<double> Unbend(const double k[4], double max_theta_rad, double bent);

}  // namespace maploc
