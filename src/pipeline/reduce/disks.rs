//! Whether a circumscribing disk lies in a box: the common case, decided without a division.

use spmesh_base::wide::{Loop, run_wide};
use spmesh_delaunay::predicates::circle::CircleBounds;
use spmesh_stream::model::bounds::Region;

/// Assumed error of the doubled area and of the numerators, relative to the sums of the magnitudes of their
/// terms: more than a hundred million times the true bound.
const ERROR: f64 = 1.0 / (1u64 << 20) as f64;

/// Distances to sides are shortened by this fraction of the coordinates, which covers all rounding of sides.
const SHORTENED: f64 = 1.0 / (1u64 << 45) as f64;

/// Smaller magnitudes go to the full test, because underflow could matter. The limit of [`CircleBounds`] is
/// far smaller.
const SMALLEST: f64 = 1e-100;

/// Triangles that are tested together.
const LANES: usize = 32;

/// The corners of so many triangles, by corner and axis.
type Lanes = [[[f64; LANES]; 2]; 3];

/// Decides whether disks certainly lie in a region, exactly as [`CircleBounds::disk_inside`] does.
#[derive(Debug, Clone, Copy)]
pub(super) struct Disks {
    bounds: CircleBounds,
    region: Region,
}

impl Disks {
    pub(super) fn new(bounds: CircleBounds, region: Region) -> Self {
        Disks { bounds, region }
    }

    /// [`CircleBounds::disk_inside`] for the region.
    #[inline]
    pub(super) fn inside(&self, a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> bool {
        self.is_far_inside(a, b, c) || self.bounds.disk_inside(a, b, c, self.region.sides())
    }

    /// Keeps those of the `kept` triangles whose disk certainly lies in the region, as by [`Disks::inside`].
    /// The corners of a triangle are the numbers of points in `at`.
    pub(super) fn keep_inside(
        &self,
        corners: impl ExactSizeIterator<Item = [u32; 3]>,
        at: &[[f64; 2]],
        kept: &mut [bool],
    ) {
        let mut lanes = [[[0.0; LANES]; 2]; 3];
        let mut corners = corners.map(|corners| corners.map(|v| at[v as usize]));
        for kept in kept.chunks_mut(LANES) {
            // The last lanes may be left over from triangles before; they do not matter.
            for (lane, triangle) in corners.by_ref().take(kept.len()).enumerate() {
                for (lanes, point) in lanes.iter_mut().zip(triangle) {
                    (lanes[0][lane], lanes[1][lane]) = (point[0], point[1]);
                }
            }
            let are_far_inside = run_wide(FarInside { disks: self, triangles: &lanes });
            for (lane, kept) in kept.iter_mut().enumerate() {
                let [a, b, c] = [0, 1, 2].map(|corner| [lanes[corner][0][lane], lanes[corner][1][lane]]);
                *kept =
                    *kept && (are_far_inside[lane] || self.bounds.disk_inside(a, b, c, self.region.sides()));
            }
        }
    }

    /// Whether twice the radius is certainly less than the distance from `a` to each side. The disk is then
    /// inside, and by such a margin that the full test agrees.
    ///
    /// The circle's centre is `m / 2 d` relative to `a`, with `d` the doubled area: the test is `|m| <
    /// distance |d|`, squared. The error terms, `E` times the sums of magnitudes `n`, are at least 2^28 times
    /// the error terms of the full test. So `|d| > E n_d` leaves `d` a relative error below 2^-28, and `|m| +
    /// E n` exceeds the sum in the full test of `m`, its error, and the errors of the quotient. The factor at
    /// the end covers the rest.
    #[inline(always)]
    fn is_far_inside(&self, a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> bool {
        let (bx, by) = (b[0] - a[0], b[1] - a[1]);
        let (cx, cy) = (c[0] - a[0], c[1] - a[1]);
        let (p, q) = (bx * bx + by * by, cx * cx + cy * cy);
        let certain = |l: f64, r: f64| ((l - r).abs(), l.abs() + r.abs());
        let (d, n_d) = certain(bx * cy, by * cx);
        let (m_x, n_x) = certain(cy * p, by * q);
        let (m_y, n_y) = certain(bx * q, cx * p);
        let (d, m_x, m_y) = (d - ERROR * n_d, m_x + ERROR * n_x, m_y + ERROR * n_y);
        let Region { min, max } = self.region;
        let to_x = least(a[0] - min[0], max[0] - a[0]);
        let to_y = least(a[1] - min[1], max[1] - a[1]);
        let distance = least(to_x, to_y) - SHORTENED * (a[0].abs() + a[1].abs());
        let reach = distance * d;
        let smallest = least(least(n_x, n_y), least(p, q));
        // Any NaN makes this false.
        (d > SMALLEST)
            & (distance > 0.0)
            & (smallest > SMALLEST)
            & (m_x * m_x + m_y * m_y < reach * reach * (1.0 - ERROR))
    }
}

/// [`Disks::is_far_inside`] for many triangles.
struct FarInside<'a> {
    disks: &'a Disks,
    triangles: &'a Lanes,
}

impl Loop for FarInside<'_> {
    type Output = [bool; LANES];

