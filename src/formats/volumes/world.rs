//! World coordinates of the sites of a grid, by the affine map that a header states.

use crate::volumes::lattice::Frame;
use crate::volumes::orientation::Orientation;
use spmesh_stream::model::bounds::Point;

/// Parts of a vector below this share of its length are taken for the rounding of f32, or of decimal numbers.
const ROUNDING: f64 = 1e-6;

/// Axes are taken for perpendicular if the cosines of their angles are below this: headers state directions
/// with few digits.
const COSINE_MAX: f64 = 1e-4;

/// The coordinates of the sites of a grid in world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct World {
    /// The coordinate in space (0, 1 or 2 for x, y and z) that changes along each spatial axis of the grid.
    pub coordinates: [usize; 3],
    pub frame: Frame,
    /// Set if the grid is oblique: then the frame gives distances along its axes.
    pub orientation: Option<Orientation>,
}

impl World {
    /// The sites `origin + i * steps[0] + j * steps[1] + k * steps[2]`; `sizes` are the distances between
    /// sites as a header states them beside the steps, if it does. `time` is the first time and the time
    /// step.
    ///
    /// # Errors
    /// The reason why there are no such coordinates: the axes are oblique to each other, or a number is
    /// infinite or zero.
    pub(crate) fn new(
        origin: Point,
        steps: [Point; 3],
        sizes: Option<[f64; 3]>,
        time: [f64; 2],
    ) -> Result<World, String> {
        let lengths = steps.map(length);
        let numbers = origin.iter().chain(&time).chain(steps.as_flattened());
        if !numbers.into_iter().all(|number| number.is_finite()) || lengths.contains(&0.0) || time[1] == 0.0 {
            let [x, y, z] = lengths;
            return Err(format!("sites cannot be {:?} apart, starting at {origin:?}", [x, y, z, time[1]]));
        }
        let steps = steps.map(without_rounding);
        if let Some(coordinates) = coordinates(&steps) {
            let mut frame = Frame { mins: [origin[0], origin[1], origin[2], time[0]], steps: [time[1]; 4] };
            for (step, at) in steps.iter().zip(coordinates) {
                frame.steps[at] = step[at];
            }
            return Ok(World { coordinates, frame, orientation: None });
        }
        if (0..3).any(|axis| cosine(&steps[axis], &steps[(axis + 1) % 3]).abs() > COSINE_MAX) {
            return Err("the axes of the grid are not perpendicular in the world".to_string());
        }
        let sizes = sizes.filter(|sizes| {
            let pairs = sizes.iter().zip(lengths);
            pairs.into_iter().all(|(size, length)| (size - length).abs() <= 10.0 * ROUNDING * length)
        });
        let [x, y, z] = sizes.unwrap_or(lengths);
        let axes =
            [(steps[0], x), (steps[1], y), (steps[2], z)].map(|(step, size)| step.map(|part| part / size));
        let frame = Frame { mins: [0.0, 0.0, 0.0, time[0]], steps: [x, y, z, time[1]] };
        Ok(World { coordinates: [0, 1, 2], frame, orientation: Some(Orientation { origin, axes }) })
    }
}

/// The coordinate along each axis, if each axis has its own.
fn coordinates(steps: &[Point; 3]) -> Option<[usize; 3]> {
    let mut coordinates = [0; 3];
    for (coordinate, step) in coordinates.iter_mut().zip(steps) {
        let mut changing = (0..3).filter(|&at| step[at] != 0.0);
        *coordinate = changing.next()?;
        if changing.next().is_some() {
            return None;
        }
    }
    (0..3).all(|at| coordinates.contains(&at)).then_some(coordinates)
}

fn without_rounding(vector: Point) -> Point {
    let least = ROUNDING * length(vector);
    vector.map(|part| if part.abs() < least { 0.0 } else { part })
}

fn length([x, y, z]: Point) -> f64 {
    x.hypot(y).hypot(z)
}

fn cosine(a: &Point, b: &Point) -> f64 {
    let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    product / length(*a) / length(*b)
}
