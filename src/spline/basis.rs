//! Bases of splines: functions that sum to one, and where they are not zero.

mod bends;

use super::approach::Approach;
use super::area::area;
use super::domain::Domain;
use super::elements::{Elements, Share, hull_area, hull_edges};
use super::jet::Jet;
use super::simplex::{self, MAX_DEGREE};
use super::tent::{self, Found, Line, Tent, line_of, scaled};
use super::tree::{Hull, Tree};
use crate::config::special::Function;
use crate::config::{self, Configurations, FARAWAY, Knots};
use crate::error::{Error, Result};
use crate::predicates::{ExpansionPredicates, Extent, Point2};
use crate::prefetch::prefetch;

/// Functions of one degree over configurations of knots.
///
/// A function is a sum of B-splines with factors, and a B-spline is what configurations collect around a set of k knots, its
/// *interior set*. On lines through knots, where functions or derivatives may jump, they have the values that they have next
/// to the line on the side of the middle of the domain: sides are told by exact predicates, so that values at knots, on
/// lines and on the border are right.
///
/// Cost: one way down a tree and a few elements for each point; for degree 2, about four elements and seven functions are
/// not zero.
#[derive(Debug, Clone)]
pub struct Basis {
    degree: usize,
    points: Vec<Point2>,
    sets: FunctionSets,
    greville: Vec<Point2>,
    supports: Vec<[Point2; 2]>,
    elements: Elements,
    /// Closed forms of the elements, where there are any.
    tents: Vec<Tent>,
    factors: Factors,
    domain: Domain,
    tree: Tree,
}

/// The interior sets of functions, with their factors.
#[derive(Debug, Clone, Default)]
struct FunctionSets {
    size: usize,
    knots: Vec<u32>,
    factors: Vec<f64>,
    offsets: Vec<u32>,
}

/// Linear factors of functions in elements, as functions of the offset from the origin of the tent.
#[derive(Debug, Clone, Default)]
struct Factors {
    offsets: Vec<u32>,
    all: Vec<(u32, Line)>,
}

/// Buffers for evaluations: one for each thread.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    values: Vec<(u32, f64)>,
    jets: Vec<(u32, Jet)>,
    knots: Vec<Point2>,
}

impl Basis {
    /// The B-splines of degree k that the links of configurations of degree k - 1 make, in the order of links, without those
    /// that are zero everywhere.
    ///
    /// They sum to one, and reproduce polynomials of degree k by polar forms, where every closed half-plane has k knots.
    ///
    /// Domain: the configurations are of these knots.
    ///
    /// Errors: knots with coordinates so great or small that areas are no numbers, too great a degree, configurations that
    /// leave no links, or of which nothing is not zero.
    ///
    /// Source: Neamtu 2004; thesis 8.1.
    pub fn new(knots: &Knots, configurations: &Configurations) -> Result<Basis> {
        check(knots, configurations)?;
        let links = config::links(knots, configurations)?;
        let mut sets = FunctionSets::new(links.size());
        let mut of_link = vec![Vec::new(); links.len()];
        for (at, link) in links.iter().enumerate().filter(|(_, link)| !link.is_null()) {
            of_link[at].push((sets.len() as u32, 1.0));
            sets.push([(link.set, 1.0)].into_iter());
        }
        let elements = of_links(knots, configurations, &links, &of_link);
        Basis::without_zeros(knots, configurations, sets, elements)
    }

