// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/mapbuilder/MapBuilder.h>
#include <dyslam/mapbuilder/MapListener.h>
#include <dyslam/mapbuilder/MapOutputs.h>
#include <dyslam/mapbuilder/MapRun.h>

#include <functional>
#include <string>
#include <vector>

namespace dyslam
{
/** Writes a file, or files that belong together. */
struct FileWriter
{
  std::string name;  //!< for errors that do not name the file
  std::function<void()> write;
};

/** Calls all writers, also after one that fails. \return what failed; empty if nothing did \throws
 * MapStopped. */
[[nodiscard]] std::string writeEach(const std::vector<FileWriter>& writers);

/** Checks the export options before anything is read. \throws UserError. */
void requireValidExports(const MapOutputs& outputs);

/** The products that the outputs need, except the uncleaned map, which only buildMap() makes. */
[[nodiscard]] MapProducts productsFor(const MapOutputs& outputs);

/** Writes the maps, the picture, the picture of what was removed (with an uncleaned map), the
 * settings and the labelled map. Warns of coordinates that are relative to an origin.
 * \return all but MapReport::scans; `problem` names the files that could not be written */
MapReport writeMapOutputs(MapBuilder& builder, const MapOutputs& outputs, MapListener& listener);
}  // namespace dyslam
