// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/StateArchive.h>
#include <dyslam/core/Deskew.h>
#include <dyslam/nets/DyloFile.h>
#include <dyslam/nets/DyloMatcher.h>
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

// Limits of the difference between the estimated motion and the deskewing's, as motionSize() [m].
constexpr double min_redeskew = 0.005;  //!< differences below: points are not re-deskewed
constexpr double max_redeskew = 0.3;    //!< differences above: the range image is computed again
constexpr double max_motion = 10;  //!< differences above: the estimate is not used for deskewing
constexpr int max_encodings = 4;
/** Relative difference of two scan periods that is ignored: the first and the last point of a
 * revolution are a little less than it apart. */
constexpr float same_period = 0.01F;
constexpr std::int64_t point_grain = 4096;  //!< least number of points per thread

/** Largest residual due to noise and surface sampling [m]. */
double inlierDistance(double range)
{
  return 0.15 + 0.005 * range;
}

/** A point of level 1 and its static confidence; unmatched points are placed out of reach. */
struct SampledNode
{
  Eigen::Vector3f point = Eigen::Vector3f::Constant(1e6F);
  float confidence = 0;
};
}  // namespace

/** A scan as given and as encoded. */
struct MatcherScan
{
  std::vector<Eigen::Vector3f> points;
  std::vector<float> phase;
  double phase_unit = 0;            //!< as of DyloMatcher::setCurrent() [s]
  Pose T_given = Pose::Identity();  //!< motion with which `points` are deskewed
  PreparedScan prepared;
  EncodedScan encoded;
  bool motion_known = false;  //!< `encoded` is deskewed with the scan's own motion
  // How `encoded` was computed, to compute it again:
  std::optional<Pose> T_encoded;  //!< motion of deskewedBy() before encoding; none: from `points`
  std::optional<Pose> T_redeskewed;  //!< motion of redeskew() after encoding, if any

  [[nodiscard]] bool empty() const { return prepared.empty(); }
  /** Converts `phase` and T_given to a scan period of `unit` seconds; leaves them as they are if
   * either period is unknown, or if they hardly differ. */
  void rescalePhase(double unit);
  /** `points`, deskewed by `T_sweep` instead of T_given. */
  [[nodiscard]] std::vector<Eigen::Vector3f> deskewedBy(const Pose& T_sweep) const;
  /** Re-deskews the points of image and levels by `T_sweep`; their selection and features stay. */
  void redeskew(const Pose& T_sweep);
};

void MatcherScan::rescalePhase(double unit)
{
  const float scale = phaseScale(phase_unit, unit);
  if (std::abs(scale - 1) < same_period)
  {
    return;
  }
  for (float& p : phase)
  {
    p *= scale;
  }
  T_given = expSE3(logSE3(T_given) / static_cast<double>(scale));
  phase_unit = unit;
}

std::vector<Eigen::Vector3f> MatcherScan::deskewedBy(const Pose& T_sweep) const
{
  const SweepMotion given(T_given, 0);
  const SweepMotion wanted(T_sweep, 0);
  std::vector<Eigen::Vector3f> deskewed(points.size());
  forRows(static_cast<std::int64_t>(points.size()), point_grain,
          [&](std::int64_t first, std::int64_t last)
          {
            for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i)
            {
              deskewed[i] = wanted.toReference(given.toReference(points[i], -phase[i]), phase[i]);
            }
          });
  return deskewed;
}

void MatcherScan::redeskew(const Pose& T_sweep)
{
  const SweepMotion given(T_given, 0);
  const SweepMotion wanted(T_sweep, 0);
  const auto redeskewCell = [&](std::size_t cell)
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
              redeskewCell(static_cast<std::size_t>(cell));
            }
          });
  updatePoints(prepared, encoded.scan);
  encoded.T_sweep = T_sweep;
  T_redeskewed = T_sweep;
}

struct DyloMatcher::Impl
{
  explicit Impl(int threads) : pool(threads) {}

  DyloNetwork network{nullptr};
  ThreadPool pool;
  MatcherScan current, reference;
  std::vector<SampledNode> nodes;  //!< nodes of the current scan in the last match

  void encodeScan(MatcherScan& scan,
                  const std::vector<Eigen::Vector3f>& points,
                  const Pose& T_sweep);
  std::vector<DyloStage> search(const Pose& start, bool deskew, const DyloPrior* prior);
  void storeConfidence(const DyloStage& stage);
  /** Interpolates the confidence of the points [first, last) of `node` from this node and its
   * neighbours. */
  void interpolateConfidence(std::int32_t node,
                             const std::int32_t* first,
                             const std::int32_t* last,
                             std::vector<float>& confidence) const;
};

DyloMatcher::DyloMatcher(const std::string& weights, int threads)
    : impl_(std::make_unique<Impl>(threads))
{
  impl_->network = loadDylo(weights);
  impl_->network->eval();
}

DyloMatcher::~DyloMatcher() = default;
DyloMatcher::DyloMatcher(DyloMatcher&&) noexcept = default;
DyloMatcher& DyloMatcher::operator=(DyloMatcher&&) noexcept = default;

