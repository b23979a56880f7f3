#include "tests/property/odometry/simulated_drive.h"

#include <algorithm>
#include <cmath>

namespace maploc::testing {
namespace {

constexpr double kSeconds = 0.1;  // between moments
constexpr double kPi = 3.141592653589793;

// Variance 1, heavier tails than the normal distribution's.
double Laplace(Random& random) {
  const double u = random.Uniform(-0.5, 0.5);
  return std::copysign(std::log1p(-2.0 * std::abs(u)), u) / -std::sqrt(2.0);
}

Eigen::Vector3d LaplaceVector(Random& random) {
  return {Laplace(random), Laplace(random), Laplace(random)};
}

double Within(Random& random, double bound) { return random.Uniform(-bound, bound); }

// The robot's course over ground.
struct Course {
  double x = 0.0;
  double y = 0.0;
  double yaw = 0.0;
  double speed = 0.5;     // m/s
  double yaw_rate = 0.0;  // rad/s

  void Step(Random& random) {
    speed = std::clamp(speed + 0.15 * Laplace(random), 0.0, 1.5);
    yaw_rate = std::clamp(0.95 * yaw_rate + 0.1 * Laplace(random), -0.8, 0.8);
    yaw += yaw_rate * kSeconds;
    x += std::cos(yaw) * speed * kSeconds;
    y += std::sin(yaw) * speed * kSeconds;
  }
};

// On hills of at most 6%, swaying on its springs.
Rigid3 OnGround(const Course& course, Random& random) {
  const Eigen::Vector3d normal(-0.03 * std::cos(course.x / 17.0), -0.03 * std::cos(course.y / 11.0),
                               1.0);
  const Eigen::Vector3d up = normal.normalized() + 0.003 * LaplaceVector(random);
  const Eigen::Quaterniond tilt =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), up.normalized());
  return {
      (tilt * Eigen::AngleAxisd(course.yaw, Eigen::Vector3d::UnitZ())).normalized(),
      {course.x, course.y, 0.51 * std::sin(course.x / 17.0) + 0.33 * std::sin(course.y / 11.0)}};
}

// What one robot's odometry makes of its steps.
class Odometry {
 public:
  Odometry(bool planar, double badness, Random& random)
      : planar_(planar),
        scale_(1.0 + Within(random, 0.03 * badness)),
        turn_scale_(1.0 + Within(random, 0.04 * badness)),
        yaw_per_meter_(Within(random, 0.008 * badness)) {
    pose_.translation = {Within(random, 100.0), Within(random, 100.0), 0.0};
    pose_.rotation = Eigen::AngleAxisd(Within(random, kPi), Eigen::Vector3d::UnitZ());
  }

  const Rigid3& Step(const Rigid3& last_from_now, double turn, Random& random) {
    const double meters = last_from_now.translation.norm();
    Rigid3 step = last_from_now;
    if (planar_) step = {Eigen::Quaterniond(Eigen::AngleAxisd(turn, Up())), {meters, 0.0, 0.0}};
    step.translation = scale_ * step.translation + 0.03 * meters * Flat(LaplaceVector(random));
    if (random.Uniform() < 0.002) step.translation += 0.02 * Flat(LaplaceVector(random));  // a slip
    const double yaw =
        (turn_scale_ - 1.0) * turn + yaw_per_meter_ * meters + 0.02 * turn * Laplace(random);
    step.rotation = (step.rotation * Eigen::AngleAxisd(yaw, Up())).normalized();
    pose_ = pose_ * step;
    return pose_;
  }

 private:
  static Eigen::Vector3d Up() { return Eigen::Vector3d::UnitZ(); }
  Eigen::Vector3d Flat(const Eigen::Vector3d& v) const {
    return planar_ ? Eigen::Vector3d(v.x(), v.y(), 0.0) : v;
  }

  bool planar_;
  double scale_;
  double turn_scale_;
  double yaw_per_meter_;
  Rigid3 pose_;
};

// Its own for each answer, with correlated parts.
PoseCovariance StatedCovariance(double sigma_m, Random& random) {
  PoseCovariance mix;
  for (double& entry : mix.reshaped()) entry = random.Gaussian();
  PoseVector sigmas;
  sigmas << sigma_m, sigma_m, sigma_m, sigma_m / 8, sigma_m / 8, sigma_m / 8;
  const PoseCovariance correlation =
      0.7 * PoseCovariance::Identity() + 0.05 * mix * mix.transpose();
  return sigmas.asDiagonal() * correlation * sigmas.asDiagonal();
}

