//! Each cell against all triangles, in integers: which triangle contains its centre, and the value there.

use spmesh_formats::raster::{Cells, Grid, RasterFormat, Window};
use spmesh_stream::Coordinates;
use spmesh_terrain::dem::{Options, Quantity};

use super::{Mesh, file, is_same, options, raster, values};
use spmesh_reference::sets::{DEGENERATE_FAMILIES, Random, degenerate, uniform};
use spmesh_reference::{exhaustive, incremental};

/// A value in units of 2^-bits; it must be a multiple of the unit.
fn units(value: f64, bits: i32) -> i128 {
    let scaled = value * 2f64.powi(bits);
    assert!(scaled == scaled.trunc() && scaled.abs() < 2f64.powi(61), "{value} in units of 2^-{bits}");
    scaled as i128
}

type Exact = [i128; 2];

/// Twice the area of a triangle.
fn area(a: Exact, b: Exact, c: Exact) -> i128 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Whether a point is on the left of an edge or on it, and whether it is on the left after it moves by an
/// infinitesimal to the right and by the square of that up. The sign of a polynomial in the infinitesimal is
/// the sign of its first nonzero coefficient.
fn sides([a, b]: [Exact; 2], p: Exact) -> [bool; 2] {
    let coefficients = [area(a, b, p), a[1] - b[1], b[0] - a[0]];
    let first = coefficients.into_iter().find(|&coefficient| coefficient != 0).expect("an edge has a length");
    [coefficients[0] >= 0, first > 0]
}

/// A mesh in integer units.
struct Reference<'a> {
    mesh: &'a Mesh,
    places: Vec<Exact>,
}

impl Reference<'_> {
    fn corners(&self, triangle: [u32; 3]) -> [Exact; 3] {
        triangle.map(|vertex| self.places[vertex as usize])
    }

    /// The triangles whose closure contains a point, and the triangle that contains it after the
    /// infinitesimal move.
    fn around(&self, p: Exact) -> (Vec<[u32; 3]>, Option<[u32; 3]>) {
        let holds = |triangle: &[u32; 3], which: usize| {
            let [a, b, c] = self.corners(*triangle);
            [[a, b], [b, c], [c, a]].into_iter().all(|edge| sides(edge, p)[which])
        };
        let all = |which| self.mesh.triangles.iter().copied().filter(move |triangle| holds(triangle, which));
        let owners: Vec<[u32; 3]> = all(1).collect();
        assert!(owners.len() <= 1, "a mesh has no overlaps");
        (all(0).collect(), owners.first().copied())
    }

    fn elevation(&self, triangle: [u32; 3], p: Exact) -> f64 {
        let [a, b, c] = self.corners(triangle);
        let [of_a, of_b, of_c] = triangle.map(|vertex| self.mesh.points[vertex as usize][2] as i128);
        let sum = area(p, b, c) * of_a + area(a, p, c) * of_b + area(a, b, p) * of_c;
        sum as f64 / area(a, b, c) as f64
    }

    /// The slope in degrees; an integer step is `unit` in the world.
    fn slope(&self, triangle: [u32; 3], unit: f64) -> f64 {
        let [a, b, c] = self.corners(triangle);
        let z = triangle.map(|vertex| self.mesh.points[vertex as usize][2] as i128);
        let along = |axis: usize| {
            let [u, v] = [b[1 - axis] - a[1 - axis], c[1 - axis] - a[1 - axis]];
            ((z[1] - z[0]) * v - (z[2] - z[0]) * u) as f64 / area(a, b, c) as f64
        };
        (along(0).hypot(along(1)) / unit).atan().to_degrees()
    }
}

