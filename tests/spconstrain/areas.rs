//! Hulls, holes, and long edges at the border, against triangles that are tried one by one.

use super::{Mesh, audit, mesh, output};
use crate::programs::Folder;
use spmesh_core::random::Random;
use std::collections::{BTreeMap, BTreeSet};

/// Scattered points, and polygons: one with a corner outside of the points, two that overlap, one with a
/// hole.
fn scene(folder: &Folder, seed: u64) -> Vec<u8> {
    let mut random = Random::new(seed);
    let points: String = (0..1500)
        .map(|_| format!("{} {} {}\n", random.below(1000), random.below(1000), random.below(50)))
        .collect();
    folder.file("points.txt", points);
    let polygon = |rings: &str| {
        format!(
            r#"{{"type":"Feature","geometry":{{"type":"Polygon","coordinates":[{rings}]}},"properties":null}}"#
        )
    };
    let collection = |features: &[String]| {
        format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","))
    };
    let hull = "[[100,120],[880,60],[930,940],[470,500],[60,910],[100,120]]";
    folder.file("hull.geojson", collection(&[polygon(hull)]));
    let first =
        "[[200,200],[400,210],[390,390],[210,400],[200,200]],[[250,250],[350,255],[300,350],[250,250]]";
    let second = "[[330,330],[700,300],[720,420],[340,430],[330,330]]";
    let third = "[[600,100],[650,100],[650,150],[600,150],[600,100]]";
    folder.file("holes.geojson", collection(&[first, second, third].map(polygon)));
    let points = output("spfinalize", &[&folder.path("points.txt")], &[]);
    output("spdelaunay2d", &[], &points)
}

/// Whether a place, times three, is inside of a ring.
fn is_in(ring: &[[i64; 2]], [x, y]: [i64; 2]) -> bool {
    let mut is_inside = false;
    for edge in ring.windows(2) {
        let [[ax, ay], [bx, by]] = [edge[0], edge[1]].map(|at| at.map(|c| 3 * c));
        if (ay > y) != (by > y) {
            let turn = (bx - ax) * (y - ay) - (by - ay) * (x - ax);
            is_inside ^= (turn > 0) == (by > ay);
        }
    }
    is_inside
}

/// The triangles whose middles are accepted.
fn filtered(all: &Mesh, accepts: impl Fn([i64; 2]) -> bool) -> Vec<[[i64; 2]; 3]> {
    let middle = |corners: &[[i64; 2]; 3]| [0, 1].map(|axis| corners.iter().map(|at| at[axis]).sum());
    all.triangles.iter().filter(|corners| accepts(middle(corners))).copied().collect()
}

/// Removes triangles at long edges of the border until there are none.
fn peeled(all: &Mesh, triangles: Vec<[[i64; 2]; 3]>, length: i64) -> Vec<[[i64; 2]; 3]> {
    let constrained: BTreeSet<[[i64; 2]; 2]> = all.constrained.iter().copied().collect();
    let mut kept: BTreeSet<[[i64; 2]; 3]> = triangles.into_iter().collect();
    loop {
        let mut uses: BTreeMap<[[i64; 2]; 2], Vec<[[i64; 2]; 3]>> = BTreeMap::new();
        for &corners in &kept {
            let [a, b, c] = corners;
            [[a, b], [b, c], [a, c]].into_iter().for_each(|edge| uses.entry(edge).or_default().push(corners));
        }
        let is_long = |edge: &[[i64; 2]; 2]| {
            let [x, y] = [0, 1].map(|axis| edge[1][axis] - edge[0][axis]);
            x * x + y * y > length * length
        };
        let removed: Vec<[[i64; 2]; 3]> = uses
            .iter()
            .filter(|(edge, users)| users.len() == 1 && is_long(edge) && !constrained.contains(*edge))
            .map(|(_, users)| users[0])
            .collect();
        if removed.is_empty() {
            return kept.into_iter().collect();
        }
        removed.iter().for_each(|corners| {
            kept.remove(corners);
        });
    }
}

const HULL: [[i64; 2]; 6] = [[100, 120], [880, 60], [930, 940], [470, 500], [60, 910], [100, 120]];
const HOLES: [&[&[[i64; 2]]]; 3] = [
    &[
        &[[200, 200], [400, 210], [390, 390], [210, 400], [200, 200]],
        &[[250, 250], [350, 255], [300, 350], [250, 250]],
    ],
    &[&[[330, 330], [700, 300], [720, 420], [340, 430], [330, 330]]],
    &[&[[600, 100], [650, 100], [650, 150], [600, 150], [600, 100]]],
];

#[test]
fn what_is_inside_of_areas_stays_or_goes() {
    for seed in 0..3 {
        let folder = Folder::new();
        let stream = scene(&folder, seed);
        let [hull, holes] = ["hull.geojson", "holes.geojson"].map(|name| folder.path(name));
        let all = mesh(&output("spconstrain", &["--lines", &hull, "--lines", &holes], &stream));
        // Rings cross, so segments are bent: the middle of a sliver there may be on the other side.
        let crossings = all.triangles.len();
        assert!(crossings > 3000);
        let cut = output("spconstrain", &["--hull", &hull, "--holes", &holes], &stream);
        audit(&cut);
        let is_hole = |at: [i64; 2]| {
            HOLES.iter().any(|rings| rings.iter().filter(|ring| is_in(ring, at)).count() % 2 == 1)
        };
        let expected = filtered(&all, |at| is_in(&HULL, at) && !is_hole(at));
        let found = mesh(&cut).triangles;
        let expected: BTreeSet<_> = expected.into_iter().collect();
        let differing: Vec<_> = found.iter().filter(|&corners| !expected.contains(corners)).collect();
        let area = |corners: &[[i64; 2]; 3]| {
            let [a, b, c] = *corners;
            ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
        };
        assert!(differing.iter().all(|corners| area(corners) < 800), "{differing:?}");
        assert!(differing.len() < 5 && found.len().abs_diff(expected.len()) < 5);
    }
}

#[test]
fn long_edges_are_taken_off_the_border() {
    for (seed, length) in [(10, 30), (11, 45), (12, 60), (13, 100)] {
        let folder = Folder::new();
        let stream = scene(&folder, seed);
        let hull = folder.path("hull.geojson");
        let kill = length.to_string();
        let all = mesh(&output("spconstrain", &["--lines", &hull], &stream));
        let found = output("spconstrain", &["--lines", &hull, "--kill", &kill], &stream);
        audit(&found);
        let expected = peeled(&all, all.triangles.clone(), length);
        assert_eq!(mesh(&found).triangles, expected, "seed {seed}, length {length}");
        assert!(expected.len() < all.triangles.len());
        let cut = output("spconstrain", &["--hull", &hull, "--kill", &kill], &stream);
        audit(&cut);
        let inside = mesh(&output("spconstrain", &["--hull", &hull], &stream));
        assert_eq!(
            mesh(&cut).triangles,
            peeled(&all, inside.triangles, length),
            "seed {seed}, length {length}"
        );
    }
}