PoseVector OffsetOfWrong(Random& random) {
  const double meters = 0.5 * std::pow(10.0, random.Uniform());
  const double bearing = Within(random, kPi);
  const double height = Within(random, 0.3) * meters;
  const bool turned = random.Below(2) == 0;
  PoseVector offset;
  offset << std::cos(bearing) * meters, std::sin(bearing) * meters, height, 0.0, 0.0,
      turned ? Within(random, 0.5) : 0.0;
  return offset;
}

class Answers {
 public:
  Answers(const DriveOptions& options, Random& random)
      : options_(options),
        sigma_m_(options.answer_sigma_m.value_or(0.03 * std::pow(5.0, random.Uniform()))),
        alias_begins_(options.aliased && random.Below(2) == 0
                          ? static_cast<int>(random.Below(options.moments - 120)) + 60
                          : options.moments),
        alias_length_(1 + static_cast<int>(random.Below(8))),
        alias_(OffsetOfWrong(random)),
        phase_(Within(random, kPi)) {}

  void Answer(int index, Moment& moment, Random& random) {
    moment.kind = Kind(index, random);
    if (moment.kind == AnswerKind::kNone) return;
    moment.answer.covariance = StatedCovariance(sigma_m_, random);
    moment.answer.map_from_body = Plus(moment.map_from_base, Error(moment, random));
    if (moment.kind == AnswerKind::kWrong) {
      moment.answer.map_from_body = Plus(moment.answer.map_from_body, OffsetOfWrong(random));
    }
    if (moment.kind == AnswerKind::kAliased) {
      moment.answer.map_from_body = Plus(moment.answer.map_from_body, alias_);
      moment.aliased_run_length = alias_length_;
    }
  }

 private:
  AnswerKind Kind(int index, Random& random) const {
    if (index >= alias_begins_ && index < alias_begins_ + alias_length_) {
      return AnswerKind::kAliased;
    }
    const double draw = random.Uniform();
    if (draw < options_.wrong_share) return AnswerKind::kWrong;
    return draw < options_.wrong_share + 0.1 ? AnswerKind::kNone : AnswerKind::kRight;
  }

  // Of a right answer. 2% have three times the error, and say nothing of it.
  PoseVector Error(const Moment& moment, Random& random) const {
    PoseVector draw;
    draw << LaplaceVector(random), LaplaceVector(random);
    const double size = random.Uniform() < 0.02 ? 3.0 : 0.95;
    PoseVector error = moment.answer.covariance.llt().matrixL() * (size * draw);
    const Eigen::Vector3d at = moment.map_from_base.translation;
    error.x() += options_.place_share * sigma_m_ * std::sqrt(2.0) * std::sin(at.x() / 3.0 + phase_);
    error.y() += options_.place_share * sigma_m_ * std::sqrt(2.0) * std::sin(at.y() / 3.0 - phase_);
    return error;
  }

  DriveOptions options_;
  double sigma_m_;
  int alias_begins_;
  int alias_length_;
  PoseVector alias_;
  double phase_;
};

void CarryAway(Course& course, Random& random) {
  const double meters = random.Uniform(2.0, 30.0);
  const double bearing = Within(random, kPi);
  course.x += std::cos(bearing) * meters;
  course.y += std::sin(bearing) * meters;
  course.yaw += Within(random, kPi);
}

}  // namespace

Drive SimulateDrive(const DriveOptions& options, Random random) {
  Drive drive;
  drive.planar_odometry = random.Below(2) == 0;
  drive.beyond_stated_drift = random.Below(10) == 0;
  Odometry odometry(drive.planar_odometry, drive.beyond_stated_drift ? 2.0 : 1.0, random);
  Answers answers(options, random);
  const bool is_carried = options.carried_away && random.Below(2) == 0;
  const int carried_at =
      is_carried ? 100 + static_cast<int>(random.Below(options.moments - 150)) : -1;
  Course course;
  course.yaw = Within(random, kPi);
  Rigid3 last = OnGround(course, random);
  for (int i = 0; i < options.moments; ++i) {
    Moment moment;
    const double yaw = course.yaw;
    course.Step(random);
    moment.map_from_base = OnGround(course, random);
    moment.odom_from_base =
        odometry.Step(last.Inverse() * moment.map_from_base, course.yaw - yaw, random);
    if (i == carried_at) {  // the wheels did not turn
      CarryAway(course, random);
      moment.map_from_base = OnGround(course, random);
      moment.carried_away = true;
    }
    last = moment.map_from_base;
    answers.Answer(i, moment, random);
    drive.moments.push_back(moment);
  }
  return drive;
}

}  // namespace maploc::testing
