//! The rules of configurations that span blocks; the reader, the text twin and the writer share them.

use std::cmp::Ordering;

use super::configurations::{ConfigurationBlock, check_degree};
use super::kind::Kind;
use crate::model::configurations::{Claim, FARAWAY};
use spmesh_base::error::{Error, Result};

/// State against which later blocks are checked.
#[derive(Debug, Default)]
pub(super) struct ConfigurationRules {
    degree: Option<(u32, Claim)>,
    /// Whether there is a degree 1, whose links name the B-splines of functions.
    has_pairs: bool,
    /// Whether the stream may hold one degree only.
    is_alone: bool,
    /// The last group of the degree.
    group: Option<LastGroup>,
}

#[derive(Debug)]
struct LastGroup {
    interior: Vec<u32>,
    /// The last boundary of the group.
    boundary: Option<[u32; 3]>,
}

impl ConfigurationRules {
    pub(super) fn new(kind: Kind) -> Self {
        ConfigurationRules { is_alone: kind == Kind::Splines, ..ConfigurationRules::default() }
    }

    /// Checks the next block; `knots` knots came before.
    pub(super) fn block(&mut self, block: &ConfigurationBlock, knots: u64) -> Result<()> {
        self.degree(block.degree, block.claim)?;
        for (number, (interior, boundaries)) in block.groups().enumerate() {
            self.group(interior, number == 0, knots)?;
            if boundaries.is_empty() {
                return Err(Error::malformed(format!("interior set {interior:?} has no configuration")));
            }
            boundaries.iter().try_for_each(|&boundary| self.boundary(block.degree, boundary, knots))?;
        }
        Ok(())
    }

    fn degree(&mut self, degree: u32, claim: Claim) -> Result<()> {
        check_degree(degree)?;
        match self.degree {
            Some((last, _)) if degree < last => {
                return Err(Error::malformed(format!(
                    "configurations of degree {degree} after those of {last}"
                )));
            }
            Some((last, known)) if degree == last && claim != known => {
                return Err(Error::malformed(format!(
                    "the configurations of degree {degree} change their standing"
                )));
            }
            Some((last, _)) if degree == last => {}
            Some((last, _)) if self.is_alone => {
                return Err(Error::malformed(format!(
                    "configurations of degree {degree} after those of {last}: splines have one degree"
                )));
            }
            _ => self.group = None,
        }
        self.degree = Some((degree, claim));
        self.has_pairs |= degree == 1;
        Ok(())
    }

    /// Checks that functions may follow: they are sums of B-splines of links of pairs of knots.
    pub(super) fn check_functions(&self) -> Result<()> {
        if self.has_pairs {
            return Ok(());
        }
        Err(Error::malformed(
            "functions in a stream without configurations of degree 1, whose links their terms name",
        ))
    }

    /// Checks that a spline has a degree.
    pub(super) fn check_end(&self) -> Result<()> {
        if !self.is_alone || self.degree.is_some() {
            return Ok(());
        }
        Err(Error::malformed("END: a spline without configurations, expected a block CONF with its degree"))
    }

    /// Checks the next group of the degree. The first group of a block may continue the last group.
    fn group(&mut self, interior: &[u32], is_first: bool, knots: u64) -> Result<()> {
        if let Some(last) = &self.group {
            match interior.cmp(&last.interior) {
                Ordering::Equal if is_first => return Ok(()),
                Ordering::Greater => {}
                _ => {
                    return Err(Error::malformed(format!(
                        "interior set {interior:?} does not follow {:?}",
                        last.interior
                    )));
                }
            }
        }
        let is_increasing = interior.windows(2).all(|pair| pair[0] < pair[1]);
        if !is_increasing || interior.last().is_some_and(|&knot| !is_knot(knot, knots)) {
            return Err(Error::malformed(format!(
                "interior set {interior:?} is not of increasing numbers of {knots} knots"
            )));
        }
        self.group = Some(LastGroup { interior: interior.to_vec(), boundary: None });
        Ok(())
    }

    /// Checks the next boundary of the group.
    fn boundary(&mut self, degree: u32, boundary: [u32; 3], knots: u64) -> Result<()> {
        let group = self.group.as_mut().expect("a boundary is in a group");
        let fail = |what: &str| Err(Error::malformed(format!("boundary {boundary:?} {what}")));
        let [a, b, c] = boundary;
        let is_infinite = c == FARAWAY;
        if ![a, b].iter().all(|&v| is_knot(v, knots)) || !(is_infinite || is_knot(c, knots)) {
            return fail(&format!("is not of numbers of {knots} knots"));
        }
        if a == b || b == c || c == a {
            return fail("repeats a knot");
        }
        if !is_infinite && a > b.min(c) {
            return fail("does not have its least knot first");
        }
        if let Some(knot) = boundary.iter().find(|knot| group.interior.binary_search(knot).is_ok()) {
            return fail(&format!("has knot {knot}, which is in the interior set {:?}", group.interior));
        }
        if let Some(last) = group.boundary {
            let was_infinite = last[2] == FARAWAY;
            // The start triangulation keeps its own order.
            let is_sorted = degree == 0 || (is_infinite && !was_infinite) || last < boundary;
            if (was_infinite && !is_infinite) || !is_sorted {
                return fail(&format!("does not follow {last:?} in its group"));
            }
        }
        group.boundary = Some(boundary);
        Ok(())
    }
}

/// Whether a number is the number of a knot; the faraway point is none.
fn is_knot(number: u32, knots: u64) -> bool {
    u64::from(number) < knots && number != FARAWAY
}
