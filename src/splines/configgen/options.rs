//! The options of a run, and how they are written in words.

use std::str::FromStr;

use super::special::SpecialKind;
use spmesh_base::error::Error;
use spmesh_formats::source::Values;

/// The options of a run.
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
    /// Treatment of knots on the border.
    pub border: Border,
    /// Knots to double at their place.
    pub pull_apart: Option<Places>,
    /// Special configurations to make, if any.
    pub special: Option<SpecialKind>,
    /// Values of the knots for rules that need some; elevations if there are none.
    pub values: Option<Values>,
}

impl Options {
    /// Checks that the other options go with the special configurations.
    pub(super) fn check_special(&self) -> spmesh_base::error::Result<()> {
        let Some(special) = &self.special else { return Ok(()) };
        if matches!(self.rule, RuleName::Heights | RuleName::Weights) {
            let what = "the rules lifted:... come with a triangulation of their own: leave out --box, \
                        --patches or \
                        --features, or take another rule";
            return Err(Error::usage(what));
        }
        if self.flips.is_some() {
            let what = "--flip would undo what --box, --patches and --features make: leave out one of them";
            return Err(Error::usage(what));
        }
        if !matches!(special, SpecialKind::Patches(..)) {
            return Ok(());
        }
        if self.border != Border::Free || self.pull_apart.is_some() {
            let what = "knots of --patches are no knots of the input: leave out --boundary and --pull-apart, \
                        or give \
                        all as points with --box";
            return Err(Error::usage(what));
        }
        if self.rule.needs_values() {
            return Err(Error::usage("knots of --patches have no values: take another rule"));
        }
        Ok(())
    }
}

/// A rule for links, before its values are read.
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
                    return Err("expected delaunay, lifted:heights, lifted:weights, min-weight, ear, fan, \
                                random, data \
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
    /// A number of edges chosen at random, with a seed of its own if there is one.
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

/// Treatment of knots on the border of the convex hull.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Border {
    /// Left as they are.
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
    text.trim().parse().map_err(|_| format!("{text:?} is not an integer, or too large"))
}
