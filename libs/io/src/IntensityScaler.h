// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/core/Scan.h>

namespace dyslam
{
/** Brings a recording's intensities to [0, 1].
 *
 * By a given factor, or by what the data show: from the first scan on that has a value above 1 they
 * are 0..255. Until then they stay as they are, so a dim first scan decides nothing.
 */
class IntensityScaler
{
 public:
  /** \param scale 0: as the data show. */
  explicit IntensityScaler(double scale = 0) : scale_(scale) {}

  void operator()(Scan& scan);

 private:
  double scale_;  //!< 0: not known yet
};
}  // namespace dyslam
