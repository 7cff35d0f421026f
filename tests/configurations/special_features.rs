//! Sharp corners, creases and linear elements, by the values of splines.

use super::spline::{area, b_spline};
use super::{check_facets, knots};
use spmesh_configurations::special::{self, Crease, Features, Function, FunctionKind, Special};
use spmesh_configurations::{self as configurations, Knots, Links, Rule};
use spmesh_reference::sets::Random;

/// Knots in a square whose middle part is coarse enough for features; ids 0..3 are its corners.
fn scattered(seed: u64, count: usize) -> Vec<[f64; 2]> {
    let mut random = Random::new(seed);
    // Coordinates with few digits, so that middles are exact.
    let mut point = || [0.0; 2].map(|_| (random.unit() * 4096.0).round() / 4096.0);
    let corners = [[-1.0, -1.0], [2.0, -1.0], [2.0, 2.0], [-1.0, 2.0]];
    corners.into_iter().chain((0..count).map(|_| point())).collect()
}

/// A special triangulation with its links and functions.
struct Built {
    special: Special,
    links: Links,
    functions: Vec<Function>,
}

fn build(points: &[[f64; 2]], features: &Features, rule: &Rule) -> Built {
    let special = special::features(&knots(points), features)
        .unwrap_or_else(|error| panic!("{error}: let points = vec!{points:?};"));
    let all = special.generate(rule, 1).expect("links");
    check_facets(&all[0], &all[1]).expect("facets");
    let links = configurations::links(&special.knots, &all[1]).expect("links");
    let functions = special.functions(&links).expect("pairs");
    Built { special, links, functions }
}

impl Built {
    fn value(&self, function: &Function, x: [f64; 2]) -> f64 {
        let link = |set: &[u32; 2]| self.links.link(self.links.find(set).expect("a link"));
        function.terms.iter().map(|(set, factor)| factor * b_spline(&self.special.knots, link(set), x)).sum()
    }

    /// The sum of all functions at a point.
    fn sum(&self, x: [f64; 2]) -> f64 {
        self.functions.iter().map(|function| self.value(function, x)).sum()
    }

    fn of_kind(&self, kind: FunctionKind) -> &Function {
        self.functions.iter().find(|function| function.kind == kind).expect("a function")
    }
}

/// Triangles of the start as corner positions, without flat triangles.
fn faces(special: &Special) -> Vec<[[f64; 2]; 3]> {
    let start = special.start.configurations();
    let faces = start.iter().map(|(triangle, _)| triangle.map(|id| special.knots.at(id)));
    faces.filter(|&[a, b, c]| area(a, b, c) != 0.0).collect()
}

/// The barycentric coordinate of corner `v` in the triangle that contains `x`; zero if `v` is not a corner of
/// it.
fn share(faces: &[[[f64; 2]; 3]], v: [f64; 2], x: [f64; 2]) -> f64 {
    for &[a, b, c] in faces {
        let size = area(a, b, c);
        let shares = [(a, area(x, b, c)), (b, area(a, x, c)), (c, area(a, b, x))];
        if shares.iter().all(|(_, part)| *part >= 0.0) {
            return shares.iter().find(|(corner, _)| *corner == v).map_or(0.0, |(_, part)| part / size);
        }
    }
    0.0
}

#[test]
fn all_knots_pulled_apart_are_bezier_patches() {
    let points = scattered(1, 9);
    let features = Features { corners: (0..13).collect(), ..Features::default() };
    for rule in [Rule::Delaunay, Rule::Random(4)] {
        let built = build(&points, &features, &rule);
        let faces = faces(&built.special);
        let mut random = Random::new(2);
        for _ in 0..40 {
            let x = [random.unit() * 3.0 - 1.0, random.unit() * 3.0 - 1.0];
            for function in &built.functions {
                let expected = match function.kind {
                    FunctionKind::Vertex(v) => share(&faces, points[v as usize], x).powi(2),
                    FunctionKind::Tent(ends) => {
                        2.0 * ends.map(|v| share(&faces, points[v as usize], x)).iter().product::<f64>()
                    }
                    kind => panic!("{kind:?}"),
                };
                let found = built.value(function, x);
                assert!((found - expected).abs() < 1e-9, "{:?} at {x:?}: {found} {expected}", function.kind);
            }
        }
    }
}