    /// Functions that are sums of B-splines of degree 2, as [`config::special::Special::functions`] collects them, in their
    /// order; `configurations` are those of degree 1.
    ///
    /// Errors: those of [`Basis::new`]; configurations of another degree; a set without a link; a factor that is not finite.
    pub fn of_functions(
        knots: &Knots,
        configurations: &Configurations,
        functions: &[Function],
    ) -> Result<Basis> {
        if configurations.degree() != 1 {
            let what = format!(
                "configurations of degree {}: sums of B-splines need degree 1",
                configurations.degree()
            );
            return Err(Error::usage(what));
        }
        check(knots, configurations)?;
        let links = config::links(knots, configurations)?;
        let mut sets = FunctionSets::new(2);
        let mut of_link = vec![Vec::new(); links.len()];
        for (number, function) in (0u32..).zip(functions) {
            for (set, factor) in &function.terms {
                let named = |error: Error| error.at(format!("function {number}"));
                let Some(at) = links.find(set) else {
                    return Err(named(Error::usage(format!("knots {} and {} have no link", set[0], set[1]))));
                };
                if !factor.is_finite() {
                    return Err(named(Error::malformed("a factor is not finite")));
                }
                of_link[at].push((number, *factor));
            }
            sets.push(function.terms.iter().map(|(set, factor)| (&set[..], *factor)));
        }
        let elements = of_links(knots, configurations, &links, &of_link);
        Basis::of_elements(knots, configurations, sets, elements)
    }

    /// Functions of degree 0: one on a triangle each, and zero elsewhere; in the order of configurations, without flat ones.
    ///
    /// Errors: those of [`Basis::new`]; configurations of another degree.
    pub fn of_triangles(knots: &Knots, configurations: &Configurations) -> Result<Basis> {
        if configurations.degree() != 0 {
            let what =
                format!("configurations of degree {}: triangles have degree 0", configurations.degree());
            return Err(Error::usage(what));
        }
        check(knots, configurations)?;
        let mut sets = FunctionSets::new(3);
        configurations.iter().for_each(|(triangle, _)| sets.push([(&triangle[..], 1.0)].into_iter()));
        let elements =
            Elements::of_configurations(knots, configurations, |number, _, _, take| take(number, 1.0));
        Basis::without_zeros(knots, configurations, sets, elements)
    }

    fn without_zeros(
        knots: &Knots,
        configurations: &Configurations,
        sets: FunctionSets,
        mut elements: Elements,
    ) -> Result<Basis> {
        let mut is_used = vec![false; sets.len()];
        let shares = (0..elements.len()).flat_map(|at| elements.shares(at));
        shares.for_each(|share| is_used[share.function as usize] = true);
        let (mut numbers, mut kept) = (vec![u32::MAX; sets.len()], FunctionSets::new(sets.size));
        for function in (0..sets.len()).filter(|&function| is_used[function]) {
            numbers[function] = kept.len() as u32;
            kept.push(sets.terms(function));
        }
        elements.renumber(&numbers);
        Basis::of_elements(knots, configurations, kept, elements)
    }

    fn of_elements(
        knots: &Knots,
        configurations: &Configurations,
        sets: FunctionSets,
        elements: Elements,
    ) -> Result<Basis> {
        if elements.len() == 0 {
            return Err(Error::usage(
                "all functions are zero: knots on one line, or none that are inside of others",
            ));
        }
        let points = knots.points().to_vec();
        let domain = Domain::of(knots, configurations);
        let hulls: Vec<Hull> = (0..elements.len()).map(|at| hull(&elements, at, &points)).collect();
        let extent = Extent::of(&points);
        let tree = Tree::new(&hulls, &domain, extent.lower, extent.upper);
        let (mut tents, mut sizes) = (Vec::new(), Vec::new());
        if elements.size <= 4 {
            for (at, hull) in hulls.iter().enumerate() {
                let knots: Vec<Point2> = elements.knots(at).iter().map(|&id| points[id as usize]).collect();
                sizes.push(hull_area(&hull.edges));
                tents.push(Tent::new(&knots, &hull.edges, sizes[at]));
            }
        }
        let factors = Factors::of(&elements, &tents, &sizes, &points);
        let greville = (0..sets.len()).map(|function| sets.greville(function, &points)).collect();
        let supports = supports(&elements, &hulls, sets.len());
        let degree =
            if sets.size == 3 && configurations.degree() == 0 { 0 } else { configurations.degree() + 1 };
        Ok(Basis { degree, points, sets, greville, supports, elements, tents, factors, domain, tree })
    }

