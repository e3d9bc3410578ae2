// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Deskew.h>
#include <dyslam/nets/DyloMatcher.h>
#include <dyslam/nets/DyloModel.h>
#include <dyslam/nets/Threads.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace dyslam
{
namespace
{
constexpr std::size_t sampled_level = 1;

// How far the motion found lies from the one that a scan was deskewed with [m, at a lever of 10 m]:
constexpr double seen_bend = 0.005;     //!< worth taking back
constexpr double far_bend = 0.3;        //!< points are elsewhere in the image
constexpr double farthest_motion = 10;  //!< not to be believed
constexpr int most_layouts = 4;
constexpr std::int64_t point_grain = 4096;  //!< worth a thread

/** A residual that may come from noise and the sampling of surfaces [m]. */
double inlierDistance(double range)
{
  return 0.15 + 0.005 * range;
}

/** A point of level 1 and its static confidence; what was not matched is out of reach. */
struct SampledNode
{
  Eigen::Vector3f point = Eigen::Vector3f::Constant(1e6F);
  float confidence = 0;
};
}  // namespace

/** A scan, as it was given and as the network sees it. */
struct SeenScan
{
  std::vector<Eigen::Vector3f> points;
  std::vector<float> phase;
  Pose T_given = Pose::Identity();  //!< that `points` are deskewed with
  PreparedScan prepared;
  EncodedScan encoded;
  bool motion_known = false;  //!< `encoded` is deskewed with its own motion

  [[nodiscard]] bool empty() const { return prepared.empty(); }
  /** The given points, deskewed by `T_sweep` instead. */
  [[nodiscard]] std::vector<Eigen::Vector3f> sweptBy(const Pose& T_sweep) const;
  /** Image and levels deskewed by `T_sweep`; which points they hold, and their features, stay. */
  void bend(const Pose& T_sweep);
};

std::vector<Eigen::Vector3f> SeenScan::sweptBy(const Pose& T_sweep) const
{
  const SweepMotion given(T_given, 0);
  const SweepMotion wanted(T_sweep, 0);
  std::vector<Eigen::Vector3f> swept(points.size());
  forRows(static_cast<std::int64_t>(points.size()), point_grain,
          [&](std::int64_t first, std::int64_t last)
          {
            for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i)
            {
              swept[i] = wanted.toReference(given.toReference(points[i], -phase[i]), phase[i]);
            }
          });
  return swept;
}

void SeenScan::bend(const Pose& T_sweep)
{
  const SweepMotion given(T_given, 0);
  const SweepMotion wanted(T_sweep, 0);
  const auto bendCell = [&](std::size_t cell)
  {
    if (prepared.source[cell] >= 0)
    {
      const auto i = static_cast<std::size_t>(prepared.source[cell]);
      prepared.points[cell] = wanted.toReference(given.toReference(points[i], -phase[i]), phase[i]);
    }
  };
  forRows(static_cast<std::int64_t>(prepared.source.size()), point_grain,
          [&](std::int64_t first, std::int64_t last)
          {
            for (std::int64_t cell = first; cell < last; ++cell)
            {
              bendCell(static_cast<std::size_t>(cell));
            }
          });
  movePoints(prepared, encoded.scan);
  encoded.T_sweep = T_sweep;
}

struct DyloMatcher::Impl
{
  DyloNetwork network{nullptr};
  int threads = 1;
  SeenScan current, reference;
  std::vector<SampledNode> nodes;  //!< of the last match

  void layOut(SeenScan& scan, const std::vector<Eigen::Vector3f>& points, const Pose& T_sweep);
  std::vector<DyloStage> search(const Pose& start, bool deskew, const DyloPrior* prior);
  void keepConfidence(const DyloStage& stage);
  /** Confidence of the points [first, last), all seen around `node`, by it and its neighbours. */
  void blendAround(std::int32_t node,
                   const std::int32_t* first,
                   const std::int32_t* last,
                   std::vector<float>& confidence) const;
};

