// SPDX-License-Identifier: BSD-3-Clause
#include "RecordingNotes.h"

#include <dyslam/base/Printable.h>

#include <algorithm>

namespace dyslam
{
void RecordingNotes::add(const std::string& text, std::optional<std::size_t> scan)
{
  const auto it = std::find_if(notes_.begin(), notes_.end(),
                               [&text](const Note& note) { return note.text == text; });
  if (it == notes_.end())
  {
    notes_.push_back({text, 1, scan});
  }
  else
  {
    ++it->times;
  }
}

std::vector<std::string> RecordingNotes::lines(const std::string& recording) const
{
  std::vector<std::string> lines;
  for (const Note& note : notes_)
  {
    const std::string times = note.times > 1 ? std::to_string(note.times) + " times" : "";
    const std::string scan = note.first_scan ? (times.empty() ? "scan " : ", first scan ") +
                                                   std::to_string(*note.first_scan)
                                             : "";
    lines.push_back(recording + ": " + printable(note.text) +
                    (times.empty() && scan.empty() ? "" : " (" + times + scan + ")"));
  }
  return lines;
}
}  // namespace dyslam
