//! Cells of the finalization, with the times of their first and last points (thesis, figure 5.1).

use std::collections::BTreeMap;

use super::projection::Scene;
use super::style::Colours;
use super::svg;
use spmesh_base::error::Result;
use spmesh_formats::raster::colour_map::hex;
use spmesh_stream::model::bounds::Point;
use spmesh_stream::model::cells::{CellCode, CellTree};
use spmesh_stream::{Coordinates, FinalizedCells};

/// The least side of a cell that is drawn. Units: lengths of the picture.
const SIDE_MIN: f64 = 8.0;
/// The width of the border of a cell, as a part of its side.
const BORDER: f64 = 0.25;
/// The deepest level that is drawn. It keeps codes within 64 bits, and bounds the number of cells by the
/// picture.
const LEVEL_MAX: u8 = 12;

/// When the first and the last point of a cell came, in points before them.
type Times = [u64; 2];

/// The cells that points lie in, at a level where cells are still visible.
///
/// Memory: proportional to the number of cells in the picture, plus the memory of [`FinalizedCells`].
#[derive(Debug)]
pub(super) struct Cells {
    tree: CellTree,
    coordinates: Coordinates,
    /// The level of cells that points are counted in.
    level: u8,
    final_cells: FinalizedCells,
    /// Cells of that level that have points and are not final.
    open: BTreeMap<u64, Times>,
    /// Final cells with points, of the level of their tag.
    closed: Vec<(CellCode, Times)>,
    /// The corners of the cell of the last point, and its code if it is visible. Neighbours in the stream are
    /// often neighbours in the plane.
    last: Option<([Point; 2], Option<u64>)>,
}

impl Cells {
    /// No points so far, in a quadtree.
    pub(super) fn new(tree: CellTree, coordinates: Coordinates, scene: &Scene) -> Cells {
        let origin = tree.origin();
        let opposite = [0, 1, 2].map(|axis| origin[axis] + tree.side());
        let [from, to] = [origin, opposite].map(|corner| scene.view.place(coordinates.to_world(corner)));
        let levels = ((to[0] - from[0]) / SIDE_MIN).log2().floor();
        // Conversion turns NaN into zero.
        let level = (levels.max(0.0) as u8).min(tree.depth()).min(LEVEL_MAX);
        Cells {
            tree,
            coordinates,
            level,
            final_cells: FinalizedCells::new(tree),
            open: BTreeMap::new(),
            closed: Vec::new(),
            last: None,
        }
    }

    /// Takes a point in stored coordinates; `number` is the number of points before it.
    pub(super) fn point(&mut self, at: Point, number: u64, scene: &Scene) {
        let is_in = |[min, max]: [Point; 2]| (0..2).all(|axis| min[axis] <= at[axis] && at[axis] < max[axis]);
        let code = match self.last {
            Some((corners, code)) if is_in(corners) => code,
            _ if !self.tree.contains(at) => None,
            _ => {
                let cell = self.tree.cell_of(at, self.level);
                let code = self.sides(cell, scene).map(|_| cell.0);
                self.last = Some((self.tree.corners(cell).into(), code));
                code
            }
        };
        if let Some(code) = code {
            self.open.entry(code).or_insert([number; 2])[1] = number;
        }
    }

    /// Takes a finalization tag.
    pub(super) fn finalize(&mut self, cell: CellCode) -> Result<()> {
        self.final_cells.finalize(cell)?;
        let level = self.tree.level(cell);
        let cell = if level <= self.level {
            cell
        } else {
            // A part of a visible cell, which becomes final with its last part.
            CellCode(cell.0 >> (2 * (level - self.level)))
        };
        if !self.final_cells.is_final_cell(cell) {
            return Ok(());
        }
        let shift = 2 * (self.level - self.tree.level(cell));
        let codes = cell.0 << shift..(cell.0 + 1) << shift;
        let inside: Vec<(u64, Times)> = self.open.range(codes).map(|(&code, &times)| (code, times)).collect();
        let all = inside.iter().map(|&(_, times)| times).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        for (code, _) in &inside {
            self.open.remove(code);
        }
        self.closed.extend(all.map(|times| (cell, times)));
        Ok(())
    }

    /// All cells. The middle of a cell has the colour of its first point. The border of a final cell has the
    /// colour of its last point; the border of an open cell is not filled.
    pub(super) fn vectors(&self, scene: &Scene, colours: &Colours) -> String {
        let colour = |time: u64| hex(colours.of(time as f64, 1.0));
        let mut text = "<g id=\"cells\" stroke=\"#fff\" stroke-width=\"0.5\">\n".to_string();
        for &(cell, [first, last]) in &self.closed {
            let Some(sides) = self.sides(cell, scene) else { continue };
            text += &rectangle(sides, &format!("fill=\"{}\"", colour(last)));
            text += &rectangle(inner(sides), &format!("fill=\"{}\" stroke=\"none\"", colour(first)));
        }
        text += "</g>\n<g id=\"open\" stroke=\"#24292f\" stroke-opacity=\"0.5\" stroke-width=\"0.75\" fill=\"none\">\n";
        for (&code, &[first, _]) in &self.open {
            let Some(sides) = self.sides(CellCode(code), scene) else { continue };
            text += &rectangle(sides, "");
            text += &rectangle(inner(sides), &format!("fill=\"{}\" stroke=\"none\"", colour(first)));
        }
        text + "</g>\n"
    }

    /// The numbers of final and of open cells with points.
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.closed.len(), self.open.len()]
    }

    /// The left, upper, right and lower side of the visible part of a cell.
    fn sides(&self, cell: CellCode, scene: &Scene) -> Option<[f64; 4]> {
        let (min, max) = self.tree.corners(cell);
        let [min, max] = [min, max].map(|corner| self.coordinates.to_world(corner));
        if !scene.may_show(&[min, max]) {
            return None;
        }
        let [[left, lower, _], [right, upper, _]] = [min, max].map(|corner| scene.view.place(corner));
        // A cell may reach beyond all points; only the part with points is drawn.
        let [x, y, end_x, end_y] = scene.sides();
        let sides = [left.max(x), upper.max(y), right.min(end_x), lower.min(end_y)];
        (sides[0] < sides[2] && sides[1] < sides[3]).then_some(sides)
    }
}

/// The inside of a cell, without its border.
fn inner([left, upper, right, lower]: [f64; 4]) -> [f64; 4] {
    let (x, y) = (BORDER * (right - left), BORDER * (lower - upper));
    [left + x, upper + y, right - x, lower - y]
}

fn rectangle([left, upper, right, lower]: [f64; 4], attributes: &str) -> String {
    let [x, y, width, height] = [left, upper, right - left, lower - upper].map(svg::length);
    format!(
        "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" vector-effect=\"non-scaling-stroke\" {attributes}/>\n"
    )
}