    /// Number of functions.
    #[must_use]
    pub fn len(&self) -> usize {
        self.sets.len()
    }

    /// Whether there is no function.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The degree of the polynomials that functions are made of, and that they reproduce.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The interior sets of the B-splines whose sum a function is, each with a factor; for degree 0, the triangle.
    ///
    /// Panics if there is no such function, as everything that takes its number.
    pub fn terms(&self, function: usize) -> impl Iterator<Item = (&[u32], f64)> {
        self.sets.terms(function)
    }

    /// The Greville site of a function: the mean of the knots of its interior set; the mean of several sets by their
    /// factors; for degree 0, that of the triangle.
    #[must_use]
    pub fn greville(&self, function: usize) -> Point2 {
        self.greville[function]
    }

    /// The least box that contains the support of a function, from lower left to upper right: nothing for one that is zero.
    #[must_use]
    pub fn support(&self, function: usize) -> Option<[Point2; 2]> {
        let [lower, upper] = self.supports[function];
        (lower[0] <= upper[0]).then_some([lower, upper])
    }

    /// Bytes held, without knots, sets and Greville sites.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let tents = std::mem::size_of_val(&self.tents[..]) + std::mem::size_of_val(&self.factors.all[..]);
        tents + self.tree.bytes() + self.elements.bytes()
    }

    /// Whether a point is in the domain: the convex, closed region where functions sum to one, and reproduce polynomials of
    /// their degree k. It is where every closed half-plane has k knots, copies counted; for degree 0 as for degree 1, that
    /// is the convex hull.
    ///
    /// (A domain that is a segment or a point only, without an inside, is not one where functions sum to one.)
    #[must_use]
    pub fn is_in_domain(&self, x: Point2) -> bool {
        let is_right = |&line: &u32| super::domain::is_right_or_on(self.domain.lines[line as usize], x);
        self.tree.lines(x).is_some_and(|lines| lines.iter().all(is_right))
    }

    /// From where functions look at a point.
    #[must_use]
    pub fn approach(&self, x: Point2) -> Approach {
        self.domain.approach(x)
    }

    /// The functions alive at a point, with their values, in order of their numbers.
    ///
    /// Alive are all whose elements have the point inside, as it is approached: a value may still be zero.
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

    /// The functions alive at a point, with values and derivatives, in order of their numbers: limits from the middle of the
    /// domain, where there is a jump.
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
    #[must_use]
    pub fn value(&self, coefficients: &[f64], x: Point2, scratch: &mut Scratch) -> f64 {
        self.at(x, scratch).iter().map(|&(function, value)| coefficients[function as usize] * value).sum()
    }

    /// The spline with the given coefficients, one for each function, with its derivatives at a point.
    #[must_use]
    pub fn jet(&self, coefficients: &[f64], x: Point2, scratch: &mut Scratch) -> Jet {
        let jets = self.jets_at(x, scratch).iter();
        jets.fold(Jet::default(), |sum, &(function, jet)| sum + jet * coefficients[function as usize])
    }

    /// Errors: not one finite coefficient for each function.
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

    /// Has closed forms brought into the cache: points may come in any order.
    #[inline(always)]
    fn prefetch(&self, element: usize) {
        prefetch(&self.tents, element);
        if let Some(&start) = self.factors.offsets.get(element) {
            prefetch(&self.factors.all, start as usize);
            prefetch(&self.factors.all, start as usize + 2);
        }
    }

    /// What an element adds to values at a point.
    #[inline]
    fn add_values(&self, element: usize, x: Point2, scratch: &mut Scratch) {
        let values = &mut scratch.values;
        self.for_each_share(element, x, &mut scratch.knots, |function, value| add(values, function, value));
    }

    /// What an element adds to a spline at a point.
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

    /// Calls `take` with functions and what the element adds to their values, if the point is inside.
    #[inline(always)]
    fn for_each_share(
        &self,
        element: usize,
        x: Point2,
        knots: &mut Vec<Point2>,
        mut take: impl FnMut(u32, f64),
    ) {
        if let Some(tent) = self.tents.get(element) {
            let offset = tent.offset(x);
            let found = match tent.find(offset) {
                Found::Outside => return,
                Found::Unclear(height) => {
                    if !self.is_inside(element, x) {
                        return;
                    }
                    height
                }
                Found::Inside(height) => height,
            };
            if tent.is_exact_enough {
                let factors = self.factors.of_element(element);
                return factors
                    .iter()
                    .for_each(|(function, line)| take(*function, tent::value(line, offset) * found));
            }
        }
        self.for_each_careful_share(element, x, knots, take);
    }

    /// The same by the recurrence.
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
        if let Some(tent) = self.tents.get(element) {
            let offset = tent.offset(x);
            let found = tent.find(offset);
            if found == Found::Outside {
                return;
            }
            let is_clear = tent.is_exact_enough && matches!(found, Found::Inside(_));
            if let Some(piece) = tent.piece(offset).filter(|_| is_clear) {
                let linear = |line: &Line| Jet::linear(tent::value(line, offset), [line[1], line[2]]);
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
        simplex::evaluate(&self.approach(x), knots, has_derivatives)
    }

    #[cold]
    fn is_inside(&self, element: usize, x: Point2) -> bool {
        let mut knots = Vec::new();
        self.take_knots(element, &mut knots);
        tent::is_inside(&self.approach(x), &knots)
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

/// What rasters need.
impl Basis {
    pub(super) fn element_count(&self) -> usize {
        self.elements.len()
    }

    pub(super) fn tents(&self) -> &[Tent] {
        &self.tents
    }

    pub(super) fn domain_lines(&self) -> &[[Point2; 2]] {
        &self.domain.lines
    }

    /// Least and greatest ordinate of an element.
    pub(super) fn rows_of(&self, element: usize) -> [f64; 2] {
        self.range_of(element, 1)
    }

    /// Least and greatest abscissa of an element.
    pub(super) fn columns_of(&self, element: usize) -> [f64; 2] {
        self.range_of(element, 0)
    }

    fn range_of(&self, element: usize, axis: usize) -> [f64; 2] {
        let coordinates = self.elements.knots(element).iter().map(|&id| self.points[id as usize][axis]);
        coordinates
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, greatest], c| [least.min(c), greatest.max(c)])
    }

    /// The factor of an element with a tent in a spline.
    pub(super) fn factor_of_spline(&self, element: usize, coefficients: &[f64]) -> Line {
        let factors = self.factors.of_element(element);
        factors.iter().fold([0.0; 3], |sum, (function, line)| {
            let added = scaled(*line, coefficients[*function as usize]);
            [0, 1, 2].map(|place| sum[place] + added[place])
        })
    }
}

