//! Maps of quotients of sums, in few pixels.

/// Most pixels along a side.
const PIXELS_MAX: f64 = 512.0;

/// A box in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Least coordinates.
    pub min: [f64; 2],
    /// Greatest coordinates.
    pub max: [f64; 2],
}

/// A map: what its pixels have of one sum over what they have of another.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Number of columns.
    pub columns: usize,
    /// Number of rows.
    pub rows: usize,
    /// Side of pixels, in units of the world.
    pub side: f64,
    left: f64,
    top: f64,
    sums: Vec<[f64; 2]>,
}

impl Picture {
    /// An empty map of a box of cells with this side, on which pixels have 1, 2, 4 and so on.
    pub(super) fn of(frame: &Frame, cell: f64) -> Picture {
        let [width, height] = [0, 1].map(|axis| (frame.max[axis] - frame.min[axis]).max(cell));
        let mut side = cell;
        while width.max(height) > PIXELS_MAX * side {
            side *= 2.0;
        }
        // The tolerance leaves out a column that is there by rounding only.
        let [columns, rows] = [width, height].map(|size| (size / side - 1e-6).ceil().max(1.0) as usize);
        let sums = vec![[0.0; 2]; columns * rows];
        Picture { columns, rows, side, left: frame.min[0], top: frame.max[1], sums }
    }

    /// Adds to both sums at a place; places outside are left out.
    pub(super) fn add(&mut self, [x, y]: [f64; 2], amounts: [f64; 2]) {
        let (column, row) = ((x - self.left) / self.side, (self.top - y) / self.side);
        let is_inside = column >= 0.0 && row >= 0.0 && column < self.columns as f64 && row < self.rows as f64;
        if is_inside {
            let sums = &mut self.sums[row as usize * self.columns + column as usize];
            *sums = [sums[0] + amounts[0], sums[1] + amounts[1]];
        }
    }

    /// The quotients row by row from the top; `None` where there is nothing.
    pub fn values(&self) -> impl Iterator<Item = Option<f64>> {
        self.sums.iter().map(|[part, whole]| (*whole > 0.0).then(|| part / whole))
    }
}
