// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Parallel.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/StateArchive.h>
#include <dyslam/mapping/HindsightLabels.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "ClearVoxels.h"
#include "GroundHeights.h"
#include "Posts.h"
#include "RayHistory.h"
#include "RecentScores.h"
#include "ScanVisibility.h"
#include "Segments.h"
#include "VoxelClassifier.h"
#include "VoxelFeatures.h"

namespace dyslam
{
namespace
{
constexpr float lowest_of_object = 0.1F;  // over the ground of a large square [m]
constexpr float lowest_of_part = 0.05F;   // and over that of a small one [m]
constexpr int cells_above = 3;            // that decide whether a low point moves
constexpr std::size_t ground_stride = 5;  // scans of the window between those used for the ground
constexpr int past_stride = 8;            // scans before the window between those that are used
constexpr double growth = 1.1;            // of the distances to those that are used
constexpr float full_change = 3;          // free observations of a voxel that suffice
constexpr float suspicious = 0.1F;        // causal probability of voxels that may be moving
constexpr float doubtful_score = -2;      // of voxels that may be moving
constexpr float post_score = 2.5F;        // by which the voxels of a post are less likely to move

/** Distances to the scans that are used: all near ones, fewer far ones. */
std::vector<int> scanOffsets(int window)
{
  std::vector<int> offsets;
  for (int o = 1; o <= window; o += std::clamp(o / 2, 1, 5))
  {
    offsets.push_back(o);
  }
  return offsets;
}

/** Fraction of the sufficient number of scans, at most 1. */
float shareOf(std::uint16_t scans)
{
  return std::min(1.0F, static_cast<float>(scans) / full_change);
}

/** One scan of the window. */
struct WindowScan
{
  WindowScan() = default;
  WindowScan(const Frame& given, FrameParts kept)
      : index(given.index),
        T_odom_vehicle(given.T_odom_vehicle),
        rays(given.scan, given.cloud),
        lowest(given.cloud.points, T_odom_vehicle.cast<float>())
  {
    if (kept != FrameParts::none)
    {
      frame = copyOf(given, kept);
    }
  }

  std::optional<Frame> frame;  //!< none if it is not kept, and once it is decided
  std::size_t index = 0;       //!< Frame::index
  Pose T_odom_vehicle = Pose::Identity();
  ScanVisibility rays;
  LowestReturns lowest;

  void exchangeState(StateArchive& archive) { archive(frame, index, T_odom_vehicle, rays, lowest); }
};

/** Tracks with a property that they keep: to the last Frame::index at which each was there. */
class LastingTracks
{
 public:
  void note(int id, bool has_property, std::size_t frame)
  {
    if (has_property || contain(id))
    {
      last_[id] = frame;
    }
  }
  [[nodiscard]] bool contain(int id) const { return last_.count(id) != 0; }
  void forgetBefore(std::size_t frame)
  {
    for (auto track = last_.begin(); track != last_.end();)
    {
      track = track->second < frame ? last_.erase(track) : std::next(track);
    }
  }
  void exchangeState(StateArchive& archive) { archive(last_); }

 private:
  std::map<int, std::size_t> last_;
};

/** One of the scans before the window. */
struct EarlierScan
{
  std::size_t number;  //!< as they were added
  Pose T_odom_vehicle;
  ScanVisibility rays;
};

/** Decision of the voxels of a cell. */
struct CellMotion
{
  int balance = 0;                    //!< number of moving minus static voxels
  double moving = 0, stationary = 0;  //!< sums of their probabilities
  int moving_voxels = 0, static_voxels = 0;