#[test]
fn splines_interpolate_at_sharp_corners() {
    let points = scattered(5, 30);
    let features = Features { corners: vec![9, 20], ..Features::default() };
    let built = build(&points, &features, &Rule::Delaunay);
    let functions: usize =
        built.functions.iter().filter(|f| !matches!(f.kind, FunctionKind::Edge(_))).count();
    assert!(functions > 8);
    for corner in [9, 20] {
        let at = points[corner as usize];
        let near = [at[0] + 3e-9, at[1] + 2e-9];
        let own = built.value(built.of_kind(FunctionKind::Vertex(corner)), near);
        assert!((own - 1.0).abs() < 1e-6, "{own}");
        assert!((built.sum(near) - 1.0).abs() < 1e-9);
    }
}

#[test]
fn linear_elements_are_interpolated() {
    let points = scattered(7, 40);
    // A polyline of three knots, and a closed one around an empty triangle.
    let line = vec![4, 9, 14];
    let triangle = empty_triangle(&points, &line);
    let features = Features { lines: vec![line.clone(), triangle.clone()], ..Features::default() };
    let built = build(&points, &features, &Rule::MinWeight);
    let height = |v: u32| f64::from(v * v % 17) - 5.0;
    let spline = |x: [f64; 2]| -> f64 {
        let term = |function: &Function| match function.kind {
            FunctionKind::Vertex(v) => height(v) * built.value(function, x),
            // All other functions may have any coefficients.
            _ => 1e3 * built.value(function, x),
        };
        built.functions.iter().map(term).sum()
    };
    let mut random = Random::new(1);
    for edge in line.windows(2).chain(triangle.windows(2)) {
        let (p, q) = (points[edge[0] as usize], points[edge[1] as usize]);
        let t = 0.1 + 0.8 * random.unit();
        let x = [p[0] + t * (q[0] - p[0]) + 1e-11, p[1] + t * (q[1] - p[1]) + 2e-11];
        let expected = (1.0 - t) * height(edge[0]) + t * height(edge[1]);
        assert!((spline(x) - expected).abs() < 1e-4, "{edge:?}: {} {expected}", spline(x));
    }
    let [a, b, c] = [0, 1, 2].map(|i| points[triangle[i] as usize]);
    let centre = [(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0];
    let mean = (height(triangle[0]) + height(triangle[1]) + height(triangle[2])) / 3.0;
    assert!((spline(centre) - mean).abs() < 1e-9, "{} {mean}", spline(centre));
}

/// A closed polyline around a Delaunay triangle off the line; it shares no knot with the line.
fn empty_triangle(points: &[[f64; 2]], line: &[u32]) -> Vec<u32> {
    let lines = Features { lines: vec![line.to_vec()], ..Features::default() };
    let special = special::features(&knots(points), &lines).expect("a line");
    let start = special.start.configurations();
    let fits = |t: &[u32; 3]| t.iter().all(|&v| v >= 4 && (v as usize) < points.len() && !line.contains(&v));
    let [a, b, c] = start.iter().map(|(t, _)| t).find(fits).expect("a triangle off the line");
    vec![a, b, c, a]
}

/// The greatest jump of a function's gradient across a segment, at four places away from the ends.
fn jump(built: &Built, function: &Function, [p, q]: [[f64; 2]; 2]) -> f64 {
    let (along, step) = ([q[0] - p[0], q[1] - p[1]], 1e-5);
    let at = |t: f64, side: f64| {
        let x = [p[0] + t * along[0] - side * step * along[1], p[1] + t * along[1] + side * step * along[0]];
        built.value(function, x)
    };
    let second = |t: f64| (at(t, 1.0) - 2.0 * at(t, 1e-4) + at(t, -1.0)) / step;
    [0.21, 0.43, 0.67, 0.83].iter().map(|&t| second(t).abs()).fold(0.0, f64::max)
}

/// An edge between two inner knots.
fn inner_edge(points: &[[f64; 2]]) -> [u32; 2] {
    let start = configurations::delaunay(&knots(points)).expect("triangles");
    let off = |v: u32| {
        let p = points[v as usize];
        v >= 4 && (p[0] - 0.5).hypot(p[1] - 0.5) < 0.35
    };
    let inner = |&(t, _): &([u32; 3], &[u32])| t.iter().all(|&v| off(v));
    let ([a, b, _], _) = start.iter().find(inner).expect("an inner triangle");
    [a, b]
}

/// Scattered points, an inner edge, and the set-up with a crease along it.
fn with_crease(has_sharp_ends: bool, rule: &Rule) -> (Vec<[f64; 2]>, [u32; 2], Built) {
    let points = scattered(3, 60);
    let edge = inner_edge(&points);
    let crease = Crease { knots: edge.to_vec(), has_sharp_ends };
    let features = Features { creases: vec![crease], ..Features::default() };
    let built = build(&points, &features, rule);
    (points, edge, built)
}

#[test]
fn creases_with_smooth_ends_have_three_sharp_functions() {
    let (points, edge, built) = with_crease(false, &Rule::Delaunay);
    assert_eq!(built.special.knots.len(), 65);
    let kind = FunctionKind::Crease([edge[0], edge[1], 64]);
    let ends = edge.map(|v| points[v as usize]);
    assert!(jump(&built, built.of_kind(kind), ends) > 0.1);
    let mut sum = Function { kind, terms: Vec::new() };
    for function in &built.functions {
        let found = jump(&built, function, ends);
        match function.kind {
            FunctionKind::Edge([_, 64]) | FunctionKind::Crease(_) => {
                assert!(found > 0.1, "{:?}: {found}", function.kind);
                sum.terms.extend_from_slice(&function.terms);
            }
            kind => assert!(found < 5e-3, "{kind:?}: {found}"),
        }
    }
    assert_eq!(sum.terms.len(), 4, "the ends and the knots opposite");
    let found = jump(&built, &sum, ends);
    assert!(found < 5e-3, "the sum is smooth: {found}");
}

#[test]
fn creases_with_sharp_ends_are_tents() {
    let (points, edge, built) = with_crease(true, &Rule::Ear);
    let ends = edge.map(|v| points[v as usize]);
    let tent = built.of_kind(FunctionKind::Tent([edge[0].min(edge[1]), edge[0].max(edge[1])]));
    assert!(jump(&built, tent, ends) > 0.1);
    let middle = [(ends[0][0] + ends[1][0]) / 2.0 + 1e-12, (ends[0][1] + ends[1][1]) / 2.0];
    assert!((built.value(tent, middle) - 0.5).abs() < 1e-6, "the tent of an edge is 2 (1/2)^2 there");
    assert!((built.sum(middle) - 1.0).abs() < 1e-9);
}

/// Whether two open segments cross, in exact integers.
fn do_cross([a, b]: [[i128; 2]; 2], [c, d]: [[i128; 2]; 2]) -> bool {
    let side = |p: [i128; 2], q: [i128; 2], r: [i128; 2]| {
        ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).signum()
    };
    side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0
}

