// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>

namespace dyslam
{
/** Brings a recording's intensities to [0, 1].
 *
 * By a given factor, or by the data: from the first scan with a value above 2 on they are 0..255,
 * and higher ones are limited to that. Until then they are unchanged, so that a dim first scan
 * decides nothing.
 */
class IntensityScaler
{
 public:
  /** \param scale 0: by the data. */
  explicit IntensityScaler(double scale = 0) : scale_(scale) {}

  void operator()(Scan& scan);

 private:
  double scale_;          //!< 0: not known yet
  bool by_data_ = false;  //!< scale_ was found by the data, not given
};
}  // namespace dyslam
