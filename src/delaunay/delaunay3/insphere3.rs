//! In-sphere tests of three tetrahedra at once, one in each lane of a vector.

use super::lanes::Lanes;
use super::locate::Site;
use super::tetrahedralization::Vertex;
use super::weights::Weights;
use crate::predicates::{INSPHERE_SQUARED_BOUND, POWER_SQUARED_BOUND, TINY};
use bytemuck::cast_ref;

/// What the tests of one insertion have in common.
#[derive(Debug)]
pub(super) struct Frame<'w, L: Lanes, W> {
    /// The new point.
    pub(super) origin: Site,
    pub(super) weights: &'w W,
    /// The vertex at infinity: its row is the direction upwards, which makes the test of an infinite
    /// tetrahedron the sign of a volume. The bound of the filter holds all the more.
    pub(super) infinite: u32,
    /// Its lift: of about the size of others, for the sake of the filter; integer if coordinates are.
    pub(super) infinite_lift: f64,
    pub(super) token: L::Token,
}

/// What the filter says of three tetrahedra, a bit for each.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Signs {
    /// Those in conflict with the new point.
    pub(super) inside: u32,
    /// Those that are not. The others are not known.
    pub(super) outside: u32,
}

impl<L: Lanes, W: Weights> Frame<'_, L, W> {
    /// A vertex relative to the new point, and its lift.
    #[inline(always)]
    pub(super) fn row(&self, number: u32, vertex: &Vertex) -> [f64; 4] {
        if number == self.infinite {
            return [0.0, 0.0, 0.0, self.infinite_lift];
        }
        let ([x, y, z], [p, q, r]) = (vertex.at, self.origin.at);
        let (x, y, z) = (x - p, y - q, z - r);
        let mut lift = x * x + y * y + z * z;
        if !W::ARE_EQUAL {
            lift -= self.weights.of(number) - self.origin.weight;
        }
        [x, y, z, lift]
    }

    /// The rows of three vertices, column by column.
    #[inline(always)]
    pub(super) fn columns(&self, numbers: [u32; 3], [u, v, w]: [&Vertex; 3]) -> [L; 4] {
        let [k, l, m] = numbers;
        let [x, y, z, _] = L::columns(self.token, [cast_ref(u), cast_ref(v), cast_ref(w)]);
        let [p, q, r] = self.origin.at;
        let (x, y, z) = (x - self.splat(p), y - self.splat(q), z - self.splat(r));
        let mut lift = dot([x, y, z], [x, y, z]);
        if !W::ARE_EQUAL {
            let weights = [self.weights.of(k), self.weights.of(l), self.weights.of(m), 0.0];
            lift = lift - (L::new(self.token, weights) - self.splat(self.origin.weight));
        }
        let columns = [x, y, z, lift];
        if k == self.infinite || l == self.infinite || m == self.infinite {
            return self.with_infinite(numbers, columns);
        }
        columns
    }

    #[inline(always)]
    fn with_infinite(&self, numbers: [u32; 3], columns: [L; 4]) -> [L; 4] {
        let [x, y, z, lift] = columns;
        let mut columns = [x.array(), y.array(), z.array(), lift.array()];
        for i in 0..3 {
            if numbers[i] == self.infinite {
                (columns[0][i], columns[1][i], columns[2][i]) = (0.0, 0.0, 0.0);
                columns[3][i] = self.infinite_lift;
            }
        }
        let [x, y, z, lift] = columns;
        let token = self.token;
        [L::new(token, x), L::new(token, y), L::new(token, z), L::new(token, lift)]
    }

    /// The tests of the three tetrahedra beyond the facets dbc, adc, abd of a tetrahedron, in this order,
    /// given the rows of its corners, and in columns those of the vertices e opposite to the facets.
    ///
    /// In the lane of a facet without p, which is a, b or c, let n and m be the next two corners. With the
    /// new point as origin, the determinant of the rows (x, lift) of d, n, m and e has the sign wanted:
    ///
    /// e . (d x (m' n - n' m) + d' n x m) - e' d . (n x m), where ' is the lift.
    #[inline(always)]
    pub(super) fn signs(&self, [a, b, c]: [&[f64; 4]; 3], d: &[f64; 4], e: [L; 4]) -> Signs {
        let [ex, ey, ez, e_lift] = e;
        let [px, py, pz, lift] = L::columns(self.token, [a, b, c]);
        let (n, m) = ([px.next(), py.next(), pz.next()], [px.previous(), py.previous(), pz.previous()]);
        let (n_lift, m_lift) = (lift.next(), lift.previous());
        let (d, d_lift) = ([self.splat(d[0]), self.splat(d[1]), self.splat(d[2])], self.splat(d[3]));
        let nm = cross(n, m);
        let [wx, wy, wz] = cross(
            d,
            [
                m_lift.times_minus(n[0], n_lift * m[0]),
                m_lift.times_minus(n[1], n_lift * m[1]),
                m_lift.times_minus(n[2], n_lift * m[2]),
            ],
        );
        let w = [d_lift.times_plus(nm[0], wx), d_lift.times_plus(nm[1], wy), d_lift.times_plus(nm[2], wz)];
        let value = dot([ex, ey, ez], w) - e_lift * dot(d, nm);
        let greatest = n_lift.greater(m_lift).greater(d_lift.greater(e_lift));
        let [inside, outside] = value.signs(self.bound(greatest));
        Signs { inside, outside }
    }

    /// Above which the square of a value is certain, given the greatest lift.
    #[inline(always)]
    fn bound(&self, mut greatest: L) -> L {
        // Squares are greater than lifts by the spread of weights at most, and lifts are above its negative.
        if !W::ARE_EQUAL {
            greatest = greatest + self.splat(2.0 * self.weights.spread());
        }
        let square = greatest * greatest;
        let bound = if W::ARE_EQUAL { INSPHERE_SQUARED_BOUND } else { POWER_SQUARED_BOUND };
        (square * square * greatest).times_plus(self.splat(bound), self.splat(TINY))
    }

    #[inline(always)]
    fn splat(&self, value: f64) -> L {
        L::splat(self.token, value)
    }
}

// Closures and `map` would not be inlined into functions for one kind of processor.

#[inline(always)]
fn cross<L: Lanes>(p: [L; 3], q: [L; 3]) -> [L; 3] {
    [
        p[1].times_minus(q[2], p[2] * q[1]),
        p[2].times_minus(q[0], p[0] * q[2]),
        p[0].times_minus(q[1], p[1] * q[0]),
    ]
}

#[inline(always)]
fn dot<L: Lanes>(p: [L; 3], q: [L; 3]) -> L {
    p[0].times_plus(q[0], p[1].times_plus(q[1], p[2] * q[2]))
}
