//! Rivers by two banks: what closes them at their ends, and whether all of this bounds an area.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::areas::Role;
use spmesh_formats::source::{Breakline, Breaklines, Properties};

/// A bank of a river, seen downstream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bank {
    Left,
    Right,
}

impl Bank {
    pub(crate) const BOTH: [Bank; 2] = [Bank::Left, Bank::Right];

    pub(crate) fn name(self) -> &'static str {
        ["left", "right"][self as usize]
    }

    /// The bank that a feature states to be, in any case; no text states nothing.
    pub(crate) fn of(properties: &Properties) -> Result<Option<Bank>, String> {
        let word = properties.bank.as_deref().unwrap_or_default().trim();
        let bank = Bank::BOTH.into_iter().find(|bank| word.eq_ignore_ascii_case(bank.name()));
        if bank.is_none() && !word.is_empty() {
            return Err(format!("the property bank is {word:?}, expected left or right, seen downstream"));
        }
        Ok(bank)
    }
}

/// Adds the lines that close rivers between their banks: from the first vertex of the left bank to that of
/// the right one, and between the last ones. They come behind all files, so the numbers of lines stay.
///
/// A river of `--lines` is closed, too: so `spconstrain` has the same lines as `spfinalize --flatten`. It
/// leaves banks that are not sound as they are, since they may be lines of another meaning.
pub(crate) fn close(files: &mut Vec<(Role, String, Breaklines)>) {
    for (role, closing) in [(Role::Lines, Role::Lines), (Role::Water, Role::Ends)] {
        let mut rivers: BTreeMap<&str, [Vec<&Breakline>; 2]> = BTreeMap::new();
        let of_role = files.iter().filter(|(other, ..)| *other == role);
        for line in of_role.flat_map(|(.., file)| &file.lines).filter(|line| line.polygon.is_none()) {
            if let (Some(river), Ok(Some(bank))) = (&line.properties.river, Bank::of(&line.properties)) {
                rivers.entry(river).or_default()[bank as usize].push(line);
            }
        }
        let lines: Vec<Breakline> = rivers.values().flat_map(|banks| ends(banks)).collect();
        if !lines.is_empty() {
            let name = "ends of rivers".to_string();
            files.push((closing, name, Breaklines { lines, ..Breaklines::default() }));
        }
    }
}

/// The lines that close a river, at those of its ends where the banks do not meet.
fn ends([left, right]: &[Vec<&Breakline>; 2]) -> Vec<Breakline> {
    let ([left], [right]) = (&left[..], &right[..]) else { return Vec::new() };
    let end = |[a, b]: [usize; 2]| Breakline {
        vertices: vec![left.vertices[a], right.vertices[b]],
        elevations: vec![left.elevations[a], right.elevations[b]],
        is_point: false,
        polygon: None,
        properties: Arc::new(Properties { river: left.properties.river.clone(), ..Properties::default() }),
        position: left.position.clone(),
    };
    let last = [left, right].map(|bank| bank.vertices.len() - 1);
    [[0, 0], last].map(end).into_iter().filter(|end| end.vertices[0] != end.vertices[1]).collect()
}

/// What is wrong with banks, and the bank at fault.
pub(crate) type BankFault = (Bank, String);

/// Checks that two banks bound an area, together with the lines between their first and their last vertices:
/// `upper` and `lower`, from left to right, which are empty where the banks meet. All are numbers of vertices
/// at `places` of a grid, and `world` gives their coordinates.
pub(crate) fn check(
    [left, right]: [&[u32]; 2],
    [upper, lower]: [&[u32]; 2],
    place: impl Fn(u32) -> [i64; 2],
    world: impl Fn([i64; 2]) -> [f64; 2],
) -> Result<(), BankFault> {
    if let Some(bank) = Bank::BOTH.into_iter().find(|&bank| [left, right][bank as usize].len() < 2) {
        let message = "a bank is at one place of the grid, expected two at least".to_string();
        return Err((bank, message));
    }
    let ends = [left, right].map(|bank| [bank[0], bank[bank.len() - 1]].map(&place));
    if is_crosswise(ends) {
        let message =
            "the banks lead in opposite directions: reverse one of them, so that both lead downstream";
        return Err((Bank::Right, message.into()));
    }
    let ring = ring([left, right], [upper, lower]);
    if let Some(vertex) = repeated(&ring) {
        let [x, y] = world(place(vertex));
        let (bank, what) = meeting([left, right], vertex);
        let remedy = "banks may meet at the ends of the river alone, and have their ends at opposite places";
        return Err((bank, format!("{what} at {x}, {y}: {remedy}")));
    }
    if area(&ring, place) > 0 {
        let message = "the left bank is on the right, seen along the lines: if they lead upstream, reverse \
                       both; else exchange left and right";
        return Err((Bank::Left, message.into()));
    }
    Ok(())
}