void DyloMatcher::Impl::encodeScan(MatcherScan& scan,
                                   const std::vector<Eigen::Vector3f>& points,
                                   const Pose& T_sweep)
{
  scan.prepared = prepareScan(points);
  scan.encoded = EncodedScan();
  scan.T_redeskewed.reset();
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
                                    const Pose& T_sweep,
                                    double phase_unit)
{
  const torch::NoGradGuard no_grad;
  Impl& s = *impl_;
  const LoopsOnPool loops(s.pool);
  s.current.points = points;
  s.current.phase = phase.size() == points.size() ? phase : std::vector<float>();
  s.current.phase_unit = phase_unit;
  s.current.T_given = T_sweep;
  s.current.motion_known = s.current.phase.empty();
  s.current.T_encoded.reset();
  s.nodes.clear();
  s.encodeScan(s.current, points, T_sweep);
  return s.current.prepared.valid_points;
}

void DyloMatcher::keepAsReference(const std::optional<Pose>& T_sweep)
{
  Impl& s = *impl_;
  const LoopsOnPool loops(s.pool);
  MatcherScan& scan = s.current;
  if (T_sweep && !scan.motion_known && !scan.empty())
  {
    scan.motion_known = true;
    if (motionSize(logSE3(scan.encoded.T_sweep.inverse() * *T_sweep)) > min_redeskew)
    {
      scan.redeskew(*T_sweep);
    }
  }
  s.reference = scan;
}

void DyloMatcher::exchangeState(StateArchive& archive)
{
  const torch::NoGradGuard no_grad;
  Impl& s = *impl_;
  MatcherScan& scan = s.reference;
  archive(scan.points, scan.phase, scan.phase_unit, scan.T_given, scan.motion_known, scan.T_encoded,
          scan.T_redeskewed);
  if (!archive.isLoading())
  {
    return;
  }
  const LoopsOnPool loops(s.pool);
  const std::optional<Pose> T_redeskewed = scan.T_redeskewed;
  if (scan.T_encoded)
  {
    s.encodeScan(scan, scan.deskewedBy(*scan.T_encoded), *scan.T_encoded);
  }
  else
  {
    s.encodeScan(scan, scan.points, scan.T_given);
  }
  if (T_redeskewed)
  {
    scan.redeskew(*T_redeskewed);
  }
}

/** Matches, re-deskews by the estimate and repeats. A scan whose deskewing changes too much to keep
 * its range image is encoded again: the current scan permanently, the reference only for this
 * match, because the estimate may still be rejected. */
std::vector<DyloStage> DyloMatcher::Impl::search(const Pose& start,
                                                 bool deskew,
                                                 const DyloPrior* prior)
{
  MatcherScan redeskewed_reference;
  const MatcherScan* target = &reference;
  Pose estimate = start;
  for (int encodings = 1;; ++encodings)
  {
    EncodedScan scan1 = current.encoded;
    if (!deskew || !target->motion_known)
    {
      // Two scans with the same distortion match best.
      scan1.phase = {};
      scan1.image_phase = torch::Tensor();
    }
    std::vector<DyloStage> stages =
        network->forward(scan1, target->encoded, PoseTensors::from(estimate, torch::kFloat), prior);
    estimate = stages.back().pose.toPose();
    const double difference = motionSize(logSE3(current.encoded.T_sweep.inverse() * estimate));
    if (encodings == max_encodings || !deskew || current.phase.empty() || difference > max_motion ||
        (target->motion_known && difference < max_redeskew))
    {
      return stages;
    }
    if (!target->motion_known)
    {
      redeskewed_reference = reference;
      // The estimate is a motion over the current scan's period, which may be another one.
      redeskewed_reference.rescalePhase(current.phase_unit);
      encodeScan(redeskewed_reference, redeskewed_reference.deskewedBy(estimate), estimate);
      redeskewed_reference.motion_known = true;
      target = &redeskewed_reference;
    }
    encodeScan(current, current.deskewedBy(estimate), estimate);
    current.T_encoded = estimate;
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
  const LoopsOnPool loops(s.pool);
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
    // The network's increment is on the left of the motion.
    const Matrix6 adjoint = adjointSE3(match.T_reference_current);
    match.normal_matrix = adjoint.transpose() * left * adjoint;
  }
  // Residuals at the estimated pose.
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
  s.storeConfidence(last);
  return match;
}

void DyloMatcher::Impl::storeConfidence(const DyloStage& stage)
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

void DyloMatcher::Impl::interpolateConfidence(std::int32_t node,
                                              const std::int32_t* first,
                                              const std::int32_t* last,
                                              std::vector<float>& confidence) const
{
  constexpr int lanes = 8;  // points per iteration
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
  // Counting sort of the points by node.
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
  const LoopsOnPool loops(impl_->pool);
  forRows(static_cast<std::int64_t>(level.size()), 64,
          [&](std::int64_t first, std::int64_t last)
          {
            for (auto n = static_cast<std::size_t>(first); n < static_cast<std::size_t>(last); ++n)
            {
              const std::int32_t begin = n == 0 ? 0 : end[n - 1];
              s.interpolateConfidence(static_cast<std::int32_t>(n), ordered.data() + begin,
                                      ordered.data() + end[n], confidence);
            }
          });
  return confidence;
}
}  // namespace dyslam