  void add(float probability)
  {
    const bool moves = probability > 0.5F;
    balance += moves ? 1 : -1;
    (moves ? moving : stationary) += probability;
    ++(moves ? moving_voxels : static_voxels);
  }
  [[nodiscard]] bool moves() const { return balance > 0; }
  /** Mean of the voxels that agree with moves(). */
  [[nodiscard]] float probability() const
  {
    return static_cast<float>(moves() ? moving / moving_voxels
                                      : stationary / std::max(1, static_voxels));
  }
};

/** Probability of each voxel that its points move. \param keys of the voxels \param points of
 * the scan, odometry frame [m] */
std::vector<float> probabilitiesOf(const std::vector<VoxelFeatures>& features,
                                   const std::vector<std::uint64_t>& keys,
                                   const std::vector<Eigen::Vector3f>& points,
                                   RecentScores& recent)
{
  std::vector<Eigen::Vector3f> voxels;
  voxels.reserve(features.size());
  for (const VoxelFeatures& f : features)
  {
    voxels.push_back(points[f.point]);
  }
  const Posts posts(voxels);
  std::vector<float> probability;
  probability.reserve(features.size());
  for (std::size_t g = 0; g < features.size(); ++g)
  {
    float score = movingScore(features[g]);
    if (score > doubtful_score && posts.contain(g))
    {
      score -= post_score;
    }
    probability.push_back(1 / (1 + std::exp(-recent.smooth(keys[g], score))));
  }
  return probability;
}

/** Points below `ground_clearance`, which have no voxel, are moving if the points above them are.
 */
void adaptLow(const Segments& segments,
              const std::vector<float>& voxel_probability,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& heights,
              const std::vector<const LowestReturns*>& scans,
              std::vector<float>& probability)
{
  std::vector<CellMotion> cells(segments.cells.size());
  for (std::size_t g = 0; g < voxel_probability.size(); ++g)
  {
    cells[segments.cell_of_voxel[g]].add(voxel_probability[g]);
  }
  std::vector<std::uint32_t> low;
  std::vector<Eigen::Vector3f> low_points;
  std::vector<float> low_heights;
  for (std::uint32_t i = 0; i < points.size(); ++i)
  {
    if (segments.voxel_of_point[i] == Segments::none && heights[i] > lowest_of_object)
    {
      low.push_back(i);
      low_points.push_back(points[i]);
      low_heights.push_back(heights[i]);
    }
  }
  const std::vector<float> fine = fineHeightsOverGround(scans, low_points, low_heights);
  for (std::size_t k = 0; k < low.size(); ++k)
  {
    for (int above = 0; above < cells_above && fine[k] > lowest_of_part; ++above)
    {
      const Eigen::Vector3f p =
          low_points[k] +
          Eigen::Vector3f(0, 0, static_cast<float>(above) / segments.inverse_cell_size);
      const std::uint32_t cell =
          segments.cell_index.find(voxelKey(voxelCell(p, segments.inverse_cell_size)));
      if (cell != VoxelHash::none)
      {
        probability[low[k]] = std::max(probability[low[k]], cells[cell].probability());
      }
    }
  }
}
}  // namespace

void HindsightOptions::describe(OptionsVisitor& v)
{
  v.flag("hindsight", hindsight, "label moving points from earlier and later scans");
  v.integer("window", window, 1, 1000,
            "number of scans used before, and after, the scan that is labelled");
  v.integer("history", history, 0, 100000,
            "number of scans before the window of which every eighth is used");
  v.real("voxel_size", voxel_size, 0.01, 10, "side of the voxels that accumulate evidence [m]");
  v.real("segment_gap", segment_gap, 0.01, 10,
         "side of the cells that are clustered to segments [m]");
  v.real("margin", margin, 0.01, 10,
         "least distance that a ray ends behind a voxel to observe it as free [m]");
  v.real("moving_threshold", moving_threshold, 0, 1,
         "moving probability above which a point is moving in labels, map and replay");
  v.real("ground_clearance", ground_clearance, 0, 10,
         "height above ground up to which returns are ground [m]");
}

struct HindsightLabels::Impl
{
  Impl(const HindsightOptions& given, int threads)
      : options(given), offsets(scanOffsets(given.window)), pool(threads)
  {
    validate(options, "labels");
  }

  /** Of the scan to be decided, as they were added. */
  [[nodiscard]] std::size_t numberOfNext() const { return count - (scans.size() - next); }
  void decideNext(const Use& use);
  void decide(WindowScan& scan);
  void outputNext(const Use& use);
  [[nodiscard]] std::vector<const LowestReturns*> lowestReturns() const;
  [[nodiscard]] std::vector<OtherScan> others() const;
  [[nodiscard]] std::vector<float> trackedShare(const Frame& frame) const;
  [[nodiscard]] std::vector<VoxelEvidence> causalEvidence(const Segments& segments) const;
  void addRays(const Segments& segments,
               const std::vector<float>& heights,
               std::vector<VoxelEvidence>& evidence);
  void noteTracks(const Frame& frame);
  void leaveWindow();

