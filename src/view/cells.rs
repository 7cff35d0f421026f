//! Cells of the finalization, with the times of their first and of their last point (thesis, figure 5.1).

use std::collections::BTreeMap;

use super::look::Colours;
use super::ramp::hex;
use super::stage::Stage;
use super::svg;
use spmesh_core::error::Result;
use spmesh_model::bounds::Point;
use spmesh_model::cells::{CellCode, CellTree};
use spmesh_stream::{Coordinates, FinalizedCells};

/// Cells are not drawn smaller. Units: lengths of the picture.
const SIDE_MIN: f64 = 8.0;
/// The part of the side of a cell that its border takes.
const BORDER: f64 = 0.25;
/// Most levels of cells that are drawn, so that their codes are numbers of 64 bits and their number is that of the picture.
const LEVEL_MAX: u8 = 12;

/// When the first and the last point of a cell came: the numbers of points before them.
type Times = [u64; 2];

/// The cells that points lie in, none smaller than can be seen.
///
/// Memory: with the number of cells in the picture, and what [`FinalizedCells`] needs.
#[derive(Debug)]
pub(super) struct Cells {
    tree: CellTree,
    coordinates: Coordinates,
    /// The level of cells that points are counted in.
    level: u8,
    final_cells: FinalizedCells,
    /// Cells of that level with points, and not final yet.
    open: BTreeMap<u64, Times>,
    /// Final cells with points, as large as they were tagged.
    closed: Vec<(CellCode, Times)>,
    /// The corners of the cell of the last point, and its code if it can be seen: points near each other in the stream are so in
    /// the plane.
    last: Option<([Point; 2], Option<u64>)>,
}

impl Cells {
    /// No points so far, in a tree of the plane.
    pub(super) fn new(tree: CellTree, coordinates: Coordinates, stage: &Stage) -> Cells {
        let origin = tree.origin();
        let opposite = [0, 1, 2].map(|axis| origin[axis] + tree.side());
        let [from, to] = [origin, opposite].map(|corner| stage.view.place(coordinates.to_world(corner)));
        let levels = ((to[0] - from[0]) / SIDE_MIN).log2().floor();
        // What is not a number becomes zero.
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

    /// Takes a point, in stored coordinates, with the number of points before it.
    pub(super) fn point(&mut self, at: Point, number: u64, stage: &Stage) {
        let is_in = |[min, max]: [Point; 2]| (0..2).all(|axis| min[axis] <= at[axis] && at[axis] < max[axis]);
        let code = match self.last {
            Some((corners, code)) if is_in(corners) => code,
            _ if !self.tree.contains(at) => None,
            _ => {
                let cell = self.tree.cell_of(at, self.level);
                let code = self.sides(cell, stage).map(|_| cell.0);
                self.last = Some((self.tree.corners(cell).into(), code));
                code
            }
        };
        if let Some(code) = code {
            self.open.entry(code).or_insert([number; 2])[1] = number;
        }
    }

    /// Takes a tag.
    ///
    /// # Errors
    /// If it is that of no cell of the tree, or of one that is final already.
    pub(super) fn finalize(&mut self, cell: CellCode) -> Result<()> {
        self.final_cells.finalize(cell)?;
        let level = self.tree.level(cell);
        let cell = if level <= self.level {
            cell
        } else {
            // Parts of what can be seen: that is final with the last of them.
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

    /// Final cells, their middle in the colour of their first point and their border in that of their last one; open ones with a
    /// border that is not filled.
    pub(super) fn vectors(&self, stage: &Stage, colours: &Colours) -> String {
        let colour = |time: u64| hex(colours.of(time as f64, 1.0));
        let mut text = "<g id=\"cells\" stroke=\"#fff\" stroke-width=\"0.5\">\n".to_string();
        for &(cell, [first, last]) in &self.closed {
            let Some(sides) = self.sides(cell, stage) else { continue };
            text += &rectangle(sides, &format!("fill=\"{}\"", colour(last)));
            text += &rectangle(inner(sides), &format!("fill=\"{}\" stroke=\"none\"", colour(first)));
        }
        text += "</g>\n<g id=\"open\" stroke=\"#24292f\" stroke-opacity=\"0.5\" stroke-width=\"0.75\" fill=\"none\">\n";
        for (&code, &[first, _]) in &self.open {
            let Some(sides) = self.sides(CellCode(code), stage) else { continue };
            text += &rectangle(sides, "");
            text += &rectangle(inner(sides), &format!("fill=\"{}\" stroke=\"none\"", colour(first)));
        }
        text + "</g>\n"
    }

    /// Number of final cells with points, and of open ones.
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.closed.len(), self.open.len()]
    }

    /// Left, upper, right and lower side of what can be seen of a cell.
    fn sides(&self, cell: CellCode, stage: &Stage) -> Option<[f64; 4]> {
        let (min, max) = self.tree.corners(cell);
        let [min, max] = [min, max].map(|corner| self.coordinates.to_world(corner));
        if !stage.may_show(&[min, max]) {
            return None;
        }
        let [[left, lower, _], [right, upper, _]] = [min, max].map(|corner| stage.view.place(corner));
        // Of a cell that reaches beyond the points, the part with points is all that matters.
        let [x, y, end_x, end_y] = stage.sides();
        let sides = [left.max(x), upper.max(y), right.min(end_x), lower.min(end_y)];
        (sides[0] < sides[2] && sides[1] < sides[3]).then_some(sides)
    }
}

/// What the border of a cell leaves.
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
