//! Ranges of frames, as Python has slices.

use std::fmt;
use std::num::NonZeroU64;
use std::str::FromStr;

/// Frames from one on, before another, each so many; all by default.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameRange {
    start: u64,
    end: Option<u64>,
    step: NonZeroU64,
}

impl Default for FrameRange {
    fn default() -> Self {
        FrameRange { start: 0, end: None, step: NonZeroU64::MIN }
    }
}

impl FrameRange {
    /// Whether it has this frame, counted from 0.
    pub fn contains(&self, frame: u64) -> bool {
        frame >= self.start && !self.is_past(frame) && (frame - self.start) % self.step == 0
    }

    /// Whether it has neither this frame nor a later one.
    pub fn is_past(&self, frame: u64) -> bool {
        self.end.is_some_and(|end| frame >= end)
    }

    /// Whether it has one frame at most.
    pub fn is_single(&self) -> bool {
        self.end.is_some_and(|end| end - self.start <= self.step.get())
    }

    /// Its first frame.
    pub fn first(&self) -> u64 {
        self.start
    }
}

impl FromStr for FrameRange {
    type Err = String;

    /// `A:B:S`, of which each may be left out, or the number of one frame.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || {
            format!(
                "{text:?} is neither the number of a frame, counted from 0, nor FIRST:END:STEP with END above FIRST"
            )
        };
        let parts: Vec<&str> = text.split(':').collect();
        let number = |part: usize| match parts.get(part) {
            None | Some(&"") => Ok(None),
            Some(digits) if digits.bytes().all(|byte| byte.is_ascii_digit()) => {
                digits.parse::<u64>().map(Some).map_err(|_| expected())
            }
            Some(_) => Err(expected()),
        };
        let (start, end, step) = (number(0)?, number(1)?, number(2)?);
        let range = match (parts.len(), start) {
            (1, Some(frame)) => {
                FrameRange { start: frame, end: frame.checked_add(1), ..FrameRange::default() }
            }
            (2 | 3, _) => {
                let step = NonZeroU64::new(step.unwrap_or(1)).ok_or_else(expected)?;
                FrameRange { start: start.unwrap_or(0), end, step }
            }
            _ => return Err(expected()),
        };
        if range.is_past(range.start) { Err(expected()) } else { Ok(range) }
    }
}

impl fmt::Display for FrameRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let FrameRange { start, end, step } = self;
        write!(f, "{start}:{}:{step}", end.map_or(String::new(), |end| end.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(text: &str) -> Vec<u64> {
        let range: FrameRange = text.parse().unwrap();
        (0..10).filter(|&frame| range.contains(frame)).collect()
    }

    #[test]
    fn ranges_are_those_of_python() {
        assert_eq!(frames("2:9:3"), [2, 5, 8]);
        assert_eq!(frames("7:"), [7, 8, 9]);
        assert_eq!(frames(":3"), [0, 1, 2]);
        assert_eq!(frames("::4"), [0, 4, 8]);
        assert_eq!(frames("6"), [6]);
        for text in ["", "-1", "3:3", "5:2", "::0", "a", "1:2:3:4", "+1", "99999999999999999999"] {
            assert!(text.parse::<FrameRange>().is_err(), "{text}");
        }
    }
}
