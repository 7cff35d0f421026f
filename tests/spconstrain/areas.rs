//! Hulls, holes, and long edges at the border, against triangles that are tried one by one.

use super::{Mesh, audit, mesh, output};
use crate::programs::{Folder, outcome, run};
use spmesh_base::random::Random;
use std::collections::{BTreeMap, BTreeSet};

/// Scattered points, and polygons among them: two that overlap, one with a hole.
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
        assert!(differing.iter().all(|corners| twice_area(corners) < 800), "{differing:?}");
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

/// Whether a line from `p` to `q` meets the interior of a triangle.
fn divides([p, q]: [[i64; 2]; 2], corners: &[[i64; 2]; 3]) -> bool {
    let turn = |a: [i64; 2], b: [i64; 2], c: [i64; 2]| {
        ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).signum()
    };
    let [a, b, c] = *corners;
    let out = turn(a, b, c);
    let is_beyond = |u, v| [p, q].iter().all(|&at| turn(u, v, at) * out <= 0);
    let sides = corners.map(|at| turn(p, q, at));
    !is_beyond(a, b) && !is_beyond(b, c) && !is_beyond(c, a) && sides.contains(&1) && sides.contains(&-1)
}

/// A star around a place, counterclockwise; closed.
fn star(random: &mut Random, [x, y]: [f64; 2], radius: f64, corners: usize) -> Vec<[i64; 2]> {
    let corner = |number: usize| {
        let angle = std::f64::consts::TAU * (number as f64 + 0.8 * random.unit()) / corners as f64;
        let reach = radius * (0.3 + 0.7 * random.unit());
        [x + reach * angle.cos(), y + reach * angle.sin()].map(|x| x.round() as i64)
    };
    let mut ring: Vec<[i64; 2]> = (0..corners).map(corner).collect();
    ring.push(ring[0]);
    ring
}

