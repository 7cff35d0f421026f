//! Sets up the computation: knots, a start triangulation, and a rule.

use super::Report;
use super::options::{Border, Flips, Options, Places, RuleName};
use super::sites::{Frame, Sites};
use super::special::SpecialKind;
use spmesh_base::error::{Error, Result};
use spmesh_configurations::special::Special;
use spmesh_configurations::{self as configurations, Configurations, Knots, Lift, Rule, Start};
use spmesh_delaunay::delaunay2::distinct;
use spmesh_formats::source::Values;
use spmesh_stream::Coordinates;

/// The input of the computation of configurations.
pub(super) struct Setup {
    pub(super) knots: Knots,
    pub(super) frame: Frame,
    pub(super) origin: Origin,
    pub(super) rule: Rule,
    /// Has no times yet.
    pub(super) report: Report,
}

/// The configurations that the rule starts from.
pub(super) enum Origin {
    /// Configurations of degree 0.
    Start(Configurations),
    /// Special configurations, which also determine diagonals of links.
    Special(Special),
}

/// Sets up the computation.
///
/// A mesh that is the Delaunay triangulation of its vertices counts as points; any other mesh is the start
/// triangulation.
pub(super) fn set_up(sites: Sites, options: &Options) -> Result<Setup> {
    options.check_special()?;
    let kind = options.special.as_ref();
    let sites = match kind {
        Some(kind) => kind.place(sites),
        None => sites,
    };
    let Sites { points, triangles, mut frame, .. } = sites;
    let given = Knots::new(points)?;
    if !kind.is_some_and(SpecialKind::has_knots) {
        configurations::check_degree(
            &given,
            if options.border == Border::Clamped { 0 } else { options.degree },
        )?;
    }
    let own = match triangles {
        Some(triangles) if !is_delaunay(&given, &triangles)? => Some(triangles),
        _ => None,
    };
    let mut knots = with_copies(&given, options)?;
    let special = kind.map(|kind| kind.set_up(&knots)).transpose()?;
    if let Some(special) = &special {
        knots = special.knots.clone();
    }
    if own.is_some() && (knots.len() > given.len() || special.is_some()) {
        let message = "a mesh that is not the Delaunay triangulation of its vertices has no place for copies \
                       of knots, \
                       nor for what --box, --patches and --features make: leave these and --boundary and \
                       --pull-apart \
                       out, or give points";
        return Err(Error::usage(message));
    }
    let mut report = Report {
        points: given.len() as u64,
        repeated: (0..given.len() as u32).filter(|&id| given.rank(id) > 0).count() as u64,
        knots: knots.len() as u64,
        own_start: own.is_some(),
        ..Report::default()
    };
    let added = added(&knots, given.len(), special.as_ref());
    let rule = Rules { options, frame: &frame, given: given.len(), added: &added }.rule()?;
    rule.check(&knots)?;
    if let Some(elevations) = &mut frame.elevations {
        extend(elevations, &added, f64::midpoint);
    }
    let origin = match special {
        Some(special) => Origin::Special(special),
        None => Origin::Start(start(&knots, own, &rule, options, &mut report.flips)?),
    };
    Ok(Setup { knots, frame, origin, rule, report })
}

/// For each added knot, the two knots that it lies between; for a copy, twice the first knot at its place.
fn added(knots: &Knots, given: usize, special: Option<&Special>) -> Vec<[u32; 2]> {
    if knots.len() == given {
        return Vec::new();
    }
    let firsts = distinct(knots.points());
    let ends = |id: u32| special.and_then(|special| special.diagonals.of(&[id]).next());
    let between = |id: u32| match firsts[id as usize] {
        first if first < id => [first, first],
        _ => ends(id).unwrap_or([id, id]),
    };
    (given as u32..knots.len() as u32).map(between).collect()
}

/// Whether triangles are those of the canonical Delaunay triangulation.
fn is_delaunay(knots: &Knots, triangles: &[[u32; 3]]) -> Result<bool> {
    let sorted = |triangles: &[[u32; 3]]| {
        let least_first = |&[a, b, c]: &[u32; 3]| match a.min(b).min(c) {
            least if least == a => [a, b, c],
            least if least == b => [b, c, a],
            _ => [c, a, b],
        };
        let mut all: Vec<[u32; 3]> = triangles.iter().map(least_first).collect();
        all.sort_unstable();
        all
    };
    Ok(sorted(configurations::delaunay(knots)?.group(0).triangles) == sorted(triangles))
}

