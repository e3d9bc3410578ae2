// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Seconds per unit of a time since 1970, by its magnitude: 1, 1e-3, 1e-6 or 1e-9. */
[[nodiscard]] double unitOfDate(double time);

/** Field with the times of the points of a scan. */
struct TimeField
{
  std::string name;
  bool is_integer = false;
  bool is_float32 = false;     //!< too coarse for times since 1970
  std::vector<double> values;  //!< one per point; not finite, or 0 among absolute times: unknown
};

/** Conventions for the fields of a recording's points: unit and zero of their times, order of their
 * rings, field of their intensities, and unit of their coordinates.
 *
 * Drivers differ in them, and neither files nor messages state them. All but the last, which the
 * user states, are therefore derived from the first scan that shows them, and then kept: one object
 * per recording of one lidar (a topic of a bag, a folder of scans).
 */
class FieldConventions
{
 public:
  /** \param length_unit unit of the coordinates in files [m] */
  explicit FieldConventions(double length_unit = 1) : length_unit_(length_unit) {}

  [[nodiscard]] double lengthUnit() const { return length_unit_; }
  /** Converts the points of a scan from lengthUnit() to metres. */
  void toMetres(Scan& scan) const;

  /** Name of the field with the intensities: `usual`, or `calibrated` if the values of the usual
   * one exceed 255 (a count of photons). A later scan may lack it. The converters limit the values
   * to 255, the readers do not. \param values values of the usual field \param calibrated empty:
   * none */
  [[nodiscard]] const std::string& intensityField(const std::string& usual,
                                                  const std::string& calibrated,
                                                  const std::vector<double>& values);

  /** Fills Scan::time, counted from the stamp that the scan has, or from its first point if that
   * has another clock. Leaves it empty, with a warning, where the field shows no times. */
  void fillTimes(const TimeField& field, Scan& scan);
  /** Fills Scan::time of a scan without a stamp: absolute times are counted from the first point,
   * whose time becomes the stamp; others are as in the field. In single precision absolute times
   * are left out. */
  void fillTimesAndStamp(const TimeField& field, Scan& scan);
  /** Gives another stamp [s] to such a scan. The times of its points then count from that, unless
   * it has another clock. */
  void restamp(Scan& scan, double stamp);
  /** Sets the conventions that the format of the recording prescribes. \param unit of times [s] */
  void setTimes(const std::string& field, double unit, bool absolute);

  /** Renumbers Scan::ring so that 0 is the lowest. Rings that are numbered from the highest are
   * taken to be as many as lidars usually have, if the scans up to the first one with 16 returns
   * lack a few. \param source of the rings, for the note \param has_all whether no ring can be
   * missing in the scan */
  void orderRings(const std::string& source, Scan& scan, bool has_all = false);

  void note(const std::string& what) { notes_.push_back(what); }
  void warn(const std::string& what) { warnings_.push_back(what); }
  /** Interpretations of the fields, one line each: "per-point time: field t, nanoseconds". */
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  /** Warnings about data that the recording lacks, one line each. */
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct TimeScale
  {
    double unit = 1;  //!< unit of the times [s]
    bool absolute = false;
    bool certain = true;  //!< the unit was determined by the times
  };
  enum class Zero
  {
    unknown,
    stamp,
    first_point
  };
  enum class Order
  {
    unknown,
    from_lowest,
    from_highest
  };
  static TimeScale scaleOf(double first, double last, bool is_integer);
  void learnTimes(const TimeField& field);
  void noteEqualTimes(const TimeField& field);
  double zeroOf(double first, double last, double stamp);

  double length_unit_;  //!< [m]
  std::vector<std::string> notes_;
  std::vector<std::string> warnings_;
  std::string intensity_field_;
  std::optional<TimeScale> scale_;
  bool times_unusable_ = false;
  bool times_equal_ = false;  //!< a scan before the unit was known had equal times
  Zero zero_ = Zero::unknown;
  Order ring_order_ = Order::unknown;
  std::uint16_t last_ring_ = 0;
};
}  // namespace dyslam
