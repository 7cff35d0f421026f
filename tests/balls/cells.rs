//! Voronoi and Laguerre cells against polyhedra that are cut by the half-spaces of all sites and images.

use super::polyhedron::Polyhedron;
use super::vectors::{Point, dot, minus};
use spmesh_molecules::cells::{SiteCells, Sites, State, cells};
use spmesh_reference::sets::Random;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;

type Box3 = [Point; 3];

fn found(points: &[Point], radii: &[f64], periodic_box: Option<Box3>) -> SiteCells {
    cells(Sites { points, radii, periodic_box }, true, NonZeroUsize::MIN).expect("sites")
}

fn volume_of([a, b, c]: Box3) -> f64 {
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    dot(cross, c).abs()
}

fn shifted(point: Point, shift: [i64; 3], vectors: Box3) -> Point {
    [0, 1, 2].map(|axis| point[axis] + (0..3).map(|k| shift[k] as f64 * vectors[k][axis]).sum::<f64>())
}

/// The cell of site `i`, cut by images up to `layers` boxes away of where the points are; and its faces by
/// site and shift.
fn by_clipping(
    points: &[Point],
    radii: &[f64],
    vectors: Box3,
    layers: i64,
    i: usize,
) -> (f64, BTreeMap<(u32, [i64; 3]), f64>) {
    let weight = |j: usize| radii.get(j).map_or(0.0, |radius| radius * radius);
    let mut cell = Polyhedron::cube(10.0 * vectors.as_flattened().iter().map(|c| c.abs()).sum::<f64>());
    let mut planes = Vec::new();
    let range = -layers..=layers;
    let shifts: Vec<[i64; 3]> = range
        .clone()
        .flat_map(|x| {
            let range = range.clone();
            range.clone().flat_map(move |y| range.clone().map(move |z| [x, y, z]))
        })
        .collect();
    for j in 0..points.len() {
        for &shift in &shifts {
            if (j, shift) == (i, [0; 3]) {
                continue;
            }
            let to = minus(shifted(points[j], shift, vectors), points[i]);
            let offset = 0.5 * (dot(to, to) + weight(i) - weight(j));
            planes.push((offset / dot(to, to).sqrt(), to, offset, (j as u32, shift)));
        }
    }
    // The nearest first, so that most cut nothing.
    planes.sort_by(|p, q| p.0.total_cmp(&q.0));
    planes.iter().enumerate().for_each(|(name, &(_, to, offset, _))| cell.cut(to, offset, name));
    let faces = cell.areas().into_iter().map(|(name, area)| (planes[name].3, area)).collect();
    (cell.volume(), faces)
}

fn assert_as_clipped(points: &[Point], radii: &[f64], vectors: Box3, layers: i64) {
    let result = found(points, radii, Some(vectors));
    let whole = volume_of(vectors);
    let sum: f64 = result.cells.iter().map(|cell| cell.volume).sum();
    assert!((sum - whole).abs() < 1e-12 * whole, "sum {sum}, not {whole}");
    let mut both: BTreeMap<(u32, u32, [i64; 3]), f64> = BTreeMap::new();
    for face in &result.faces {
        let ([i, j], shift) = (face.sites, face.shift);
        both.insert((i, j, shift), face.area);
        both.insert((j, i, shift.map(|s| -s)), face.area);
        let distance = minus(shifted(points[j as usize], shift, vectors), points[i as usize]);
        assert!((dot(distance, distance).sqrt() - face.distance).abs() < 1e-11 * whole.cbrt());
    }
    let unit = (whole / points.len() as f64).cbrt();
    for (i, cell) in result.cells.iter().enumerate() {
        let (volume, faces) = by_clipping(points, radii, vectors, layers, i);
        assert!((cell.volume - volume).abs() < 1e-11 * unit.powi(3), "{i}: {} {volume}", cell.volume);
        let area: f64 = faces.values().sum();
        assert!((cell.area - area).abs() < 1e-10 * unit.powi(2), "{i}: {} {area}", cell.area);
        for (&(j, shift), &area) in &faces {
            let found = both.get(&(i as u32, j, shift)).copied().unwrap_or(0.0);
            assert!((found - area).abs() < 1e-10 * unit.powi(2), "{i} {j} {shift:?}: {found}, not {area}");
        }
        let large =
            both.iter().filter(|((first, ..), area)| *first == i as u32 && **area > 1e-9 * unit * unit);
        let expected = faces.values().filter(|&&area| area > 1e-9 * unit * unit).count();
        assert_eq!(large.count(), expected, "faces of {i}");
    }
}

