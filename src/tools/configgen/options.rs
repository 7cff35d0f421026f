//! What is made of knots, and how that is written.

use std::str::FromStr;

use super::purpose::Purpose;
use spmesh_io::source::Values;

/// What is made of knots.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// The highest degree.
    pub degree: usize,
    /// How links are triangulated.
    pub rule: RuleName,
    /// Seed of [`RuleName::Random`], and of flips that have none of their own.
    pub seed: u64,
    /// Flips of the start triangulation.
    pub flips: Option<Flips>,
    /// What becomes of knots on the border.
    pub border: Border,
    /// Knots that become two at one place each.
    pub pull_apart: Option<Places>,
    /// What special configurations are for.
    pub purpose: Option<Purpose>,
    /// Values of the knots for rules that need some; elevations if there are none.
    pub values: Option<Values>,
}

/// A rule for links, with its values still in the input.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum RuleName {
    /// Circles.
    #[default]
    Delaunay,
    /// The lower side of knots lifted to their values.
    Heights,
    /// Power circles: values are weights.
    Weights,
    /// The least sum of lengths.
    MinWeight,
    /// Ears in order.
    Ear,
    /// All diagonals from the least knot.
    Fan,
    /// At random.
    Random,
    /// Edges near a direction, in degrees.
    Aligned(f64),
    /// Edges along which values, or slopes, differ least.
    Data,
}

impl RuleName {
    /// Whether knots must have values.
    #[must_use]
    pub fn needs_values(self) -> bool {
        matches!(self, RuleName::Heights | RuleName::Weights | RuleName::Data)
    }
}

impl FromStr for RuleName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Ok(match text {
            "delaunay" => RuleName::Delaunay,
            "lifted:heights" => RuleName::Heights,
            "lifted:weights" => RuleName::Weights,
            "min-weight" => RuleName::MinWeight,
            "ear" => RuleName::Ear,
            "fan" => RuleName::Fan,
            "random" => RuleName::Random,
            "data" => RuleName::Data,
            _ => match text.strip_prefix("aligned:") {
                Some(angle) => RuleName::Aligned(parse_angle(angle)?),
                None => {
                    return Err("expected delaunay, lifted:heights, lifted:weights, min-weight, ear, fan, random, data \
                                or aligned:ANGLE"
                        .into());
                }
            },
        })
    }
}

/// Flips of the start triangulation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Flips {
    /// So many edges chosen at random; from a seed, if it has one of its own.
    Random(u32, Option<u64>),
    /// Edges whose other diagonal is nearer to a direction, in degrees.
    Aligned(f64),
}

impl FromStr for Flips {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let words: Vec<&str> = text.split(':').collect();
        match words[..] {
            ["aligned", angle] => Ok(Flips::Aligned(parse_angle(angle)?)),
            ["random", count] => Ok(Flips::Random(parse_whole(count)?, None)),
            ["random", count, seed] => Ok(Flips::Random(parse_whole(count)?, Some(parse_whole(seed)?))),
            _ => Err("expected random:N, random:N:SEED or aligned:ANGLE".into()),
        }
    }
}

/// What becomes of knots on the border of the convex hull.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Border {
    /// Nothing.
    #[default]
    Free,
    /// Corners are repeated, so that there are degree + 1 at each.
    Clamped,
    /// All are repeated once.
    PulledApart,
}

/// Some of the knots.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Places {
    /// All.
    All,
    /// Those on the border of the convex hull.
    Border,
    /// Those with these ids.
    List(Vec<u32>),
}

impl FromStr for Places {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "all" => Ok(Places::All),
            "boundary" => Ok(Places::Border),
            _ => {
                let ids: Result<Vec<u32>, String> = text.split(',').map(parse_whole).collect();
                ids.map(Places::List)
                    .map_err(|_| "expected all, boundary, or ids between commas, like 3,17".into())
            }
        }
    }
}

fn parse_angle(text: &str) -> Result<f64, String> {
    let angle = text.parse().ok().filter(|angle: &f64| angle.is_finite());
    angle.ok_or_else(|| format!("{text:?} is no angle in degrees, like 30 or -45"))
}

fn parse_whole<T: FromStr>(text: &str) -> Result<T, String> {
    text.trim().parse().map_err(|_| format!("{text:?} is no whole number, or too large"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_what_the_help_says() {
        assert_eq!("aligned:-30".parse(), Ok(RuleName::Aligned(-30.0)));
        assert_eq!("random:5".parse(), Ok(Flips::Random(5, None)));
        assert_eq!("random:5:18446744073709551615".parse(), Ok(Flips::Random(5, Some(u64::MAX))));
        assert_eq!("3, 7".parse(), Ok(Places::List(vec![3, 7])));
        for word in ["", "aligned", "aligned:", "aligned:nan", "lifted", "delaunay:1"] {
            assert!(word.parse::<RuleName>().is_err(), "{word}");
        }
        for word in ["", "random", "random:-1", "random:1:2:3", "random:1:x", "aligned:inf", "5"] {
            assert!(word.parse::<Flips>().is_err(), "{word}");
        }
        for word in ["", "3,", "-1", "corner", "4294967296"] {
            assert!(word.parse::<Places>().is_err(), "{word}");
        }
    }
}
