//! Boxes of the world in steps of a file's grid.

use spmesh_stream::Coordinates;
use spmesh_stream::model::bounds::{Bounds, Point};

/// The smallest box of stored integers that holds `bounds`, and `slack` more steps per axis on each side.
///
/// A stored point that lies in `bounds` is in the box, however the product of scale and integer is rounded.
pub(crate) fn outward(coordinates: &Coordinates, bounds: &Bounds, slack: Point) -> Bounds {
    let steps = |side: Point, axis: usize| match coordinates {
        Coordinates::I32 { scale, offset } => (side[axis] - offset[axis]) / scale[axis],
        Coordinates::F64 => side[axis],
    };
    Bounds {
        min: std::array::from_fn(|axis| steps(bounds.min, axis).floor() - slack[axis]),
        max: std::array::from_fn(|axis| steps(bounds.max, axis).ceil() + slack[axis]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_grows_to_whole_steps() {
        let coordinates = Coordinates::I32 { scale: [0.01; 3], offset: [1000.0, 0.0, -5.0] };
        let infinite = f64::INFINITY;
        let bounds = Bounds { min: [1000.015, -0.07, -infinite], max: [1000.07, 0.07, infinite] };
        let found = outward(&coordinates, &bounds, [0.0; 3]);
        assert_eq!((found.min[0], found.min[2], found.max[2]), (1.0, -infinite, infinite));
        for (x, y) in [(2.0, -7.0), (7.0, 7.0)] {
            assert!(found.contains([x, y, 0.0]), "{found:?}");
        }
        let wider = outward(&coordinates, &bounds, [1.0; 3]);
        assert_eq!((wider.min[0], wider.max[1]), (0.0, found.max[1] + 1.0));
    }
}
