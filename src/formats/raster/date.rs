//! A time that a user states of a raster.

use std::str::FromStr;

/// A second of the Gregorian calendar, in UTC.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Date {
    /// Year, month and day.
    day: [u32; 3],
    /// Hour, minute and second.
    time: [u32; 3],
}

impl Date {
    /// As the tag `DateTime` of TIFF has it.
    pub(super) fn of_tiff(&self) -> String {
        let Date { day: [year, month, day], time: [hour, minute, second] } = self;
        format!("{year:04}:{month:02}:{day:02} {hour:02}:{minute:02}:{second:02}")
    }

    /// As RFC 3339 has it.
    pub fn text(&self) -> String {
        let Date { day: [year, month, day], time: [hour, minute, second] } = self;
        format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
    }
}

impl FromStr for Date {
    type Err = String;

    /// Parses `2021-06-15` or `2021-06-15T12:30:00Z`.
    fn from_str(text: &str) -> Result<Date, String> {
        let (day, time) = match text.split_once('T') {
            Some((day, time)) => (day, time.strip_suffix('Z')),
            None => (text, Some("00:00:00")),
        };
        let day = numbers(day, '-', [4, 2, 2]).filter(|&[year, month, day]| {
            let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
            let days = match month {
                2 => 28 + u32::from(is_leap),
                4 | 6 | 9 | 11 => 30,
                _ => 31,
            };
            year > 0 && (1..=12).contains(&month) && (1..=days).contains(&day)
        });
        let time = time
            .and_then(|time| numbers(time, ':', [2; 3]))
            .filter(|&[hour, minute, second]| hour < 24 && minute < 60 && second < 60);
        match (day, time) {
            (Some(day), Some(time)) => Ok(Date { day, time }),
            _ => Err("expected a day or a second in UTC, as in 2021-06-15 or 2021-06-15T12:30:00Z".into()),
        }
    }
}

/// Three numbers of these many digits.
fn numbers(text: &str, separator: char, digits: [usize; 3]) -> Option<[u32; 3]> {
    let parts: Vec<&str> = text.split(separator).collect();
    let parts: [&str; 3] = parts.try_into().ok()?;
    let is_right =
        |(part, digits): (&&str, usize)| part.len() == digits && part.bytes().all(|b| b.is_ascii_digit());
    if !parts.iter().zip(digits).all(is_right) {
        return None;
    }
    let mut found = [0; 3];
    for (number, part) in found.iter_mut().zip(parts) {
        *number = part.parse().ok()?;
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        let date: Date = "2024-02-29".parse().unwrap();
        assert_eq!(
            (date.of_tiff(), date.text()),
            ("2024:02:29 00:00:00".into(), "2024-02-29T00:00:00Z".into())
        );
        assert_eq!("2021-06-15T12:30:59Z".parse::<Date>().unwrap().of_tiff(), "2021:06:15 12:30:59");
        for wrong in [
            "",
            "2023-02-29",
            "2021-13-01",
            "2021-06-31",
            "2021-6-15",
            "0000-01-01",
            "2021-06-15T12:30:00",
            "2021-06-15T24:00:00Z",
            "2021-06-15T12:60:00Z",
            "2021-06-15 12:30:00",
            "+021-06-15",
        ] {
            assert!(wrong.parse::<Date>().is_err(), "{wrong}");
        }
    }
}
