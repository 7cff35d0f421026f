//! Concave outlines against a flood over all triangles in memory, and holes inside that are filled.

use std::collections::{HashMap, HashSet, VecDeque};

use spmesh_formats::raster::{Grid, RasterFormat};
use spmesh_stream::Coordinates;
use spmesh_terrain::dem::{Options, Quantity};

use super::tiles::tiff_values;
use super::{Mesh, file, is_same, options, raster, values};
use spmesh_reference::sets::{Random, uniform};

/// The grid of the tests.
const GRID: Grid = Grid { left: 0.0, top: 60.0, step: 0.5, columns: 120, rows: 120 };

impl Mesh {
    /// The mesh without triangles that a flood from the border reaches over edges whose squared length is above
    /// a limit.
    pub fn inside(&self, limit: f64) -> Mesh {
        let ends = |triangle: &[u32; 3]| {
            let [a, b, c] = *triangle;
            [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)])
        };
        let is_long = |edge: &[u32; 2]| {
            let [p, q] = edge.map(|vertex| self.points[vertex as usize]);
            (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2) > limit
        };
        let mut sides: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
        for (number, triangle) in self.triangles.iter().enumerate() {
            ends(triangle).into_iter().for_each(|edge| sides.entry(edge).or_default().push(number));
        }
        let border = sides.iter().filter(|(edge, sides)| sides.len() == 1 && is_long(edge));
        let mut reached: HashSet<usize> = border.map(|(_, sides)| sides[0]).collect();
        let mut queue: VecDeque<usize> = reached.iter().copied().collect();
        while let Some(number) = queue.pop_front() {
            for edge in ends(&self.triangles[number]).into_iter().filter(is_long) {
                let others = sides[&edge].iter().copied();
                queue.extend(others.filter(|&other| reached.insert(other)).collect::<Vec<usize>>());
            }
        }
        let kept = self.triangles.iter().enumerate().filter(|(number, _)| !reached.contains(number));
        Mesh { points: self.points.clone(), triangles: kept.map(|(_, triangle)| *triangle).collect() }
    }

    /// Points in a ring around a lake, with a bay, an island in the lake, and an island outside.
    pub fn lake(random: &mut Random) -> Mesh {
        let is_land = |[x, y]: [i64; 2]| {
            let far = (x - 30).pow(2) + (y - 30).pow(2);
            let is_ring = (150..600).contains(&far) && !(x > 46 && (y - 30).abs() < 6);
            is_ring || far < 10 || (x > 54 && y > 54)
        };
        let points: Vec<[i64; 2]> =
            uniform(random, 3_000, 60).into_iter().filter(|at| is_land(*at)).collect();
        Mesh::of(random, &points)
    }
}

/// Integer coordinates in the world that the mesh has.
const WHOLE: Coordinates = Coordinates::I32 { scale: [1.0; 3], offset: [0.0; 3] };

fn scaled(scale: f64) -> Coordinates {
    Coordinates::I32 { scale: [scale; 3], offset: [0.0; 3] }
}

#[test]
fn outlines_are_those_of_a_flood() {
    let mut random = Random::new(12);
    let mut counts = [0; 2];
    for round in 0..6 {
        let mesh = if round < 3 {
            Mesh::lake(&mut random)
        } else {
            Mesh::of(&mut random, &uniform(&mut Random::new(round), 90, 60))
        };
        for length in [1.0, 2.0, 4.0, 5.0, 8.0, 10.0, 20.0, 100.0] {
            let inside = mesh.inside(length * length);
            let expected = match inside.without_unused() {
                Some(inside) => raster(&inside.stream(WHOLE), &GRID, &options(Quantity::Elevation)),
                None => vec![f32::NAN; 120 * 120],
            };
            let limited = Options { concave: Some(length), ..options(Quantity::Elevation) };
            for coordinates in [WHOLE, Coordinates::F64] {
                let shuffled = mesh.shuffled(&mut random).stream(coordinates);
                for (stream, memory) in [(&mesh.stream(coordinates), 1 << 30), (&shuffled, 1 << 19)] {
                    let limited = Options { memory, ..limited.clone() };
                    let (text, stats) = file(stream, RasterFormat::Ascii, &GRID, &limited).unwrap();
                    assert!(is_same(&values(&text), &expected), "{round} {length}");
                    assert_eq!(stats.outside as usize, mesh.triangles.len() - inside.triangles.len());
                    let (bytes, _) = file(stream, RasterFormat::GeoTiff, &GRID, &limited).unwrap();
                    assert!(is_same(&tiff_values(&bytes, &GRID), &expected), "{round} {length}");
                }
            }
            counts[0] += usize::from(inside.triangles.len() < mesh.triangles.len());
            counts[1] += inside.triangles.len();
        }
    }
    assert!(counts[0] > 20 && counts[1] > 10_000, "{counts:?}");
}

#[test]
fn lakes_stay_and_bays_go() {
    let mesh = Mesh::lake(&mut Random::new(3));
    let stream = mesh.stream(WHOLE);
    let limited = Options { concave: Some(4.0), ..options(Quantity::Elevation) };
    let found = raster(&stream, &GRID, &limited);
    let at = |x: f64, y: f64| found[((60.0 - y) / 0.5) as usize * 120 + (x / 0.5) as usize];
    // In the lake, in the bay, between the islands.
    assert!(!at(30.0, 37.0).is_nan() && at(53.0, 30.0).is_nan() && at(52.0, 52.0).is_nan());
    let killed = raster(&stream, &GRID, &Options { kill: Some(4.0), ..options(Quantity::Elevation) });
    assert!(killed[((60.0 - 37.0) / 0.5) as usize * 120 + 60].is_nan());
}

