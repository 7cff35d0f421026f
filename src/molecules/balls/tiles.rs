//! Cuts balls into tiles that fit into little memory, each with the balls around it, and holds the contacts
//! that they give.

use super::{Balls, Contact};
use spmesh_stream::model::bounds::Bounds;

/// Greatest number of balls of a tile, without those around it. Larger tiles have fewer of these, but need
/// more memory.
pub(super) const TILE_MAX: usize = 6_000;

/// The balls of a tile, as indices of all balls.
#[derive(Debug, Default)]
pub(super) struct Members {
    /// Those of the tile.
    pub(super) core: Vec<u32>,
    /// Others that reach the box of these.
    pub(super) around: Vec<u32>,
}

impl Members {
    pub(super) fn all(balls: Balls<'_>) -> Members {
        Members::first(balls, balls.centres.len())
    }

    /// A tile of the first balls, and the others around it.
    fn first(balls: Balls<'_>, count: usize) -> Members {
        let all = balls.centres.len() as u32;
        Members { core: (0..count as u32).collect(), around: (count as u32..all).collect() }
    }
}

/// As [`cut_first`], all balls.
pub(super) fn cut(balls: Balls<'_>, most: usize) -> Vec<Members> {
    cut_first(balls, balls.centres.len(), most)
}

/// Halves the first `count` balls at the median, along the longest side of their box, until tiles have at
/// most `most`. Tiles depend on the balls only.
pub(super) fn cut_first(balls: Balls<'_>, count: usize, most: usize) -> Vec<Members> {
    let mut tiles = Vec::new();
    let mut open = vec![Members::first(balls, count)];
    while let Some(members) = open.pop() {
        if members.core.is_empty() {
            continue;
        }
        if members.core.len() <= most {
            tiles.push(members);
        } else {
            open.extend(halve(balls, members));
        }
    }
    tiles
}

fn halve(balls: Balls<'_>, members: Members) -> [Members; 2] {
    let Members { mut core, around } = members;
    let axis = longest_axis(&bounds(balls, &core));
    let key = |&ball: &u32| (balls.centres[ball as usize][axis], ball);
    let middle = core.len() / 2;
    core.select_nth_unstable_by(middle, |p, q| {
        let ((x, i), (y, j)) = (key(p), key(q));
        x.total_cmp(&y).then(i.cmp(&j))
    });
    let mut upper = core.split_off(middle);
    // The order of the input is that of the contacts.
    core.sort_unstable();
    upper.sort_unstable();
    let reaching = |half: &[u32], other: &[u32]| -> Vec<u32> {
        let bounds = bounds(balls, half);
        other.iter().chain(&around).copied().filter(|&ball| is_reached(&bounds, balls, ball)).collect()
    };
    let (around_lower, around_upper) = (reaching(&core, &upper), reaching(&upper, &core));
    [Members { core, around: around_lower }, Members { core: upper, around: around_upper }]
}

/// The box of some balls, at least one.
fn bounds(balls: Balls<'_>, members: &[u32]) -> Bounds {
    let ball = |&ball: &u32| {
        let (centre, radius) = (balls.centres[ball as usize], balls.radii[ball as usize]);
        Bounds { min: centre.map(|c| c - radius), max: centre.map(|c| c + radius) }
    };
    members.iter().map(ball).reduce(Bounds::union).expect("a tile has balls")
}

fn longest_axis(bounds: &Bounds) -> usize {
    let side = |axis: usize| bounds.max[axis] - bounds.min[axis];
    (1..3).fold(0, |longest, axis| if side(axis) > side(longest) { axis } else { longest })
}

fn is_reached(bounds: &Bounds, balls: Balls<'_>, ball: u32) -> bool {
    let (centre, radius) = (balls.centres[ball as usize], balls.radii[ball as usize]);
    // Rounding must not lose a ball that touches; 1e-9 is far more, and costs nothing.
    let reach = radius * (1.0 + 1e-9);
    (0..3).all(|axis| centre[axis] + reach >= bounds.min[axis] && centre[axis] - reach <= bounds.max[axis])
}

/// Contacts in the order of their balls, kept by tile: merging the lists would double the memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contacts {
    /// Those of each tile, in the order of their balls.
    parts: Vec<Vec<Contact>>,
    /// For each ball the part with the contacts in which it is the lesser ball; empty if there is one part.
    part_of: Vec<u32>,
}

impl Contacts {
    /// The contacts of tiles, in any order within a tile.
    pub(super) fn of_tiles(balls: usize, tiles: &[Members], mut parts: Vec<Vec<Contact>>) -> Contacts {
        for part in &mut parts {
            part.sort_unstable_by_key(|contact| contact.balls);
        }
        let mut part_of = Vec::new();
        if tiles.len() > 1 {
            part_of = vec![0; balls];
            for (number, tile) in (0..).zip(tiles) {
                tile.core.iter().for_each(|&ball| part_of[ball as usize] = number);
            }
        }
        Contacts { parts, part_of }
    }

    /// All contacts.
    pub fn iter(&self) -> impl Iterator<Item = &Contact> {
        let mut rest: Vec<&[Contact]> = self.parts.iter().map(Vec::as_slice).collect();
        // With one part, one step takes all of it.
        let whole = (self.part_of.is_empty() && !rest.is_empty()).then_some((u32::MAX, 0));
        let by_ball = (0..).zip(self.part_of.iter().map(|&part| part as usize));
        whole.into_iter().chain(by_ball).flat_map(move |(ball, part)| {
            let end =
                rest[part].iter().position(|contact| contact.balls[0] > ball).unwrap_or(rest[part].len());
            let (taken, left) = rest[part].split_at(end);
            rest[part] = left;
            taken
        })
    }

    /// Number of contacts.
    pub fn len(&self) -> usize {
        self.parts.iter().map(Vec::len).sum()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
