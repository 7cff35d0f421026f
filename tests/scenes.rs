//! Random scenes of lakes, rivers and lines through all programs, against a search of all triangles.

use spmesh_base::random::Random;

use crate::programs::{Folder, outcome, run};
use crate::spconstrain::{Mesh, audit, mesh};
use crate::water::{distance, is_in, text};

type Line = Vec<[f64; 2]>;

/// Points, water and lines in a square of this side.
const SIDE: u64 = 60;

#[derive(Default)]
struct Scene {
    points: Vec<[i64; 3]>,
    lake: Line,
    level: i64,
    has_z: bool,
    river: Line,
    soft: Vec<Line>,
    hard: Vec<[i64; 3]>,
    densify: Option<String>,
    /// Whether water, and lines, are given to `spconstrain` alone.
    is_late: [bool; 2],
    /// What `--hull` keeps.
    hull: Option<Line>,
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
    /// from the lake or the river to anywhere, also beyond the points, a hard one in the lower right quarter.
    /// Corners may be without points, also that of a lake with a level.
    fn random(random: &mut Random) -> Scene {
        let is_late = [random.below(3) == 0, random.below(3) == 0];
        let cuts = [0, 1, 2, 3].map(|_| random.below(2) as f64 * (10.0 + random.unit() * 15.0));
        let is_far = !is_late[0] && random.below(4) == 0;
        let lower_left = if is_far { 62.0 + random.unit() * 8.0 } else { cuts[0].min(12.0) };
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|at| at.map(|x| x * SIDE as f64));
        let is_cut = |at: [f64; 2]| {
            let cuts = [lower_left, cuts[1], cuts[2], cuts[3]];
            corners.iter().zip(cuts).any(|([x, y], cut)| (at[0] - x).abs() + (at[1] - y).abs() < cut)
        };
        let ground = |[x, y]: [i64; 2]| 10_000 + x / 20 - y / 30;
        let point = |random: &mut Random| {
            let mut at = place(random, 0, SIDE);
            while is_cut(at) {
                at = place(random, 0, SIDE);
            }
            let at = at.map(cents);
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
        let soft = (0..4).map(|number| match number {
            0 => vec![inside(random), place(random, 0, SIDE)],
            1 => vec![inside(random), inside(random)],
            2 => vec![lake[0], place(random, 2, SIDE - 2), place(random, 30, 50)],
            _ => (0..3).map(|_| place(random, 0, SIDE + 10).map(|x| x - 5.0)).collect(),
        });
        let soft = soft.collect();
        let hard = (0..2).map(|_| {
            let [x, y] = place(random, 2, 24).map(cents);
            [x + 3200, y, ground([x, y]) + random.below(300) as i64]
        });
        let hard: Vec<[i64; 3]> = hard.collect();
        let hull = (random.below(4) == 0).then(|| {
            let corner = |[u, v]: [f64; 2]| {
                let [x, y] = place(random, 0, 12);
                [30.0 + 30.0 * u + x, 30.0 + 30.0 * v + y].map(|value| cents(value) as f64 / 100.0)
            };
            [[-1.0, -1.0], [0.0, -1.2], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner).into()
        });
        Scene {
            hard,
            is_late,
            hull,
            points: (0..400).map(|_| point(random)).collect(),
            level: 9_700 - random.below(500) as i64,
            has_z: random.below(2) == 0,
            densify: (random.below(3) == 0).then(|| format!("{}.5", 2 + random.below(5))),
            ..Scene { lake, river, soft, ..Scene::default() }
        }
    }

    /// The ring of the river.
    fn ring(&self) -> Line {
        let bank = |by: f64| self.river.iter().map(move |[x, y]| [*x, y + by]);
        bank(-1.5).chain(bank(1.5).rev()).collect()
    }

