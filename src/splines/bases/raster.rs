//! Splines on the points of a raster, row by row.
//!
//! On a row y = const an element is the least of a few linear functions of x. It contributes to the spline
//! the product of this value and a linear factor: the sum of the linear factors of its functions, weighted by
//! their coefficients, which is computed beforehand. So a row costs a few divisions for each element that it
//! crosses, which yield the columns that are certainly inside. A pixel costs an evaluation of plain linear
//! functions, in a loop without branches. Columns too near to an edge are evaluated as single points.

use super::basis::{Basis, Scratch};
use super::linear_simplex::{Line, LinearSimplex, lesser, scaled, value};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::predicates::Point2;
use std::ops::Range;

/// Points at `origin + [column * step[0], row * step[1]]`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Raster {
    /// The point of the first column and the first row.
    pub origin: Point2,
    /// Distance of columns, above zero, and distance of rows, of either sign.
    pub step: [f64; 2],
    /// Number of columns.
    pub columns: usize,
    /// Number of rows.
    pub rows: usize,
}

/// A row of a raster.
#[derive(Debug, Clone, PartialEq)]
pub struct Row<'a> {
    /// Its number.
    pub row: usize,
    /// Its ordinate.
    pub y: f64,
    /// The values in all columns.
    pub values: &'a [f64],
    /// The columns in the domain: elsewhere functions do not sum to one.
    pub domain: Range<usize>,
}

impl Raster {
    /// Checks that all coordinates are finite and that rows and columns are distinct.
    fn check(&self) -> Result<()> {
        let last = [0, 1].map(|axis| {
            let count = [self.columns, self.rows][axis];
            self.origin[axis] + count as f64 * self.step[axis]
        });
        if !self.origin.iter().chain(&self.step).chain(&last).all(|number| number.is_finite()) {
            let Raster { origin, step, .. } = self;
            let what = format!("a number is not finite: the raster starts at {origin:?} with steps {step:?}");
            return Err(Error::malformed(what));
        }
        if self.step[0] <= 0.0 || self.step[1] == 0.0 {
            let what = "steps of a raster must not be zero, and columns must go from left to right";
            return Err(Error::usage(what));
        }
        Ok(())
    }

    /// The abscissa of a column.
    pub fn x(&self, column: usize) -> f64 {
        self.origin[0] + column as f64 * self.step[0]
    }

    /// The ordinate of a row.
    pub fn y(&self, row: usize) -> f64 {
        self.origin[1] + row as f64 * self.step[1]
    }

    /// The columns between two abscissae, and one more on either side.
    fn columns_around(&self, [from, to]: [f64; 2]) -> Range<usize> {
        let place = |x: f64| (x - self.origin[0]) / self.step[0];
        // Conversions saturate, and turn NaN into zero.
        let first = (place(from).ceil() as usize).saturating_sub(1).min(self.columns);
        let end = if place(to) < -1.0 {
            0
        } else {
            (place(to).floor() as usize).saturating_add(2).min(self.columns)
        };
        first..end.max(first)
    }

    /// The columns between two abscissae, without the first and the last.
    fn columns_inside(&self, [from, to]: [f64; 2]) -> Range<usize> {
        let place = |x: f64| (x - self.origin[0]) / self.step[0];
        if place(to) < 1.0 || from > to {
            return 0..0;
        }
        let first = ((place(from) + 1.0).ceil().max(0.0) as usize).min(self.columns);
        let end = (place(to).floor() as usize).min(self.columns);
        first..end.max(first)
    }
}

impl Basis {
    /// Evaluates the spline with the given coefficients on a raster, and calls `visit` with each row in turn.
    ///
    /// Values are those of [`Basis::at`] except for rounding, outside of the domain, too.
    ///
    /// Cost: per row, all elements that it crosses; per pixel, about six of them for degree 2.
    ///
    /// # Errors
    /// A number of coefficients other than the number of functions, a coefficient that is not finite, a
    /// raster with numbers out of range; errors of `visit`.
    pub fn raster(
        &self,
        coefficients: &[f64],
        raster: &Raster,
        mut visit: impl FnMut(Row<'_>) -> Result<()>,
    ) -> Result<()> {
        raster.check()?;
        self.check_coefficients(coefficients)?;
        let mut sweep = Sweep::new(self, coefficients, raster);
        for row in 0..raster.rows {
            sweep.evaluate(row);
            let (y, domain) = (raster.y(row), self.columns_of_domain(raster, raster.y(row)));
            visit(Row { row, y, values: &sweep.values, domain })?;
        }
        Ok(())
    }

    /// The columns of a row that are in the domain, which is convex.
    fn columns_of_domain(&self, raster: &Raster, y: f64) -> Range<usize> {
        let mut interval = [f64::NEG_INFINITY, f64::INFINITY];
        for &[p, q] in self.domain_lines() {
            // The cross product of q - p and x - p must not be positive.
            let (along, up) = (q[0] - p[0], q[1] - p[1]);
            narrow(&mut interval, [-along * (y - p[1]), up], p[0]);
        }
        let is_inside = |column: usize| self.is_in_domain([raster.x(column), y]);
        let around = raster.columns_around(interval);
        let Some(first) = around.clone().find(|&column| is_inside(column)) else { return 0..0 };
        let last = around.rev().find(|&column| is_inside(column)).unwrap_or(first);
        first..last + 1
    }
}

/// Restricts an interval to where `line[0] + line[1] (x - origin)` is not negative.
fn narrow(interval: &mut [f64; 2], line: [f64; 2], origin: f64) {
    let [constant, slope] = line;
    if slope > 0.0 {
        interval[0] = interval[0].max(origin - constant / slope);
    } else if slope < 0.0 {
        interval[1] = interval[1].min(origin - constant / slope);
    } else if constant < 0.0 {
        *interval = [f64::INFINITY, f64::NEG_INFINITY];
    }
}

/// The state of a sweep over the rows.
struct Sweep<'a> {
    basis: &'a Basis,
    raster: &'a Raster,
    coefficients: &'a [f64],
    /// For each element with a closed form, its linear factor in the spline.
    factors: Vec<Line>,
    /// Elements in the order in which rows meet them.
    order: Vec<u32>,
    /// How many elements of `order` the sweep has met.
    met: usize,
    /// The elements that the row crosses.
    active: Vec<u32>,
    abscissae: Vec<f64>,
    values: Vec<f64>,
    scratch: Scratch,
}