/// A box that needs no more than the images next to it, but for `layers`.
fn random_box(random: &mut Random, size: f64) -> Box3 {
    let mut off = || size * (random.unit() - 0.5) * 0.6;
    let (mut vectors, skews) = ([[0.0; 3]; 3], [off(), off(), off()]);
    for (k, vector) in vectors.iter_mut().enumerate() {
        vector[k] = size * (0.7 + 0.6 * random.unit());
    }
    vectors[1][0] = skews[0];
    vectors[2][0] = skews[1];
    vectors[2][1] = skews[2];
    vectors
}

fn random_points(random: &mut Random, count: usize, vectors: Box3) -> Vec<Point> {
    let mut point = || {
        // Some are outside of the box.
        let fraction = [0; 3].map(|_| 3.0 * random.unit() - 1.0);
        [0, 1, 2].map(|axis| (0..3).map(|k| fraction[k] * vectors[k][axis]).sum())
    };
    (0..count).map(|_| point()).collect()
}

fn wrapped(points: &[Point], vectors: Box3) -> Vec<Point> {
    // For boxes whose matrix is lower triangular.
    let mut points = points.to_vec();
    for point in &mut points {
        for k in (0..3).rev() {
            let boxes = (point[k] / vectors[k][k]).floor();
            (0..3).for_each(|axis| point[axis] -= boxes * vectors[k][axis]);
        }
    }
    points
}

#[test]
fn cells_in_random_boxes_are_those_of_clipping() {
    let mut random = Random::new(11);
    for round in 0..24 {
        let vectors = random_box(&mut random, 10.0);
        let points = wrapped(&random_points(&mut random, 1 + 2 * round, vectors), vectors);
        assert_as_clipped(&points, &[], vectors, 2);
        let radii: Vec<f64> = points.iter().map(|_| 2.0 * random.unit()).collect();
        assert_as_clipped(&points, &radii, vectors, 2);
    }
}

/// A few sites in boxes of very different sides, where images far away matter.
#[test]
fn few_sites_in_elongated_boxes_are_those_of_clipping() {
    let mut random = Random::new(12);
    for count in 1..=5 {
        let vectors = [[1.0, 0.0, 0.0], [0.3, 2.0, 0.0], [-0.2, 0.4, 6.0]];
        let points = wrapped(&random_points(&mut random, count, vectors), vectors);
        assert_as_clipped(&points, &[], vectors, 8);
        let clustered: Vec<Point> = points.iter().map(|point| point.map(|c| 0.01 * c)).collect();
        assert_as_clipped(&clustered, &[], vectors, 8);
    }
}

/// A slab with empty space around it: cells are open until images across the space are taken.
#[test]
fn a_slab_in_empty_space_is_that_of_clipping() {
    let mut random = Random::new(13);
    let vectors = [[8.0, 0.0, 0.0], [1.0, 9.0, 0.0], [0.0, -1.0, 60.0]];
    let points: Vec<Point> =
        (0..40).map(|_| [8.0 * random.unit(), 9.0 * random.unit(), 20.0 + 3.0 * random.unit()]).collect();
    assert_as_clipped(&points, &[], vectors, 4);
    let plane: Vec<Point> = points.iter().map(|&[x, y, _]| [x, y, 25.0]).collect();
    assert_as_clipped(&plane, &[], vectors, 4);
}

/// Volume, area, and number of faces of each cell of a crystal.
fn assert_crystal(basis: &[Point], edge: f64, expected: (f64, f64, u32), what: &str) {
    for copies in 1..=3i64 {
        let mut points = Vec::new();
        for (x, y, z) in (0..copies.pow(3)).map(|n| (n % copies, n / copies % copies, n / copies.pow(2))) {
            points.extend(basis.iter().map(|p| [0, 1, 2].map(|i| edge * (p[i] + [x, y, z][i] as f64))));
        }
        let side = edge * copies as f64;
        let vectors = [[side, 0.0, 0.0], [0.0, side, 0.0], [0.0, 0.0, side]];
        let result = found(&points, &[], Some(vectors));
        let (volume, area, faces) = expected;
        for cell in &result.cells {
            assert!((cell.volume - volume).abs() < 1e-12 * volume, "{what}: {} {volume}", cell.volume);
            assert!((cell.area - area).abs() < 1e-11 * area, "{what}: {} {area}", cell.area);
            assert_eq!(cell.faces, faces, "{what}, edge {edge}, {copies} copies");
            assert!((cell.density().unwrap() * cell.star - 4.0).abs() < 1e-14);
        }
        assert_eq!(result.faces.len() as u32, faces * points.len() as u32 / 2);
        let stars: f64 = result.cells.iter().map(|cell| cell.star).sum();
        assert!((stars - 4.0 * side.powi(3)).abs() < 1e-11 * side.powi(3));
    }
}

