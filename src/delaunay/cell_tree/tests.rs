//! The work of searches, with and without what is far away.

use super::*;
use crate::random::Random;

const FINENESS: Fineness = Fineness {
    items_per_cell: 1.0,
    cells: [16.0, 1e7],
    entries: [32, 1 << 10],
    crowd: 8,
    reach: 0.0,
    is_whole: false,
};

fn unit(random: &mut Random) -> f64 {
    random.below(1 << 20) as f64 / f64::from(1 << 20)
}

/// Short segments, and their first ends.
fn scattered(count: usize) -> Vec<Item> {
    let mut random = Random::new(7);
    let mut items = Vec::new();
    for _ in 0..count / 2 {
        let [x, y] = [unit(&mut random), unit(&mut random)];
        let length = 1.0 / (count as f64).sqrt();
        let end = [x + length * (unit(&mut random) - 0.5), y + length * (unit(&mut random) - 0.5)];
        items.extend([Item::Place([x, y]), Item::Segment([[x, y], end])]);
    }
    items
}

fn tree_of(items: &[Item], fineness: &Fineness) -> CellTree {
    CellTree::new(items.len() as u32, |number| items[number as usize], fineness)
}

fn middle(item: &Item) -> Point2 {
    match *item {
        Item::Place(place) => place,
        Item::Segment([a, b]) => [0, 1].map(|axis| a[axis].midpoint(b[axis])),
    }
}

/// Entries of all grids, and the items that searches at some items look at.
fn work(items: &[Item], searched: &[Item]) -> usize {
    let tree = tree_of(items, &FINENESS);
    let (mut cells, mut work) = (0, 0);
    tree.for_each_grid(&mut |tree| (cells, work) = (cells + tree.grid.count(), work + tree.lists.entries()));
    assert!(cells < 8 * items.len() + 100, "{cells} cells for {} items", items.len());
    let list = |item| tree.leaf(middle(item)).map_or(0, |(tree, cell)| tree.list(cell).len());
    work + searched.iter().map(list).sum::<usize>()
}

fn corners(distance: f64) -> [Point2; 4] {
    [[distance, 0.5], [-distance, distance], [distance, distance], [0.3, -distance]]
}

#[test]
fn an_outlier_at_most_doubles_the_work() {
    let items = scattered(5_000);
    let ordinary = work(&items, &items);
    for distance in [2.0, 1e3, 1e5, 1e9, 1e12, 1e300] {
        for corner in corners(distance) {
            let with = |more: &[Item]| work(&[&items[..], more].concat(), &items) as f64 / ordinary as f64;
            let from = [0.5, 0.5];
            let ratios = [
                with(&[Item::Place(corner)]),
                with(&[Item::Segment([from, corner])]),
                with(&corners(distance).map(Item::Place)),
                with(&corners(distance).map(|end| Item::Segment([corner, end]))),
            ];
            assert!(ratios.iter().all(|&ratio| ratio < 2.0), "{corner:?}: {ratios:?}");
        }
    }
}

#[test]
fn the_work_grows_as_the_items() {
    let scaled = |by: f64, count: usize| {
        let scale = |end: Point2| [by * end[0], by * end[1]];
        let one = |item: &Item| match *item {
            Item::Place(place) => Item::Place(scale(place)),
            Item::Segment(ends) => Item::Segment(ends.map(scale)),
        };
        scattered(count).iter().map(one).collect::<Vec<_>>()
    };
    let line = |count: usize| -> Vec<Item> {
        (0..count).map(|i| i as f64 / count as f64).map(|x| Item::Place([x, 0.7 * x])).collect()
    };
    let star = |count: usize| -> Vec<Item> {
        (0..count).map(|i| i as f64).map(|a| Item::Segment([[0.0; 2], [a.cos(), a.sin()]])).collect()
    };
    let clusters = |count: usize| -> Vec<Item> {
        (0..7).flat_map(|power| scaled(10f64.powi(-2 * power), count / 7)).collect()
    };
    for (name, of) in [
        ("scattered", &scattered as &dyn Fn(usize) -> Vec<Item>),
        ("line", &line),
        ("clusters", &clusters),
        ("one place", &|count| vec![Item::Place([1.0, 2.0]); count]),
    ] {
        let work =
            |count| work(&of(count), &of(count)[..if name == "one place" { 1 } else { count / 8 * 7 }]);
        let ratio = work(16_000) as f64 / work(8_000) as f64;
        assert!(ratio < 2.3, "{name}: {ratio}");
    }
    // Nothing parts segments that meet in one place, but their lists are limited.
    let ratio = work(&star(64_000), &[]) as f64 / work(&star(32_000), &[]) as f64;
    assert!(ratio < 2.5, "star: {ratio}");
}

/// What meets a box is in the lists of the cells that meet it; a place is in the list of its cell.
#[test]
fn no_item_is_lost() {
    let mut random = Random::new(11);
    for case in 0..60 {
        let mut items = scattered(200);
        let distance = 10f64.powi(random.below(18) as i32);
        let far: Vec<Point2> = (0..random.below(5)).map(|at| corners(distance)[at as usize % 4]).collect();
        for &corner in &far {
            items.push(Item::Place(corner));
            items.push(Item::Segment([[unit(&mut random), unit(&mut random)], corner]));
            items.push(Item::Segment([far[0], corner]));
        }
        let fineness = Fineness { crowd: 1 + case % 5, reach: [0.0, 0.01][case % 2], ..FINENESS };
        let tree = tree_of(&items, &fineness);
        for (number, item) in (0..).zip(&items) {
            let lists = match *item {
                Item::Place(place) => vec![place],
                Item::Segment([a, b]) => (0..20)
                    .map(|part| f64::from(part) / 20.0)
                    .map(|part| [0, 1].map(|axis| a[axis] + part * (b[axis] - a[axis])))
                    .collect(),
            };
            for place in lists {
                let found = tree.leaf(place).is_some_and(|(tree, cell)| tree.list(cell).contains(&number));
                // Rounding moves places on long segments.
                assert!(found || place[0].abs().max(place[1].abs()) > 10.0, "{item:?} at {place:?}");
            }
        }
        let places: Vec<Item> = items.iter().copied().filter(|i| matches!(i, Item::Place(_))).collect();
        let tree = tree_of(&places, &fineness);
        let mut positions = Vec::new();
        let Ok::<(), ()>(()) = tree.for_each_leaf(&mut |_, _, list| {
            positions.extend_from_slice(list);
            Ok(())
        }) else {
            unreachable!()
        };
        for (number, place) in (0..).zip(&places) {
            let (tree, cell) = tree.leaf(middle(place)).expect("a place is in the box");
            assert!(positions[tree.positions(cell)].contains(&number), "{place:?}");
        }
    }
}