DyloMatcher::DyloMatcher(const std::string& weights, int threads) : impl_(std::make_unique<Impl>())
{
  impl_->network = loadDylo(weights);
  impl_->network->eval();
  impl_->threads = threads;
}

DyloMatcher::~DyloMatcher() = default;
DyloMatcher::DyloMatcher(DyloMatcher&&) noexcept = default;
DyloMatcher& DyloMatcher::operator=(DyloMatcher&&) noexcept = default;

void DyloMatcher::Impl::layOut(SeenScan& scan,
                               const std::vector<Eigen::Vector3f>& points,
                               const Pose& T_sweep)
{
  scan.prepared = prepareScan(points);
  scan.encoded = EncodedScan();
  if (scan.prepared.empty())
  {
    return;
  }
  scan.encoded = network->encode(toTensors(scan.prepared));
  scan.encoded.T_sweep = T_sweep;
  if (scan.phase.empty())
  {
    return;
  }
  const std::vector<std::int32_t>& source = scan.prepared.source;
  scan.encoded.image_phase = torch::zeros({static_cast<std::int64_t>(source.size())});
  float* of_cell = scan.encoded.image_phase.data_ptr<float>();
  for (std::size_t cell = 0; cell < source.size(); ++cell)
  {
    if (source[cell] >= 0)
    {
      of_cell[cell] = scan.phase[static_cast<std::size_t>(source[cell])];
    }
  }
  for (std::size_t l = 0; l < scan.encoded.phase.size(); ++l)
  {
    const std::vector<std::int32_t>& cells = scan.prepared.levels[l].cell;
    torch::Tensor phase = torch::zeros({static_cast<std::int64_t>(cells.size())});
    for (std::size_t n = 0; n < cells.size(); ++n)
    {
      if (cells[n] >= 0)
      {
        phase.data_ptr<float>()[n] = of_cell[cells[n]];
      }
    }
    scan.encoded.phase[l] = phase;
  }
}

std::size_t DyloMatcher::setCurrent(const std::vector<Eigen::Vector3f>& points,
                                    const std::vector<float>& phase,
                                    const Pose& T_sweep)
{
  const torch::NoGradGuard no_grad;
  Impl& s = *impl_;
  useTorchThreads(s.threads);
  s.current.points = points;
  s.current.phase = phase.size() == points.size() ? phase : std::vector<float>();
  s.current.T_given = T_sweep;
  s.current.motion_known = s.current.phase.empty();
  s.nodes.clear();
  s.layOut(s.current, points, T_sweep);
  return s.current.prepared.valid_points;
}

void DyloMatcher::keepAsReference(const std::optional<Pose>& T_sweep)
{
  Impl& s = *impl_;
  SeenScan& scan = s.current;
  if (T_sweep && !scan.motion_known && !scan.empty())
  {
    scan.motion_known = true;
    if (motionSize(logSE3(scan.encoded.T_sweep.inverse() * *T_sweep)) > seen_bend)
    {
      scan.bend(*T_sweep);
    }
  }
  s.reference = scan;
}

void DyloMatcher::forgetReference()
{
  impl_->reference = SeenScan();
}

/** Where a scan was bent too much to be straightened in its place, it is laid out anew: the current
 * one for good, the reference only for this search, for the motion found may yet be refused. */
std::vector<DyloStage> DyloMatcher::Impl::search(const Pose& start,
                                                 bool deskew,
                                                 const DyloPrior* prior)
{
  SeenScan straightened;
  const SeenScan* against = &reference;
  Pose found = start;
  for (int layouts = 1;; ++layouts)
  {
    EncodedScan scan1 = current.encoded;
    if (!deskew || !against->motion_known)
    {
      // Bent alike, two scans fit best.
      scan1.phase = {};
      scan1.image_phase = torch::Tensor();
    }
    std::vector<DyloStage> stages =
        network->forward(scan1, against->encoded, PoseTensors::from(found, torch::kFloat), prior);
    found = stages.back().pose.toPose();
    const double apart = motionSize(logSE3(current.encoded.T_sweep.inverse() * found));
    if (layouts == most_layouts || !deskew || current.phase.empty() || apart > farthest_motion ||
        (against->motion_known && apart < far_bend))
    {
      return stages;
    }
    if (!against->motion_known)
    {
      straightened = reference;
      layOut(straightened, reference.sweptBy(found), found);
      straightened.motion_known = true;
      against = &straightened;
    }
    layOut(current, current.sweptBy(found), found);
  }
}

