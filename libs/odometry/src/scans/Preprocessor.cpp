// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/core/FiringOrder.h>
#include <dyslam/core/PointTimes.h>
#include <dyslam/core/ScanParts.h>
#include <dyslam/odometry/OwnVehicle.h>
#include <dyslam/odometry/Preprocessor.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace dyslam
{
namespace
{
constexpr std::size_t chunk_size = 8192;

/** Times of the first and the last point; nothing unless the scan has times. */
std::optional<TimeExtent> timesOf(const Scan& scan)
{
  return scan.time.size() == scan.size() ? timeExtent(scan.time) : std::nullopt;
}

/** Measurement times of the points of a lidar, in units of the time since the previous scan. With
 * several lidars they are always known, at least by the stamps of their scans. */
class Phases
{
 public:
  /** \param scan scan of one lidar \param all the scan that it is part of
   * \param stamp stamp of the lidar's own scan, relative to Scan::stamp [s]
   * \param dt time since the previous scan [s]; 0: unknown, then `usual_period`
   * \param sweep_duration duration of a revolution [s]; 0: `dt` */
  Phases(const Scan& scan,
         const Scan& all,
         double stamp,
         const PreprocessOptions& options,
         double dt,
         double sweep_duration)
      : scan_(scan),
        sweep_(options.sweep),
        source_(sourceOf(all, options.deskew)),
        per_revolution_(dt > 0 ? phaseScale(sweep_duration, dt) : 1.0F),
        reference_(static_cast<float>(options.sweep_reference)),
        offset_(static_cast<float>(stamp / (dt > 0 ? dt : usual_period))),
        unit_(sweep_duration > 0 ? dt : 0)
  {
    if (source_ == Source::times)
    {
      // While no motion is known, phases are in units of the scan's own duration.
      unit_ = dt > 0 ? dt : timesOf(all).value_or(TimeExtent()).duration();
      per_second_ = unit_ > 0 ? static_cast<float>(1 / unit_) : 0.0F;
    }
    const bool may_be_ordered = source_ == Source::none || source_ == Source::azimuth;
    if (may_be_ordered && usesTimes(options.deskew))
    {
      fractions_ = firingFractions(scan.points);
      source_ = fractions_.empty() ? source_ : Source::order;
    }
    if (source_ == Source::none && !all.parts.empty())
    {
      source_ = Source::stamp;
    }
  }

  [[nodiscard]] bool known() const { return source_ != Source::none; }
  /** See Cloud::phase_unit [s]. */
  [[nodiscard]] double unit() const { return unit_; }
  /** Time of a point; NaN if it cannot be right. */
  [[nodiscard]] float of(std::size_t i) const
  {
    switch (source_)
    {
      case Source::times:
        return isPossibleTime(scan_.time[i]) ? scan_.time[i] * per_second_
                                             : std::numeric_limits<float>::quiet_NaN();
      case Source::order:
        return (fractions_[i] - reference_) * per_revolution_ + offset_;
      case Source::stamp:
        return offset_;
      default:
        return (sweepFraction(scan_.points[i], sweep_) - reference_) * per_revolution_ + offset_;
    }
  }

 private:
  enum class Source
  {
    none,
    times,
    order,  //!< by the order of the points
    azimuth,
    stamp  //!< by the stamp of the lidar's scan
  };
  static constexpr double usual_period = 0.1;  //!< usual period of scans [s]

  static bool usesTimes(DeskewMode mode)
  {
    return mode == DeskewMode::automatic || mode == DeskewMode::time;
  }
  /** Source of the times, without examining the order of the points. */
  static Source sourceOf(const Scan& scan, DeskewMode mode)
  {
    if (usesTimes(mode) && timesOf(scan))
    {
      return Source::times;
    }
    return mode == DeskewMode::automatic || mode == DeskewMode::azimuth ? Source::azimuth
                                                                        : Source::none;
  }

  const Scan& scan_;
  const SweepModel& sweep_;
  Source source_;
  float per_revolution_;  //!< phase per revolution
  float reference_;       //!< fraction of the sweep at the stamp
  float offset_;          //!< phase of the lidar's own stamp
  double unit_;
  float per_second_ = 0;          //!< phase per second
  std::vector<float> fractions_;  //!< fraction of the revolution per point, if by order
};

/** Cloud points of a chunk of a scan. */
struct CloudChunk
{
  std::vector<Eigen::Vector3f> points;
  std::vector<std::uint32_t> source;
  std::vector<float> phase;
};

void appendTo(Cloud& cloud, const CloudChunk& chunk)
{
  cloud.points.insert(cloud.points.end(), chunk.points.begin(), chunk.points.end());
  cloud.source.insert(cloud.source.end(), chunk.source.begin(), chunk.source.end());
  cloud.phase.insert(cloud.phase.end(), chunk.phase.begin(), chunk.phase.end());
}
}  // namespace

void PreprocessOptions::describe(OptionsVisitor& v)
{
  v.real("min_range", min_range, 0, 1000,
         "range from the lidar below which returns are dropped [m]");
  v.real("own_vehicle_range", own_vehicle_range, 0, 5,
         "range from the lidar within which its own vehicle is recognised: returns that stay in "
         "place while it moves are dropped, and all of them before it has moved; 0: never [m]");
  v.real("max_range", max_range, 0.1, 10000,
         "range from the lidar above which returns are dropped [m]");
  v.choice(
      "deskew", deskew,
      {{"none", DeskewMode::none},
       {"time", DeskewMode::time},
       {"azimuth", DeskewMode::azimuth},
       {"auto", DeskewMode::automatic}},
      "motion compensation: by point times, and by the order of points stored as they were fired "
      "(time), by azimuth, or (auto) by azimuth where time and order are unknown");
  v.choice("sweep_direction", sweep.direction, {{"-1", -1}, {"1", 1}},
           "direction of the sweep: -1 clockwise from above, 1 counter-clockwise");
  v.degrees("sweep_start_azimuth_deg", sweep.start_azimuth, -360, 360,
            "azimuth of the start of the sweep, counter-clockwise from straight ahead [deg]");
  v.real("sweep_reference", sweep_reference, -1, 2,
         "fraction of the sweep at which the frame's pose is taken");
}

Preprocessor::Preprocessor(const PreprocessOptions& options, ThreadPool& pool)
    : options_(options), pool_(pool)
{
  validate(options_, "preprocess");
  if (options_.min_range >= options_.max_range)
  {
    throw UserError(
        "[preprocess] min_range: is not below max_range; lower min_range or raise max_range");
  }
}

Cloud Preprocessor::prepare(const Scan& scan,
                            const Pose& T_previous_current,
                            double dt,
                            double sweep_duration,
                            const OwnVehicle* own_vehicle) const
{
  const bool has_motion = dt > 0 && std::isfinite(dt);
  const Sweep sweep{T_previous_current, has_motion ? dt : 0, sweep_duration};
  Cloud cloud;
  cloud.points.reserve(scan.size());
  cloud.source.reserve(scan.size());
  forEachPart(scan, [&](const Scan& part, const LidarRange& range)
              { prepareOf(part, scan, range, sweep, own_vehicle, cloud); });
  if (scan.intensity.size() == scan.size())
  {
    cloud.intensity.reserve(cloud.source.size());
    for (const std::uint32_t i : cloud.source)
    {
      cloud.intensity.push_back(scan.intensity[i]);
    }
  }
  return cloud;
}

/** Adds the points of one lidar. \param part part of the scan `all` in the lidar's frame, with its
 * points `range` */
void Preprocessor::prepareOf(const Scan& part,
                             const Scan& all,
                             const LidarRange& range,
                             const Sweep& sweep,
                             const OwnVehicle* own_vehicle,
                             Cloud& cloud) const
{
  const Phases phases(part, all, range.stamp, options_, sweep.dt, sweep.duration);
  cloud.T_sweep = phases.known() && sweep.dt > 0 ? sweep.T_previous_current : Pose::Identity();
  cloud.phase_unit = phases.unit();

  const SweepMotion motion(cloud.T_sweep, 0);
  const Eigen::Matrix3f R = part.T_vehicle_lidar.linear().cast<float>();
  const Eigen::Vector3f t = part.T_vehicle_lidar.translation().cast<float>();
  const auto min2 = static_cast<float>(options_.min_range * options_.min_range);
  const auto max2 = static_cast<float>(options_.max_range * options_.max_range);
  const auto own2 = static_cast<float>(options_.own_vehicle_range * options_.own_vehicle_range);
  std::vector<CloudChunk> chunks(ThreadPool::chunkCount(part.size(), chunk_size));
  pool_.forChunks(
      part.size(), chunk_size,
      [&](std::size_t begin, std::size_t end, std::size_t number)
      {
        CloudChunk& chunk = chunks[number];
        chunk.points.reserve(end - begin);
        chunk.source.reserve(end - begin);
        for (std::size_t i = begin; i < end; ++i)
        {
          const Eigen::Vector3f& p = part.points[i];
          const float range2 = p.squaredNorm();
          // NaN fails every comparison, infinity the last one.
          if (!(range2 > 0 && range2 >= min2 && range2 <= max2))
          {
            continue;
          }
          if (range2 < own2 && (own_vehicle == nullptr || own_vehicle->mayBeAt(p, range.lidar)))
          {
            continue;
          }
          Eigen::Vector3f q = R * p + t;
          if (phases.known())
          {
            const float phase = phases.of(i);
            q = motion.toReference(q, phase);
            if (!q.allFinite())
            {
              continue;
            }
            chunk.phase.push_back(phase);
          }
          chunk.points.push_back(q);
          chunk.source.push_back(static_cast<std::uint32_t>(range.begin + i));
        }
      });
  for (const CloudChunk& chunk : chunks)
  {
    appendTo(cloud, chunk);
  }
}

std::pair<double, double> Preprocessor::sweepSpan(const Scan& scan, double sweep_duration) const
{
  const auto times = timesOf(scan);
  if (times && times->duration() > 0 && options_.deskew != DeskewMode::azimuth)
  {
    return {static_cast<double>(times->first), static_cast<double>(times->last)};
  }
  return {-options_.sweep_reference * sweep_duration,
          (1 - options_.sweep_reference) * sweep_duration};
}

void redeskew(const Pose& T_previous_current, double dt, ThreadPool& pool, Cloud& cloud)
{
  constexpr double same_translation = 1e-3;  // difference that is ignored [m]
  constexpr double same_angle = 1e-4;        // difference that is ignored [rad]
  if (cloud.phase.size() != cloud.size() || !(dt > 0))
  {
    return;
  }
  const float scale = phaseScale(cloud.phase_unit, dt);
  const Vector6 change = logSE3(cloud.T_sweep.inverse() * T_previous_current);
  if (scale == 1.0F && change.head<3>().norm() < same_translation &&
      change.tail<3>().norm() < same_angle)
  {
    return;
  }
  const SweepMotion before(cloud.T_sweep, 0);
  const SweepMotion after(T_previous_current, 0);
  pool.forChunks(cloud.size(), chunk_size,
                 [&](std::size_t begin, std::size_t end, std::size_t)
                 {
                   for (std::size_t i = begin; i < end; ++i)
                   {
                     float& phase = cloud.phase[i];
                     const Eigen::Vector3f measured = before.toReference(cloud.points[i], -phase);
                     phase *= scale;
                     cloud.points[i] = after.toReference(measured, phase);
                   }
                 });
  cloud.T_sweep = T_previous_current;
  cloud.phase_unit = dt;
}
}  // namespace dyslam