#[test]
fn crystals_have_their_cells() {
    let fcc = [[0.0; 3], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]];
    let quarter: Vec<Point> = fcc.iter().map(|p| p.map(|c| c + 0.25)).collect();
    let diamond: Vec<Point> = fcc.iter().copied().chain(quarter).collect();
    // On the grid, and with coordinates that are rounded.
    for edge in [4.0, 4000.0, 3.7, 0.1] {
        let squared = edge * edge;
        assert_crystal(&[[0.0; 3]], edge, (edge.powi(3), 6.0 * squared, 6), "simple cubic");
        // A truncated octahedron of side edge / sqrt 8.
        let area = (6.0 + 12.0 * 3f64.sqrt()) * squared / 8.0;
        assert_crystal(&[[0.0; 3], [0.5; 3]], edge, (edge.powi(3) / 2.0, area, 14), "body-centred");
        // A rhombic dodecahedron with a middle sphere of half the distance of neighbours.
        let area = 8.0 * 2f64.sqrt() * squared * 3.0 / 16.0;
        assert_crystal(&fcc, edge, (edge.powi(3) / 4.0, area, 12), "face-centred");
        // A truncated triakis tetrahedron, of four hexagons and twelve triangles.
        let points: Vec<Point> = diamond.iter().map(|p| p.map(|c| c * edge)).collect();
        let vectors = [[edge, 0.0, 0.0], [0.0, edge, 0.0], [0.0, 0.0, edge]];
        assert_as_clipped(&points, &[], vectors, 2);
        let result = found(&points, &[], Some(vectors));
        for cell in &result.cells {
            assert!((cell.volume - edge.powi(3) / 8.0).abs() < 1e-12 * edge.powi(3), "diamond");
            assert_eq!(cell.faces, 16, "diamond, edge {edge}");
        }
    }
}

#[test]
fn shifted_boxes_and_other_vectors_change_rounding_only() {
    let mut random = Random::new(14);
    for _ in 0..10 {
        let vectors = random_box(&mut random, 10.0);
        let points = random_points(&mut random, 30, vectors);
        let radii: Vec<f64> = points.iter().map(|_| random.unit()).collect();
        let [a, b, c] = vectors;
        let sum = |p: Point, n: f64, q: Point| [0, 1, 2].map(|i| p[i] + n * q[i]);
        let skewed = [sum(a, 3.0, b), b, sum(sum(c, -2.0, a), 1.0, b)];
        let turned = [c, a, sum(b, -1.0, a)];
        let moved: Vec<Point> = points.iter().map(|&p| sum(p, 0.37, [10.0, -20.0, 30.0])).collect();
        for radii in [&[][..], &radii] {
            let first = found(&points, radii, Some(vectors));
            for (points, vectors) in [(&points, skewed), (&points, turned), (&moved, vectors)] {
                let other = found(points, radii, Some(vectors));
                assert_eq!(other.faces.len(), first.faces.len());
                for (p, q) in first.cells.iter().zip(&other.cells) {
                    assert_eq!((p.state, p.faces, p.sites), (q.state, q.faces, q.sites));
                    assert!((p.volume - q.volume).abs() < 1e-12 * volume_of(vectors));
                    assert!((p.star - q.star).abs() < 1e-12 * volume_of(vectors));
                }
            }
            let threads = NonZeroUsize::new(3).unwrap();
            let sites = Sites { points: &points, radii, periodic_box: Some(vectors) };
            assert_eq!(cells(sites, true, threads).unwrap(), first);
        }
    }
}

