//! The definition of the ground, followed to the letter: every cell, disk, triangle and point is looked at.

use std::collections::BTreeMap;

use spmesh_reference::incremental::triangles;

/// Steps of a cell, and of z.
const STEPS: f64 = 256.0;
const Z_STEPS: f64 = 1024.0;

type Cell = [i64; 2];
type Corners = [[f64; 3]; 3];

/// The lowest point of a cell: z, then x and y within, in steps.
type Lows = BTreeMap<Cell, (i64, [i64; 2])>;

/// The parameters that tests vary: the window in cells of a metre, the slope, and the reach in metres.
#[derive(Debug, Clone, Copy)]
pub struct Rules {
    pub window: i64,
    pub slope: f64,
    pub reach: f64,
}

/// The classes of points in centimetres, and for each how far it is from getting another one, in steps of z.
pub fn classes(points: &[[i32; 3]], rules: Rules) -> Vec<(u8, f64)> {
    let mut lows = Lows::new();
    for &[x, y, z] in points {
        let cell = [x, y].map(|at| i64::from(at).div_euclid(100));
        let within = [x, y].map(|at| i64::from(at).rem_euclid(100) * 256 / 100);
        let z = (f64::from(z) / 100.0 * Z_STEPS).round() as i64;
        let lowest = lows.entry(cell).or_insert((z, within));
        *lowest = (*lowest).min((z, within));
    }
    let heights: BTreeMap<Cell, f64> = lows.iter().map(|(&cell, &(z, _))| (cell, z as f64)).collect();
    let sound = with_company(&without_pits(&heights), rules.window);
    let objects = risen(&sound, rules.window, |radius| (rules.slope * radius).min(2.0) * Z_STEPS);
    let reach = rules.reach * STEPS;
    let first = mesh(&lows, sound.keys().filter(|cell| !objects.contains(cell)), reach);
    let above = |cell: &Cell| {
        let place = place(&lows, cell);
        let (surface, _) = elevation(&first, place, reach)?;
        Some((*cell, (place[2] - surface) as f32 as f64))
    };
    let residuals: BTreeMap<Cell, f64> = sound.keys().filter_map(above).collect();
    let objects = risen(&residuals, rules.window, |radius| (0.4 + 0.12 * radius).min(2.0) * Z_STEPS);
    let second = mesh(&lows, residuals.keys().filter(|cell| !objects.contains(cell)), reach);
    points.iter().map(|&point| class(&second, reach, point, points)).collect()
}

/// The class of a point, and how near it is to another one.
fn class(surface: &[Corners], reach: f64, [x, y, z]: [i32; 3], points: &[[i32; 3]]) -> (u8, f64) {
    let at = [x, y].map(|at| f64::from(at) / 100.0 * STEPS - 0.5);
    let z_steps = f64::from(z) / 100.0 * Z_STEPS;
    let Some((ground, slope)) = elevation(surface, [at[0], at[1], z_steps], reach) else {
        return (1, f64::INFINITY);
    };
    let (height, limit) = (z_steps - ground, (0.3 + 1.25 * (slope * STEPS / Z_STEPS).min(2.0)) * Z_STEPS);
    let margin =
        [limit, -2.0 * limit].map(|limit| (height - limit).abs()).into_iter().fold(f64::INFINITY, f64::min);
    let class = if height < -2.0 * limit {
        7
    } else if height <= limit {
        2
    } else if height > 500.0 * Z_STEPS || is_bird([x, y, z], points) {
        18
    } else {
        1
    };
    (class, margin)
}

/// Whether a point is one of at most three above a gap of 15 m, among those of its column and its neighbours.
fn is_bird([x, y, z]: [i32; 3], points: &[[i32; 3]]) -> bool {
    let column = |at: i32| at.div_euclid(500);
    let near = |point: &&[i32; 3]| {
        [(x, point[0]), (y, point[1])].iter().all(|&(a, b)| (column(a) - column(b)).abs() <= 1)
    };
    let mut heights: Vec<i32> = points.iter().filter(near).map(|point| point[2]).collect();
    heights.sort_unstable_by(|a, b| b.cmp(a));
    let group =
        (1..=3.min(heights.len() - 1)).rev().find(|&count| heights[count - 1] - heights[count] >= 1500);
    group.is_some_and(|count| z >= heights[count - 1])
}

fn in_disk(cell: Cell, radius: i64) -> impl Iterator<Item = Cell> {
    let offsets = (-radius..=radius).flat_map(move |dy| (-radius..=radius).map(move |dx| [dx, dy]));
    let inside = offsets.filter(move |[dx, dy]| dx * dx + dy * dy <= radius * radius);
    inside.map(move |[dx, dy]| [cell[0] + dx, cell[1] + dy])
}

fn opened(heights: &BTreeMap<Cell, f64>, radius: i64) -> BTreeMap<Cell, f64> {
    let known = |cell: Cell| in_disk(cell, radius).filter_map(|near| heights.get(&near).copied());
    let pushed: BTreeMap<Cell, f64> =
        heights.keys().map(|&cell| (cell, known(cell).fold(f64::INFINITY, f64::min))).collect();
    let highest = |&cell: &Cell| {
        in_disk(cell, radius).filter_map(|near| pushed.get(&near).copied()).fold(f64::NEG_INFINITY, f64::max)
    };
    heights.keys().map(|cell| (*cell, highest(cell))).collect()
}