#[test]
fn random_segments_are_edges_or_cross() {
    let (mut fine, mut crossed, mut through) = (0, 0, 0);
    for seed in 0..120 {
        let mut random = Random::new(seed);
        // Small grids have collinear knots; copies are among them, too.
        let side = if seed % 2 == 0 { 5 } else { 200 };
        let integers: Vec<[i64; 2]> =
            (0..25).map(|_| [random.integer(0, side), random.integer(0, side)]).collect();
        let points: Vec<[f64; 2]> = integers.iter().map(|p| p.map(|c| c as f64)).collect();
        let all = knots(&points);
        let segments: Vec<[u32; 2]> =
            (0..3).map(|_| [random.integer(0, 24) as u32, random.integer(0, 24) as u32]).collect();
        if segments.iter().any(|s| points[s[0] as usize] == points[s[1] as usize]) {
            continue;
        }
        let ends = |s: [u32; 2]| s.map(|v| integers[v as usize].map(i128::from));
        let crosses = (0..3).any(|i| (0..i).any(|j| do_cross(ends(segments[i]), ends(segments[j]))));
        let features =
            Features { lines: segments.iter().map(|s| s.to_vec()).collect(), ..Features::default() };
        match special::features(&all, &features) {
            Ok(special) => {
                assert!(!crosses, "seed {seed}");
                assert_edges(&special, &segments);
                special.generate(&Rule::Random(seed), 3).expect("simple links");
                fine += 1;
            }
            Err(error) => {
                let error = error.to_string();
                assert!(error.starts_with("linear element "), "{error}");
                let is_through = error.contains("is on it");
                assert!(is_through || (crosses && error.contains("crosses the one")), "seed {seed}: {error}");
                (crossed, through) = (crossed + u32::from(!is_through), through + u32::from(is_through));
            }
        }
    }
    assert!(fine > 20 && crossed > 10 && through > 10, "{fine} {crossed} {through}");
}

