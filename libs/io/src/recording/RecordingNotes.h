// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** What the user should know about a recording, each kind once with its count. */
class RecordingNotes
{
 public:
  /** \param scan index of the one it is about, if it is about one. */
  void add(const std::string& text, std::optional<std::size_t> scan = std::nullopt);
  /** One line each, in the order in which they were first added. \param recording its name */
  [[nodiscard]] std::vector<std::string> lines(const std::string& recording) const;

 private:
  struct Note
  {
    std::string text;
    std::size_t times = 0;
    std::optional<std::size_t> first_scan;
  };
  std::vector<Note> notes_;
};
}  // namespace dyslam
