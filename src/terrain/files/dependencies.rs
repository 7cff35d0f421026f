//! Which tiles are needed for what, while they come in any order.

use std::ops::Range;

use super::tiles::{TilePlace, places};

/// Products that are each made of a rectangle of tiles, in rows and columns as the tiles are: says when all
/// tiles of a product have come, and when all products of a tile are made.
///
/// Memory: five bytes for each tile, four for each product.
#[derive(Debug)]
pub(crate) struct Dependencies {
    /// Along each axis, the tiles of each product.
    needs: [Vec<Range<usize>>; 2],
    /// Along each axis, the products of each tile.
    users: [Vec<Range<usize>>; 2],
    has_come: Vec<bool>,
    /// For each product, how many of its tiles have not come.
    missing: Vec<u32>,
    /// For each tile, how many of its products are not made.
    waiting: Vec<u32>,
}

impl Dependencies {
    /// No tile has come. `tiles` is the number of tiles along each axis; `needs` holds, along each axis, the
    /// tiles of each product.
    ///
    /// Domain: ranges that are not empty; along an axis, neither starts nor ends decrease.
    pub(crate) fn new(tiles: [usize; 2], needs: [Vec<Range<usize>>; 2]) -> Dependencies {
        let users = [0, 1].map(|axis| users(&needs[axis], tiles[axis]));
        Dependencies {
            has_come: vec![false; tiles[0] * tiles[1]],
            missing: areas(&needs),
            waiting: areas(&users),
            needs,
            users,
        }
    }

    /// Whether a tile has come.
    pub(crate) fn has_come(&self, at: TilePlace) -> bool {
        self.has_come[number(&self.users, at)]
    }

    /// Takes note of a tile. Returns the products that can be made now.
    pub(crate) fn come(&mut self, at: TilePlace) -> Vec<TilePlace> {
        let tile = number(&self.users, at);
        debug_assert!(!self.has_come[tile], "each tile comes once");
        self.has_come[tile] = true;
        count_down(&self.users, at, &self.needs, &mut self.missing)
    }

    /// Takes note of a product that was made. Returns the tiles that no other one needs.
    pub(crate) fn made(&mut self, product: TilePlace) -> Vec<TilePlace> {
        count_down(&self.needs, product, &self.users, &mut self.waiting)
    }
}

/// For each tile along an axis, the range of products that need it.
fn users(needs: &[Range<usize>], tiles: usize) -> Vec<Range<usize>> {
    let of_tile = |tile: usize| {
        needs.partition_point(|need| need.end <= tile)..needs.partition_point(|need| need.start <= tile)
    };
    (0..tiles).map(of_tile).collect()
}

/// The number of a place whose row and column are described by `axes`.
fn number(axes: &[Vec<Range<usize>>; 2], [column, row]: TilePlace) -> usize {
    row * axes[0].len() + column
}

/// The number of partners of each place.
fn areas(axes: &[Vec<Range<usize>>; 2]) -> Vec<u32> {
    let of_place = |[column, row]: TilePlace| (axes[0][column].len() * axes[1][row].len()) as u32;
    places([axes[0].len(), axes[1].len()]).map(of_place).collect()
}

/// Subtracts 1 from the count of each partner of a place; returns those that have reached zero.
fn count_down(
    axes: &[Vec<Range<usize>>; 2],
    [column, row]: TilePlace,
    partner_axes: &[Vec<Range<usize>>; 2],
    counts: &mut [u32],
) -> Vec<TilePlace> {
    let (columns, rows) = (axes[0][column].clone(), axes[1][row].clone());
    let partners = rows.flat_map(|row| columns.clone().map(move |column| [column, row]));
    let is_last = |&partner: &TilePlace| {
        let count = &mut counts[number(partner_axes, partner)];
        *count -= 1;
        *count == 0
    };
    partners.filter(is_last).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn products_wait_for_their_tiles_and_tiles_for_their_products() {
        let needs = [vec![0..2, 1..3, 1..4], vec![0..1, 0..2]];
        let tiles = [4, 2];
        let mut dependencies = Dependencies::new(tiles, needs.clone());
        let needed = |[x, y]: TilePlace| -> HashSet<TilePlace> {
            places(tiles).filter(|at| needs[0][x].contains(&at[0]) && needs[1][y].contains(&at[1])).collect()
        };
        let (mut come, mut made) = (HashSet::new(), HashSet::new());
        for at in places(tiles).collect::<Vec<_>>().into_iter().rev() {
            let products = dependencies.come(at);
            come.insert(at);
            let expected: HashSet<TilePlace> =
                places([3, 2]).filter(|&it| needed(it).is_subset(&come) && !made.contains(&it)).collect();
            assert_eq!(products.iter().copied().collect::<HashSet<_>>(), expected);
            for product in products {
                made.insert(product);
                let free = |at: &TilePlace| {
                    needed(product).contains(at)
                        && places([3, 2]).all(|other| made.contains(&other) || !needed(other).contains(at))
                };
                let expected: HashSet<TilePlace> = places(tiles).filter(free).collect();
                assert_eq!(dependencies.made(product).into_iter().collect::<HashSet<_>>(), expected);
            }
        }
        assert_eq!(made.len(), 6);
        assert!(places(tiles).all(|at| dependencies.has_come(at)));
    }
}
