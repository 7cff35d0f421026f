//! The audit of configurations of repeated knots, against the configurations that a brute-force reference
//! finds.

use std::collections::BTreeMap;

use spmesh_audit::configurations::{ConfigurationSet, Configurations, Knots, Proof, Violation, check};
use spmesh_configurations::{Claim, FARAWAY};

use spmesh_reference::configurations::{by_definition, lines};
use spmesh_reference::sets::Random;

const DEGREE_MAX: usize = 2;

type Boundaries = BTreeMap<Vec<u32>, Vec<[u32; 3]>>;

/// Configurations by degree and interior set, infinite ones included.
fn reference(points: &[[f64; 2]]) -> Vec<Boundaries> {
    let finite = by_definition(points, DEGREE_MAX);
    let degrees = finite.into_iter().enumerate().map(|(degree, finite)| {
        let infinite = lines(points, degree).into_iter().map(|([p, q], left)| ([p, q, FARAWAY], left));
        let mut groups = Boundaries::new();
        for (boundary, interior) in finite.into_iter().chain(infinite) {
            groups.entry(interior).or_default().push(boundary);
        }
        groups
    });
    degrees.collect()
}

fn verdict(points: &[[f64; 2]], degrees: &[Boundaries], claim: Claim) -> Result<Proof, Violation> {
    let hold = |(degree, groups): (usize, &Boundaries)| {
        let mut held = Configurations::new(degree, claim);
        groups.iter().for_each(|(interior, boundaries)| held.extend(interior, boundaries).unwrap());
        held
    };
    let degrees = degrees.iter().enumerate().map(hold).collect();
    check(&ConfigurationSet {
        knots: Knots::new(points.to_vec()).unwrap(),
        degrees,
        ..ConfigurationSet::default()
    })
}

/// Knots on a grid of 4 by 4 places, several of them at one place. Zeros have either sign.
fn repeated(random: &mut Random) -> Vec<[f64; 2]> {
    let count = random.integer(3, 9);
    let mut points: Vec<[f64; 2]> =
        (0..count).map(|_| [0, 1].map(|_| random.integer(-1, 2) as f64)).collect();
    points.extend([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-0.0, 0.0]]);
    for i in (1..points.len()).rev() {
        points.swap(i, random.integer(0, i as i64) as usize);
    }
    points
}

/// The configurations after two knots have exchanged their ids.
fn exchanged(degrees: &[Boundaries], [a, b]: [u32; 2]) -> Vec<Boundaries> {
    let id = |id: u32| {
        if id == a {
            b
        } else if id == b {
            a
        } else {
            id
        }
    };
    let boundary = |ids: &[u32; 3]| {
        let mut ids = ids.map(id);
        if !ids.contains(&FARAWAY) {
            let least = (0..3).min_by_key(|&i| ids[i]).unwrap();
            ids.rotate_left(least);
        }
        ids
    };
    let group = |(interior, boundaries): (&Vec<u32>, &Vec<[u32; 3]>)| {
        let mut interior: Vec<u32> = interior.iter().map(|&knot| id(knot)).collect();
        interior.sort_unstable();
        let mut boundaries: Vec<[u32; 3]> = boundaries.iter().map(boundary).collect();
        boundaries.sort_unstable();
        (interior, boundaries)
    };
    degrees.iter().map(|groups| groups.iter().map(group).collect()).collect()
}

fn sorted(degrees: &[Boundaries]) -> Vec<Boundaries> {
    exchanged(degrees, [0, 0])
}

/// Pairs of knots at one place.
fn copies(points: &[[f64; 2]]) -> Vec<[u32; 2]> {
    let count = points.len();
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| [a, b]));
    pairs.filter(|&[a, b]| points[a] == points[b]).map(|pair| pair.map(|id| id as u32)).collect()
}

#[test]
fn configurations_by_definition_pass() {
    for seed in 0..150 {
        let points = repeated(&mut Random::new(seed));
        let proof = verdict(&points, &reference(&points), Claim::Delaunay)
            .unwrap_or_else(|violation| panic!("seed {seed}: {violation:?}"));
        let at_place = |p: &[f64; 2]| points.iter().filter(|q| *q == p).count();
        let first = |id: usize| !points[..id].contains(&points[id]);
        assert_eq!(proof.knots, points.len());
        assert_eq!(proof.places, (0..points.len()).filter(|&id| first(id)).count(), "seed {seed}");
        assert_eq!(proof.multiplicity_max, points.iter().map(at_place).max().unwrap(), "seed {seed}");
        let complete = proof.degrees.iter().all(|d| d.has_circles && d.facets.is_some() && d.is_counted);
        assert!(complete, "seed {seed}: {proof:?}");
    }
}

/// Exchanging the ranks of two copies of a knot gives other configurations, which differ from the right ones
/// in nothing but the ranks.
#[test]
fn configurations_with_other_ranks_are_refused() {
    let mut refused = 0;
    for seed in 0..60 {
        let points = repeated(&mut Random::new(seed));
        let degrees = reference(&points);
        for pair in copies(&points) {
            let other = exchanged(&degrees, pair);
            if other == sorted(&degrees) {
                continue;
            }
            let violation = verdict(&points, &other, Claim::Delaunay).expect_err("the ranks are wrong");
            assert_eq!(violation.claim, "circles", "seed {seed}, {pair:?}: {violation:?}");
            // A boundary with both copies changes its orientation, so a set with such a boundary fails
            // without circles, too.
            refused += usize::from(verdict(&points, &other, Claim::Any).is_err());
        }
    }
    assert!(refused > 50, "without circles, only {refused} were refused");
}
