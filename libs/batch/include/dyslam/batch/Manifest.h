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
  std::uintmax_t input_bytes = 0;     //!< its size; 0 for a folder, whose files are external
  std::int64_t input_time = 0;        //!< of its last change [ns]
  std::uintmax_t external_bytes = 0;  //!< size of its external files, in a folder beside it
  std::int64_t external_time = 0;     //!< of the last change in that folder [ns]
  std::string input_checksum;         //!< with that of its external files, if it has any
  std::string settings;               //!< flags and ini, as text
  std::string version;                //!< of the program
  std::string program_checksum;       //!< of program, weights and other files that all runs read
};

enum class State
{
  unknown,  //!< not run
  running,  //!< or killed
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
  std::string reason;             //!< why it failed, one line
  bool interrupted = false;       //!< stopped or killed by a signal: can be resumed
  std::string settings_checksum;  //!< of effective.ini, every setting of the run
  int attempts = 0;
  double seconds = 0;             //!< wall time of the last attempt
  std::uint64_t peak_memory = 0;  //!< of it [bytes]

  /** Whether there are results. */
  [[nodiscard]] bool hasResults() const
  {
    return state == State::done || state == State::unregistered;
  }
};

/** Nothing if there is none or it cannot be understood: then the recording is run again. */
[[nodiscard]] std::optional<Manifest> readManifest(const std::string& folder);
/** \throws UserError. */
void writeManifest(const std::string& folder, const Manifest& manifest);

/** The work of a recording. The checksum is not computed again if size and time of a known
 * recording and of its external files are the same. \param common settings, version and program's
 * checksum. \throws UserError. */
[[nodiscard]] Work workOn(const std::string& input,
                          const Work& common,
                          const std::optional<Manifest>& known);

/** Whether both give the same results. */
[[nodiscard]] bool isSame(const Work& a, const Work& b);
/** Whether a folder holds the results of this work, unchanged. */
[[nodiscard]] bool isDone(const std::string& folder,
                          const Work& work,
                          const std::optional<Manifest>& known);
}  // namespace dyslam::batch