/// Adds to what is there for a function.
#[inline(always)]
fn add<T: std::ops::AddAssign>(all: &mut Vec<(u32, T)>, function: u32, value: T) {
    match all.iter_mut().find(|(other, _)| *other == function) {
        Some((_, sum)) => *sum += value,
        None => all.push((function, value)),
    }
}

/// What is asked of all knots and configurations.
fn check(knots: &Knots, configurations: &Configurations) -> Result<()> {
    if !ExpansionPredicates::covers(&Extent::of(knots.points())) {
        let what =
            "coordinates of knots must be zero, or have magnitudes between 2^-170 and 2^240: scale them";
        return Err(Error::usage(what));
    }
    if configurations.degree() > MAX_DEGREE {
        let what = format!(
            "degree {} is more than {MAX_DEGREE}, the greatest that can be evaluated",
            configurations.degree()
        );
        return Err(Error::usage(what));
    }
    let ids = configurations.groups().flat_map(|group| {
        let boundaries = group.triangles.iter().chain(group.infinite).flatten();
        boundaries.chain(group.interior).copied()
    });
    match ids.filter(|&id| id != FARAWAY).max() {
        Some(id) if id as usize >= knots.len() => {
            Err(Error::usage(format!("unknown knot {id}: there are {}", knots.len())))
        }
        _ => Ok(()),
    }
}