DyloMatch DyloMatcher::match(const Pose& start, bool deskew, const DyloPrior* prior)
{
  const torch::NoGradGuard no_grad;
  Impl& s = *impl_;
  DyloMatch match;
  match.T_reference_current = start;
  if (s.reference.empty() || s.current.empty())
  {
    return match;
  }
  useTorchThreads(s.threads);
  const std::vector<DyloStage> stages = s.search(start, deskew, prior);
  const DyloStage& last = stages.back();
  const Pose before = stages[stages.size() - 2].pose.toPose();
  match.T_reference_current = last.pose.toPose();
  match.last_step = motionSize(logSE3(before.inverse() * match.T_reference_current));

  if (last.normal_matrix.defined())
  {
    const torch::Tensor normal = last.normal_matrix.to(torch::kDouble).contiguous();
    const Matrix6 left =
        Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(normal.data_ptr<double>());
    // The network's step stands on the left of the motion.
    const Matrix6 adjoint = adjointSE3(match.T_reference_current);
    match.normal_matrix = adjoint.transpose() * left * adjoint;
  }
  // How well the points lie on the surfaces matched, at the pose found.
  const torch::Tensor moved = last.pose.apply(last.points);
  const torch::Tensor residual = (last.normal * moved).sum(1) - last.offset;
  const torch::Tensor range = moved.norm(2, 1);
  const float* r = residual.data_ptr<float>();
  const float* w = last.weight.data_ptr<float>();
  const float* valid = last.valid.data_ptr<float>();
  const ScanTensors::Level& sampled = s.current.encoded.scan.levels[last.level];
  match.sampled = static_cast<std::size_t>(sampled.valid.sum().item<double>() + 0.5);
  const float* distance = range.data_ptr<float>();
  double squares = 0;
  double weight_squares = 0;
  for (std::int64_t i = 0; i < residual.size(0); ++i)
  {
    if (valid[i] == 0)
    {
      continue;
    }
    const double error = static_cast<double>(r[i]);
    const double weight = static_cast<double>(w[i]);
    ++match.matched;
    match.inliers += std::abs(error) < inlierDistance(static_cast<double>(distance[i])) ? 1U : 0U;
    squares += weight * error * error;
    weight_squares += weight * weight;
  }
  match.rmse = std::sqrt(squares);
  match.effective_points = weight_squares > 0 ? 1 / weight_squares : 0;
  s.keepConfidence(last);
  return match;
}

void DyloMatcher::Impl::keepConfidence(const DyloStage& stage)
{
  nodes.clear();
  if (stage.level != sampled_level)
  {
    return;
  }
  const torch::Tensor confidence = torch::sigmoid(stage.logits.is_static).contiguous();
  const float* c = confidence.data_ptr<float>();
  const float* valid = stage.valid.data_ptr<float>();
  const PreparedScan& prepared = current.prepared;
  const PreparedScan::Level& level = prepared.levels[sampled_level];
  nodes.resize(level.size());
  for (std::size_t n = 0; n < level.size(); ++n)
  {
    if (level.cell[n] >= 0 && valid[n] > 0)
    {
      const auto point = prepared.source[static_cast<std::size_t>(level.cell[n])];
      nodes[n] = {current.points[static_cast<std::size_t>(point)], c[n]};
    }
  }
}