#[test]
fn edges_at_the_limit_are_not_crossed() {
    // A grid of squares whose sides are exactly the limit, in steps of a tenth; the diagonals are longer.
    let points: Vec<[i64; 2]> = (0..36).map(|i| [i % 6 * 11, i / 6 * 11]).collect();
    let mesh = Mesh::of(&mut Random::new(1), &points);
    let stream = mesh.stream(scaled(0.1));
    let grid = Grid { left: 0.0, top: 6.0, step: 0.25, columns: 24, rows: 24 };
    let outside = |concave: f64| {
        let limited = Options { concave: Some(concave), ..options(Quantity::Elevation) };
        file(&stream, RasterFormat::Ascii, &grid, &limited).unwrap().1.outside
    };
    assert_eq!([outside(1.1), outside(1.0999999)], [0, 50]);
}

#[test]
fn holes_inside_of_the_outline_are_filled_and_nothing_outside() {
    let mesh = Mesh::lake(&mut Random::new(7));
    let stream = mesh.stream(WHOLE);
    let plain = options(Quantity::Elevation);
    let outline = Options { concave: Some(4.0), ..plain.clone() };
    let whole = raster(&stream, &GRID, &plain);
    let inside = raster(&stream, &GRID, &outline);
    let killed = Options { kill: Some(4.0), fill: Some(100), ..plain.clone() };
    let both = Options { concave: Some(4.0), ..killed.clone() };
    for (options, outline) in [(&killed, &whole), (&both, &inside)] {
        let found = raster(&stream, &GRID, options);
        let counts = [&found, outline].map(|values| values.iter().filter(|value| !value.is_nan()).count());
        // Some cells see no data in any of eight directions.
        assert!(counts[0] <= counts[1] && counts[0] > counts[1] * 19 / 20, "{counts:?}");
        assert!(found.iter().zip(outline).all(|(found, outline)| found.is_nan() || !outline.is_nan()));
    }
    assert!(inside.iter().zip(&whole).any(|(inside, whole)| inside.is_nan() && !whole.is_nan()));
}

#[test]
fn slopes_of_filled_cells_follow_from_filled_elevations() {
    let mut mesh = Mesh::lake(&mut Random::new(9));
    // A rough plane, so that slopes vary.
    mesh.points.iter_mut().for_each(|[x, y, z]| *z = 2.0 * *x - *y + *z % 3.0);
    let stream = mesh.stream(WHOLE);
    // Cells of 1 in two tiles at least.
    let grid = Grid { left: -240.0, top: 60.0, step: 1.0, columns: 300, rows: 60 };
    let [columns, rows] = [300, 60];
    let drawn = |quantity: &Quantity, fill: Option<u32>, memory: u64| {
        let options = Options { kill: Some(4.0), fill, memory, ..options(quantity.clone()) };
        let (text, stats) = file(&stream, RasterFormat::Ascii, &grid, &options).unwrap();
        let (bytes, _) = file(&stream, RasterFormat::GeoTiff, &grid, &options).unwrap();
        assert!(is_same(&values(&text), &tiff_values(&bytes, &grid)));
        (values(&text), stats.filled)
    };
    let heights = drawn(&Quantity::Elevation, Some(50), 1 << 30).0;
    let before = drawn(&Quantity::Elevation, None, 1 << 30).0;
    for quantity in [Quantity::Slope, Quantity::Aspect] {
        let plain = drawn(&quantity, None, 1 << 30).0;
        for memory in [1 << 30, 1 << 19] {
            let (found, filled) = drawn(&quantity, Some(50), memory);
            let mut count = 0;
            for cell in 0..columns * rows {
                let at = |column: i64, row: i64| {
                    let is_there = (0..columns as i64).contains(&column) && (0..rows as i64).contains(&row);
                    let height = is_there.then(|| heights[row as usize * columns + column as usize]);
                    height.filter(|height| !height.is_nan()).map(f64::from)
                };
                let [column, row] = [cell % columns, cell / columns].map(|place| place as i64);
                if !before[cell].is_nan() || heights[cell].is_nan() {
                    assert!(found[cell].to_bits() == plain[cell].to_bits(), "{cell}");
                    continue;
                }
                let here = f64::from(heights[cell]);
                let along = |low: Option<f64>, high: Option<f64>| match (low, high) {
                    (Some(low), Some(high)) => Some((high - low) / 2.0),
                    (low, high) => high.map(|high| high - here).or(low.map(|low| here - low)),
                };
                let east = along(at(column - 1, row), at(column + 1, row));
                let north = along(at(column, row + 1), at(column, row - 1));
                let (Some(east), Some(north)) = (east, north) else { continue };
                let expected = match quantity {
                    Quantity::Slope => (east * east + north * north).sqrt().atan().to_degrees(),
                    _ => (270.0 - north.atan2(east).to_degrees()).rem_euclid(360.0),
                };
                let off = (f64::from(found[cell]) - expected).abs();
                assert!(off < 1e-3 || (off - 360.0).abs() < 1e-3, "{cell}: {} {expected}", found[cell]);
                count += 1;
            }
            assert!(count > 50 && filled >= count, "{count} {filled}");
        }
    }
}

#[test]
fn too_many_waiting_triangles_are_too_much_memory() {
    let mut random = Random::new(4);
    let mesh = Mesh::of(&mut random, &uniform(&mut Random::new(8), 3_000, 4_000));
    let limited = Options { concave: Some(1e-3), memory: 1, ..options(Quantity::Elevation) };
    let error =
        file(&mesh.shuffled(&mut random).stream(WHOLE), RasterFormat::Ascii, &GRID, &limited).unwrap_err();
    assert!(error.exit_code() == 5 && error.to_string().contains("longer than --concave"), "{error}");
}
