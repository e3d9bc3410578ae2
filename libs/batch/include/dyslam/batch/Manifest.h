// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace dyslam::batch
{
/** SHA-256, 64 hexadecimal digits. \throws UserError if the file cannot be read. */
[[nodiscard]] std::string checksumOfFile(const std::string& path);
[[nodiscard]] std::string checksumOfText(const std::string& text);

/** All inputs of a recording's results. Equal work has the same results. */
struct Work
{
  std::string input;                  //!< path of the recording
  std::uintmax_t input_bytes = 0;     //!< size of the file; 0 for a folder: its files are external
  std::int64_t input_time = 0;        //!< time of the last change of the file [ns]
  std::uintmax_t external_bytes = 0;  //!< size of the external files, in a folder beside it
  std::int64_t external_time = 0;     //!< time of the last change in that folder [ns]
  std::string input_checksum;         //!< checksum of the file and its external files
  std::string settings;               //!< flags and ini, as text
  std::string version;                //!< version of the program
  std::string
      program_checksum;  //!< checksum of program, weights and other files that all runs read
};

enum class State
{
  unknown,  //!< not run
  running,  //!< still running, or killed
  done,
  unregistered,  //!< done, but most scans could not be registered
  failed
};

[[nodiscard]] const char* toString(State state);

/** `manifest.json` in the folder of each recording of a batch. */
struct Manifest
{
  Work work;
  State state = State::unknown;
  std::string reason;             //!< why the run failed, one line
  bool interrupted = false;       //!< stopped, killed, or without room for results: can be resumed
  std::string settings_checksum;  //!< checksum of effective.ini, every setting of the run
  int attempts = 0;               //!< number of attempts so far
  double seconds = 0;             //!< wall time of the last attempt [s]
  std::uint64_t peak_memory = 0;  //!< peak memory of the last attempt [bytes]

  /** Whether there are results. */
  [[nodiscard]] bool hasResults() const
  {
    return state == State::done || state == State::unregistered;
  }
};

/** Reads the manifest in a folder; nothing if there is none or it is invalid: then the recording is
 * run again. */
[[nodiscard]] std::optional<Manifest> readManifest(const std::string& folder);
/** Writes the manifest into a folder. \throws UserError. */
void writeManifest(const std::string& folder, const Manifest& manifest);

/** The work of a recording. The checksum is not computed again if size and time of a known
 * recording and of its external files are the same. \param common settings, version and program's
 * checksum. \throws UserError. */
[[nodiscard]] Work workOn(const std::string& input,
                          const Work& common,
                          const std::optional<Manifest>& known);

/** Whether two works give the same results. */
[[nodiscard]] bool isSame(const Work& a, const Work& b);
/** Whether a folder holds the results of this work, unchanged. */
[[nodiscard]] bool isDone(const std::string& folder,
                          const Work& work,
                          const std::optional<Manifest>& known);
}  // namespace dyslam::batch