/// Elements, if functions belong to links.
fn of_links(
    knots: &Knots,
    configurations: &Configurations,
    links: &config::Links,
    of_link: &[Vec<(u32, f64)>],
) -> Elements {
    let mut set = Vec::new();
    Elements::of_configurations(knots, configurations, |_, corner, interior, take| {
        set.clear();
        set.extend_from_slice(interior);
        set.insert(interior.partition_point(|&id| id < corner), corner);
        let at = links.find(&set);
        at.into_iter().flat_map(|at| &of_link[at]).for_each(|&(function, factor)| take(function, factor));
    })
}

fn hull(elements: &Elements, element: usize, points: &[Point2]) -> Hull {
    let knots: Vec<Point2> = elements.knots(element).iter().map(|&id| points[id as usize]).collect();
    let extent = Extent::of(&knots);
    Hull { lower: extent.lower, upper: extent.upper, edges: hull_edges(&knots) }
}

/// The box of each function: an empty one, if it has no element.
fn supports(elements: &Elements, hulls: &[Hull], functions: usize) -> Vec<[Point2; 2]> {
    let mut supports = vec![[[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]]; functions];
    for (at, hull) in hulls.iter().enumerate() {
        for share in elements.shares(at) {
            let [lower, upper] = &mut supports[share.function as usize];
            *lower = [0, 1].map(|axis| lower[axis].min(hull.lower[axis]));
            *upper = [0, 1].map(|axis| upper[axis].max(hull.upper[axis]));
        }
    }
    supports
}

impl FunctionSets {
    fn new(size: usize) -> FunctionSets {
        FunctionSets { size, offsets: vec![0], ..FunctionSets::default() }
    }

    fn len(&self) -> usize {
        self.offsets.len() - 1
    }

    fn push<'a>(&mut self, terms: impl Iterator<Item = (&'a [u32], f64)>) {
        for (set, factor) in terms {
            self.knots.extend_from_slice(set);
            self.factors.push(factor);
        }
        self.offsets.push(self.factors.len() as u32);
    }

    fn terms(&self, function: usize) -> impl Iterator<Item = (&[u32], f64)> {
        let range = self.offsets[function] as usize..self.offsets[function + 1] as usize;
        range.map(|at| (&self.knots[at * self.size..][..self.size], self.factors[at]))
    }

    fn greville(&self, function: usize, points: &[Point2]) -> Point2 {
        let whole: f64 = self.terms(function).map(|(_, factor)| factor).sum();
        let mean = |set: &[u32], axis: usize| {
            set.iter().map(|&id| points[id as usize][axis]).sum::<f64>() / self.size as f64
        };
        [0, 1].map(|axis| {
            self.terms(function).map(|(set, factor)| mean(set, axis) * factor).sum::<f64>() / whole
        })
    }
}

impl Factors {
    /// Those of elements that have tents, over supports of given sizes.
    fn of(elements: &Elements, tents: &[Tent], sizes: &[f64], points: &[Point2]) -> Factors {
        let mut factors = Factors { offsets: vec![0], all: Vec::new() };
        for (at, (tent, size)) in tents.iter().zip(sizes).enumerate() {
            for shares in elements.shares(at).chunk_by(|a, b| a.function == b.function) {
                let mut sum = [0.0; 3];
                for share in shares {
                    let edge = share.edge.map(|id| points[id as usize]);
                    let line = scaled(line_of(edge, tent.origin), share.factor / size);
                    sum = [0, 1, 2].map(|place| sum[place] + line[place]);
                }
                factors.all.push((shares[0].function, sum));
            }
            factors.offsets.push(factors.all.len() as u32);
        }
        factors
    }

    #[inline(always)]
    fn of_element(&self, element: usize) -> &[(u32, Line)] {
        &self.all[self.offsets[element] as usize..self.offsets[element + 1] as usize]
    }
}
