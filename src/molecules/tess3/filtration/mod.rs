//! The filtration of the alpha complex: each simplex of the Delaunay tetrahedralization with the square of
//! the radius from which on it belongs to the alpha complex, in an order in which faces come before cofaces.
//!
//! With weights, which are squares of radii of balls, the tetrahedralization is the regular one, and values
//! are powers of orthocentres: at the value t, the complex is that of the balls whose squared radii are
//! greater by t. Hidden points and duplicates are in no simplex.
//!
//! All decisions are exact: what is attached, and the order. Text has 17 digits of values, which are rounded
//! once, unless a value is a shorter decimal number.
//!
//! Source: Edelsbrunner and Mücke, "Three-dimensional alpha shapes", 1994; with weights Edelsbrunner, "The
//! union of balls and its dual shape", 1995.

mod complex;
mod decimal;
mod double;
mod orthosphere;
mod sites;
mod value;

use std::io::Write;

use complex::Table;
use decimal::Decimals;
use sites::{Sites, dimension, vertices};
use spmesh_base::error::{Error, Result};
use spmesh_delaunay::delaunay3::Tetrahedralization;
use spmesh_delaunay::predicates::Point3;
use value::Order;

/// Bytes of text that are buffered before they are written.
const TEXT_LEN: usize = 1 << 16;

/// A filtration.
#[derive(Debug)]
pub struct Filtration<'p> {
    sites: Sites<'p>,
    table: Table,
    order: Order,
}

impl<'p> Filtration<'p> {
    /// The filtration of points with weights, if there are any, and their exact tetrahedralization: the
    /// Delaunay or the regular one.
    ///
    /// Domain: `weights` has a weight for each point, in the square of the unit of coordinates. Points in a
    /// plane, whose tetrahedralization is empty, are fine.
    ///
    /// Cost: O(n log n) for n simplices. Memory: about 1.6 kB per point for points spread evenly in space.
    ///
    /// # Errors
    /// Those of the kernel, which is called for points in a plane.
    pub fn new(points: &'p [Point3], weights: Option<&'p [f64]>, mesh: &Tetrahedralization) -> Result<Self> {
        let sites = Sites::new(points, weights);
        let is_flat = mesh.tetrahedra().is_empty() && !points.is_empty();
        let table = if is_flat {
            complex::simplices(&sites, &sites::tetrahedralize(points, weights)?)
        } else {
            complex::simplices(&sites, mesh)
        };
        let order = value::order(&sites, &table);
        Ok(Filtration { sites, table, order })
    }

    /// Writes a line for each simplex: its dimension, the indices of its vertices (from 0, increasing), its
    /// value, and a bound on the error of the value as it is written. Values are in squares of `scale`, which
    /// is the world units per unit of the coordinates and stands for the shortest decimal that is rounded to
    /// it.
    ///
    /// Lines are in order of values, and those of equal values by dimension, then by vertices.
    ///
    /// # Errors
    /// If writing fails.
    pub fn write(&self, output: &mut impl Write, scale: f64) -> Result<()> {
        let failed = |cause| Error::io("writing the filtration", cause);
        let decimals = Decimals::new(scale, self.sites.exponent());
        let (mut text, mut value) = (Vec::new(), Vec::new());
        let mut start = 0;
        for &end in &self.order.ends {
            let group = &self.order.numbers[start..end as usize];
            start = end as usize;
            value.clear();
            let carrier = self.table.carriers[group[0] as usize] as usize;
            let exact = || self.sites.fraction(&self.table.simplices[carrier]);
            decimals.write(&mut value, &self.table.values[carrier], exact).map_err(failed)?;
            for &number in group {
                let simplex = &self.table.simplices[number as usize];
                write!(text, "{} ", dimension(simplex)).map_err(failed)?;
                for vertex in vertices(simplex) {
                    write!(text, "{vertex} ").map_err(failed)?;
                }
                text.extend_from_slice(&value);
                text.push(b'\n');
                if text.len() >= TEXT_LEN {
                    output.write_all(&text).map_err(failed)?;
                    text.clear();
                }
            }
        }
        output.write_all(&text).map_err(failed)
    }
}
