//! The audit of a stream of configurations: everything in it is held, and proved when it is complete.

use super::set::Collector;
use super::{
    Claim, ConfigurationSet, Configurations, FacetCounts, Knots, check_centroids, check_circles,
    check_facets, check_functions, check_start,
};
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::Event;

/// Audit of one stream of configurations: start with the default, pass it every event, then call
/// [`StreamAudit::prove`].
///
/// Domain: the events must come from a [`spmesh_stream::StreamReader`], which has checked the form of each
/// block.
///
/// Memory: what the stream holds; and for facets, 4 (k + 4) bytes for each of three facets of each
/// configuration of two degrees.
#[derive(Debug, Default)]
pub struct StreamAudit {
    collector: Collector,
    proof: Option<std::result::Result<Proof, Violation>>,
}

/// Counts of what was proved.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Proof {
    /// Knots, copies included.
    pub knots: usize,
    /// Places of knots.
    pub places: usize,
    /// Most knots at one place.
    pub multiplicity_max: usize,
    /// By degree.
    pub degrees: Vec<DegreeProof>,
    /// Functions whose terms have links.
    pub functions: usize,
}

/// What was proved of a degree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DegreeProof {
    /// The degree.
    pub degree: usize,
    /// Configurations of three knots.
    pub finite: usize,
    /// Configurations of two knots and the faraway point.
    pub infinite: usize,
    /// Whether circles were checked to contain their interior sets and no other knots: only where
    /// configurations claim to be Delaunay.
    pub has_circles: bool,
    /// Counts of facets, which match, so that the centroid triangulation is planar; `None` unless the degree
    /// is 0 or the degree below is in the stream.
    pub facets: Option<FacetCounts>,
    /// Whether their number was checked against theory, which takes all degrees below in the stream.
    pub is_counted: bool,
}

/// The first violation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Violation {
    /// Name of the claim that does not hold: `circles`, `facets`, `centroids`, `counts` or `functions`.
    pub claim: &'static str,
    /// The degree.
    pub degree: usize,
    /// Describes the violation and where it is.
    pub message: String,
}

impl StreamAudit {
    /// Adds the next event.
    ///
    /// # Errors
    /// If there are too many configurations to hold.
    pub fn event(&mut self, event: &Event) -> Result<()> {
        self.collector.event(event)
    }

    /// Proves what the stream claims; all events up to END have been given.
    ///
    /// # Errors
    /// The first violation (kind [`ErrorKind::Audit`]), or that there are too many knots.
    pub fn prove(&mut self) -> Result<()> {
        let set = std::mem::take(&mut self.collector).finish()?;
        let proof = check(&set);
        let failure = proof.as_ref().err().map(|Violation { claim, degree, message }| {
            Error::new(ErrorKind::Audit, format!("degree {degree}: {claim} check failed: {message}"))
        });
        self.proof = Some(proof);
        failure.map_or(Ok(()), Err)
    }

    /// The result of [`StreamAudit::prove`].
    pub fn proof(&self) -> Option<&std::result::Result<Proof, Violation>> {
        self.proof.as_ref()
    }
}

/// Proves the claims of each degree.
///
/// # Errors
/// The first violation.
pub fn check(set: &ConfigurationSet) -> std::result::Result<Proof, Violation> {
    let knots = &set.knots;
    let ranks = || (0..knots.len() as u32).map(|id| knots.rank(id));
    let mut proof = Proof {
        knots: knots.len(),
        places: ranks().filter(|&rank| rank == 0).count(),
        multiplicity_max: ranks().max().map_or(0, |rank| rank as usize + 1),
        degrees: Vec::new(),
        functions: set.functions.len(),
    };
    // Infinite configurations of this degree and those below, as long as none is missing.
    let mut lines = Some(0);
    let mut lower: Option<&Configurations> = None;
    for upper in &set.degrees {
        let degree = upper.degree();
        let violation = |claim| move |error: Error| Violation { claim, degree, message: error.to_string() };
        let has_circles = upper.claim() == Claim::Delaunay;
        if has_circles {
            check_circles(knots, upper).map_err(violation("circles"))?;
        }
        let below = lower.filter(|lower| lower.degree() + 1 == degree);
        let facets = match below {
            _ if degree == 0 => Some(check_start(upper)),
            Some(lower) => Some(check_facets(lower, upper)),
            None => None,
        };
        let facets = facets.transpose().map_err(violation("facets"))?;
        check_centroids(knots, upper).map_err(violation("centroids"))?;
        lines = lines.filter(|_| facets.is_some()).map(|lines| lines + upper.infinite_len());
        if let Some(lines) = lines {
            check_count(knots, upper, lines).map_err(violation("counts"))?;
        }
        let (finite, infinite, is_counted) = (upper.finite_len(), upper.infinite_len(), lines.is_some());
        proof.degrees.push(DegreeProof { degree, finite, infinite, has_circles, facets, is_counted });
        lower = Some(upper);
    }
    let pairs = set.degrees.iter().find(|configurations| configurations.degree() == 1);
    check_functions(pairs, &set.functions).map_err(|error| Violation {
        claim: "functions",
        degree: 1,
        message: error.to_string(),
    })?;
    Ok(proof)
}

/// Checks that there are 2 (k + 1) n - (k + 1) (k + 2) - e configurations of degree k, where e is the number
/// of infinite configurations of degrees up to k. It follows from Euler's relation of all centroid
/// triangulations, whatever the rule (D. T. Lee's count of Voronoi vertices of order k is the Delaunay case).
fn check_count(knots: &Knots, configurations: &Configurations, lines: usize) -> Result<()> {
    let (next, count) = (configurations.degree() as i128 + 1, configurations.finite_len() as i128);
    let expected = 2 * next * knots.len() as i128 - next * (next + 1) - lines as i128;
    if count == expected {
        return Ok(());
    }
    let message =
        format!("{count} configurations, but {expected} follow from {} knots and {lines} lines", knots.len());
    Err(Error::new(ErrorKind::Audit, message))
}