void DyloMatcher::Impl::blendAround(std::int32_t node,
                                    const std::int32_t* first,
                                    const std::int32_t* last,
                                    std::vector<float>& confidence) const
{
  constexpr int lanes = 8;  // points at a time
  using Lanes = Eigen::Array<float, lanes, 1>;
  constexpr float softness = 0.002F;
  constexpr float at_reach = 1 / (softness + 1);
  const PreparedScan::Level& level = current.prepared.levels[sampled_level];
  const int row = node / level.cols;
  const int col = node % level.cols;
  Eigen::Array<float, lanes, 3> p = Eigen::Array<float, lanes, 3>::Zero();
  for (; first < last; first += lanes)
  {
    const auto count = std::min<std::ptrdiff_t>(lanes, last - first);
    for (std::ptrdiff_t k = 0; k < count; ++k)
    {
      p.row(k) = current.points[static_cast<std::size_t>(first[k])];
    }
    const Lanes reach = 0.5F + 0.05F * p.square().rowwise().sum().sqrt();
    const Lanes scale = reach.square().inverse();
    Lanes weight_sum = Lanes::Zero();
    Lanes sum = Lanes::Zero();
    for (int i = std::max(0, row - 1); i <= std::min(level.rows - 1, row + 1); ++i)
    {
      for (int j = col - 1; j <= col + 1; ++j)
      {
        const int wrapped = (j + level.cols) % level.cols;
        const SampledNode& near = nodes[static_cast<std::size_t>(i * level.cols + wrapped)];
        const Lanes d2 =
            ((p.col(0) - near.point.x()).square() + (p.col(1) - near.point.y()).square() +
             (p.col(2) - near.point.z()).square()) *
            scale;
        const Lanes weight = ((softness + d2.square()).inverse() - at_reach).max(0.F);
        weight_sum += weight;
        sum += weight * near.confidence;
      }
    }
    for (std::ptrdiff_t k = 0; k < count; ++k)
    {
      confidence[static_cast<std::size_t>(first[k])] =
          weight_sum[k] > 0 ? sum[k] / weight_sum[k] : 1.F;
    }
  }
}

std::vector<float> DyloMatcher::staticConfidence() const
{
  const Impl& s = *impl_;
  std::vector<float> confidence(s.current.points.size(), 1.F);
  if (s.nodes.empty())
  {
    return confidence;
  }
  // Points in the order of the nodes they were seen around.
  const PreparedScan& prepared = s.current.prepared;
  const PreparedScan::Level& level = prepared.levels[sampled_level];
  std::vector<std::int32_t> node_of(confidence.size(), -1);
  std::vector<std::int32_t> end(level.size() + 1, 0);
  for (std::size_t i = 0; i < node_of.size(); ++i)
  {
    const std::int32_t cell = prepared.cell_of_point[i];
    if (cell >= 0)
    {
      const int row = cell / PreparedScan::columns * level.rows / prepared.rows;
      const int col = cell % PreparedScan::columns * level.cols / PreparedScan::columns;
      node_of[i] = row * level.cols + col;
      ++end[static_cast<std::size_t>(node_of[i]) + 1];
    }
  }
  std::partial_sum(end.begin(), end.end(), end.begin());
  std::vector<std::int32_t> ordered(static_cast<std::size_t>(end.back()));
  for (std::size_t i = 0; i < node_of.size(); ++i)
  {
    if (node_of[i] >= 0)
    {
      const auto place = end[static_cast<std::size_t>(node_of[i])]++;
      ordered[static_cast<std::size_t>(place)] = static_cast<std::int32_t>(i);
    }
  }
  useTorchThreads(s.threads);
  forRows(static_cast<std::int64_t>(level.size()), 64,
          [&](std::int64_t first, std::int64_t last)
          {
            for (auto n = static_cast<std::size_t>(first); n < static_cast<std::size_t>(last); ++n)
            {
              const std::int32_t begin = n == 0 ? 0 : end[n - 1];
              s.blendAround(static_cast<std::int32_t>(n), ordered.data() + begin,
                            ordered.data() + end[n], confidence);
            }
          });
  return confidence;
}
}  // namespace dyslam
