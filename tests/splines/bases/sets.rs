//! Knots, starts and rules to test, and points to evaluate at.

use spmesh_configurations::{self as configurations, Configurations, Knots, Rule, Start};
use spmesh_reference::sets::Random;
use spmesh_splines::bases::Basis;

/// Knots with the configurations for a basis of some degree.
pub struct Case {
    pub name: String,
    pub knots: Knots,
    pub configurations: Configurations,
    pub basis: Basis,
    /// The map of the unit square: constants and factors of its coordinates.
    shape: [[f64; 3]; 2],
}

const UNIT: [[f64; 3]; 2] = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn mapped(shape: [[f64; 3]; 2], [u, v]: [f64; 2]) -> [f64; 2] {
    shape.map(|[constant, along, across]| constant + along * u + across * v)
}

impl Case {
    /// The basis of a degree.
    pub fn new(name: &str, knots: Knots, start: Configurations, rule: &Rule, degree: usize) -> Case {
        let name = format!("{name}, degree {degree}");
        let made =
            configurations::generate(&knots, start, rule, degree.saturating_sub(1)).and_then(|mut all| {
                let configurations = all.pop().expect("a degree");
                let basis = match degree {
                    0 => Basis::of_triangles(&knots, &configurations)?,
                    _ => Basis::new(&knots, &configurations)?,
                };
                Ok((configurations, basis))
            });
        let (configurations, basis) =
            made.unwrap_or_else(|error| panic!("{name}: {error}: let points = vec!{:?};", knots.points()));
        Case { name, knots, configurations, basis, shape: UNIT }
    }

    /// Points of the domain: anywhere, at knots, on lines through two knots, and on the border of the domain.
    pub fn points(&self, seed: u64, count: usize) -> Vec<[f64; 2]> {
        let mut random = Random::new(seed);
        let all = self.knots.points();
        let mut found = Vec::new();
        for round in 0..20 * count {
            let mut knot = || all[random.integer(0, all.len() as i64 - 1) as usize];
            let (p, q) = (knot(), knot());
            let share = [0.5, 0.25, 0.75, -0.5][round / 5 % 4];
            let x = match round % 5 {
                0 => p,
                1 => [0, 1].map(|axis| p[axis] + share * (q[axis] - p[axis])),
                2 => mapped(self.shape, [random.unit(), [0.0, 1.0][round / 5 % 2]]),
                _ => mapped(self.shape, [random.unit(), random.unit()]),
            };
            if self.basis.is_in_domain(x) {
                found.push(x);
            }
            if found.len() == count {
                break;
            }
        }
        assert!(found.len() > count / 2, "{}: {} points of {count}", self.name, found.len());
        found
    }
}

/// A square with knots on its sides and inside, at multiples of 2^-12, so that midpoints of knots are exact
/// and lie on the line through the two knots.
pub fn square(seed: u64, inside: usize) -> Vec<[f64; 2]> {
    let mut random = Random::new(seed);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let along = [[0.25, 0.0], [0.75, 0.0], [1.0, 0.5], [0.0, 0.625], [0.5, 1.0]];
    let mut coordinate = || random.integer(1, 4095) as f64 / 4096.0;
    let inner = (0..inside).map(|_| [coordinate(), coordinate()]);
    corners.into_iter().chain(along).chain(inner).collect()
}

/// One case of every kind of knots and configurations, for one degree.
pub fn cases(degree: usize) -> Vec<Case> {
    let knots = |points: &[[f64; 2]]| Knots::new(points.to_vec()).expect("finite points");
    let start = |knots: &Knots| Start::delaunay(knots).expect("triangles");
    let clamped = |points: &[[f64; 2]]| knots(points).clamped(degree.saturating_sub(1)).expect("a hull");
    let mut cases = Vec::new();
    let mut add = |name: &str, knots: Knots, start: Start, rule: Rule| {
        cases.push(Case::new(name, knots, start.configurations(), &rule, degree));
    };
    let plain = knots(&square(1, 40));
    add("plain", plain.clone(), start(&plain), Rule::Delaunay);
    let fixed = clamped(&square(2, 40));
    for rule in [Rule::Delaunay, Rule::Random(5), Rule::Fan, Rule::Ear] {
        add(&format!("clamped, {rule:?}"), fixed.clone(), start(&fixed), rule);
    }
    let mut flipped = start(&fixed);
    flipped.flip_random(&fixed, 30, 9);
    add("flipped", fixed.clone(), flipped, Rule::Random(1));
    let mut random = Random::new(3);
    let scattered: Vec<[f64; 2]> = (0..60).map(|_| [random.unit(), random.unit()]).collect();
    let scattered = knots(&scattered);
    add("scattered", scattered.clone(), start(&scattered), Rule::Delaunay);
    let grid: Vec<[f64; 2]> = (0..49).map(|i| [f64::from(i % 7) / 6.0, f64::from(i / 7) / 6.0]).collect();
    let grid = clamped(&grid);
    add("grid", grid.clone(), start(&grid), Rule::Delaunay);
    let mut repeated = square(4, 30);
    let copies: Vec<[f64; 2]> = [12, 12, 15, 20, 21].iter().map(|&at: &usize| repeated[at]).collect();
    repeated.extend(copies);
    let repeated = clamped(&repeated);
    add("repeated", repeated.clone(), start(&repeated), Rule::Delaunay);
    let apart = clamped(&square(5, 25)).pull_apart(&(9..34).collect::<Vec<u32>>()).expect("known knots");
    add("pulled apart", apart.clone(), start(&apart).generalised(), Rule::Delaunay);
    cases
}

/// Knots far from the origin, and in narrow slanted strips, where all triangles are slivers.
pub fn distorted(degree: usize) -> Vec<Case> {
    let shapes = [
        ("far", [[431_250.0, 1.0, 0.0], [4_918_000.5, 0.0, 1.0]]),
        ("narrow", [[0.0, 1.0, 0.0], [0.0, 0.5, 1e-6]]),
        ("very narrow", [[0.0, 1.0, 1e-11], [0.0, 0.7, 0.0]]),
    ];
    let case = |(name, shape): (&str, [[f64; 3]; 2])| {
        let points = square(6, 40).into_iter().map(|point| mapped(shape, point)).collect();
        let knots = Knots::new(points).expect("finite points");
        let start = configurations::delaunay(&knots).expect("triangles");
        Case { shape, ..Case::new(name, knots, start, &Rule::Delaunay, degree) }
    };
    shapes.into_iter().map(case).collect()
}
