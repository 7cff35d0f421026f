//! Tests of points in four dimensions: whether a cell has a sphere, and what a facet separates.

use std::cmp::Ordering;

use super::number::Number;
use super::sites::{Extent, Question};

/// A point relative to another.
type Vector<T> = [T; 4];

/// Whether vertices of a cell lie on one sphere, with a volume, and others outside of it. All are given
/// relative to the first vertex of the cell.
pub(super) struct Sphere {
    /// Number of vectors that are vertices of the cell; the others must be outside.
    pub(super) own: usize,
}

/// Result of [`Sphere`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Roundness {
    /// The cell lies in a hyperplane.
    Flat,
    /// This vertex of the cell is not on the sphere of the others.
    Off(usize),
    /// The cell is round, with the orientation `turn`. `worst` is the other point that is furthest inside,
    /// and `others` says where it lies: `Greater` strictly outside, as all others then are, `Equal` on the
    /// sphere, `Less` inside.
    Round { turn: Ordering, others: Ordering, worst: usize },
}

impl Question for Sphere {
    type Answer = Roundness;

    /// With coordinates of at most m: a minor of two rows has at most 2 m^2, of three 6 m^3, and the volume
    /// 24 m^4; a lift 4 m^2; so a component of the normal of the sphere 4 * 4 m^2 * 6 m^3, and the power of a
    /// point 24 * 4 m^6 + 4 * 96 m^6 = 480 m^6. For m = 840,000 that is 1.69 * 10^38 < 2^127. These are sums
    /// of magnitudes, so no partial sum is larger.
    fn fits(&self, extent: Extent) -> bool {
        extent.first.max(extent.rest) <= 840_000
    }

    fn first(&self) -> usize {
        self.own
    }

    fn answer<T: Number>(&self, vectors: &[Vector<T>]) -> Option<Roundness> {
        let (own, others) = vectors.split_at(self.own);
        let basis = Basis::of(own, 4);
        if basis.rank < 4 {
            return basis.is_certain.then_some(Roundness::Flat);
        }
        let [b, c, d, e] = basis.chosen.map(|i| &own[i]);
        let turn = dot(&normal(b, c, d), e).sign()?;
        let mut answer = Roundness::Round { turn, others: Ordering::Greater, worst: 0 };
        if vectors.len() == 4 {
            return Some(answer);
        }
        let power = Power::of(b, c, d, e);
        let side =
            |p: &Vector<T>| power.at(p).sign().map(|sign| if turn.is_lt() { sign.reverse() } else { sign });
        for (i, p) in own.iter().enumerate().filter(|(i, _)| !basis.chosen.contains(i)) {
            if side(p)? != Ordering::Equal {
                return Some(Roundness::Off(i));
            }
        }
        for (i, p) in others.iter().enumerate() {
            let side = side(p)?;
            match &mut answer {
                Roundness::Round { others, worst, .. } if side < *others => (*others, *worst) = (side, i),
                _ => (),
            }
        }
        Some(answer)
    }
}

/// What the hyperplane of a facet separates. Vectors are relative to the first vertex of the facet, and come
/// in this order: other vertices of the facet; other vertices of its cell; other vertices of the cell beyond
/// it; vertices of neighbouring facets of the boundary; and five points in general position.
pub(super) struct Facet {
    /// Vertices of the facet but the first.
    pub(super) on: usize,
    /// Vertices of the cell that are not on the facet.
    pub(super) near: usize,
    /// Vertices of the cell beyond it.
    pub(super) far: usize,
    /// Vertices of facets around it, which may not be beyond.
    pub(super) around: usize,
}

/// Result of [`Facet`], with numbers of vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Separation {
    /// The facet has no hyperplane.
    Flat,
    /// This vertex of the facet is not in the hyperplane of the others.
    Bent(usize),
    /// This vertex of the cell is not strictly on the side of the others.
    Crossed(usize),
    /// This vertex of the cell beyond the facet is not strictly on the other side.
    SameSide(usize),
    /// This vertex of a facet around is beyond.
    Concave(usize),
    /// All vectors are on their sides. `is_near` tells whether the first of the five points, moved by
    /// infinitesimals towards the others, lies on the side of the cell.
    Good { is_near: bool },
}

impl Question for Facet {
    type Answer = Separation;

    /// Let m bound the vectors in the facet, and n the others. The normal has components of at most 6 m^3,
    /// and its product with another vector is at most 24 m^3 n: for m = 2^20 and n = 2^62 less than 2^127.
    fn fits(&self, extent: Extent) -> bool {
        extent.first <= 1 << 20 && extent.rest <= 1 << 62
    }

    fn first(&self) -> usize {
        self.on
    }

    fn answer<T: Number>(&self, vectors: &[Vector<T>]) -> Option<Separation> {
        let (on, rest) = vectors.split_at(self.on);
        let basis = Basis::of(on, 3);
        if basis.rank < 3 {
            return basis.is_certain.then_some(Separation::Flat);
        }
        let [u, v, w, _] = basis.chosen;
        let normal = normal(&on[u], &on[v], &on[w]);
        let side = |p: &Vector<T>| dot(&normal, p).sign();
        for i in (0..self.on).filter(|i| ![u, v, w].contains(i)) {
            if side(&on[i])? != Ordering::Equal {
                return Some(Separation::Bent(i));
            }
        }
        let (near, rest) = rest.split_at(self.near);
        let inside = near.first().map_or(Some(Ordering::Equal), side)?;
        for (i, p) in near.iter().enumerate() {
            if inside == Ordering::Equal || side(p)? != inside {
                return Some(Separation::Crossed(self.on + i));
            }
        }
        let (far, rest) = rest.split_at(self.far);
        for (i, p) in far.iter().enumerate() {
            if side(p)? != inside.reverse() {
                return Some(Separation::SameSide(self.on + self.near + i));
            }
        }
        let (around, five) = rest.split_at(self.around);
        for (i, p) in around.iter().enumerate() {
            if side(p)? == inside.reverse() {
                return Some(Separation::Concave(self.on + self.near + self.far + i));
            }
        }
        for p in five {
            match side(p)? {
                Ordering::Equal => (),
                sign => return Some(Separation::Good { is_near: sign == inside }),
            }
        }
        Some(Separation::Good { is_near: false })
    }
}

