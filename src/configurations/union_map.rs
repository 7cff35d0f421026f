//! The union map, which turns configurations into faces of k-set polytopes, and its inverse (thesis,
//! equations 7.3 and 7.4).

/// All unions of I with `count` knots of B, each sorted, in lexicographic order.
///
/// Domain: disjoint sets; `count` from 1 to one less than the size of `boundary`, otherwise there are no
/// unions. (In the thesis the bound in equation 7.3 is one less than in theorem 7.1.2, which is right.)
pub fn union_map(boundary: &[u32], interior: &[u32], count: usize) -> Vec<Vec<u32>> {
    if count == 0 || count >= boundary.len() {
        return Vec::new();
    }
    let mut sets = Vec::new();
    choose(boundary, count, interior.to_vec(), &mut sets);
    sets.iter_mut().for_each(|set| set.sort_unstable());
    sets.sort_unstable();
    sets
}

/// Adds to `sets` all unions of `with` and `count` of `from`.
fn choose(from: &[u32], count: usize, with: Vec<u32>, sets: &mut Vec<Vec<u32>>) {
    if count == 0 {
        sets.push(with);
        return;
    }
    for (place, &knot) in from.iter().enumerate().take((from.len() + 1).saturating_sub(count)) {
        choose(&from[place + 1..], count - 1, [&with[..], &[knot]].concat(), sets);
    }
}

/// A configuration and the number of boundary knots that are taken at a time; sets are sorted.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnionSource {
    /// The boundary set B.
    pub boundary: Vec<u32>,
    /// The interior set I.
    pub interior: Vec<u32>,
    /// The number of knots of B in each set.
    pub count: usize,
}

/// The preimage of `sets` under the union map; `None` if there is none.
///
/// I is the intersection of the sets, and B is their union without I.
pub fn inverse_union_map(sets: &[Vec<u32>]) -> Option<UnionSource> {
    let first = sets.first()?;
    let interior: Vec<u32> =
        first.iter().copied().filter(|v| sets.iter().all(|set| set.contains(v))).collect();
    let mut boundary: Vec<u32> = sets.iter().flatten().copied().filter(|v| !interior.contains(v)).collect();
    boundary.sort_unstable();
    boundary.dedup();
    let mut source = UnionSource { count: first.len() - interior.len(), boundary, interior };
    source.interior.sort_unstable();
    let mut given: Vec<Vec<u32>> = sets.to_vec();
    given.iter_mut().for_each(|set| set.sort_unstable());
    given.sort_unstable();
    // If the number of unions differs, the sets are not an image. Compare numbers before computing all
    // unions.
    let expected = binomial(source.boundary.len(), source.count)?;
    let is_image =
        expected == given.len() && union_map(&source.boundary, &source.interior, source.count) == given;
    is_image.then_some(source)
}

fn binomial(n: usize, k: usize) -> Option<usize> {
    (0..k).try_fold(1usize, |product, i| Some(product.checked_mul(n.checked_sub(i)?)? / (i + 1)))
}
