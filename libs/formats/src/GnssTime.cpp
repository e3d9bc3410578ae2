// SPDX-License-Identifier: BSD-3-Clause
#include "GnssTime.h"

#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace dyslam
{
namespace
{
constexpr double seconds_per_day = 86400;
constexpr double seconds_per_week = 7 * seconds_per_day;
constexpr double start_of_week_zero = 315964800;  // 1980-01-06 [s since 1970]

/** Months, 100 * year + month, whose first day followed a leap second, since GPS time began. */
constexpr std::array<int, 18> after_leap_seconds{198107, 198207, 198307, 198507, 198801, 199001,
                                                 199101, 199207, 199307, 199407, 199601, 199707,
                                                 199901, 200601, 200901, 201207, 201507, 201701};

/** Number of days from 1970-01-01 to the first day of a month. */
int firstDayOf(int year, int month)
{
  // Years are counted from March, so that a leap day is the last of its year.
  const int y = month > 2 ? year : year - 1;
  const int m = month > 2 ? month - 3 : month + 9;
  return 365 * y + y / 4 - y / 100 + y / 400 + (153 * m + 2) / 5 - 719468;
}

int leapSecondsAt(double gps_time)
{
  int seconds = 0;
  for (const int month : after_leap_seconds)
  {
    if (gps_time < seconds_per_day * firstDayOf(month / 100, month % 100) + seconds + 1)
    {
      break;
    }
    ++seconds;
  }
  return seconds;
}

bool isWhole(double number, double min, double max)
{
  return number >= min && number <= max && std::floor(number) == number;
}

/** The numbers in "a:b:c"; nothing for another text. */
std::optional<std::array<double, 3>> threeNumbers(std::string_view text, char separator)
{
  std::array<double, 3> numbers{};
  for (std::size_t i = 0; i < 3; ++i)
  {
    const std::size_t end = i < 2 ? text.find(separator) : text.size();
    const auto number =
        end == std::string_view::npos ? std::nullopt : parseNumber<double>(text.substr(0, end));
    if (!number)
    {
      return std::nullopt;
    }
    numbers[i] = *number;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return numbers;
}

/** Seconds from 1970 to the start of a day, "2024/05/18". */
std::optional<double> startOfDay(std::string_view text)
{
  const auto date = threeNumbers(text, '/');
  if (!date || !isWhole((*date)[0], 1980, 9999) || !isWhole((*date)[1], 1, 12))
  {
    return std::nullopt;
  }
  const int year = static_cast<int>((*date)[0]);
  const int month = static_cast<int>((*date)[1]);
  const int first = firstDayOf(year, month);
  const int next = month < 12 ? firstDayOf(year, month + 1) : firstDayOf(year + 1, 1);
  return isWhole((*date)[2], 1, next - first)
             ? std::make_optional(seconds_per_day * (first + (*date)[2] - 1))
             : std::nullopt;
}

/** Seconds since the start of the day, "12:30:00.5". */
std::optional<double> timeOfDay(std::string_view text)
{
  const auto time = threeNumbers(text, ':');
  const bool is_time = time && isWhole((*time)[0], 0, 23) && isWhole((*time)[1], 0, 59) &&
                       (*time)[2] >= 0 && (*time)[2] < 61;
  return is_time ? std::make_optional(3600 * (*time)[0] + 60 * (*time)[1] + (*time)[2])
                 : std::nullopt;
}

/** Seconds since 1970 of a date and a time of day, or of a week and the seconds in it. */
std::optional<double> secondsOf(std::string_view date, std::string_view time)
{
  if (const auto week = parseNumber<double>(date))
  {
    const auto seconds = parseNumber<double>(time);
    const bool is_time =
        isWhole(*week, 0, 9999) && seconds && *seconds >= 0 && *seconds <= seconds_per_week;
    return is_time ? std::make_optional(start_of_week_zero + seconds_per_week * *week + *seconds)
                   : std::nullopt;
  }
  const auto day = startOfDay(date);
  const auto in_day = timeOfDay(time);
  return day && in_day ? std::make_optional(*day + *in_day) : std::nullopt;
}
}  // namespace

int secondsAheadOfUtc(GnssClock clock, double time)
{
  switch (clock)
  {
    case GnssClock::gps:
      return leapSecondsAt(time);
    case GnssClock::japan:
      return 9 * 3600;
    case GnssClock::utc:
      break;
  }
  return 0;
}

std::optional<double> unixTimeOf(std::string_view date, std::string_view time, GnssClock clock)
{
  const std::optional<double> seconds = secondsOf(date, time);
  return seconds ? std::make_optional(*seconds - secondsAheadOfUtc(clock, *seconds)) : std::nullopt;
}
}  // namespace dyslam