  HindsightOptions options;
  std::vector<int> offsets;
  ThreadPool pool;
  std::deque<WindowScan> scans;
  std::deque<EarlierScan> past;  //!< some of those before the window
  std::size_t next = 0;          //!< of `scans`, to be decided
  std::size_t count = 0;         //!< of all scans added
  ClearVoxels clear;
  RecentScores recent;
  LastingTracks dynamic;  //!< have been at some time
  LastingTracks reported;
};

/** The ground as the scan to be decided and others of the window show it. */
std::vector<const LowestReturns*> HindsightLabels::Impl::lowestReturns() const
{
  std::vector<const LowestReturns*> lowest;
  for (std::size_t i = next % ground_stride; i < scans.size(); i += ground_stride)
  {
    lowest.push_back(&scans[i].lowest);
  }
  return lowest;
}

/** The scans that are used, those before and those after each in order of their distance. */
std::vector<OtherScan> HindsightLabels::Impl::others() const
{
  const Pose& here = scans[next].T_odom_vehicle;
  std::vector<OtherScan> result;
  const auto ask = [&](const Pose& there, const ScanVisibility& rays, bool after)
  {
    const Eigen::Isometry3f T = (there.inverse() * here).cast<float>();
    result.push_back({&rays, T, after});
  };
  for (const int offset : offsets)
  {
    for (const int step : {-offset, offset})
    {
      const auto other = static_cast<std::ptrdiff_t>(next) + step;
      if (other >= 0 && other < static_cast<std::ptrdiff_t>(scans.size()))
      {
        const WindowScan& o = scans[static_cast<std::size_t>(other)];
        ask(o.T_odom_vehicle, o.rays, step > 0);
      }
    }
  }
  const std::size_t number = numberOfNext();
  auto last = static_cast<double>(offsets.back());
  for (auto o = past.rbegin(); o != past.rend(); ++o)
  {
    const auto age = static_cast<double>(number - o->number);
    if (age >= growth * last)
    {
      ask(o->T_odom_vehicle, o->rays, false);
      last = age;
    }
  }
  return result;
}

/** Of each point 1 if it belongs to a track that is dynamic at one time. */
std::vector<float> HindsightLabels::Impl::trackedShare(const Frame& frame) const
{
  std::vector<float> tracked(frame.cloud.size(), 0.0F);
  for (const TrackedObject& object : frame.objects)
  {
    if (dynamic.contain(object.id))
    {
      for (const std::uint32_t i : frame.pointsOf(object))
      {
        tracked[i] = 1;
      }
    }
  }
  return tracked;
}

/** Of each voxel the causal labels and the tracks of its points. */
std::vector<VoxelEvidence> HindsightLabels::Impl::causalEvidence(const Segments& segments) const
{
  const Frame& frame = *scans[next].frame;
  std::vector<VoxelEvidence> evidence(segments.first_point.size());
  const std::vector<float> tracked = trackedShare(frame);
  std::vector<float> points(evidence.size(), 0.0F);
  for (std::size_t i = 0; i < segments.voxel_of_point.size(); ++i)
  {
    const std::uint32_t g = segments.voxel_of_point[i];
    if (g != Segments::none)
    {
      points[g] += 1;
      evidence[g].tracked += tracked[i];
      evidence[g].probability +=
          i < frame.moving_probability.size() ? frame.moving_probability[i] : 0.0F;
    }
  }
  for (std::size_t g = 0; g < evidence.size(); ++g)
  {
    evidence[g].tracked /= points[g];
    evidence[g].probability /= points[g];
  }
  return evidence;
}

/** Adds what the rays of the other scans observed. \param heights of the points over the ground
 * [m] */
void HindsightLabels::Impl::addRays(const Segments& segments,
                                    const std::vector<float>& heights,
                                    std::vector<VoxelEvidence>& evidence)
{
  const Frame& frame = *scans[next].frame;
  std::vector<Eigen::Vector3f> voxels;
  std::vector<RayEffort> efforts;
  std::vector<std::size_t> evaluated;  // index of each of `voxels` in `evidence`
  for (std::size_t g = 0; g < evidence.size(); ++g)
  {
    const bool suspected = evidence[g].tracked > 0 || evidence[g].probability > suspicious;
    if (!suspected && clear.contain(segments.key_of_voxel[g]))
    {
      evidence[g].known = 1;
      continue;
    }
    const std::uint32_t first = segments.first_point[g];
    evaluated.push_back(g);
    voxels.push_back(frame.cloud.points[first]);
    efforts.push_back(suspected                         ? RayEffort::all
                      : heights[first] > vehicle_height ? RayEffort::few
                                                        : RayEffort::if_needed);
  }
  const std::vector<RayCounts> counts =
      countRays(others(), voxels, efforts, static_cast<float>(0.5 * options.voxel_size),
                static_cast<float>(options.margin), pool);
  for (std::size_t i = 0; i < counts.size(); ++i)
  {
    const RayCounts& c = counts[i];
    VoxelEvidence& e = evidence[evaluated[i]];
    const int known = c.free + c.occupied;
    e.known = known > 0 ? 1.0F : 0.0F;
    e.free = static_cast<float>(c.free) / static_cast<float>(std::max(1, known));
    e.change_before = shareOf(c.change_before);
    e.change_after = shareOf(c.change_after);
    if (isClear(c))
    {
      clear.add(segments.key_of_voxel[evaluated[i]]);
    }
  }
}

void HindsightLabels::Impl::noteTracks(const Frame& frame)
{
  for (const TrackedObject& object : frame.objects)
  {
    dynamic.note(object.id, object.confirmed && object.dynamic, frame.index);
    reported.note(object.id, object.reported, frame.index);
  }
}

/** Removes the oldest scan from the window. */
void HindsightLabels::Impl::leaveWindow()
{
  const std::size_t number = count - scans.size();
  if (number % past_stride == 0 && options.history > 0)
  {
    past.push_back({number, scans.front().T_odom_vehicle, std::move(scans.front().rays)});
  }
  while (!past.empty() && number - past.front().number > static_cast<std::size_t>(options.history))
  {
    past.pop_front();
  }
  scans.pop_front();
  --next;
  dynamic.forgetBefore(scans.front().index);
  reported.forgetBefore(scans.front().index);
}

/** Outputs the next frame, if it was kept, and drops the oldest scan. */
void HindsightLabels::Impl::outputNext(const Use& use)
{
  std::optional<Frame> frame = std::exchange(scans[next].frame, std::nullopt);
  ++next;
  if (next > static_cast<std::size_t>(options.window))
  {
    leaveWindow();
  }
  if (frame)
  {
    use(std::move(*frame));
  }
}

void HindsightLabels::Impl::decide(WindowScan& scan)
{
  clear.beginScan(numberOfNext());
  recent.beginScan(numberOfNext());
  Frame& frame = *scan.frame;
  const Eigen::Isometry3f T = scan.T_odom_vehicle.cast<float>();
  std::vector<Eigen::Vector3f> points;
  points.reserve(frame.cloud.size());
  for (const Eigen::Vector3f& p : frame.cloud.points)
  {
    points.push_back(T * p);
  }
  const std::vector<const LowestReturns*> lowest = lowestReturns();
  const std::vector<float> heights = heightsOverGround(lowest, points);
  std::vector<bool> use_point;
  use_point.reserve(points.size());
  for (const float height : heights)
  {
    use_point.push_back(height > static_cast<float>(options.ground_clearance));
  }
  const Segments segments =
      findSegments(points, use_point, options.voxel_size, options.segment_gap);
  std::vector<VoxelEvidence> evidence = causalEvidence(segments);
  addRays(segments, heights, evidence);
  const std::vector<VoxelFeatures> features = voxelFeatures(segments, evidence, points, heights);
  const std::vector<float> voxel_probability =
      probabilitiesOf(features, segments.key_of_voxel, points, recent);
  frame.moving_probability.resize(frame.cloud.size(), 0);
  frame.moving.resize(frame.cloud.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const std::uint32_t g = segments.voxel_of_point[i];
    frame.moving_probability[i] = g == Segments::none ? 0 : voxel_probability[g];
  }
  adaptLow(segments, voxel_probability, points, heights, lowest, frame.moving_probability);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    frame.moving[i] = static_cast<double>(frame.moving_probability[i]) > options.moving_threshold;
  }
  for (TrackedObject& object : frame.objects)
  {
    object.reported = object.reported || reported.contain(object.id);
  }
}

void HindsightLabels::Impl::decideNext(const Use& use)
{
  if (scans[next].frame)
  {
    decide(scans[next]);
  }
  outputNext(use);
}

HindsightLabels::HindsightLabels(const HindsightOptions& options, int threads)
    : impl_(std::make_unique<Impl>(options, threads))
{
}
HindsightLabels::~HindsightLabels() = default;

void HindsightLabels::add(const Frame& frame, FrameParts kept, const Use& use)
{
  Impl& m = *impl_;
  m.noteTracks(frame);
  m.scans.emplace_back(frame, kept);
  ++m.count;
  if (m.scans.size() - m.next > static_cast<std::size_t>(m.options.window))
  {
    m.decideNext(use);
  }
}

void HindsightLabels::finish(const Use& use)
{
  while (impl_->next < impl_->scans.size())
  {
    impl_->decideNext(use);
  }
}

void HindsightLabels::exchangeState(StateArchive& archive)
{
  archive(impl_->scans, impl_->past, impl_->next, impl_->count, impl_->clear, impl_->recent,
          impl_->dynamic, impl_->reported);
}
}  // namespace dyslam
