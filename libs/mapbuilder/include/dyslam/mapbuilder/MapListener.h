// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Error.h>

#include <cstddef>
#include <string>

namespace dyslam
{
/** Ends the work on a map from within MapListener::update(). Files that were complete stay, the
 * others are removed. */
class MapStopped : public UserError
{
 public:
  using UserError::UserError;
};

/** Progress and warnings of a map that is being built, for a program to show; nothing by default.
 * One piece of work follows another. One that ends early, by an error, is not finished. */
class MapListener
{
 public:
  virtual ~MapListener() = default;

  /** A recording is read from its start. \param purpose "times", "tracks", "map, monday"; empty for
   * the map of one recording. Scans are counted. */
  virtual void beginReading(const std::string& /*purpose*/) {}
  /** Files are written together. \param names of the files \param unit that is counted, in the
   * plural */
  virtual void beginWriting(const std::string& /*names*/, const std::string& /*unit*/) {}
  /** \param fraction of this work that is done, 0 to 1 \param count of its units \throws MapStopped
   * to end the work */
  virtual void update(double /*fraction*/, std::size_t /*count*/) {}
  virtual void finish(std::size_t /*count*/) {}

  /** \param text one sentence about the recording or the files */
  virtual void warn(const std::string& /*text*/) {}
};
}  // namespace dyslam