/// Compares rasters of slopes and of elevations with the reference. In units of 2^-bits all coordinates and
/// centres are integers. A stored step is `scale` in the world, counted from `offset`. Returns the number of
/// centres on borders of triangles and of centres without a triangle.
fn check(mesh: &Mesh, grid: &Grid, bits: i32, [scale, offset]: [f64; 2]) -> [usize; 2] {
    let coordinates = match scale {
        1.0 => Coordinates::F64,
        scale => Coordinates::I32 { scale: [scale, scale, 1.0], offset: [offset, offset, 0.0] },
    };
    let stream = mesh.stream(coordinates);
    let places = mesh.points.iter().map(|&[x, y, _]| [units(x, bits), units(y, bits)]).collect();
    let reference = Reference { mesh, places };
    let slopes = raster(&stream, grid, &options(Quantity::Slope));
    let elevations = raster(&stream, grid, &options(Quantity::Elevation));
    let (mut ties, mut outside) = (0, 0);
    for cell in 0..grid.cells() as usize {
        let (column, row) = ((cell % grid.columns as usize) as u32, (cell / grid.columns as usize) as u32);
        let centre = grid.center(column, row).map(|world| (world - offset) / scale);
        let p = centre.map(|number| units(number, bits));
        let (around, owner) = reference.around(p);
        ties += usize::from(around.len() > 1);
        let Some(&first) = around.first() else {
            assert!(slopes[cell].is_nan() && elevations[cell].is_nan(), "{centre:?} is outside");
            outside += 1;
            continue;
        };
        let slope_of = |triangle| reference.slope(triangle, scale * 2f64.powi(-bits));
        let least = || around.iter().map(|&triangle| slope_of(triangle)).fold(f64::INFINITY, f64::min);
        let slope = owner.map_or_else(least, slope_of);
        let elevation = reference.elevation(owner.unwrap_or(first), p);
        assert!((f64::from(slopes[cell]) - slope).abs() < 1e-4, "{centre:?}: {} for {slope}", slopes[cell]);
        assert!(
            (f64::from(elevations[cell]) - elevation).abs() < 1e-3,
            "{centre:?}: {} for {elevation}",
            elevations[cell]
        );
    }
    [ties, outside]
}

fn grid(min: f64, max: f64, step: f64) -> Grid {
    Grid::of(Window { min: [min; 2], max: [max; 2] }, Cells::Step { step, anchor: [0.0; 2] }).unwrap()
}

#[test]
fn random_points_of_a_small_square_have_centres_everywhere() {
    let mut ties = 0;
    for seed in 0..30 {
        let mut random = Random::new(seed);
        let points = uniform(&mut random, 3 + seed as usize, 12);
        if incremental::triangles(&points).is_empty() {
            continue;
        }
        let mesh = Mesh::of(&mut random, &points);
        // Centres between the points of the lattice and on them.
        for (min, max, step) in [(-2.0, 14.0, 1.0), (-1.0, 13.0, 0.5), (-3.0, 15.0, 2.0), (-3.0, 15.0, 0.75)]
        {
            ties += check(&mesh, &grid(min, max, step), 4, [1.0, 0.0])[0];
        }
    }
    assert!(ties > 1_000, "{ties}");
}

#[test]
fn degenerate_points_have_no_gaps_and_no_doubles() {
    for family in 0..DEGENERATE_FAMILIES {
        let mut random = Random::new(family as u64);
        let points = degenerate(&mut random, family, 40);
        if incremental::triangles(&points).is_empty() {
            continue;
        }
        let mesh = Mesh::of(&mut random, &points);
        let [min, max] = [i64::min as fn(i64, i64) -> i64, i64::max].map(|choose| {
            [0, 1].map(|axis| points.iter().map(|point| point[axis]).reduce(choose).unwrap() as f64)
        });
        let window = Window { min, max };
        let side = (max[0] - min[0]).max(max[1] - min[1]);
        // The even step puts centres on integers, the odd one between them.
        let step = (side / 40.0).ceil() * 2.0;
        for step in [step, step + 1.0] {
            check(&mesh, &Grid::of(window, Cells::Step { step, anchor: [0.0; 2] }).unwrap(), 4, [1.0, 0.0]);
        }
    }
}

#[test]
fn squares_with_centres_on_all_vertices_lose_no_border() {
    let points: Vec<[i64; 2]> = (0..49).map(|i| [2 * (i % 7), 2 * (i / 7)]).collect();
    let mesh = Mesh::of(&mut Random::new(1), &points);
    let grid = Grid { left: -1.0, top: 13.0, step: 2.0, columns: 7, rows: 7 };
    assert_eq!(grid.center(0, 6), [0.0, 0.0]);
    assert_eq!(check(&mesh, &grid, 4, [1.0, 0.0])[1], 0);
    let elevations = raster(&mesh.stream(Coordinates::F64), &grid, &options(Quantity::Elevation));
    let expected: Vec<f32> = (0..49)
        .map(|cell| (cell % 7, 6 - cell / 7))
        .map(|(column, row)| points.iter().position(|&point| point == [2 * column, 2 * row]).unwrap())
        .map(|vertex| mesh.points[vertex][2] as f32)
        .collect();
    assert!(is_same(&elevations, &expected));
}

