//! Volumes with those of an exact overlay of all pairs of triangles.

use super::{GRID, Mesh, compared, turned, units_of_step, volumes};
use num_bigint::BigInt;
use spmesh_base::random::Random;
use spmesh_reference::overlay::overlay;
use spmesh_stream::Coordinates;
use spmesh_terrain::diff::Other;

/// A pair of meshes of a kind.
fn pair(seed: u64) -> [Mesh; 2] {
    let mut random = Random::new(seed);
    let points = 3 + random.below(12);
    let first = Mesh::random(&mut random, points, 7, 4);
    let second = match seed % 10 {
        // Ties: few places and elevations.
        0 => Mesh::random(&mut random, points, 7, 4),
        1 => first.clone(),
        // The same triangles with other elevations.
        2 => first.raised(|_| random.below(4) as f64),
        // Planes in common over different triangles.
        3 | 4 => {
            let plane = |[x, y, _]: [f64; 3]| 3.0 * x - 2.0 * y + 20.0;
            let lifted = |[x, y, z]: [f64; 3]| plane([x, y, z]) + if x < 4.0 { 0.0 } else { z };
            let second = Mesh::random(&mut random, 12, 7, 2);
            return if seed % 10 == 3 {
                [first.raised(plane), second.raised(plane)]
            } else {
                [first.raised(lifted), second.raised(lifted)]
            };
        }
        // One beside the other, with places in common.
        5 => {
            let beside = Mesh::random(&mut random, points, 7, 4).vertices;
            Mesh::of(beside.into_iter().map(|[x, y, z]| [x + 6.0, y, z]).collect())
        }
        // Corners on edges, and edges on edges.
        6 => Mesh::of(
            [[0, 0], [6, 0], [6, 6], [0, 6], [3, 0], [3, 3]]
                .map(|[x, y]| [f64::from(x), f64::from(y), f64::from(x + y) / 3.0])
                .map(|[x, y, z]| [x, y, z.floor()])
                .to_vec(),
        ),
        7 => {
            return [
                Mesh::random(&mut random, points, 1 << 20, 1 << 16),
                Mesh::random(&mut random, 9, 1 << 20, 1 << 16),
            ];
        }
        8 => {
            return [
                Mesh::random(&mut random, points, 1 << 31, 1 << 31),
                Mesh::random(&mut random, 5, 1 << 31, 1 << 31),
            ];
        }
        // Slivers.
        _ => {
            let sliver = |random: &mut Random| {
                [random.below(1 << 30), random.below(3), random.below(9)].map(|value| value as f64)
            };
            return [0, 1].map(|_| Mesh::of((0..8).map(|_| sliver(&mut random)).collect()));
        }
    };
    [first, second]
}

#[test]
fn volumes_are_those_of_exact_overlay() {
    let [area, volume] = units_of_step();
    let mut counts = [0; 2];
    for seed in 0..250 {
        let meshes = pair(seed);
        let [a, b] = meshes.each_ref().map(Mesh::integers);
        let found = compared(&a, &Other::Mesh(&b));
        assert_eq!(found.rounded, None);
        let exact = overlay(&meshes[0].corners(), &meshes[1].corners(), None);
        let units = &found.volumes[0][0];
        // Pieces that are cut where surfaces cross are rounded in two parts, to half a unit each.
        let most = BigInt::from(found.pieces);
        // Of large coordinates, the digits of a value end above a unit.
        let (gross, whole) = (&units.cut + &units.fill, units.area());
        for (exact, units, size, all) in [
            (&exact.cut[0], &units.cut, &volume, &gross),
            (&exact.cut[1], &units.cut_area, &area, &whole),
            (&exact.fill[0], &units.fill, &volume, &gross),
            (&exact.fill[1], &units.fill_area, &area, &whole),
            (&exact.level, &units.level_area, &area, &whole),
        ] {
            let off = exact.distance(units, size);
            let slack = &most + if seed % 10 < 7 { BigInt::ZERO } else { all >> 90u32 };
            assert!(off <= slack, "seed {seed}: {exact:?} is {off} units from {units}, {meshes:?}");
        }
        counts[usize::from(found.pieces > 0)] += 1;
        assert_eq!(volumes(&b, &a), turned(units), "seed {seed}");
        assert_eq!(volumes(&b, &a).net(), -units.net());
    }
    assert!(counts[1] > 180, "{counts:?}");
}

#[test]
fn grids_in_line_are_exact() {
    let [area, volume] = units_of_step();
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let meshes = [0, 1].map(|_| Mesh::random(&mut random, 10, 9, 5));
        let offset = [5_000_000.1, 450_000.2, 100.0];
        let fine = Coordinates::I32 { scale: [0.01; 3], offset: [5_000_000.13, 450_000.19, 99.99] };
        let coarse = Coordinates::I32 { scale: [0.02, 0.02, 0.01], offset };
        let found = compared(&meshes[0].surface(fine), &Other::Mesh(&meshes[1].surface(coarse)));
        assert_eq!(found.rounded, None);
        let moved = meshes[1].vertices.iter().map(|&[x, y, z]| [2.0 * x - 3.0, 2.0 * y + 1.0, z + 1.0]);
        let second = Mesh { vertices: moved.collect(), ..meshes[1].clone() };
        let exact = overlay(&meshes[0].corners(), &second.corners(), None);
        let most = BigInt::from(found.pieces);
        assert!(exact.fill[0].distance(&found.volumes[0][0].fill, &volume) <= most, "{seed}");
        assert!(exact.cut[1].distance(&found.volumes[0][0].cut_area, &area) <= most, "{seed}");
    }
}

#[test]
fn neither_order_nor_threads_nor_corners_matter() {
    let mut random = Random::new(5);
    let meshes = [0, 1].map(|_| Mesh::random(&mut random, 6000, 20_000, 500));
    let [a, b] = meshes.each_ref().map(Mesh::integers);
    let found = volumes(&a, &b);
    let mut shuffled = meshes[0].clone();
    random.shuffle(&mut shuffled.triangles);
    shuffled.triangles.iter_mut().for_each(|triangle| triangle.rotate_left(1));
    assert_eq!(volumes(&shuffled.surface(GRID), &b), found);
    assert_eq!(volumes(&b, &shuffled.surface(GRID)), turned(&found));
}
