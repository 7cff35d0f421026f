//! The faces between cells, tile by tile.

use super::Contact;
use super::tiles::Members;

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