fn with_copies(given: &Knots, options: &Options) -> Result<Knots> {
    let knots = match options.border {
        Border::Free => given.clone(),
        Border::Clamped => given.clamped(options.degree)?,
        Border::PulledApart => given.pulled_apart()?,
    };
    match &options.pull_apart {
        None => Ok(knots),
        Some(Places::Border) => knots.pulled_apart(),
        Some(Places::All) => knots.pull_apart(&Vec::from_iter(0..given.len() as u32)),
        Some(Places::List(ids)) => match ids.iter().find(|&&id| id as usize >= given.len()) {
            Some(unknown) => {
                let count = given.len();
                Err(Error::usage(format!(
                    "--pull-apart: unknown knot {unknown}: there are {count}, counted from 0"
                )))
            }
            None => knots.pull_apart(ids),
        },
    }
}

fn start(
    knots: &Knots,
    own: Option<Vec<[u32; 3]>>,
    rule: &Rule,
    options: &Options,
    flips: &mut u64,
) -> Result<Configurations> {
    let is_pulled_apart = options.border == Border::PulledApart || options.pull_apart.is_some();
    let mut start = match (own, rule) {
        (Some(triangles), _) => Start::of_triangles(knots, &triangles)?,
        (None, Rule::Lifted(lift)) => Start::lifted(knots, lift)?,
        // The fast path.
        (None, _) if options.flips.is_none() && !is_pulled_apart => return configurations::delaunay(knots),
        (None, _) => Start::delaunay(knots)?,
    };
    if is_pulled_apart {
        start = start.generalised();
    }
    *flips = match options.flips {
        None => 0,
        Some(Flips::Random(count, seed)) => {
            start.flip_random(knots, count as usize, seed.unwrap_or(options.seed)) as u64
        }
        Some(Flips::Aligned(degrees)) => start.flip_aligned(knots, degrees) as u64,
    };
    Ok(start.configurations())
}

/// The data for making a rule.
struct Rules<'a> {
    options: &'a Options,
    frame: &'a Frame,
    /// Number of knots of the input.
    given: usize,
    /// As [`added`] returns them.
    added: &'a [[u32; 2]],
}

impl Rules<'_> {
    fn rule(&self) -> Result<Rule> {
        Ok(match self.options.rule {
            RuleName::Delaunay => Rule::Delaunay,
            RuleName::Heights => Rule::Lifted(Lift::Heights(self.numbers()?)),
            RuleName::Weights => Rule::Lifted(Lift::Weights(self.weights()?)),
            RuleName::MinWeight => Rule::MinWeight,
            RuleName::Ear => Rule::Ear,
            RuleName::Fan => Rule::Fan,
            RuleName::Random => Rule::Random(self.options.seed),
            RuleName::Aligned(degrees) => Rule::Aligned(degrees),
            RuleName::Data => match &self.options.values {
                Some(Values::Vectors(vectors)) => {
                    Rule::Gradients(self.for_all(vectors, |[a, b], [c, d]| [a.midpoint(c), b.midpoint(d)])?)
                }
                _ => Rule::Data(self.numbers()?),
            },
        })
    }

    /// Values of all knots: the given ones, or else elevations, whose unit does not matter.
    fn numbers(&self) -> Result<Vec<f64>> {
        match (&self.options.values, &self.frame.elevations) {
            (Some(Values::Numbers(numbers)), _) => self.for_all(numbers, f64::midpoint),
            (Some(Values::Vectors(_)), _) => {
                Err(Error::usage("--values has two numbers for each knot, this rule needs one"))
            }
            (None, Some(elevations)) => self.for_all(elevations, f64::midpoint),
            (None, None) => Err(Error::usage(
                "the rule needs a value for each knot: give points with a third coordinate, or --values FILE",
            )),
        }
    }

    /// Weights in squares of stored units. A common constant does not matter, so elevations are used without
    /// offset.
    fn weights(&self) -> Result<Vec<f64>> {
        let mut weights = self.numbers()?;
        if let Coordinates::I32 { scale, .. } = self.frame.coordinates {
            let unit = if self.options.values.is_some() { 1.0 } else { scale[2] };
            weights.iter_mut().for_each(|weight| *weight *= unit / (scale[0] * scale[0]));
        }
        Ok(weights)
    }

    /// The values of the input knots, extended to the added ones.
    fn for_all<T: Copy>(&self, values: &[T], mean: impl Fn(T, T) -> T) -> Result<Vec<T>> {
        if values.len() != self.given {
            let (found, needed) = (values.len(), self.given);
            return Err(Error::usage(format!(
                "{found} values for {needed} knots of the input: one each is needed"
            )));
        }
        let mut all = values.to_vec();
        extend(&mut all, self.added, mean);
        Ok(all)
    }
}

/// Gives each added knot the mean of the values of the two that it lies between.
fn extend<T: Copy>(values: &mut Vec<T>, added: &[[u32; 2]], mean: impl Fn(T, T) -> T) {
    for ends in added {
        let [a, b] = ends.map(|end| values[end as usize]);
        values.push(mean(a, b));
    }
}
