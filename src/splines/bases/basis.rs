//! A basis of splines: the functions alive at a point, with values and derivatives.

mod bends;

pub(crate) use bends::Bend;

use super::directional_limit::DirectionalLimit;
use super::domain::Domain;
use super::elements::{Elements, FunctionSets, Share};
use super::linear_simplex::{self, Factors, Found, Line, LinearSimplex};
use super::simplex;
use super::simplex::Jet;
use super::tree::Tree;
use spmesh_base::error::{Error, Result};
use spmesh_base::prefetch::prefetch;
use spmesh_delaunay::predicates::{Point2, area};

/// Functions of one degree over configurations of knots.
///
/// A function is a sum of B-splines with factors. A B-spline belongs to a set of k knots, its *interior set*,
/// and consists of the simplex splines of the configurations around that set. Functions or derivatives may
/// jump across lines through knots. On such a line they take the limit from the side of the middle of the
/// domain. Exact predicates decide sides, so values at knots, on lines and on the border are correct.
///
/// Cost: per point, one descent of a tree and a few elements; for degree 2, about four elements and seven
/// functions are nonzero.
#[derive(Debug, Clone)]
pub struct Basis {
    pub(super) degree: usize,
    pub(super) points: Vec<Point2>,
    pub(super) sets: FunctionSets,
    pub(super) greville: Vec<Point2>,
    pub(super) supports: Vec<[Point2; 2]>,
    pub(super) elements: Elements,
    /// Closed forms of the elements, where there are any.
    pub(super) linear_simplices: Vec<LinearSimplex>,
    pub(super) factors: Factors,
    pub(super) domain: Domain,
    pub(super) tree: Tree,
}

/// Buffers for evaluations; each thread needs its own.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    values: Vec<(u32, f64)>,
    jets: Vec<(u32, Jet)>,
    knots: Vec<Point2>,
}

impl Basis {
    /// Number of functions.
    pub fn len(&self) -> usize {
        self.sets.len()
    }

    /// Whether there is no function.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The degree of the polynomials that functions consist of and reproduce.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The B-splines that a function is the sum of, as interior sets with factors; for degree 0, the
    /// triangle.
    ///
    /// # Panics
    /// If there is no such function. All methods that take the number of a function panic then.
    pub fn terms(&self, function: usize) -> impl Iterator<Item = (&[u32], f64)> {
        self.sets.terms(function)
    }

    /// The Greville site of a function: the mean of the knots of its interior set. With several sets it is
    /// the mean of their means, weighted by their factors; for degree 0, it is the centroid of the triangle.
    pub fn greville(&self, function: usize) -> Point2 {
        self.greville[function]
    }

    /// The bounding box of the support of a function, as lower left and upper right corner; `None` for a
    /// function that is zero.
    pub fn support(&self, function: usize) -> Option<[Point2; 2]> {
        let [lower, upper] = self.supports[function];
        (lower[0] <= upper[0]).then_some([lower, upper])
    }

    /// Bytes held, without knots, sets and Greville sites.
    pub fn bytes(&self) -> usize {
        let linear_simplices =
            std::mem::size_of_val(&self.linear_simplices[..]) + std::mem::size_of_val(&self.factors.all[..]);
        linear_simplices + self.tree.bytes() + self.elements.bytes()
    }

    /// Whether a point is in the domain: the convex, closed region where functions sum to one and reproduce
    /// polynomials of their degree k. A point is in it if every closed half-plane that contains the point
    /// contains at least k knots, copies counted. For degrees 0 and 1 the domain is the convex hull.
    ///
    /// (Functions do not sum to one on a domain without interior, that is, a segment or a point.)
    pub fn is_in_domain(&self, x: Point2) -> bool {
        let is_right = |&line: &u32| super::domain::is_right_or_on(self.domain.lines[line as usize], x);
        self.tree.lines(x).is_some_and(|lines| lines.iter().all(is_right))
    }

    /// The directional limit that functions take at a point.
    pub fn limit_at(&self, x: Point2) -> DirectionalLimit {
        self.domain.limit_at(x)
    }

