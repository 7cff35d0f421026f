//! Seeded segments between integer points.

use super::sets::{Random, uniform};

fn turn(p: [i64; 2], q: [i64; 2], r: [i64; 2]) -> i64 {
    ((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])).signum()
}

/// Whether a point lies on a segment.
pub fn is_on([p, q]: [[i64; 2]; 2], x: [i64; 2]) -> bool {
    let dot = (p[0] - x[0]) * (q[0] - x[0]) + (p[1] - x[1]) * (q[1] - x[1]);
    turn(p, q, x) == 0 && dot <= 0
}

/// Whether a point lies in a counterclockwise triangle or on its border.
pub fn is_in(corners: [[i64; 2]; 3], x: [i64; 2]) -> bool {
    (0..3).all(|i| turn(corners[i], corners[(i + 1) % 3], x) >= 0)
}

/// Whether two segments cross or overlap; unless they may touch, also whether one has an end amid the other.
fn collide(s: [[i64; 2]; 2], t: [[i64; 2]; 2], may_touch: bool) -> bool {
    let crosses = turn(s[0], s[1], t[0]) * turn(s[0], s[1], t[1]) < 0
        && turn(t[0], t[1], s[0]) * turn(t[0], t[1], s[1]) < 0;
    let ends = [s[0], s[1], t[0], t[1]];
    let mut shared: Vec<[i64; 2]> = ends.into_iter().filter(|&x| is_on(s, x) && is_on(t, x)).collect();
    shared.sort_unstable();
    shared.dedup();
    let is_amid = |x: &[i64; 2]| !s.contains(x) || !t.contains(x);
    crosses || shared.len() > 1 || (!may_touch && shared.iter().any(is_amid))
}

/// Up to `most` segments between random points, of which no two cross or overlap. If they may touch, one may end amid
/// another.
pub fn random_segments(
    random: &mut Random,
    points: &[[i64; 2]],
    most: usize,
    may_touch: bool,
) -> Vec<[u32; 2]> {
    let mut segments: Vec<[u32; 2]> = Vec::new();
    let at = |ends: [u32; 2]| ends.map(|end| points[end as usize]);
    for _ in 0..4 * most {
        let ends = [0; 2].map(|_| random.integer(0, points.len() as i64 - 1) as u32);
        let collides = segments.iter().any(|&other| collide(at(other), at(ends), may_touch));
        if segments.len() < most && ends[0] != ends[1] && !collides {
            segments.push(ends);
        }
    }
    segments
}

/// Up to `most` polylines of two to six random points, which may touch and overlap, but cross at points only.
pub fn random_polylines(random: &mut Random, points: &[[i64; 2]], most: usize) -> Vec<Vec<[i64; 2]>> {
    let crosses = |s: [[i64; 2]; 2], t: [[i64; 2]; 2]| {
        let divides = |[p, q]: [[i64; 2]; 2], [a, b]: [[i64; 2]; 2]| turn(p, q, a) * turn(p, q, b) < 0;
        divides(s, t) && divides(t, s) && !points.iter().any(|&x| is_on(s, x) && is_on(t, x))
    };
    let mut parts: Vec<[[i64; 2]; 2]> = Vec::new();
    let mut lines: Vec<Vec<[i64; 2]>> = Vec::new();
    for _ in 0..most {
        let mut any = || points[random.integer(0, points.len() as i64 - 1) as usize];
        let mut line = vec![any()];
        for _ in 0..5 {
            let part = [line[line.len() - 1], any()];
            if part[0] != part[1] && !parts.iter().any(|&other| crosses(part, other)) {
                parts.push(part);
                line.push(part[1]);
            }
        }
        lines.extend((line.len() > 1).then_some(line));
    }
    lines
}

/// The corners of a square, then one to nine points in it: all different.
pub fn in_square(random: &mut Random, side: i64) -> Vec<[i64; 2]> {
    let count = random.integer(1, 9) as usize;
    let corners = [[0, 0], [side, 0], [side, side], [0, side]];
    without_copies(corners.into_iter().chain(uniform(random, count, side)))
}

/// Points in their order, each once.
pub fn without_copies(points: impl IntoIterator<Item = [i64; 2]>) -> Vec<[i64; 2]> {
    let mut unique = Vec::new();
    points.into_iter().for_each(|point| {
        if !unique.contains(&point) {
            unique.push(point);
        }
    });
    unique
}
