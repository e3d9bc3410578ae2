// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Options.h>
#include <dyslam/base/Parallel.h>
#include <dyslam/core/Deskew.h>
#include <dyslam/core/Pose.h>
#include <dyslam/core/Scan.h>

#include <utility>

namespace dyslam
{
class OwnVehicle;
struct LidarRange;

enum class DeskewMode
{
  none,       //!< no deskewing: motion-compensated scans or single shots
  time,       //!< by Scan::time, else by firingFractions(), else no deskewing
  azimuth,    //!< by the sweep model, for spinning sensors without times
  automatic,  //!< "auto": as `time` if times or firing order are known, else as `azimuth`
};

/** Ini section `[preprocess]`. */
struct PreprocessOptions : Options
{
  double min_range = 0.5;          //!< range below which returns are dropped [m]
  double own_vehicle_range = 1.5;  //!< as min_range, where the own vehicle may be [m]
  double max_range = 100;          //!< range beyond which returns are dropped [m]
  DeskewMode deskew = DeskewMode::automatic;
  SweepModel sweep;  //!< sweep of the sensor, for deskewing by azimuth
  /** Fraction of the sweep at the scan's stamp, for deskewing by azimuth or order. KITTI: 0.5, the
   * lidar faces straight ahead. */
  double sweep_reference = 0.5;

  void describe(OptionsVisitor& visitor) override;
};

/** Makes the Cloud that algorithms use from a recorded Scan.
 *
 * Thread-safe; callers share the threads of the pool.
 */
class Preprocessor
{
 public:
  /** \throws UserError for options out of range. The pool must outlive the object. */
  Preprocessor(const PreprocessOptions& options, ThreadPool& pool);

  /** Valid returns within the range limits, in the vehicle frame at the frame's stamp, in the order
   * of the scan, with Cloud::source. Ranges are from the lidar that measured the point. If the
   * points are deskewed by their times, those without one, or more than 60 s from the stamp, are
   * left out.
   *
   * The points are relative to the pose at Scan::stamp (time 0), or at
   * PreprocessOptions::sweep_reference if deskewed by azimuth or order.
   * \param T_previous_current predicted motion of the vehicle over `dt`
   * \param dt time since the previous scan [s]. With dt <= 0 (a first scan) no point is moved, but
   *   Cloud::phase is filled, so that the scan can be deskewed once its motion is known.
   * \param sweep_duration duration of one revolution [s], for deskewing by azimuth or order; 0:
   * `dt` \param own_vehicle places where returns within PreprocessOptions::own_vehicle_range may be
   *   the vehicle's; null: everywhere */
  [[nodiscard]] Cloud prepare(const Scan& scan,
                              const Pose& T_previous_current,
                              double dt,
                              double sweep_duration = 0,
                              const OwnVehicle* own_vehicle = nullptr) const;

  /** Measurement times of the first and the last point of a scan, after its stamp [s], as assumed
   * by prepare(). \param sweep_duration duration of one revolution [s]; 0: unknown, then both may
   * be 0 */
  [[nodiscard]] std::pair<double, double> sweepSpan(const Scan& scan, double sweep_duration) const;

  [[nodiscard]] const PreprocessOptions& options() const { return options_; }

 private:
  /** Motion for deskewing. */
  struct Sweep
  {
    Pose T_previous_current;
    double dt;        //!< time since the previous scan [s]; 0: unknown
    double duration;  //!< duration of one revolution [s]; 0: `dt`
  };

  void prepareOf(const Scan& part,
                 const Scan& all,
                 const LidarRange& range,
                 const Sweep& sweep,
                 const OwnVehicle* own_vehicle,
                 Cloud& cloud) const;

  PreprocessOptions options_;
  ThreadPool& pool_;
};

/** Deskews a cloud of Preprocessor::prepare() again, with another motion of the vehicle over `dt`
 * seconds.
 *
 * Does nothing if the cloud has no phases or the motions differ by less than 1 mm and 0.1 mrad. */
void redeskew(const Pose& T_previous_current, double dt, ThreadPool& pool, Cloud& cloud);
}  // namespace dyslam