/// Asserts that the segments are edges of a triangulation. `of_triangles` checks that it covers the hull and
/// has all knots.
fn assert_edges(special: &Special, segments: &[[u32; 2]]) {
    let start = special.start.configurations();
    let triangles: Vec<[u32; 3]> = start.iter().map(|(triangle, _)| triangle).collect();
    configurations::Start::of_triangles(&special.knots, &triangles).expect("a triangulation");
    for ends in segments.iter().map(|s| s.map(|v| special.knots.at(v))) {
        let has = |t: &[u32; 3]| ends.iter().all(|end| t.iter().any(|&v| special.knots.at(v) == *end));
        assert!(triangles.iter().any(has), "{ends:?}");
    }
}

#[test]
fn constrained_triangulations_are_delaunay_elsewhere() {
    let points = scattered(11, 50);
    let features =
        Features { creases: vec![Crease { knots: vec![4, 5], has_sharp_ends: true }], ..Features::default() };
    let special = special::features(&knots(&points), &features).expect("one segment");
    let start = special.start.configurations();
    let plain = Knots::new(special.knots.points().to_vec()).expect("knots");
    let delaunay = configurations::delaunay(&plain).expect("triangles");
    let is_old = |triangle: &[u32; 3]| delaunay.iter().any(|(other, _)| other == *triangle);
    let new: Vec<[u32; 3]> = start.iter().map(|(triangle, _)| triangle).filter(|t| !is_old(t)).collect();
    // Fewer than half of the triangles are new, and no triangle crosses the segment.
    let (p, q) = (points[4], points[5]);
    let sides = |t: &[u32; 3]| t.map(|v| area(p, q, special.knots.at(v)));
    assert!(!new.is_empty() && new.len() < start.len() / 2, "{} of {}", new.len(), start.len());
    assert!(start.iter().all(|(t, _)| {
        let [lo, hi] = [sides(&t).into_iter().fold(0.0, f64::min), sides(&t).into_iter().fold(0.0, f64::max)];
        lo >= 0.0 || hi <= 0.0 || !meets_inside(&special, &t, [p, q])
    }));
}

/// Whether sampled points of the segment are inside the triangle.
fn meets_inside(special: &Special, triangle: &[u32; 3], [p, q]: [[f64; 2]; 2]) -> bool {
    let [a, b, c] = triangle.map(|v| special.knots.at(v));
    (1..400).any(|i| {
        let t = f64::from(i) / 400.0;
        let x = [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])];
        [area(x, b, c), area(a, x, c), area(a, b, x)].iter().all(|&part| part > 1e-12)
    })
}

#[test]
fn bad_features_are_errors() {
    let square = knots(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.0, 2.0], [3.0, 2.0], [2.0, 2.0]]);
    let refused = |features: Features| special::features(&square, &features).expect_err("bad").to_string();
    let crease = |knots: &[u32], has_sharp_ends| Crease { knots: knots.to_vec(), has_sharp_ends };
    let creases = |creases: Vec<Crease>| Features { creases, ..Features::default() };
    assert_eq!(
        refused(Features { corners: vec![3, 70], ..Features::default() }),
        "corners: unknown knot 70: there are 7"
    );
    assert_eq!(refused(creases(vec![crease(&[0, 9], true)])), "crease 0: unknown knot 9: there are 7");
    assert_eq!(
        refused(creases(vec![crease(&[0, 2], true)])),
        "crease 0: segment from knot 0 to knot 2: knot 6 is on it: name it, too, between the two"
    );
    let crossing = refused(creases(vec![crease(&[0, 5], false), crease(&[1, 4], false)]));
    assert!(
        crossing
            .starts_with("crease 1: segment from knot 1 to knot 4: it crosses the one from knot 0 to knot 5"),
        "{crossing}"
    );
    let lines = |line: &[u32]| Features { lines: vec![line.to_vec()], ..Features::default() };
    assert!(refused(lines(&[5])).starts_with("linear element 0: 1 knots"));
    assert!(refused(lines(&[5, 5])).contains("no length"));
    assert!(refused(creases(vec![crease(&[0, 1], false)])).contains("on the border"));
    let mixed = Features { corners: vec![6], creases: vec![crease(&[4, 6], false)], ..Features::default() };
    assert!(refused(mixed).contains("crease 0: segment from knot 4 to knot 6: knot 6 is pulled apart"));
    let few = knots(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]);
    assert!(special::features(&few, &Features::default()).is_err());
}