fn polygon_file(folder: &Folder, name: &str, ring: &[[i64; 2]]) -> String {
    let text = format!(r#"{{"type":"Polygon","coordinates":[{ring:?}]}}"#);
    folder.file(name, text);
    folder.path(name)
}

/// The meshes that a polygon leaves as `--hull` and as `--holes`, and all of their triangles, which cover the
/// whole mesh.
fn parted(path: &str, stream: &[u8]) -> ([Vec<u8>; 2], Vec<[[i64; 2]; 3]>) {
    let cuts = ["--hull", "--holes"].map(|flag| output("spconstrain", &[flag, path], stream));
    let mut all = cuts.each_ref().map(|cut| mesh(cut).triangles).concat();
    all.sort_unstable();
    all.dedup();
    let area = |triangles: &[[[i64; 2]; 3]]| triangles.iter().map(twice_area).sum::<i64>();
    assert_eq!(area(&all), area(&mesh(stream).triangles));
    (cuts, all)
}

fn twice_area([a, b, c]: &[[i64; 2]; 3]) -> i64 {
    ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs()
}

#[test]
fn triangles_that_a_ring_divides_where_it_leaves_the_mesh_stay() {
    let (mut divided, mut removed) = (0, 0);
    for seed in 0..40 {
        let folder = Folder::new();
        let mut random = Random::new(100 + seed);
        let points: String =
            (0..300).map(|_| format!("{} {} 0\n", random.below(1000), random.below(1000))).collect();
        folder.file("points.txt", points);
        let points = output("spfinalize", &[&folder.path("points.txt")], &[]);
        let stream = output("spdelaunay2d", &[], &points);
        let centre = [1200.0 * random.unit() - 100.0, 1200.0 * random.unit() - 100.0];
        let corners = 3 + random.below(12) as usize;
        let hull = star(&mut random, centre, 900.0, corners);
        let path = polygon_file(&folder, "area.geojson", &hull);
        let (cuts, all) = parted(&path, &stream);
        let is_divided =
            |corners: &[[i64; 2]; 3]| hull.windows(2).any(|side| divides([side[0], side[1]], corners));
        let of_hull = |corners: &&[[i64; 2]; 3]| {
            is_divided(corners) || is_in(&hull, [0, 1].map(|axis| corners.iter().map(|at| at[axis]).sum()))
        };
        for (cut, is_hull) in cuts.iter().zip([true, false]) {
            audit(cut);
            let stays = |corners: &&[[i64; 2]; 3]| is_divided(corners) || of_hull(corners) == is_hull;
            let expected: Vec<[[i64; 2]; 3]> = all.iter().filter(stays).copied().collect();
            assert_eq!(mesh(cut).triangles, expected, "seed {seed}, {is_hull}");
            removed += all.len() - expected.len();
        }
        divided += all.iter().filter(|corners| is_divided(corners)).count();
    }
    assert!(divided > 400 && removed > 5000, "{divided} divided, {removed} removed");
}

#[test]
fn segments_in_areas_that_are_cut_off_do_not_leave_the_mesh() {
    let folder = Folder::new();
    let stream = scene(&folder, 7);
    let hull = polygon_file(&folder, "hull.geojson", &HULL);
    folder.file("lines.txt", "soft 20 20 40 60\nsoft 300 300 420 330\n");
    let lines = folder.path("lines.txt");
    let run = run("spconstrain", &["--hull", &hull, "--lines", &lines, "--stats=json"], &stream);
    let (code, message) = outcome(&run);
    assert_eq!(code, Some(0), "{message}");
    audit(&run.stdout);
    assert!(
        message.contains(r#""cut_segments":1,"#) && message.contains(r#""open_segments":0,"#),
        "{message}"
    );
    assert!(!message.contains("leave the mesh"), "{message}");
}

#[test]
fn rings_with_vertices_on_the_border_of_the_mesh_leave_it_there() {
    let folder = Folder::new();
    let points: String =
        (0..11).flat_map(|x| (0..11).map(move |y| format!("{} {} 0\n", 10 * x, 10 * y))).collect();
    folder.file("points.txt", points);
    let points = output("spfinalize", &[&folder.path("points.txt")], &[]);
    let stream = output("spdelaunay2d", &[], &points);
    // Through vertices of the border, along it, through edges of it at new vertices, and across it.
    for ring in [
        vec![[-50, 0], [150, 0], [150, 50], [-50, 50], [-50, 0]],
        vec![[0, 0], [105, 105], [0, 100], [0, 0]],
        vec![[0, 5], [100, 5], [100, 25], [0, 33], [0, 5]],
        vec![[-20, 15], [0, 15], [50, 47], [0, 85], [-20, 85], [-20, 15]],
        vec![[-7, -7], [107, 111], [-7, 111], [-7, -7]],
        vec![[-100, -100], [300, -100], [300, 300], [-100, 300], [-100, -100]],
    ] {
        let path = polygon_file(&folder, "area.geojson", &ring);
        let (cuts, all) = parted(&path, &stream);
        for (cut, is_hull) in cuts.iter().zip([true, false]) {
            audit(cut);
            let stays = |corners: &&[[i64; 2]; 3]| {
                let middle = [0, 1].map(|axis| corners.iter().map(|at| at[axis]).sum());
                is_in(&ring, middle) == is_hull
                    || ring.windows(2).any(|side| divides([side[0], side[1]], corners))
            };
            let expected: Vec<[[i64; 2]; 3]> = all.iter().filter(stays).copied().collect();
            assert_eq!(mesh(cut).triangles, expected, "{ring:?}, {is_hull}");
        }
    }
}

#[test]
fn areas_among_coordinates_that_are_not_exact_are_exact() {
    for seed in 0..60 {
        let folder = Folder::new();
        let mut random = Random::new(700 + seed);
        let offset = if seed % 2 == 0 { 0.0 } else { 500_000.0 };
        let mut place = || [0, 1].map(|_| offset + random.below(100) as f64 / 10.0);
        let points: String = (0..40).map(|_| place()).map(|[x, y]| format!("{x} {y} 0\n")).collect();
        let corners: Vec<String> = (0..4).map(|_| place()).map(|[x, y]| format!("[{x},{y}]")).collect();
        let ring = format!("{},{}", corners.join(","), corners[0]);
        folder.file("area.geojson", format!(r#"{{"type":"Polygon","coordinates":[[{ring}]]}}"#));
        let area = folder.path("area.geojson");
        // Without a scale, coordinates are f64, so that places on a line of decimals are beside it.
        let points = output("spfinalize", &["-"], points.as_bytes());
        let stream = output("spdelaunay2d", &[], &points);
        for flags in [["--hull", &area, "--quiet"], ["--holes", &area, "--quiet"]] {
            audit(&output("spconstrain", &flags, &stream));
            let dense = [&flags[..], &["--densify", "0.7"]].concat();
            audit(&output("spconstrain", &dense, &stream));
        }
    }
}
