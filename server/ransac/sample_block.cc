#include "server/ransac/sample_block.h"

#include <cmath>
namespace maploc {

template <int kVectors>
void SampleBlock::Arrays<kVectors>::Add(
    const Sample& sample, const std::array<const Eigen::Vector3d*, kVectors>& values) {
  samples[count] = sample;
  for (int v = 0; v < kVectors; ++v) {
    for (int axis = 0; axis < 3; ++axis) vectors[v][axis][count] = (*values[v])[axis];
  }
  ++count;
}

template <int kVectors>
void SampleBlock::Arrays<kVectors>::Get(int place, const PreparedProblem& prepared,
                                        Hypotheses& out) const {
  out.sample = samples[place];
  for (const auto& of_root : poses) {
    // The batched solvers' mark for a root that does not exist, or has a depth that is not
    // positive.
    if (std::isnan(of_root[0][place])) continue;
    const AlignedPose pose = {{of_root[0][place], of_root[1][place]},
                              {of_root[2][place], of_root[3][place], of_root[4][place]}};
    out.camera_from_centred[out.count++] = CameraFromCentred(prepared, pose);
  }
}

void SampleBlock::Clear() {
  size_ = 0;
  two_points_.count = 0;
  point_and_line_.count = 0;
  solved_.clear();
}

void SampleBlock::AddTwoPoints(const Sample& sample) {
  const PreparedPoint& a = prepared_.points[sample.points[0]];
  const PreparedPoint& b = prepared_.points[sample.points[1]];
  Add(Kind::kTwoPoints, two_points_.count);
  two_points_.Add(sample, {&a.ray_in_aligned, &a.position, &b.ray_in_aligned, &b.position});
}

void SampleBlock::AddPointAndLine(const Sample& sample) {
  const PreparedPoint& p = prepared_.points[sample.points[0]];
  const PreparedLine& l = prepared_.lines[sample.lines[0]];
  Add(Kind::kPointAndLine, point_and_line_.count);
  point_and_line_.Add(
      sample, {&p.ray_in_aligned, &p.position, &l.plane_normal_in_aligned, &l.point, &l.direction});
}

void SampleBlock::AddSolved(const Hypotheses& hypotheses) {
  Add(Kind::kSolved, static_cast<int>(solved_.size()));
  solved_.push_back(hypotheses);
}

int SampleBlock::Solve(double min_conditioning) {
  const Up2pArrays pairs = {two_points_.In(0),
                            two_points_.In(1),
                            two_points_.In(2),
                            two_points_.In(3),
                            static_cast<std::size_t>(two_points_.count),
                            min_conditioning};
  const Up1p1lArrays with_line = {
      point_and_line_.In(0), point_and_line_.In(1), point_and_line_.In(2),
      point_and_line_.In(3), point_and_line_.In(4), static_cast<std::size_t>(point_and_line_.count),
      min_conditioning};
  return static_cast<int>(
      SolveUp2pBatch(pairs, two_points_.Out(0), two_points_.Out(1)) +
      SolveUp1p1lBatch(with_line, point_and_line_.Out(0), point_and_line_.Out(1)));
}

const Hypotheses& SampleBlock::At(int i) {
  const Entry& entry = entries_[i];
  current_.count = 0;
  switch (entry.kind) {
    case Kind::kRejected:
      break;
    case Kind::kTwoPoints:
      two_points_.Get(entry.place, prepared_, current_);
      break;
    case Kind::kPointAndLine:
      point_and_line_.Get(entry.place, prepared_, current_);
      break;
    case Kind::kSolved:
      return solved_[entry.place];
  }
  return current_;
}

}  // namespace maploc