/// Finds points in general position: the first point and four others, or `None` if all points are in a
/// hyperplane. All are given relative to the first.
pub(super) struct Independent;

impl Question for Independent {
    type Answer = Option<[usize; 4]>;

    /// A volume is at most 24 m^4.
    fn fits(&self, extent: Extent) -> bool {
        extent.first.max(extent.rest) <= 1 << 30
    }

    fn first(&self) -> usize {
        0
    }

    fn answer<T: Number>(&self, vectors: &[Vector<T>]) -> Option<Option<[usize; 4]>> {
        let basis = Basis::of(vectors, 4);
        if basis.rank == 4 {
            return Some(Some(basis.chosen));
        }
        basis.is_certain.then_some(None)
    }
}

/// The first vectors that are certainly independent of those before.
struct Basis {
    chosen: [usize; 4],
    rank: usize,
    /// Whether all others are certainly dependent.
    is_certain: bool,
}

impl Basis {
    fn of<T: Number>(vectors: &[Vector<T>], wanted: usize) -> Self {
        let mut basis = Basis { chosen: [usize::MAX; 4], rank: 0, is_certain: true };
        for (i, vector) in vectors.iter().enumerate() {
            if basis.rank == wanted {
                break;
            }
            match basis.is_independent(vectors, vector) {
                Some(true) => {
                    basis.chosen[basis.rank] = i;
                    basis.rank += 1;
                }
                Some(false) => (),
                None => basis.is_certain = false,
            }
        }
        basis
    }

    fn is_independent<T: Number>(&self, vectors: &[Vector<T>], vector: &Vector<T>) -> Option<bool> {
        let chosen = |i: usize| &vectors[self.chosen[i]];
        match self.rank {
            0 => is_any_nonzero(vector),
            1 => is_any_nonzero(&minors(chosen(0), vector)),
            2 => is_any_nonzero(&normal(chosen(0), chosen(1), vector)),
            _ => is_any_nonzero(&[dot(&normal(chosen(0), chosen(1), chosen(2)), vector)]),
        }
    }
}

fn is_any_nonzero<T: Number>(values: &[T]) -> Option<bool> {
    let mut is_certain = true;
    for value in values {
        match value.sign() {
            Some(Ordering::Equal) => (),
            Some(_) => return Some(true),
            None => is_certain = false,
        }
    }
    is_certain.then_some(false)
}

/// The minors of two rows in columns 01, 02, 03, 12, 13, 23.
fn minors<T: Number>(u: &Vector<T>, v: &Vector<T>) -> [T; 6] {
    [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
        .map(|[i, j]: [usize; 2]| u[i].times(&v[j]).minus(&u[j].times(&v[i])))
}

/// The vector whose product with any `x` is det(u, v, w, x).
fn normal<T: Number>(u: &Vector<T>, v: &Vector<T>, w: &Vector<T>) -> Vector<T> {
    let [m01, m02, m03, m12, m13, m23] = minors(u, v);
    [
        w[2].times(&m13).minus(&w[1].times(&m23)).minus(&w[3].times(&m12)),
        w[0].times(&m23).minus(&w[2].times(&m03)).plus(&w[3].times(&m02)),
        w[1].times(&m03).minus(&w[0].times(&m13)).minus(&w[3].times(&m01)),
        w[0].times(&m12).minus(&w[1].times(&m02)).plus(&w[2].times(&m01)),
    ]
}

fn dot<T: Number>(u: &Vector<T>, v: &Vector<T>) -> T {
    let [x, y, z, t] = [0, 1, 2, 3].map(|i| u[i].times(&v[i]));
    x.plus(&y).plus(&z).plus(&t)
}

/// The power of points to the sphere through the origin and four points, times the volume of the five.
struct Power<T> {
    volume: T,
    normal: Vector<T>,
}

impl<T: Number> Power<T> {
    /// `normal * p = volume * |p|^2` holds for the four points, by Cramer's rule.
    fn of(b: &Vector<T>, c: &Vector<T>, d: &Vector<T>, e: &Vector<T>) -> Self {
        let [over_b, over_c, over_d, over_e] = [b, c, d, e].map(|p| dot(p, p));
        let (cde, bde, bce, bcd) = (normal(c, d, e), normal(b, d, e), normal(b, c, e), normal(b, c, d));
        let normal = [0, 1, 2, 3].map(|i| {
            let (from_b, from_c) = (over_b.times(&cde[i]), over_c.times(&bde[i]));
            let (from_d, from_e) = (over_d.times(&bce[i]), over_e.times(&bcd[i]));
            from_c.minus(&from_b).minus(&from_d).plus(&from_e)
        });
        Power { volume: dot(&bcd, e), normal }
    }

    fn at(&self, p: &Vector<T>) -> T {
        self.volume.times(&dot(p, p)).minus(&dot(&self.normal, p))
    }
}