/// Whether the first place of each of two lines is nearer to the last one of the other, both taken together.
fn is_crosswise([left, right]: [[[i64; 2]; 2]; 2]) -> bool {
    let distance = |[x, y]: [i64; 2], [u, v]: [i64; 2]| ((u - x) as f64).hypot((v - y) as f64);
    let of = |[first, last]: [[i64; 2]; 2]| distance(left[0], first) + distance(left[1], last);
    of(right) > of([right[1], right[0]])
}

/// The border of a river, clockwise if its banks are sound. A vertex at which they meet comes once.
fn ring([left, right]: [&[u32]; 2], [upper, lower]: [&[u32]; 2]) -> Vec<u32> {
    let back = |line: &[u32]| line.iter().rev().copied().collect::<Vec<_>>();
    let mut ring = [left, lower, &back(right), &back(upper)].concat();
    ring.dedup();
    if ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    ring
}

/// What meets at a vertex that comes twice, and the bank at fault.
fn meeting(banks: [&[u32]; 2], vertex: u32) -> (Bank, &'static str) {
    match banks.map(|bank| bank.iter().filter(|&&other| other == vertex).count()) {
        [2..=usize::MAX, _] => (Bank::Left, "the left bank crosses or touches itself"),
        [_, 2..=usize::MAX] => (Bank::Right, "the right bank crosses or touches itself"),
        [1, 1] => (Bank::Right, "the banks cross or touch each other"),
        _ => (Bank::Left, "the line between the ends of the banks crosses or touches a bank"),
    }
}

/// A vertex that comes twice.
fn repeated(ring: &[u32]) -> Option<u32> {
    let mut sorted = ring.to_vec();
    sorted.sort_unstable();
    sorted.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
}

/// Twice the area of a ring; positive if it is counterclockwise.
fn area(ring: &[u32], place: impl Fn(u32) -> [i64; 2]) -> i128 {
    let next = ring.iter().cycle().skip(1);
    let parts = ring.iter().zip(next).map(|(&a, &b)| {
        let [[x, y], [u, v]] = [place(a), place(b)].map(|place| place.map(i128::from));
        x * v - u * y
    });
    parts.sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is wrong with banks among the vertices of a river that flows along x: 0 to 3 on the left, 4 to 7
    /// on the right.
    fn checked([left, right]: [&[u32]; 2]) -> Result<(), BankFault> {
        let places = [[0, 5], [3, 5], [6, 5], [9, 5], [0, 0], [3, 0], [6, 0], [9, 0]];
        let end =
            |a: Option<&u32>, b: Option<&u32>| if a == b { vec![] } else { vec![*a.unwrap(), *b.unwrap()] };
        let [upper, lower] = [end(left.first(), right.first()), end(left.last(), right.last())];
        let place = |vertex: u32| places[vertex as usize];
        check([left, right], [&upper, &lower], place, |place| place.map(|value| value as f64))
    }

    #[test]
    fn banks_bound_an_area_or_the_fault_is_named() {
        let found = |banks: [&[u32]; 2]| checked(banks).map_err(|(bank, message)| (bank as usize, message));
        assert_eq!(found([&[0, 1, 2, 3], &[4, 5, 6, 7]]), Ok(()));
        // Banks that meet at an end need no line there.
        assert_eq!(found([&[0, 1, 2, 3], &[0, 5, 6, 3]]), Ok(()));
        for (banks, bank, part) in [
            ([&[0, 1, 2, 3][..], &[7, 6, 5, 4][..]], 1, "opposite directions"),
            ([&[4, 5, 6, 7], &[0, 1, 2, 3]], 0, "exchange left and right"),
            ([&[3, 2, 1, 0], &[7, 6, 5, 4]], 0, "reverse both"),
            ([&[0, 1, 2, 1, 3], &[4, 5, 6, 7]], 0, "the left bank crosses or touches itself at 3, 5"),
            ([&[0, 1, 2, 3], &[4, 6, 5, 6, 7]], 1, "the right bank crosses or touches itself at 6, 0"),
            ([&[0, 1, 2, 3], &[4, 1, 6, 7]], 1, "the banks cross or touch each other at 3, 5"),
            ([&[0], &[4, 5]], 0, "one place"),
        ] {
            let (own, message) = found(banks).unwrap_err();
            assert!(own == bank && message.contains(part), "{banks:?}: {message}");
        }
    }
}
