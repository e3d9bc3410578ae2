// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/backend/FactorGraph.h>

#include <string>
#include <vector>

namespace dyslam
{
/** Reads a factor graph from a text file (doc/formats.md, "Factor graph").
 *
 * A factor is left out if its information is not positive definite, a number is not finite or a
 * variable is missing.
 * \param types of factor that the file may have
 * \param warnings one line for every factor left out: file, line and why
 * \throws UserError if the file cannot be read or is not of this format. */
[[nodiscard]] FactorGraph readFactorGraph(const std::string& path,
                                          std::vector<std::string>& warnings,
                                          const FactorTypes& types = FactorTypes());
/** As above, but a factor that cannot be used is an error, too. */
[[nodiscard]] FactorGraph readFactorGraph(const std::string& path,
                                          const FactorTypes& types = FactorTypes());

/** Writes a factor graph with all digits: reading and writing it again gives the same file. The
 * file is never incomplete. \throws UserError. */
void writeFactorGraph(const FactorGraph& graph, const std::string& path);

/** Whether a file is a factor graph, by its first line. \throws UserError if it can't be read. */
[[nodiscard]] bool isFactorGraphFile(const std::string& path);
}  // namespace dyslam