impl<'a> Sweep<'a> {
    fn new(basis: &'a Basis, coefficients: &'a [f64], raster: &'a Raster) -> Sweep<'a> {
        let factors =
            (0..basis.linear_simplices().len()).map(|at| basis.factor_of_spline(at, coefficients)).collect();
        let mut order: Vec<u32> = (0..basis.element_count() as u32).collect();
        let start = |&at: &u32| {
            let [lower, upper] = basis.rows_of(at as usize);
            if raster.step[1] > 0.0 { lower } else { -upper }
        };
        order.sort_by(|a, b| start(a).total_cmp(&start(b)));
        Sweep {
            basis,
            raster,
            coefficients,
            factors,
            order,
            met: 0,
            active: Vec::new(),
            abscissae: (0..raster.columns).map(|column| raster.x(column)).collect(),
            values: vec![0.0; raster.columns],
            scratch: Scratch::default(),
        }
    }

    fn evaluate(&mut self, row: usize) {
        let y = self.raster.y(row);
        let is_downward = self.raster.step[1] < 0.0;
        // Least and greatest ordinate of an element, negated if rows go down.
        let extent = |at: u32| {
            let [lower, upper] = self.basis.rows_of(at as usize);
            if is_downward { [-upper, -lower] } else { [lower, upper] }
        };
        let now = if is_downward { -y } else { y };
        while let Some(&at) = self.order.get(self.met).filter(|&&at| extent(at)[0] <= now) {
            self.active.push(at);
            self.met += 1;
        }
        self.active.retain(|&at| extent(at)[1] >= now);
        self.values.fill(0.0);
        for place in 0..self.active.len() {
            self.add(self.active[place] as usize, y);
        }
    }

    /// Adds an element to the row.
    fn add(&mut self, element: usize, y: f64) {
        let Some(linear_simplex) = self
            .basis
            .linear_simplices()
            .get(element)
            .filter(|linear_simplex| linear_simplex.is_exact_enough)
        else {
            let columns = self.raster.columns_around(self.basis.columns_of(element));
            return self.add_points(element, columns, y);
        };
        let [around, inside] = linear_simplex.intervals(y - linear_simplex.origin[1]);
        let around = self.raster.columns_around(around);
        let inside = self.raster.columns_inside(inside);
        if inside.is_empty() {
            return self.add_points(element, around, y);
        }
        self.add_points(element, around.start..inside.start, y);
        self.add_points(element, inside.end..around.end, y);
        add_inside(
            linear_simplex,
            self.factors[element],
            y,
            &self.abscissae[inside.clone()],
            &mut self.values[inside],
        );
    }

    fn add_points(&mut self, element: usize, columns: Range<usize>, y: f64) {
        for column in columns {
            let x = [self.abscissae[column], y];
            self.values[column] +=
                self.basis.value_of_element(element, x, self.coefficients, &mut self.scratch);
        }
    }
}

/// Adds a closed form times a linear function where it is not zero.
fn add_inside(linear_simplex: &LinearSimplex, factor: Line, y: f64, abscissae: &[f64], values: &mut [f64]) {
    let up = y - linear_simplex.origin[1];
    let along = |line: Line| [value(&line, [0.0, up]), line[1]];
    let lines = linear_simplex.lines_of_values().map(along);
    let factor = along(factor);
    let origin = linear_simplex.origin[0];
    for (x, sum) in abscissae.iter().zip(values) {
        let right = x - origin;
        let [a, b, c, d] = lines.map(|[constant, slope]| constant + slope * right);
        let height = lesser(lesser(a, b), lesser(c, d));
        *sum += height * (factor[0] + factor[1] * right);
    }
}

impl LinearSimplex {
    /// The abscissae outside of which a row is certainly outside of the support, and the abscissae between
    /// which it is certainly inside. `up` is the ordinate of the row, relative to the origin.
    fn intervals(&self, up: f64) -> [[f64; 2]; 2] {
        let (mut around, mut inside) = (self.range(), self.range());
        for line in self.edges() {
            let [constant, slope] = [value(&line, [0.0, up]), line[1]];
            narrow(&mut around, [constant + 2.0 * self.error(), slope], self.origin[0]);
            narrow(&mut inside, [constant - 2.0 * self.error(), slope], self.origin[0]);
        }
        [around, inside]
    }
}

impl Basis {
    pub(super) fn element_count(&self) -> usize {
        self.elements.len()
    }

    pub(super) fn linear_simplices(&self) -> &[LinearSimplex] {
        &self.linear_simplices
    }

    pub(crate) fn domain_lines(&self) -> &[[Point2; 2]] {
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

    /// The linear factor of an element with a closed form in a spline.
    pub(super) fn factor_of_spline(&self, element: usize, coefficients: &[f64]) -> Line {
        let factors = self.factors.of_element(element);
        factors.iter().fold([0.0; 3], |sum, (function, line)| {
            let added = scaled(*line, coefficients[*function as usize]);
            [0, 1, 2].map(|place| sum[place] + added[place])
        })
    }
}