    /// The functions alive at a point, with their values, in order of their numbers.
    ///
    /// A function is alive if one of its elements contains the directional limit; its value may still be
    /// zero.
    pub fn at<'a>(&self, x: Point2, scratch: &'a mut Scratch) -> &'a [(u32, f64)] {
        scratch.values.clear();
        let elements = self.tree.elements(x);
        elements.iter().for_each(|&element| self.prefetch(element as usize));
        for &element in elements {
            self.add_values(element as usize, x, scratch);
        }
        scratch.values.sort_unstable_by_key(|&(function, _)| function);
        &scratch.values
    }

    /// The functions alive at a point, with values and derivatives, in order of their numbers. At a jump
    /// these are the limits from the side of the middle of the domain.
    ///
    /// These are the functions of [`Basis::at`].
    pub fn jets_at<'a>(&self, x: Point2, scratch: &'a mut Scratch) -> &'a [(u32, Jet)] {
        scratch.jets.clear();
        for &element in self.tree.elements(x) {
            self.add_jets(element as usize, x, scratch);
        }
        scratch.jets.sort_unstable_by_key(|&(function, _)| function);
        &scratch.jets
    }

    /// The spline with the given coefficients, one for each function, at a point.
    pub fn value(&self, coefficients: &[f64], x: Point2, scratch: &mut Scratch) -> f64 {
        self.at(x, scratch).iter().map(|&(function, value)| coefficients[function as usize] * value).sum()
    }

    /// The spline with the given coefficients, one for each function, with its derivatives at a point.
    pub fn jet(&self, coefficients: &[f64], x: Point2, scratch: &mut Scratch) -> Jet {
        let jets = self.jets_at(x, scratch).iter();
        jets.fold(Jet::default(), |sum, &(function, jet)| sum + jet * coefficients[function as usize])
    }

    /// Checks that there is one coefficient for each function, and that all are finite.
    pub(super) fn check_coefficients(&self, coefficients: &[f64]) -> Result<()> {
        if coefficients.len() != self.len() {
            let what = format!(
                "{} coefficients for {} functions: one each is needed",
                coefficients.len(),
                self.len()
            );
            return Err(Error::usage(what));
        }
        match coefficients.iter().position(|coefficient| !coefficient.is_finite()) {
            Some(bad) => Err(Error::malformed("coefficient is not finite").at(format!("function {bad}"))),
            None => Ok(()),
        }
    }

    /// Prefetches the closed form of an element, because points may come in any order.
    #[inline(always)]
    fn prefetch(&self, element: usize) {
        prefetch(&self.linear_simplices, element);
        if let Some(&start) = self.factors.offsets.get(element) {
            prefetch(&self.factors.all, start as usize);
            prefetch(&self.factors.all, start as usize + 2);
        }
    }

    #[inline]
    fn add_values(&self, element: usize, x: Point2, scratch: &mut Scratch) {
        let values = &mut scratch.values;
        self.for_each_share(element, x, &mut scratch.knots, |function, value| add(values, function, value));
    }

    /// The contribution of an element to the value of a spline at a point.
    pub(super) fn value_of_element(
        &self,
        element: usize,
        x: Point2,
        coefficients: &[f64],
        scratch: &mut Scratch,
    ) -> f64 {
        let mut sum = 0.0;
        self.for_each_share(element, x, &mut scratch.knots, |function, value| {
            sum += coefficients[function as usize] * value;
        });
        sum
    }

    /// If the point is inside the element, calls `take` with each function and the element's contribution to
    /// its value.
    #[inline(always)]
    fn for_each_share(
        &self,
        element: usize,
        x: Point2,
        knots: &mut Vec<Point2>,
        mut take: impl FnMut(u32, f64),
    ) {
        if let Some(linear_simplex) = self.linear_simplices.get(element) {
            let offset = linear_simplex.offset(x);
            let found = match linear_simplex.find(offset) {
                Found::Outside => return,
                Found::Unclear(height) => {
                    if !self.is_inside(element, x) {
                        return;
                    }
                    height
                }
                Found::Inside(height) => height,
            };
            if linear_simplex.is_exact_enough {
                let factors = self.factors.of_element(element);
                return factors.iter().for_each(|(function, line)| {
                    take(*function, linear_simplex::value(line, offset) * found)
                });
            }
        }
        self.for_each_careful_share(element, x, knots, take);
    }

    /// [`Basis::for_each_share`] by the recurrence instead of the closed form.
    #[cold]
    fn for_each_careful_share(
        &self,
        element: usize,
        x: Point2,
        knots: &mut Vec<Point2>,
        mut take: impl FnMut(u32, f64),
    ) {
        let Some(jet) = self.jet_of_element(element, x, false, knots) else { return };
        for share in self.elements.shares(element) {
            take(share.function, self.linear(share, x).value * jet.value);
        }
    }

    fn add_jets(&self, element: usize, x: Point2, scratch: &mut Scratch) {
        if let Some(linear_simplex) = self.linear_simplices.get(element) {
            let offset = linear_simplex.offset(x);
            let found = linear_simplex.find(offset);
            if found == Found::Outside {
                return;
            }
            let is_clear = linear_simplex.is_exact_enough && matches!(found, Found::Inside(_));
            if let Some(piece) = linear_simplex.piece(offset).filter(|_| is_clear) {
                let linear =
                    |line: &Line| Jet::linear(linear_simplex::value(line, offset), [line[1], line[2]]);
                let jet = linear(&piece);
                for (function, line) in self.factors.of_element(element) {
                    add(&mut scratch.jets, *function, linear(line).product(jet));
                }
                return;
            }
        }
        let Some(jet) = self.jet_of_element(element, x, true, &mut scratch.knots) else { return };
        for share in self.elements.shares(element) {
            add(&mut scratch.jets, share.function, self.linear(share, x).product(jet));
        }
    }

    /// The simplex spline of an element, by the recurrence.
    fn jet_of_element(
        &self,
        element: usize,
        x: Point2,
        has_derivatives: bool,
        knots: &mut Vec<Point2>,
    ) -> Option<Jet> {
        self.take_knots(element, knots);
        simplex::evaluate(&self.limit_at(x), knots, has_derivatives)
    }

    #[cold]
    fn is_inside(&self, element: usize, x: Point2) -> bool {
        let mut knots = Vec::new();
        self.take_knots(element, &mut knots);
        linear_simplex::is_inside(&self.limit_at(x), &knots)
    }

    fn take_knots(&self, element: usize, knots: &mut Vec<Point2>) {
        knots.clear();
        knots.extend(self.elements.knots(element).iter().map(|&id| self.points[id as usize]));
    }

    fn linear(&self, share: &Share, x: Point2) -> Jet {
        let [a, b] = share.edge.map(|id| self.points[id as usize]);
        Jet::linear(area(x, a, b), [0.5 * (a[1] - b[1]), 0.5 * (b[0] - a[0])]) * share.factor
    }
}

/// Adds a value to the entry of a function.
#[inline(always)]
fn add<T: std::ops::AddAssign>(all: &mut Vec<(u32, T)>, function: u32, value: T) {
    match all.iter_mut().find(|(other, _)| *other == function) {
        Some((_, sum)) => *sum += value,
        None => all.push((function, value)),
    }
}