    #[inline(always)]
    fn run(self) -> [bool; LANES] {
        let [a, b, c] = self.triangles;
        let mut are_far_inside = [false; LANES];
        for (lane, is_far_inside) in are_far_inside.iter_mut().enumerate() {
            let corner = |corner: &[[f64; LANES]; 2]| [corner[0][lane], corner[1][lane]];
            *is_far_inside = self.disks.is_far_inside(corner(a), corner(b), corner(c));
        }
        are_far_inside
    }
}

/// The lesser of two numbers: one instruction, unlike `f64::min`, which has a rule for NaN.
#[inline(always)]
fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear congruential generator, enough to pick triangles.
    struct Random(u64);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }

        fn point(&mut self, about: [f64; 2], spread: f64) -> [f64; 2] {
            about.map(|x| x + spread * (self.unit() - 0.5))
        }
    }

    #[test]
    fn says_yes_only_where_the_full_test_does() {
        let mut random = Random(7);
        let (mut quick, mut full) = (0, 0);
        for round in 0..400_000 {
            let scale = 10f64.powi([0, 0, 3, -3, 8, -30, 60, -60][round % 8]);
            let offset = if round % 3 == 0 { 1e7 * scale } else { 0.0 };
            let low = [offset + scale * random.unit(), offset + scale * random.unit()];
            let mut region = Region { min: low, max: [low[0] + scale, low[1] + scale] };
            if round % 5 == 0 {
                region.max[0] = f64::INFINITY;
            }
            let a = random.point([low[0] + scale / 2.0, low[1] + scale / 2.0], scale);
            let spread = scale * 10f64.powi(-(round as i32 % 9));
            let b = random.point(a, spread);
            let mut c = random.point(a, spread);
            if round % 4 == 0 {
                // Almost on a line with the other two.
                let t = 3.0 * random.unit();
                c = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]) + spread * 1e-9 * random.unit()];
            }
            for bounds in [CircleBounds::FLOAT, CircleBounds::INTEGER] {
                let disks = Disks::new(bounds, region);
                let expected = bounds.disk_inside(a, b, c, region.sides());
                assert_eq!(disks.inside(a, b, c), expected);
                let far = disks.is_far_inside(a, b, c);
                assert!(!far || expected, "{a:?} {b:?} {c:?} in {region:?}");
                quick += u32::from(far);
                full += u32::from(expected);
            }
        }
        assert!(quick > full / 2, "the quick test decides {quick} of {full}");
    }

    #[test]
    fn many_triangles_at_once_get_the_answers_of_one_by_one() {
        let mut random = Random(11);
        let region = Region { min: [0.0; 2], max: [1.0; 2] };
        for bounds in [CircleBounds::FLOAT, CircleBounds::INTEGER] {
            let disks = Disks::new(bounds, region);
            for count in [0, 1, LANES - 1, LANES, LANES + 1, 5 * LANES + 7] {
                let at: Vec<[f64; 2]> = (0..3 * count).map(|_| random.point([0.5; 2], 1.1)).collect();
                let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
                let mut kept: Vec<bool> = (0..count).map(|_| random.unit() < 0.7).collect();
                let expected: Vec<bool> = kept
                    .iter()
                    .zip(triangles.clone())
                    .map(|(&kept, triangle)| {
                        let [a, b, c] = triangle.map(|v| at[v as usize]);
                        kept && disks.inside(a, b, c)
                    })
                    .collect();
                disks.keep_inside(triangles, &at, &mut kept);
                assert_eq!(kept, expected, "{count} triangles");
                assert!(count < 100 || (expected.contains(&true) && expected.contains(&false)));
            }
        }
    }

    #[test]
    fn extremes_are_left_to_the_full_test() {
        let plane = Disks::new(CircleBounds::FLOAT, Region::PLANE);
        assert!(plane.is_far_inside([0.0; 2], [1.0, 0.0], [0.0, 1.0]));
        for size in [0.0, 1e-120, 1e-200, 1e160, 1e300, f64::MAX] {
            assert!(!plane.is_far_inside([0.0; 2], [size, 0.0], [0.0, size]), "{size}");
        }
        assert!(!plane.is_far_inside([0.0; 2], [1.0, 1.0], [2.0, 2.0]));
    }
}