    /// All lines, those of water included.
    fn all(&self) -> Vec<Line> {
        let closed = |ring: &Line| [&ring[..], &ring[..1]].concat();
        let hard = self.hard.iter().map(|&[x, y, _]| [x, y].map(|value| value as f64 / 100.0)).collect();
        let mut all = self.soft.clone();
        all.extend([hard, self.river.clone(), closed(&self.lake), closed(&self.ring())]);
        all
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

/// The convex hull of some places, counterclockwise.
fn hull_of(mut places: Line) -> Line {
    places.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    let chain = |places: &mut dyn Iterator<Item = &[f64; 2]>| {
        let mut chain: Line = Vec::new();
        for &[x, y] in places {
            let turns_left = |chain: &Line| {
                let [[a, b], [c, d]] = [chain[chain.len() - 2], chain[chain.len() - 1]];
                (c - a) * (y - b) > (d - b) * (x - a)
            };
            while chain.len() > 1 && !turns_left(&chain) {
                chain.pop();
            }
            chain.push([x, y]);
        }
        chain.pop();
        chain
    };
    let lower = chain(&mut places.iter());
    [lower, chain(&mut places.iter().rev())].concat()
}

#[test]
fn water_is_level_and_lines_are_edges_in_random_scenes() {
    let folder = Folder::new();
    let count = std::env::var("SCENES").map_or(40, |count| count.parse().expect("a number"));
    let mut wrong = Vec::new();
    for seed in 0..count {
        let scene = Scene::random(&mut Random::new(seed));
        if let Err(message) = try_scene(&folder, &scene) {
            wrong.push(format!("{seed}: {message}"));
        }
    }
    assert!(wrong.is_empty(), "{} wrong scenes:\n{}", wrong.len(), wrong.join("\n"));
}

fn try_scene(folder: &Folder, scene: &Scene) -> Result<(), String> {
    let collection = |features: String| format!(r#"{{"type":"FeatureCollection","features":[{features}]}}"#);
    let water = folder.write("water.geojson", collection(scene.water()));
    let lines = folder.write("lines.geojson", collection(scene.lines()));
    let densify = scene.densify.as_ref().map_or(vec![], |length| vec!["--densify", length]);
    let mut flags = vec!["--scale", "0.01,0.01,0.01", "-"];
    if scene.is_late != [true; 2] {
        flags.extend(&densify);
    }
    if !scene.is_late[0] {
        flags.extend(["--flatten", &water, "--shore-width", "4"]);
    }
    if !scene.is_late[1] {
        flags.extend(["--lines", &lines]);
    }
    let points = run("spfinalize", &flags, text(&scene.points).as_bytes());
    let delaunay = run("spdelaunay2d", &[], &points.stdout);
    let ring = scene.hull.as_ref().map(|ring| {
        let closed = [&ring[..], &ring[..1]].concat();
        folder.write("hull.geojson", feature("Polygon", "", &format!("[{}]", chain(&closed, ""))))
    });
    let ring = ring.as_ref().map_or(vec![], |ring| vec!["--hull", ring]);
    let both = [&["--lines", &water, "--lines", &lines], &densify[..], &ring].concat();
    let constrained = run("spconstrain", &both, &delaunay.stdout);
    let (code, messages) = outcome(&constrained);
    let first = outcome(&points).1;
    if code != Some(0)
        || messages.contains("not level")
        || first.contains("left out")
        || [&first, &messages].iter().any(|it| it.contains("are far from"))
    {
        return Err(format!("{code:?} {first}{messages}"));
    }
    audit(&constrained.stdout);
    let hull =
        hull_of(mesh(&delaunay.stdout).elevations.keys().map(|at| at.map(|x| x as f64 / 100.0)).collect());
    let are_all = |is_so: &dyn Fn([f64; 2]) -> bool| scene.all().iter().flatten().all(|&at| is_so(at));
    let is_inside = are_all(&|at| is_well_in(&hull, at));
    let leaves = !are_all(&|at| is_in(&hull, at) || distance(&hull, at) < 0.05);
    let says_so = messages.contains(" the mesh: parts outside");
    if scene.hull.is_none() && (says_so && is_inside || leaves && !says_so) {
        return Err(format!("lines leave the mesh: {leaves}. {messages}"));
    }
    check(scene, &mesh(&constrained.stdout), &hull)
}

/// Whether a place is in a ring and not near it.
fn is_well_in(ring: &Line, at: [f64; 2]) -> bool {
    is_in(ring, at) && distance(ring, at) > 0.05
}

fn check(scene: &Scene, found: &Mesh, hull: &Line) -> Result<(), String> {
    let is_mesh =
        |at: [f64; 2]| is_well_in(hull, at) && scene.hull.as_ref().is_none_or(|ring| is_well_in(ring, at));
    let edges: Vec<[[f64; 2]; 2]> =
        found.constrained.iter().map(|ends| ends.map(|end| end.map(|value| value as f64 / 100.0))).collect();
    for line in scene.all().iter().flat_map(|line| line.windows(2)) {
        for step in 0..=40 {
            let at =
                [0, 1].map(|axis| line[0][axis] + (line[1][axis] - line[0][axis]) * f64::from(step) / 40.0);
            let away = edges.iter().map(|edge| distance(edge, at)).fold(f64::INFINITY, f64::min);
            if is_mesh(at) && away > 0.03 {
                return Err(format!("no edge at {at:?}"));
            }
        }
    }
    for [x, y, z] in &scene.hard {
        if found.elevations.get(&[*x, *y]) != Some(z) && is_mesh([*x, *y].map(|x| x as f64 / 100.0)) {
            return Err(format!("a vertex of a line is not at {x} {y} {z}"));
        }
    }
    if scene.has_z || !scene.is_late[0] {
        let is_shore = |ends: &[[f64; 2]; 2]| {
            let [a, b] = *ends;
            let middle = [0, 1].map(|axis| (a[axis] + b[axis]) / 2.0);
            (a[0] - b[0]).hypot(a[1] - b[1]) > 0.1
                && [a, b, middle].iter().all(|&at| distance(&scene.lake, at) < 0.0075 && is_mesh(at))
        };
        for at in edges.iter().filter(|ends| is_shore(ends)).flatten() {
            let z = found.elevations[&at.map(cents)];
            if z != scene.level {
                return Err(format!("a shore is not level at {at:?}: {z}, not {}", scene.level));
            }
        }
    }
    if !scene.is_late[0] { check_water(scene, found, is_mesh) } else { Ok(()) }
}

fn check_water(scene: &Scene, found: &Mesh, is_mesh: impl Fn([f64; 2]) -> bool) -> Result<(), String> {
    let of = |at: [f64; 2]| elevation(found, at.map(|value| 100.0 * value));
    for at in (0..900).map(|number| [f64::from(number % 30) + 0.25, f64::from(number / 30) + 0.75]) {
        if is_well_in(&scene.lake, at) && is_mesh(at) {
            let z = of(at);
            if z.is_none_or(|z| (z - scene.level as f64).abs() > 1e-6) {
                return Err(format!("a lake is not level at {at:?}: {z:?}, not {}", scene.level));
            }
        }
    }
    let along = |number: i32| {
        let (part, way) = (number as usize / 10, f64::from(number % 10) / 10.0);
        [0, 1].map(|axis| scene.river[part][axis] * (1.0 - way) + scene.river[part + 1][axis] * way)
    };
    let levels: Vec<Option<f64>> = (0..40).map(along).filter(|&at| is_mesh(at)).map(of).collect();
    if levels.windows(2).any(|pair| pair[1].is_none() || pair[1] >= pair[0].map(|z| z + 1.5)) {
        return Err(format!("a river rises: {levels:?}"));
    }
    Ok(())
}
