use spmesh_reference::sets::Random;
use spmesh_reference::space::{Claim, Corner, Point, Space, distinct};
use spmesh_reference::tetrahedra::exact_points;
use spmesh_reference::{clouds, exact3};

#[test]
fn decisions_are_those_of_integers_without_limit() {
    let mut decided = [0; 3];
    for seed in 0..150 {
        let mut random = Random::new(seed);
        let (points, _) = distinct(&clouds::mixture(&mut random, 12));
        let (space, exact) = (Space::new(&points), exact_points(&points));
        for _ in 0..40 {
            let mut five: Vec<usize> = (0..points.len()).collect();
            random.shuffle(&mut five);
            let &[a, b, c, d, e, ..] = five.as_slice() else { break };
            let sign = space.orientation([a, b, c, d]);
            assert_eq!(sign, exact3::orientation([a, b, c, d].map(|i| &exact[i])), "{points:?}");
            decided[(sign + 1) as usize] += 1;
            let (a, b) = if sign < 0 { (b, a) } else { (a, b) };
            let expected = exact3::insphere_perturbed([a, b, c, d, e].map(|i| &exact[i]));
            assert!(sign == 0 || space.insphere([a, b, c, d], e) == expected, "{points:?}");
        }
    }
    assert!(decided.iter().all(|&count| count > 500), "{decided:?}");
}

/// The tetrahedra by definition, with the neighbour's corner across each facet.
fn claims(points: &[Point]) -> Vec<Claim> {
    let tetrahedra = Space::new(points).tetrahedra();
    let facet = |t: usize, side: usize| {
        let mut facet = tetrahedra[t];
        facet[side] = u32::MAX;
        facet.sort_unstable();
        facet
    };
    let corners: Vec<Corner> = (0..tetrahedra.len()).flat_map(|t| (0..4).map(move |i| (t, i))).collect();
    let across = |t, i| {
        let is_other = |&&(u, j): &&Corner| u != t && facet(u, j) == facet(t, i);
        corners.iter().find(is_other).copied()
    };
    (0..tetrahedra.len())
        .map(|t| (tetrahedra[t].map(|v| v as usize), [0, 1, 2, 3].map(|i| across(t, i))))
        .collect()
}

#[test]
fn the_proof_holds_for_the_tetrahedra_by_definition_and_for_no_others() {
    for seed in 0..60 {
        let mut random = Random::new(1000 + seed);
        let (points, _) = distinct(&clouds::mixture(&mut random, 9));
        let (space, claims) = (Space::new(&points), claims(&points));
        assert_eq!(space.prove(&claims), Ok(()), "{points:?}");
        if claims.is_empty() {
            continue;
        }
        assert!(space.prove(&[]).is_err());
        let t = random.integer(0, claims.len() as i64 - 1) as usize;
        let mut inverted = claims.clone();
        inverted[t].0.swap(0, 1);
        inverted[t].1.swap(0, 1);
        assert!(space.prove(&inverted).is_err(), "{points:?}");
        let mut holed: Vec<Claim> = claims.clone();
        for side in 0..4 {
            if let Some((u, back)) = claims[t].1[side] {
                holed[u].1[back] = None;
            }
        }
        holed.remove(t);
        let renumbered = |(u, i): Corner| (u - usize::from(u > t), i);
        holed.iter_mut().for_each(|claim| claim.1 = claim.1.map(|across| across.map(renumbered)));
        assert!(space.prove(&holed).is_err(), "{points:?}");
        let twice: Vec<Claim> = claims
            .iter()
            .copied()
            .chain(
                claims.iter().map(|&(v, across)| (v, across.map(|a| a.map(|(u, i)| (u + claims.len(), i))))),
            )
            .collect();
        assert!(space.prove(&twice).is_err(), "{points:?}");
    }
}

/// Five points in general position have two triangulations; one is Delaunay, and the proof refuses the
/// other.
#[test]
fn the_other_tetrahedra_of_five_points_are_refused() {
    let points = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [1.0, 1.0, 3.0], [1.0, 1.0, -3.0]];
    let two = vec![
        ([0, 1, 2, 3], [None, None, None, Some((1, 3))]),
        ([0, 2, 1, 4], [None, None, None, Some((0, 3))]),
    ];
    let around = |i: usize, j: usize| [i, j, 3, 4];
    let cyclic = |t: usize| [Some(((t + 1) % 3, 1)), Some(((t + 2) % 3, 0)), None, None];
    let three: Vec<Claim> = (0..3)
        .map(|t| (around(t, (t + 1) % 3), cyclic(t)))
        .map(|([i, j, k, l], a)| ([i, j, l, k], a))
        .collect();
    let space = Space::new(&points);
    let results = [space.prove(&two), space.prove(&three)];
    assert_eq!(results.iter().filter(|result| result.is_ok()).count(), 1, "{results:?}");
    let error = results.into_iter().find_map(Result::err).expect("one");
    assert!(error.contains("locally Delaunay"), "{error}");
}
