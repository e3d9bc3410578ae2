// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
enum class Split
{
  training,
  validation,
  test
};

/** "training", "validation" or "test". */
[[nodiscard]] std::string toString(Split split);

/** Numbers from first to last, both included. */
struct NumberRange
{
  std::int64_t first = 0;
  std::int64_t last = 0;
};

/** The frame number of a scan: the last number in the name of its file, without the extension;
 * nothing if it has none. */
[[nodiscard]] std::optional<std::int64_t> frameNumberOf(const std::string& file);

/** Which frames of real recordings, and which seeds of simulated worlds, are for training, for
 * validation and for test (splits.ini). */
class DataSplits
{
 public:
  /** \throws UserError for keys that are no split, and for ranges that overlap. */
  explicit DataSplits(const Config& config);
  /** Reads a file of splits, or a shipped one by its name. \param field setting that names the
   * file, for the message \throws UserError. */
  [[nodiscard]] static DataSplits load(const std::string& file, const std::string& field);

  /** Requires that a scan is in a split. Its recording is the innermost folder of its path that has
   * a section, its frame the last number in the file's name. \param field setting that names the
   * scan, for the message \throws UserError if the scan is in another split or in none. */
  void requireScan(const std::string& file, Split split, const std::string& field) const;
  /** requireScan() for a range of frames of a folder of scans. \throws UserError. */
  void requireFrames(const std::string& folder,
                     const NumberRange& frames,
                     Split split,
                     const std::string& field) const;
  /** Requires that a simulated world is in a split. \throws UserError. */
  void requireSeed(std::int64_t seed, Split split, const std::string& field) const;
  /** The split of a scan, found as by requireScan(); nothing if it is in none or has no number. */
  [[nodiscard]] std::optional<Split> splitOfScan(const std::string& file) const;
  /** The split of a simulated world; nothing if it is in none. */
  [[nodiscard]] std::optional<Split> splitOfSeed(std::int64_t seed) const;
  /** The seeds to draw worlds from for training. \throws UserError unless it is one range. */
  [[nodiscard]] NumberRange trainingSeeds() const;

 private:
  using Ranges = std::array<std::vector<NumberRange>, 3>;

  [[nodiscard]] const Ranges* recordingOf(const std::string& file, std::string& name) const;

  std::map<std::string, Ranges> sections_;
};
}  // namespace dyslam