#[test]
fn whole_numbers_mean_what_the_header_says() {
    for seed in 0..10 {
        let mut random = Random::new(seed);
        let points = uniform(&mut random, 25, 64);
        let mesh = Mesh::of(&mut random, &points);
        // A stored step is a quarter in the world: all numbers are exact.
        let grid = grid(98.0, 120.0, [0.25, 0.5, 1.0][seed as usize % 3]);
        check(&mesh, &grid, 4, [0.25, 100.0]);
    }
}

#[test]
fn tenths_are_no_tenths_but_lose_nothing() {
    let mut random = Random::new(7);
    for case in 0..12 {
        let mut points: Vec<[f64; 2]> = Vec::new();
        while points.len() < 9 {
            let point = [0, 1].map(|_| random.integer(0, 9) as f64 * 0.1);
            if !points.contains(&point) {
                points.push(point);
            }
        }
        let triangles = exhaustive::triangles(&points);
        let points = points.iter().map(|&[x, y]| [x, y, random.integer(0, 9) as f64]).collect();
        let mesh = Mesh { points, triangles };
        let step = [0.1, 0.2, 0.05][case % 3];
        let grid =
            Grid::of(Window { min: [-0.1; 2], max: [0.95; 2] }, Cells::Step { step, anchor: [0.0; 2] })
                .unwrap();
        check(&mesh, &grid, 60, [1.0, 0.0]);
    }
}

#[test]
fn the_order_of_triangles_changes_nothing() {
    let mut random = Random::new(3);
    let points = uniform(&mut random, 200, 40);
    let mesh = Mesh::of(&mut random, &points);
    for quantity in [Quantity::Elevation, Quantity::Slope, Quantity::Aspect] {
        for (step, min) in [(1.0, -0.5), (0.5, 0.0), (3.0, -1.5)] {
            let grid = grid(min, 40.0, step);
            let first = raster(&mesh.stream(Coordinates::F64), &grid, &options(quantity.clone()));
            for _ in 0..4 {
                let stream = mesh.shuffled(&mut random).stream(Coordinates::F64);
                assert!(
                    is_same(&raster(&stream, &grid, &options(quantity.clone())), &first),
                    "{quantity:?} {step}"
                );
            }
        }
    }
}

#[test]
fn long_edges_leave_holes() {
    let mut random = Random::new(5);
    let points = uniform(&mut random, 60, 40);
    let mesh = Mesh::of(&mut random, &points);
    let grid = grid(0.0, 40.0, 1.0);
    for kill in [3.0, 8.0, 50f64.sqrt(), 1e9] {
        let is_short = |triangle: &[u32; 3]| {
            let at = |i: usize| mesh.points[triangle[i % 3] as usize];
            (0..3).all(|i| {
                (at(i)[0] - at(i + 1)[0]).powi(2) + (at(i)[1] - at(i + 1)[1]).powi(2) <= kill * kill + 1e-9
            })
        };
        let killed = mesh.triangles.iter().filter(|triangle| !is_short(triangle)).count() as u64;
        let limited = Options { kill: Some(kill), ..options(Quantity::Slope) };
        let (text, stats) =
            file(&mesh.stream(Coordinates::F64), RasterFormat::Ascii, &grid, &limited).unwrap();
        assert_eq!(stats.killed, killed);
        // The other triangles are drawn as if the mesh had no long ones.
        let mut short = mesh.clone();
        short.triangles.retain(is_short);
        if let Some(expected) = short.without_unused() {
            let expected = raster(&expected.stream(Coordinates::F64), &grid, &options(Quantity::Slope));
            assert!(is_same(&values(&text), &expected), "{kill}");
        }
    }
}

impl Mesh {
    /// The mesh without vertices that no triangle uses; `None` if it has no triangles.
    pub fn without_unused(&self) -> Option<Mesh> {
        let used = |vertex: &usize| self.triangles.as_flattened().contains(&(*vertex as u32));
        let kept: Vec<usize> = (0..self.points.len()).filter(used).collect();
        let new = |vertex: u32| kept.iter().position(|&old| old == vertex as usize).unwrap() as u32;
        let triangles: Vec<[u32; 3]> = self.triangles.iter().map(|triangle| triangle.map(new)).collect();
        let points = kept.iter().map(|&vertex| self.points[vertex]).collect();
        (!triangles.is_empty()).then_some(Mesh { points, triangles })
    }
}