/// Vectors of integers are reduced exactly, and sites far away are moved exactly, also those on the border.
#[test]
fn large_skews_change_nothing_if_numbers_are_integers() {
    let vectors = [[30.0, 0.0, 0.0], [0.0, 40.0, 0.0], [0.0, 10.0, 50.0]];
    let points = [[0.0; 3], [15.0, 0.0, 0.0], [30.0, 20.0, 0.0], [7.0, 8.0, 9.0], [0.0, 50.0, 50.0]];
    let first = found(&points, &[], Some(vectors));
    let duplicates = first.cells.iter().map(|cell| cell.sites).collect::<Vec<_>>();
    assert_eq!(duplicates, [2, 1, 1, 1, 2]);
    let b = shifted([0.0; 3], [100_001, 1, 0], vectors);
    let c = shifted([0.0; 3], [12_345, -777, 1], vectors);
    let far: Vec<Point> =
        (0..).zip(points).map(|(n, point)| shifted(point, [123_457 * n, -n, 98_765], vectors)).collect();
    for (points, vectors) in [(&points[..], [vectors[0], b, c]), (&far, vectors), (&far, [c, vectors[0], b])]
    {
        let other = found(points, &[], Some(vectors));
        for (p, q) in first.cells.iter().zip(&other.cells) {
            assert_eq!((p.state, p.faces, p.sites), (q.state, q.faces, q.sites));
            assert!((p.volume - q.volume).abs() < 1e-15 * 60_000.0);
        }
        for face in &other.faces {
            let [i, j] = face.sites.map(|site| points[site as usize]);
            let between = minus(shifted(j, face.shift, vectors), i);
            assert_eq!(dot(between, between).sqrt(), face.distance);
        }
    }
}

#[test]
fn sites_at_one_place_have_one_cell() {
    let vectors = [[5.0, 0.0, 0.0], [1.0, 6.0, 0.0], [0.0, 2.0, 7.0]];
    // The second is the first, a box further; the third too, from the border.
    let points = [[0.0; 3], [5.0, 0.0, 0.0], [-1.0, -8.0, -7.0], [2.0, 3.0, 4.0]];
    let result = found(&points, &[], Some(vectors));
    let states = result.cells.iter().map(|cell| cell.state).collect::<Vec<_>>();
    assert_eq!(states, [State::Bounded, State::Duplicate, State::Duplicate, State::Bounded]);
    assert_eq!(result.cells.iter().map(|cell| cell.sites).collect::<Vec<_>>(), [3, 3, 3, 1]);
    assert_eq!(result.cells[0].density(), result.cells[2].density());
    let sum: f64 = result.cells.iter().map(|cell| cell.volume).sum();
    assert!((sum - 210.0).abs() < 1e-11);
    // The heaviest has the cell.
    let result = found(&points, &[1.0, 1.0, 2.0, 1.0], Some(vectors));
    let states = result.cells.iter().map(|cell| cell.state).collect::<Vec<_>>();
    assert_eq!(states, [State::Duplicate, State::Duplicate, State::Bounded, State::Bounded]);
    // A site in a heavy one has no cell.
    let result = found(&[[0.0; 3], [0.1, 0.0, 0.0]], &[2.0, 0.5], Some(vectors));
    assert_eq!(result.cells[1].state, State::Empty);
    assert!((result.cells[0].volume - 210.0).abs() < 1e-11);
}

#[test]
fn without_a_box_cells_on_the_hull_are_unbounded() {
    let mut points: Vec<Point> = (0..27).map(|n| [n % 3, n / 3 % 3, n / 9].map(f64::from)).collect();
    let result = found(&points, &[], None);
    for (i, cell) in result.cells.iter().enumerate() {
        let expected = if i == 13 { State::Bounded } else { State::Unbounded };
        assert_eq!(cell.state, expected);
        assert_eq!(cell.density().is_some(), i == 13);
    }
    let middle = &result.cells[13];
    assert!((middle.volume - 1.0).abs() < 1e-14 && (middle.area - 6.0).abs() < 1e-14);
    let of_middle = result.faces.iter().filter(|face| face.sites.contains(&13) && face.area > 0.0);
    assert!(of_middle.map(|face| face.area).all(|area| (area - 1.0).abs() < 1e-14));
    // Between neighbours on the hull, faces reach to infinity.
    let on_edge = result.faces.iter().find(|face| face.sites == [0, 1]).unwrap();
    assert_eq!(on_edge.area, f64::INFINITY);
    points.truncate(9);
    assert!(found(&points, &[], None).cells.iter().all(|cell| cell.state == State::Flat));
    assert!(found(&[], &[], None).cells.is_empty());
}

#[test]
fn what_has_no_cells_is_refused() {
    let refused = |points: &[Point], vectors| {
        let sites = Sites { points, radii: &[], periodic_box: Some(vectors) };
        cells(sites, false, NonZeroUsize::MIN).unwrap_err().to_string()
    };
    let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert!(refused(&[[f64::NAN, 0.0, 0.0]], unit).contains("NaN"));
    assert!(refused(&[[1e15, 0.0, 0.0]], unit).contains("boxes away"));
    assert!(refused(&[[1e70, 0.0, 0.0]], unit).contains("too large"));
    let needle = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1e6]];
    assert!(refused(&[[0.0; 3]], needle).contains("images"));
}
