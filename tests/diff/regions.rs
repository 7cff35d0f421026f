//! Volumes in polygons.

use super::{MEMORY, Mesh, compared, sum, turned, units_of_step};
use num_bigint::BigInt;
use spmesh_base::random::Random;
use spmesh_reference::overlay::overlay;
use spmesh_terrain::diff::{Comparison, Options, Other, Surface, compare};

/// A polygon: its rings.
type Rings = Vec<Vec<[f64; 2]>>;

fn within(first: &Surface, other: &Other, polygons: &[Rings]) -> Comparison {
    let options = Options { polygons, memory: MEMORY, threads: 2 };
    compare(first, other, &options, &mut |_, _| ()).unwrap()
}

fn rectangle([left, low]: [f64; 2], [right, high]: [f64; 2]) -> Vec<[f64; 2]> {
    vec![[left, low], [right, low], [right, high], [left, high]]
}

/// Sixteen boxes around a mesh, some of which are joined to polygons of several steps.
fn boxes(random: &mut Random, side: f64) -> Vec<Rings> {
    let mut cuts = || {
        let mut cuts: Vec<f64> = (0..3).map(|_| side * random.unit()).collect();
        cuts.sort_by(f64::total_cmp);
        [-1.0, cuts[0], cuts[1], cuts[2], side + 1.0]
    };
    let columns = cuts();
    // Rows differ by column, so boxes meet at places where edges of others pass.
    (0..4)
        .flat_map(|column| {
            let rows = cuts();
            (0..4).map(move |row| {
                vec![rectangle([columns[column], rows[row]], [columns[column + 1], rows[row + 1]])]
            })
        })
        .collect()
}

#[test]
fn sixteen_boxes_add_up_to_the_last_unit() {
    for seed in 0..7 {
        let mut random = Random::new(seed);
        let (points, side) = if seed < 6 { (40, 1000) } else { (1000, 100_000) };
        let [a, b] = [0, 1].map(|_| Mesh::random(&mut random, points, side, 300).integers());
        let boxes = boxes(&mut random, side as f64);
        let plane = Other::Plane([100.0, 0.01, -0.02]);
        for other in [Other::Mesh(&b), Other::Levels(&[20.0, 120.5, 133.0]), plane] {
            let whole = compared(&a, &other);
            let parts = within(&a, &other, &boxes);
            for (level, whole) in whole.volumes[0].iter().enumerate() {
                assert_eq!(sum(parts.volumes.iter().map(|part| &part[level])), *whole, "{seed} {other:?}");
            }
        }
        let parts = within(&a, &Other::Mesh(&b), &boxes);
        let back = within(&b, &Other::Mesh(&a), &boxes);
        for (part, back) in parts.volumes.iter().zip(&back.volumes) {
            assert_eq!(turned(&part[0]), back[0]);
        }
        // Each box alone is what it is among others.
        for (rings, part) in boxes.iter().zip(&parts.volumes) {
            assert_eq!(within(&a, &Other::Mesh(&b), std::slice::from_ref(rings)).volumes[0], *part);
        }
    }
}

#[test]
fn polygons_with_holes_are_exact() {
    let [area, volume] = units_of_step();
    for seed in 0..30 {
        let mut random = Random::new(seed);
        let meshes = [0, 1].map(|_| Mesh::random(&mut random, 12, 20, 9));
        let [a, b] = meshes.each_ref().map(Mesh::integers);
        // A convex polygon with a hole in it, in any orientation.
        let outer = vec![[1, 2], [9, 0], [19, 4], [17, 15], [5, 18]];
        let hole = vec![[6, 6], [12, 5], [13, 11]];
        let world = |ring: &[[i64; 2]]| ring.iter().map(|place| place.map(|value| value as f64)).collect();
        let mut rings: Rings = vec![world(&outer), world(&hole)];
        for ring in &mut rings {
            if random.below(2) == 0 {
                ring.reverse();
            }
        }
        if random.below(2) == 0 {
            rings.reverse();
        }
        let found = within(&a, &Other::Mesh(&b), &[rings]);
        let [around, inside] =
            [outer, hole].map(|ring| overlay(&meshes[0].corners(), &meshes[1].corners(), Some(&ring)));
        let units = &found.volumes[0][0];
        // Each edge adds two terms of two parts.
        let most = BigInt::from(32 * found.pieces);
        for (exact, units, size) in [
            (around.cut[0].minus(&inside.cut[0]), &units.cut, &volume),
            (around.fill[0].minus(&inside.fill[0]), &units.fill, &volume),
            (around.fill[1].minus(&inside.fill[1]), &units.fill_area, &area),
            (around.level.minus(&inside.level), &units.level_area, &area),
        ] {
            assert!(exact.distance(units, size) <= most, "seed {seed}: {exact:?} {units}");
        }
    }
}

#[test]
fn polygons_that_cross_themselves_are_refused() {
    let mesh = Mesh::random(&mut Random::new(1), 20, 30, 9).integers();
    let bow_tie = vec![vec![[0.0, 0.0], [9.0, 9.0], [9.0, 0.0], [0.0, 9.0]]];
    let square = rectangle([9.0, 9.0], [21.0, 21.0]);
    let shared = vec![square.clone(), rectangle([9.0, 11.0], [14.0, 14.0])];
    let touching = vec![square.clone(), vec![[9.0, 14.0], [18.0, 11.0], [18.0, 17.0]]];
    let run = |rings: Rings| {
        let options = Options { polygons: &[rings], memory: MEMORY, threads: 1 };
        compare(&mesh, &Other::Levels(&[3.0]), &options, &mut |_, _| ())
    };
    for rings in [bow_tie, shared] {
        let error = run(rings).unwrap_err();
        assert!(error.exit_code() == 2 && error.to_string().contains("polygon 1"), "{error}");
    }
    let touching = run(touching).unwrap();
    let outer = within(&mesh, &Other::Levels(&[3.0]), &[vec![square]]);
    assert!(touching.volumes[0][0].area() < outer.volumes[0][0].area());
}