/// The cells without pits.
fn without_pits(heights: &BTreeMap<Cell, f64>) -> BTreeMap<Cell, f64> {
    let negative = heights.iter().map(|(&cell, &z)| (cell, -z)).collect();
    let closed = opened(&negative, 3);
    let is_pit = |cell: &Cell, z: f64| {
        let near: Vec<f64> = in_disk(*cell, 5).filter_map(|near| heights.get(&near).copied()).collect();
        let low = near.iter().filter(|near| **near < z + Z_STEPS).count();
        -closed[cell] - z > 2.0 * Z_STEPS && low as f64 <= (0.1 * near.len() as f64).max(1.0)
    };
    heights.iter().filter(|(cell, z)| !is_pit(cell, **z)).map(|(&cell, &z)| (cell, z)).collect()
}

/// The cells with at least three others within the window.
fn with_company(heights: &BTreeMap<Cell, f64>, window: i64) -> BTreeMap<Cell, f64> {
    let company = |cell: &Cell| {
        let is_near = |other: &&Cell| [0, 1].iter().all(|&axis| (cell[axis] - other[axis]).abs() <= window);
        heights.keys().filter(is_near).count()
    };
    heights.iter().filter(|(cell, _)| company(cell) >= 4).map(|(&cell, &z)| (cell, z)).collect()
}

/// The cells from which an opening takes more than a limit.
fn risen(heights: &BTreeMap<Cell, f64>, window: i64, limit: impl Fn(f64) -> f64) -> Vec<Cell> {
    let (mut current, mut risen) = (heights.clone(), Vec::new());
    for radius in 1..=window {
        let next = opened(&current, radius);
        let limit = limit(radius as f64);
        risen.extend(current.iter().filter(|(cell, z)| **z - next[*cell] > limit).map(|(cell, _)| *cell));
        current = next;
    }
    risen
}

fn place(lows: &Lows, cell: &Cell) -> [f64; 3] {
    let (z, within) = lows[cell];
    [(cell[0] * 256 + within[0]) as f64, (cell[1] * 256 + within[1]) as f64, z as f64]
}

/// The triangles whose circles have a radius of at most `reach`.
fn mesh<'c>(lows: &Lows, cells: impl Iterator<Item = &'c Cell>, reach: f64) -> Vec<Corners> {
    let places: Vec<[f64; 3]> = cells.map(|cell| place(lows, cell)).collect();
    let flat: Vec<[i64; 2]> = places.iter().map(|place| [place[0] as i64, place[1] as i64]).collect();
    let all = triangles(&flat).into_iter().map(|corners| corners.map(|corner| places[corner as usize]));
    all.filter(|corners| circumradius(corners) <= reach).collect()
}

/// Of the sides a, b, c, and the area by Heron: a b c / (4 area).
fn circumradius(corners: &Corners) -> f64 {
    let side = |i: usize, j: usize| (corners[i][0] - corners[j][0]).hypot(corners[i][1] - corners[j][1]);
    let [a, b, c] = [side(1, 2), side(0, 2), side(0, 1)];
    let half = (a + b + c) / 2.0;
    a * b * c / (4.0 * (half * (half - a) * (half - b) * (half - c)).max(0.0).sqrt())
}

/// The slope of the edge that a place lies on; 0 at a corner.
fn on_edge(corners: Corners, at: [f64; 3], area: f64) -> Option<f64> {
    let share = |number: usize| {
        let [p, q] = [corners[(number + 1) % 3], corners[(number + 2) % 3]];
        ((q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0])) / area
    };
    let far: Vec<[f64; 3]> =
        (0..3).filter(|&number| share(number) > 1e-6).map(|number| corners[number]).collect();
    match far[..] {
        [p, q] => Some((q[2] - p[2]).abs() / (q[0] - p[0]).hypot(q[1] - p[1]).max(1.5 * STEPS)),
        [_, _, _] => None,
        _ => Some(0.0),
    }
}

/// The elevation and the slope of the first triangle that contains a place, or the elevation of the nearest
/// place within reach with slope 0.
fn elevation(mesh: &[Corners], at: [f64; 3], reach: f64) -> Option<(f64, f64)> {
    let side = |p: [f64; 3], q: [f64; 3]| (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]);
    let inside =
        mesh.iter().find(|[a, b, c]| side(*a, *b) >= 0.0 && side(*b, *c) >= 0.0 && side(*c, *a) >= 0.0);
    if let Some([a, b, c]) = inside {
        let [u, v] = [b, c].map(|corner| [0, 1, 2].map(|axis| corner[axis] - a[axis]));
        let area = u[0] * v[1] - u[1] * v[0];
        let gradient = [u[2] * v[1] - v[2] * u[1], u[0] * v[2] - v[0] * u[2]].map(|value| value / area);
        let rise = gradient[0] * (at[0] - a[0]) + gradient[1] * (at[1] - a[1]);
        let relief = a[2].max(b[2]).max(c[2]) - a[2].min(b[2]).min(c[2]);
        let slope = gradient[0].hypot(gradient[1]).min(relief / (1.5 * STEPS));
        return Some((a[2] + rise, on_edge([*a, *b, *c], at, area).unwrap_or(slope)));
    }
    let edges = mesh.iter().flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
    let nearest = edges.map(|(p, q)| {
        let d = [0, 1, 2].map(|axis| q[axis] - p[axis]);
        let share = ((at[0] - p[0]) * d[0] + (at[1] - p[1]) * d[1]) / (d[0] * d[0] + d[1] * d[1]);
        let share = share.clamp(0.0, 1.0);
        let distance = (at[0] - p[0] - share * d[0]).hypot(at[1] - p[1] - share * d[1]);
        (distance, p[2] + share * d[2])
    });
    let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0));
    nearest.filter(|(distance, _)| *distance <= reach).map(|(_, z)| (z, 0.0))
}
