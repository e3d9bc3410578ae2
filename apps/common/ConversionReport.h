// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/formats/Bag.h>
#include <dyslam/io/Conversion.h>

#include <functional>
#include <string>

namespace dyslam
{
/** Final report of a converter: notes and warnings on stderr, one line of counts on stdout.
 * \param are_true whether the poses are ground truth, not an estimate */
void report(const ConversionResult& result, const std::string& output, bool are_true = true);

/** Converts with a line of progress. A signal ends it and removes what was written so far; the
 * error is stoppedMessage() of the input, as of a run. \param program its name \param convert
 * converts, and reports its progress. \throws UserError. */
ConversionResult convertWithProgress(
    const std::string& program,
    const std::string& input,
    const std::string& output,
    bool quiet,
    const std::function<ConversionResult(const ConversionProgress&)>& convert);

/** Says what bag that is compressed as a whole is unpacked where, with a line of progress. From the
 * first call of the result on a signal ends the unpacking, which removes the unpacked files.
 * \param program its name \param input the bag as the user named it. The result \throws UserError
 * after a signal: stoppedMessage() of the input. */
[[nodiscard]] BagUnpackingProgress unpackWithProgress(const std::string& program,
                                                      const std::string& input,
                                                      bool quiet);

/** Writes a rawlog with a line of progress, and prints the result.
 * \param force replace an earlier recording and its ground truth \throws UserError. */
void runConversion(const std::string& program,
                   const std::string& input,
                   const std::string& output,
                   bool force,
                   bool quiet,
                   const std::function<ConversionResult(const ConversionProgress&)>& convert);
}  // namespace dyslam
