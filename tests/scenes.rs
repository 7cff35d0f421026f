//! Random scenes of lakes, rivers and lines through all programs, against a search of all triangles.

use spmesh_base::random::Random;

use crate::programs::{Folder, outcome, run};
use crate::spconstrain::{Mesh, audit, mesh};
use crate::water::{distance, is_in, text};

type Line = Vec<[f64; 2]>;

/// Points, water and lines in a square of this side.
const SIDE: u64 = 60;

struct Scene {
    points: Vec<[i64; 3]>,
    lake: Line,
    level: i64,
    has_z: bool,
    river: Line,
    soft: Vec<Line>,
    hard: Vec<[i64; 3]>,
    densify: Option<String>,
}

/// A hundredth.
fn cents(value: f64) -> i64 {
    (value * 100.0).round() as i64
}

fn place(random: &mut Random, low: u64, high: u64) -> [f64; 2] {
    [0, 1].map(|_| (100 * low + random.below(100 * (high - low))) as f64 / 100.0)
}

impl Scene {
    /// A lake below the ground in the lower left quarter, a river in the upper half, and lines: soft ones
    /// from the lake or the river to anywhere, a hard one in the lower right quarter.
    fn random(random: &mut Random) -> Scene {
        let ground = |[x, y]: [i64; 2]| 10_000 + x / 20 - y / 30;
        let point = |random: &mut Random| {
            let at = place(random, 0, SIDE).map(cents);
            [at[0], at[1], ground(at) + random.below(30) as i64]
        };
        let corner = |[u, v]: [f64; 2], random: &mut Random| {
            let [x, y] = place(random, 0, 4);
            [15.0 + 6.0 * u + x, 12.0 + 6.0 * v + y].map(|value| cents(value) as f64 / 100.0)
        };
        let lake: Line =
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|at| corner(at, random)).into();
        let river = (0..5).map(|x| [6.0 + 12.0 * f64::from(x), place(random, 40, 48)[1]]).collect();
        let inside = |random: &mut Random| place(random, 13, 18);
        let soft = (0..3).map(|number| match number {
            0 => vec![inside(random), place(random, 2, SIDE - 2)],
            1 => vec![inside(random), inside(random)],
            _ => vec![lake[0], place(random, 2, SIDE - 2), place(random, 30, 50)],
        });
        let soft = soft.collect();
        let hard = (0..2).map(|_| {
            let [x, y] = place(random, 2, 24).map(cents);
            [x + 3200, y, ground([x, y]) + random.below(300) as i64]
        });
        Scene {
            hard: hard.collect(),
            points: (0..400).map(|_| point(random)).collect(),
            level: 9_700 - random.below(500) as i64,
            has_z: random.below(2) == 0,
            densify: (random.below(3) == 0).then(|| format!("{}.5", 2 + random.below(5))),
            ..Scene {
                lake,
                river,
                soft,
                points: Vec::new(),
                level: 0,
                has_z: false,
                hard: Vec::new(),
                densify: None,
            }
        }
    }

    /// The ring of the river.
    fn ring(&self) -> Line {
        let bank = |by: f64| self.river.iter().map(move |[x, y]| [*x, y + by]);
        bank(-1.5).chain(bank(1.5).rev()).collect()
    }

    fn water(&self) -> String {
        let level = self.level as f64 / 100.0;
        let z = if self.has_z { format!(",{level}") } else { String::new() };
        let properties = if self.has_z { String::new() } else { format!(r#""level":{level}"#) };
        let closed = |ring: &Line| [&ring[..], &ring[..1]].concat();
        [
            feature("Polygon", &properties, &format!("[{}]", chain(&closed(&self.lake), &z))),
            feature("Polygon", r#""river":1"#, &format!("[{}]", chain(&closed(&self.ring()), ""))),
            feature("LineString", r#""river":1"#, &chain(&self.river, "")),
        ]
        .join(",")
    }

    fn lines(&self) -> String {
        let soft = self.soft.iter().map(|line| feature("LineString", "", &chain(line, "")));
        let hard = self.hard.iter().map(|at| {
            let [x, y, z] = at.map(|value| value as f64 / 100.0);
            format!("[{x},{y},{z}]")
        });
        let hard: Vec<String> = hard.collect();
        soft.chain([feature("LineString", "", &format!("[{}]", hard.join(",")))])
            .collect::<Vec<_>>()
            .join(",")
    }
}

fn chain(places: &[[f64; 2]], z: &str) -> String {
    let all: Vec<String> = places.iter().map(|[x, y]| format!("[{x},{y}{z}]")).collect();
    format!("[{}]", all.join(","))
}

fn feature(kind: &str, properties: &str, coordinates: &str) -> String {
    let geometry = format!(r#"{{"type":"{kind}","coordinates":{coordinates}}}"#);
    format!(r#"{{"type":"Feature","properties":{{{properties}}},"geometry":{geometry}}}"#)
}

/// The elevation of a mesh at a place, in hundredths; `None` outside.
fn elevation(mesh: &Mesh, at: [f64; 2]) -> Option<f64> {
    mesh.triangles.iter().find_map(|corners| {
        let [a, b, c] = corners.map(|corner| corner.map(|value| value as f64));
        let cross = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
            (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
        };
        let whole = cross(a, b, c);
        let parts = [cross(at, b, c), cross(a, at, c), cross(a, b, at)].map(|part| part / whole);
        let z = corners.map(|corner| mesh.elevations[&corner] as f64);
        parts.iter().all(|part| *part >= -1e-9).then(|| (0..3).map(|place| parts[place] * z[place]).sum())
    })
}

#[test]
fn water_is_level_and_lines_are_edges_in_random_scenes() {
    let folder = Folder::new();
    for seed in 0..30 {
        let mut random = Random::new(seed);
        let scene = Scene::random(&mut random);
        let collection =
            |features: String| format!(r#"{{"type":"FeatureCollection","features":[{features}]}}"#);
        let water = folder.write("water.geojson", collection(scene.water()));
        let lines = folder.write("lines.geojson", collection(scene.lines()));
        let densify = scene.densify.as_ref().map_or(vec![], |length| vec!["--densify", length]);
        let flags =
            ["--scale", "0.01,0.01,0.01", "--flatten", &water, "--shore-width", "4", "--lines", &lines];
        let points =
            run("spfinalize", &[&flags[..], &densify, &["-"]].concat(), text(&scene.points).as_bytes());
        let delaunay = run("spdelaunay2d", &[], &points.stdout);
        let both = [&["--lines", &water, "--lines", &lines], &densify[..]].concat();
        let constrained = run("spconstrain", &both, &delaunay.stdout);
        let (code, messages) = outcome(&constrained);
        assert_eq!(code, Some(0), "{seed}: {:?} {messages}", outcome(&points));
        assert!(
            !messages.contains("leave the mesh") && !messages.contains("not level"),
            "{seed}: {messages}"
        );
        audit(&constrained.stdout);
        check(seed, &scene, &mesh(&constrained.stdout));
    }
}

fn check(seed: u64, scene: &Scene, found: &Mesh) {
    for x in 0..30 {
        for y in 0..30 {
            let at = [f64::from(x) + 0.25, f64::from(y) + 0.75];
            if is_in(&scene.lake, at) && distance(&scene.lake, at) > 0.03 {
                let z = elevation(found, at.map(|value| 100.0 * value));
                assert!(z.is_some_and(|z| (z - scene.level as f64).abs() < 1e-6), "{seed}, {at:?}: {z:?}");
            }
        }
    }
    let along = |number: i32| {
        let (part, way) = (number as usize / 10, f64::from(number % 10) / 10.0);
        [0, 1].map(|axis| 100.0 * (scene.river[part][axis] * (1.0 - way) + scene.river[part + 1][axis] * way))
    };
    let levels: Vec<f64> = (0..40).filter_map(|number| elevation(found, along(number))).collect();
    assert!(
        levels.len() == 40 && levels.windows(2).all(|pair| pair[1] < pair[0] + 1.5),
        "{seed}: {levels:?}"
    );
    for &[x, y, z] in &scene.hard {
        assert_eq!(found.elevations.get(&[x, y]), Some(&z), "{seed}");
    }
    let edges: Vec<[[f64; 2]; 2]> =
        found.constrained.iter().map(|ends| ends.map(|end| end.map(|value| value as f64 / 100.0))).collect();
    for line in scene.soft.iter().flat_map(|line| line.windows(2)) {
        for step in 0..=20 {
            let at =
                [0, 1].map(|axis| line[0][axis] + (line[1][axis] - line[0][axis]) * f64::from(step) / 20.0);
            let away = edges.iter().map(|edge| distance(edge, at)).fold(f64::INFINITY, f64::min);
            assert!(away < 0.03, "{seed}: no edge at {at:?}");
        }
    }
}
